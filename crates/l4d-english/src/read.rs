//! Sentences to predicates.
//!
//! A parser that follows every reading: each part of the grammar gives all that the words from a place on may mean, and
//! where each reading ends. Preferred readings come first: what stands close belongs together, unless a landmark is
//! named already and nothing more needs to be said of it.

mod event;
mod phrase;
mod property;
mod sentence;
mod state;
mod verb_phrase;

pub(crate) use state::SUPERLATIVES;

use std::cell::{Cell, RefCell};
use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;
use std::sync::LazyLock;

use l4d_data::Temporal;
use l4d_query::Predicate;

use self::phrase::Phrase;
use crate::canonical::canonical;
use crate::lexicon::{lexicon, tokens};
use crate::words::Words;

/// Words of the longest sentence that is read.
const LONGEST: usize = 40;
/// Readings of a part that are followed.
const MOST_READINGS: usize = 120;

/// Words that the grammar itself knows.
const GRAMMAR: &str = "a after afterwards all along alongside among an and another any anybody anyone are around as at atop away \
    be been before begin beginning begins behind being below beneath beside between bigger biggest but by \
    clip close closer closest comes contact did do does dressed during each end ends eventually every faces \
    facing farther farthest final finally finish finishes first five for four from front get gets getting had \
    has have having he her higher highest him his in initially inside into is it its keep keeps larger \
    largest last later located long lower lowest made moment near nearest never next no no-one not nothing of \
    off on once one ones only onto or originally other others out put remain remains rest same scene she \
    smaller smallest some somebody someone something start starting starts stay stays still taller tallest \
    than that the their them then there these they this those three time to top touches touching two under \
    underneath until up video was wear wearing wears were when whenever where which while who whom whose with \
    within without";

/// Words that say how something is done, which no clause speaks of.
const SKIPPED: &str = "slowly quickly gently carefully just also always currently very";

static KNOWN: LazyLock<BTreeSet<String>> = LazyLock::new(|| {
    let mut known = lexicon().content_words();
    known.extend(GRAMMAR.split_whitespace().map(str::to_owned));
    known
});

/// Why a sentence is not read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Unread {
    /// There is nothing to read.
    #[error("the sentence is empty: describe one thing, such as \"The cup that a hand lifts\"")]
    Empty,
    /// Too long to follow.
    #[error("the sentence has {0} words: use at most {LONGEST}")]
    Long(usize),
    /// A word that the lexicon doesn't have.
    #[error("\"{0}\" is an unknown word: use another, or add it to lexicon.toml")]
    Word(String),
    /// The words are known, but not in this order.
    #[error("cannot follow \"{rest}\" after \"{read}\": say it in a plainer way")]
    Construction {
        /// What was understood.
        read: String,
        /// What was not.
        rest: String,
    },
    /// The predicate language has no such predicate.
    #[error("{0}")]
    Predicate(String),
    /// Too little of it means anything here.
    #[error("cannot read this sentence{}: describe one of {knows}{}", of_words(words), such_as(nearest))]
    Unclear {
        /// Words that mean nothing here.
        words: Vec<String>,
        /// What there is to describe.
        knows: String,
        /// The nearest sentence that would be understood, and that has one answer.
        nearest: Option<String>,
    },
}

fn of_words(words: &[String]) -> String {
    match words {
        [] => String::new(),
        words => format!(" (no meaning for \"{}\")", words.join("\", \"")),
    }
}

fn such_as(nearest: &Option<String>) -> String {
    nearest.as_ref().map(|sentence| format!(", such as \"{sentence}\"")).unwrap_or_default()
}

/// The predicate that a sentence means, its clauses in canonical order.
///
/// # Errors
/// Which word is unknown, or which construction is.
pub fn read(text: &str, words: &Words<'_>) -> Result<(Predicate, Temporal), Unread> {
    readings(text, words).map(|mut found| found.swap_remove(0))
}

/// All readings, the preferred one first; at least one.
pub(crate) fn readings(text: &str, words: &Words<'_>) -> Result<Vec<(Predicate, Temporal)>, Unread> {
    let tokens = sentence_tokens(text);
    match tokens.len() {
        0 => return Err(Unread::Empty),
        length if length > LONGEST => return Err(Unread::Long(length)),
        _ => {}
    }
    let reader = Reader::new(tokens, words);
    let mut found: Vec<(Predicate, Temporal)> = Vec::new();
    for (predicate, temporal) in reader.sentences() {
        let reading = (canonical(&predicate), temporal);
        if !found.contains(&reading) {
            found.push(reading);
        }
    }
    if found.is_empty() {
        return Err(reader.problem());
    }
    let well_formed = |predicate: &Predicate| match predicate.0.len() {
        1 => Ok(()),
        _ => Predicate::from_json(&predicate_json(predicate)).map(drop),
    };
    let refused = found.iter().find_map(|(predicate, _)| well_formed(predicate).err());
    found.retain(|(predicate, _)| well_formed(predicate).is_ok());
    match (found.is_empty(), refused) {
        (true, Some(message)) => Err(Unread::Predicate(message)),
        _ => Ok(found),
    }
}

fn predicate_json(predicate: &Predicate) -> serde_json::Value {
    serde_json::to_value(predicate).unwrap_or_default()
}

