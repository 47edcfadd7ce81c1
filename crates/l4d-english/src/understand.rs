//! The one reader of sentences: the strict grammar where it follows them, else the likeliest inferred readings.

use l4d_data::Temporal;
use l4d_query::{Clause, Predicate};

use crate::read::{Unread, readings};
use crate::wide::{self, Inferred};
use crate::words::Words;

/// Confidence of the best inferred reading: the strict grammar alone is sure.
const INFERRED: f64 = 0.95;
/// Confidence of what the grammar follows, where the scene has no such things or properties.
const STRANGE: f64 = 0.5;
/// Cost at which a reading is believed half as much.
const HALVING: f64 = 25.0;
/// Dearer readings are none.
const DEAREST: u32 = 90;
/// Nouns that are named to somebody who was not understood.
const MOST_NOUNS: usize = 12;
/// Words that are quoted.
const MOST_WORDS: usize = 6;

/// What a sentence means.
#[derive(Debug, Clone, PartialEq)]
pub struct Reading {
    /// Whom or what it describes, its clauses in canonical order.
    pub predicate: Predicate,
    /// Whether it names an identity or a while.
    pub temporal: Temporal,
    /// From 0 to 1; 1 is a sentence that the grammar follows word by word.
    pub confidence: f64,
    /// Words that were passed over and might have mattered.
    pub skipped: Vec<String>,
    /// Misspelled words, and what they were read as.
    pub repairs: Vec<(String, String)>,
}

impl Reading {
    /// A meaning that is certain.
    pub fn certain(predicate: Predicate, temporal: Temporal) -> Self {
        Self { predicate, temporal, confidence: 1.0, skipped: Vec::new(), repairs: Vec::new() }
    }

    /// Whether words were passed over or guessed at, so that somebody should be told.
    pub fn is_inferred(&self) -> bool {
        self.confidence < 1.0
    }

    /// "an inferred reading; skipped: ...; read \"teh\" as \"the\"", for a sentence that was not followed word by word.
    pub fn note(&self) -> Option<String> {
        if !self.is_inferred() {
            return None;
        }
        let mut note = "an inferred reading".to_owned();
        if !self.skipped.is_empty() {
            note.push_str(&format!("; skipped: {}", self.skipped.join(", ")));
        }
        for (written, meant) in &self.repairs {
            note.push_str(&format!("; read \"{written}\" as \"{meant}\""));
        }
        Some(note)
    }
}

/// What a sentence of everyday English means: at least one reading, the likeliest first.
///
/// # Errors
/// Which words mean nothing here, what there is to describe, and the nearest sentence that would be understood.
pub fn understand(text: &str, words: &Words<'_>) -> Result<Vec<Reading>, Unread> {
    let exact = |(predicate, temporal)| Reading {
        predicate,
        temporal,
        confidence: 1.0,
        skipped: Vec::new(),
        repairs: Vec::new(),
    };
    let length = text.split_whitespace().count();
    if length > wide::LONGEST {
        return Err(Unread::Long(length));
    }
    let strict = readings(text, words);
    if strict == Err(Unread::Empty) {
        return Err(Unread::Empty);
    }
    let mut found: Vec<Reading> = strict.unwrap_or_default().into_iter().take(1).map(exact).collect();
    for reading in &mut found {
        if !words.has_all_of(&reading.predicate) {
            reading.confidence = STRANGE;
        }
    }
    let inference = wide::infer(text, words);
    let believed = inference.readings.iter().filter(|reading| is_believed(reading, inference.length));
    for reading in believed {
        if found.iter().any(|own| own.predicate == reading.predicate && own.temporal == reading.temporal) {
            continue;
        }
        found.push(Reading {
            predicate: reading.predicate.clone(),
            temporal: reading.temporal,
            confidence: INFERRED * 0.5_f64.powf(f64::from(reading.cost) / HALVING),
            skipped: reading.skipped.clone(),
            repairs: inference.repairs.clone(),
        });
    }
    found.sort_by(|a, b| b.confidence.total_cmp(&a.confidence));
    if found.is_empty() {
        // What was taken for misspellings is not understood either.
        let repaired = inference.repairs.iter().map(|(written, _)| written);
        let mut strange: Vec<String> = Vec::new();
        for word in inference.unknown.iter().chain(repaired) {
            if !strange.contains(word) {
                strange.push(word.clone());
            }
        }
        return Err(unclear(&strange, inference.readings.first(), words));
    }
    Ok(found)
}

/// Whether enough of a sentence has been used to believe a reading of it.
fn is_believed(reading: &Inferred, length: usize) -> bool {
    let has_clauses = reading.predicate.0.len() > 1;
    let is_complete = reading.skipped.is_empty() && reading.cost < 40;
    (has_clauses && reading.cost <= DEAREST && reading.skipped.len() * 2 <= length)
        || (!has_clauses && is_complete)
}

fn unclear(unknown: &[String], nearest: Option<&Inferred>, words: &Words<'_>) -> Unread {
    let nouns: Vec<String> = words
        .categories()
        .into_iter()
        .filter(|category| words.is_object(category))
        .map(|category| category.replace('_', " "))
        .collect();
    let more = if nouns.len() > MOST_NOUNS { ", ..." } else { "" };
    let knows = format!("{}{more}", nouns.iter().take(MOST_NOUNS).cloned().collect::<Vec<_>>().join(", "));
    let is_clause =
        |predicate: &Predicate| predicate.0.iter().any(|clause| !matches!(clause, Clause::Category(_)));
    // Only what has one answer is suggested.
    let suggested = nearest.filter(|reading| {
        is_clause(&reading.predicate) && words.has_one_answer(&reading.predicate, reading.temporal)
    });
    let nearest = suggested.and_then(|reading| {
        crate::say::forms(&reading.predicate, reading.temporal, words).into_iter().next()
    });
    let words = unknown.iter().take(MOST_WORDS).cloned().collect();
    Unread::Unclear { words, knows, nearest }
}
