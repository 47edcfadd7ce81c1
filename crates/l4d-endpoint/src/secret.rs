//! Keys: read from environment variables, never printed, taken out of everything that comes back.

use std::ffi::OsString;
use std::fmt;

use serde_json::Value;

use crate::error::EndpointError;

/// Replaces a key.
pub(crate) const REDACTED: &str = "[redacted]";

/// A shorter key looks like a word when it is taken out of what a server sends.
const SHORTEST: usize = 8;

/// Where keys are looked up by the name of their variable.
pub(crate) type Environment<'a> = &'a dyn Fn(&str) -> Option<OsString>;

/// A key. Its text goes into a request header and nowhere else.
#[derive(Clone, PartialEq, Eq)]
pub(crate) struct Secret(String);

impl Secret {
    /// The key in a variable of the environment.
    pub(crate) fn read(variable: &str, environment: Environment<'_>) -> Result<Self, EndpointError> {
        let text = environment(variable).ok_or("is not set");
        text.and_then(|text| text.into_string().map_err(|_not_utf8| "is not text"))
            .and_then(|text| Self::new(&text))
            .map_err(|message| {
                let remedy = "export the key, or leave `api_key_env` out if the server wants none";
                EndpointError::not_asked(format!("environment variable {variable}"), message, remedy)
            })
    }

    /// Checks a key; space around it is dropped. The error never quotes it.
    fn new(text: &str) -> Result<Self, &'static str> {
        let text = text.trim();
        if text.len() < SHORTEST {
            return Err("holds fewer than 8 characters, which is no key");
        }
        if !text.bytes().all(|byte| byte.is_ascii_graphic()) {
            return Err("holds spaces, line breaks or other characters that no key has");
        }
        Ok(Self(text.to_owned()))
    }

    /// The text, for a header.
    pub(crate) fn expose(&self) -> &str {
        &self.0
    }
}

impl fmt::Debug for Secret {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(REDACTED)
    }
}

/// Takes keys out of text, however a server echoes them.
#[derive(Clone, Default)]
pub(crate) struct Redactor {
    forms: Vec<String>,
}

impl Redactor {
    /// For these keys.
    pub(crate) fn new(secrets: &[Secret]) -> Self {
        let mut forms: Vec<String> = secrets.iter().flat_map(|secret| spellings(&secret.0)).collect();
        // A longer form may contain a shorter one.
        forms.sort_by_key(|form| std::cmp::Reverse(form.len()));
        forms.dedup();
        Self { forms }
    }

    /// Text without keys.
    pub(crate) fn text(&self, text: &str) -> String {
        self.forms.iter().fold(text.to_owned(), |text, form| match text.contains(form) {
            true => text.replace(form, REDACTED),
            false => text,
        })
    }

    /// A body without keys, those in JSON escapes included.
    pub(crate) fn body(&self, body: &str) -> String {
        let body = self.text(body);
        if self.forms.is_empty() || !body.contains('\\') {
            return body;
        }
        let Ok(mut document) = serde_json::from_str::<Value>(&body) else { return body };
        if self.clean(&mut document) { document.to_string() } else { body }
    }

    /// Cleans all strings and names in a document; whether anything was found.
    fn clean(&self, value: &mut Value) -> bool {
        match value {
            Value::String(text) => self.clean_text(text),
            Value::Array(items) => items.iter_mut().fold(false, |found, item| self.clean(item) | found),
            Value::Object(fields) => {
                let mut found = false;
                let cleaned = std::mem::take(fields).into_iter().map(|(mut name, mut value)| {
                    found |= self.clean_text(&mut name) | self.clean(&mut value);
                    (name, value)
                });
                *fields = cleaned.collect();
                found
            }
            Value::Null | Value::Bool(_) | Value::Number(_) => false,
        }
    }

    fn clean_text(&self, text: &mut String) -> bool {
        let cleaned = self.text(text);
        let found = cleaned != *text;
        *text = cleaned;
        found
    }
}

impl fmt::Debug for Redactor {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Redactor({} forms)", self.forms.len())
    }
}

/// The key as it is, in a URL, in JSON with escaped slashes, and in HTML.
fn spellings(key: &str) -> Vec<String> {
    let percent: String = key
        .bytes()
        .map(|byte| match byte {
            byte if byte.is_ascii_alphanumeric() || b"-_.~".contains(&byte) => char::from(byte).to_string(),
            byte => format!("%{byte:02X}"),
        })
        .collect();
    let json = Value::from(key).to_string();
    let json = json.trim_matches('"').to_owned();
    let slashed = json.replace('/', "\\/");
    let html = key.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
    let mut all = vec![key.to_owned(), percent.to_lowercase(), percent, json, slashed, html];
    // A lower-case form of a key without escapes would be another word.
    all.retain(|form| form == key || form.to_lowercase() != key.to_lowercase());
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEY: &str = "sk-canary/7Yq+\"x";

    fn redactor() -> Redactor {
        Redactor::new(&[Secret::new(KEY).unwrap()])
    }

    #[test]
    fn every_spelling_of_a_key_is_taken_out() {
        let echoes = [
            format!("Incorrect API key provided: {KEY}."),
            r#"{"error":"bad sk-canary/7Yq+\"x"}"#.to_owned(),
            r#"{"error":"bad sk-canary\/7Yq+\"x"}"#.to_owned(),
            r#"{"error":{"\u0073k-canary/7Yq+\"x":["\u0073\u006b-canary\u002f7Yq+\"x"]}}"#.to_owned(),
            "GET /?key=sk-canary%2F7Yq%2B%22x".to_owned(),
            "GET /?key=sk-canary%2f7yq%2b%22x".to_owned(),
        ];
        for echo in echoes {
            let cleaned = redactor().body(&echo);
            assert!(cleaned.contains(REDACTED), "{cleaned}");
            let lower = cleaned.to_lowercase();
            assert!(!lower.contains("7yq"), "{cleaned}");
        }
    }

    #[test]
    fn bodies_without_a_key_keep_their_bytes() {
        let body = "{ \"text\" : \"a\\nb\" }";
        assert_eq!(redactor().body(body), body);
        assert_eq!(Redactor::default().body(body), body);
    }

    #[test]
    fn what_is_no_key_is_refused_without_being_quoted() {
        for bad in ["", "short", "with space inside", "line\nbreak-key", "schlüssel-schlüssel"] {
            assert!(Secret::new(bad).is_err(), "{bad:?} was taken for a key");
        }
        assert_eq!(Secret::new("  sk-12345678\r\n").unwrap().expose(), "sk-12345678");
    }

    #[test]
    fn a_key_has_no_debug_output() {
        let secret = Secret::new(KEY).unwrap();
        assert!(!format!("{secret:?}{:?}", redactor()).contains("canary"));
    }
}
