//! What is demanded of the shipped set beyond its counts: `docs/queries.md`, The set.

use std::collections::BTreeSet;
use std::path::Path;

use l4d_data::{Benchmark, Category, Event, Interval, Name, Profile, Query, Report, Role, Temporal};
use l4d_query::eval::{answer_whole, clause_times};
use l4d_query::prove::SceneSet;
use l4d_query::times::any_of;
use l4d_query::verbs::{is_colour, is_state};
use l4d_query::{Clause, Predicate, World};

#[test]
fn the_shipped_set_is_as_hard_as_it_has_to_be() {
    let bench = Benchmark::open(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../benchmark")).unwrap();
    let mut report = Report::default();
    let scenes = bench.select(&[]).unwrap();
    let read = |scene| SceneSet::read(&bench, Profile::Small, scene, &mut report).unwrap();
    let sets: Vec<SceneSet> = scenes.iter().map(read).collect();

    let [mut beyond_colour, mut partial, mut mere_states] = [0; 3];
    for set in &sets {
        let world = World::new(&set.tracks);
        for query in &set.queries {
            let predicate = Predicate::from_json(query.predicate.as_ref().unwrap()).unwrap();
            match query.categories[..] {
                [Category::Attribute] => beyond_colour += usize::from(!is_plain_colour(&world, &predicate)),
                [Category::Action] => mere_states += usize::from(is_mere_state(&predicate)),
                _ => {}
            }
            if matches!(query.categories[..], [Category::Action | Category::Interaction]) {
                partial += usize::from(is_partial(&world, query, &predicate));
            }
        }
    }
    assert!(beyond_colour >= 40, "attribute queries beyond plain colour: {beyond_colour}");
    assert!(partial >= 60, "actions and interactions in part of the clip: {partial}");
    assert!(mere_states <= 6, "actions that are mere states: {mere_states}");
    let count = |test: fn(&SceneSet) -> bool| sets.iter().filter(|set| test(set)).count();
    assert_eq!(count(|set| !set.absents.is_empty()), sets.len(), "scenes with an absent sentence");
    assert!(count(has_twins) >= 14, "scenes with twins: {}", count(has_twins));
    assert!(count(has_role_change) >= 8, "scenes in which a role changes hands: {}", count(has_role_change));
}

/// A colour alone tells the referent, whatever else is said.
fn is_plain_colour(world: &World<'_>, predicate: &Predicate) -> bool {
    let names_colour = |clause: &&Clause| match clause {
        Clause::Attribute { key, value } => key.contains("colour") || value.split(['_', '-']).all(is_colour),
        _ => false,
    };
    predicate.discriminating().filter(names_colour).any(|clause| {
        let noun = Clause::Category(predicate.noun().to_owned());
        answer_whole(world, &Predicate(vec![noun, clause.clone()])).len() == 1
    })
}

/// What it speaks of happens only in a part of the clip.
fn is_partial(world: &World<'_>, query: &Query, predicate: &Predicate) -> bool {
    if query.temporal == Temporal::While {
        return query.frames != [Interval::WHOLE];
    }
    let happens = |clause: &&Clause| matches!(clause, Clause::Does { .. } | Clause::Undergoes { .. });
    let referents: Vec<_> = query.referents.iter().filter_map(|name| world.instance(name)).collect();
    predicate.discriminating().filter(|clause| !matches!(clause, Clause::Not(_))).any(|clause| {
        let inner = if happens(&clause) { std::slice::from_ref(clause) } else { clause.inner() };
        let times = |event: &Clause| any_of(referents.iter().map(|who| clause_times(world, event, who)));
        inner.iter().filter(happens).any(|event| times(event).any() && !times(event).all())
    })
}

/// All that it speaks of is standing, sitting and the like, or something that does not happen.
fn is_mere_state(predicate: &Predicate) -> bool {
    predicate.discriminating().all(|clause| match clause {
        Clause::Does { verb, .. } => is_state(verb),
        Clause::Not(_) => true,
        _ => false,
    })
}

/// Two objects of one category that look the same.
fn has_twins(set: &SceneSet) -> bool {
    let mut looks = BTreeSet::new();
    let mut objects = set.tracks.instances.iter().filter(|instance| instance.role == Role::Object);
    objects.any(|object| !looks.insert((&object.category, &object.attributes)))
}

/// Somebody stops doing (or having done to it) what another of its category begins later.
fn has_role_change(set: &SceneSet) -> bool {
    let category = |name: &Name| {
        let instance = set.tracks.instance(name);
        instance.filter(|found| found.role == Role::Object).map(|found| found.category.as_str())
    };
    let change = |earlier: &Name, later: &Name| {
        earlier != later && category(earlier).is_some() && category(earlier) == category(later)
    };
    let hands_over = |before: &Event, after: &Event| {
        let objects = before.object.as_ref().zip(after.object.as_ref());
        after.verb == before.verb
            && after.frames.first() > before.frames.last()
            && (change(&before.subject, &after.subject)
                || objects.is_some_and(|(earlier, later)| change(earlier, later)))
    };
    let events = || set.tracks.events.iter().filter(|event| !is_state(&event.verb));
    events().any(|before| events().any(|after| hands_over(before, after)))
}
