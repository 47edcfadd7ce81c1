//! JSON out of what models write: thinking, prose and code fences around it are passed over. Nothing is repaired.

use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::error::{EndpointError, excerpt, tail};

/// Text with more brackets that open nothing is no answer, and looking on would take long.
const MAX_OPENINGS: usize = 1000;

/// The text after the thinking. Some templates open the thinking themselves, so that only its end is seen.
pub(crate) fn without_thinking(text: &str) -> &str {
    const ENDS: [&str; 2] = ["</think>", "</thinking>"];
    let after = ENDS.iter().filter_map(|end| text.rfind(end).map(|at| at + end.len())).max();
    let text = after.map_or(text, |at| &text[at..]).trim();
    if text.starts_with("<think>") || text.starts_with("<thinking>") { "" } else { text }
}

/// The first JSON object or array in the text that is a `T`.
pub(crate) fn first_json<T: DeserializeOwned>(text: &str) -> Result<T, EndpointError> {
    let mut mismatch = None;
    let mut start = 0;
    for _ in 0..MAX_OPENINGS {
        let Some(offset) = text[start..].find(['{', '[']) else { break };
        start += offset;
        let mut documents = serde_json::Deserializer::from_str(&text[start..]).into_iter::<Value>();
        match documents.next() {
            Some(Ok(document)) => {
                start += documents.byte_offset();
                match serde_path_to_error::deserialize(document) {
                    Ok(value) => return Ok(value),
                    Err(error) => mismatch = mismatch.or(Some(error)),
                }
            }
            // What is inside it would be a fragment.
            Some(Err(error)) if error.is_eof() => {
                return Err(EndpointError::Truncated { excerpt: tail(text) });
            }
            _ => start += 1,
        }
    }
    Err(match mismatch {
        Some(error) => {
            let field = error.path().to_string();
            let field = if field == "." { "top level".to_owned() } else { field };
            EndpointError::Unfit { message: format!("{field}: {}", excerpt(&error.inner().to_string())) }
        }
        None => EndpointError::NoJson { excerpt: excerpt(text) },
    })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use serde::Deserialize;
    use serde_json::json;

    use super::*;

    #[derive(Debug, PartialEq, Deserialize)]
    struct Found {
        boxes: Vec<[i32; 2]>,
    }

    fn found(text: &str) -> Result<Found, EndpointError> {
        first_json(without_thinking(text))
    }

    #[test]
    fn json_is_found_behind_all_that_models_put_around_it() {
        let bare = r#"{"boxes":[[1,2]]}"#;
        for text in [
            bare.to_owned(),
            format!("```json\n{bare}\n```"),
            format!("Sure! Here [as you asked] are {{all}} of them:\n{bare}\nAnything else?"),
            format!("<think>maybe {{\"boxes\":[[9,9]]}}?</think>\n{bare}"),
            format!("a template opened this {{\"boxes\":[[9,9]]}} </think> {bare}"),
            format!("I count [1, 2] of them. {bare}"),
            format!("{bare}{bare}"),
            format!("\u{feff}{bare}"),
        ] {
            assert_eq!(found(&text).unwrap(), Found { boxes: vec![[1, 2]] }, "{text}");
        }
    }

    #[test]
    fn what_is_no_answer_has_its_own_error() {
        let kind = |text: &str| found(text).unwrap_err();
        assert!(matches!(kind("I cannot see any."), EndpointError::NoJson { .. }));
        assert!(matches!(kind(""), EndpointError::NoJson { .. }));
        assert!(matches!(kind(r#"```json {"boxes":[[1,2],[3"#), EndpointError::Truncated { .. }));
        assert!(matches!(kind(r#"[1] {"boxes":[[1,2],[3"#), EndpointError::Truncated { .. }));
        assert!(matches!(kind(r#"{'boxes': [[1, 2]]}"#), EndpointError::Unfit { .. }));
        assert!(matches!(
            first_json::<Value>(r#"[{"box":[1,2]},{"bo"#),
            Err(EndpointError::Truncated { .. })
        ));
        match kind(r#"{"boxes":[[1,"two"]]}"#) {
            EndpointError::Unfit { message } => assert!(message.starts_with("boxes[0][1]: "), "{message}"),
            other => panic!("{other}"),
        }
    }

    #[test]
    fn deep_nesting_and_endless_openings_are_no_danger() {
        for text in ["[".repeat(2 << 20), "{\"a\":".repeat(1 << 20), "[1,".repeat(1 << 20)] {
            assert!(found(&text).is_err());
        }
    }

    proptest! {
        #[test]
        fn any_text_is_survived(text in "[\\[\\]{}\",:0-9a-z<>/ä ]{0,60}") {
            found(&text).ok();
        }

        #[test]
        fn any_cut_of_an_answer_is_half_or_nothing(length in 0..30_usize) {
            let text = r#"{"boxes":[[1,2],[30,40]]}"#;
            let cut = &text[..length.min(text.len())];
            prop_assert_eq!(first_json::<Value>(cut).is_ok(), cut.len() == text.len());
        }

        #[test]
        fn any_document_is_read_back(words in prop::collection::vec(any::<String>(), 0..5)) {
            let document = json!({ "boxes": words });
            let text = format!("so:\n```json\n{document}\n```");
            prop_assert_eq!(first_json::<Value>(&text).unwrap(), document);
        }
    }
}
