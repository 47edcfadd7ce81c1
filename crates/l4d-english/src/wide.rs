//! Everyday English to predicates: a tolerant reader for sentences that no one wrote for a grammar.
//!
//! A text is made plain first (`tokens`), then every part of it is guessed at (`guess`): each guess has a cost, words
//! that fit nowhere are passed over for a price, and the cheapest reading of the whole wins. Prefers the nouns, verbs and
//! properties that the scene has; never looks at what is true in it.

mod data;
mod event;
mod guess;
mod noun_phrase;
mod place;
mod property;
mod sentence;
mod tokens;
mod verb_phrase;

use std::cell::{Cell, RefCell};
use std::collections::{BTreeSet, HashMap};
use std::rc::Rc;

use l4d_data::Temporal;
use l4d_query::{Clause, Predicate};

use self::data::data;
use self::guess::{Guess, Guesses};
use self::noun_phrase::Described;
use self::tokens::Plain;
use crate::canonical::canonical;
use crate::words::Words;

/// Words of the longest text that is read.
pub(crate) const LONGEST: usize = 80;
/// Readings that are given.
const MOST_READINGS: usize = 5;
/// Work after which guessing stops: hostile sentences are ambiguous without end.
const MOST_STEPS: u32 = 400_000;

/// What passing over a word costs.
mod price {
    /// A word of the grammar.
    pub(super) const FUNCTION: u32 = 4;
    /// A word that means nothing here.
    pub(super) const UNKNOWN: u32 = 9;
    /// A word that means something.
    pub(super) const CONTENT: u32 = 15;
    /// A word that turns the meaning round.
    pub(super) const NEGATION: u32 = 120;
}

/// A reading of a text that is not exactly in the grammar.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Inferred {
    pub(crate) predicate: Predicate,
    pub(crate) temporal: Temporal,
    pub(crate) cost: u32,
    /// Words that were passed over and might have mattered.
    pub(crate) skipped: Vec<String>,
}

/// All that was made of a text.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Inference {
    /// The likeliest first.
    pub(crate) readings: Vec<Inferred>,
    pub(crate) repairs: Vec<(String, String)>,
    pub(crate) unknown: Vec<String>,
    /// How many words the text has.
    pub(crate) length: usize,
}

/// Guesses at a text.
pub(crate) fn infer(text: &str, words: &Words<'_>) -> Inference {
    let plain = tokens::plain(text, &preferred(words));
    let Plain { words: tokens, repairs, unknown, length } = plain;
    let mut readings = Vec::new();
    // A text in another language has nothing to guess from.
    let is_english = unknown.len() * 2 < length.max(1);
    if is_english && !tokens.is_empty() && tokens.len() <= LONGEST {
        let wide = Wide::new(tokens, words, None);
        readings = wide.readings();
    }
    Inference { readings, repairs, unknown, length }
}

/// Words of what the scene has.
fn preferred(words: &Words<'_>) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let split = |text: &str| text.split(['_', ' ']).map(str::to_owned).collect::<Vec<_>>();
    for category in words.categories() {
        found.extend(split(&category));
        found.extend(
            words.properties(&category).iter().flat_map(|(key, value)| [split(key), split(value)].concat()),
        );
    }
    found.extend(words.verbs().iter().flat_map(|verb| split(verb)));
    found
}

/// Guesses that have been made already.
type Memory<K, T> = RefCell<HashMap<K, Rc<Guesses<T>>>>;

/// A plain sentence being guessed at.
struct Wide<'r, 'a> {
    words: &'r Words<'a>,
    tokens: Vec<String>,
    /// What is named where, for "one" and "it".
    mentions: Vec<(usize, String)>,
    /// What an earlier sentence spoke of.
    before: Option<Described>,
    phrases: Memory<(usize, bool), Described>,
    rests: Memory<(usize, String, bool), Vec<Clause>>,
    steps: Cell<u32>,
}

impl<'r, 'a> Wide<'r, 'a> {
    fn new(tokens: Vec<String>, words: &'r Words<'a>, before: Option<Described>) -> Self {
        let mut wide = Self {
            words,
            tokens,
            mentions: Vec::new(),
            before,
            phrases: RefCell::default(),
            rests: RefCell::default(),
            steps: Cell::new(0),
        };
        let mut at = 0;
        while at < wide.tokens.len() {
            let mut nouns = wide.nouns(at);
            nouns.sort_by_key(|guess| (std::cmp::Reverse(guess.end), guess.cost));
            match nouns.first() {
                Some(noun) if noun.cost < 10 => {
                    wide.mentions.push((at, noun.value.0.clone()));
                    at = noun.end;
                }
                _ => at += 1,
            }
        }
        wide
    }

    fn readings(&self) -> Vec<Inferred> {
        let mut found: Vec<Inferred> = Vec::new();
        for guess in self.sentences() {
            let (predicate, temporal) = guess.value;
            let predicate = canonical(&without_repeats(predicate));
            let is_known =
                found.iter().any(|other| other.predicate == predicate && other.temporal == temporal);
            if is_known || !is_sound(&predicate) {
                continue;
            }
            let skipped = self.passed_over(guess.skipped);
            found.push(Inferred { predicate, temporal, cost: guess.cost, skipped });
            if found.len() == MOST_READINGS {
                break;
            }
        }
        found
    }

    fn passed_over(&self, skipped: u128) -> Vec<String> {
        let is_skipped = |at: &usize| skipped >> at & 1 == 1;
        let places = (0..self.tokens.len()).filter(is_skipped);
        let words = places.map(|at| self.tokens[at].clone());
        words.filter(|word| !data().is_function(word) && word != ",").collect()
    }

    fn word(&self, at: usize) -> &str {
        self.tokens.get(at).map_or("", String::as_str)
    }

