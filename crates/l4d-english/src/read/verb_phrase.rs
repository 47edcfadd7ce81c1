//! Finite clauses: "rolls", "is not on the tray", "sits first and walks afterwards", "that a hand lifts".

use l4d_query::{Clause, Party, Relation};

use super::phrase::{Article, Order};
use super::property::negated;
use super::state::{Edge, POSTURES};
use super::{Reader, Readings, distinct};
use crate::lexicon::{Form, Way, lexicon};

const THEN: &str =
    "and then|then|and afterwards|and later|and after that|and next|before it|and then it|then it";
const AFTERWARDS: &str = "afterwards|later|after that|next|then|later on";
const BEFORE_OTHERS: &str = "first|before all others|before all the others|before the others|before any other|\
    before any other one|before the other|before the other one|before all other|before every other";
const AFTER_OTHERS: &str = "last|after all others|after all the others|after the others|after any other|\
    after any other one|after the other|after the other one|after all other|after every other";

/// Who does something to the thing that is spoken of.
#[derive(Debug, Clone, PartialEq)]
enum Subject {
    Party {
        party: Party,
        is_no: bool,
    },
    /// "somebody", "no-one": all who do it.
    Somebody {
        is_no: bool,
    },
}

impl Reader<'_, '_> {
    /// A verb phrase whose subject is the thing that is spoken of, its verb in this form: clauses that must all hold.
    pub(super) fn verb_phrase(&self, at: usize, form: Form, category: &str) -> Readings<Vec<Clause>> {
        let mut found = Readings::new();
        let starts_with_be = self.any_of(at, "is are was were be").is_some();
        for (clause, end) in self.ordered_steps(at, form, category) {
            found.push((vec![clause.clone()], end));
            // "sits on the bench".
            if matches!(clause, Clause::Does { to: None, .. }) {
                let places = self.timed(self.relation(end)).into_iter();
                found.extend(places.map(|(place, end)| (vec![clause.clone(), place], end)));
            }
            let Some(next) = self.any_of(end, "and") else { continue };
            let mut others = self.verb_phrase(next, form, category);
            if starts_with_be {
                let states = self.complement(next, category).into_iter();
                others.extend(states.map(|(clause, end)| (vec![clause], end)));
            }
            for (more, end) in others {
                found.push(([&[clause.clone()][..], &more].concat(), end));
            }
        }
        found.sort_by_key(|(_, end)| std::cmp::Reverse(*end));
        distinct(found)
    }

    /// One clause, or two in a stated order.
    fn ordered_steps(&self, at: usize, form: Form, category: &str) -> Readings<Clause> {
        let mut found = Readings::new();
        if let Some(first) = self.any_of(at, "first") {
            for (one, end) in self.clause(first, form, category) {
                found.extend(self.second_step(&one, end, THEN, form, category));
            }
        }
        for first in self.phrases(at, "is first|are first|was first|gets first") {
            for (one, end) in self.passive(first) {
                found.extend(self.second_step(&one, end, THEN, form, category));
            }
        }
        for (one, end) in self.clause(at, form, category) {
            found.extend(self.second_step(&one, end, THEN, form, category));
            if let Some(and) = self.any_of(end, "first").and_then(|first| self.any_of(first, "and")) {
                for (two, end) in self.clause(self.skip(and, "then"), form, category) {
                    let ends = self.phrases(end, AFTERWARDS).into_iter().chain([end]);
                    found.extend(ends.filter_map(|end| Some((then(&one, &two)?, end))));
                }
            }
            if let Some(and) = self.any_of(end, "and") {
                for (two, end) in self.clause(and, form, category) {
                    let ends = self.phrases(end, AFTERWARDS).into_iter();
                    found.extend(ends.filter_map(|end| Some((then(&one, &two)?, end))));
                }
            }
            for (word, is_after) in [("after", true), ("before", false)] {
                let Some(next) = self.any_of(end, word) else { continue };
                for (other, end) in self.gerund(next, category) {
                    let (one, two) = if is_after { (&other, &one) } else { (&one, &other) };
                    found.extend(then(one, two).map(|clause| (clause, end)));
                }
            }
            found.push((one, end));
        }
        distinct(found)
    }

