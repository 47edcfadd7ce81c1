//! Writing proposals without losing earlier ones: of another model, or edited by hand.

use std::path::{Path, PathBuf};

use l4d_data::DataError;
use l4d_data::store::{read_bounded, write_atomic};

/// Writes all of the files, or none of them if one holds something else and `force` is off.
pub(crate) fn write_unless_other(files: &[(PathBuf, String)], force: bool) -> Result<(), DataError> {
    for (path, text) in files {
        if !force && holds_something_else(path, text)? {
            let message = "holds something else: of another model, of another run, or edited by hand";
            let remedy =
                "choose another --out, or replace it with --force; the new answer is kept in the cache";
            return Err(DataError::invalid(path, "file", message, remedy));
        }
    }
    files.iter().try_for_each(|(path, text)| write_atomic(path, text.as_bytes()))
}

fn holds_something_else(path: &Path, text: &str) -> Result<bool, DataError> {
    if !path.exists() {
        return Ok(false);
    }
    let standing = read_bounded(path, l4d_data::json::MAX_BYTES)?;
    Ok(!standing.is_empty() && standing != text.as_bytes())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_foreign_file_keeps_all_of_them_as_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let (a, b) = (folder.path().join("a"), folder.path().join("b"));
        std::fs::write(&b, "of another model").unwrap();
        let files = [(a.clone(), "one".to_owned()), (b.clone(), "two".to_owned())];
        let error = write_unless_other(&files, false).unwrap_err();
        assert!(error.path() == b && error.hint().unwrap().contains("--force"), "{error}");
        assert!(!a.exists());
        write_unless_other(&files, true).unwrap();
        write_unless_other(&files, false).expect("the same again is fine");
        assert_eq!(std::fs::read_to_string(&b).unwrap(), "two");
        std::fs::write(&b, "").unwrap();
        write_unless_other(&files, false).expect("nothing is lost with an empty file");
    }
}
