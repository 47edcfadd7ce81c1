//! What somebody wears, what something has: "in the pink dress", "with a wooden knob on its lid".

use l4d_query::{Clause, Party, Relation};

use super::Reader;
use super::phrase::attribute;
use super::places::FILLERS;

impl Reader<'_> {
    /// "grey-haired" as (hair, grey).
    pub(super) fn part_compound(&self, word: &str) -> Option<(String, String)> {
        let (value, tail) = word.split_once('-')?;
        let stem = tail.strip_suffix("ed")?;
        let part = [stem, &format!("{stem}e")]
            .into_iter()
            .find(|part| self.lexicon.part(part).is_some())?
            .to_owned();
        let is_value = self.lexicon.colour(value).is_some()
            || self.lexicon.attribute(value).is_some()
            || self.lexicon.is_quality(value);
        is_value.then(|| (part, value.to_owned()))
    }

    /// "whose dress is dotted".
    pub(super) fn whose(&mut self) -> Option<Vec<Clause>> {
        if !self.take("whose") {
            return None;
        }
        let part = self.word().to_owned();
        self.lexicon.part(&part)?;
        self.advance(1);
        self.take_any("is|are")?;
        let is_negated = self.take("not");
        self.skip(FILLERS);
        let value = self.value()?;
        // What the whole is made of is not finer than what is said of its part.
        self.loose_tail();
        let clause = attribute_of(&part, value);
        Some(vec![if is_negated { Clause::Not(Box::new(clause)) } else { clause }])
    }

    /// "with the ponytail", "in the pink dress", "wearing trousers", "made of steel", "with water in it".
    pub(super) fn appearance(&mut self) -> Option<Vec<Clause>> {
        if self.take("made of") || self.take("made from") {
            let (key, value) = self.value()?;
            self.lexicon.part(self.word()).is_some().then(|| self.advance(1));
            self.take("metal");
            return Some(vec![attribute(&key, &value)]);
        }
        let preposition = self.take_any("with no|without|with|wearing|in|has|having|has got")?;
        let is_negated = matches!(preposition, "with no" | "without");
        if let Some(clause) = self.attempt(Self::carries_on_top) {
            return Some(vec![if is_negated { Clause::Not(Box::new(clause)) } else { clause }]);
        }
        let mut clauses = self.attempt(|reader| reader.part_phrase(preposition == "in"))?;
        while self.word() == "and" {
            let more = self.attempt(|reader| {
                reader.take("and");
                reader.part_phrase(false)
            });
            let Some(more) = more else { break };
            clauses.extend(more);
        }
        if is_negated {
            clauses = clauses.into_iter().map(|clause| Clause::Not(Box::new(clause))).collect();
        }
        Some(clauses)
    }

    /// "(with) another block standing on it".
    fn carries_on_top(&mut self) -> Option<Clause> {
        let other = self.party()?;
        self.take_any("standing|sitting|lying|resting");
        let kind = match self.take_any("on top of it|on it|in it|inside it|under it|beside it|next to it")? {
            "on top of it" | "on it" | "in it" | "inside it" => Relation::Under,
            "under it" => Relation::On,
            _ => Relation::Beside,
        };
        let is_material = matches!(&other, Party::Name(name) if self.lexicon.is_material(name))
            || matches!(&other, Party::Category(noun) if self.lexicon.is_material(noun));
        match (is_material, &other) {
            (true, Party::Name(noun)) => Some(attribute("content", noun)),
            (true, Party::Category(noun)) => Some(attribute("content", noun)),
            _ => Some(Clause::Relation { kind, of: vec![other] }),
        }
    }

    /// "a wooden knob on its lid", "the checked shirt", "pink".
    fn part_phrase(&mut self, is_worn: bool) -> Option<Vec<Clause>> {
        self.take_any("the|an|a|two|its|his|her");
        let mut values = Vec::new();
        loop {
            self.skip(",");
            while self.is_possessive(self.at) {
                self.advance(1);
            }
            let word = self.word().to_owned();
            let ends_here = self.lexicon.part(&word).is_some()
                || self.lexicon.attribute(&word).is_some_and(|(key, _)| key == "hair");
            if ends_here && self.lexicon.part(self.ahead(1)).is_none() {
                self.advance(1);
                if self.lexicon.part(&word).is_none() {
                    let (key, value) = self.lexicon.attribute(&word)?;
                    values.push((key.to_owned(), value.to_owned()));
                    self.loose_tail();
                    return Some(values.into_iter().map(|(key, value)| attribute(&key, &value)).collect());
                }
                self.loose_tail();
                return Some(self.part_clauses(&word, values));
            }
            match self.value() {
                Some(value) => values.push(value),
                None => break,
            }
        }
        // "in pink": what somebody wears; "with stripes": what it looks like.
        let alone = values.last().is_some_and(|(key, _)| key == "colour");
        if is_worn && !alone {
            return None;
        }
        let clause = |(key, value): (String, String)| {
            if key == "colour" { attribute("clothes", &value) } else { attribute(&key, &value) }
        };
        self.loose_tail();
        (!values.is_empty()).then(|| values.into_iter().map(clause).collect())
    }

    fn part_clauses(&self, part: &str, values: Vec<(String, String)>) -> Vec<Clause> {
        let group = self.lexicon.part(part).unwrap_or_default().to_owned();
        if values.is_empty() {
            let clause = if group == "clothes" { attribute("clothes", part) } else { attribute(part, "any") };
            return vec![clause];
        }
        let mut clauses = Vec::new();
        if group == "clothes" && values.iter().all(|(key, _)| key == "pattern") {
            clauses.push(attribute("clothes", part));
        }
        clauses.extend(values.into_iter().map(|value| attribute_of(part, value)));
        clauses
    }

    /// A colour, pattern, material, shape or quality, as (key, value).
    fn value(&mut self) -> Option<(String, String)> {
        if let Some(colour) = self.colour() {
            return Some(("colour".to_owned(), colour));
        }
        let word = self.word().to_owned();
        let found = match self.lexicon.attribute(&word) {
            Some((key, value)) => (key.to_owned(), value.to_owned()),
            None if self.lexicon.is_quality(&word) => ("quality".to_owned(), word.clone()),
            None => return None,
        };
        self.advance(1);
        Some(found)
    }

    /// Where a part is: of no use to whom sees no parts.
    fn loose_tail(&mut self) {
        const PLACES: &str = "on either side|on both sides|on it|in it";
        const PARTS: &str = "on its|around its|round its|along the|along its|at the|down to the|\
             at its|on the";
        for _ in 0..3 {
            let read = self.attempt(|reader| {
                if reader.take_any(PLACES).is_some() {
                    return Some(());
                }
                reader.take_any(PARTS)?;
                let from = reader.at;
                while reader.lexicon.part(reader.word()).is_some()
                    || reader.lexicon.attribute(reader.word()).is_some()
                {
                    reader.advance(1);
                }
                (reader.at > from).then_some(())
            });
            if read.is_none() {
                return;
            }
        }
    }
}

/// "wooden" of a knob is a property of the knob; "striped" of a shirt is a pattern.
fn attribute_of(part: &str, (key, value): (String, String)) -> Clause {
    if key == "pattern" { attribute("pattern", &value) } else { attribute(part, &value) }
}
