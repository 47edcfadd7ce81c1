//! Small TOML files that people write. Errors name the line or the field and quote no value: it may be a key in the wrong
//! place, or part of a file that a link leads to.

use std::path::Path;

use serde::de::DeserializeOwned;

use crate::error::DataError;
use crate::store::read_bounded;

/// No such file is larger.
const MAX_BYTES: u64 = 1 << 20;

/// Reads a file; `hint` says where its fields are described.
///
/// # Errors
/// A file that cannot be read, or has another form.
pub fn read<T: DeserializeOwned>(path: &Path, hint: &str) -> Result<T, DataError> {
    let bytes = read_bounded(path, MAX_BYTES)?;
    let text = str::from_utf8(&bytes)
        .map_err(|error| DataError::invalid(path, "top level", format!("is no text: {error}"), hint))?;
    parse(path, text, hint)
}

/// Parses the text of `path`.
///
/// # Errors
/// Text of another form.
pub fn parse<T: DeserializeOwned>(path: &Path, text: &str, hint: &str) -> Result<T, DataError> {
    let wrong = |place: String, error: &toml::de::Error| {
        DataError::invalid(path, place, without_values(error.message()), hint)
    };
    let document = toml::Deserializer::parse(text).map_err(|error| {
        let line = error.span().map_or(1, |span| text[..span.start].matches('\n').count() + 1);
        wrong(format!("line {line}"), &error)
    })?;
    serde_path_to_error::deserialize(document).map_err(|error| {
        let field = error.path().to_string();
        let place = if field == "." { "top level".to_owned() } else { format!("field `{field}`") };
        wrong(place, error.inner())
    })
}

/// A parser's message without the value that it quotes, which may hold quotes itself.
fn without_values(message: &str) -> String {
    match (message.find('"'), message.rfind('"')) {
        (Some(first), Some(last)) => format!("{}\"...\"{}", &message[..first], &message[last + 1..]),
        _ => message.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Settings {
        #[expect(dead_code)]
        views: u32,
    }

    #[test]
    fn errors_name_the_place_and_quote_no_value() {
        for (text, place) in [
            ("root:x:0:0:canary:/root\n", "line 1"),
            ("# canary\nviews = 1\nviews = canary", "line 3"),
            ("views = \"canary \\\" canary\"", "field `views`"),
            ("views = 1\nmore = \"canary\"", "unknown field `more`"),
            ("more = 'canary'", "unknown field `more`"),
        ] {
            let error = parse::<Settings>(Path::new("x.toml"), text, "see the docs").unwrap_err();
            let told = format!("{error} {error:?}");
            assert!(
                told.contains(place) && !told.contains("canary") && error.hint() == "see the docs",
                "{told}"
            );
        }
    }
}
