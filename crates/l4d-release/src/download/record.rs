//! What was unpacked of a release: which of its files became which files here.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use l4d_data::digest::sha256_file;
use l4d_data::{DataError, json};
use serde::{Deserialize, Serialize};

const SCHEMA: &str = "l4d/download/1";
const FILE: &str = "downloaded.json";

/// `downloaded.json`.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Record {
    schema: String,
    /// File of the release -> what became of it.
    files: BTreeMap<String, Unpacked>,
}

/// What became of a file.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Unpacked {
    pub(super) sha256: String,
    /// Folder of what it became.
    pub(super) target: PathBuf,
    /// Whether frames have ids.
    pub(super) with_ids: bool,
    /// File below that folder -> its digest.
    pub(super) files: BTreeMap<String, String>,
}

impl Record {
    pub(super) fn read(folder: &Path) -> Result<Self, DataError> {
        let path = folder.join(FILE);
        if !path.exists() {
            return Ok(Self { schema: SCHEMA.to_owned(), files: BTreeMap::new() });
        }
        let record: Self = json::read(&path)?;
        match record.schema == SCHEMA {
            true => Ok(record),
            false => {
                let message = format!("is `{}`, but this l4d reads `{SCHEMA}`", record.schema);
                Err(DataError::invalid(
                    &path,
                    "field `schema`",
                    message,
                    "remove the folder and download again",
                ))
            }
        }
    }

    pub(super) fn write(&self, folder: &Path) -> Result<(), DataError> {
        json::write(&folder.join(FILE), self)
    }

    pub(super) fn add(&mut self, file: String, unpacked: Unpacked) {
        self.files.insert(file, unpacked);
    }

    /// Removes what became of a file, unless it was changed: it is to be unpacked again.
    pub(super) fn clear(&mut self, file: &str, target: &Path) -> Result<(), DataError> {
        let Some(unpacked) = self.files.remove(file).filter(|unpacked| unpacked.target == target) else {
            return Ok(());
        };
        for (file, digest) in &unpacked.files {
            let path = target.join(file);
            if sha256_file(&path).is_ok_and(|found| found == *digest) {
                fs::remove_file(&path).map_err(|source| DataError::io(&path, "remove", source))?;
            }
        }
        Ok(())
    }

    /// What became of a file with that digest, in that folder; frames without ids are not frames with them.
    pub(super) fn find(&self, file: &str, sha256: &str, target: &Path, with_ids: bool) -> Option<&Unpacked> {
        let unpacked = self.files.get(file)?;
        let is_it = unpacked.sha256 == sha256 && unpacked.target == target;
        (is_it && (unpacked.with_ids || !with_ids)).then_some(unpacked)
    }

    /// Whether all that became of it is still there.
    pub(super) fn has(&self, file: &str, sha256: &str, target: &Path, with_ids: bool) -> bool {
        self.find(file, sha256, target, with_ids)
            .is_some_and(|unpacked| unpacked.files.keys().all(|file| target.join(file).is_file()))
    }

    /// All files that were written into a folder, with their digests.
    pub(super) fn below(&self, target: &Path) -> impl Iterator<Item = (String, String)> {
        let here = self.files.values().filter(move |unpacked| unpacked.target == target);
        here.flat_map(|unpacked| unpacked.files.clone())
    }
}
