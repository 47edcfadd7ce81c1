//! What is done: verb phrases with or without objects, in the active and the passive, and with the object left out.

use l4d_query::{Clause, Party, Relation};

use super::data::{Doing, data};
use super::guess::{Guess, Guesses, cheapest};
use super::noun_phrase::{Article, Described};
use super::{Order, Wide};
use crate::lexicon::Form;

/// Words within a verb phrase that say nothing more.
const WITHIN: &str = "a an the its his her their some any little good quick big single old own up down back off out away along around over another again \
    tea water coffee something anything liquid one's right";
/// Particles that may go before or after an object.
const PARTICLES: [&str; 9] = ["up", "down", "over", "off", "out", "away", "along", "around", "open"];
/// Adverbs and the like after a verb.
const TRAILING: &str = "away|off|along|around|about|up|down|out|over|past|by hand|with one hand|with both hands|it|anything|them|with its nose|with its paw|with its snout|with its muzzle|with its head|with a hand|with one paw|with its foot|with a nose|with a paw|with her foot|\
    with his foot|with its foot|with a foot|with her hand|with his hand|on its own|through the air|across the table|across the floor|on the ground|on the floor|\
    on the table|off the table|off the ground|off the floor|from the table|from the floor|from the ground|to the ground|to the floor|to the table|\
    with its beak|in the air|on foot|into the road|into the street|round|with her hands|with his hands|with its nose first|back|back down|forward|forwards|\
    with its bill|water|some water|for a sip|to one side|in her arms|in his arms|in her hands|in his hands|in its hand|with the hand|into it|from it|in it|on it|at it|with it|\
    back and forth|backwards|low|further|more|on the spot|in place|to go|to pass|to go past|to move|to go by|to get by|to drive by|to come past|to get past|up to it|down the road|along the road|across the tabletop";

/// All phrases of the grammar of events, whose words are no misspellings.
pub(super) const PHRASES: &[&str] = &[WITHIN, TRAILING];

impl Wide<'_, '_> {
    /// The place after these words, whatever says nothing in between.
    fn after_words(&self, at: usize, words: &[String]) -> Option<usize> {
        let mut at = at;
        for wanted in words {
            let mut steps = 0;
            while self.word(at) != wanted {
                at = self.any_of(at, WITHIN)?;
                steps += 1;
                if steps > 4 {
                    return None;
                }
            }
            at += 1;
        }
        Some(at)
    }

    /// What the subject does: "lifts a cup", "goes for a stroll".
    pub(super) fn event(
        &self,
        at: usize,
        forms: &[Form],
        subject: Option<&str>,
        with_object: bool,
    ) -> Guesses<Clause> {
        let mut found = Vec::new();
        for (form, doing) in data().doings_at(self.word(at)) {
            if !forms.contains(&form) {
                continue;
            }
            let Some(end) = self.after_words(at + 1, &doing.before) else {
                if with_object && doing.takes_object {
                    self.parted(at, doing, subject, &mut found);
                }
                continue;
            };
            if !doing.takes_object {
                let Some((verb, misfit)) = self.verb(doing, subject, None) else { continue };
                found.push(Guess::new(
                    Clause::Does { verb, to: None },
                    end,
                    misfit + doing.cost + plain_price(doing),
                ));
                continue;
            }
            if !with_object {
                continue;
            }
            if let Some(end) = self
                .any_of(end, "something someone somebody anything anyone anybody")
                .and_then(|end| self.after_words(end, &doing.after))
                && let Some((verb, misfit)) = self.verb(doing, subject, None)
            {
                found.push(Guess::new(Clause::Does { verb, to: None }, end, misfit + 3));
            }
            // "Who kicks first": the object goes without saying.
            if doing.after.is_empty()
                && !matches!(self.word(at), "with" | "in" | "on" | "has" | "have")
                && let Some((verb, misfit)) = self.verb(doing, subject, None)
            {
                found.push(Guess::new(Clause::Does { verb, to: None }, end, misfit + 7 + doing.cost));
            }
            for object in self.objects(end, subject) {
                let Some(end) = self.after_words(object.end, &doing.after) else { continue };
                let (party, noun, is_no) = &object.value;
                let Some((verb, misfit)) = self.verb(doing, subject, Some(noun)) else { continue };
                let clause = Clause::Does { verb, to: Some(party.clone()) };
                let clause = if *is_no { super::negated(clause) } else { clause };
                let cost = misfit + doing.cost + plain_price(doing);
                found.push(object.clone().map(|_| clause).ending(end).plus(cost));
            }
        }
        self.trailing(cheapest(found))
    }

