//! Predicates drawn by seed from what a scene has: every kind of clause, alone, nested and together.

use l4d_data::tracks::{TrackedInstance, Tracks};
use l4d_data::{Role, Temporal};
use l4d_query::{Clause, Party, Predicate, Relation, Superlative};
use rand::seq::IndexedRandom;
use rand::{Rng, RngExt};

/// Landmarks that a scene has words for.
const NAMED: [&str; 9] =
    ["tray", "lamp", "table", "book_green", "book_blue", "sofa", "window", "laptop", "bench"];
const RELATIONS: [Relation; 11] = Relation::ALL;
const EXTREMES: [Superlative; 5] = [
    Superlative::Largest,
    Superlative::Smallest,
    Superlative::Tallest,
    Superlative::Highest,
    Superlative::Lowest,
];

/// A predicate about an object of the scene, and how it binds time.
pub(crate) fn draw(tracks: &Tracks, rng: &mut impl Rng) -> (Predicate, Temporal) {
    let objects: Vec<&TrackedInstance> =
        tracks.instances.iter().filter(|instance| instance.role == Role::Object).collect();
    let object = objects.choose(rng).unwrap();
    let mut draw = Draw { tracks, rng };
    let mut clauses = vec![Clause::Category(object.category.clone())];
    let temporal = if draw.chance(4) { Temporal::While } else { Temporal::Whole };
    let main = match temporal {
        Temporal::While => draw.passing(object),
        Temporal::Whole => draw.any(object),
    };
    clauses.push(main);
    if draw.chance(3) {
        let second = if draw.chance(2) { draw.property(object) } else { draw.relation() };
        if !clauses.contains(&second) {
            clauses.push(second);
        }
    }
    (Predicate(clauses), temporal)
}

struct Draw<'d, R> {
    tracks: &'d Tracks,
    rng: &'d mut R,
}

impl<R: Rng> Draw<'_, R> {
    fn chance(&mut self, one_in: u32) -> bool {
        self.rng.random_range(0..one_in) == 0
    }

    fn any(&mut self, of: &TrackedInstance) -> Clause {
        match self.rng.random_range(0..13) {
            0 | 1 => self.property(of),
            2 => self.extreme(),
            3 | 4 => self.relation(),
            5..=7 => self.event(of),
            8 => {
                let inner = match self.rng.random_range(0..4) {
                    0 => self.property(of),
                    1 => self.extreme(),
                    2 => self.relation(),
                    _ => self.event(of),
                };
                not(inner)
            }
            9 | 10 => {
                let mut inner = match self.rng.random_range(0..4) {
                    0 => Clause::Superlative(if self.chance(2) {
                        Superlative::Highest
                    } else {
                        Superlative::Lowest
                    }),
                    1 | 2 => self.relation(),
                    _ => self.event(of),
                };
                if self.chance(4) {
                    inner = not(inner);
                }
                if self.chance(2) { Clause::AtStart(Box::new(inner)) } else { Clause::AtEnd(Box::new(inner)) }
            }
            11 => {
                let event = Box::new(self.event(of));
                if self.chance(2) { Clause::First(event) } else { Clause::Last(event) }
            }
            _ => loop {
                let steps = [self.event(of), self.event(of)];
                if steps[0] != steps[1] {
                    break Clause::Then(Box::new(steps));
                }
            },
        }
    }

    /// Something that holds at some times and not at others.
    fn passing(&mut self, of: &TrackedInstance) -> Clause {
        let clause = match self.rng.random_range(0..5) {
            0 => self.relation(),
            1 => Clause::Superlative(Superlative::Highest),
            _ => self.event(of),
        };
        if self.chance(5) { not(clause) } else { clause }
    }

    fn property(&mut self, of: &TrackedInstance) -> Clause {
        let alike = self.tracks.instances.iter().filter(|other| other.category == of.category);
        let all: Vec<(&String, &String)> = alike.flat_map(|other| &other.attributes).collect();
        let (key, value) = all.choose(self.rng).unwrap();
        Clause::Attribute { key: (*key).clone(), value: (*value).clone() }
    }

    fn extreme(&mut self) -> Clause {
        Clause::Superlative(*EXTREMES.choose(self.rng).unwrap())
    }

    fn relation(&mut self) -> Clause {
        let kind = *RELATIONS.choose(self.rng).unwrap();
        Clause::Relation { kind, of: (0..kind.arity()).map(|_| self.party(1)).collect() }
    }

    /// What this one might do, or have done to it: any verb that its like takes part in, or that anything does.
    fn event(&mut self, of: &TrackedInstance) -> Clause {
        let category = |name: &str| self.tracks.instance(name).unwrap().category.clone();
        let mut choices = Vec::new();
        for event in &self.tracks.events {
            if category(&event.subject) == of.category {
                choices.push((event.verb.clone(), event.object.as_ref().map(|name| category(name)), true));
            }
            if event.object.as_ref().is_some_and(|object| category(object) == of.category) {
                choices.push((event.verb.clone(), Some(category(&event.subject)), false));
            }
        }
        if choices.is_empty() || self.chance(8) {
            choices = vec![("move".into(), None, true), ("push".into(), Some("hand".into()), false)];
        }
        let (verb, other, acts) = choices.choose(self.rng).unwrap().clone();
        let party = other.map(|other| if self.chance(2) { Party::Category(other) } else { self.party(1) });
        match (acts, party) {
            (true, to) => Clause::Does { verb, to },
            (false, by) => Clause::Undergoes { verb, by: by.unwrap() },
        }
    }

    fn party(&mut self, depth: u32) -> Party {
        match self.rng.random_range(0..4) {
            0 | 1 => Party::Name(l4d_data::Name::new(*NAMED.choose(self.rng).unwrap()).unwrap()),
            2 => {
                let nouns = ["hand", "cup", "cat", "woman", "child", "ball", "post"];
                Party::Category((*nouns.choose(self.rng).unwrap()).to_owned())
            }
            _ => {
                let objects: Vec<&TrackedInstance> =
                    self.tracks.instances.iter().filter(|other| other.role == Role::Object).collect();
                let one = *objects.choose(self.rng).unwrap();
                let clause = match self.rng.random_range(0..3) {
                    2 if depth > 0 => self.event_of(one),
                    1 if depth > 0 => {
                        let name =
                            Party::Name(l4d_data::Name::new(*NAMED.choose(self.rng).unwrap()).unwrap());
                        Clause::Relation { kind: Relation::On, of: vec![name] }
                    }
                    _ => self.property(one),
                };
                Party::Such(Predicate(vec![Clause::Category(one.category.clone()), clause]))
            }
        }
    }

    /// An event without others inside others.
    fn event_of(&mut self, one: &TrackedInstance) -> Clause {
        let alone = self.tracks.events.iter().filter(|event| event.object.is_none());
        let verbs: Vec<&String> = alone
            .filter(|event| self.tracks.instance(&event.subject).unwrap().category == one.category)
            .map(|event| &event.verb)
            .collect();
        match verbs.choose(self.rng) {
            Some(verb) => Clause::Does { verb: (*verb).clone(), to: None },
            None => self.property(one),
        }
    }
}

fn not(clause: Clause) -> Clause {
    Clause::Not(Box::new(clause))
}
