//! Who satisfies a predicate, and when.

use std::collections::{BTreeMap, BTreeSet};

use l4d_data::tracks::TrackedInstance;
use l4d_data::{Event, Name};

use crate::ast::{Clause, Party, Predicate};
use crate::relations::{is_extreme, related};
use crate::thresholds::LEAD_FRAMES;
use crate::times::{Times, all_of, any_of};
use crate::world::World;

/// A set of instances.
pub type Answer = BTreeSet<Name>;

/// Objects that satisfy all clauses at a canonical frame.
pub fn answer_at(world: &World<'_>, predicate: &Predicate, frame: u32) -> Answer {
    let times = answer_times(world, predicate).into_iter();
    times.filter(|(_, times)| times.at(frame)).map(|(name, _)| name).collect()
}

/// Objects that the predicate identifies over the whole clip: what it says of events happens at some time, what it
/// says of states holds all the time.
pub fn answer_whole(world: &World<'_>, predicate: &Predicate) -> Answer {
    let identified = world.objects().filter(|object| identifies(world, predicate, object));
    identified.map(|object| object.name.clone()).collect()
}

/// When each object satisfies all clauses at once; those that never do are left out.
pub fn answer_times(world: &World<'_>, predicate: &Predicate) -> BTreeMap<Name, Times> {
    let times = |object: &TrackedInstance| {
        all_of(predicate.0.iter().map(|clause| clause_times(world, clause, object)))
    };
    let all = world.objects().filter(|object| object.category == predicate.noun());
    all.map(|object| (object.name.clone(), times(object))).filter(|(_, times)| times.any()).collect()
}

/// The instances that a party means.
pub fn members<'a>(world: &World<'a>, party: &Party) -> Vec<&'a TrackedInstance> {
    match party {
        Party::Name(name) => world.instance(name).into_iter().collect(),
        Party::Category(noun) => world.instances().filter(|instance| instance.category == *noun).collect(),
        Party::Such(predicate) => {
            world.instances().filter(|instance| identifies(world, predicate, instance)).collect()
        }
    }
}

/// Whether the predicate names this instance over the whole clip.
pub fn identifies(world: &World<'_>, predicate: &Predicate, instance: &TrackedInstance) -> bool {
    predicate.0.iter().all(|clause| holds_over_clip(world, clause, instance))
}

/// Whether a clause holds of an instance over the whole clip: an event at some time, a state all the time.
pub fn holds_over_clip(world: &World<'_>, clause: &Clause, instance: &TrackedInstance) -> bool {
    match clause {
        // "Never does" is the negation of "does at some time".
        Clause::Not(inner) if inner.is_event() => !holds_over_clip(world, inner, instance),
        clause if clause.is_event() => clause_times(world, clause, instance).any(),
        clause => clause_times(world, clause, instance).all(),
    }
}

/// When a clause holds of an instance.
pub fn clause_times(world: &World<'_>, clause: &Clause, instance: &TrackedInstance) -> Times {
    match clause {
        Clause::Category(noun) => Times::constant(instance.category == *noun),
        Clause::Attribute { key, value } => Times::constant(instance.attributes.get(key) == Some(value)),
        Clause::Does { .. } | Clause::Undergoes { .. } => {
            any_of(events_of(world, clause, instance).iter().map(|event| Times::of(event.frames)))
        }
        Clause::Relation { kind, of } => {
            let mut parties = of.iter().map(|party| members(world, party));
            let others = parties.next().unwrap_or_default();
            let second = parties.next().unwrap_or_default();
            related(world, instance, *kind, &others, &second)
        }
        Clause::Superlative(extreme) => is_extreme(world, instance, *extreme),
        Clause::Not(inner) => clause_times(world, inner, instance).complement(),
        Clause::AtStart(inner) => Times::constant(clause_times(world, inner, instance).at(0)),
        Clause::AtEnd(inner) => {
            Times::constant(clause_times(world, inner, instance).at(l4d_data::timeline::LAST_FRAME))
        }
        Clause::First(inner) => Times::constant(leads(world, inner, instance, 1.0)),
        Clause::Last(inner) => Times::constant(leads(world, inner, instance, -1.0)),
        Clause::Then(steps) => {
            let [before, after] = [0, 1].map(|step| events_of(world, &steps[step], instance));
            let lead = world.slack().at_least(LEAD_FRAMES);
            let follows = |a: &&Event, b: &&Event| {
                f64::from(b.frames.first()) >= f64::from(a.frames.first()) + lead
                    && b.frames.last() > a.frames.last()
            };
            Times::constant(before.iter().any(|a| after.iter().any(|b| follows(a, b))))
        }
    }
}

/// The events that a `does` or `undergoes` clause speaks of.
fn events_of<'a>(world: &World<'a>, clause: &Clause, instance: &TrackedInstance) -> Vec<&'a Event> {
    let (wanted, other) = match clause {
        Clause::Does { verb, to } => (verb, to.as_ref()),
        Clause::Undergoes { verb, by } => (verb, Some(by)),
        _ => return Vec::new(),
    };
    let passive = matches!(clause, Clause::Undergoes { .. });
    let mut events: Vec<&Event> = world.events().filter(|event| event.verb == *wanted).collect();
    events.retain(|event| {
        let own = if passive { event.object.as_ref() } else { Some(&event.subject) };
        own == Some(&instance.name)
    });
    // Describing the other one is the expensive part: only who takes part at all is asked about.
    if let (Some(party), false) = (other, events.is_empty()) {
        let others: BTreeSet<&Name> = members(world, party).into_iter().map(|member| &member.name).collect();
        events.retain(|event| {
            let other = if passive { Some(&event.subject) } else { event.object.as_ref() };
            other.is_some_and(|name| others.contains(name))
        });
    }
    events
}

