//! What is done: verbs with their objects, in the active and the passive.

use l4d_query::{Clause, Party};

use super::{Reader, Readings};
use crate::lexicon::{Form, Pattern, lexicon};

/// How well a verb fits, and what it was read as.
type Ranked = ((usize, usize), Clause, usize);

impl Reader<'_, '_> {
    /// "lifts a cup", "rolls": what the subject does, its verb in this form.
    pub(super) fn event(&self, at: usize, form: Form) -> Readings<Clause> {
        let mut found: Vec<Ranked> = Vec::new();
        for (verb, index, pattern) in lexicon().heads(form, self.word(at)) {
            let head = self.reached(at + 1);
            let Some(object) = self.all_of(head, &pattern.before) else { continue };
            let rank = self.rank(verb, index, pattern);
            if !pattern.takes_object {
                let verb = verb.to_owned();
                found.push((rank, Clause::Does { verb, to: None }, object));
                continue;
            }
            for (to, end) in self.objects(object) {
                let Some(end) = self.all_of(end, &pattern.after) else { continue };
                found.push((rank, Clause::Does { verb: verb.to_owned(), to }, end));
            }
        }
        best(found)
    }

    /// "lifted by a hand": what is done to the subject.
    pub(super) fn passive(&self, at: usize) -> Readings<Clause> {
        let mut found: Vec<Ranked> = Vec::new();
        for (verb, index, pattern) in lexicon().heads(Form::Participle, self.word(at)) {
            let end = self.all_of(self.reached(at + 1), &pattern.before);
            let end = end.and_then(|end| self.all_of(end, &pattern.after));
            let Some(end) = end.filter(|_| pattern.takes_object) else { continue };
            let rank = self.rank(verb, index, pattern);
            for (by, end) in self.agents(end, verb) {
                found.push((rank, Clause::Undergoes { verb: verb.to_owned(), by }, end));
            }
        }
        best(found)
    }

    /// A verb whose object is the thing that is spoken of: "lifts" in "that a hand lifts", or "lifts it" where
    /// `pronoun` says so. Gives the verbs, since who does it has been read before.
    pub(super) fn gapped(&self, at: usize, form: Form, pronoun: bool) -> Readings<String> {
        let mut found: Vec<((usize, usize), String, usize)> = Vec::new();
        for (verb, index, pattern) in lexicon().heads(form, self.word(at)) {
            let Some(mut end) = self.all_of(self.reached(at + 1), &pattern.before) else { continue };
            if !pattern.takes_object {
                continue;
            }
            if pronoun {
                let Some(object) = self.any_of(end, "it him her them") else { continue };
                end = object;
            }
            // "puts it down" as well as "puts down it".
            let ends = [self.all_of(end, &pattern.after), self.particle(at + 1, pattern, pronoun)];
            for end in ends.into_iter().flatten() {
                found.push((self.rank(verb, index, pattern), verb.to_owned(), end));
            }
        }
        if pronoun {
            for (verb, index, pattern) in lexicon().heads(form, self.word(at)) {
                let Some(end) = self.particle(at + 1, pattern, true) else { continue };
                found.push((self.rank(verb, index, pattern), verb.to_owned(), end));
            }
        }
        found.sort_by_key(|(rank, ..)| *rank);
        let best = |rank: (usize, usize), end: usize| {
            found.iter().filter(|other| other.2 == end).all(|other| other.0 >= rank)
        };
        let chosen: Readings<String> = found
            .iter()
            .filter(|(rank, _, end)| best(*rank, *end))
            .map(|(_, verb, end)| (verb.clone(), *end))
            .collect();
        super::distinct(chosen)
    }

    /// "it down": the pronoun before the particle.
    fn particle(&self, at: usize, pattern: &Pattern, pronoun: bool) -> Option<usize> {
        let is_moved = pronoun && pattern.takes_object && !pattern.before.is_empty();
        let object = self.any_of(at, "it him her them").filter(|_| is_moved)?;
        self.all_of(object, &pattern.before)
    }

    /// The object of a verb; none if it is left open ("something").
    fn objects(&self, at: usize) -> Readings<Option<Party>> {
        if let Some(end) = self.any_of(at, "something someone somebody") {
            return vec![(None, end)];
        }
        self.parties(at).into_iter().map(|(party, end)| (Some(party), end)).collect()
    }

    /// Who does it: "by a hand"; where nothing is said, all that do this in the scene if they are alike.
    fn agents(&self, at: usize, verb: &str) -> Readings<Party> {
        let all_who_do = || self.words.agent(verb).map(Party::Category);
        match self.any_of(at, "by") {
            Some(by) => {
                let mut found = self.parties(by);
                if let Some(end) = self.any_of(by, "somebody someone anybody anyone something") {
                    found.extend(all_who_do().map(|party| (party, end)));
                }
                found
            }
            None => all_who_do().map(|party| (party, at)).into_iter().collect(),
        }
    }

    /// The place after all of these words.
    fn all_of(&self, at: usize, words: &[String]) -> Option<usize> {
        let fits = self.rest(at).len() >= words.len() && words.iter().zip(self.rest(at)).all(|(a, b)| a == b);
        fits.then(|| self.reached(at + words.len()))
    }

    fn rank(&self, verb: &str, index: usize, pattern: &Pattern) -> (usize, usize) {
        (self.words.verb_rank(verb, pattern.takes_object), if pattern.is_said { index } else { 10 + index })
    }
}

/// Of the readings that end at the same place with an object or without one, those that fit best.
fn best(mut found: Vec<Ranked>) -> Readings<Clause> {
    let has_object = |clause: &Clause| match clause {
        Clause::Does { to, .. } => to.is_some(),
        _ => true,
    };
    found.sort_by_key(|(rank, ..)| *rank);
    let is_best = |(rank, clause, end): &&Ranked| {
        let rivals =
            found.iter().filter(|other| other.2 == *end && has_object(&other.1) == has_object(clause));
        rivals.map(|other| other.0).min().is_some_and(|least| least == *rank)
    };
    let chosen = found.iter().filter(is_best).map(|(_, clause, end)| (clause.clone(), *end)).collect();
    super::distinct(chosen)
}
