//! The clauses that may tell the members of a group apart, each with what it says and how natural it is.

use std::collections::BTreeSet;

use l4d_data::tracks::TrackedInstance;
use l4d_data::{Category, Event, Name};
use l4d_query::eval::clause_times;
use l4d_query::prove::Prover;
use l4d_query::{Clause, Party, Relation, Superlative, World, verbs};

use crate::facts::Group;
use crate::parties::{Somebody, is_upright};

/// A place is rarely told by something that goes about.
const RESTLESS: f64 = 0.5;
/// A plain clause that holds of no one: as good as two that hold of different ones.
const STRANGE: f64 = 2.0;

/// A clause that may discriminate.
#[derive(Debug, Clone)]
pub(crate) struct Atom {
    pub(crate) clause: Clause,
    pub(crate) category: Category,
    /// Its form, so that a set can have many: `at_end relation on`.
    pub(crate) shape: String,
    /// What it is about, however it is wrapped and others are described: `on tray`.
    pub(crate) core: String,
    /// How long or strange a sentence gets; the plainest clauses cost 1.
    pub(crate) price: f64,
}

/// A family of clauses: something that may hold, and how it may be bound to time.
struct Base {
    clause: Clause,
    shape: String,
    core: String,
    price: f64,
}

/// Whether no event of this verb in the scene has a second role.
pub(crate) fn is_intransitive(world: &World<'_>, verb: &str) -> bool {
    world.events().filter(|event| event.verb == verb).all(|event| event.object.is_none())
}

/// All clauses that may tell members of the group apart.
pub(crate) fn atoms(prover: &Prover<'_>, group: &Group<'_>, everybody: &[Somebody]) -> Vec<Atom> {
    let world = prover.world();
    let mut found = attributes(group);
    found.extend(extremes(group, world));
    for base in
        relations(world, group, everybody).into_iter().filter(|base| varies(world, group, &base.clause))
    {
        found.extend(wrapped_state(&base));
    }
    let events = events(world, group, everybody);
    for base in &events {
        found.extend(wrapped_event(base));
    }
    found.extend(sequences(world, group, &events));
    found
}

fn atom(clause: Clause, shape: impl Into<String>, core: impl Into<String>, price: f64) -> Option<Atom> {
    let category = clause.category()?;
    Some(Atom { clause, category, shape: shape.into(), core: core.into(), price })
}

fn attributes(group: &Group<'_>) -> Vec<Atom> {
    let mut seen = BTreeSet::new();
    let all = group.members.iter().flat_map(|member| &member.attributes);
    all.filter(|pair| seen.insert(*pair))
        .flat_map(|(key, value)| {
            let clause = Clause::Attribute { key: key.clone(), value: value.clone() };
            let core = key.clone();
            let not = Clause::Not(Box::new(clause.clone()));
            [atom(clause, format!("attribute {key}"), &core, 1.0), atom(not, "not attribute", &core, 2.4)]
        })
        .flatten()
        .collect()
}

fn extremes(group: &Group<'_>, world: &World<'_>) -> Vec<Atom> {
    let all = [
        (Superlative::Largest, 1.1),
        (Superlative::Smallest, 1.1),
        (Superlative::Tallest, 1.1),
        (Superlative::Highest, 1.2),
        (Superlative::Lowest, 1.2),
    ];
    let bases = all.map(|(extreme, price)| {
        let clause = Clause::Superlative(extreme);
        let core = match extreme {
            Superlative::Largest | Superlative::Smallest => "size".to_owned(),
            other => other.to_string(),
        };
        Base { clause, shape: format!("superlative {extreme}"), core, price }
    });
    let fits = |base: &&Base| {
        let is_height = base.clause == Clause::Superlative(Superlative::Tallest);
        (!is_height || group.members.iter().all(|member| is_upright(member)))
            && varies(world, group, &base.clause)
    };
    bases.iter().filter(fits).flat_map(wrapped_state).collect()
}

/// Whether a clause holds differently of different members, or at different times.
fn varies(world: &World<'_>, group: &Group<'_>, clause: &Clause) -> bool {
    let mut times = group.members.iter().map(|member| clause_times(world, clause, member));
    let Some(first) = times.next() else { return false };
    (first.any() && !first.all()) || times.any(|other| other != first)
}

