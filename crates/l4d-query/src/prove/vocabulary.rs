//! `benchmark/vocabulary.txt`: the words that sentences may use, reviewed by a person. An unknown word is a typo or
//! wants a review.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::DataError;
use l4d_data::store::read_bounded;

use super::words;

/// Reviewed words, lower case, with their kind.
#[derive(Debug, Clone, Default)]
pub struct Vocabulary(BTreeMap<String, String>);

impl Vocabulary {
    /// Reads the file: a word and its kind a line, `#` starts a remark; none where there is no such file.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn read(path: &Path) -> Result<Option<Self>, DataError> {
        if !path.exists() {
            return Ok(None);
        }
        let bytes = read_bounded(path, 1 << 20)?;
        let text = String::from_utf8_lossy(&bytes);
        Ok(Some(text.lines().filter_map(|line| line.split('#').next()).collect()))
    }

    /// Words of a sentence that were never reviewed, in order.
    pub fn unknown(&self, text: &str) -> Vec<String> {
        words(text).into_iter().filter(|word| !self.0.contains_key(word)).collect()
    }

    /// Noun, verb, adjective, adverb, preposition or other.
    pub fn kind(&self, word: &str) -> &str {
        self.0.get(word).map_or("other", String::as_str)
    }
}

impl<'w> FromIterator<&'w str> for Vocabulary {
    fn from_iter<I: IntoIterator<Item = &'w str>>(lines: I) -> Self {
        let entry = |line: &str| {
            let mut parts = line.split_whitespace();
            let word = parts.next()?.to_lowercase();
            Some((word, parts.next().unwrap_or("other").to_owned()))
        };
        Self(lines.into_iter().filter_map(entry).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_words_are_found_and_remarks_are_none() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("vocabulary.txt");
        assert!(Vocabulary::read(&path).unwrap().is_none());
        std::fs::write(&path, "# reviewed\nthe\nbucket noun  # of a well\n").unwrap();
        let vocabulary = Vocabulary::read(&path).unwrap().unwrap();
        assert_eq!(vocabulary.unknown("The buckett"), ["buckett"]);
        assert!(vocabulary.unknown("The bucket").is_empty());
        assert_eq!((vocabulary.kind("bucket"), vocabulary.kind("the")), ("noun", "other"));
    }
}
