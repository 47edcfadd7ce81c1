//! What l4d wrote into a folder: only that is replaced there, unless the user says otherwise.
//!
//! `.l4d-written` lists files with their digests. A run notes first which names it is about to write, and at its end
//! what stands under them: what a run left that was killed is l4d's own, what somebody put there or changed is not.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use super::{FolderLock, folder_of, open_bounded, read_bounded, write_atomic};
use crate::digest::sha256_file;
use crate::error::DataError;
use crate::sums::MAX_BYTES;

const LIST: &str = ".l4d-written";
/// In place of the digest of what is being written.
const UNFINISHED: &str = "unfinished";
/// How far it is read, bytes.
const MOST_OF_A_CARD: u64 = 1 << 20;

/// Why a run may write into a folder without a list.
#[derive(Debug, Clone, Copy)]
pub struct Earlier<'a> {
    /// A file that versions without lists wrote there last.
    pub file: &'a str,
    /// What it contains.
    pub says: &'a str,
}

/// The right to write these names of a folder, and no other run's at the same time. Dropping it notes what was written.
#[derive(Debug)]
pub struct Claim {
    folder: PathBuf,
    /// Relative paths of files; with a final `/` a folder and all that is in it.
    names: Vec<String>,
    _lock: FolderLock,
}

impl Claim {
    /// Makes the folder if it is missing.
    ///
    /// # Errors
    /// A file under one of the names that l4d did not write, unless `force`; a folder that another run writes into; and
    /// what the disk refuses.
    pub fn take(
        folder: &Path,
        names: Vec<String>,
        earlier: Option<Earlier<'_>>,
        force: bool,
    ) -> Result<Self, DataError> {
        let lock = FolderLock::wait(folder)?;
        let list = List::read(folder)?;
        let is_ours = force || (list.is_none() && earlier.is_some_and(|earlier| earlier.is_in(folder)));
        let mut list = list.unwrap_or_default();
        if !is_ours {
            for file in present(folder, &names) {
                list.require(folder, &file)?;
            }
        }
        for name in &names {
            list.0.insert(name.clone(), UNFINISHED.to_owned());
        }
        list.write(folder)?;
        Ok(Self { folder: folder.to_owned(), names, _lock: lock })
    }

    /// The right to write one file.
    ///
    /// # Errors
    /// As [`Claim::take`].
    pub fn of_file(path: &Path, force: bool) -> Result<Self, DataError> {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Self::take(folder_of(path), vec![name], None, force)
    }

    /// Whether l4d has written a file of this name, whatever became of it.
    pub fn lists(folder: &Path, name: &str) -> bool {
        List::read(folder).is_ok_and(|list| list.is_some_and(|list| list.0.contains_key(name)))
    }

    fn settle(&self) -> Result<(), DataError> {
        let mut list = List::read(&self.folder)?.unwrap_or_default();
        let is_claimed = |file: &String| {
            self.names.iter().any(|name| file == name || (name.ends_with('/') && file.starts_with(name)))
        };
        list.0.retain(|file, _| !is_claimed(file));
        for file in present(&self.folder, &self.names) {
            if let Ok(digest) = sha256_file(&self.folder.join(&file)) {
                list.0.insert(file, digest);
            }
        }
        list.write(&self.folder)
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        // What could not be noted stays unfinished, which is l4d's own.
        self.settle().ok();
    }
}

impl Earlier<'_> {
    fn is_in(self, folder: &Path) -> bool {
        let mut bytes = Vec::new();
        if let Ok(file) = open_bounded(&folder.join(self.file), u64::MAX) {
            file.take(MOST_OF_A_CARD).read_to_end(&mut bytes).ok();
        }
        bytes.windows(self.says.len()).any(|part| part == self.says.as_bytes())
    }
}

/// Relative path -> digest, or [`UNFINISHED`].
#[derive(Default)]
struct List(BTreeMap<String, String>);

impl List {
    /// None where there is no list.
    fn read(folder: &Path) -> Result<Option<Self>, DataError> {
        let path = folder.join(LIST);
        if !path.exists() {
            return Ok(None);
        }
        let text = String::from_utf8_lossy(&read_bounded(&path, MAX_BYTES)?).into_owned();
        let lines = text.lines().filter_map(|line| line.split_once("  "));
        Ok(Some(Self(lines.map(|(digest, file)| (file.to_owned(), digest.to_owned())).collect())))
    }

