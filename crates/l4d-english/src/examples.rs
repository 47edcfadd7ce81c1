//! What can be said, by example: one sentence for each relation, extreme, order and state.

use l4d_data::Temporal;
use l4d_query::Predicate;
use serde_json::json;

use crate::say::forms;
use crate::words::Words;

/// A sentence for each way of telling things apart that is neither a property nor a verb, as far as these words can say
/// it, with what it is an example of.
pub fn examples(words: &Words<'_>) -> Vec<(&'static str, String)> {
    let is = |kind: &str, of: &str| json!({"relation": {"kind": kind, "of": [{"category": of}]}});
    let does = |verb: &str| json!({"does": {"verb": verb}});
    let predicates = [
        ("on", "cup", is("on", "table")),
        ("in", "ball", is("in", "basket")),
        ("under", "cat", is("under", "table")),
        ("beside", "dog", is("beside", "bench")),
        ("touching", "ball", is("touching", "box")),
        (
            "between",
            "child",
            json!({"relation": {"kind": "between", "of": [{"category": "table"}, {"category": "chair"}]}}),
        ),
        ("closest to", "cup", is("closest_to", "bowl")),
        ("farthest from", "cup", is("farthest_from", "bowl")),
        ("in front of", "dog", is("in_front_of", "child")),
        ("behind", "dog", is("behind", "child")),
        ("facing", "cat", is("facing", "dog")),
        ("largest", "ball", json!({"superlative": "largest"})),
        ("smallest", "ball", json!({"superlative": "smallest"})),
        ("tallest", "child", json!({"superlative": "tallest"})),
        ("highest", "cup", json!({"superlative": "highest"})),
        ("lowest", "cup", json!({"superlative": "lowest"})),
        ("not", "cat", json!({"not": does("walk")})),
        ("at the start", "cup", json!({"at_start": is("on", "table")})),
        ("at the end", "cup", json!({"at_end": is("on", "table")})),
        ("first to", "child", json!({"first": does("jump")})),
        ("last to", "child", json!({"last": does("jump")})),
        ("one thing, then another", "dog", json!({"then": [does("walk"), does("jump")]})),
    ];
    let sentence = |(what, noun, clause): (&'static str, &str, serde_json::Value)| {
        let predicate = Predicate::from_json(&json!([{"category": noun}, clause])).ok()?;
        Some((what, forms(&predicate, Temporal::Whole, words).into_iter().next()?))
    };
    predicates.into_iter().filter_map(sentence).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read::read;

    #[test]
    fn every_one_can_be_said_and_is_read_back() {
        let words = Words::all();
        let found = examples(&words);
        assert_eq!(found.len(), 22, "{found:?}");
        for (what, sentence) in found {
            assert!(read(&sentence, &words).is_ok(), "{what}: {sentence}");
        }
    }
}
