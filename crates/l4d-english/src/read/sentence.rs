//! Whole sentences: a noun phrase, and the time at which it counts ("while it rolls").

use l4d_data::Temporal;
use l4d_query::{Clause, Predicate};

use super::phrase::Article;
use super::{Reader, Readings, distinct};
use crate::lexicon::Form;

const GATES: &str = "while|as|when|whenever|as long as|just as|at the moment when|during the time that|at the time when|\
    but only while|only while|at the moment";

impl Reader<'_, '_> {
    /// All readings of the whole sentence, the preferred one first.
    pub(super) fn sentences(&self) -> Vec<(Predicate, Temporal)> {
        let repeats = self.tokens.iter().any(|word| matches!(word.as_str(), "one" | "ones" | "another"));
        let mut heads = vec![None];
        if repeats {
            let phrases = self.phrases_at(0);
            let mut nouns: Vec<String> = phrases.iter().map(|(phrase, _)| phrase.noun.clone()).collect();
            nouns.dedup();
            nouns.truncate(4);
            heads.splice(.., nouns.into_iter().map(Some));
            if heads.is_empty() {
                heads.push(None);
            }
        }
        let mut found = Vec::new();
        for head in heads {
            self.phrases.borrow_mut().clear();
            *self.head.borrow_mut() = head;
            found.extend(self.sentences_of_head());
        }
        found
    }

    fn sentences_of_head(&self) -> Vec<(Predicate, Temporal)> {
        let mut found = Vec::new();
        let phrases = self.phrases_at(0);
        for (phrase, end) in phrases.iter().filter(|(phrase, _)| phrase.article != Article::No) {
            self.finish(&phrase.predicate(), *end, &mut found);
        }
        for of in self
            .phrases(0, "of the|of all the|of all|among the|of the two|of the three|of the four|of the five")
        {
            for (noun, end) in self.categories(of, true) {
                self.phrases.borrow_mut().clear();
                *self.head.borrow_mut() = Some(noun.clone());
                for one in self.phrases(end, "the one|the only one|that|the one and only") {
                    for ((clauses, _), end) in self.one_of(one, &noun) {
                        let all = std::iter::once(Clause::Category(noun.clone())).chain(clauses);
                        self.finish(&Predicate(all.collect()), end, &mut found);
                    }
                }
            }
        }
        found
    }

    fn one_of(&self, at: usize, noun: &str) -> Readings<(Vec<Clause>, bool)> {
        self.after_noun(at, noun)
    }

    fn finish(&self, predicate: &Predicate, at: usize, found: &mut Vec<(Predicate, Temporal)>) {
        if self.is_end(at) {
            found.push((predicate.clone(), Temporal::Whole));
            return;
        }
        for gate in self.phrases(at, GATES) {
            for (clauses, end) in self.gated(gate, predicate.noun()) {
                if self.is_end(end) {
                    let all = predicate.0.iter().cloned().chain(clauses);
                    found.push((Predicate(all.collect()), Temporal::While));
                }
            }
        }
    }

    /// "it rolls", "rolling", "a hand lifts it", and more of these.
    fn gated(&self, at: usize, noun: &str) -> Readings<Vec<Clause>> {
        let mut found = Readings::new();
        if let Some(next) = self.any_of(at, "it he she") {
            found.extend(self.verb_phrase(next, Form::Third, noun));
        }
        if let Some(next) = self.any_of(at, "they") {
            found.extend(self.verb_phrase(next, Form::Base, noun));
        }
        found.extend(self.state(at, noun).into_iter().map(|(clause, end)| (vec![clause], end)));
        found.extend(self.gap(at, true).into_iter().map(|(clause, end)| (vec![clause], end)));
        let mut all = Readings::new();
        for (clauses, end) in distinct(found) {
            if let Some(next) = self.any_of(end, "and") {
                let next = self.skip(next, "while|as|when");
                for (more, end) in self.gated(next, noun) {
                    all.push(([&clauses[..], &more].concat(), end));
                }
            }
            all.push((clauses, end));
        }
        distinct(all)
    }
}