    /// "puts the jug down": the particle after the object.
    fn parted(&self, at: usize, doing: &Doing, subject: Option<&str>, found: &mut Guesses<Clause>) {
        let is_particle = doing.before.len() == 1
            && PARTICLES.contains(&doing.before[0].as_str())
            && doing.after.is_empty();
        if !is_particle {
            return;
        }
        for object in self.objects(at + 1, subject) {
            let Some(end) = self.after_words(object.end, &doing.before) else { continue };
            let (party, noun, is_no) = &object.value;
            let Some((verb, misfit)) = self.verb(doing, subject, Some(noun)) else { continue };
            let clause = Clause::Does { verb, to: Some(party.clone()) };
            let clause = if *is_no { super::negated(clause) } else { clause };
            found.push(object.clone().map(|_| clause).ending(end).plus(misfit + doing.cost + 2));
        }
    }

    /// Objects of a verb; "no basket" says that it is not done.
    fn objects(&self, at: usize, subject: Option<&str>) -> Guesses<(Party, String, bool)> {
        let mut found: Guesses<(Party, String, bool)> = self
            .parties(at)
            .into_iter()
            .map(|guess| guess.map(|(party, noun)| (party, noun, false)))
            .collect();
        // "Doesn't chase one": any of what was spoken of.
        if let Some(end) = self.any_of(at, "one them any") {
            let nouns = self.mentioned(at).into_iter();
            found.extend(
                nouns.map(|(noun, cost)| {
                    Guess::new((Party::Category(noun.clone()), noun, false), end, cost + 3)
                }),
            );
        }
        // "Without putting it down": what was spoken of besides the subject.
        if let (Some(end), None) = (self.any_of(at, "it"), &self.before) {
            let others = self
                .mentions
                .iter()
                .rev()
                .filter(|(place, noun)| *place < at && subject.is_some_and(|own| own != noun));
            for (_, noun) in others.take(1) {
                let such = Described {
                    article: Article::The,
                    noun: noun.clone(),
                    clauses: Vec::new(),
                    is_plural: false,
                };
                found.push(Guess::new((self.party(&such), noun.clone(), false), end, 5));
            }
        }
        for guess in self.described(at, false).iter().filter(|guess| guess.value.article == Article::No) {
            let mut such = guess.value.clone();
            such.article = Article::A;
            found.push(guess.clone().map(|_| (self.party(&such), such.noun.clone(), true)));
        }
        cheapest(found)
    }

    /// Which of the verbs that it may mean fits best, and how badly.
    fn verb(&self, doing: &Doing, subject: Option<&str>, object: Option<&str>) -> Option<(String, u32)> {
        let ranked = doing.verbs.iter().enumerate();
        let ranked = ranked.map(|(at, verb)| (self.words.misfit(verb, subject, object) + at as u32, verb));
        ranked.min_by_key(|(cost, _)| *cost).map(|(cost, verb)| (verb.clone(), cost))
    }

    /// With adverbs after them.
    fn trailing<T: Clone>(&self, guesses: Guesses<T>) -> Guesses<T> {
        let mut found = guesses.clone();
        for guess in guesses {
            if let Some(end) = self.phrase(guess.end, TRAILING) {
                let again = self.phrase(end, TRAILING);
                found.push(guess.clone().ending(end).plus(1));
                found.extend(again.map(|end| guess.ending(end).plus(2)));
            }
        }
        found
    }

