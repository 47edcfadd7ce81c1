//! Where things are, what they are next to, and extremes: "between barn and spotty ball", "smaller than the rest".

use l4d_query::{Clause, Party, Relation};

use super::Wide;
use super::guess::{Guess, Guesses, cheapest};
use super::noun_phrase::Article;

/// Words of relations; between them `|`.
const PREPOSITIONS: [(Relation, &str); 9] = [
    (Relation::InFrontOf, "in front of|before"),
    (Relation::On, "on|onto|atop|upon|on to"),
    (Relation::In, "in|inside|into|within|in to"),
    (Relation::Under, "under|underneath|beneath|below"),
    (Relation::Beside, "beside|next to|near|alongside|at|by|around"),
    (Relation::Touching, "touching|against|in contact with"),
    (Relation::Behind, "behind"),
    (Relation::Facing, "facing|looking at"),
    (Relation::Between, "between|amid"),
];
/// What comparisons compare with.
const RIVALS: &str = "any all the other others one ones of them rest every either two three four does do is are have more most everyone everybody else anyone \
    anybody these those both pair set bunch group lot whole entire same its his her their others' that @all a neighbour neighbours companion companions mates fellows";
const ON_ONE_SIDE: &str = "on one side of it|on its one side|to one side of it|on one side|to one side|on the one side|at one side|over on one side";
const ON_THE_OTHER: &str = "on the other side of it|on the other side|on the other|over on the other|over on the other side|to the other side|to the other|\
    on its other side|on its other|over on its other side|at the other|on the opposite side|on the far side";
/// Words before a relation that say nothing more.
const LEADING: &str = "right|up|over|down|out|standing|sitting|lying|located|placed|situated|positioned|parked|positioned in the middle|positioned|resting|being|found|seen|left|\
    close|straight|there|off|back|away|hanging|somewhere|along|squarely|perched|set|put|kept|still|staying|remaining|that bit";

/// All phrases of the grammar of places, whose words are no misspellings.
pub(super) const PHRASES: &[&str] = &[RIVALS, LEADING];

impl Wide<'_, '_> {
    /// "on the tray", "between the posts", "closer to the lamp than the others".
    pub(super) fn relation(&self, at: usize) -> Guesses<Vec<Clause>> {
        let mut found = Vec::new();
        let mut start = at;
        let mut price = 0;
        loop {
            let mut here = Vec::new();
            self.plain_relation(start, &mut here);
            self.nearness(start, &mut here);
            here.extend(self.between_sides(start));
            found.extend(here.into_iter().map(|guess| guess.plus(price)));
            let Some(next) = self.phrase(start, LEADING) else { break };
            price += if matches!(
                self.word(start),
                "put" | "set" | "left" | "placed" | "kept" | "back" | "seen" | "found"
            ) {
                3
            } else {
                0
            };
            start = next;
        }
        cheapest(found)
    }

    fn plain_relation(&self, at: usize, found: &mut Guesses<Vec<Clause>>) {
        for (kind, phrases) in PREPOSITIONS {
            let Some(next) = self.phrase(at, phrases) else { continue };
            if kind == Relation::Between {
                found.extend(self.between(next));
                continue;
            }
            let cost = match self.word(at) {
                "before" => 12,
                "at" | "around" | "within" => 6,
                "by" => 5,
                _ => 0,
            };
            for guess in self.parties(next) {
                found.push(
                    guess.map(|(party, _)| vec![Clause::Relation { kind, of: vec![party] }]).plus(cost),
                );
            }
        }
    }

