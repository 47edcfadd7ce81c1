//! Relations in space, extremes, ways on which something goes, and the words for when.

use l4d_query::{Clause, Relation, Superlative};

use super::Reader;

/// Prepositions of relations; of those with the same beginning the longest first.
const RELATIONS: [(&str, Relation); 12] = [
    ("in front of", Relation::InFrontOf),
    ("on top of|up on|on|upon", Relation::On),
    ("inside of|inside|within|in", Relation::In),
    ("underneath|beneath|below|under", Relation::Under),
    ("next to|close to|beside|alongside|near|by", Relation::Beside),
    ("leaning against|touching|against", Relation::Touching),
    ("turned towards|facing", Relation::Facing),
    ("between", Relation::Between),
    ("behind", Relation::Behind),
    ("closest to|nearest to|closer to|nearer to|nearest|nearer", Relation::ClosestTo),
    ("farthest away from|furthest away from|farther away from|further away from", Relation::FarthestFrom),
    ("farthest from|furthest from|farther from|further from", Relation::FarthestFrom),
];

const EXTREMES: [(&str, Superlative); 5] = [
    ("biggest|bigger|largest|larger", Superlative::Largest),
    ("smallest|smaller", Superlative::Smallest),
    ("tallest|taller", Superlative::Tallest),
    ("highest|higher", Superlative::Highest),
    ("lowest|lower", Superlative::Lowest),
];

const STARTS: &str = "at the very beginning|at the very start|at the beginning|at the start|\
     at the outset|in the beginning|to begin with|when the clip begins|\
     when the clip starts|when the video begins|when the video starts|\
     when the scene begins|when the scene starts|initially|at first";

const ENDS: &str = "at the very end|at the end|in the end|when the clip ends|when the video ends|\
     when the scene ends|when the clip is over|finally|at last";

/// Words that bind nothing: always, still, slowly.
pub(super) const FILLERS: &str = "all the time|the whole time|throughout the clip|throughout the video|\
     for the whole clip|during the whole clip|throughout|always|still|\
     also|later|afterwards|later on|just|slowly|quickly|gently|again|\
     at all|ever|only|itself|together|once|very";

/// Ways on which something moves: said for colour, they tell nothing apart.
const WAYS: &str = "away from|out of|off of|off|along|across|over|through|from|into|onto|past|\
     around|round|about|towards|toward|to and fro|back and forth|up|down|to|away|\
     back|with|in the air|on|in|at|by|out|against|under|for";

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

impl Reader<'_> {
    /// "at the beginning", "when the clip ends".
    pub(super) fn clip_end(&mut self) -> Option<ClipEnd> {
        let end = if self.take_any(STARTS).is_some() {
            ClipEnd::Start
        } else {
            self.take_any(ENDS).map(|_| ClipEnd::End)?
        };
        self.take_any("of the clip|of the video|of the scene");
        Some(end)
    }

    /// A relation with its parties: "between the lamp and the post".
    pub(super) fn relation(&mut self) -> Option<Clause> {
        self.attempt(|reader| {
            let (_, kind) =
                RELATIONS.into_iter().find(|(spellings, _)| reader.take_any(spellings).is_some())?;
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
        let found = EXTREMES.into_iter().find(|(spellings, _)| self.take_any(spellings).is_some());
        let (_, extreme) = found?;
        self.take_any("up|down|of all|of them all|one");
        Some(Clause::Superlative(extreme))
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
                        reader.take_any("its|his|her|the|their")?;
                        reader.lexicon.part(reader.word())?;
                        reader.advance(1);
                        Some(())
                    });
                    is_part
                        .or_else(|| {
                            reader.attempt(|reader| {
                                reader.take_any("its place|place|the air|it|the ground").map(|_| ())
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
