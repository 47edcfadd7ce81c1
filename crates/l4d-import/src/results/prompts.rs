//! Which query a foreign name means: a sentence, as file names spell it, or a number.

use std::collections::{BTreeMap, BTreeSet};

use l4d_data::{Query, Temporal};
use unicode_normalization::UnicodeNormalization as _;

use crate::annotations::base_object;

/// The queries of a scene by every name that files may call them.
#[derive(Debug)]
pub(super) struct Prompts<'a> {
    queries: &'a [Query],
    by_text: BTreeMap<String, Vec<usize>>,
    bases: BTreeSet<String>,
}

/// Why a name means no query.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum NoQuery {
    /// No query of the scene is like it; the nearest one, for a hint.
    Unknown {
        /// The sentence that differs least.
        nearest: Option<String>,
    },
    /// Several sentences are spelt alike as file names.
    Several(Vec<String>),
}

impl<'a> Prompts<'a> {
    /// The names of these queries.
    pub(super) fn new(queries: &'a [Query]) -> Self {
        let mut by_text: BTreeMap<String, Vec<usize>> = BTreeMap::new();
        for (index, query) in queries.iter().enumerate() {
            by_text.entry(spelling(&query.text)).or_default().push(index);
        }
        let gated = queries.iter().filter(|query| query.temporal == Temporal::While);
        let bases = gated.map(|query| spelling(&base_object(query)));
        let bases = bases.filter(|base| !by_text.contains_key(base)).collect();
        Self { queries, by_text, bases }
    }

    /// Whether a name is that of the object which a gated sentence is about, and no sentence: a category of its own in the
    /// annotations of 4D LangSplat, which its evaluation answers and averages like a sentence.
    pub(super) fn is_base_object(&self, name: &str) -> bool {
        self.bases.contains(&spelling(name))
    }

    /// The query that a number means: `003`, or `<scene>/003`.
    pub(super) fn by_number(&self, name: &str) -> Option<&'a Query> {
        let number = name.rsplit('/').next().unwrap_or(name);
        self.queries.iter().find(|query| query.id.number.as_str() == number)
    }

    /// The query whose sentence this is, whatever its case, blanks and Unicode form.
    pub(super) fn by_text(&self, name: &str) -> Result<&'a Query, NoQuery> {
        let spelling = spelling(name);
        match self.by_text.get(&spelling).map(Vec::as_slice) {
            Some([index]) => Ok(&self.queries[*index]),
            Some(several) => Err(NoQuery::Several(
                several.iter().map(|&index| self.queries[index].id.to_string()).collect(),
            )),
            None => {
                let far = |text: &str| strsim::levenshtein(start(&spelling), start(text));
                let nearest = self.by_text.iter().min_by_key(|(text, _)| far(text));
                Err(NoQuery::Unknown { nearest: nearest.map(|(_, all)| self.queries[all[0]].text.clone()) })
            }
        }
    }

    /// A number first, then a sentence.
    pub(super) fn find(&self, name: &str) -> Result<&'a Query, NoQuery> {
        self.by_number(name).map_or_else(|| self.by_text(name), Ok)
    }
}

/// Enough of a name to tell how near it is to another; a file may make it as long as it likes.
fn start(text: &str) -> &str {
    text.char_indices().nth(200).map_or(text, |(end, _)| &text[..end])
}

/// What two names of one sentence have in common: Unicode NFC, lower case, one blank between words. Underscores are
/// blanks, since many programs write them for blanks in file names.
pub(super) fn spelling(text: &str) -> String {
    let composed: String =
        text.nfc().flat_map(char::to_lowercase).map(|c| if c == '_' { ' ' } else { c }).collect();
    composed.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn queries(texts: &[&str]) -> Vec<Query> {
        let query = |(index, text): (usize, &&str)| {
            serde_json::from_value(serde_json::json!({
                "id": format!("cups/{:03}", index + 1), "text": text, "categories": ["attribute"],
                "referents": ["cup"], "temporal": "whole", "frames": [[0, 96]], "predicate": null,
                "text_digest": "", "provenance": {"source": "author"}, "status": "candidate",
            }))
            .unwrap()
        };
        texts.iter().enumerate().map(query).collect()
    }

    #[test]
    fn spellings_of_file_names_are_one_sentence() {
        let queries = queries(&["The red cup", "the caf\u{e9} table"]);
        let prompts = Prompts::new(&queries);
        for name in ["The red cup", "the  RED cup ", "the_red_cup"] {
            assert_eq!(prompts.by_text(name).unwrap().id.number.as_str(), "001", "{name}");
        }
        assert_eq!(prompts.by_text("the cafe\u{301} table").unwrap().id.number.as_str(), "002");
        assert_eq!(prompts.find("002").unwrap().text, "the caf\u{e9} table");
        assert_eq!(prompts.find("cups/002").unwrap().text, "the caf\u{e9} table");
    }

    #[test]
    fn the_object_of_a_gated_sentence_is_a_name_but_no_query() {
        let mut queries = queries(&["the cup while it tips", "the mouse", "cup"]);
        queries[0].temporal = Temporal::While;
        queries[0].referents = vec!["cup_red".parse().unwrap(), "mat".parse().unwrap()];
        let prompts = Prompts::new(&queries);
        assert!(prompts.is_base_object("cup red and mat"));
        assert!(!prompts.is_base_object("cup"), "what holds throughout is a sentence alone");
        queries[0].referents.truncate(1);
        queries[2].text = "Cup red".to_owned();
        assert!(!Prompts::new(&queries).is_base_object("cup red"), "a sentence comes first");
    }

    #[test]
    fn what_fits_nothing_names_the_nearest_and_what_fits_two_names_both() {
        let queries = queries(&["the red cup", "The Red  Cup", "the blue plate"]);
        let prompts = Prompts::new(&queries);
        let nearest = Some("the blue plate".to_owned());
        assert_eq!(prompts.by_text("the blue plat").unwrap_err(), NoQuery::Unknown { nearest });
        let both = vec!["cups/001".to_owned(), "cups/002".to_owned()];
        assert_eq!(prompts.by_text("the red cup").unwrap_err(), NoQuery::Several(both));
    }
}
