//! Predicates to sentences.
//!
//! Every clause has several wordings, each with a place in the sentence and a price; sentences are all that fit
//! together, the cheapest first. What cannot be read back as exactly what was meant is never said.

mod clause;
mod finite;
mod gate;
mod phrase;
mod property;

use std::collections::BTreeSet;

use l4d_data::{Name, Temporal};
use l4d_query::{Clause, Predicate, prove};

use crate::canonical::canonical;
use crate::inflect::takes_an;
use crate::lexicon::{lexicon, tokens};
use crate::read::readings;
use crate::words::Words;

/// Words of the shortest sentence.
pub const SHORTEST: usize = 3;
/// Words of the longest sentence.
pub const LONGEST: usize = 20;

/// Sentences that are tried for a predicate.
const MOST_TRIED: usize = 160;
/// Sentences that are given.
const MOST_GIVEN: usize = 24;
/// Sentences among which the best are sought: an ambiguous one may be worse than some that cost more at first.
const ENOUGH: usize = 36;
/// What a sentence may cost more than the best.
const WORST: f64 = 1.6;
/// The price of a word.
const PER_WORD: f64 = 0.05;
/// The price of a sentence that the grammar can also read in another way.
const AMBIGUOUS: f64 = 0.5;

/// Words of sentences that no entry of the lexicon has.
const FUNCTION_WORDS: &str = "a after afterwards all away an and another any are as at be before beginning behind being beside between \
     bigger biggest by clip closer closest contact do does end ends ever faces facing farther farthest finishes \
     first from front had has have he her higher highest him in inside is it larger largest last lower lowest \
     nearest never next no not of on one only other others out she smaller smallest something start starts \
     taller tallest than that the them then they to top touches touching two under underneath up wear wearing \
     wears when which while who with without";

/// A wording and its price.
#[derive(Debug, Clone, PartialEq)]
struct Said {
    text: String,
    cost: f64,
}

fn said(text: impl Into<String>, cost: f64) -> Said {
    Said { text: text.into(), cost }
}

/// All sentences for a predicate, best first; every one reads back as exactly this predicate (its clauses in
/// [`canonical`] order) and temporal. Empty if a word has no phrase, or if all sentences would be too long.
pub fn forms(predicate: &Predicate, temporal: Temporal, words: &Words<'_>) -> Vec<String> {
    let meant = canonical(predicate);
    let speaker = Speaker { words, head: Some(meant.noun().to_owned()) };
    let mut tried = match temporal {
        Temporal::Whole => speaker.whole_sentences(&meant),
        Temporal::While => speaker.gated_sentences(&meant),
    };
    for sentence in &mut tried {
        sentence.text = finished(&sentence.text);
        sentence.cost += PER_WORD * tokens(&sentence.text).len() as f64;
    }
    tried.sort_by(|a, b| a.cost.total_cmp(&b.cost).then_with(|| a.text.cmp(&b.text)));
    let mut seen = BTreeSet::new();
    tried.retain(|sentence| seen.insert(sentence.text.clone()));
    let mut given: Vec<Said> = Vec::new();
    for mut sentence in
        tried.into_iter().filter(|sentence| is_sayable(&sentence.text, temporal, &meant)).take(MOST_TRIED)
    {
        let Ok(found) = readings(&sentence.text, words) else { continue };
        if found.first() != Some(&(meant.clone(), temporal)) {
            continue;
        }
        if found.len() > 1 {
            sentence.cost += AMBIGUOUS;
        }
        given.push(sentence);
        if given.len() >= ENOUGH {
            break;
        }
    }
    given.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    let limit = given.first().map_or(0.0, |best| best.cost) + WORST;
    given
        .into_iter()
        .filter(|sentence| sentence.cost <= limit)
        .take(MOST_GIVEN)
        .map(|sentence| sentence.text)
        .collect()
}

/// How a landmark is called.
pub(crate) fn landmark(words: &Words<'_>, name: &Name) -> Option<String> {
    let speaker = Speaker { words, head: None };
    let mut phrases = speaker.named(name);
    phrases.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    Some(with_articles(&phrases.first()?.text))
}

/// Every word that a sentence may have.
pub fn vocabulary() -> BTreeSet<String> {
    let mut words = lexicon().said_words();
    words.extend(FUNCTION_WORDS.split_whitespace().map(str::to_owned));
    words
}

/// Says the clauses of a sentence about one kind of thing.
#[derive(Debug, Clone)]
struct Speaker<'s, 'a> {
    words: &'s Words<'a>,
    /// The noun of the sentence: others of it are "another one", "the red one".
    head: Option<String>,
}

fn is_sayable(text: &str, temporal: Temporal, predicate: &Predicate) -> bool {
    let length = tokens(text).len();
    (SHORTEST..=LONGEST).contains(&length) && prove::wording_problem(text, temporal, predicate).is_none()
}

/// First letter in upper case, "an" where it belongs.
fn finished(text: &str) -> String {
    let text = with_articles(text);
    let mut letters = text.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

fn with_articles(text: &str) -> String {
    let words: Vec<&str> = text.split_whitespace().collect();
    let next = |at: usize| words.get(at + 1).copied().unwrap_or_default();
    let article = |(at, word): (usize, &&str)| match *word {
        "a" | "an" if takes_an(next(at)) => "an".to_owned(),
        "an" => "a".to_owned(),
        word => word.to_owned(),
    };
    words.iter().enumerate().map(article).collect::<Vec<_>>().join(" ")
}

/// Whether it is something that can change within the clip.
fn changes(clause: &Clause) -> bool {
    !clause.is_constant()
}

/// All ways to choose one of each, at most `most`.
fn products<T: Clone>(choices: &[Vec<T>], most: usize) -> Vec<Vec<T>> {
    choices.iter().fold(vec![Vec::new()], |found, options| {
        let longer = found.iter().flat_map(|chosen| {
            options.iter().map(move |option| [&chosen[..], std::slice::from_ref(option)].concat())
        });
        longer.take(most).collect()
    })
}

fn cheapest(mut found: Vec<Said>, most: usize) -> Vec<Said> {
    found.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    found.truncate(most);
    found
}