/// Whether the first event of this instance starts before (`sign` 1) or after (-1) that of all others of its category.
fn leads(world: &World<'_>, clause: &Clause, instance: &TrackedInstance, sign: f64) -> bool {
    let start = |of: &TrackedInstance| {
        let events = events_of(world, clause, of);
        events.iter().map(|event| f64::from(event.frames.first())).min_by(f64::total_cmp)
    };
    let Some(own) = start(instance) else { return false };
    let lead = world.slack().at_least(LEAD_FRAMES);
    let rivals =
        world.instances().filter(|other| other.category == instance.category && other.name != instance.name);
    rivals.filter_map(start).all(|other| sign * (other - own) >= lead)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{cup, event, moving, standing, tracks};
    use l4d_data::Interval;
    use l4d_data::tracks::Tracks;

    fn names(answer: &Answer) -> Vec<&str> {
        answer.iter().map(Name::as_str).collect()
    }

    /// Three cups: the left hand lifts a, then b; the right hand lifts c and waves; b rolls first.
    fn scene() -> Tracks {
        let path: Vec<[f64; 3]> = (0..97).map(|frame| [2.0, 0.0, f64::from(frame) / 96.0]).collect();
        let instances = [
            standing(1, "a", "cup", [0., 0., 0.], [0.1; 3]),
            standing(2, "b", "cup", [1., 0., 0.], [0.1; 3]),
            moving(3, "c", "cup", &path, [0.1; 3]),
            standing(1001, "left", "hand", [0., 0., 0.], [0.1; 3]),
            standing(1002, "right", "hand", [0., 0., 0.], [0.1; 3]),
        ];
        let events = [
            event("left", "lift", Some("a"), [10, 30]),
            event("left", "lift", Some("b"), [50, 70]),
            event("right", "lift", Some("c"), [50, 70]),
            event("right", "wave", None, [80, 96]),
            event("b", "roll", None, [0, 20]),
            event("c", "roll", None, [60, 80]),
        ];
        tracks(&instances, &events.join(","), "")
    }

    #[test]
    fn events_count_once_states_count_always() {
        let tracks = scene();
        let world = World::new(&tracks);
        let whole = |clauses: &str| answer_whole(&world, &cup(clauses));
        let lifted = r#"{"undergoes":{"verb":"lift","by":{"name":"left"}}}"#;
        assert_eq!(names(&whole(lifted)), ["a", "b"]);
        assert_eq!(names(&answer_at(&world, &cup(lifted), 30)), ["a"]);
        assert!(answer_at(&world, &cup(lifted), 31).is_empty());
        let never = format!(r#"{{"not":{lifted}}}"#);
        assert_eq!(names(&whole(&never)), ["c"]);
        assert_eq!(names(&answer_at(&world, &cup(&never), 31)), ["a", "b", "c"]);
        assert_eq!(names(&whole(r#"{"attribute":{"key":"colour","value":"grey"}}"#)), ["a", "b", "c"]);
        // c rises from the floor: it is not the highest all the time, but at the end.
        assert!(whole(r#"{"superlative":"highest"}"#).is_empty());
        assert_eq!(names(&whole(r#"{"at_end":{"superlative":"highest"}}"#)), ["c"]);
        let from = answer_times(&world, &cup(r#"{"superlative":"highest"}"#));
        assert_eq!(from.values().next().unwrap().intervals(), [Interval::new(3, 96).unwrap()]);
    }

    #[test]
    fn order_in_time() {
        let tracks = scene();
        let world = World::new(&tracks);
        let whole = |clauses: &str| answer_whole(&world, &cup(clauses));
        assert_eq!(names(&whole(r#"{"first":{"does":{"verb":"roll"}}}"#)), ["b"]);
        assert_eq!(names(&whole(r#"{"last":{"does":{"verb":"roll"}}}"#)), ["c"]);
        let hand = r#"{"undergoes":{"verb":"lift","by":{"category":"hand"}}}"#;
        assert_eq!(names(&whole(&format!(r#"{{"first":{hand}}}"#))), ["a"]);
        assert!(whole(&format!(r#"{{"last":{hand}}}"#)).is_empty(), "b and c begin together");
        assert_eq!(names(&whole(&format!(r#"{{"then":[{{"does":{{"verb":"roll"}}}},{hand}]}}"#))), ["b"]);
        assert_eq!(names(&whole(&format!(r#"{{"then":[{hand},{{"does":{{"verb":"roll"}}}}]}}"#))), ["c"]);
    }

    #[test]
    fn parties_are_described_over_the_whole_clip() {
        let tracks = scene();
        let world = World::new(&tracks);
        // The hand waves at 80, long after it has lifted.
        let waving =
            r#"{"undergoes":{"verb":"lift","by":{"such":[{"category":"hand"},{"does":{"verb":"wave"}}]}}}"#;
        assert_eq!(names(&answer_whole(&world, &cup(waving))), ["c"]);
        assert_eq!(names(&answer_at(&world, &cup(waving), 55)), ["c"]);
    }
}