    fn second_step(
        &self,
        one: &Clause,
        at: usize,
        links: &str,
        form: Form,
        category: &str,
    ) -> Readings<Clause> {
        let mut found = Readings::new();
        for next in self.phrases(at, links) {
            let passives = self.passive(next).into_iter();
            for (two, end) in self.clause(next, form, category).into_iter().chain(passives) {
                found.extend(then(one, &two).map(|clause| (clause, end)));
            }
        }
        found
    }

    /// "sitting", "being lifted by a hand", "it is lifted by a hand".
    fn gerund(&self, at: usize, category: &str) -> Readings<Clause> {
        let mut found = self.event(at, Form::Ing);
        for being in self.phrases(at, "being|having been|getting") {
            found.extend(self.passive(being));
        }
        if let Some(next) = self.any_of(at, "it he she") {
            found.extend(self.clause(next, Form::Third, category));
        }
        if let Some(next) = self.any_of(at, "they") {
            found.extend(self.clause(next, Form::Base, category));
        }
        found
    }

    fn clause(&self, at: usize, form: Form, category: &str) -> Readings<Clause> {
        let at = self.skip(at, "still");
        if let Some(next) = self.any_of(at, "never not") {
            let found = self.clause(next, form, category).into_iter();
            return self.timed(found.map(|(clause, end)| (negated(clause), end)).collect());
        }
        let mut found = self.placed(at, form, category);
        found.extend(self.being(at, form, category));
        if let Some(not) = self.any_of(at, "does do did").and_then(|next| self.any_of(next, "not never")) {
            let inner = self.clause(not, Form::Base, category).into_iter();
            found.extend(inner.map(|(clause, end)| (negated(clause), end)));
        }
        if let Some(has) = self.any_of(at, if form == Form::Third { "has had" } else { "have had" }) {
            found.extend(self.having(has, category));
        }
        if let Some(wears) = self.any_of(at, if form == Form::Third { "wears" } else { "wear" }) {
            found.extend(self.property(wears, Way::Wears, category));
        }
        let is_relation = match self.word(at) {
            "touches" | "touch" => !self.is_done("touch"),
            "faces" | "face" => !self.is_done("face"),
            _ => false,
        };
        if !is_relation {
            found.extend(self.done(at, form));
        }
        for (edge, next) in self.edges(at) {
            let plain = self.clause(next, form, category).into_iter();
            found.extend(plain.filter_map(|(clause, end)| Some((edge.of(clause)?, end))));
        }
        self.timed(distinct(found))
    }

    /// What is done, and whether it is the first or the last of its kind to do it.
    fn done(&self, at: usize, form: Form) -> Readings<Clause> {
        let mut found = self.event(at, form);
        if form == Form::Third {
            found.extend(self.event(at, Form::Past));
        }
        self.with_order(found)
    }

    fn with_order(&self, found: Readings<Clause>) -> Readings<Clause> {
        let mut ordered = Readings::new();
        for (clause, end) in &found {
            let is_event = matches!(clause, Clause::Does { .. } | Clause::Undergoes { .. });
            for (order, words) in [(Order::First, BEFORE_OTHERS), (Order::Last, AFTER_OTHERS)] {
                for next in self.phrases(*end, words).into_iter().filter(|_| is_event) {
                    ordered.push((order.of(clause.clone()), next));
                    let nouns = self.categories(next, false).into_iter().chain(self.categories(next, true));
                    ordered.extend(nouns.map(|(_, end)| (order.of(clause.clone()), end)));
                }
            }
        }
        ordered.extend(found);
        ordered
    }

