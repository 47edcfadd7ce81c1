//! What something is: properties, relations, extremes, what it is doing, and when.

use l4d_query::{Clause, Party, Relation, Superlative};

use super::phrase::Order;
use super::property::negated;
use super::{Reader, Readings, distinct};
use crate::lexicon::{Form, Way};

/// Words of relations; the first of each is what the realiser says, all are read.
pub(crate) const RELATIONS: [(Relation, &str); 11] = [
    (Relation::InFrontOf, "in front of"),
    (Relation::On, "on|on top of|onto|atop"),
    (Relation::In, "in|inside|into|within"),
    (Relation::Under, "under|underneath|beneath|below"),
    (Relation::Beside, "beside|next to|near|close to|alongside|right beside|right next to|at"),
    (Relation::Touching, "touching|in contact with"),
    (Relation::Between, "between"),
    (Relation::ClosestTo, "closest to|nearest to|nearest|the closest to|the nearest to|the one closest to"),
    (Relation::FarthestFrom, "farthest from|farthest away from|the farthest from"),
    (Relation::Behind, "behind"),
    (Relation::Facing, "facing"),
];

/// Words of extremes and of their comparatives.
pub(crate) const SUPERLATIVES: [(Superlative, &str, &str); 5] = [
    (Superlative::Largest, "largest biggest", "larger bigger"),
    (Superlative::Smallest, "smallest", "smaller"),
    (Superlative::Tallest, "tallest", "taller"),
    (Superlative::Highest, "highest", "higher"),
    (Superlative::Lowest, "lowest", "lower"),
];

const AT_START: &str = "at the start|at the beginning|at first|in the beginning|to begin with|initially|originally|\
    when the clip starts|when the clip begins|when the video starts|when the video begins|at the start of the clip|\
    at the beginning of the clip|at the start of the video|at the beginning of the video|when the scene begins";
const AT_END: &str = "at the end|in the end|finally|eventually|when the clip ends|when the video ends|\
    at the end of the clip|at the end of the video|when it all ends|when the scene ends";

/// Verbs that say no more than that something is somewhere, unless it is said to do that.
pub(super) const POSTURES: [&str; 4] = ["stand", "sit", "lie", "rest"];

/// An edge of the clip.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Edge {
    Start,
    End,
}

impl Edge {
    pub(super) fn of(self, clause: Clause) -> Option<Clause> {
        match self {
            _ if clause.is_constant() => None,
            Self::Start => Some(Clause::AtStart(Box::new(clause))),
            Self::End => Some(Clause::AtEnd(Box::new(clause))),
        }
    }
}

impl Reader<'_, '_> {
    /// What may follow a noun without "that": "on the tray", "with a lid", "lifted by a hand", "walking", "never on
    /// the tray", with the time at which it is so.
    pub(super) fn state(&self, at: usize, category: &str) -> Readings<Clause> {
        if let Some(next) = self.any_of(at, "not never") {
            let found =
                self.plain_state(next, category).into_iter().map(|(clause, end)| (negated(clause), end));
            return self.timed(found.collect());
        }
        let mut found = self.plain_state(at, category);
        for (edge, next) in self.edges(at) {
            let plain = self.state(next, category).into_iter();
            found.extend(plain.filter_map(|(clause, end)| Some((edge.of(clause)?, end))));
        }
        self.timed(found)
    }

    fn plain_state(&self, at: usize, category: &str) -> Readings<Clause> {
        let at = self.skip(at, "still");
        let mut found = self.property_phrase(at, category);
        found.extend(self.posture(at, category));
        let is_relation = match self.word(at) {
            "touching" => !self.is_done("touch"),
            "facing" => !self.is_done("face"),
            _ => false,
        };
        if !is_relation {
            found.extend(self.event(at, Form::Ing));
        }
        found.extend(self.relation(at));
        found.extend(self.passive(at));
        for being in self.phrases(at, "being|getting") {
            found.extend(self.passive(being));
        }
        distinct(found)
    }

    /// What may follow "is": all that may follow a noun, adjectives, extremes and order.
    pub(super) fn complement(&self, at: usize, category: &str) -> Readings<Clause> {
        let mut found = self.property(at, Way::Adjective, category);
        found.extend(self.kind(at, category));
        found.extend(self.state(at, category));
        found.extend(self.timed(self.extreme(at)));
        found.extend(self.order(at, category));
        for (edge, next) in self.edges(at) {
            let plain = self.extreme(next).into_iter();
            found.extend(plain.filter_map(|(clause, end)| Some((edge.of(clause)?, end))));
        }
        found
    }

    /// Whether a verb that might as well be a relation is something that is done in the scene.
    pub(super) fn is_done(&self, verb: &str) -> bool {
        self.words.is_of_a_scene() && self.words.verb_rank(verb, true) == 0
    }

    /// "standing on the tray", where no one stands: the thing is there.
    fn posture(&self, at: usize, category: &str) -> Readings<Clause> {
        let Some(next) = self.any_of(at, "standing sitting lying resting placed put located") else {
            return Vec::new();
        };
        if POSTURES.iter().any(|verb| self.words.is_done_by(verb, category)) {
            return Vec::new();
        }
        self.relation(next)
    }

    /// The same readings, and those with the time that follows them.
    pub(super) fn timed(&self, found: Readings<Clause>) -> Readings<Clause> {
        let mut timed = Readings::new();
        for (clause, end) in &found {
            for (edge, after) in self.edges(*end) {
                timed.extend(edge.of(clause.clone()).map(|clause| (clause, after)));
            }
        }
        timed.extend(found);
        distinct(timed)
    }