    /// "closest to the lamp", "farther from it than any other cup".
    fn nearness(&self, at: usize, found: &mut Guesses<Vec<Clause>>) {
        let start = self.skip(at, "the one|the|at the|one");
        for (kind, words, links) in [
            (Relation::ClosestTo, "closest closer", "to|of all to|@all to|by|by to|beside|from"),
            (
                Relation::FarthestFrom,
                "farthest farther",
                "from|away from|off from|away off from|of all from|@all from|to|out from",
            ),
        ] {
            let Some(next) = self.any_of(start, words) else { continue };
            let is_comparative = self.word(start).ends_with("er");
            let next = self.skip(next, "one|ones|of all|of them all");
            let next = self
                .nouns(next)
                .iter()
                .filter(|guess| self.phrase(guess.end, links).is_some())
                .map(|guess| guess.end)
                .max()
                .unwrap_or(next);
            let next = self.of_all(next).filter(|end| self.phrase(*end, links).is_some()).unwrap_or(next);
            let link = self.phrase(next, links);
            // "Closest the lamp".
            for (of, cost) in link
                .map(|of| (of, 0))
                .into_iter()
                .chain([(next, if kind == Relation::ClosestTo { 1 } else { 6 })])
            {
                for guess in self.parties(of) {
                    let ends = [
                        (self.than_others(guess.end), 0),
                        (Some(guess.end), if is_comparative { 2 } else { 0 }),
                    ];
                    for (end, more) in ends {
                        let Some(end) = end else { continue };
                        let clause =
                            |(party, _): (Party, String)| vec![Clause::Relation { kind, of: vec![party] }];
                        found.push(guess.clone().map(clause).ending(end).plus(cost + more));
                    }
                }
                // "Closer than the others to the lamp".
                if let Some(than) = self.than_others(next)
                    && let Some(of) = self.phrase(than, links)
                {
                    for guess in self.parties(of) {
                        found.push(guess.map(|(party, _)| vec![Clause::Relation { kind, of: vec![party] }]));
                    }
                }
            }
        }
    }

    /// The place after "than any of the others".
    pub(super) fn than_others(&self, at: usize) -> Option<usize> {
        let at = self.skip(at, ",");
        let mut end = self.any_of(at, "than")?;
        let start = end;
        loop {
            if let Some(next) = self.any_of(end, RIVALS) {
                end = next;
                continue;
            }
            let nouns = self.nouns(end);
            // "Than the cat on the sofa" compares with one that is described.
            match nouns.iter().map(|guess| guess.end).max().filter(|_| end > start) {
                Some(next)
                    if nouns
                        .iter()
                        .any(|guess| self.mentioned(at).iter().any(|(noun, _)| *noun == guess.value.0)) =>
                {
                    end = next;
                }
                _ => break,
            }
        }
        (end > start).then_some(end)
    }

    fn between(&self, at: usize) -> Guesses<Vec<Clause>> {
        let mut found = Vec::new();
        let clause = |of: Vec<Party>| vec![Clause::Relation { kind: Relation::Between, of }];
        for one in self.parties(at) {
            // "The jar on one side and the bowl on the other."
            let end = self.skip(self.skip(one.end, ON_ONE_SIDE), ",");
            if let Some(and) = self.phrase(end, "and|and also|and then|and over to") {
                for two in self.parties(and) {
                    let end = self.skip(two.end, ON_THE_OTHER);
                    let both = one.then(two, |(one, _), (two, _)| clause(vec![one.clone(), two]));
                    found.push(both.ending(end));
                }
            }
        }
        let two =
            self.skip(at, "the two other|the other two|two other|the two|two|both|both the|both of the|the");
        for noun in self.nouns(two).into_iter().filter(|guess| guess.value.1 && two > at) {
            found.push(
                noun.map(|(noun, _)| clause(vec![Party::Category(noun.clone()), Party::Category(noun)])),
            );
        }
        found
    }