    /// "is on the tray", "stays beside the lamp", "starts out on the tray", "ends up lying".
    fn being(&self, at: usize, form: Form, category: &str) -> Readings<Clause> {
        let (be, starts, ends) = match form {
            Form::Third => (
                "is|was|are|were|gets|has been|keeps|stays|remains",
                "starts|starts out|starts off|begins",
                "ends|ends up|finishes|finishes up|comes to rest",
            ),
            _ => (
                "be|are|were|get|keep|stay|remain",
                "start|start out|start off|begin",
                "end|end up|finish|finish up|come to rest",
            ),
        };
        let mut found = Readings::new();
        for next in self.phrases(at, be) {
            found.extend(self.complement(next, category));
            if let Some(not) = self.any_of(next, "not never") {
                let inner = self.complement(not, category).into_iter();
                found.extend(inner.map(|(clause, end)| (negated(clause), end)));
            }
        }
        for (edge, phrases) in [(Edge::Start, starts), (Edge::End, ends)] {
            for next in self.phrases(at, phrases) {
                let inner = self.complement(next, category).into_iter();
                let inner =
                    inner.filter(|(clause, _)| !matches!(clause, Clause::AtStart(_) | Clause::AtEnd(_)));
                found.extend(inner.filter_map(|(clause, end)| Some((edge.of(clause)?, end))));
            }
        }
        let passives = self.with_order(found.clone());
        found.extend(passives);
        distinct(found)
    }

    /// "stands on the tray" of what does not stand, "faces the window", "touches the wall".
    fn placed(&self, at: usize, form: Form, category: &str) -> Readings<Clause> {
        let mut found = Readings::new();
        let (postures, faces, touches) = match form {
            Form::Third => ("stands sits lies rests", "faces", "touches"),
            _ => ("stand sit lie rest", "face", "touch"),
        };
        let does = POSTURES.iter().any(|verb| self.words.is_done_by(verb, category));
        if let Some(next) = self.any_of(at, postures).filter(|_| !does) {
            found.extend(self.relation(next));
        }
        for (word, kind, verb) in [(faces, Relation::Facing, "face"), (touches, Relation::Touching, "touch")]
        {
            let Some(next) = self.any_of(at, word) else { continue };
            if self.is_done(verb) {
                continue;
            }
            let of = self.parties(next).into_iter();
            found.extend(of.map(|(party, end)| (Clause::Relation { kind, of: vec![party] }, end)));
        }
        found
    }

    /// After "whose": "top is green", "hair is long".
    fn whose(&self, at: usize, category: &str) -> Readings<Clause> {
        let mut found = Readings::new();
        for is in at + 1..at + 4 {
            let Some(value) = self.any_of(is, "is are") else { continue };
            for end in value + 1..=(value + 3).min(self.tokens.len()) {
                let words = [&self.tokens[value..end], &self.tokens[at..is]].concat();
                for way in [Way::Has, Way::Wears] {
                    let said = lexicon().properties_at(way, &words).into_iter();
                    let said =
                        said.filter_map(|(wording, length)| (length == words.len()).then_some(wording));
                    let wordings: Vec<_> = said.collect();
                    let meant = self.meant(category, &wordings).into_iter();
                    found.extend(meant.map(|clause| (clause, self.reached(end))));
                }
            }
        }
        found
    }

    /// "that rolls", "which a hand lifts", "whose top is green".
    pub(super) fn relative(&self, at: usize, category: &str) -> Readings<Vec<Clause>> {
        if let Some(next) = self.any_of(at, "whose") {
            return self.whose(next, category).into_iter().map(|(clause, end)| (vec![clause], end)).collect();
        }
        let Some(next) = self.any_of(at, "that which who whom") else { return Vec::new() };
        let mut found = self.verb_phrase(next, Form::Third, category);
        let gaps = self.gap(next, false).into_iter();
        found.extend(gaps.map(|(clause, end)| (vec![clause], end)));
        found.sort_by_key(|(_, end)| std::cmp::Reverse(*end));
        distinct(found)
    }

