//! Who satisfies a predicate, and when.
//!
//! The meaning of clauses is written once, over a reading of the scene (`reading`); the public functions read it hard.

use std::collections::{BTreeMap, BTreeSet};

use l4d_data::Name;
use l4d_data::tracks::TrackedInstance;

use crate::ast::{Clause, Party, Predicate};
use crate::reading::{Degree, Happens, Member, Reading, Truth, any_of, is_any};
use crate::relations::{extreme, relation};
use crate::thresholds::LEAD_FRAMES;
use crate::times::{Times, all_of};
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
    members_in(world, party).iter().map(|(member, _)| *member).collect()
}

/// Whether the predicate names this instance over the whole clip.
pub fn identifies(world: &World<'_>, predicate: &Predicate, instance: &TrackedInstance) -> bool {
    fits(world, predicate, instance)
}

/// Whether a clause holds of an instance over the whole clip: an event at some time, a state all the time.
pub fn holds_over_clip(world: &World<'_>, clause: &Clause, instance: &TrackedInstance) -> bool {
    over_clip(world, clause, instance, &instance.category)
}

/// When a clause holds of an instance.
pub fn clause_times(world: &World<'_>, clause: &Clause, instance: &TrackedInstance) -> Times {
    truth(world, clause, instance, &instance.category)
}

/// Those whom a party means, with how sure that is.
fn members_in<'a, R: Reading<'a>>(reading: &R, party: &Party) -> std::rc::Rc<Vec<Member<'a, R::Degree>>> {
    reading.meant(party, || {
        let fit = |fit: &dyn Fn(&TrackedInstance) -> R::Degree| {
            let all = reading.world().instances().map(|instance| (instance, fit(instance)));
            all.filter(|(_, degree)| degree.is_possible()).collect()
        };
        match party {
            Party::Name(name) => reading.named(name),
            Party::Category(noun) => fit(&|instance| reading.is_a(instance, noun)),
            Party::Such(predicate) => fit(&|instance| fits(reading, predicate, instance)),
        }
    })
}

/// How well a predicate describes an instance over the whole clip.
pub(crate) fn fits<'a, R: Reading<'a>>(
    reading: &R,
    predicate: &Predicate,
    instance: &TrackedInstance,
) -> R::Degree {
    let noun = predicate.noun();
    predicate.0.iter().fold(R::Degree::TRUE, |held, clause| {
        held.and(|| reading.weigh(clause, over_clip(reading, clause, instance, noun)))
    })
}

/// Whether a clause holds over the whole clip of an instance among those of a noun.
pub(crate) fn over_clip<'a, R: Reading<'a>>(
    reading: &R,
    clause: &Clause,
    instance: &TrackedInstance,
    noun: &str,
) -> R::Degree {
    match clause {
        // "Never does" is the negation of "does at some time".
        Clause::Not(inner) if inner.is_event() => over_clip(reading, inner, instance, noun).not(),
        clause if clause.is_event() => truth(reading, clause, instance, noun).ever(),
        clause => truth(reading, clause, instance, noun).throughout(),
    }
}

/// When a clause holds of an instance among those of a noun.
pub(crate) fn truth<'a, R: Reading<'a>>(
    reading: &R,
    clause: &Clause,
    instance: &TrackedInstance,
    noun: &str,
) -> R::Truth {
    let of = |inner: &Clause| truth(reading, inner, instance, noun);
    let constant = R::Truth::constant;
    match clause {
        Clause::Category(noun) => constant(reading.is_a(instance, noun)),
        Clause::Attribute { key, value } => constant(reading.has(instance, key, value)),
        Clause::Does { .. } | Clause::Undergoes { .. } => any_of(events_of(reading, clause, instance)),
        Clause::Relation { kind, of } => {
            let mut parties = of.iter().map(|party| members_in(reading, party));
            let others = parties.next().unwrap_or_default();
            let second = parties.next().unwrap_or_default();
            relation(reading, instance, *kind, [&others, &second], noun)
        }
        Clause::Superlative(which) => extreme(reading, instance, *which, noun),
        Clause::Not(inner) => of(inner).not(),
        Clause::AtStart(inner) => constant(of(inner).at_start()),
        Clause::AtEnd(inner) => constant(of(inner).at_end()),
        Clause::First(inner) => constant(comes(reading, inner, instance, noun, Order::First)),
        Clause::Last(inner) => constant(comes(reading, inner, instance, noun, Order::Last)),
        Clause::Then(steps) => {
            let [before, after] = [0, 1].map(|step| events_of(reading, &steps[step], instance));
            let (lead, jitter) = (reading.slack().at_least(LEAD_FRAMES), reading.jitter_frames());
            let follows = |a: &R::Truth, b: &R::Truth| {
                let both = a.ever().and(|| b.ever());
                both.and(|| a.leads(b, lead, jitter)).and(|| b.outlasts(a, jitter))
            };
            constant(is_any(before.iter().flat_map(|a| after.iter().map(move |b| follows(a, b)))))
        }
    }
}

/// The events that a `does` or `undergoes` clause speaks of.
fn events_of<'a, R: Reading<'a>>(reading: &R, clause: &Clause, instance: &TrackedInstance) -> Vec<R::Truth> {
    let (wanted, other) = match clause {
        Clause::Does { verb, to } => (verb, to.as_ref()),
        Clause::Undergoes { verb, by } => (verb, Some(by)),
        _ => return Vec::new(),
    };
    let passive = matches!(clause, Clause::Undergoes { .. });
    let mut events = reading.events().iter().filter(|event| {
        let own = if passive { event.object() } else { Some(event.subject()) };
        event.verb() == wanted && own == Some(&instance.name)
    });
    let Some(party) = other else { return events.map(R::Event::times).collect() };
    // Describing the other one is the expensive part: only who takes part at all is asked about.
    let Some(first) = events.next() else { return Vec::new() };
    let members = members_in(reading, party);
    let with_meant = |event: &R::Event| {
        let name = if passive { Some(event.subject()) } else { event.object() };
        let (_, degree) = members.iter().find(|(member, _)| Some(&member.name) == name)?;
        Some(event.times().and(R::Truth::constant(*degree)))
    };
    std::iter::once(first).chain(events).filter_map(with_meant).collect()
}

/// Who comes first or last.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Order {
    First,
    Last,
}

/// Whether the first event of this instance starts before or after that of all others of its noun.
fn comes<'a, R: Reading<'a>>(
    reading: &R,
    clause: &Clause,
    instance: &TrackedInstance,
    noun: &str,
    order: Order,
) -> R::Degree {
    let happens = |of: &TrackedInstance| any_of(events_of(reading, clause, of));
    let own = happens(instance);
    let (lead, jitter) = (reading.slack().at_least(LEAD_FRAMES), reading.jitter_frames());
    reading.world().instances().fold(own.ever(), |so_far, other| {
        let is_beaten = || {
            let theirs = happens(other);
            theirs.ever().and(|| {
                let (early, late) = if order == Order::First { (&own, &theirs) } else { (&theirs, &own) };
                early.leads(late, lead, jitter).not()
            })
        };
        so_far.and(|| reading.is_rival(instance, other, noun).and(is_beaten).not())
    })
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
