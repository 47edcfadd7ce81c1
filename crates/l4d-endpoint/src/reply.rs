//! A model's answer, and the JSON in it: thinking, prose and code fences around it are passed over. Nothing is
//! repaired.

use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::error::{EndpointError, excerpt, tail};

/// Text with more brackets that open nothing is no answer, and looking on would take long.
const MAX_OPENINGS: usize = 1000;

/// An answer that arrived: whole, cut off or refused.
#[derive(Debug, Clone, PartialEq)]
pub struct Reply {
    /// What the model said, without its thinking.
    pub text: String,
    /// Why it stopped.
    pub finish: Finish,
    /// What it cost.
    pub usage: Usage,
    /// The model that the server says it used.
    pub model: Option<String>,
    /// Where the answer came from.
    pub origin: Origin,
    /// Digest of the question as it was sent: the name of the exchange in a cache or recording.
    pub digest: String,
    /// What a person who relies on the answer should know (pictures that may have been lost, ...).
    pub notes: Vec<String>,
}

/// Why a model stopped.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Finish {
    /// It was done, or the server gives no reason.
    Stop,
    /// It ran into the limit of tokens.
    Length,
    /// It or its server declined, with the words given.
    Refused(String),
}

/// Where an answer came from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// The server, just now.
    Server,
    Cache,
    Recording,
}

/// Tokens, as the server counts them; `None` when it does not say.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Usage {
    /// Of the question.
    pub prompt_tokens: Option<u64>,
    /// Of the answer, thinking included.
    pub completion_tokens: Option<u64>,
}

impl Reply {
    /// A whole answer of no server, for tests of what reads answers.
    pub fn saying(text: &str) -> Self {
        Self {
            text: text.to_owned(),
            finish: Finish::Stop,
            usage: Usage::default(),
            model: None,
            origin: Origin::Server,
            digest: "d".repeat(64),
            notes: Vec::new(),
        }
    }

    /// The text of a whole answer.
    ///
    /// # Errors
    /// If the answer was cut off, refused or empty.
    pub fn whole(&self) -> Result<&str, EndpointError> {
        match &self.finish {
            Finish::Length => Err(EndpointError::Truncated(tail(&self.text))),
            Finish::Refused(words) => Err(EndpointError::Refused(excerpt(words))),
            Finish::Stop if self.text.is_empty() => Err(EndpointError::Unfit("it is empty".to_owned())),
            Finish::Stop => Ok(&self.text),
        }
    }

    /// The first JSON object or array in a whole answer that is a `T`.
    ///
    /// # Errors
    /// As [`Reply::whole`], and if the answer holds no such JSON.
    pub fn json<T: DeserializeOwned>(&self) -> Result<T, EndpointError> {
        let text = self.whole()?;
        let mut mismatch = None;
        for document in documents(text) {
            let Some(document) = document else {
                // What is inside it would be a fragment.
                return Err(EndpointError::Truncated(tail(text)));
            };
            match serde_path_to_error::deserialize(document) {
                Ok(value) => return Ok(value),
                Err(error) => mismatch = mismatch.or(Some(error)),
            }
        }
        Err(match mismatch {
            Some(error) => {
                let field = error.path().to_string();
                let field = if field == "." { "top level".to_owned() } else { field };
                EndpointError::Unfit(format!("{field}: {}", excerpt(&error.inner().to_string())))
            }
            None => EndpointError::NoJson(excerpt(text)),
        })
    }
}

/// The JSON objects and arrays in a text, in order; `None` for one that the end of the text cuts off, and then those
/// inside it.
pub fn documents(text: &str) -> impl Iterator<Item = Option<Value>> {
    let mut start = 0;
    let mut openings = 0;
    std::iter::from_fn(move || {
        while openings < MAX_OPENINGS {
            openings += 1;
            start += text[start..].find(['{', '['])?;
            let mut values = serde_json::Deserializer::from_str(&text[start..]).into_iter::<Value>();
            match values.next() {
                Some(Ok(document)) => {
                    start += values.byte_offset();
                    return Some(Some(document));
                }
                Some(Err(error)) if error.is_eof() => {
                    start += 1;
                    return Some(None);
                }
                _ => start += 1,
            }
        }
        None
    })
}

/// The text after the thinking. Some templates open the thinking themselves, so that only its end is seen.
pub(crate) fn without_thinking(text: &str) -> &str {
    const ENDS: [&str; 2] = ["</think>", "</thinking>"];
    let after = ENDS.iter().filter_map(|end| text.rfind(end).map(|at| at + end.len())).max();
    let text = after.map_or(text, |at| &text[at..]).trim();
    if text.starts_with("<think>") || text.starts_with("<thinking>") { "" } else { text }
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
        Reply::saying(without_thinking(text)).json()
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
        assert!(matches!(kind(r#"```json {"boxes":[[1,2],[3"#), EndpointError::Truncated { .. }));
        assert!(matches!(kind(r#"[1] {"boxes":[[1,2],[3"#), EndpointError::Truncated { .. }));
        assert!(matches!(kind(r#"{'boxes': [[1, 2]]}"#), EndpointError::Unfit { .. }));
        let message = kind(r#"{"boxes":[[1,"two"]]}"#).to_string();
        assert!(message.contains("boxes[0][1]: "), "{message}");
    }

    #[test]
    fn what_is_whole_inside_of_what_is_cut_off_is_found_too() {
        let half = r#"so: {"boxes": [{"a": 1}, {"a": "{"}, {"a": 3"#;
        let whole: Vec<Value> = documents(half).flatten().collect();
        assert_eq!(whole, [json!({"a": 1}), json!({"a": "{"})]);
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
            prop_assert_eq!(Reply::saying(cut).json::<Value>().is_ok(), cut.len() == text.len());
        }

        #[test]
        fn any_document_is_read_back(words in prop::collection::vec(any::<String>(), 0..5)) {
            let document = json!({ "boxes": words });
            let text = format!("so:\n```json\n{document}\n```");
            prop_assert_eq!(Reply::saying(&text).json::<Value>().unwrap(), document);
        }
    }
}