    fn rest(&self, at: usize) -> &[String] {
        self.tokens.get(at..).unwrap_or_default()
    }

    /// The place after one of these words.
    fn any_of(&self, at: usize, words: &str) -> Option<usize> {
        let word = self.tokens.get(at)?;
        words.split(' ').any(|other| other == word).then_some(at + 1)
    }

    /// The place after the longest of these phrases (`|` between them).
    fn phrase(&self, at: usize, phrases: &str) -> Option<usize> {
        let rest = self.rest(at);
        let follows = |phrase: &str| {
            let words: Vec<&str> = phrase.split_whitespace().collect();
            let fits = rest.len() >= words.len() && words.iter().zip(rest).all(|(word, own)| word == own);
            fits.then_some(at + words.len())
        };
        phrases.split('|').filter_map(follows).max()
    }

    /// The place after these, or the place itself.
    fn skip(&self, at: usize, phrases: &str) -> usize {
        self.phrase(at, phrases).unwrap_or(at)
    }

    /// What it costs to pass over the word at a place.
    fn price(&self, at: usize) -> u32 {
        let word = self.word(at);
        match word {
            "," | "" => 0,
            "not" | "never" | "no" | "without" | "neither" | "nor" | "nobody" => price::NEGATION,
            "@while" => 36,
            "@first" | "@last" | "@start" | "@end" | "@then" => 12,
            "@all" => 0,
            _ if data().is_function(word) => price::FUNCTION,
            _ if data().is_known(word) => price::CONTENT,
            _ => price::UNKNOWN,
        }
    }

    /// The same place one word later, that word passed over.
    fn pass(&self, at: usize) -> Guess<()> {
        Guess { value: (), end: at + 1, cost: self.price(at), skipped: 1 << at.min(127) }
    }

    /// All words from one place to another passed over.
    fn pass_all(&self, from: usize, to: usize) -> Guess<()> {
        let mut all = Guess::new((), from, 0);
        for at in from..to {
            all = all.then(self.pass(at), |(), ()| ());
        }
        all.ending(to)
    }

    /// Whether there is still work to spend.
    fn may_go_on(&self) -> bool {
        self.steps.set(self.steps.get() + 1);
        self.steps.get() < MOST_STEPS
    }
}

fn without_repeats(predicate: Predicate) -> Predicate {
    let mut clauses: Vec<Clause> = Vec::new();
    for clause in predicate.0 {
        if !clauses.contains(&clause) {
            clauses.push(clause);
        }
    }
    // "Black, all others being white": the first is said of it.
    let mut keys: Vec<String> = Vec::new();
    clauses.retain(|clause| match clause {
        Clause::Attribute { key, .. } => {
            let is_new = !keys.contains(key);
            keys.push(key.clone());
            is_new
        }
        _ => true,
    });
    // "Nudges" says no more than "nudges a ball".
    let is_less = |clause: &Clause| match clause {
        Clause::Does { verb, to: None } => clauses
            .iter()
            .any(|other| matches!(other, Clause::Does { verb: own, to: Some(_) } if own == verb)),
        _ => false,
    };
    // "Sits before the others sit": the order says that it sits.
    let is_ordered = |clause: &Clause| {
        clauses.iter().any(|other| match other {
            Clause::First(inner) | Clause::Last(inner) => inner.as_ref() == clause,
            _ => false,
        })
    };
    let is_less = |clause: &Clause| is_less(clause) || is_ordered(clause);
    let kept = clauses.iter().filter(|clause| !is_less(clause)).cloned().collect();
    Predicate(kept)
}

/// Whether the predicate language has it.
fn is_sound(predicate: &Predicate) -> bool {
    if predicate.0.len() == 1 {
        return true;
    }
    serde_json::to_value(predicate).is_ok_and(|value| Predicate::from_json(&value).is_ok())
}

/// That it does not hold; two "not" are none.
fn negated(clause: Clause) -> Clause {
    match clause {
        Clause::Not(inner) => *inner,
        Clause::AtStart(inner) => Clause::AtStart(Box::new(negated(*inner))),
        Clause::AtEnd(inner) => Clause::AtEnd(Box::new(negated(*inner))),
        clause => Clause::Not(Box::new(clause)),
    }
}

/// An end of the clip.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Edge {
    Start,
    End,
}

impl Edge {
    /// What changes, at this end; none if nothing does.
    fn of(self, clauses: Vec<Clause>) -> Option<Vec<Clause>> {
        let mut is_changed = false;
        let clauses = clauses
            .into_iter()
            .map(|clause| {
                if clause.is_constant() {
                    return clause;
                }
                is_changed = true;
                match self {
                    Self::Start => Clause::AtStart(Box::new(clause)),
                    Self::End => Clause::AtEnd(Box::new(clause)),
                }
            })
            .collect();
        is_changed.then_some(clauses)
    }
}

/// Order in time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Order {
    First,
    Last,
}

impl Order {
    /// The first event of these, in this order; none if there is no event.
    fn of(self, mut clauses: Vec<Clause>) -> Option<Vec<Clause>> {
        // "The last to end up standing": the end is when it stands.
        let event_of = |clause: &Clause| match clause {
            Clause::AtEnd(inner) | Clause::AtStart(inner) if is_event(inner) => Some(inner.as_ref().clone()),
            clause => is_event(clause).then(|| clause.clone()),
        };
        let event = clauses.iter_mut().find(|clause| event_of(clause).is_some())?;
        let inner = Box::new(event_of(event)?);
        *event = match self {
            Self::First => Clause::First(inner),
            Self::Last => Clause::Last(inner),
        };
        Some(clauses)
    }
}

fn is_event(clause: &Clause) -> bool {
    matches!(clause, Clause::Does { .. } | Clause::Undergoes { .. })
}
