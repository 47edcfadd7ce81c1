//! JSON and JSON Lines with errors that name file, line and field, and a canonical form for digests.

use std::path::Path;

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use crate::error::DataError;
use crate::store::{read_bounded, write_atomic};

/// No JSON file of the project is larger.
pub const MAX_BYTES: u64 = 512 << 20;

/// Reads one JSON document.
///
/// # Errors
/// A file that cannot be read, or is no such document.
pub fn read<T: DeserializeOwned>(path: &Path) -> Result<T, DataError> {
    parse(path, None, &read_bounded(path, MAX_BYTES)?)
}

/// A document that says what it is, and can be wrong in ways that its types allow.
pub trait Document: DeserializeOwned {
    /// What its field `schema` holds.
    const SCHEMA: &'static str;
    /// What to do about one that is wrong.
    const HINT: &'static str;

    /// Its field `schema`.
    fn schema(&self) -> &str;

    /// What cannot be: where, and why.
    fn problem(&self) -> Option<(String, String)>;
}

/// Reads a document and checks it.
///
/// # Errors
/// A file that cannot be read, is of another schema, or contradicts itself.
pub fn read_document<T: Document>(path: &Path) -> Result<T, DataError> {
    let document: T = read(path)?;
    let problem = match document.schema() {
        found if found == T::SCHEMA => document.problem(),
        found => {
            let message = format!("is `{found}`, but this l4d reads `{}`", T::SCHEMA);
            Some(("field `schema`".to_owned(), message))
        }
    };
    match problem {
        None => Ok(document),
        Some((place, message)) => Err(DataError::invalid(path, place, message, T::HINT)),
    }
}

/// Reads a JSON Lines file; blank lines are skipped. Gives each value with its line number, from 1.
///
/// # Errors
/// A file that cannot be read, or a line that is no such value.
pub fn read_lines<T: DeserializeOwned>(path: &Path) -> Result<Vec<(usize, T)>, DataError> {
    let bytes = read_bounded(path, MAX_BYTES)?;
    bytes
        .split(|&byte| byte == b'\n')
        .enumerate()
        .filter(|(_, line)| !line.trim_ascii().is_empty())
        .map(|(index, line)| Ok((index + 1, parse(path, Some(index + 1), line)?)))
        .collect()
}

/// Parses bytes that came from `path` (at line `line` of a JSON Lines file).
///
/// # Errors
/// Bytes that are no such document.
pub fn parse<T: DeserializeOwned>(path: &Path, line: Option<usize>, bytes: &[u8]) -> Result<T, DataError> {
    // Keeping track of the place costs time: it is done when there is something to say of it.
    serde_json::from_slice(bytes).or_else(|_| parse_tracked(path, line, bytes))
}

fn parse_tracked<T: DeserializeOwned>(
    path: &Path,
    line: Option<usize>,
    bytes: &[u8],
) -> Result<T, DataError> {
    let mut reader = serde_json::Deserializer::from_slice(bytes);
    let value = serde_path_to_error::deserialize(&mut reader).map_err(|error| {
        let field = error.path().to_string();
        let field = if field == "." { "top level".to_owned() } else { format!("field `{field}`") };
        let location = match line {
            Some(line) => format!("line {line}, {field}"),
            None => field,
        };
        DataError::format(path, location, error.inner())
    })?;
    let end = line.map_or_else(|| "end of file".to_owned(), |line| format!("line {line}"));
    reader.end().map_err(|error| DataError::format(path, end, error))?;
    Ok(value)
}

/// Writes a document as indented JSON with a final newline.
///
/// # Errors
/// What the disk refuses.
pub fn write<T: Serialize>(path: &Path, value: &T) -> Result<(), DataError> {
    write_atomic(path, &indented(path, value)?)
}

/// The bytes of a document as indented JSON with a final newline; `path` is where it is to go.
///
/// # Errors
/// What cannot be JSON.
pub fn indented<T: Serialize>(path: &Path, value: &T) -> Result<Vec<u8>, DataError> {
    let mut text = serde_json::to_string_pretty(value).map_err(|error| unwritable(path, &error))?;
    text.push('\n');
    Ok(text.into_bytes())
}

/// Writes a document on one line with a final newline (large machine-written data).
///
/// # Errors
/// What the disk refuses.
pub fn write_compact<T: Serialize>(path: &Path, value: &T) -> Result<(), DataError> {
    write_atomic(path, &compact(path, value)?)
}

/// The bytes of a document on one line with a final newline; `path` is where it is to go.
///
/// # Errors
/// What cannot be JSON.
pub fn compact<T: Serialize>(path: &Path, value: &T) -> Result<Vec<u8>, DataError> {
    let mut text = serde_json::to_string(value).map_err(|error| unwritable(path, &error))?;
    text.push('\n');
    Ok(text.into_bytes())
}

/// Writes one value per line.
///
/// # Errors
/// What the disk refuses.
pub fn write_lines<T: Serialize>(path: &Path, values: &[T]) -> Result<(), DataError> {
    let mut text = String::new();
    for value in values {
        text.push_str(&serde_json::to_string(value).map_err(|error| unwritable(path, &error))?);
        text.push('\n');
    }
    write_atomic(path, text.as_bytes())
}

/// Compact JSON with object keys sorted: the same value always gives the same bytes.
pub fn canonical(value: &Value) -> String {
    match value {
        Value::Object(fields) => {
            let mut keys: Vec<&String> = fields.keys().collect();
            keys.sort();
            let fields: Vec<String> = keys
                .into_iter()
                .map(|key| format!("{}:{}", Value::from(key.as_str()), canonical(&fields[key])))
                .collect();
            format!("{{{}}}", fields.join(","))
        }
        Value::Array(items) => format!("[{}]", items.iter().map(canonical).collect::<Vec<_>>().join(",")),
        scalar => scalar.to_string(),
    }
}

fn unwritable(path: &Path, error: &serde_json::Error) -> DataError {
    DataError::format(path, "document", error)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    #[derive(Debug, Deserialize)]
    struct Outer {
        #[expect(dead_code)]
        inner: Vec<Inner>,
    }

    #[derive(Debug, Deserialize)]
    struct Inner {
        #[expect(dead_code)]
        count: u32,
    }

    #[test]
    fn errors_name_file_line_and_field() {
        let error = parse::<Outer>(Path::new("x.jsonl"), Some(3), br#"{"inner":[{"count":1},{"count":-2}]}"#);
        let text = error.unwrap_err().to_string();
        assert!(text.starts_with("x.jsonl: line 3, field `inner[1].count`"), "{text}");
    }

    #[test]
    fn what_an_error_quotes_cannot_steer_a_terminal() {
        let error = parse::<Outer>(Path::new("x"), None, br#"{"inner":"\u001b]0;gotcha\u0007\u009b2J"}"#)
            .unwrap_err();
        assert!(
            error.to_string().contains("gotcha") && !error.to_string().contains(char::is_control),
            "{error:?}"
        );
    }

    #[test]
    fn trailing_text_is_refused() {
        assert!(parse::<Value>(Path::new("x"), None, b"{} {}").is_err());
    }

    #[test]
    fn canonical_form_sorts_keys_at_every_depth() {
        let value: Value = serde_json::from_str(r#"{"b":[{"z":1,"a":"\n"}],"a":null}"#).unwrap();
        assert_eq!(canonical(&value), r#"{"a":null,"b":[{"a":"\n","z":1}]}"#);
    }
}