    fn write(&self, folder: &Path) -> Result<(), DataError> {
        let path = folder.join(LIST);
        match self.0.is_empty() {
            true => fs::remove_file(&path).map_err(|source| DataError::io(&path, "remove", source)),
            false => write_atomic(&path, crate::sums::to_text(&self.0).as_bytes()),
        }
    }

    fn require(&self, folder: &Path, file: &str) -> Result<(), DataError> {
        let path = folder.join(file);
        let is_unfinished = |name: &str| self.0.get(name).is_some_and(|digest| digest == UNFINISHED);
        let mut folders = file.match_indices('/').map(|(end, _)| &file[..=end]);
        let is_ours = is_unfinished(file)
            || folders.any(is_unfinished)
            || self.0.get(file).is_some_and(|digest| sha256_file(&path).is_ok_and(|found| found == *digest));
        if is_ours {
            return Ok(());
        }
        let message = "was not written by l4d, or was changed since";
        let hint = "move it away, choose another place, or replace it with --force";
        Err(DataError::invalid(&path, "file", message, hint))
    }
}

/// What is there under the names: relative paths, no folders.
fn present(folder: &Path, names: &[String]) -> BTreeSet<String> {
    let (mut found, mut left) = (BTreeSet::new(), names.to_vec());
    while let Some(name) = left.pop() {
        let file = name.trim_end_matches('/');
        match fs::symlink_metadata(folder.join(file)) {
            Ok(kind) if !kind.is_dir() => {
                found.insert(file.to_owned());
            }
            Ok(_) if name.ends_with('/') => {
                let entries = fs::read_dir(folder.join(file)).into_iter().flatten().flatten();
                left.extend(entries.map(|entry| format!("{name}{}/", entry.file_name().to_string_lossy())));
            }
            // A folder in the place of a file cannot be replaced.
            _ => {}
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    const EARLIER: Option<Earlier<'_>> = Some(Earlier { file: "card.json", says: "l4d/card/1" });

    fn take(folder: &Path, force: bool) -> Result<Claim, DataError> {
        Claim::take(folder, vec!["table.csv".to_owned(), "figures/".to_owned()], EARLIER, force)
    }

    fn write(folder: &Path, file: &str, text: &str) {
        write_atomic(&folder.join(file), text.as_bytes()).unwrap();
    }

    #[test]
    fn what_l4d_wrote_is_replaced_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        write(folder, "notes.txt", "mine");
        for text in ["one", "two"] {
            let claim = take(folder, false).unwrap();
            write(folder, "table.csv", text);
            write(folder, "figures/deep/a.svg", text);
            drop(claim);
        }
        for file in ["table.csv", "figures/deep/a.svg", "figures/mine.svg"] {
            write(folder, file, "mine");
            let error = take(folder, false).unwrap_err();
            assert!(error.path().ends_with(file) && error.hint().contains("--force"), "{error}");
            drop(take(folder, true).unwrap());
            take(folder, false).unwrap();
        }
    }

    #[test]
    fn what_a_killed_run_left_is_replaced() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let claim = take(folder, false).unwrap();
        write(folder, "table.csv", "half");
        write(folder, "figures/a.svg", "half");
        // As a kill does, without a note of what was written; the lock goes with the process.
        let Claim { _lock: lock, .. } = &claim;
        lock.file.unlock().unwrap();
        std::mem::forget(claim);
        take(folder, false).unwrap();
    }

    #[test]
    fn nothing_is_left_of_a_run_that_writes_nothing() {
        let folder = tempfile::tempdir().unwrap();
        drop(take(folder.path(), false).unwrap());
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    }

    #[test]
    fn a_folder_of_an_earlier_version_is_known_by_its_card() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        write(folder, "table.csv", "of an earlier version");
        assert!(take(folder, false).is_err());
        write(folder, "card.json", r#"{"schema":"l4d/card/1"}"#);
        drop(take(folder, false).unwrap());
        write(folder, "table.csv", "mine");
        assert!(take(folder, false).is_err());
    }

    #[test]
    fn a_second_run_is_refused_while_the_first_one_writes() {
        let folder = tempfile::tempdir().unwrap();
        let claim = take(folder.path(), false).unwrap();
        assert!(take(folder.path(), true).unwrap_err().to_string().contains("another l4d writes into it"));
        drop(claim);
        take(folder.path(), false).unwrap();
    }
}
