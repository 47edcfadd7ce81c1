//! Why a grounder cannot read a sentence: which of its words, and what is wrong with them.

use serde::{Deserialize, Serialize};

/// Most words that a message names.
const MOST_NAMED: usize = 8;
/// Longest word that is repeated, characters.
const LONGEST_WORD: usize = 32;

/// What is wrong with a sentence.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    /// The grounder does not know the words.
    Unknown,
    /// The words name a kind of thing, and nothing tells one of that kind from another.
    Bare,
    /// Anything else, in a clause that can follow a colon.
    Other(String),
}

/// A sentence that a grounder cannot read, today or ever.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
#[serde(deny_unknown_fields)]
#[error("{}", self.message())]
pub struct Unreadable {
    /// What is wrong.
    pub reason: Reason,
    /// The words that it is about, in the order of the sentence; none where it is about the whole.
    pub words: Vec<String>,
}

impl Unreadable {
    /// Some words of a sentence.
    pub fn words<'w>(reason: Reason, words: impl IntoIterator<Item = &'w String>) -> Self {
        let cut = |word: &String| word.chars().take(LONGEST_WORD).collect();
        Self { reason, words: words.into_iter().map(cut).collect() }
    }

    /// The sentence as a whole.
    pub fn whole(why: impl Into<String>) -> Self {
        Self { reason: Reason::Other(why.into()), words: Vec::new() }
    }

    fn message(&self) -> String {
        match &self.reason {
            Reason::Unknown => format!("cannot read {}", self.listed()),
            Reason::Bare => format!("\"{}\" says nothing beside the kind of thing", self.passage()),
            Reason::Other(why) => why.clone(),
        }
    }

    /// The words as they follow each other.
    fn passage(&self) -> String {
        let named = self.words[..self.words.len().min(MOST_NAMED)].join(" ");
        if self.words.len() > MOST_NAMED { format!("{named} ...") } else { named }
    }

    /// The words one by one: `"a", "b" and "c"`.
    fn listed(&self) -> String {
        let mut named: Vec<String> =
            self.words.iter().take(MOST_NAMED).map(|word| format!("\"{word}\"")).collect();
        if self.words.len() > MOST_NAMED {
            named.push(format!("{} more words", self.words.len() - MOST_NAMED));
        }
        match named.split_last() {
            Some((last, rest)) if !rest.is_empty() => format!("{} and {last}", rest.join(", ")),
            _ => named.concat(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_name_the_words_and_stay_short() {
        let message = |reason: Reason, text: &str| {
            let words: Vec<String> = text.split(' ').map(str::to_owned).collect();
            Unreadable::words(reason, &words).to_string()
        };
        assert_eq!(message(Reason::Unknown, "flurb"), "cannot read \"flurb\"");
        assert_eq!(message(Reason::Unknown, "der rote eimer"), "cannot read \"der\", \"rote\" and \"eimer\"");
        assert_eq!(message(Reason::Bare, "the cup"), "\"the cup\" says nothing beside the kind of thing");
        let many = vec!["word"; 60].join(" ");
        assert!(message(Reason::Unknown, &many).ends_with("\"word\" and 52 more words"));
        assert!(message(Reason::Bare, &many).contains("word ...\""));
        assert!(message(Reason::Unknown, &"a".repeat(500)).len() < 60);
    }
}
