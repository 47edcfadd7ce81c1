//! What each relation and superlative means, decided from oriented boxes, exact mesh distances and contact.
//!
//! `docs/queries.md` states the same definitions in words; the numbers are in `thresholds`. "In plan" means seen
//! from above.

use l4d_data::tracks::TrackedInstance;

use crate::ast::{Relation, Superlative};
use crate::obb::Obb;
use crate::thresholds::{
    BETWEEN_MARGIN, BETWEEN_OFFSET, CONE_DEG, DISTANCE_MARGIN, FACING_DEG, HEIGHT_MARGIN, ON_HEIGHT_SHARE,
    Slack, UNDER_HEIGHT_SHARE, VOLUME_MARGIN, before_m, beside_m, higher_m,
};
use crate::times::{Times, any_of};
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
    let is_other = |other: &&&TrackedInstance| other.name != subject.name;
    match kind {
        Relation::ClosestTo => when(world, |now| now.beats_rivals(subject, others, true)),
        Relation::FarthestFrom => when(world, |now| now.beats_rivals(subject, others, false)),
        Relation::Between => any_of(others.iter().filter(is_other).flat_map(|first| {
            let rest = second.iter().filter(is_other).filter(|other| other.name != first.name);
            rest.map(|other| when(world, |now| now.is_between(subject, first, other)))
        })),
        _ => any_of(others.iter().filter(is_other).map(|other| related_to(world, subject, kind, other))),
    }
}

fn related_to(
    world: &World<'_>,
    subject: &TrackedInstance,
    kind: Relation,
    other: &TrackedInstance,
) -> Times {
    match kind {
        Relation::Touching => world.contact(subject, other),
        Relation::On => world.contact(subject, other) & when(world, |now| now.rises_from(subject, other)),
        Relation::In => world.contact(subject, other) & when(world, |now| now.is_inside(subject, other)),
        Relation::Under => when(world, |now| now.is_under(subject, other)),
        Relation::Beside => {
            let opposite = world.with_slack(world.slack().opposite());
            let elsewhere = [Relation::On, Relation::In];
            let elsewhere = any_of(elsewhere.map(|kind| related_to(&opposite, subject, kind, other)));
            let reach = world.slack().at_most(beside_m(world.scale()));
            elsewhere.complement() & Times::when(|frame| world.distance_m(subject, other, frame) <= reach)
        }
        Relation::InFrontOf => when(world, |now| now.is_before(subject, other, 1.0)),
        Relation::Behind => when(world, |now| now.is_before(subject, other, -1.0)),
        Relation::Facing => when(world, |now| now.is_facing(subject, other)),
        Relation::Between | Relation::ClosestTo | Relation::FarthestFrom => Times::NEVER,
    }
}

/// When `subject` is the extreme of its category among the objects.
pub fn is_extreme(world: &World<'_>, subject: &TrackedInstance, extreme: Superlative) -> Times {
    let rivals: Vec<_> = rivals(world, subject).collect();
    let slack = world.slack();
    let beats = |measure: fn(&Obb) -> f64, margin: f64, sign: f64| {
        let own = world.median(subject, measure);
        let beaten = |rival: &&TrackedInstance| {
            let (own, other) = (own.powf(sign), world.median(rival, measure).powf(sign));
            own >= other * slack.at_least(margin)
        };
        Times::constant(rivals.iter().all(beaten))
    };
    let is_above = |sign: f64| {
        let lead = slack.at_least(higher_m(world.scale()));
        Times::when(|frame| {
            let own = world.obb(subject, frame).centre.z;
            rivals.iter().all(|rival| sign * (own - world.obb(rival, frame).centre.z) >= lead)
        })
    };
    match extreme {
        Superlative::Largest => beats(Obb::volume, VOLUME_MARGIN, 1.0),
        Superlative::Smallest => beats(Obb::volume, VOLUME_MARGIN, -1.0),
        Superlative::Tallest => beats(Obb::height, HEIGHT_MARGIN, 1.0),
        Superlative::Highest => is_above(1.0),
        Superlative::Lowest => is_above(-1.0),
    }
}

fn rivals<'a>(
    world: &World<'a>,
    subject: &TrackedInstance,
) -> impl Iterator<Item = &'a TrackedInstance> + use<'a> {
    let (category, name) = (subject.category.clone(), subject.name.clone());
    world.objects().filter(move |rival| rival.category == category && rival.name != name)
}

/// A world at a frame.
struct Moment<'w, 'a> {
    world: &'w World<'a>,
    slack: Slack,
    frame: u32,
}

