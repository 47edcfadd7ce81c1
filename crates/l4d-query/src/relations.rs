//! What each relation and superlative means, decided from oriented boxes, exact mesh distances and contact.
//!
//! `docs/queries.md` states the same definitions in words; the numbers are in `thresholds`. "In plan" means seen
//! from above.

use l4d_data::tracks::{TrackedInstance, at_frame};

use crate::ast::{Relation, Superlative};
use crate::obb::Obb;
use crate::reading::{Degree, Member, Reading, Truth, Unit, any_of};
use crate::thresholds::{
    BETWEEN_MARGIN, BETWEEN_OFFSET, CONE_DEG, CONTACT_BEGIN_M, CONTACT_END_M, DISTANCE_MARGIN, FACING_DEG,
    HEIGHT_MARGIN, ON_HEIGHT_SHARE, Slack, UNDER_HEIGHT_SHARE, VOLUME_MARGIN, before_m, beside_m, higher_m,
};
use crate::times::Times;
use crate::world::World;

/// Distances below this are contact; no ratio is taken of less, metres.
const NEAREST_M: f64 = 1e-3;

/// When `subject` is in a relation: to any of `others`, for `between` to any of them and any of `second`.
///
/// Nothing is related to itself.
pub fn related(
    world: &World<'_>,
    subject: &TrackedInstance,
    kind: Relation,
    others: &[&TrackedInstance],
    second: &[&TrackedInstance],
) -> Times {
    let [others, second] = [others, second].map(|of| of.iter().map(|one| (*one, true)).collect::<Vec<_>>());
    relation(world, subject, kind, [&others, &second], &subject.category)
}