    /// What is done to the subject: "lifted by a hand", "held in a hand", "tilted".
    pub(super) fn passive(&self, at: usize, subject: &str) -> Guesses<Clause> {
        let mut found = Vec::new();
        for (form, doing) in data().doings_at(self.word(at)) {
            if form != Form::Participle {
                continue;
            }
            if !doing.takes_object {
                // "Is tilted": of what tilts.
                if let Some(end) = self.after_words(at + 1, &doing.before)
                    && let Some((verb, misfit)) = self.verb(doing, Some(subject), None)
                {
                    found.push(Guess::new(Clause::Does { verb, to: None }, end, misfit + 6));
                }
                continue;
            }
            let words: Vec<String> = doing.before.iter().chain(&doing.after).cloned().collect();
            let Some(mut end) = self.after_words(at + 1, &words) else { continue };
            end = self.skip(end, "up|down|back down|back up|along|around|round|over|out|off|away|to|it|them|into it|in it|on it|back");
            // "Picked up first by a hand".
            let order = match self.word(end) {
                "first" | "@first" => Some(Order::First),
                "last" | "@last" | "second" => Some(Order::Last),
                _ => None,
            };
            let end = if order.is_some() && self.any_of(end + 1, "by").is_some() { end + 1 } else { end };
            let order = order.filter(|_| self.any_of(end, "by").is_some());
            let wrapped = |clause: Clause| match order {
                Some(Order::First) => Clause::First(Box::new(clause)),
                Some(Order::Last) => Clause::Last(Box::new(clause)),
                None => clause,
            };
            if let Some(by) = self.any_of(end, "by in from with into out") {
                let price = if self.word(end) == "by" { 0 } else { 4 };
                let by = self.skip(by, "of");
                for agent in self.agents(by) {
                    let (party, noun, is_no) = &agent.value;
                    let Some((verb, misfit)) = self.verb(doing, Some(noun), Some(subject)) else { continue };
                    let clause = wrapped(Clause::Undergoes { verb, by: party.clone() });
                    let clause = if *is_no { super::negated(clause) } else { clause };
                    let cost = misfit + price + doing.cost + plain_price(doing);
                    found.push(agent.clone().map(|_| clause).plus(cost));
                }
            }
            if let Some((verb, misfit)) = self.verb(doing, None, Some(subject))
                && let Some(agent) = self.words.usual_agent(&verb, subject)
            {
                let clause = Clause::Undergoes { verb, by: Party::Category(agent) };
                let by_somebody =
                    self.phrase(end, "by somebody|by someone|by anybody|by anyone|by something");
                found.push(Guess::new(clause.clone(), end, misfit + 3 + doing.cost + plain_price(doing)));
                found.extend(
                    by_somebody.map(|end| Guess::new(clause, end, misfit + doing.cost + plain_price(doing))),
                );
            }
        }
        self.trailing(cheapest(found))
    }

    /// Who does it, and whether it says that none does.
    fn agents(&self, at: usize) -> Guesses<(Party, String, bool)> {
        let mut found: Guesses<(Party, String, bool)> = Vec::new();
        if let Some(before) = self
            .any_of(at, "it him her them")
            .and_then(|end| self.before.as_ref().map(|before| (before, end)))
        {
            found.push(Guess::new((self.party(before.0), before.0.noun.clone(), false), before.1, 0));
        }
        for guess in self.described(at, false).iter() {
            let mut such = guess.value.clone();
            let is_no = such.article == Article::No;
            if is_no {
                such.article = Article::A;
            }
            found.push(guess.clone().map(|_| (self.party(&such), such.noun.clone(), is_no)));
        }
        cheapest(found)
    }

    /// "the blue ball is kicked", where what is spoken of is who does it.
    pub(super) fn acted_by(&self, at: usize, subject: &str) -> Guesses<Vec<Clause>> {
        let mut found = Vec::new();
        for object in self.parties(at) {
            let Some(next) = self.any_of(object.end, "is was gets got") else { continue };
            let next = self.skip(next, "being|been");
            let (party, noun) = &object.value;
            for (form, doing) in data().doings_at(self.word(next)).filter(|(_, doing)| doing.takes_object) {
                let words: Vec<String> = doing.before.iter().chain(&doing.after).cloned().collect();
                let Some(end) = self.after_words(next + 1, &words).filter(|_| form == Form::Participle)
                else {
                    continue;
                };
                let Some((verb, misfit)) = self.verb(doing, Some(subject), Some(noun)) else { continue };
                let clause = Clause::Does { verb, to: Some(party.clone()) };
                found.push(object.clone().map(|_| vec![clause]).ending(end).plus(misfit + doing.cost));
            }
        }
        cheapest(found)
    }

    /// After "gets a": "kick from the woman", "push by a hand".
    pub(super) fn given(&self, at: usize, object: &str) -> Guesses<Vec<Clause>> {
        let mut found = Vec::new();
        let what = self.word(at).to_owned();
        for (_, doing) in data()
            .doings_at("give")
            .filter(|(form, doing)| *form == Form::Base && doing.after == [what.clone()])
        {
            let Some(from) = self.any_of(at + 1, "from by") else { continue };
            for agent in self.agents(from) {
                let (party, noun, is_no) = &agent.value;
                let Some((verb, misfit)) = self.verb(doing, Some(noun), Some(object)) else { continue };
                let clause = Clause::Undergoes { verb, by: party.clone() };
                let clause = if *is_no { super::negated(clause) } else { clause };
                found.push(agent.clone().map(|_| vec![clause]).plus(misfit));
            }
        }
        cheapest(found)
    }

