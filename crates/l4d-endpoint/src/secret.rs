//! Keys: read from environment variables, never printed, taken out of everything that comes back.

use std::ffi::OsString;
use std::fmt;

use l4d_data::error::is_hidden;
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
                let hint = "export the key, or leave `api_key_env` out if the server wants none";
                EndpointError::not_asked(format!("environment variable {variable}"), message, hint)
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

/// Takes keys out of text and of the strings of JSON, whatever the case of letters and whatever invisible characters are
/// between them. It decodes nothing: bodies of errors, where servers echo keys in encodings of all kinds, are not read.
#[derive(Clone, Default)]
pub(crate) struct Redactor {
    keys: Vec<Vec<u8>>,
}

impl Redactor {
    /// For these keys.
    pub(crate) fn new(secrets: &[Secret]) -> Self {
        Self { keys: secrets.iter().map(|secret| secret.0.clone().into_bytes()).collect() }
    }

    /// The body of an answer without keys; one without any keeps its bytes.
    pub(crate) fn body(&self, body: &str) -> String {
        match serde_json::from_str::<Value>(body) {
            Ok(document) => {
                let clean = self.document(&document);
                if clean == document { self.text(body) } else { self.text(&clean.to_string()) }
            }
            Err(_) => self.text(body),
        }
    }

    fn document(&self, document: &Value) -> Value {
        match document {
            Value::String(text) => self.text(text).into(),
            Value::Array(items) => items.iter().map(|item| self.document(item)).collect(),
            Value::Object(fields) => {
                fields.iter().map(|(name, value)| (self.text(name), self.document(value))).collect()
            }
            _ => document.clone(),
        }
    }

    /// Text without keys; one without any keeps its bytes.
    pub(crate) fn text(&self, text: &str) -> String {
        let mut clean = text.to_owned();
        for key in &self.keys {
            let visible: Vec<(usize, char)> =
                clean.char_indices().filter(|(_, letter)| !is_invisible(*letter)).collect();
            let (mut redacted, mut end, mut next) = (String::with_capacity(clean.len()), 0, 0);
            while let Some(window) = visible.get(next..next + key.len()) {
                let is_key = window
                    .iter()
                    .zip(key)
                    .all(|((_, letter), byte)| letter.eq_ignore_ascii_case(&char::from(*byte)));
                if is_key {
                    redacted.push_str(&clean[end..window[0].0]);
                    redacted.push_str(REDACTED);
                    // A key is ASCII: its last letter is one byte long.
                    end = window[key.len() - 1].0 + 1;
                }
                next += if is_key { key.len() } else { 1 };
            }
            redacted.push_str(&clean[end..]);
            clean = redacted;
        }
        clean
    }
}

/// Whether no one sees a letter, so that a text with it reads like one without: no key holds any.
fn is_invisible(letter: char) -> bool {
    let is_mark = matches!(
        letter,
        '\u{ad}' | '\u{34f}' | '\u{115f}' | '\u{1160}' | '\u{17b4}' | '\u{17b5}' | '\u{180b}'..='\u{180f}' | '\u{3164}'
            | '\u{fe00}'..='\u{fe0f}' | '\u{ffa0}' | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e0fff}'
    );
    is_mark || is_hidden(letter) || letter.is_whitespace()
}

impl fmt::Debug for Redactor {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "Redactor({} keys)", self.keys.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KEY: &str = "sk-canary/7Yq+\"x%41";

    fn redactor(key: &str) -> Redactor {
        Redactor::new(&[Secret::new(key).unwrap()])
    }

    fn spaced(text: &str, between: &str) -> String {
        text.chars().map(String::from).collect::<Vec<_>>().join(between)
    }

    #[test]
    fn a_key_is_taken_out_whatever_is_between_its_letters_and_nothing_else() {
        let invisible = [
            "",
            "\0",
            "\u{1b}",
            "\u{7f}",
            "\u{85}",
            "\r\n",
            "\u{ad}",
            "\u{200b}",
            "\u{200d}\u{2060}",
            "\u{202e}",
            "\u{2028}",
            "\u{feff}",
            "\u{fe0f}",
            "\u{e0041}",
            "\u{3164}",
        ];
        for between in invisible {
            for key in [KEY.to_owned(), KEY.to_uppercase(), KEY.to_lowercase()] {
                let echo = spaced(&key, between);
                let text = format!("no\u{200b} <b>{echo}</b>, {echo}100% ä");
                let clean = redactor(KEY).text(&text);
                assert_eq!(clean, text.replace(&echo, REDACTED), "{between:?}");
            }
        }
        // The beginning of a key once more before the key.
        assert_eq!(redactor("aab-aab-x").text("aab-aab-aab-x!"), format!("aab-{REDACTED}!"));
    }

    #[test]
    fn strings_of_a_document_are_read_before_keys_are_looked_for() {
        let escaped: String =
            KEY.chars().map(|letter| format!("\\u{:04x}\\u200b", u32::from(letter))).collect();
        let json = Value::from(KEY).to_string().replace('/', "\\/");
        for echo in [format!("\"{escaped}\""), json] {
            let body = format!("{{\"a\": [{{\"b\": {echo}}}], {echo}: 1.50}}");
            let clean = redactor(KEY).body(&body);
            let document: Value = serde_json::from_str(&clean).unwrap();
            assert!(document["a"][0]["b"].as_str().unwrap().starts_with(REDACTED), "{clean}");
            assert!(document.as_object().unwrap().keys().any(|name| name.starts_with(REDACTED)), "{clean}");
        }
        assert_eq!(redactor(KEY).body(&format!("not JSON: {KEY}")), format!("not JSON: {REDACTED}"));
    }

    #[test]
    fn texts_without_a_key_keep_their_bytes() {
        let text = "{ \"text\" : \"a\\nb\u{200d} &amp; %41 sk-canar\", \"n\": 1.50 } \n";
        assert_eq!(redactor(KEY).body(text), text);
        assert_eq!(Redactor::default().body(text), text);
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
        assert!(!format!("{secret:?}{:?}", redactor(KEY)).contains("canary"));
    }
}
