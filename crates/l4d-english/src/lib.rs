//! English sentences for predicates, in both directions: [`forms`] says a predicate, [`read`] finds what such a sentence
//! means, [`understand`] what people mean by theirs. What is said is always read back as exactly what was meant.
//!
//! Owns the words and the grammar. Refuses to know what is true in a scene beyond what its things are called: whether a
//! sentence has one answer is proved by `l4d-query`.

mod canonical;
mod examples;
mod inflect;
mod lexicon;
mod read;
mod say;
mod understand;
mod wide;
mod words;

use std::collections::BTreeSet;

use l4d_data::tracks::Tracks;

pub use canonical::canonical;
pub use examples::examples;
pub use read::{Unread, read};
pub use say::{LONGEST, SHORTEST, forms, vocabulary};
pub use understand::{Reading, understand};
pub use words::{Vocabulary, Words};

use lexicon::lexicon;

/// What of these tracks has no words: nouns, verbs and properties, each as a line. Properties that sentences never
/// mention (which hand is the left one) are not missing.
pub fn missing(tracks: &Tracks) -> Vec<String> {
    let mut found = BTreeSet::new();
    for instance in &tracks.instances {
        let category = &instance.category;
        if lexicon().noun(category).is_none() {
            found.insert(format!("noun `{category}`"));
        }
        for (key, value) in &instance.attributes {
            let has_words = !lexicon().wordings(category, key, value).is_empty();
            if !has_words && !lexicon().is_unsaid(key, value) {
                found.insert(format!("{key} `{value}` of `{category}`"));
            }
        }
    }
    for event in &tracks.events {
        let verb = &event.verb;
        let with_object = event.object.is_some();
        let is_said = lexicon().verb(verb).is_some_and(|known| known.said(with_object).next().is_some());
        if !is_said {
            let frame = if with_object { "with" } else { "without" };
            found.insert(format!("verb `{verb}` {frame} an object"));
        }
    }
    found.into_iter().collect()
}
