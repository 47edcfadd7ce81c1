//! The shortcuts themselves: each looks at one thing and ignores the meaning of the sentence.

use glam::{DMat4, DVec3};
use l4d_data::tracks::{TrackedInstance, at_frame};
use l4d_data::truth::Truth;
use l4d_data::{Role, Split};

use crate::ast::{Clause, Party, Predicate};
use crate::eval::{answer_at, members};
use crate::obb::Obb;
use crate::prove::{path_length_m, words};
use crate::verbs;
use crate::world::World;

/// Differences of scores below this share of the best are ties.
const TIE: f64 = 1e-3;
/// The frame in the middle of the clip.
const MIDDLE: u32 = l4d_data::timeline::LAST_FRAME / 2;
/// What a shortcut sees of a query.
pub(super) struct Case<'c, 'a> {
    pub(super) world: &'c World<'a>,
    pub(super) truth: Option<&'c Truth>,
    pub(super) text: &'c str,
    pub(super) predicate: Predicate,
    pub(super) candidates: Vec<&'a TrackedInstance>,
    pub(super) frames: Vec<u32>,
}

/// What a shortcut picks.
pub(super) enum Pick<'a> {
    /// One of these at random; none means no information.
    Among(Vec<&'a TrackedInstance>),
    /// It cannot be tried: what it looks at is missing.
    Impossible,
}

/// A way to answer without understanding.
pub(super) struct Shortcut {
    /// What tables call it.
    pub(super) name: &'static str,
    /// How it picks.
    pub(super) rule: &'static str,
    /// Whether it must stay near chance.
    pub(super) bounded: bool,
    pub(super) pick: for<'c, 'a> fn(&Case<'c, 'a>) -> Pick<'a>,
}

const fn shortcut(
    name: &'static str,
    rule: &'static str,
    pick: for<'c, 'a> fn(&Case<'c, 'a>) -> Pick<'a>,
) -> Shortcut {
    Shortcut { name, rule, bounded: true, pick }
}

/// All shortcuts, in table order.
pub(super) const SHORTCUTS: [Shortcut; 9] = [
    shortcut("colour only", "the object whose colour the sentence mentions", colour),
    shortcut("most moving", "the longest path of the box centre while the query holds", most_moving),
    shortcut("least moving", "the shortest path of the box centre", least_moving),
    shortcut(
        "nearest landmark",
        "nearest to what the sentence mentions, or to any landmark",
        nearest_landmark,
    ),
    shortcut("largest box", "the largest volume", largest_box),
    shortcut("most pixels", "the most pixels in the held-out view", most_pixels),
    shortcut("most central", "nearest to the centre of the held-out picture", most_central),
    shortcut("busy at half-time", "takes part in an event in the middle frame", busy),
    Shortcut {
        bounded: false,
        ..shortcut("reads one frame", "the predicate as far as the middle frame alone can show it", one_frame)
    },
];

fn colour<'a>(case: &Case<'_, 'a>) -> Pick<'a> {
    let said: Vec<String> = words(case.text).iter().flat_map(|word| parts(word)).collect();
    let shows = |candidate: &&&TrackedInstance| {
        let values = candidate.attributes.values().flat_map(|value| parts(value));
        values.filter(|part| verbs::is_colour(part)).any(|part| said.contains(&part))
    };
    Pick::Among(case.candidates.iter().filter(shows).copied().collect())
}

/// `red_and_white` and `red-and-white` speak of red and of white.
fn parts(value: &str) -> Vec<String> {
    value.split(['_', '-', ' ']).map(str::to_lowercase).collect()
}

fn most_moving<'a>(case: &Case<'_, 'a>) -> Pick<'a> {
    best(case, |candidate| path_length_m(case.world, candidate, case.frames.iter().copied()))
}

fn least_moving<'a>(case: &Case<'_, 'a>) -> Pick<'a> {
    best(case, |candidate| -path_length_m(case.world, candidate, case.frames.iter().copied()))
}