/// When `subject`, one of a noun, is in a relation to those of the first list, and for `between` of the second.
pub(crate) fn relation<'a, R: Reading<'a>>(
    reading: &R,
    subject: &TrackedInstance,
    kind: Relation,
    [others, second]: [&[Member<'_, R::Degree>]; 2],
    noun: &str,
) -> R::Truth {
    let slack = reading.slack();
    let of = |list: &[Member<'_, R::Degree>], but: &[&TrackedInstance]| -> Vec<(usize, R::Degree)> {
        let is_other = |one: &TrackedInstance| but.iter().all(|excluded| excluded.name != one.name);
        let all = list.iter().enumerate().filter(|(_, (one, _))| is_other(one));
        all.map(|(at, (_, degree))| (at, *degree)).collect()
    };
    match kind {
        Relation::ClosestTo => beats_rivals(reading, subject, others, noun, true),
        Relation::FarthestFrom => beats_rivals(reading, subject, others, noun, false),
        Relation::Between => any_of(of(others, &[subject]).into_iter().flat_map(|(at, is_first)| {
            let first = others[at].0;
            of(second, &[subject, first]).into_iter().map(move |(at, is_second)| {
                let pair = is_first.and(|| is_second);
                when(reading, slack, |now| pair.and(|| now.is_between(subject, first, second[at].0)))
            })
        })),
        _ => any_of(of(others, &[subject]).into_iter().map(|(at, is_meant)| {
            related_to(reading, slack, subject, kind, others[at].0).and(R::Truth::constant(is_meant))
        })),
    }
}

fn related_to<'a, R: Reading<'a>>(
    reading: &R,
    slack: Slack,
    subject: &TrackedInstance,
    kind: Relation,
    other: &TrackedInstance,
) -> R::Truth {
    let world = reading.world();
    let when = |test: &dyn Fn(AtFrame<'_, 'a, R>) -> R::Degree| when(reading, slack, test);
    let touching = || contact(reading, slack, subject, other);
    match kind {
        Relation::Touching => touching(),
        Relation::On => touching().and(when(&|now| now.rises_from(subject, other))),
        Relation::In => touching().and(when(&|now| now.is_inside(subject, other))),
        Relation::Under => when(&|now| now.is_under(subject, other)),
        Relation::Beside => {
            let elsewhere = [Relation::On, Relation::In];
            let elsewhere = elsewhere.map(|kind| related_to(reading, slack.opposite(), subject, kind, other));
            let reach = slack.at_most(beside_m(world.scale()));
            let is_near = |now: AtFrame<'_, 'a, R>| {
                now.at_most(world.distance_m(subject, other, now.frame), reach, Unit::Metres)
            };
            any_of(elsewhere).not().and(when(&is_near))
        }
        Relation::InFrontOf => when(&|now| now.is_before(subject, other, 1.0)),
        Relation::Behind => when(&|now| now.is_before(subject, other, -1.0)),
        Relation::Facing => when(&|now| now.is_facing(subject, other)),
        Relation::Between | Relation::ClosestTo | Relation::FarthestFrom => {
            R::Truth::constant(R::Degree::FALSE)
        }
    }
}

/// When two things touch: from [`CONTACT_BEGIN_M`] until [`CONTACT_END_M`].
pub(crate) fn contact<'a, R: Reading<'a>>(
    reading: &R,
    slack: Slack,
    a: &TrackedInstance,
    b: &TrackedInstance,
) -> R::Truth {
    let Some(distances) = reading.world().near_m(a, b) else {
        return R::Truth::constant(R::Degree::FALSE);
    };
    let (begin, end) = (slack.at_most(CONTACT_BEGIN_M), slack.at_most(CONTACT_END_M));
    let mut touching = false;
    R::Truth::when(|frame| {
        let limit = if touching { end } else { begin };
        let degree = reading.at_least(limit, *at_frame(distances, frame), Unit::Metres);
        touching = degree.is_likely();
        degree
    })
}

/// When `subject`, one of a noun, is the extreme of the objects of that noun.
pub(crate) fn extreme<'a, R: Reading<'a>>(
    reading: &R,
    subject: &TrackedInstance,
    extreme: Superlative,
    noun: &str,
) -> R::Truth {
    let (world, slack) = (reading.world(), reading.slack());
    let rivals: Vec<_> = rivals(reading, subject, noun).collect();
    let beats = |measure: fn(&Obb) -> f64, power: f64, margin: f64, sign: f64| {
        let own = world.median(subject, measure).powf(sign);
        let factor = slack.at_least(margin);
        R::Truth::constant(beats_all(&rivals, |rival| {
            let other = world.median(rival, measure).powf(sign);
            reading.at_least(own, other * factor, Unit::Size(power))
        }))
    };
    let is_above = |sign: f64| {
        let lead = slack.at_least(higher_m(world.scale()));
        R::Truth::when(|frame| {
            let own = world.obb(subject, frame).centre.z;
            beats_all(&rivals, |rival| {
                let ahead = sign * (own - world.obb(rival, frame).centre.z);
                reading.at_least(ahead, lead, Unit::Metres)
            })
        })
    };
    match extreme {
        Superlative::Largest => beats(Obb::volume, 3.0, VOLUME_MARGIN, 1.0),
        Superlative::Smallest => beats(Obb::volume, 3.0, VOLUME_MARGIN, -1.0),
        Superlative::Tallest => beats(Obb::height, 1.0, HEIGHT_MARGIN, 1.0),
        Superlative::Highest => is_above(1.0),
        Superlative::Lowest => is_above(-1.0),
    }
}

/// The objects that `subject` is compared with, each with how sure it is that it is of the noun.
fn rivals<'a, 'r, R: Reading<'a>>(
    reading: &'r R,
    subject: &'r TrackedInstance,
    noun: &'r str,
) -> impl Iterator<Item = Member<'a, R::Degree>> + 'r
where
    'a: 'r,
{
    let all = reading.world().objects().map(move |other| (other, reading.is_rival(subject, other, noun)));
    all.filter(|(_, is_rival)| is_rival.is_possible())
}

/// Whether the test holds for all rivals that are rivals.
fn beats_all<D: Degree>(rivals: &[Member<'_, D>], beats: impl Fn(&TrackedInstance) -> D) -> D {
    rivals
        .iter()
        .fold(D::TRUE, |so_far, (rival, is_rival)| so_far.and(|| is_rival.and(|| beats(rival).not()).not()))
}

/// When `subject` is closer to the nearest of `others`, or farther from it, than all it is compared with: its noun
/// without itself and without the one that distances are taken to.
fn beats_rivals<'a, R: Reading<'a>>(
    reading: &R,
    subject: &TrackedInstance,
    others: &[Member<'_, R::Degree>],
    noun: &str,
    closer: bool,
) -> R::Truth {
    let is_target = |rival: &TrackedInstance| matches!(others, [(only, _)] if only.name == rival.name);
    let rivals: Vec<_> = rivals(reading, subject, noun).filter(|(rival, _)| !is_target(rival)).collect();
    let margin = reading.slack().at_least(DISTANCE_MARGIN);
    when(reading, reading.slack(), |now| {
        let Some(own) = now.nearest_m(subject, others) else { return R::Degree::FALSE };
        beats_all(&rivals, |rival| {
            let Some(other) = now.nearest_m(rival, others) else { return R::Degree::TRUE };
            let (near, far) = if closer { (own, other) } else { (other, own) };
            reading.at_least(far, near.max(NEAREST_M) * margin, Unit::Metres)
        })
    })
}

/// A reading at a frame.
struct AtFrame<'r, 'a, R> {
    reading: &'r R,
    world: &'r World<'a>,
    slack: Slack,
    frame: u32,
}

fn when<'a, R: Reading<'a>>(
    reading: &R,
    slack: Slack,
    test: impl Fn(AtFrame<'_, 'a, R>) -> R::Degree,
) -> R::Truth {
    R::Truth::when(|frame| test(AtFrame { reading, world: reading.world(), slack, frame }))
}

impl<'a, R: Reading<'a>> AtFrame<'_, 'a, R> {
    fn obb(&self, instance: &TrackedInstance) -> &Obb {
        self.world.obb(instance, self.frame)
    }

    fn at_most(&self, value: f64, limit: f64, unit: Unit) -> R::Degree {
        self.reading.at_least(limit, value, unit)
    }

    /// Whether a height is truly above another.
    fn is_above(&self, upper: f64, lower: f64) -> R::Degree {
        self.reading.at_least(lower, upper, Unit::Metres).not()
    }

    fn is_over_footprint(&self, obb: &Obb, point: glam::DVec3) -> R::Degree {
        let margin = obb.footprint_margin_m(point.truncate(), self.slack.at_most(1.0));
        self.reading.at_least(margin, 0.0, Unit::Metres)
    }

    fn rises_from(&self, subject: &TrackedInstance, other: &TrackedInstance) -> R::Degree {
        let (above, below) = (self.obb(subject), self.obb(other));
        let least = below.bottom() + self.slack.at_least(ON_HEIGHT_SHARE) * below.height();
        self.is_over_footprint(below, above.centre)
            .and(|| self.reading.at_least(above.centre.z, least, Unit::Metres))
            .and(|| self.is_above(above.rounded().0, below.bottom()))
    }

    fn is_inside(&self, subject: &TrackedInstance, other: &TrackedInstance) -> R::Degree {
        let (inner, outer) = (self.obb(subject), self.obb(other));
        let margin = outer.margin_m(inner.centre, self.slack.at_most(1.0));
        self.reading
            .at_least(margin, 0.0, Unit::Metres)
            .and(|| self.is_above(inner.rounded().0, outer.bottom()))
    }

    fn is_under(&self, subject: &TrackedInstance, other: &TrackedInstance) -> R::Degree {
        let (below, above) = (self.obb(subject), self.obb(other));
        let (bottom, top) = below.rounded();
        let most = above.bottom() + self.slack.at_most(UNDER_HEIGHT_SHARE) * above.height();
        self.is_over_footprint(above, below.centre)
            .and(|| self.at_most(top, above.top(), Unit::Metres))
            .and(|| self.at_most(bottom, most, Unit::Metres))
            .and(|| self.is_above(above.centre.z, below.centre.z))
    }

    fn is_between(&self, subject: &TrackedInstance, a: &TrackedInstance, b: &TrackedInstance) -> R::Degree {
        let [start, end, point] = [a, b, subject].map(|instance| self.obb(instance).centre.truncate());
        let along = end - start;
        let length = along.length();
        if length < NEAREST_M {
            return R::Degree::FALSE;
        }
        let share = (point - start).dot(along) / (length * length);
        let offset = (point - start - along * share).length();
        let least = self.slack.at_least(BETWEEN_MARGIN);
        self.reading
            .at_least(share.min(1.0 - share), least, Unit::ShareOf(length))
            .and(|| self.at_most(offset, self.slack.at_most(BETWEEN_OFFSET) * length, Unit::Metres))
    }

    /// Distance to the nearest of `others` that is not `subject`.
    fn nearest_m(&self, subject: &TrackedInstance, others: &[Member<'_, R::Degree>]) -> Option<f64> {
        let others = others.iter().filter(|(other, _)| other.name != subject.name);
        self.reading.nearest(
            others.map(|(other, degree)| (self.world.distance_m(subject, other, self.frame), *degree)),
        )
    }

    /// Whether `subject` is in the cone that opens from the centre of `other` to its front (`sign` 1) or back (-1).
    fn is_before(&self, subject: &TrackedInstance, other: &TrackedInstance, sign: f64) -> R::Degree {
        let reach = self.slack.at_most(before_m(self.world.scale()));
        self.is_ahead(other, subject, sign, CONE_DEG)
            .and(|| self.at_most(self.world.distance_m(subject, other, self.frame), reach, Unit::Metres))
    }

    fn is_facing(&self, subject: &TrackedInstance, other: &TrackedInstance) -> R::Degree {
        self.is_ahead(subject, other, 1.0, FACING_DEG)
    }

    /// Whether the front of `viewer` (times `sign`) points in plan within an angle of the centre of `target`.
    fn is_ahead(
        &self,
        viewer: &TrackedInstance,
        target: &TrackedInstance,
        sign: f64,
        within_deg: f64,
    ) -> R::Degree {
        let angle = self.front_angle_deg(viewer, target, sign);
        let limit = self.slack.at_most(within_deg);
        angle.map_or(R::Degree::UNKNOWN, |angle| self.at_most(angle, limit, Unit::Degrees))
    }

    fn front_angle_deg(&self, viewer: &TrackedInstance, target: &TrackedInstance, sign: f64) -> Option<f64> {
        let here = self.obb(viewer);
        let front = here.plan_direction(viewer.front.as_deref()?)? * sign;
        let towards = (self.obb(target).centre - here.centre).truncate().try_normalize()?;
        Some(front.dot(towards).clamp(-1.0, 1.0).acos().to_degrees())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{pair, standing, tracks};
    use l4d_data::tracks::Tracks;

    /// Objects that stand in the relation to the named at frame 0.
    fn holding(tracks: &Tracks, kind: Relation, of: &[&str]) -> Vec<String> {
        let world = World::new(tracks);
        let of: Vec<_> = of.iter().map(|name| world.instance(name).unwrap()).collect();
        let second = of.get(1..).unwrap_or_default();
        let related = world.objects().filter(|object| related(&world, object, kind, &of[..1], second).at(0));
        related.map(|object| object.name.to_string()).collect()
    }

    fn room() -> Tracks {
        let size = [0.08, 0.08, 0.1];
        let instances = [
            standing(1, "on", "cup", [0.2, 0., 0.7], size),
            standing(2, "under", "cup", [0.2, 0., 0.], size),
            standing(3, "near", "cup", [0.6, 0., 0.], size),
            standing(4, "far", "cup", [2., 0., 0.], size),
            standing(1001, "table", "table", [0., 0., 0.], [1., 1., 0.7]),
            standing(1002, "crate", "crate", [2., 0., -0.01], [0.4, 0.4, 0.3]),
        ];
        let pairs = [
            pair("on", "table", &[0.0]),
            pair("under", "table", &[0.6]),
            pair("near", "table", &[0.06]),
            pair("far", "crate", &[0.0]),
        ];
        tracks(&instances, "", &pairs.join(","))
    }

    #[test]
    fn places_by_hand() {
        let room = room();
        assert_eq!(holding(&room, Relation::On, &["table"]), ["on"]);
        assert_eq!(holding(&room, Relation::Under, &["table"]), ["under"]);
        assert_eq!(holding(&room, Relation::Beside, &["table"]), ["near"]); // `under` is 0.6 m away
        assert_eq!(holding(&room, Relation::In, &["crate"]), ["far"]);
        assert_eq!(holding(&room, Relation::Beside, &["crate"]), [""; 0]);
        assert_eq!(holding(&room, Relation::Touching, &["table"]), ["on"]);
        assert_eq!(holding(&room, Relation::Between, &["under", "far"]), ["near"]);
        assert_eq!(holding(&room, Relation::ClosestTo, &["far"]), ["near"]);
        assert_eq!(holding(&room, Relation::FarthestFrom, &["table"]), ["far"]);
    }

    /// A chair at the origin that faces -y, and dolls around it.
    fn around() -> Tracks {
        let size = [0.05, 0.05, 0.1];
        let instances = [
            standing(1, "before", "doll", [0.05, -0.2, 0.], size),
            standing(2, "back", "doll", [0.05, 0.2, 0.], size),
            standing(3, "side", "doll", [0.2, 0.02, 0.], size),
            standing(4, "too_far", "doll", [0.0, -0.9, 0.], size),
            standing(1001, "chair", "chair", [0., 0., 0.], [0.1, 0.1, 0.2]),
        ];
        tracks(&instances, "", "")
    }

    #[test]
    fn front_and_back_follow_the_axis() {
        let around = around();
        assert_eq!(holding(&around, Relation::InFrontOf, &["chair"]), ["before"]);
        assert_eq!(holding(&around, Relation::Behind, &["chair"]), ["back"]);
        // Facing -y, only the doll behind the chair looks at it.
        assert_eq!(holding(&around, Relation::Facing, &["chair"]), ["back"]);
    }

    #[test]
    fn superlatives_need_a_margin() {
        let instances = [
            standing(1, "big", "block", [0., 0., 0.], [0.2, 0.1, 0.1]),
            standing(2, "long", "block", [1., 0., 0.1], [0.1, 0.1, 0.15]),
            standing(3, "small", "block", [2., 0., 0.11], [0.1, 0.1, 0.1]),
        ];
        let tracks = tracks(&instances, "", "");
        let world = World::new(&tracks);
        let extremes = |which: Superlative| -> Vec<&str> {
            let found = world.objects().filter(|object| extreme(&world, object, which, "block").all());
            found.map(|object| object.name.as_str()).collect()
        };
        assert_eq!(extremes(Superlative::Largest), ["big"]);
        assert_eq!(extremes(Superlative::Smallest), ["small"]);
        assert_eq!(extremes(Superlative::Tallest), ["long"]);
        assert_eq!(extremes(Superlative::Lowest), ["big"]);
        assert!(extremes(Superlative::Highest).is_empty());
    }

    #[test]
    fn contact_has_hysteresis() {
        let instances = [
            standing(1, "a", "cup", [0., 0., 0.], [0.1; 3]),
            standing(2, "b", "cup", [1., 0., 0.], [0.1; 3]),
        ];
        let mut distances = [0.1; 97];
        distances[10..50].fill(0.015);
        distances[20] = 0.004;
        let tracks = tracks(&instances, "", &pair("a", "b", &distances));
        let world = World::new(&tracks);
        let [a, b] = ["a", "b"].map(|name| world.instance(name).unwrap());
        let contact: Times = contact(&world, Slack::Nominal, a, b);
        assert_eq!(contact.intervals(), [l4d_data::Interval::new(20, 49).unwrap()]);
    }
}