fn when(world: &World<'_>, test: impl Fn(Moment<'_, '_>) -> bool) -> Times {
    Times::when(|frame| test(Moment { world, slack: world.slack(), frame }))
}

impl Moment<'_, '_> {
    fn obb(&self, instance: &TrackedInstance) -> &Obb {
        self.world.obb(instance, self.frame)
    }

    fn rises_from(&self, subject: &TrackedInstance, other: &TrackedInstance) -> bool {
        let (above, below) = (self.obb(subject), self.obb(other));
        below.footprint_contains(above.centre.truncate(), self.slack.at_most(1.0))
            && above.centre.z >= below.bottom() + self.slack.at_least(ON_HEIGHT_SHARE) * below.height()
            && above.rounded().0 > below.bottom()
    }

    fn is_inside(&self, subject: &TrackedInstance, other: &TrackedInstance) -> bool {
        let (inner, outer) = (self.obb(subject), self.obb(other));
        outer.contains(inner.centre, self.slack.at_most(1.0)) && inner.rounded().0 > outer.bottom()
    }

    fn is_under(&self, subject: &TrackedInstance, other: &TrackedInstance) -> bool {
        let (below, above) = (self.obb(subject), self.obb(other));
        let (bottom, top) = below.rounded();
        above.footprint_contains(below.centre.truncate(), self.slack.at_most(1.0))
            && top <= above.top()
            && bottom <= above.bottom() + self.slack.at_most(UNDER_HEIGHT_SHARE) * above.height()
            && below.centre.z < above.centre.z
    }

    fn is_between(&self, subject: &TrackedInstance, a: &TrackedInstance, b: &TrackedInstance) -> bool {
        let [start, end, point] = [a, b, subject].map(|instance| self.obb(instance).centre.truncate());
        let along = end - start;
        let length = along.length();
        if length < NEAREST_M {
            return false;
        }
        let share = (point - start).dot(along) / (length * length);
        let offset = (point - start - along * share).length();
        share.min(1.0 - share) >= self.slack.at_least(BETWEEN_MARGIN)
            && offset <= self.slack.at_most(BETWEEN_OFFSET) * length
    }

    /// Distance to the nearest of `others` that is not `subject`.
    fn nearest_m(&self, subject: &TrackedInstance, others: &[&TrackedInstance]) -> Option<f64> {
        let others = others.iter().filter(|other| other.name != subject.name);
        others.map(|other| self.world.distance_m(subject, other, self.frame)).min_by(f64::total_cmp)
    }

    /// Whether `subject` is closer to the nearest of `others`, or farther from it, than all it is compared with: its
    /// category without itself and without the one that distances are taken to.
    fn beats_rivals(&self, subject: &TrackedInstance, others: &[&TrackedInstance], closer: bool) -> bool {
        let Some(own) = self.nearest_m(subject, others) else { return false };
        let margin = self.slack.at_least(DISTANCE_MARGIN);
        let is_rival = |rival: &&TrackedInstance| !matches!(others, [only] if only.name == rival.name);
        rivals(self.world, subject).filter(is_rival).all(|rival| {
            let Some(other) = self.nearest_m(rival, others) else { return true };
            let (near, far) = if closer { (own, other) } else { (other, own) };
            far >= near.max(NEAREST_M) * margin
        })
    }

    /// Whether `subject` is in the cone that opens from the centre of `other` to its front (`sign` 1) or back (-1).
    fn is_before(&self, subject: &TrackedInstance, other: &TrackedInstance, sign: f64) -> bool {
        let angle = self.front_angle_deg(other, subject, sign);
        angle.is_some_and(|angle| angle <= self.slack.at_most(CONE_DEG))
            && self.world.distance_m(subject, other, self.frame)
                <= self.slack.at_most(before_m(self.world.scale()))
    }

    fn is_facing(&self, subject: &TrackedInstance, other: &TrackedInstance) -> bool {
        let angle = self.front_angle_deg(subject, other, 1.0);
        angle.is_some_and(|angle| angle <= self.slack.at_most(FACING_DEG))
    }

    /// Angle in plan between the front of `viewer` (times `sign`) and the direction to the centre of `target`, degrees.
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
        let extreme = |which: Superlative| -> Vec<&str> {
            let found = world.objects().filter(|object| is_extreme(&world, object, which).all());
            found.map(|object| object.name.as_str()).collect()
        };
        assert_eq!(extreme(Superlative::Largest), ["big"]);
        assert_eq!(extreme(Superlative::Smallest), ["small"]);
        assert_eq!(extreme(Superlative::Tallest), ["long"]);
        assert_eq!(extreme(Superlative::Lowest), ["big"]);
        assert!(extreme(Superlative::Highest).is_empty());
    }
}