    /// What somebody does to the thing that is spoken of: "a hand lifts", "the cat is batting it", "nobody touches".
    pub(super) fn done_by(&self, at: usize, object: &str) -> Guesses<Vec<Clause>> {
        let mut found = Vec::new();
        let mut subjects: Guesses<Option<(Party, String, bool)>> =
            self.agents(at).into_iter().map(|guess| guess.map(Some)).collect();
        if let Some(end) = self.any_of(at, "somebody someone something anybody anyone people you they") {
            subjects.push(Guess::new(None, end, 2));
        }
        let nobody = self.any_of(at, "nobody nothing none");
        if let Some(end) = nobody {
            subjects.push(Guess::new(None, end, 0));
        }
        if let (Some(end), Some(before)) = (self.any_of(at, "she he it they"), &self.before) {
            subjects.push(Guess::new(Some((self.party(before), before.noun.clone(), false)), end, 0));
        }
        for subject in subjects {
            let mut is_not = subject.value.as_ref().map_or(nobody.is_some(), |(_, _, is_no)| *is_no);
            let mut next = self.skip(subject.end, "also|first");
            while let Some(after) = self.any_of(next, "is are was were has have had does do did gets never not being ever will can been starts begins to keeps") {
                is_not ^= matches!(self.word(next), "never" | "not");
                next = after;
            }
            let by = subject.value.as_ref();
            for (verb, end, cost) in self.verbs_of(next, by, object) {
                let Some(party) = by
                    .map(|(party, ..)| party.clone())
                    .or_else(|| self.words.usual_agent(&verb, object).map(Party::Category))
                else {
                    continue;
                };
                let clause = Clause::Undergoes { verb, by: party.clone() };
                let clause = if is_not { super::negated(clause) } else { clause };
                // "Has hold of it and is turning it".
                if let Some(and) = self.phrase(end, "and is|and was|and then is|and|, and") {
                    for (verb, end, more) in self.verbs_of(and, by, object) {
                        let second = Clause::Undergoes { verb, by: party.clone() };
                        found.push(
                            subject
                                .clone()
                                .map(|_| vec![clause.clone(), second])
                                .ending(end)
                                .plus(cost + more),
                        );
                    }
                }
                found.push(subject.clone().map(|_| vec![clause]).ending(end).plus(cost));
            }
            // "That the hand is farthest from": the same of the two.
            if let Some((party, ..)) = by {
                for (kind, phrases) in [
                    (Relation::FarthestFrom, "farthest from|the farthest from|farther from"),
                    (Relation::ClosestTo, "closest to|the closest to|closer to"),
                    (Relation::Beside, "beside|next to|near"),
                    (Relation::Touching, "touching|touches"),
                ] {
                    let Some(end) = self.phrase(next, phrases) else { continue };
                    let end = self.skip(end, "it|him|her|them");
                    let clause = Clause::Relation { kind, of: vec![party.clone()] };
                    let clause = if is_not { super::negated(clause) } else { clause };
                    found.push(subject.clone().map(|_| vec![clause]).ending(end).plus(2));
                }
            }
        }
        self.trailing(cheapest(found))
    }

    /// Verbs at a place whose object is what is spoken of, left out or as a pronoun.
    fn verbs_of(
        &self,
        at: usize,
        by: Option<&(Party, String, bool)>,
        object: &str,
    ) -> Vec<(String, usize, u32)> {
        let mut found = Vec::new();
        let pronouns = "it him her them";
        for (form, doing) in data().doings_at(self.word(at)) {
            if !doing.takes_object || form == Form::Participle && self.word(at).ends_with("ing") {
                continue;
            }
            let Some((verb, misfit)) = self.verb(doing, by.map(|(_, noun, _)| noun.as_str()), Some(object))
            else {
                continue;
            };
            let cost = misfit + doing.cost + plain_price(doing);
            let past = if matches!(form, Form::Past | Form::Participle) { 1 } else { 0 };
            if let Some(end) = self.after_words(at + 1, &doing.before) {
                for end in [Some(end), self.any_of(end, pronouns)].into_iter().flatten() {
                    found.extend(
                        self.after_words(end, &doing.after).map(|end| (verb.clone(), end, cost + past)),
                    );
                }
            }
            // "Puts it down".
            if let Some(end) = self.any_of(at + 1, pronouns) {
                found.extend(
                    self.after_words(end, &doing.before)
                        .filter(|_| doing.after.is_empty())
                        .map(|end| (verb, end, cost + past)),
                );
            }
        }
        found
    }
}

/// A bare verb says less than a phrase.
fn plain_price(doing: &Doing) -> u32 {
    4_u32.saturating_sub(2 * (doing.before.len() + doing.after.len()) as u32)
}
