//! A sentence in English -> the predicate that it means, by a small grammar.
//!
//! Owns words, backtracking and limits; `parse/phrase` reads descriptions, `parse/appearance` what somebody wears or has, `parse/verbs` what is done, `parse/places`
//! relations and times. Refuses to guess: where a word is left over, the answer is that word.

mod appearance;
mod phrase;
mod places;
mod verbs;

use l4d_data::{Name, Temporal};
use l4d_query::{Clause, Party, Predicate};

use super::lexicon::Lexicon;
use crate::unreadable::{Reason, Unreadable};

/// Longest sentence that is read, words.
const MAX_WORDS: usize = 60;
/// Longest sentence that is looked at, bytes.
const MAX_BYTES: usize = 600;
/// Steps after which reading is given up: backtracking is exponential in hostile sentences.
const MAX_STEPS: u32 = 20_000;
/// Deepest description within a description.
const MAX_NESTING: u32 = 4;

/// The noun of a person who is not described.
pub(crate) const ANY_PERSON: &str = "somebody";

/// What a sentence means.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Parsed {
    /// Whom or what it describes.
    pub(crate) predicate: Predicate,
    /// Whether it names an identity or a while.
    pub(crate) temporal: Temporal,
    /// Whether it speaks of several ("the hens").
    pub(crate) is_plural: bool,
    /// The words of the sentence, lower-case.
    pub(crate) words: Vec<String>,
}

/// Reads a sentence.
///
/// # Errors
/// The words that it does not understand.
pub(crate) fn parse(lexicon: &Lexicon, text: &str) -> Result<Parsed, Unreadable> {
    let words = words_of(text)?;
    let mut reader = Reader::new(lexicon, words.clone());
    let unknown = reader.unknown_words();
    if !unknown.is_empty() {
        return Err(Unreadable::words(Reason::Unknown, unknown.into_iter().map(|index| &words[index])));
    }
    let Some(Phrase { noun, clauses, temporal, is_plural, .. }) = reader.sentence() else {
        let from = reader.furthest.min(words.len() - 1);
        return Err(Unreadable::words(Reason::Grammar, &words[from..]));
    };
    if clauses.is_empty() {
        return Err(Unreadable::words(Reason::Bare, &words));
    }
    let all = std::iter::once(Clause::Category(noun)).chain(clauses);
    let predicate = Predicate(all.collect());
    match Predicate::from_json(&serde_json::to_value(&predicate).unwrap_or_default()) {
        Ok(_) => Ok(Parsed { predicate, temporal, is_plural, words }),
        Err(why) => Err(Unreadable::words(Reason::Other(format!("the sentence {why}")), &words)),
    }
}

/// The words of a sentence that is not too long to be read.
fn words_of(text: &str) -> Result<Vec<String>, Unreadable> {
    let has = |count: usize, unit: &str, most: usize| {
        Err(Unreadable::whole(format!("the sentence has {count} {unit}, and at most {most} are read")))
    };
    let count = text.split_whitespace().count();
    if count > MAX_WORDS {
        return has(count, "words", MAX_WORDS);
    }
    if text.len() > MAX_BYTES {
        return has(text.len(), "bytes", MAX_BYTES);
    }
    let words = split(text);
    match words.len() {
        0 => Err(Unreadable::whole("the sentence has no words")),
        count if count > MAX_WORDS => has(count, "words and commas", MAX_WORDS),
        _ => Ok(words),
    }
}

/// Lower-case words without punctuation; a comma is a word.
fn split(text: &str) -> Vec<String> {
    let is_mark = |letter: char| ".!?;:\"()".contains(letter);
    let spaced = text.replace(',', " , ").replace('\u{2019}', "'");
    let words = spaced.split_whitespace().map(|word| word.trim_matches(is_mark).to_lowercase());
    words.filter(|word| !word.is_empty()).collect()
}

/// A place in a sentence, and what has been learned on the way.
struct Reader<'l> {
    lexicon: &'l Lexicon,
    words: Vec<String>,
    at: usize,
    furthest: usize,
    steps: u32,
    nesting: u32,
    /// Noun of the description that is being read: what "one" and "others" stand for.
    nouns: Vec<String>,
}

/// A description as far as it has been read.
#[derive(Debug, Clone)]
struct Phrase {
    noun: String,
    is_definite: bool,
    is_plural: bool,
    clauses: Vec<Clause>,
    temporal: Temporal,
    order: Option<Order>,
}

/// "The first ...", "the last ...", whose event follows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Order {
    First,
    Last,
}

