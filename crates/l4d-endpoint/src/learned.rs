//! What a server taught: fields that it rejects by name, left out from then on.

use std::collections::BTreeSet;

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::call::Response;
use crate::request::Request;

/// Fields that may be left out without changing what is asked. What a user sets under `[body]` is not among them:
/// whoever sets a field wants to hear that it fails.
const OPTIONAL: [&str; 4] = ["temperature", "seed", "response_format", "format"];
const MAX_TOKENS: [&str; 2] = ["max_tokens", "max_completion_tokens"];

/// Lessons about one server and model.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Learned {
    /// Fields that it does not take.
    pub(crate) omitted: BTreeSet<String>,
    /// Whether it wants the limit of the answer under the other of its two names.
    pub(crate) other_max_tokens: bool,
}

impl Learned {
    /// Spells a body the way that the server wants it.
    pub(crate) fn apply(&self, body: &mut Value) {
        let Some(fields) = body.as_object_mut() else { return };
        for field in &self.omitted {
            fields.shift_remove(field);
        }
        if self.other_max_tokens {
            let [older, newer] = MAX_TOKENS;
            for (from, to) in [(older, newer), (newer, older)] {
                if let Some(limit) = fields.shift_remove(from) {
                    fields.insert(to.to_owned(), limit);
                    break;
                }
            }
        }
    }

    /// These lessons and the one in a server's rejection of `body`; `None` if there is nothing to learn from it.
    pub(crate) fn with(&self, response: &Response, body: &Value) -> Option<Self> {
        if !matches!(response.status, 400 | 422) {
            return None;
        }
        let document: Value = serde_json::from_str(&response.body).ok()?;
        let mut learned = self.clone();
        let field = rejected_field(&document, body)?;
        if MAX_TOKENS.contains(&field) {
            // Once: a server that rejects both names minds the number.
            let other = MAX_TOKENS.into_iter().find(|name| *name != field)?;
            if self.other_max_tokens || !response.body.contains(other) {
                return None;
            }
            learned.other_max_tokens = true;
        } else {
            learned.omitted.insert(field.to_owned());
        }
        Some(learned)
    }

    /// What to tell whoever relies on the answer to this question.
    pub(crate) fn notes(&self, request: &Request) -> Vec<String> {
        let is_wanted = |field: &str| match field {
            "temperature" => request.temperature.is_some(),
            "seed" => request.seed.is_some(),
            _ => request.schema.is_some(),
        };
        let missed = self.omitted.iter().filter(|field| is_wanted(field));
        missed.map(|field| format!("the server does not take `{field}`: it was left out")).collect()
    }
}

/// The field of `body` that a rejection is about.
fn rejected_field(document: &Value, body: &Value) -> Option<&'static str> {
    let candidates = || OPTIONAL.into_iter().chain(MAX_TOKENS).filter(|field| !body[*field].is_null());
    let named = |name: &str| {
        let name = name.split(['.', '[']).next().unwrap_or_default();
        candidates().find(|field| *field == name)
    };
    let parameter = [&document["error"]["param"], &document["param"]].into_iter().find_map(Value::as_str);
    if let Some(field) = parameter.and_then(named) {
        return Some(field);
    }
    let places =
        document["detail"].as_array().into_iter().flatten().filter_map(|detail| detail["loc"].as_array());
    if let Some(field) = places.flatten().filter_map(Value::as_str).find_map(named) {
        return Some(field);
    }
    let text = document.to_string();
    let mentions = candidates().filter_map(|field| Some((find_word(&text, field)?, field)));
    mentions.min().map(|(_, field)| field)
}

/// Where a word stands on its own: `seed`, but not `unseeded`.
fn find_word(text: &str, word: &str) -> Option<usize> {
    let is_part =
        |letter: Option<char>| letter.is_some_and(|letter| letter.is_alphanumeric() || letter == '_');
    text.match_indices(word).map(|(at, _)| at).find(|&at| {
        !is_part(text[..at].chars().next_back()) && !is_part(text[at + word.len()..].chars().next())
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use serde_json::json;

    use super::*;

    fn body() -> Value {
        json!({"model": "m", "messages": [], "max_tokens": 5, "temperature": 0.0, "seed": 0, "response_format": {}})
    }

    fn lesson(status: u16, rejection: &Value) -> Option<Learned> {
        let response = Response { status, headers: BTreeMap::new(), body: rejection.to_string() };
        Learned::default().with(&response, &body())
    }

    fn omitted(rejection: &Value) -> Option<String> {
        lesson(400, rejection)?.omitted.into_iter().next()
    }

    #[test]
    fn the_named_field_is_found_in_every_wording() {
        let cases = [
            (json!({"error": {"message": "Unsupported value", "param": "temperature"}}), Some("temperature")),
            (
                json!({"error": {"message": "bad", "param": "response_format.json_schema"}}),
                Some("response_format"),
            ),
            (
                json!({"detail": [{"loc": ["body", "seed"], "msg": "extra fields not permitted"}]}),
                Some("seed"),
            ),
            (
                json!({"object": "error", "message": "[{'type': 'extra_forbidden', 'loc': ('body', 'seed')}]"}),
                Some("seed"),
            ),
            (
                json!({"error": "json: unknown field \"response_format\", seed is fine"}),
                Some("response_format"),
            ),
            (json!({"error": {"message": "the unseeded model is out of temperatures"}}), None),
            (json!({"error": {"message": "messages must not be empty", "param": "messages"}}), None),
            (json!({"error": {"message": "top_p is not supported"}}), None),
        ];
        for (rejection, expected) in cases {
            assert_eq!(omitted(&rejection).as_deref(), expected, "{rejection}");
        }
    }

    #[test]
    fn the_limit_is_renamed_once_and_never_dropped() {
        let rejection = json!({"error": {"message": "Unsupported parameter: 'max_tokens'. Use 'max_completion_tokens' instead.", "param": "max_tokens"}});
        let learned = lesson(400, &rejection).unwrap();
        let mut renamed = body();
        learned.apply(&mut renamed);
        assert_eq!((&renamed["max_completion_tokens"], &renamed["max_tokens"]), (&json!(5), &Value::Null));
        let response = Response { status: 400, headers: BTreeMap::new(), body: rejection.to_string() };
        assert_eq!(learned.with(&response, &renamed), None);
        assert_eq!(lesson(400, &json!({"error": {"message": "max_tokens is too large"}})), None);
    }

    #[test]
    fn other_statuses_teach_nothing() {
        let rejection = json!({"error": {"param": "seed"}});
        assert!(lesson(422, &rejection).is_some());
        for status in [200, 401, 404, 413, 429, 500] {
            assert_eq!(lesson(status, &rejection), None);
        }
    }
}
