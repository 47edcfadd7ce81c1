//! Why a grounder cannot read a sentence: which of its words, where they are, and what is wrong with them.

use std::fmt;

use serde::{Deserialize, Serialize};

/// Most words that a message names.
const MOST_NAMED: usize = 8;
/// Longest word that is repeated, characters.
const LONGEST_WORD: usize = 32;

/// A word of a sentence.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Word {
    /// As it is read: lower case, without punctuation around it.
    pub text: String,
    /// Where it is in the sentence, bytes: from the first, up to the second.
    pub bytes: [usize; 2],
}

impl Word {
    /// The word, cut where it is too long to be repeated.
    fn cut(&self) -> Self {
        Self { text: self.text.chars().take(LONGEST_WORD).collect(), ..self.clone() }
    }
}

/// What is wrong with a sentence.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Reason {
    /// The grounder does not know the words.
    Unknown,
    /// It knows the words, but cannot read them in this order.
    Grammar,
    /// The words name a kind of thing, and nothing tells one of that kind from another.
    Bare,
    /// It reads the sentence, but measures nothing that tells of the words.
    Unmeasured,
    /// Anything else, in a clause that can follow a colon.
    Other(String),
}

/// A sentence that a grounder cannot read, today or ever.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, thiserror::Error)]
#[serde(deny_unknown_fields)]
#[error("{}", self.message())]
pub struct Unread {
    /// What is wrong.
    pub reason: Reason,
    /// The words that it is about, in the order of the sentence; none where it is about the whole.
    pub words: Vec<Word>,
}

impl Unread {
    /// Some words of a sentence.
    pub fn words<'w>(reason: Reason, words: impl IntoIterator<Item = &'w Word>) -> Self {
        Self { reason, words: words.into_iter().map(Word::cut).collect() }
    }

    /// The sentence as a whole.
    pub fn whole(why: impl Into<String>) -> Self {
        Self { reason: Reason::Other(why.into()), words: Vec::new() }
    }

    /// The words alone.
    pub fn texts(&self) -> Vec<&str> {
        self.words.iter().map(|word| word.text.as_str()).collect()
    }

    fn message(&self) -> String {
        match &self.reason {
            Reason::Unknown => format!("cannot read {}", Listed(&self.texts())),
            Reason::Grammar => format!("cannot read \"{}\" in this place", self.passage()),
            Reason::Bare => format!("\"{}\" says nothing beside the kind of thing", self.passage()),
            Reason::Unmeasured => {
                format!("reads {}, but measures nothing that tells of it", Listed(&self.texts()))
            }
            Reason::Other(why) => why.clone(),
        }
    }

    /// The words as they follow each other.
    fn passage(&self) -> String {
        let texts = self.texts();
        let named = texts.iter().take(MOST_NAMED).copied().collect::<Vec<_>>().join(" ").replace(" ,", ",");
        if texts.len() > MOST_NAMED { format!("{named} ...") } else { named }
    }
}

/// Words one by one: `"a", "b" and "c"`.
struct Listed<'w>(&'w [&'w str]);

impl fmt::Display for Listed<'_> {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut named: Vec<String> =
            self.0.iter().take(MOST_NAMED).map(|word| format!("\"{word}\"")).collect();
        if self.0.len() > MOST_NAMED {
            named.push(format!("{} more words", self.0.len() - MOST_NAMED));
        }
        match named.split_last() {
            Some((last, rest)) if !rest.is_empty() => {
                write!(formatter, "{} and {last}", rest.join(", "))
            }
            _ => formatter.write_str(&named.concat()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unread(reason: Reason, text: &str) -> String {
        let word = |text: &str| Word { text: text.to_owned(), bytes: [0, 0] };
        let words: Vec<Word> = text.split(' ').map(word).collect();
        Unread::words(reason, &words).to_string()
    }

    #[test]
    fn messages_name_the_words() {
        assert_eq!(unread(Reason::Unknown, "flurb"), "cannot read \"flurb\"");
        assert_eq!(unread(Reason::Unknown, "der rote eimer"), "cannot read \"der\", \"rote\" and \"eimer\"");
        assert_eq!(unread(Reason::Grammar, "plays , too"), "cannot read \"plays, too\" in this place");
        assert_eq!(unread(Reason::Bare, "the cup"), "\"the cup\" says nothing beside the kind of thing");
        assert!(unread(Reason::Unmeasured, "lid").starts_with("reads \"lid\", but"));
        assert_eq!(Unread::whole("it is empty").to_string(), "it is empty");
    }

    #[test]
    fn messages_stay_short() {
        let many = vec!["word"; 60].join(" ");
        assert!(unread(Reason::Unknown, &many).ends_with("\"word\" and 52 more words"));
        assert!(unread(Reason::Grammar, &many).contains("word ...\""));
        assert!(unread(Reason::Unknown, &"a".repeat(500)).len() < 60);
    }
}
