//! Which of some sentences is the most like another one, by the words that they share.
//!
//! Knows no grammar and no meaning: it suggests a sentence to a user whose own was not understood.

use std::collections::BTreeSet;

/// The sentence that has the most words in common with `text` for its length (Dice's coefficient, every word counted
/// once); of equals the first. None where there is none to choose from.
pub fn nearest<'s>(text: &str, sentences: impl IntoIterator<Item = &'s str>) -> Option<&'s str> {
    let wanted = words_of(text);
    let mut best: Option<(f64, &str)> = None;
    for sentence in sentences {
        let likeness = dice(&wanted, &words_of(sentence));
        if best.is_none_or(|(most, _)| likeness > most) {
            best = Some((likeness, sentence));
        }
    }
    best.map(|(_, sentence)| sentence)
}

fn words_of(text: &str) -> BTreeSet<String> {
    let words = text.split(|letter: char| !letter.is_alphanumeric());
    words.filter(|word| !word.is_empty()).map(str::to_lowercase).collect()
}

fn dice(a: &BTreeSet<String>, b: &BTreeSet<String>) -> f64 {
    let both = a.len() + b.len();
    if both == 0 { 0.0 } else { 2.0 * a.intersection(b).count() as f64 / both as f64 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SENTENCES: [&str; 4] = [
        "The red cup on the tray",
        "The cup that the woman lifts",
        "The cup that the man lifts",
        "The spoon with which the woman stirs her tea, slowly and for a long time",
    ];

    fn of(text: &str) -> Option<&'static str> {
        nearest(text, SENTENCES)
    }

    #[test]
    fn shared_words_decide() {
        assert_eq!(of("the RED mug on a tray!"), Some(SENTENCES[0]));
        assert_eq!(of("The mug that a man lifts."), Some(SENTENCES[2]));
        assert_eq!(of("the spoon she stirs her tea with, for a while"), Some(SENTENCES[3]));
    }

    #[test]
    fn long_sentences_have_no_advantage() {
        assert_eq!(of("The woman"), Some(SENTENCES[1]));
        assert_eq!(of("tray, tray, tray: the woman lifts"), Some(SENTENCES[1]), "words count once");
    }

    #[test]
    fn of_equals_the_first_is_taken() {
        assert_eq!(of("The cup that somebody lifts"), Some(SENTENCES[1]));
        for strange in ["", "?!", "\u{8d64}\u{3044}", "Der rote Eimer"] {
            assert_eq!(of(strange), Some(SENTENCES[0]), "{strange:?}");
        }
        assert_eq!(nearest("The cup", []), None);
    }
}