fn nearest_landmark<'a>(case: &Case<'_, 'a>) -> Pick<'a> {
    let mentioned: Vec<&Party> = case.predicate.parties();
    let mut marks: Vec<&TrackedInstance> =
        mentioned.into_iter().flat_map(|party| members(case.world, party)).collect();
    if marks.is_empty() {
        marks = case.world.instances().filter(|instance| instance.role == Role::Landmark).collect();
    }
    best(case, |candidate| {
        let others = || marks.iter().filter(|mark| mark.name != candidate.name);
        let nearest = |frame: u32| {
            let distances = others().map(|mark| case.world.distance_m(candidate, mark, frame));
            distances.min_by(f64::total_cmp).unwrap_or(f64::INFINITY)
        };
        // Every fourth frame tells as much.
        let frames: Vec<u32> = case.frames.iter().copied().step_by(4).collect();
        -frames.iter().map(|&frame| nearest(frame)).sum::<f64>() / frames.len() as f64
    })
}

fn largest_box<'a>(case: &Case<'_, 'a>) -> Pick<'a> {
    best(case, |candidate| case.world.median(candidate, Obb::volume))
}

fn most_pixels<'a>(case: &Case<'_, 'a>) -> Pick<'a> {
    let Some(truth) = case.truth else { return Pick::Impossible };
    let Some(visible) = truth.visible.get(&truth.test_view) else { return Pick::Impossible };
    best(case, |candidate| {
        let counts = visible.get(&candidate.name).map(Vec::as_slice).unwrap_or_default();
        let asked = truth.frames.iter().zip(counts).filter(|(frame, _)| case.frames.contains(frame));
        asked.map(|(_, &count)| f64::from(count)).sum()
    })
}

fn most_central<'a>(case: &Case<'_, 'a>) -> Pick<'a> {
    let cameras = &case.world.tracks().cameras;
    let Some(camera) = cameras.iter().find(|camera| camera.split == Split::Test) else {
        return Pick::Impossible;
    };
    best(case, |candidate| {
        let offset = |frame: u32| {
            let world_from_camera =
                DMat4::from_cols_array(at_frame(&camera.world_from_camera, frame)).transpose();
            let centre: DVec3 = case.world.obb(candidate, frame).centre;
            let point = world_from_camera.inverse().transform_point3(centre);
            point.truncate().length() / point.z.max(1e-6) * camera.focal_over_width
        };
        -case.frames.iter().map(|&frame| offset(frame)).sum::<f64>() / case.frames.len() as f64
    })
}

fn busy<'a>(case: &Case<'_, 'a>) -> Pick<'a> {
    let takes_part = |candidate: &&&TrackedInstance| {
        let mut events = case.world.events().filter(|event| event.frames.contains(MIDDLE));
        events.any(|event| {
            let is_own = event.subject == candidate.name || event.object.as_ref() == Some(&candidate.name);
            is_own && !verbs::is_state(&event.verb)
        })
    };
    Pick::Among(case.candidates.iter().filter(takes_part).copied().collect())
}

fn one_frame<'a>(case: &Case<'_, 'a>) -> Pick<'a> {
    let still = Predicate(case.predicate.0.iter().map(in_one_frame).collect());
    let seen = answer_at(case.world, &still, MIDDLE);
    Pick::Among(case.candidates.iter().filter(|candidate| seen.contains(&candidate.name)).copied().collect())
}

/// What one frame can show of a clause: no start, no end, no order.
fn in_one_frame(clause: &Clause) -> Clause {
    match clause {
        Clause::AtStart(inner) | Clause::AtEnd(inner) | Clause::First(inner) | Clause::Last(inner) => {
            in_one_frame(inner)
        }
        Clause::Then(steps) => in_one_frame(&steps[1]),
        Clause::Not(inner) => Clause::Not(Box::new(in_one_frame(inner))),
        clause => clause.clone(),
    }
}

/// The candidates with the highest score, those that tie included.
fn best<'a>(case: &Case<'_, 'a>, score: impl Fn(&TrackedInstance) -> f64) -> Pick<'a> {
    let scored: Vec<(f64, &TrackedInstance)> =
        case.candidates.iter().map(|candidate| (score(candidate), *candidate)).collect();
    let top = scored.iter().map(|(score, _)| *score).fold(f64::NEG_INFINITY, f64::max);
    let tied = |value: f64| value == top || top - value <= TIE * top.abs().max(TIE);
    Pick::Among(
        scored.into_iter().filter(|(value, _)| tied(*value)).map(|(_, candidate)| candidate).collect(),
    )
}