fn relations(world: &World<'_>, group: &Group<'_>, everybody: &[Somebody]) -> Vec<Base> {
    let have_fronts = group.members.iter().all(|member| member.front.is_some());
    let mut found = Vec::new();
    for kind in Relation::ALL.into_iter().filter(|kind| *kind != Relation::Between) {
        for other in everybody {
            let others_have_fronts = other
                .meant
                .iter()
                .all(|name| world.instance(name).is_some_and(|instance| instance.front.is_some()));
            let fits = match kind {
                Relation::InFrontOf | Relation::Behind => others_have_fronts && other.only().is_some(),
                // What somebody carries or lifts is held by them, not on them.
                Relation::On => !world.events().any(|event| {
                    other.meant.contains(&event.subject)
                        && event
                            .object
                            .as_ref()
                            .is_some_and(|object| group.members.iter().any(|member| member.name == *object))
                }),
                // What acts has no inside: boxes of bodies overlap, and a hand hovers.
                Relation::In | Relation::Under => {
                    !world.events().any(|event| other.meant.contains(&event.subject))
                }
                Relation::Facing => have_fronts && other.only().is_some(),
                Relation::ClosestTo | Relation::FarthestFrom => other.only().is_some(),
                _ => true,
            };
            if fits {
                let clause = Clause::Relation { kind, of: vec![other.party.clone()] };
                let core = format!("{kind} {}", meant(other));
                let price = relation_price(kind) + other.price + if other.moves { RESTLESS } else { 0.0 };
                found.push(Base { clause, shape: format!("relation {kind}"), core, price });
            }
        }
    }
    let kind = Relation::Between;
    let single: Vec<&Somebody> = cheapest_of_each(everybody);
    for (place, first) in single.iter().enumerate() {
        for second in &single[place + 1..] {
            let clause = Clause::Relation { kind, of: vec![first.party.clone(), second.party.clone()] };
            let core = format!("{kind} {} {}", meant(first), meant(second));
            let restless = f64::from(u8::from(first.moves) + u8::from(second.moves));
            let price = relation_price(kind) + first.price + second.price + RESTLESS * restless;
            found.push(Base { clause, shape: format!("relation {kind}"), core, price });
        }
    }
    found
}

/// The cheapest description of each instance that can be described.
fn cheapest_of_each(everybody: &[Somebody]) -> Vec<&Somebody> {
    let mut seen = BTreeSet::new();
    let single = everybody.iter().filter_map(|one| Some((one, one.only()?)));
    single.filter(|(_, name)| seen.insert(*name)).map(|(one, _)| one).collect()
}

fn meant(somebody: &Somebody) -> String {
    match &somebody.party {
        Party::Category(noun) => format!("any {noun}"),
        _ => somebody.only().map_or_else(String::new, ToString::to_string),
    }
}

const fn relation_price(kind: Relation) -> f64 {
    match kind {
        Relation::On | Relation::In => 1.0,
        Relation::Under | Relation::Beside => 1.1,
        Relation::ClosestTo | Relation::InFrontOf | Relation::Behind => 1.2,
        Relation::FarthestFrom => 1.4,
        Relation::Between | Relation::Facing => 1.5,
        Relation::Touching => 1.7,
    }
}

/// What can change: as it is, at either end of the clip, and denied.
fn wrapped_state(base: &Base) -> Vec<Atom> {
    let Base { clause, shape, core, price } = base;
    let inner = || Box::new(clause.clone());
    let not = || Box::new(Clause::Not(inner()));
    let mut found = vec![atom(clause.clone(), shape, core, *price)];
    if clause.is_constant() {
        return found.into_iter().flatten().collect();
    }
    found.push(atom(Clause::AtEnd(inner()), format!("at_end {shape}"), core, price + 0.3));
    found.push(atom(Clause::AtStart(inner()), format!("at_start {shape}"), core, price + 0.3));
    if matches!(clause, Clause::Relation { .. }) {
        found.push(atom(*not(), format!("not {shape}"), core, price + 1.1));
        found.push(atom(Clause::AtEnd(not()), format!("at_end not {shape}"), core, price + 1.3));
        found.push(atom(Clause::AtStart(not()), format!("at_start not {shape}"), core, price + 1.3));
    }
    found.into_iter().flatten().collect()
}

/// What members of the group do, and what is done to them.
fn events(world: &World<'_>, group: &Group<'_>, everybody: &[Somebody]) -> Vec<Base> {
    let mut found: Vec<Base> = Vec::new();
    let mut seen = BTreeSet::new();
    let is_member =
        |instance: &TrackedInstance| group.members.iter().any(|member| member.name == instance.name);
    let takes_part = |name: &Name| world.instance(name).is_some_and(is_member);
    for event in world.events() {
        let Event { subject, verb, object, .. } = event;
        let idle = if verbs::is_state(verb) { 0.6 } else { 0.0 };
        if takes_part(subject) {
            if is_intransitive(world, verb) {
                let clause = Clause::Does { verb: verb.clone(), to: None };
                let core = format!("does {verb}");
                found.push(Base { clause, shape: "does".to_owned(), core, price: 1.0 + idle });
            }
            for other in
                everybody.iter().filter(|other| object.as_ref().is_some_and(|o| other.meant.contains(o)))
            {
                let clause = Clause::Does { verb: verb.clone(), to: Some(other.party.clone()) };
                let (shape, core) = ("does to".to_owned(), format!("does {verb} to"));
                found.push(Base { clause, shape, core, price: 1.1 + idle + other.price });
            }
        }
        if object.as_ref().is_some_and(takes_part) {
            for other in everybody.iter().filter(|other| other.meant.contains(subject)) {
                let clause = Clause::Undergoes { verb: verb.clone(), by: other.party.clone() };
                let (shape, core) = ("undergoes".to_owned(), format!("undergoes {verb}"));
                found.push(Base { clause, shape, core, price: 1.1 + idle + other.price });
            }
        }
    }
    found.retain(|base| seen.insert(base.clause.to_string()));
    found
}

