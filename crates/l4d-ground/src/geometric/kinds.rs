//! How readily a track is taken for a kind of thing, by its size.

use glam::DVec3;
use l4d_data::Scale;

use super::lexicon::{Lexicon, Noun};
use super::motion::Kinematics;
use super::parse::ANY_PERSON;
use super::perceive::{Glimpse, Perceived, Track};
use super::settings::{
    CLOSED_POWER, CUT_COST, FILL_POWER, FOCUS_POWER, FOCUS_REACH, FOCUS_SHARE, LIFELESS, SEEN_POWER,
    SIZE_DEVIATION, STAND_SHARE, UNSUPPORTED,
};

/// Two things are alike in size if their sides differ by this much: standard deviation of the logarithm.
const ALIKE_DEVIATION: f64 = 0.15;

/// 0 to 1: whether a track may be one of these.
pub(crate) fn fits(
    seen: &Perceived,
    track: &Track,
    moves: &Kinematics,
    noun: &str,
    lexicon: &Lexicon,
) -> f64 {
    let noun = match (noun, seen.scale) {
        (ANY_PERSON, Scale::Tabletop) => "hand",
        (ANY_PERSON, _) => "person",
        _ => noun,
    };
    let Some(noun) = lexicon.noun(noun) else { return 0.0 };
    let moves = moves.ever_moves();
    let alive = if noun.live { LIFELESS + (1.0 - LIFELESS) * moves } else { 1.0 };
    let held = f64::max(moves, stands(seen, track));
    let held = UNSUPPORTED + (1.0 - UNSUPPORTED) * held;
    let cut = if noun.live { 1.0 } else { 1.0 - CUT_COST * cut_share(track) };
    size_fit(track, noun) * whole(track) * alive * held * cut * near_focus(seen, track)
}

/// Share of the frames in which the border of the picture cuts it: arms reach in, things lie inside.
fn cut_share(track: &Track) -> f64 {
    let cut = track.seen().filter(|(_, seen)| seen.is_cut).count();
    cut as f64 / track.seen().count().max(1) as f64
}

/// 0 to 1 for each track: whether there is another of the same size elsewhere. "Which one" means that there are several.
pub(crate) fn alike(seen: &Perceived) -> Vec<f64> {
    let middle = seen.frames.len() / 2;
    let sides =
        |track: &Track| [track.median(Glimpse::longest_m), track.median(|seen| seen.high.z - seen.low.z)];
    let measured: Vec<Option<([f64; 2], DVec3, f64)>> = seen
        .tracks
        .iter()
        .map(|track| Some((sides(track), track.nearest(middle)?.centre, track.median(|seen| seen.closed))))
        .collect();
    let likeness = |own: &([f64; 2], DVec3, f64), other: &([f64; 2], DVec3, f64)| {
        if own.1.distance(other.1) < 0.7 * own.0[0].max(other.0[0]) {
            return 0.0; // another reading of the same thing
        }
        let off =
            |axis: usize| ((own.0[axis].max(1e-4) / other.0[axis].max(1e-4)).ln() / ALIKE_DEVIATION).powi(2);
        (-0.5 * (off(0) + off(1))).exp() * other.2
    };
    let best = |own: &Option<([f64; 2], DVec3, f64)>| {
        let others = measured.iter().flatten();
        own.as_ref().map_or(0.0, |own| others.map(|other| likeness(own, other)).fold(0.0, f64::max))
    };
    measured.iter().map(best).collect()
}

/// Whether it stands on a level surface.
fn stands(seen: &Perceived, track: &Track) -> f64 {
    let height_m = track.median(|seen| seen.high.z - seen.low.z);
    let bottom_m = track.median(|seen| seen.low.z);
    let off = seen.levels_m.iter().map(|level| (bottom_m - level).abs()).fold(f64::INFINITY, f64::min);
    (-off / (STAND_SHARE * height_m.max(seen.spacing_m))).exp()
}

/// Whether it is where things happen.
fn near_focus(seen: &Perceived, track: &Track) -> f64 {
    let Some((focus, spread_m)) = seen.focus else { return 1.0 };
    let nearest_m = track
        .seen()
        .map(|(_, seen)| focus.clamp(seen.low, seen.high).distance(focus))
        .fold(f64::INFINITY, f64::min);
    let around_m = spread_m.max(FOCUS_SHARE * seen.eye.distance(focus));
    let reach_m = FOCUS_REACH * around_m.max(1e-6);
    1.0 / (1.0 + (nearest_m / reach_m).powf(FOCUS_POWER))
}

/// Whether its size is usual for the kind.
fn size_fit(track: &Track, noun: &Noun) -> f64 {
    let longest_m = track.median(|seen| seen.longest_m());
    let tall_m = track.median(|seen| seen.high.z - seen.low.z);
    within(longest_m, noun.size, SIZE_DEVIATION) * within(tall_m, noun.tall, SIZE_DEVIATION)
}

/// 1 inside the range, fading with the logarithm outside.
fn within(value: f64, [from, to]: [f64; 2], deviation: f64) -> f64 {
    let value = value.max(1e-4);
    let off = if value < from {
        (from / value).ln()
    } else if value > to {
        (value / to).ln()
    } else {
        0.0
    };
    (-0.5 * (off / deviation).powi(2)).exp()
}

/// Whether it looks like all of a thing rather than a piece of one, and is there for long.
fn whole(track: &Track) -> f64 {
    let closed = track.median(|seen| seen.closed);
    let seen = track.seen().count() as f64 / track.glimpses.len().max(1) as f64;
    let fill = |seen: &Glimpse| {
        let bounds = &seen.bounds;
        let spans = u64::from(bounds.last_col - bounds.first_col + 1)
            * u64::from(bounds.last_row - bounds.first_row + 1);
        seen.area_px as f64 / spans as f64
    };
    closed.powf(CLOSED_POWER) * track.median(fill).powf(FILL_POWER) * seen.powf(SEEN_POWER)
}
