//! Whom a clause may speak of: landmarks by name, any of a category, and who is described so that it is one.

use std::collections::BTreeMap;

use l4d_data::tracks::{TrackedInstance, at_frame};
use l4d_data::{Name, Role};
use l4d_query::eval::members;
use l4d_query::prove::Prover;
use l4d_query::{Clause, Party, Predicate, Relation, Superlative, verbs};

/// Most descriptions of one instance: enough to vary, few enough to try them all.
const MOST_DESCRIPTIONS: usize = 4;

/// Somebody a clause may speak of.
#[derive(Debug, Clone)]
pub(crate) struct Somebody {
    /// How the predicate says it.
    pub(crate) party: Party,
    /// Who is meant, by name; of a category all of them.
    pub(crate) meant: Vec<Name>,
    /// Whether it goes about.
    pub(crate) moves: bool,
    /// How much longer or stranger a sentence gets that speaks of it.
    pub(crate) price: f64,
}

impl Somebody {
    /// The one that is meant; none where it may be several.
    pub(crate) fn only(&self) -> Option<&Name> {
        match self.meant.as_slice() {
            [one] => Some(one),
            _ => None,
        }
    }
}

/// Everybody in the scene: for each instance how it may be described, cheapest first, and each noun of several.
pub(crate) fn everybody(prover: &Prover<'_>) -> Vec<Somebody> {
    let world = prover.world();
    let mut nouns: BTreeMap<&str, Vec<&TrackedInstance>> = BTreeMap::new();
    for instance in world.instances() {
        nouns.entry(&instance.category).or_default().push(instance);
    }
    let mut found = Vec::new();
    for (noun, alike) in nouns {
        let names = || alike.iter().map(|one| one.name.clone()).collect();
        match alike.as_slice() {
            [only] if only.role == Role::Landmark => {
                let party = Party::Name(only.name.clone());
                found.push(Somebody { party, meant: names(), moves: moves(only), price: 0.0 });
            }
            [only] => {
                let party = Party::Such(Predicate(vec![Clause::Category(noun.to_owned())]));
                found.push(Somebody { party, meant: names(), moves: moves(only), price: 0.1 });
            }
            _ => {
                let party = Party::Category(noun.to_owned());
                let moves = alike.iter().any(|one| moves(one));
                found.push(Somebody { party, meant: names(), moves, price: 0.3 });
                for one in &alike {
                    found.extend(descriptions(prover, one));
                }
            }
        }
    }
    found
}

/// Whether the centre of its box ever strays from where it begins by more than a quarter of its size.
fn moves(instance: &TrackedInstance) -> bool {
    let [centres, extents] = [&instance.track.centre, &instance.track.extents];
    let length = |vector: [f64; 3]| vector.iter().map(|part| part * part).sum::<f64>().sqrt();
    let apart = |centre: &[f64; 3]| length(std::array::from_fn(|axis| centre[axis] - centres[0][axis]));
    centres.iter().map(apart).fold(0.0, f64::max) > 0.25 * length(extents[0])
}

/// Whether its box is at least half as high as long when the clip begins: what lies flat is not called tall.
pub(crate) fn is_upright(instance: &TrackedInstance) -> bool {
    let (extents, axes) = (at_frame(&instance.track.extents, 0), at_frame(&instance.track.axes, 0));
    let height: f64 = extents.iter().zip(&axes[6..]).map(|(extent, up)| extent * up.abs()).sum();
    height >= 0.5 * extents.iter().copied().fold(0.0, f64::max)
}

/// The descriptions that mean this instance and no other, however strictly thresholds are meant.
fn descriptions(prover: &Prover<'_>, instance: &TrackedInstance) -> Vec<Somebody> {
    let noun = Clause::Category(instance.category.clone());
    let mut found: Vec<Somebody> = Vec::new();
    for (clause, price) in traits(prover, instance) {
        let party = Party::Such(Predicate(vec![noun.clone(), clause]));
        let is_one = prover.worlds().iter().all(|world| {
            let members = members(world, &party);
            matches!(members.as_slice(), [one] if one.name == instance.name)
        });
        if is_one {
            let meant = vec![instance.name.clone()];
            found.push(Somebody { party, meant, moves: moves(instance), price });
        }
        if found.len() == MOST_DESCRIPTIONS {
            break;
        }
    }
    found
}

/// What may tell an instance from others of its noun, cheapest first.
fn traits(prover: &Prover<'_>, instance: &TrackedInstance) -> Vec<(Clause, f64)> {
    let world = prover.world();
    let mut found = Vec::new();
    for (key, value) in &instance.attributes {
        found.push((Clause::Attribute { key: key.clone(), value: value.clone() }, 0.5));
    }
    for extreme in [Superlative::Largest, Superlative::Smallest] {
        found.push((Clause::Superlative(extreme), 0.7));
    }
    if world.instances().filter(|one| one.category == instance.category).all(is_upright) {
        found.push((Clause::Superlative(Superlative::Tallest), 0.7));
    }
    let mut own: Vec<&str> = world
        .events()
        .filter(|event| event.subject == instance.name && event.object.is_none())
        .map(|event| event.verb.as_str())
        .filter(|verb| !verbs::is_state(verb) && crate::atoms::is_intransitive(world, verb))
        .collect();
    own.sort_unstable();
    own.dedup();
    for verb in own {
        found.push((Clause::Does { verb: verb.to_owned(), to: None }, 0.9));
    }
    let landmarks = world.instances().filter(|one| {
        let alike = world.instances().filter(|other| other.category == one.category).count();
        one.role == Role::Landmark && alike == 1 && one.name != instance.name
    });
    for landmark in landmarks {
        for kind in [Relation::On, Relation::In, Relation::Beside, Relation::Under] {
            let of = vec![Party::Name(landmark.name.clone())];
            found.push((Clause::Relation { kind, of }, 1.1));
        }
    }
    found
}
