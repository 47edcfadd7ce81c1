//! What a sentence may say: its words must fit how it binds time, and places that depend on the viewer are out.

use l4d_data::Temporal;

use crate::ast::{Clause, Predicate, Relation};
use crate::verbs::is_among;

/// Words that gate a sentence in time; each `while` sentence has at least one.
const GATES: &str = "while as when whenever during until before after once moment";
/// Words that gate a sentence so plainly that no `whole` sentence may have them.
const PLAIN_GATES: &str = "while when whenever during";
/// Words that depend on where the viewer is.
const VIEWER: &str = "leftmost rightmost left-hand right-hand foreground background";
/// After these, "left" and "right" are sides; elsewhere somebody left, or was right.
const BEFORE_SIDES: &str = "the to on far its his her their";
/// Words that make a description one of several.
const INDEFINITE: &str =
    "a an any some one another other no someone somebody something anyone anybody nobody";

/// Words of a sentence in lower case; hyphens and apostrophes inside a word belong to it.
pub fn words(text: &str) -> Vec<String> {
    let inside = |letter: char| letter.is_alphanumeric() || "'’-".contains(letter);
    let words = text.split(|letter: char| !inside(letter));
    let words = words.map(|word| word.trim_matches(['\'', '’', '-']).replace('’', "'").to_lowercase());
    words.filter(|word| !word.is_empty()).collect()
}

/// Whether the sentence speaks of one of several.
pub(crate) fn is_indefinite(text: &str) -> bool {
    words(text).iter().any(|word| is_among(INDEFINITE, word))
}

/// Whether the sentence says when, as every `while` sentence does.
pub fn says_when(text: &str) -> bool {
    words(text).iter().any(|word| is_among(GATES, word))
}

/// What is wrong with a sentence for a predicate, the spelling of its words aside.
pub fn wording_problem(text: &str, temporal: Temporal, predicate: &Predicate) -> Option<String> {
    temporal_problem(text, temporal, predicate).or_else(|| place_problem(text, predicate))
}

/// What is wrong with how the sentence binds time.
pub(crate) fn temporal_problem(text: &str, temporal: Temporal, predicate: &Predicate) -> Option<String> {
    match temporal {
        Temporal::While if !says_when(text) => {
            Some("temporal is `while`, but the sentence doesn't say when".to_owned())
        }
        // "When the clip ends" names a moment of the clip, not the time of the query.
        Temporal::Whole if names_a_moment(predicate) => None,
        Temporal::Whole => {
            let gate = words(text).into_iter().find(|word| is_among(PLAIN_GATES, word))?;
            Some(format!("temporal is `whole`, but \"{gate}\" gates the sentence"))
        }
        Temporal::While => None,
    }
}

fn names_a_moment(predicate: &Predicate) -> bool {
    predicate.clauses().iter().any(|clause| matches!(clause, Clause::AtStart(_) | Clause::AtEnd(_)))
}

/// What is wrong with a sentence whatever its predicate is: places that depend on the viewer, a full stop.
pub fn form_problem(text: &str) -> Option<String> {
    let words = words(text);
    let is_side = |word: &str| matches!(word, "left" | "right");
    let side = words.windows(2).find_map(|pair| match [pair[0].as_str(), pair[1].as_str()] {
        [before, side] if is_side(side) && is_among(BEFORE_SIDES, before) => Some(&pair[1]),
        [side, "of"] if is_side(side) => Some(&pair[0]),
        _ => None,
    });
    if let Some(word) = side.or_else(|| words.iter().find(|word| is_among(VIEWER, word))) {
        return Some(format!("\"{word}\" depends on where the viewer is"));
    }
    text.ends_with('.').then(|| "ends with a full stop, but is a noun phrase".to_owned())
}

/// What is wrong with the places that the sentence speaks of, and with its form.
pub(crate) fn place_problem(text: &str, predicate: &Predicate) -> Option<String> {
    if let Some(problem) = form_problem(text) {
        return Some(problem);
    }
    let words = words(text);
    let relates = |kind: Relation| {
        let clauses = predicate.clauses();
        clauses.iter().any(|clause| matches!(clause, Clause::Relation { kind: k, .. } if *k == kind))
    };
    let in_front =
        words.windows(2).any(|pair| pair == ["in", "front"]) || words.iter().any(|word| word == "ahead");
    let behind = words.iter().any(|word| word == "behind");
    for (says, kind) in [(in_front, Relation::InFrontOf), (behind, Relation::Behind)] {
        if says != relates(kind) {
            let (is, is_not) = if says { ("sentence", "predicate") } else { ("predicate", "sentence") };
            return Some(format!("the {is} says `{kind}`, the {is_not} doesn't"));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Predicate {
        Predicate::from_json(&serde_json::from_str(text).unwrap()).unwrap()
    }

    #[test]
    fn words_keep_hyphens_and_lose_stops() {
        assert_eq!(
            words("The dog's half-open box, (not) «that»"),
            ["the", "dog's", "half-open", "box", "not", "that"]
        );
    }

    #[test]
    fn gates_bind_time() {
        let tips = parse(r#"[{"category":"pear"},{"does":{"verb":"tip"}}]"#);
        let ends = parse(r#"[{"category":"pear"},{"at_end":{"does":{"verb":"tip"}}}]"#);
        assert!(temporal_problem("the pear that tips", Temporal::While, &tips).is_some());
        assert!(temporal_problem("the pear as it tips", Temporal::While, &tips).is_none());
        assert!(temporal_problem("the pear while it tips", Temporal::Whole, &tips).is_some());
        assert!(temporal_problem("the pear as big as a melon", Temporal::Whole, &tips).is_none());
        assert!(temporal_problem("the pear that tips when the clip ends", Temporal::Whole, &ends).is_none());
    }

    #[test]
    fn viewers_and_fronts() {
        let beside = parse(r#"[{"category":"a"},{"relation":{"kind":"beside","of":[{"name":"b"}]}}]"#);
        let behind = parse(r#"[{"category":"a"},{"relation":{"kind":"behind","of":[{"name":"b"}]}}]"#);
        assert!(place_problem("The cup to the left of the box", &beside).is_some());
        assert!(place_problem("The cup right of the box", &beside).is_some());
        assert!(place_problem("The cup left beside the box", &beside).is_none());
        assert!(place_problem("The cup behind the box", &beside).is_some());
        assert!(place_problem("The cup in the back of the box", &behind).is_some());
        assert!(place_problem("The cup behind the box", &behind).is_none());
        assert!(place_problem("The cup at the box.", &beside).is_some());
    }
}
