//! How often each word occurs in the sentences, and what kind of word it is.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::prove::{SceneSet, Vocabulary, words};

/// A word of the sentences.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct WordRow {
    /// Lower case.
    pub word: String,
    /// As `vocabulary.txt` says: noun, verb, preposition, adjective, adverb or other.
    pub kind: String,
    /// Occurrences in queries of one and of two categories.
    pub count: usize,
    /// Scenes in whose sentences it occurs.
    pub scenes: usize,
}

/// Words by falling frequency, then alphabet.
pub(super) fn count(sets: &[SceneSet], vocabulary: &Vocabulary) -> Vec<WordRow> {
    let mut counts: BTreeMap<String, (usize, Vec<usize>)> = BTreeMap::new();
    for (index, set) in sets.iter().enumerate() {
        let composites = set.composites.iter().filter(|query| query.status != l4d_data::Status::Rejected);
        let queries = set.scored().map(|(query, _)| query).chain(composites);
        for word in queries.flat_map(|query| words(&query.text)) {
            let (count, scenes) = counts.entry(word).or_default();
            *count += 1;
            if scenes.last() != Some(&index) {
                scenes.push(index);
            }
        }
    }
    let row = |(word, (count, scenes)): (String, (usize, Vec<usize>))| {
        let kind = vocabulary.kind(&word).to_owned();
        WordRow { word, kind, count, scenes: scenes.len() }
    };
    let mut rows: Vec<WordRow> = counts.into_iter().map(row).collect();
    rows.sort_by(|a, b| b.count.cmp(&a.count).then_with(|| a.word.cmp(&b.word)));
    rows
}