    /// "the line from the ball to the barn", "from the lamp post over to the plant".
    fn between_sides(&self, at: usize) -> Guesses<Vec<Clause>> {
        let mut found = Vec::new();
        let ways = "partway from|midway from|halfway from|along the line from|on the line from|on the way from|along the way from|somewhere from|\
            in the middle of the line from|in the gap from";
        if let Some(from) = self.phrase(at, ways) {
            for one in self.parties(from) {
                let to = self.skip(one.end, "over|across|on");
                let Some(to) = self.any_of(to, "to and") else { continue };
                for two in self.parties(to) {
                    let both = |of: Vec<Party>| vec![Clause::Relation { kind: Relation::Between, of }];
                    found.push(one.then(two, |(one, _), (two, _)| both(vec![one.clone(), two])));
                }
            }
        }
        found
    }

    /// After "has" or "with": "the tree on one side and the tray on the other", "the candle next to it".
    pub(super) fn surrounded(&self, at: usize) -> Guesses<Vec<Clause>> {
        let mut found = Vec::new();
        let at = self.skip(at, "got");
        for one in self.described(at, false).iter() {
            let party = self.party(&one.value);
            let mut side = self.skip(one.end, "over");
            if let Some(next) = self.phrase(side, ON_ONE_SIDE) {
                side = self.skip(next, ",");
                if let Some(and) = self.any_of(side, "and") {
                    let and = self.skip(and, "has|with");
                    for two in self.parties(and) {
                        let Some(end) = self.phrase(self.skip(two.end, "over"), ON_THE_OTHER) else {
                            continue;
                        };
                        let of = vec![party.clone(), two.value.0.clone()];
                        let clause = vec![Clause::Relation { kind: Relation::Between, of }];
                        found.push(one.then(two, |_, _| clause).ending(end));
                    }
                }
            }
            // What is next to it, it is next to.
            let place = self.skip(one.end, "right|that is|which is|standing|lying|sitting|placed");
            for (kind, phrases) in [
                (
                    Relation::Beside,
                    "beside it|next to it|by it|near it|beside her|beside him|beside them|alongside it|at hand",
                ),
                (Relation::Facing, "in front of it|in front of her|in front of him|before it|ahead of it"),
                (Relation::Touching, "touching it|against it|touching them|in contact with it|touches it"),
            ] {
                let Some(end) = self.phrase(place, phrases) else { continue };
                let clause = Clause::Relation { kind, of: vec![party.clone()] };
                let clause = if one.value.article == Article::No { super::negated(clause) } else { clause };
                found.push(one.clone().map(|_| vec![clause]).ending(end));
            }
        }
        cheapest(found)
    }

    /// "the tallest of the lot", "smaller than the rest", "the highest".
    pub(super) fn extreme(&self, at: usize) -> Guesses<Vec<Clause>> {
        let mut found = Vec::new();
        let start = self.skip(at, "by far the|the|at the|the very");
        for (extreme, next) in self.extreme_word(start) {
            let clause = vec![Clause::Superlative(extreme)];
            let is_comparative = self.word(start).ends_with('r');
            if let Some(end) = self.than_others(next) {
                found.push(Guess::new(clause.clone(), end, 0));
            }
            let cost = if is_comparative { 4 } else { 0 };
            let mut end = self.skip(next, "one|ones|size|in size");
            end = self.nouns(next).iter().map(|guess| guess.end).max().unwrap_or(end);
            found.push(Guess::new(clause.clone(), next, cost));
            found.push(Guess::new(clause.clone(), end, cost));
            if let Some(end) = self.of_all(end) {
                found.push(Guess::new(clause, end, 0));
            }
        }
        cheapest(found)
    }

    /// The place after "of all the cups", "of them all".
    pub(super) fn of_all(&self, at: usize) -> Option<usize> {
        let mut end = self.phrase(at, "of|@all|among|out of")?;
        loop {
            if let Some(next) = self.any_of(end, RIVALS) {
                end = next;
                continue;
            }
            match self.nouns(end).iter().filter(|guess| guess.value.1).map(|guess| guess.end).max() {
                Some(next) => end = next,
                None => break,
            }
        }
        Some(end)
    }
}
