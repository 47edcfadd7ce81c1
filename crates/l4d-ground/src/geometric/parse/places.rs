//! Relations in space, extremes, ways on which something goes, and the words for when.

use l4d_query::{Clause, Relation, Superlative};

use super::Reader;

/// Prepositions of relations, longest first.
const RELATIONS: &[(&str, Relation)] = &[
    ("in front of", Relation::InFrontOf),
    ("on top of", Relation::On),
    ("up on", Relation::On),
    ("inside of", Relation::In),
    ("next to", Relation::Beside),
    ("close to", Relation::Beside),
    ("leaning against", Relation::Touching),
    ("turned towards", Relation::Facing),
    ("closest to", Relation::ClosestTo),
    ("nearest to", Relation::ClosestTo),
    ("closer to", Relation::ClosestTo),
    ("nearer to", Relation::ClosestTo),
    ("nearest", Relation::ClosestTo),
    ("nearer", Relation::ClosestTo),
    ("farthest away from", Relation::FarthestFrom),
    ("furthest away from", Relation::FarthestFrom),
    ("farther away from", Relation::FarthestFrom),
    ("further away from", Relation::FarthestFrom),
    ("farthest from", Relation::FarthestFrom),
    ("furthest from", Relation::FarthestFrom),
    ("farther from", Relation::FarthestFrom),
    ("further from", Relation::FarthestFrom),
    ("on", Relation::On),
    ("upon", Relation::On),
    ("inside", Relation::In),
    ("within", Relation::In),
    ("in", Relation::In),
    ("underneath", Relation::Under),
    ("beneath", Relation::Under),
    ("below", Relation::Under),
    ("under", Relation::Under),
    ("beside", Relation::Beside),
    ("alongside", Relation::Beside),
    ("near", Relation::Beside),
    ("by", Relation::Beside),
    ("between", Relation::Between),
    ("behind", Relation::Behind),
    ("touching", Relation::Touching),
    ("against", Relation::Touching),
    ("facing", Relation::Facing),
];

const EXTREMES: &[(&str, Superlative)] = &[
    ("biggest", Superlative::Largest),
    ("bigger", Superlative::Largest),
    ("largest", Superlative::Largest),
    ("larger", Superlative::Largest),
    ("smallest", Superlative::Smallest),
    ("smaller", Superlative::Smallest),
    ("tallest", Superlative::Tallest),
    ("taller", Superlative::Tallest),
    ("highest", Superlative::Highest),
    ("higher", Superlative::Highest),
    ("lowest", Superlative::Lowest),
    ("lower", Superlative::Lowest),
];

const STARTS: &[&str] = &[
    "at the very beginning",
    "at the very start",
    "at the beginning",
    "at the start",
    "at the outset",
    "in the beginning",
    "to begin with",
    "when the clip begins",
    "when the clip starts",
    "when the video begins",
    "when the video starts",
    "when the scene begins",
    "when the scene starts",
    "initially",
    "at first",
];

const ENDS: &[&str] = &[
    "at the very end",
    "at the end",
    "in the end",
    "when the clip ends",
    "when the video ends",
    "when the scene ends",
    "when the clip is over",
    "finally",
    "at last",
];

/// Words that bind nothing: always, still, slowly.
pub(super) const FILLERS: &[&str] = &[
    "all the time",
    "the whole time",
    "throughout the clip",
    "throughout the video",
    "for the whole clip",
    "during the whole clip",
    "throughout",
    "always",
    "still",
    "also",
    "later",
    "afterwards",
    "later on",
    "just",
    "slowly",
    "quickly",
    "gently",
    "again",
    "at all",
    "ever",
    "only",
    "itself",
    "together",
    "once",
    "very",
];

