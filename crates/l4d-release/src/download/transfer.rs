//! One file of a release: into a `.part`, on from where that ends, and into its place once its digest is right.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Write as _};
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::Duration;

use l4d_data::digest::sha256_file;
use l4d_data::store::{folder_of, make_folder};
use l4d_data::{DataError, StageError, sums};

use super::{Base, Missing};

/// So often a file is asked for again without a byte arriving in between.
const TRIES: u32 = 4;
const FIRST_PAUSE: Duration = Duration::from_millis(500);

/// A file of a few megabytes at most, read whole.
pub(super) fn read_small(base: &dyn Base, file: &str) -> Result<Vec<u8>, StageError> {
    let mut tries = 0;
    loop {
        let mut bytes = Vec::new();
        let read = base.read(file, 0).and_then(|(_, reader)| {
            reader.take(sums::MAX_BYTES).read_to_end(&mut bytes).map_err(|error| passing(&error))
        });
        match read {
            Ok(_) => return Ok(bytes),
            Err(missing) => again(base, file, missing, &mut tries)?,
        }
    }
}

/// Fetches a file below a folder, and gives its path.
pub(super) fn fetch(base: &dyn Base, file: &str, sha256: &str, folder: &Path) -> Result<PathBuf, StageError> {
    let path = folder.join(file);
    if path.is_file() && sha256_file(&path)? == sha256 {
        return Ok(path);
    }
    make_folder(folder_of(&path))?;
    let mut part = path.clone().into_os_string();
    part.push(".part");
    let part = PathBuf::from(part);
    let mut tries = 0;
    loop {
        let before = length(&part);
        match append(base, file, &part, before) {
            Ok(()) => break,
            Err(Problem::Here(error)) => return Err(error.into()),
            Err(Problem::There(missing)) => {
                if length(&part) > before {
                    tries = 0;
                }
                again(base, file, missing, &mut tries)?;
            }
        }
    }
    if sha256_file(&part)? != sha256 {
        // Nothing of it can be gone on with.
        fs::remove_file(&part).map_err(|source| DataError::io(&part, "remove", source))?;
        return Err(altered(&base.name(file)));
    }
    fs::rename(&part, &path).map_err(|source| DataError::io(&path, "move the file to", source))?;
    Ok(path)
}

/// The refusal of a file with other bytes.
pub(super) fn altered(name: &str) -> StageError {
    StageError::new(
        format!("{name}: bytes are not those that SHA256SUMS lists"),
        "run the same command again; if it says the same, ask the publisher of the release",
    )
}

enum Problem {
    Here(DataError),
    There(Missing),
}

fn length(part: &Path) -> u64 {
    fs::metadata(part).map_or(0, |metadata| metadata.len())
}

/// Appends what a file lacks.
fn append(base: &dyn Base, file: &str, part: &Path, from: u64) -> Result<(), Problem> {
    let (first, mut reader) = base.read(file, from).map_err(Problem::There)?;
    let here = |source: io::Error| Problem::Here(DataError::io(part, "write", source));
    let mut out: File = OpenOptions::new().create(true).append(true).open(part).map_err(here)?;
    if first != from {
        out.set_len(first).map_err(here)?;
    }
    let mut block = vec![0; 1 << 16];
    loop {
        let count = match reader.read(&mut block) {
            Ok(0) => break,
            Ok(count) => count,
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            Err(error) => return Err(Problem::There(passing(&error))),
        };
        out.write_all(&block[..count]).map_err(here)?;
    }
    out.sync_all().map_err(here)
}

fn passing(error: &io::Error) -> Missing {
    Missing { message: error.to_string(), is_passing: true }
}

/// Waits before the next try, if there is one.
fn again(base: &dyn Base, file: &str, missing: Missing, tries: &mut u32) -> Result<(), StageError> {
    *tries += 1;
    if !missing.is_passing || *tries == TRIES {
        let hint = "name the folder or address that holds SHA256SUMS and release.json of a release; run the same \
                    command again to go on";
        return Err(StageError::new(format!("{}: {}", base.name(file), missing.message), hint));
    }
    sleep(FIRST_PAUSE * 2_u32.pow(*tries - 1));
    Ok(())
}