/// Words in their usual spelling, "doesn't" as two.
fn sentence_tokens(text: &str) -> Vec<String> {
    let mut found = Vec::new();
    let skipped = |word: &String| SKIPPED.split(' ').any(|other| other == word);
    for word in tokens(text).into_iter().filter(|word| !skipped(word)) {
        match word.as_str() {
            "can't" | "cannot" => found.extend(["can".to_owned(), "not".to_owned()]),
            "it's" => found.extend(["it".to_owned(), "is".to_owned()]),
            "that's" | "who's" => found.extend(["that".to_owned(), "is".to_owned()]),
            _ => match word.strip_suffix("n't") {
                Some(verb) => found.extend([verb.to_owned(), "not".to_owned()]),
                None => found.push(lexicon().spelled(&word).to_owned()),
            },
        }
    }
    found
}

/// Readings of a part of a sentence, each with the place after it.
type Readings<T> = Vec<(T, usize)>;

/// A sentence being read.
#[derive(Debug)]
struct Reader<'r, 'a> {
    words: &'r Words<'a>,
    tokens: Vec<String>,
    /// The noun of the sentence, which "one" repeats.
    head: RefCell<Option<String>>,
    phrases: RefCell<BTreeMap<usize, Rc<Readings<Phrase>>>>,
    /// The first word that no reading has used.
    furthest: Cell<usize>,
}

impl<'r, 'a> Reader<'r, 'a> {
    fn new(tokens: Vec<String>, words: &'r Words<'a>) -> Self {
        Self { words, tokens, head: RefCell::default(), phrases: RefCell::default(), furthest: Cell::new(0) }
    }

    fn word(&self, at: usize) -> &str {
        self.tokens.get(at).map_or("", String::as_str)
    }

    fn rest(&self, at: usize) -> &[String] {
        self.tokens.get(at..).unwrap_or_default()
    }

    /// Notes that all words before `at` have been used by some reading.
    fn reached(&self, at: usize) -> usize {
        self.furthest.set(self.furthest.get().max(at));
        at
    }

    /// The place after one of these words.
    fn any_of(&self, at: usize, words: &str) -> Option<usize> {
        let word = self.tokens.get(at)?;
        words.split(' ').any(|other| other == word).then(|| self.reached(at + 1))
    }

    /// The places after those of these phrases (`|` between them) that follow.
    fn phrases(&self, at: usize, phrases: &str) -> Vec<usize> {
        let follows = |phrase: &str| {
            let words: Vec<&str> = phrase.split_whitespace().collect();
            let rest = self.rest(at);
            let fits = rest.len() >= words.len() && words.iter().zip(rest).all(|(word, own)| word == own);
            fits.then(|| self.reached(at + words.len()))
        };
        phrases.split('|').filter_map(follows).collect()
    }

    /// The place after the longest of these phrases, or the place itself.
    fn skip(&self, at: usize, phrases: &str) -> usize {
        self.phrases(at, phrases).into_iter().max().unwrap_or(at)
    }

    fn is_end(&self, at: usize) -> bool {
        at >= self.tokens.len()
    }

    fn problem(&self) -> Unread {
        if let Some(word) = self.tokens.iter().find(|word| !KNOWN.contains(*word)) {
            return Unread::Word(word.clone());
        }
        let at = self.furthest.get().min(self.tokens.len());
        Unread::Construction { read: self.tokens[..at].join(" "), rest: self.tokens[at..].join(" ") }
    }
}

/// Without repeats, and no more than can be followed.
fn distinct<T: PartialEq>(readings: Readings<T>) -> Readings<T> {
    let mut found = Readings::new();
    for reading in readings {
        if found.len() < MOST_READINGS && !found.contains(&reading) {
            found.push(reading);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn meaning(text: &str) -> String {
        let (predicate, temporal) = read(text, &Words::all()).unwrap();
        let when = if temporal == Temporal::While { " while" } else { "" };
        format!("{predicate}{when}")
    }

    #[test]
    fn wordings_of_other_people() {
        let cases = [
            ("A woman whose top is light blue", "woman(x) and top(x) = light_blue"),
            (
                "The gray cup nearest the lamp",
                "cup(x) and colour(x) = grey and closest_to(x, the y: lamp(y))",
            ),
            ("The dog which isn't slowly running", "dog(x) and not run(x)"),
            ("The cup standing on the tray", "cup(x) and on(x, the y: tray(y))"),
            ("The cup next to another one", "cup(x) and beside(x, any cup)"),
            (
                "The man in black trousers and a red shirt",
                "man(x) and shirt(x) = red and trousers(x) = black",
            ),
            ("The cat while it sits on the sofa", "cat(x) and on(x, the y: sofa(y)) and sit(x) while"),
            ("The cup when it's on the tray", "cup(x) and on(x, the y: tray(y)) while"),
            ("The tallest of the three women", "woman(x) and tallest(x)"),
            ("The lady who wears a green dress", "woman(x) and dress(x) = green"),
            ("The ball that is not touched by the cat", "ball(x) and not touch(the y: cat(y), x)"),
            ("The couch between two lamps", "sofa(x) and between(x, any lamp, any lamp)"),
        ];
        for (text, expected) in cases {
            assert_eq!(meaning(text), expected, "{text}");
        }
    }

    #[test]
    fn a_sentence_that_is_not_read_says_why() {
        let words = Words::all();
        let problem = |text: &str| read(text, &words).unwrap_err();
        assert_eq!(problem(" . "), Unread::Empty);
        assert_eq!(problem("The cup that zigzags"), Unread::Word("zigzags".into()));
        let rest = |text: &str| match problem(text) {
            Unread::Construction { rest, .. } => rest,
            other => panic!("{other}"),
        };
        assert_eq!(rest("The cup that rolls the"), "");
        assert!(rest("The cup on on the tray").starts_with("on the tray"));
        assert_eq!(problem(&"cup ".repeat(60)), Unread::Long(60));
    }
}