impl Order {
    fn of(self, clause: Clause) -> Clause {
        match self {
            Self::First => Clause::First(Box::new(clause)),
            Self::Last => Clause::Last(Box::new(clause)),
        }
    }
}

impl<'l> Reader<'l> {
    fn new(lexicon: &'l Lexicon, words: Vec<String>) -> Self {
        Self { lexicon, words, at: 0, furthest: 0, steps: 0, nesting: 0, nouns: Vec::new() }
    }

    /// Which words are neither in the grammar nor in the lexicon.
    fn unknown_words(&self) -> Vec<usize> {
        let known = |index: usize| {
            let word = self.words[index].as_str();
            self.lexicon.is_grammar(word)
                || self.lexicon.attribute(word).is_some()
                || self.lexicon.part(word).is_some()
                || self.lexicon.is_quality(word)
                || self.lexicon.is_material(word)
                || self.lexicon.colour(word).is_some()
                || !self.lexicon.verbs_at(word).is_empty()
                || self.part_compound(word).is_some()
                || self.is_possessive(index)
                || (index.saturating_sub(3)..=index).any(|from| {
                    self.lexicon
                        .noun_at(&self.words[from..])
                        .is_some_and(|(_, _, length)| from + length > index)
                })
        };
        (0..self.words.len()).filter(|&index| !known(index)).collect()
    }

    /// "chef's": whose kind of hat it is says nothing of how it looks.
    fn is_possessive(&self, index: usize) -> bool {
        let owner = self.words.get(index).and_then(|word| word.strip_suffix("'s"));
        owner.is_some_and(|owner| self.lexicon.noun_at(&[owner.to_owned()]).is_some())
    }

    fn sentence(&mut self) -> Option<Phrase> {
        let phrase = self.description(true)?;
        if self.at < self.words.len() || phrase.order.is_some() {
            self.furthest = self.furthest.max(self.at);
            return None;
        }
        Some(phrase)
    }

    fn word(&self) -> &str {
        self.ahead(0)
    }

    fn ahead(&self, by: usize) -> &str {
        self.words.get(self.at + by).map_or("", String::as_str)
    }

    fn rest(&self) -> &[String] {
        self.words.get(self.at..).unwrap_or_default()
    }

    fn advance(&mut self, by: usize) {
        self.at = (self.at + by).min(self.words.len());
        self.furthest = self.furthest.max(self.at);
    }

    /// Reads these words if they are the next.
    fn take(&mut self, phrase: &str) -> bool {
        let wanted: Vec<&str> = phrase.split(' ').collect();
        let is_next = wanted.iter().enumerate().all(|(by, word)| self.ahead(by) == *word);
        if is_next {
            self.advance(wanted.len());
        }
        is_next
    }