/// What happens: at some time, never, first, last, and at either end of the clip.
fn wrapped_event(base: &Base) -> Vec<Atom> {
    let Base { clause, shape, core, price } = base;
    let inner = || Box::new(clause.clone());
    let wrapped = [
        atom(clause.clone(), shape, core, *price),
        atom(Clause::Not(inner()), format!("not {shape}"), core, price + 0.8),
        atom(Clause::First(inner()), format!("first {shape}"), core, price + 0.3),
        atom(Clause::Last(inner()), format!("last {shape}"), core, price + 0.3),
        atom(Clause::AtStart(inner()), format!("at_start {shape}"), core, price + 0.5),
        atom(Clause::AtEnd(inner()), format!("at_end {shape}"), core, price + 0.5),
    ];
    wrapped.into_iter().flatten().collect()
}

/// The one thing and later the other, for members that do both; each said in the cheapest way.
fn sequences(world: &World<'_>, group: &Group<'_>, events: &[Base]) -> Vec<Atom> {
    let mut cheapest: Vec<&Base> = Vec::new();
    for base in events {
        match cheapest.iter_mut().find(|other| other.core == base.core) {
            Some(other) if other.price > base.price => *other = base,
            Some(_) => {}
            None => cheapest.push(base),
        }
    }
    let mut found = Vec::new();
    for before in &cheapest {
        for after in cheapest.iter().filter(|after| after.core != before.core) {
            let clause = Clause::Then(Box::new([before.clause.clone(), after.clause.clone()]));
            if varies(world, group, &clause) {
                let core = format!("{} then {}", before.core, after.core);
                found.extend(atom(clause, "then", core, 0.6 + 0.7 * (before.price + after.price)));
            }
        }
    }
    found
}

/// What is said of others but could be said of the group: values that its properties have elsewhere, and its events
/// with others of the kind that takes the second role.
pub(crate) fn strange(world: &World<'_>, group: &Group<'_>, everybody: &[Somebody]) -> Vec<Atom> {
    let mut found = Vec::new();
    let mut seen = BTreeSet::new();
    let has_key = |key: &String| group.members.iter().any(|member| member.attributes.contains_key(key));
    for (key, value) in world.instances().flat_map(|instance| &instance.attributes) {
        let is_own = group.members.iter().any(|member| member.attributes.get(key) == Some(value));
        if has_key(key) && !is_own && seen.insert((key, value)) {
            let clause = Clause::Attribute { key: key.clone(), value: value.clone() };
            found.extend(atom(clause, format!("attribute {key}"), key, STRANGE));
        }
    }
    let noun_of = |name: &Name| world.instance(name).map(|instance| instance.category.as_str());
    let of_kind = |other: &Somebody, kind: Option<&str>| {
        kind.is_some() && other.meant.first().and_then(noun_of) == kind
    };
    let mut said = BTreeSet::new();
    for event in world.events() {
        let Event { subject, verb, object: Some(object), .. } = event else { continue };
        for other in everybody.iter().filter(|other| other.only().is_some()) {
            if noun_of(object) == Some(group.noun) && of_kind(other, noun_of(subject)) {
                let clause = Clause::Undergoes { verb: verb.clone(), by: other.party.clone() };
                let price = STRANGE + 0.1 + other.price;
                let is_new = said.insert(clause.to_string());
                found
                    .extend(atom(clause, "undergoes", format!("undergoes {verb}"), price).filter(|_| is_new));
            }
            if noun_of(subject) == Some(group.noun) && of_kind(other, noun_of(object)) {
                let clause = Clause::Does { verb: verb.clone(), to: Some(other.party.clone()) };
                let price = STRANGE + 0.1 + other.price;
                let is_new = said.insert(clause.to_string());
                found.extend(atom(clause, "does to", format!("does {verb} to"), price).filter(|_| is_new));
            }
        }
    }
    found
}
