//! A folder that one run at a time writes into.

use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};
use std::thread::sleep;
use std::time::{Duration, Instant};

use super::{make_folder, sweep};
use crate::error::DataError;

/// The right to write into a folder; dropping gives it back, and so does a kill. The folder itself is locked, so that
/// nothing is left in it; one that was made for a run that writes nothing is removed.
#[derive(Debug)]
pub struct FolderLock {
    pub(super) file: File,
    /// The folder, if it was not there before.
    made: Option<PathBuf>,
}

/// How long a run waits for one that is about to end.
const PATIENCE: Duration = Duration::from_secs(2);

impl FolderLock {
    /// Makes the folder if it is missing, and removes what killed runs left half-written below it.
    ///
    /// # Errors
    /// A folder that another run writes into, and what the disk refuses.
    pub fn take(folder: &Path) -> Result<Self, DataError> {
        let lock = Self::ask(folder)?.ok_or_else(|| busy(folder))?;
        sweep(folder)?;
        Ok(lock)
    }

    /// The same for a folder that may hold much else: waits a moment, and looks at nothing in it.
    pub(super) fn wait(folder: &Path) -> Result<Self, DataError> {
        let begin = Instant::now();
        loop {
            match Self::ask(folder)? {
                Some(lock) => return Ok(lock),
                None if begin.elapsed() > PATIENCE => return Err(busy(folder)),
                None => sleep(PATIENCE / 100),
            }
        }
    }

    /// None where another run has it.
    fn ask(folder: &Path) -> Result<Option<Self>, DataError> {
        let made = (!folder.exists()).then(|| folder.to_owned());
        make_folder(folder)?;
        let file = File::open(folder).map_err(|source| DataError::io(folder, "open the folder", source))?;
        // A filesystem that cannot lock folders is no error.
        let is_busy = matches!(file.try_lock(), Err(TryLockError::WouldBlock));
        // The run that had it has removed the folder.
        let is_gone = !folder.exists();
        Ok((!is_busy && !is_gone).then_some(Self { file, made }))
    }
}

fn busy(folder: &Path) -> DataError {
    let hint = "wait until it has ended, or choose another folder";
    DataError::invalid(folder, "folder", "another l4d writes into it", hint)
}

impl Drop for FolderLock {
    fn drop(&mut self) {
        if let Some(folder) = &self.made {
            // Only where nothing was written.
            std::fs::remove_dir(folder).ok();
        }
        // A child that is just being started holds a copy of the handle, and with it the lock, for a moment longer.
        self.file.unlock().ok();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_folder_has_one_writer_and_nothing_is_left_in_it() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("out");
        let lock = FolderLock::take(&out).unwrap();
        std::fs::write(out.join(".l4d-1-0.tmp"), "half").unwrap();
        let error = FolderLock::take(&out).unwrap_err();
        assert!(error.to_string().ends_with("another l4d writes into it"), "{error}");
        drop(lock);
        FolderLock::take(&out).unwrap();
        assert_eq!(std::fs::read_dir(&out).unwrap().count(), 0);
        std::fs::remove_dir(&out).unwrap();
        drop(FolderLock::take(&out).unwrap());
        assert!(!out.exists(), "a folder that was made for nothing stays");
    }
}