    /// "at the start", "when the clip ends".
    pub(super) fn edges(&self, at: usize) -> Readings<Edge> {
        let starts = self.phrases(at, AT_START).into_iter().map(|end| (Edge::Start, end));
        let ends = self.phrases(at, AT_END).into_iter().map(|end| (Edge::End, end));
        let mut found: Readings<Edge> = starts.chain(ends).collect();
        found.sort_by_key(|(_, end)| std::cmp::Reverse(*end));
        found
    }

    /// "on the tray", "between the two posts", "closer to the lamp than any other cup".
    pub(super) fn relation(&self, at: usize) -> Readings<Clause> {
        let mut found = Readings::new();
        for (kind, phrases) in RELATIONS {
            for next in self.phrases(at, phrases) {
                if kind == Relation::Between {
                    found.extend(self.between(next));
                    continue;
                }
                let of = self.parties(next).into_iter();
                found.extend(of.map(|(party, end)| (Clause::Relation { kind, of: vec![party] }, end)));
            }
        }
        let comparatives = [
            (Relation::ClosestTo, "closer to|closer"),
            (Relation::FarthestFrom, "farther from|farther away from"),
        ];
        for (kind, phrases) in comparatives {
            for next in self.phrases(at, phrases) {
                for (party, end) in self.parties(next) {
                    let clause = Clause::Relation { kind, of: vec![party] };
                    found.extend(self.than_others(end).into_iter().map(|end| (clause.clone(), end)));
                }
            }
        }
        found
    }

    /// "than any other cup", "than the other one", "than all others".
    fn than_others(&self, at: usize) -> Vec<usize> {
        let mut found = Vec::new();
        for next in self
            .phrases(at, "than any other|than the other|than every other|than all other|than all the other")
        {
            found.extend(self.any_of(next, "one ones"));
            found.extend(self.categories(next, false).into_iter().map(|(_, end)| end));
            found.extend(self.categories(next, true).into_iter().map(|(_, end)| end));
        }
        found.extend(self.phrases(at, "than the others|than all others|than all the others|than the rest"));
        found
    }

    fn between(&self, at: usize) -> Readings<Clause> {
        let mut found = Readings::new();
        let clause = |of: Vec<Party>| Clause::Relation { kind: Relation::Between, of };
        for (one, and) in self.parties(at) {
            let Some(next) = self.any_of(and, "and") else { continue };
            found.extend(
                self.parties(next).into_iter().map(|(two, end)| (clause(vec![one.clone(), two]), end)),
            );
        }
        for next in self.phrases(at, "two|the two|two other|the two other") {
            let both = self.categories(next, true).into_iter();
            found.extend(both.map(|(noun, end)| (clause(vec![Party::Category(noun); 2]), end)));
        }
        found
    }

    pub(super) fn superlative(&self, at: usize) -> Readings<Clause> {
        let said = SUPERLATIVES.iter().filter_map(|(extreme, superlative, comparative)| {
            let end = self.any_of(at, superlative).or_else(|| self.any_of(at, comparative))?;
            Some((Clause::Superlative(*extreme), end))
        });
        said.collect()
    }

    /// "the tallest", "highest", "the tallest of the women", "taller than any other woman".
    fn extreme(&self, at: usize) -> Readings<Clause> {
        let mut found = Readings::new();
        let start = self.skip(at, "the");
        for (clause, end) in self.superlative(start) {
            found.extend(self.than_others(end).into_iter().map(|end| (clause.clone(), end)));
            if !self.tokens[at..end].iter().any(|word| word.ends_with('r')) {
                found.extend(self.of_all(end).into_iter().map(|end| (clause.clone(), end)));
            }
        }
        found
    }

    /// What may follow "the first" or "the tallest" after "is": the noun, "of the cups", or nothing.
    fn of_all(&self, at: usize) -> Vec<usize> {
        let mut found = Vec::new();
        let mut nouns: Vec<usize> = self.categories(at, false).into_iter().map(|(_, end)| end).collect();
        nouns.extend(self.any_of(at, "one"));
        nouns.push(at);
        for end in nouns {
            for next in
                self.phrases(end, "of the|of all the|of all|of the two|of the three|of the four|of the five")
            {
                found.extend(self.categories(next, true).into_iter().map(|(_, end)| end));
            }
            found.extend(self.phrases(end, "of them|of them all|of all"));
            found.push(end);
        }
        found
    }

    /// "the first to jump", "the last cup to be lifted by a hand", "the first that a hand lifts".
    fn order(&self, at: usize, category: &str) -> Readings<Clause> {
        let Some(the) = self.any_of(at, "the") else { return Vec::new() };
        let (order, next) = match self.word(the) {
            "first" => (Order::First, self.reached(the + 1)),
            "last" => (Order::Last, self.reached(the + 1)),
            _ => return Vec::new(),
        };
        let mut found: Readings<Clause> = Vec::new();
        for next in self.of_all(next) {
            if let Some(to) = self.any_of(next, "to") {
                found.extend(self.event(to, Form::Base));
                for be in self.phrases(to, "be|get") {
                    found.extend(self.passive(be));
                }
            }
            found.extend(self.contact_relative(next));
            for (clauses, end) in self.relative(next, category) {
                if let [clause] = &clauses[..] {
                    found.push((clause.clone(), end));
                }
            }
        }
        found.retain(|(clause, _)| matches!(clause, Clause::Does { .. } | Clause::Undergoes { .. }));
        distinct(found.into_iter().map(|(clause, end)| (order.of(clause), end)).collect())
    }
}