/// Ways on which something moves: said for colour, they tell nothing apart.
const WAYS: &[&str] = &[
    "away from",
    "out of",
    "off of",
    "off",
    "along",
    "across",
    "over",
    "through",
    "from",
    "into",
    "onto",
    "past",
    "around",
    "round",
    "about",
    "towards",
    "toward",
    "to and fro",
    "back and forth",
    "up",
    "down",
    "to",
    "away",
    "back",
    "with",
    "in the air",
    "on",
    "in",
    "at",
    "by",
    "out",
    "against",
    "under",
    "for",
];

/// Which end of the clip is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum ClipEnd {
    Start,
    End,
}

impl ClipEnd {
    /// The clause at that end, if it can change at all.
    pub(super) fn of(self, clause: Clause) -> Clause {
        if clause.is_constant() {
            return clause;
        }
        match self {
            Self::Start => Clause::AtStart(Box::new(clause)),
            Self::End => Clause::AtEnd(Box::new(clause)),
        }
    }
}

/// How relations and extremes are spelled.
#[cfg(test)]
pub(in super::super) fn place_words() -> impl Iterator<Item = &'static str> {
    RELATIONS.iter().map(|(text, _)| *text).chain(EXTREMES.iter().map(|(text, _)| *text))
}

impl Reader<'_> {
    /// "at the beginning", "when the clip ends".
    pub(super) fn clip_end(&mut self) -> Option<ClipEnd> {
        let end = if self.take_any(STARTS).is_some() {
            ClipEnd::Start
        } else {
            self.take_any(ENDS).map(|_| ClipEnd::End)?
        };
        self.take_any(&["of the clip", "of the video", "of the scene"]);
        Some(end)
    }

    /// A relation with its parties: "between the lamp and the post".
    pub(super) fn relation(&mut self) -> Option<Clause> {
        self.attempt(|reader| {
            let spellings: Vec<&str> = RELATIONS.iter().map(|(text, _)| *text).collect();
            let spelling = reader.take_any(&spellings)?;
            let kind = RELATIONS.iter().find(|(text, _)| *text == spelling).map(|(_, kind)| *kind)?;
            let first = reader.party()?;
            let mut of = vec![first];
            if kind.arity() == 2 {
                let second = if reader.take("and") { reader.party()? } else { of[0].clone() };
                of.push(second);
            }
            Some(Clause::Relation { kind, of })
        })
    }

    /// "highest up", "the tallest of the cups": the kind of extreme without what follows it.
    pub(super) fn extreme(&mut self) -> Option<Clause> {
        let spellings: Vec<&str> = EXTREMES.iter().map(|(text, _)| *text).collect();
        let spelling = self.take_any(&spellings)?;
        self.take_any(&["up", "down", "of all", "of them all", "one"]);
        EXTREMES.iter().find(|(text, _)| *text == spelling).map(|(_, extreme)| Clause::Superlative(*extreme))
    }

    /// Reads over ways and means: "along the hob", "from the spoon", "with its nose".
    pub(super) fn ways(&mut self) {
        for _ in 0..3 {
            self.skip(FILLERS);
            let read = self.attempt(|reader| {
                if reader.starts_another_clause() {
                    return None;
                }
                reader.take_any(WAYS)?;
                reader.attempt(|reader| {
                    let is_part = reader.attempt(|reader| {
                        reader.take_any(&["its", "his", "her", "the", "their"])?;
                        reader.lexicon.part(reader.word())?;
                        reader.advance(1);
                        Some(())
                    });
                    is_part
                        .or_else(|| {
                            reader.attempt(|reader| {
                                reader
                                    .take_any(&["its place", "place", "the air", "it", "the ground"])
                                    .map(|_| ())
                            })
                        })
                        .or_else(|| reader.party().map(|_| ()))
                });
                Some(())
            });
            if read.is_none() {
                return;
            }
        }
    }

    /// Times are not ways: "at the end", "at first".
    fn starts_another_clause(&mut self) -> bool {
        let at = self.at;
        let is_time = self.clip_end().is_some();
        self.at = at;
        is_time
    }
}