    /// Reads one of these, the first that fits; `|` is between them.
    fn take_any<'p>(&mut self, phrases: &'p str) -> Option<&'p str> {
        phrases.split('|').find(|phrase| self.take(phrase))
    }

    /// Reads all of these that come next.
    fn skip(&mut self, phrases: &str) {
        while self.take_any(phrases).is_some() {}
    }

    /// Reads something or stays where it was.
    fn attempt<T>(&mut self, read: impl FnOnce(&mut Self) -> Option<T>) -> Option<T> {
        self.steps += 1;
        if self.steps > MAX_STEPS {
            return None;
        }
        let (at, nouns) = (self.at, self.nouns.len());
        let found = read(self);
        self.nouns.truncate(nouns);
        if found.is_none() {
            self.at = at;
        }
        found
    }

    /// Another one, as a party of a relation or an interaction.
    fn party(&mut self) -> Option<Party> {
        if self.take_any("somebody|someone|anybody|anyone|everybody|everyone").is_some() {
            return Some(Party::Category(ANY_PERSON.to_owned()));
        }
        let phrase = self.attempt(|reader| reader.description(false))?;
        if !phrase.clauses.is_empty() {
            let mut all = vec![Clause::Category(phrase.noun)];
            all.extend(phrase.clauses);
            return Some(Party::Such(Predicate(all)));
        }
        let is_own_kind = self.nouns.first() == Some(&phrase.noun);
        let is_live = self.lexicon.noun(&phrase.noun).is_some_and(|noun| noun.live);
        if phrase.is_definite && !phrase.is_plural && !is_own_kind && !is_live {
            return Name::new(phrase.noun).ok().map(Party::Name);
        }
        Some(Party::Category(phrase.noun))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<(String, Temporal), Vec<String>> {
        match parse(Lexicon::shipped().unwrap(), text) {
            Ok(parsed) => Ok((parsed.predicate.to_string(), parsed.temporal)),
            Err(unread) => Err(unread.words),
        }
    }

    fn unread(text: &str) -> Unreadable {
        parse(Lexicon::shipped().unwrap(), text).unwrap_err()
    }

    #[test]
    fn sentences_of_every_kind() {
        let cases = [
            ("The red bucket", "bucket(x) and colour(x) = red"),
            ("the biggest of the melons", "melon(x) and largest(x)"),
            ("The goat that never jumps", "goat(x) and not jump(x)"),
            ("The pigeon on the statue", "pigeon(x) and on(x, statue)"),
            ("The crate that ends up under the bench", "crate(x) and at the end under(x, bench)"),
            ("The last sheep to start running", "sheep(x) and last run(x)"),
            ("A lemon a girl throws", "lemon(x) and throw(any girl, x)"),
            (
                "The lemon thrown by the girl in the green coat",
                "lemon(x) and throw(the y: girl(y) and coat(y) = green, x)",
            ),
            ("The boy who puts the crate down", "boy(x) and put_down(x, crate)"),
            (
                "The horse that stands still at first and then starts to gallop",
                "horse(x) and stand(x) then run(x)",
            ),
            (
                "The kite farthest from the tree at the beginning",
                "kite(x) and at the start farthest_from(x, tree)",
            ),
            ("The goat that is not on the ramp", "goat(x) and not on(x, ramp)"),
            ("The box nobody lifts", "box(x) and not lift(any somebody, x)"),
        ];
        for (text, meaning) in cases {
            assert_eq!(read(text).map(|read| read.0), Ok(meaning.to_owned()), "{text}");
        }
    }

    #[test]
    fn whiles_gate() {
        for text in ["The goose while it swims", "The goose while swimming", "The goose when it is swimming"]
        {
            assert_eq!(read(text), Ok(("goose(x) and swim(x)".into(), Temporal::While)), "{text}");
        }
        let held = Ok(("crate(x) and carry(any somebody, x)".into(), Temporal::While));
        assert_eq!(read("The crate while somebody carries it"), held);
        assert_eq!(read("The crate while it is being carried"), held);
        assert_eq!(read("The dog that sleeps while the cat plays"), Err(vec!["plays".into()]));
        assert_eq!(read("The crate that somebody carries").map(|read| read.1), Ok(Temporal::Whole));
    }

    #[test]
    fn what_is_wrong_with_a_sentence_is_told() {
        let cases = [
            ("The flurb that (Zorples)", Reason::Unknown, "flurb|zorples"),
            ("\u{c4}h,the dog that r\u{fc}ns", Reason::Unknown, "\u{e4}h|r\u{fc}ns"),
            ("The dog that sleeps while the cat plays.", Reason::Grammar, "plays"),
            ("The dog, that the of a cat", Reason::Grammar, "of|a|cat"),
            ("The Dog!", Reason::Bare, "the|dog"),
        ];
        for (text, reason, words) in cases {
            let unread = unread(text);
            assert_eq!((unread.reason, unread.words.join("|").as_str()), (reason, words), "{text}");
        }
    }

    #[test]
    fn what_it_cannot_read_is_named_in_bounded_time() {
        assert_eq!(read("The vase between the lamp and the clock tower"), Err(vec!["clock".to_owned()]));
        assert_eq!(read("\u{8d64}\u{3044}\u{30d0}\u{30b1}\u{30c4}").unwrap_err().len(), 1);
        assert_eq!(read("the \u{1f431}"), Err(vec!["\u{1f431}".to_owned()]));
        for empty in ["", "  \n\t ", "...", "?!"] {
            assert_eq!(unread(empty), Unreadable::whole("the sentence has no words"), "{empty:?}");
        }
        assert!(
            unread(&"the dog that chases ".repeat(2500)).to_string().contains("10000 words, and at most 60")
        );
        assert!(unread(&"dog,".repeat(40)).to_string().contains("80 words and commas"));
        assert!(unread(&"d".repeat(10_000)).to_string().contains("10000 bytes"));
        for hostile in [
            "the dog that a dog that a dog that ",
            "with a and a and a and ",
            "while it is while ",
            "not not ",
        ] {
            for count in 1..15 {
                assert!(read(&format!("the dog {}", hostile.repeat(count))).is_err(), "{hostile}");
            }
        }
    }
}
