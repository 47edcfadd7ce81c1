//! Descriptions: "the red bucket on the cart that nobody lifts".

use l4d_data::Temporal;
use l4d_query::{Clause, Party};

use super::places::FILLERS;
use super::{ANY_PERSON, MAX_NESTING, Order, Phrase, Reader};

const ARTICLES: &str = "one of the|the other two|the other|the same|the two|the|an other|another|an|a|\
     any other|any|some|this|that|these|those|its own|its|his|her|their|each|every|\
     both|two";
const INDEFINITE: &str = "another|an other|an|a|any other|any|some|the other two|each|every|two|one of the";
const SHADES: &str = "light|dark|pale|bright";
const WHILES: &str = "whenever|while|when|as long as|during the time when|at the moment when|\
     the moment|as";

impl Reader<'_> {
    /// A noun with all that is said of it. `is_head`: of the sentence, not of another one within it.
    pub(super) fn description(&mut self, is_head: bool) -> Option<Phrase> {
        if self.nesting >= MAX_NESTING {
            return None;
        }
        self.nesting += 1;
        let phrase = self.attempt(|reader| reader.described(is_head));
        self.nesting -= 1;
        phrase
    }

    fn described(&mut self, is_head: bool) -> Option<Phrase> {
        let article = self.take_any(ARTICLES);
        let mut phrase = Phrase {
            noun: String::new(),
            is_definite: article.is_none_or(|article| !INDEFINITE.split('|').any(|one| one == article)),
            is_plural: false,
            clauses: Vec::new(),
            temporal: Temporal::Whole,
            order: None,
        };
        self.before_noun(&mut phrase);
        let is_plural = self.noun(&mut phrase)?;
        phrase.is_plural |= is_plural && !is_head;
        if is_head {
            self.nouns.push(phrase.noun.clone());
            phrase.is_plural = is_plural && phrase.order.is_none() && phrase.clauses.is_empty();
            self.after_noun(&mut phrase);
        } else {
            self.after_party(&mut phrase);
        }
        Some(phrase)
    }

    /// Adjectives, extremes, ordinals.
    fn before_noun(&mut self, phrase: &mut Phrase) {
        loop {
            self.skip(",|very");
            if self.at + 1 < self.words.len() && self.noun_length().is_some_and(|length| length > 1) {
                return; // "toy car", "wooden stand": a noun of several words wins over its adjectives
            }
            if let Some(extreme) = self.extreme() {
                phrase.clauses.push(extreme);
                self.take_any("of the two|of the");
            } else if self.take("first") {
                phrase.order = Some(Order::First);
                self.take("of the");
            } else if self.take("last") {
                phrase.order = Some(Order::Last);
                self.take("of the");
            } else if let Some(clause) = self.adjective() {
                phrase.clauses.push(clause);
            } else {
                return;
            }
        }
    }

    /// "red", "black and white", "light blue", "wooden", "grey-haired".
    fn adjective(&mut self) -> Option<Clause> {
        if let Some(colour) = self.colour() {
            return Some(attribute("colour", &colour));
        }
        let word = self.word().to_owned();
        if let Some((part, value)) = self.part_compound(&word) {
            self.advance(1);
            return Some(attribute(&part, &value));
        }
        // The word may be the noun itself: "the glass", "the tin".
        let is_noun =
            self.lexicon.noun_at(std::slice::from_ref(&word)).is_some() && self.noun_after(1).is_none();
        if let (Some((key, value)), false) = (self.lexicon.attribute(&word), is_noun) {
            let clause = attribute(key, value);
            self.advance(1);
            return Some(clause);
        }
        let readings = self.lexicon.verbs_at(&word).iter();
        let verb = readings.filter(|reading| {
            reading.form == super::super::lexicon::Form::Ing && reading.particles.is_empty()
        });
        let verb = verb
            .filter_map(|reading| self.lexicon.verb(reading.verb))
            .find(|verb| !verb.motion.is_mutual())?;
        let clause = Clause::Does { verb: verb.name.clone(), to: None };
        (self.noun_after(1).is_some() && !is_noun).then(|| {
            self.advance(1);
            clause
        })
    }

    /// Name of a colour, or of two.
    pub(super) fn colour(&mut self) -> Option<String> {
        self.attempt(|reader| {
            let shade = SHADES.split('|').find(|shade| reader.take(shade));
            let name = reader.lexicon.colour(reader.word())?.to_owned();
            // An orange is a fruit unless it is the colour of something.
            let is_noun = reader.lexicon.noun_at(std::slice::from_ref(&name)).is_some();
            let is_followed =
                reader.noun_after(1).is_some() || reader.lexicon.part(reader.ahead(1)).is_some();
            if is_noun && !is_followed && !reader.ahead(1).is_empty() {
                return None;
            }
            reader.advance(1);
            let shaded = shade.map(|shade| format!("{shade}_{name}"));
            let name = shaded.filter(|shaded| reader.lexicon.colour(shaded).is_some()).unwrap_or(name);
            if reader.word() == "and"
                && let Some(second) = reader.lexicon.colour(reader.ahead(1)).map(str::to_owned)
            {
                reader.advance(2);
                return Some(format!("{name}_and_{second}"));
            }
            Some(name)
        })
    }

    fn noun_length(&self) -> Option<usize> {
        self.lexicon.noun_at(self.rest()).map(|(_, _, length)| length)
    }

    fn noun_after(&self, words: usize) -> Option<usize> {
        let rest = self.rest().get(words..)?;
        let is_one = rest.first().is_some_and(|word| word == "one" || word == "ones");
        if is_one { Some(1) } else { self.lexicon.noun_at(rest).map(|(_, _, length)| length) }
    }

    /// Reads the noun; whether it is a plural.
    fn noun(&mut self, phrase: &mut Phrase) -> Option<bool> {
        if let Some((name, is_plural, length)) = self.lexicon.noun_at(self.rest()) {
            phrase.noun = name.to_owned();
            self.advance(length);
            return Some(is_plural);
        }
        let is_plural = self.take_any("ones|others").is_some();
        let stands_for_another = is_plural || self.take_any("one|other").is_some();
        if stands_for_another {
            phrase.noun = self.nouns.last().cloned().unwrap_or_else(|| "thing".to_owned());
            return Some(is_plural);
        }
        if self.lexicon.is_material(self.word()) {
            phrase.noun = self.word().to_owned();
            self.advance(1);
            return Some(false);
        }
        None
    }

    /// What may follow another one within the sentence: what it wears or has, and what it does if it is alive.
    fn after_party(&mut self, phrase: &mut Phrase) {
        loop {
            let from = self.at;
            if let Some(clauses) = self.attempt(Self::appearance) {
                phrase.clauses.extend(clauses);
            } else if self.word() == "who" {
                let relative = self.attempt(|reader| {
                    reader.take("who");
                    reader.predicate()
                });
                phrase.clauses.extend(relative.unwrap_or_default());
            }
            if self.at == from {
                return;
            }
        }
    }

    /// Everything that may follow the noun of the sentence.
    fn after_noun(&mut self, phrase: &mut Phrase) {
        loop {
            let from = self.at;
            self.skip(",");
            if !self.after_noun_once(phrase) || self.at == from {
                return;
            }
        }
    }

    fn after_noun_once(&mut self, phrase: &mut Phrase) -> bool {
        if let Some(end) = self.clip_end() {
            let last = phrase.clauses.pop().map(|clause| end.of(clause));
            phrase.clauses.extend(last);
            return true;
        }
        if self.order_tail(phrase) || self.while_clause(phrase) || self.earlier_clause(phrase) {
            return true;
        }
        self.take_any(
            "and then|and afterwards|and later|and also|but also|although|though|and|but|\
             yet|then",
        );
        let joined = self
            .attempt(Self::relative)
            .or_else(|| self.attempt(Self::whose))
            .or_else(|| self.attempt(Self::appearance));
        let joined = joined.or_else(|| self.relation().map(|clause| vec![clause]));
        let joined = joined.or_else(|| {
            self.attempt(|reader| {
                reader.skip(FILLERS);
                reader.predicate()
            })
        });
        let joined =
            joined.or_else(|| self.attempt(|reader| reader.participle(None)).map(|clause| vec![clause]));
        let joined = joined.or_else(|| phrase.order.and_then(|_| self.attempt(Self::infinitive)));
        let Some(mut clauses) = joined else { return false };
        if let (Some(order), Some(event)) =
            (phrase.order, clauses.iter_mut().find(|clause| is_plain_event(clause)))
        {
            *event = order.of(event.clone());
            phrase.order = None;
        }
        phrase.clauses.extend(clauses);
        true
    }

    /// "... is tilted first", "... after another one".
    fn order_tail(&mut self, phrase: &mut Phrase) -> bool {
        let Some(event) = phrase.clauses.last_mut().filter(|clause| is_plain_event(clause)) else {
            return false;
        };
        let order = if self.take("first") {
            Order::First
        } else if self
            .take_any(
                "last|after another one|after the others|after the other one|\
                 after the other",
            )
            .is_some()
        {
            Order::Last
        } else if self
            .take_any(
                "before the others|before the other one|before the other|\
                 before another one",
            )
            .is_some()
        {
            Order::First
        } else {
            return false;
        };
        *event = order.of(event.clone());
        true
    }

    /// "while it is being held", "when somebody strokes it".
    fn while_clause(&mut self, phrase: &mut Phrase) -> bool {
        let clauses = self.attempt(|reader| {
            reader.take_any(WHILES)?;
            let clauses = reader.attempt(|reader| {
                reader.take_any("it|she|he|they");
                reader.predicate()
            });
            clauses
                .or_else(|| reader.attempt(Self::done_to_it))
                .or_else(|| reader.relation().map(|clause| vec![clause]))
        });
        let Some(clauses) = clauses else { return false };
        phrase.temporal = Temporal::While;
        phrase.clauses.extend(clauses);
        true
    }

    /// "before anybody lifts it": what was said of a place is said of the start.
    fn earlier_clause(&mut self, phrase: &mut Phrase) -> bool {
        let is_place =
            matches!(phrase.clauses.last(), Some(Clause::Relation { .. } | Clause::Superlative(_)));
        let is_read = is_place
            && self
                .attempt(|reader| {
                    reader.take_any("before|until")?;
                    reader.attempt(Self::done_to_it).or_else(|| {
                        reader.take_any("it|she|he|they");
                        reader.predicate()
                    })
                })
                .is_some();
        if is_read {
            let last = phrase.clauses.pop().map(|clause| super::places::ClipEnd::Start.of(clause));
            phrase.clauses.extend(last);
        }
        is_read
    }

    /// "that walks", "which the woman lifts", "in which a spoon is stirred".
    fn relative(&mut self) -> Option<Vec<Clause>> {
        if self.take_any("in which|into which|on which").is_some() {
            let by = self.party()?;
            self.take_any("is being|is|are|gets")?;
            return self.participle(Some(by)).map(|clause| vec![clause]);
        }
        let is_said = self.take_any("that|which|who|whom").is_some();
        if is_said && let Some(clauses) = self.attempt(Self::predicate) {
            return Some(clauses);
        }
        let clause = self.attempt(Self::done_by_another)?;
        Some(vec![clause])
    }

    /// "while somebody strokes it", "before anybody lifts it".
    fn done_to_it(&mut self) -> Option<Vec<Clause>> {
        let clause = self.done_by_another()?;
        Some(vec![clause])
    }

    /// "a cook stirs (it)", "nobody carries (it)", "a jug is emptied into".
    fn done_by_another(&mut self) -> Option<Clause> {
        let is_negated = self.take_any("nobody|no one|no-one").is_some();
        let by = if is_negated { Party::Category(ANY_PERSON.to_owned()) } else { self.party()? };
        let clause = self.done_by(by)?;
        Some(if is_negated { Clause::Not(Box::new(clause)) } else { clause })
    }
}

/// Whether `first`, `last` and `then` may be said of it.
pub(super) fn is_plain_event(clause: &Clause) -> bool {
    matches!(clause, Clause::Does { .. } | Clause::Undergoes { .. })
}

pub(super) fn attribute(key: &str, value: &str) -> Clause {
    Clause::Attribute { key: key.to_owned(), value: value.to_owned() }
}
