//! Properties: which key and value words mean, for such a thing in such a scene.

use l4d_query::Clause;

use super::{Reader, Readings};
use crate::lexicon::{Way, Wording, lexicon};

impl Reader<'_, '_> {
    /// Wordings of this way at a place, by where they end.
    pub(super) fn wordings(&self, at: usize, way: Way) -> Vec<(Vec<&'static Wording>, usize)> {
        let mut found: Vec<(Vec<&'static Wording>, usize)> = Vec::new();
        for (wording, length) in lexicon().properties_at(way, self.rest(at)) {
            let end = self.reached(at + length);
            match found.iter_mut().find(|(_, other)| *other == end) {
                Some((wordings, _)) => wordings.push(wording),
                None => found.push((vec![wording], end)),
            }
        }
        found.sort_by_key(|(_, end)| std::cmp::Reverse(*end));
        found
    }

    /// What of these wordings is meant of such a thing.
    pub(super) fn meant(&self, category: &str, wordings: &[&'static Wording]) -> Vec<Clause> {
        let person = lexicon().is_person(category);
        let fitting = wordings.iter().filter(|wording| wording.people.is_none_or(|people| people == person));
        let mut ranked: Vec<(usize, &Wording)> = fitting
            .map(|wording| (self.words.property_rank(category, &wording.key, &wording.value), *wording))
            .collect();
        ranked.sort_by_key(|(rank, _)| *rank);
        let Some(&(best, _)) = ranked.first() else { return Vec::new() };
        // What is not seen in the scene at all has the lexicon's first meaning.
        let most = if best < 2 { usize::MAX } else { 1 };
        let meant = ranked.into_iter().filter(|(rank, _)| *rank == best).take(most);
        let mut clauses: Vec<Clause> = Vec::new();
        for (_, wording) in meant {
            let clause = Clause::Attribute { key: wording.key.clone(), value: wording.value.clone() };
            if !clauses.contains(&clause) {
                clauses.push(clause);
            }
        }
        clauses
    }

    /// A property said in this way.
    pub(super) fn property(&self, at: usize, way: Way, category: &str) -> Readings<Clause> {
        let found = self.wordings(at, way).into_iter();
        let meant = found.flat_map(|(wordings, end)| {
            self.meant(category, &wordings).into_iter().map(move |clause| (clause, end))
        });
        meant.collect()
    }

    /// "with a lid", "without a lid", "in a red top", "wearing jeans", "of coffee", "made of tin", with what may go
    /// before it: "not".
    pub(super) fn property_phrase(&self, at: usize, category: &str) -> Readings<Clause> {
        let mut found = self.property(at, Way::Is, category);
        if let Some(with) = self.any_of(at, "with having") {
            found.extend(self.having(with, category));
        }
        if let Some(without) = self.any_of(at, "without") {
            found.extend(self.lacking(without, category));
        }
        if let Some(of) = self.any_of(at, "of") {
            found.extend(self.property(of, Way::Contents, category));
        }
        for worn in self.phrases(at, "in|wearing|dressed in") {
            found.extend(self.property(worn, Way::Wears, category));
        }
        if let Some(worn) = self.any_of(at, "wearing") {
            let lacked = self.property(worn, Way::Lacks, category).into_iter();
            found.extend(lacked.map(|(clause, end)| (negated(clause), end)));
        }
        found
    }

    /// "a backpack": the noun says it.
    pub(super) fn kind(&self, at: usize, category: &str) -> Readings<Clause> {
        let wordings = self.wordings(at, Way::Noun).into_iter();
        let fitting =
            wordings.flat_map(|(wordings, end)| wordings.into_iter().map(move |wording| (wording, end)));
        let fitting = fitting.filter(|(wording, _)| wording.category.as_deref() == Some(category));
        let clause =
            |wording: &Wording| Clause::Attribute { key: wording.key.clone(), value: wording.value.clone() };
        fitting.map(|(wording, end)| (clause(wording), end)).collect()
    }

    /// "in a red top and jeans", "with a ponytail and a red ribbon": two properties after one preposition.
    pub(super) fn property_pairs(&self, at: usize, category: &str) -> Readings<Vec<Clause>> {
        let mut found = Readings::new();
        for (words, ways) in [("in|wearing|dressed in", &[Way::Wears][..]), ("with", &[Way::Has, Way::Wears])]
        {
            for start in self.phrases(at, words) {
                let one = |at: usize| ways.iter().flat_map(move |way| self.property(at, *way, category));
                for (first, end) in one(start) {
                    let Some(next) = self.any_of(end, "and") else { continue };
                    found.extend(one(next).map(|(second, end)| (vec![first.clone(), second], end)));
                }
            }
        }
        found
    }

    /// After "with" or "has": "a lid", "no lid".
    pub(super) fn having(&self, at: usize, category: &str) -> Readings<Clause> {
        let mut found = self.property(at, Way::Has, category);
        found.extend(self.property(at, Way::Wears, category));
        // What others lack.
        let lacked = self.property(at, Way::Lacks, category).into_iter();
        found.extend(lacked.map(|(clause, end)| (negated(clause), end)));
        if let Some(no) = self.any_of(at, "no") {
            found.extend(self.lacking(no, category));
        }
        found
    }

    /// After "without": what is missing, or a property that it doesn't have.
    pub(super) fn lacking(&self, at: usize, category: &str) -> Readings<Clause> {
        let mut found = self.property(at, Way::Lacks, category);
        for way in [Way::Has, Way::Wears] {
            found.extend(
                self.property(at, way, category).into_iter().map(|(clause, end)| (negated(clause), end)),
            );
        }
        found
    }
}

/// That it doesn't hold; two "not" are none.
pub(super) fn negated(clause: Clause) -> Clause {
    match clause {
        Clause::Not(inner) => *inner,
        clause => Clause::Not(Box::new(clause)),
    }
}
