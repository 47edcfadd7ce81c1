//! Changes the `status` of queries in place: every other byte of the file stays as it was written.
//!
//! Knows nothing of votes. `l4d verdict` decides, and is the only caller.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;
use serde_json::value::RawValue;

use crate::error::DataError;
use crate::json;
use crate::query::{QueryId, Status};
use crate::store::{read_bounded, write_atomic};

/// The two fields of a line that matter here; the others may be anything.
#[derive(Deserialize)]
struct Line<'a> {
    id: QueryId,
    #[serde(borrow)]
    status: &'a RawValue,
}

/// Sets the status of the queries of one file that are named; gives how many had another one. The file is written
/// once, atomically, and not at all where nothing changes. Ids that the file does not have are ignored.
///
/// # Errors
/// A file that cannot be read or written, or lacks one of the queries.
pub fn set_statuses(path: &Path, wanted: &BTreeMap<QueryId, Status>) -> Result<usize, DataError> {
    let bytes = read_bounded(path, json::MAX_BYTES)?;
    let mut written = Vec::with_capacity(bytes.len() + 16 * wanted.len());
    let mut changed = 0;
    for (index, line) in bytes.split_inclusive(|&byte| byte == b'\n').enumerate() {
        if line.trim_ascii().is_empty() {
            written.extend_from_slice(line);
            continue;
        }
        let refuse = |error: serde_json::Error| DataError::format(path, format!("line {}", index + 1), error);
        let Line { id, status } = serde_json::from_slice(line).map_err(refuse)?;
        let old: Status = serde_json::from_str(status.get()).map_err(refuse)?;
        match wanted.get(&id) {
            Some(&new) if new != old => {
                // The raw value borrows from the line, so its address tells where it is.
                let start = status.get().as_ptr() as usize - line.as_ptr() as usize;
                written.extend_from_slice(&line[..start]);
                written.extend_from_slice(&serde_json::to_vec(&new).map_err(refuse)?);
                written.extend_from_slice(&line[start + status.get().len()..]);
                changed += 1;
            }
            _ => written.extend_from_slice(line),
        }
    }
    if changed > 0 {
        write_atomic(path, &written)?;
    }
    Ok(changed)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wanted(pairs: &[(&str, Status)]) -> BTreeMap<QueryId, Status> {
        pairs.iter().map(|(id, status)| (id.parse().unwrap(), *status)).collect()
    }

    #[test]
    fn only_the_word_changes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("s.jsonl");
        // Spaces, the order of keys, CRLF, a blank line, the word in another field, no line feed at the end.
        let before = concat!(
            "{ \"status\" :  \"candidate\" , \"id\":\"s/001\", \"text\":\"a \\\"candidate\\\"\"}\r\n",
            "\n",
            "{\"id\":\"s/002\",\"status\":\"verified\"}\n",
            "{\"id\":\"s/003\",\"more\":[1,{\"status\":\"candidate\"}],\"status\":\"candidate\"}",
        );
        std::fs::write(&path, before).unwrap();
        let asked =
            wanted(&[("s/001", Status::Rejected), ("s/003", Status::Verified), ("t/001", Status::Verified)]);
        assert_eq!(set_statuses(&path, &asked).unwrap(), 2);
        let after = before
            .replace(":  \"candidate\" ,", ":  \"rejected\" ,")
            .replace("}],\"status\":\"candidate\"", "}],\"status\":\"verified\"");
        assert_eq!(std::fs::read_to_string(&path).unwrap(), after);
        assert_eq!(set_statuses(&path, &asked).unwrap(), 0, "the second time there is nothing to do");
    }

    #[test]
    fn nothing_is_written_where_nothing_changes_or_a_line_is_broken() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("s.jsonl");
        for bad in [
            "{\"id\":\"s/002\"}",
            "{",
            "{\"id\":\"s/002\",\"status\":\"fine\"}",
            "{\"id\":7,\"status\":\"verified\"}",
        ] {
            let text = format!("{{\"id\":\"s/001\",\"status\":\"candidate\"}}\n{bad}\n");
            std::fs::write(&path, &text).unwrap();
            let error = set_statuses(&path, &wanted(&[("s/001", Status::Verified)])).unwrap_err().to_string();
            assert!(error.contains("line 2"), "{bad}: {error}");
            assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
        }
        std::fs::write(&path, "{\"id\":\"s/001\",\"status\":\"verified\"}").unwrap();
        let written_at = std::fs::metadata(&path).unwrap().modified().unwrap();
        assert_eq!(set_statuses(&path, &wanted(&[("s/001", Status::Verified)])).unwrap(), 0);
        assert_eq!(std::fs::metadata(&path).unwrap().modified().unwrap(), written_at);
    }
}