    /// "a hand lifts", right after the noun.
    pub(super) fn contact_relative(&self, at: usize) -> Readings<Clause> {
        match self.any_of(at, "a an the no another somebody someone no-one nothing") {
            Some(_) => self.gap(at, false),
            None => Vec::new(),
        }
    }

    /// A clause in which somebody does something to the thing that is spoken of; with `pronoun` it is "it" there.
    pub(super) fn gap(&self, at: usize, pronoun: bool) -> Readings<Clause> {
        let mut found = Readings::new();
        for (subject, next) in self.subjects(at) {
            for (verb, is_not, end) in self.gap_verb(next, pronoun) {
                let Some(one) = self.undergone(&subject, &verb, is_not) else { continue };
                for then_at in self.phrases(end, "and then|then|and afterwards|and later") {
                    for (verb, end) in self.gapped(then_at, Form::Third, pronoun) {
                        let two = self.undergone(&subject, &verb, false);
                        found.extend(two.and_then(|two| then(&one, &two)).map(|clause| (clause, end)));
                    }
                }
                if let Some(word) = self.any_of(end, "after before") {
                    for (verb, end) in self.gapped(word, Form::Ing, true) {
                        let Some(two) = self.undergone(&subject, &verb, false) else { continue };
                        let is_after = self.word(word - 1) == "after";
                        let (first, last) = if is_after { (&two, &one) } else { (&one, &two) };
                        found.extend(then(first, last).map(|clause| (clause, end)));
                    }
                }
                found.push((one, end));
            }
        }
        self.timed(self.with_order(distinct(found)))
    }

    fn undergone(&self, subject: &Subject, verb: &str, is_not: bool) -> Option<Clause> {
        let (by, is_no) = match subject {
            Subject::Party { party, is_no } => (party.clone(), *is_no),
            Subject::Somebody { is_no } => (Party::Category(self.words.agent(verb)?), *is_no),
        };
        let clause = Clause::Undergoes { verb: verb.to_owned(), by };
        Some(if is_no != is_not { negated(clause) } else { clause })
    }

    /// "lifts", "is lifting", "never lifts", "does not lift".
    fn gap_verb(&self, at: usize, pronoun: bool) -> Vec<(String, bool, usize)> {
        let mut found = Vec::new();
        let mut add = |at: usize, form: Form, is_not: bool| {
            let verbs = self.gapped(at, form, pronoun).into_iter();
            found.extend(verbs.map(|(verb, end)| (verb, is_not, end)));
        };
        add(at, Form::Third, false);
        add(at, Form::Past, false);
        if let Some(next) = self.any_of(at, "never") {
            add(next, Form::Third, true);
        }
        if let Some(next) = self.any_of(at, "does did").and_then(|next| self.any_of(next, "not never")) {
            add(next, Form::Base, true);
        }
        if let Some(is) = self.any_of(at, "is was") {
            add(self.skip(is, "still"), Form::Ing, false);
            if let Some(not) = self.any_of(is, "not never") {
                add(not, Form::Ing, true);
            }
        }
        found
    }

    fn subjects(&self, at: usize) -> Readings<Subject> {
        if let Some(end) = self.any_of(at, "somebody someone something anybody anyone") {
            return vec![(Subject::Somebody { is_no: false }, end)];
        }
        if let Some(end) = self.any_of(at, "no-one nothing") {
            return vec![(Subject::Somebody { is_no: true }, end)];
        }
        let phrases = self.phrases_at(at);
        let subjects = phrases.iter().map(|(phrase, end)| {
            let is_no = phrase.article == Article::No;
            (Subject::Party { party: self.party(phrase), is_no }, *end)
        });
        distinct(subjects.collect())
    }
}

/// The one and later the other, if both are events.
fn then(one: &Clause, two: &Clause) -> Option<Clause> {
    let is_event = |clause: &Clause| matches!(clause, Clause::Does { .. } | Clause::Undergoes { .. });
    (is_event(one) && is_event(two)).then(|| Clause::Then(Box::new([one.clone(), two.clone()])))
}
