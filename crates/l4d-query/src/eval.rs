//! Who satisfies a predicate, at a frame or over the whole clip.

use std::collections::BTreeSet;

use l4d_data::Name;
use l4d_data::timeline::FRAME_COUNT;
use l4d_data::tracks::TrackedInstance;

use crate::ast::{Clause, Party, Predicate};
use crate::world::World;

/// A set of instances.
pub type Answer = BTreeSet<Name>;

/// Objects that satisfy all clauses at a canonical frame.
pub fn answer_at(world: &World<'_>, predicate: &Predicate, frame: u32) -> Answer {
    select(world, |object| predicate.0.iter().all(|clause| holds(world, clause, object, frame)))
}

/// Objects that the predicate identifies over the whole clip: what it says of events happens at some time, what it
/// says of states holds all the time.
pub fn answer_whole(world: &World<'_>, predicate: &Predicate) -> Answer {
    select(world, |object| predicate.0.iter().all(|clause| holds_over_clip(world, clause, object)))
}

fn select(world: &World<'_>, test: impl Fn(&TrackedInstance) -> bool) -> Answer {
    world.objects().filter(|object| test(object)).map(|object| object.name.clone()).collect()
}

fn holds_over_clip(world: &World<'_>, clause: &Clause, object: &TrackedInstance) -> bool {
    match clause {
        // "never does" is the negation of "does at some time".
        Clause::Not(inner) if inner.is_event() => !holds_over_clip(world, inner, object),
        clause if clause.is_event() => (0..FRAME_COUNT).any(|frame| holds(world, clause, object, frame)),
        clause => (0..FRAME_COUNT).all(|frame| holds(world, clause, object, frame)),
    }
}

fn holds(world: &World<'_>, clause: &Clause, object: &TrackedInstance, frame: u32) -> bool {
    let own = || Party::Name(object.name.clone());
    match clause {
        Clause::Category(noun) => object.category == *noun,
        Clause::Attribute { key, value } => object.attributes.get(key) == Some(value),
        Clause::Does { verb, to } => world.happens(&own(), verb, to.as_ref(), frame),
        Clause::Undergoes { verb, by } => world.happens(by, verb, Some(&own()), frame),
        Clause::Relation { kind, of } => {
            let others: Option<Vec<_>> = of.iter().map(|name| world.instance(name)).collect();
            others.is_some_and(|others| world.related(object, *kind, &others, frame))
        }
        Clause::Not(inner) => !holds(world, inner, object, frame),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::tests::{standing, tracks};

    fn names(answer: &Answer) -> Vec<&str> {
        answer.iter().map(Name::as_str).collect()
    }

    #[test]
    fn events_count_once_states_count_always() {
        let instances = [
            standing(1, "a", "cup", [0., 0., 0.], [0.1; 3]),
            standing(2, "b", "cup", [1., 0., 0.], [0.1; 3]),
            standing(1001, "hand", "hand", [0., 0., 0.], [0.1; 3]),
        ];
        let events = r#"{"subject":"hand","verb":"lift","object":"a","frames":[10,30]},{"subject":"b","verb":"roll","object":null,"frames":[0,96]}"#;
        let tracks = tracks(&instances, events, "");
        let world = World::new(&tracks);
        let parse = |text: &str| Predicate::from_json(&serde_json::from_str(text).unwrap()).unwrap();
        let lifted = parse(r#"[{"category":"cup"},{"undergoes":{"verb":"lift","by":{"category":"hand"}}}]"#);
        assert_eq!(names(&answer_whole(&world, &lifted)), ["a"]);
        assert_eq!(names(&answer_at(&world, &lifted, 30)), ["a"]);
        assert!(answer_at(&world, &lifted, 31).is_empty());
        let never =
            parse(r#"[{"category":"cup"},{"not":{"undergoes":{"verb":"lift","by":{"category":"hand"}}}}]"#);
        assert_eq!(names(&answer_whole(&world, &never)), ["b"]);
        assert_eq!(names(&answer_at(&world, &never, 31)), ["a", "b"]);
        let grey = parse(r#"[{"category":"cup"},{"attribute":{"key":"colour","value":"grey"}}]"#);
        assert_eq!(names(&answer_whole(&world, &grey)), ["a", "b"]);
    }
}
