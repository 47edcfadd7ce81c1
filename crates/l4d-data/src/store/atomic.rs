//! Atomic writes of files: a file appears whole or not at all, though it is written piece by piece.
//!
//! Until [`AtomicFile::commit`] it is a temporary file beside its target, locked by the process that writes it. The
//! operating system releases the lock of a process that was killed, so a temporary file without a lock is left over.
//! Other machines that share the disk see that, too. Knows nothing of what is written.

use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufWriter, ErrorKind, Write as _};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use super::make_folder;
use crate::error::DataError;

/// A temporary file, locked, under a name that nothing else uses; dropping removes it.
#[derive(Debug)]
pub struct Temporary {
    path: PathBuf,
    writer: BufWriter<File>,
}

impl Temporary {
    /// Creates one, and its folder if that is missing; removes from the folder what killed processes left there.
    ///
    /// # Errors
    /// What the operating system refuses.
    pub fn create(folder: &Path) -> Result<Self, DataError> {
        make_folder(folder)?;
        sweep_once(folder);
        let (path, file) =
            open_new(folder).map_err(|source| DataError::io(folder, "write into the folder", source))?;
        Ok(Self { path, writer: BufWriter::new(file) })
    }

    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Appends bytes.
    ///
    /// # Errors
    /// What the operating system refuses.
    pub fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.writer.write_all(bytes)
    }

    /// Empties the buffer, so that other processes can read what was written so far.
    ///
    /// # Errors
    /// What the operating system refuses.
    pub fn flush(&mut self) -> io::Result<()> {
        self.writer.flush()
    }

    /// Renames it to `path`; the lock is held until then.
    fn commit(mut self, path: &Path) -> io::Result<()> {
        self.writer.flush()?;
        self.writer.get_ref().sync_all()?;
        fs::rename(&self.path, path)?;
        // Dropping must remove nothing: another process, on this or another machine, may use the name by now.
        self.path.clear();
        Ok(())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        fs::remove_file(&self.path).ok();
    }
}

/// Writes to a temporary file in the same folder; [`AtomicFile::commit`] moves it into place, dropping removes it.
#[derive(Debug)]
pub struct AtomicFile {
    path: PathBuf,
    temporary: Temporary,
}

impl AtomicFile {
    /// Starts the file; creates its folder if that is missing.
    ///
    /// # Errors
    /// What the operating system refuses.
    pub fn create(path: &Path) -> Result<Self, DataError> {
        Ok(Self { path: path.to_owned(), temporary: Temporary::create(folder_of(path))? })
    }

    /// Appends bytes.
    ///
    /// # Errors
    /// What the operating system refuses.
    pub fn write(&mut self, bytes: &[u8]) -> Result<(), DataError> {
        self.temporary.write(bytes).map_err(|source| DataError::io(&self.path, "write", source))
    }

    /// The writer, for libraries that want an [`io::Write`].
    pub fn writer(&mut self) -> &mut (impl io::Write + use<>) {
        &mut self.temporary.writer
    }

    /// Syncs the file to disk and moves it into place.
    ///
    /// # Errors
    /// What the operating system refuses.
    pub fn commit(self) -> Result<(), DataError> {
        self.temporary.commit(&self.path).map_err(|source| DataError::io(&self.path, "write", source))?;
        // The rename itself must survive a power cut; a filesystem that cannot sync folders is no error.
        if let Ok(folder) = File::open(folder_of(&self.path)) {
            folder.sync_all().ok();
        }
        Ok(())
    }
}

/// The folder of a file; `.` if the path is a mere name.
pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// A new file under a name that no process uses, locked where the filesystem supports locks.
fn open_new(folder: &Path) -> io::Result<(PathBuf, File)> {
    static NEXT: AtomicU64 = AtomicU64::new(0);
    loop {
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let path = folder.join(format!(".l4d-{}-{number}.tmp", std::process::id()));
        let file = match File::create_new(&path) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists => continue,
            file => file?,
        };
        // Between creating and locking it, another process may have removed it as left over: then try the next name.
        if !matches!(file.try_lock(), Err(TryLockError::WouldBlock)) && path.exists() {
            return Ok((path, file));
        }
    }
}

/// Removes the temporary files that killed processes left in a folder and below it; those that are being written stay.
/// A missing folder is no error.
///
/// # Errors
/// A folder that cannot be listed.
pub fn sweep(folder: &Path) -> Result<(), DataError> {
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        let inner = sweep_one(&folder).map_err(|source| DataError::io(&folder, "list the folder", source))?;
        folders.extend(inner);
    }
    Ok(())
}

/// [`sweep_one`] of a folder before this process first writes into it.
fn sweep_once(folder: &Path) {
    static SWEPT: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());
    if SWEPT.lock().unwrap_or_else(PoisonError::into_inner).insert(folder.to_owned()) {
        // A file that stays only takes room: no reason to refuse the write.
        sweep_one(folder).ok();
    }
}

/// Removes the left-over temporary files of a folder, not of those in it; gives the folders in it.
fn sweep_one(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let mut inner = Vec::new();
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(inner),
        entries => entries?,
    };
    for entry in entries {
        let entry = entry?;
        let kind = entry.file_type()?;
        if kind.is_dir() {
            inner.push(entry.path());
        } else if kind.is_file() && entry.file_name().to_str().is_some_and(is_temporary) {
            remove_left_over(&entry.path());
        }
    }
    Ok(inner)
}

/// `.l4d-<process>-<number>.tmp`, or another ending where a library insists on one.
fn is_temporary(name: &str) -> bool {
    let parts = name.strip_prefix(".l4d-").and_then(|name| name.split_once('.')?.0.split_once('-'));
    let is_number = |part: &str| part.bytes().all(|byte| byte.is_ascii_digit());
    parts.is_some_and(|(process, number)| is_number(process) && is_number(number))
}

/// Removes a temporary file unless its process lives, or the filesystem cannot say.
fn remove_left_over(path: &Path) {
    let is_left_over = match OpenOptions::new().write(true).open(path.with_extension("tmp")) {
        Ok(locked) => locked.try_lock().is_ok(),
        Err(error) => error.kind() == ErrorKind::NotFound,
    };
    if is_left_over {
        fs::remove_file(path).ok();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_commit_replaces_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/file.csv");
        let write = |text: &str| {
            let mut file = AtomicFile::create(&path).unwrap();
            file.write(text.as_bytes()).unwrap();
            file
        };
        write("old").commit().unwrap();
        drop(write("torn"));
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        write("new").commit().unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(fs::read_dir(path.parent().unwrap()).unwrap().count(), 1);
    }

    #[test]
    fn sweeping_removes_what_a_killed_process_left_and_keeps_what_is_being_written() {
        let folder = tempfile::tempdir().unwrap();
        let left = [".l4d-1-0.tmp", "deep/.l4d-1-0.tmp", "deep/er/.l4d-1-0.usdc"]
            .map(|name| folder.path().join(name));
        let others = [".notes.tmp", ".l4d-notes.tmp", "l4d-1-0.tmp"].map(|name| folder.path().join(name));
        fs::create_dir_all(folder.path().join("deep/er")).unwrap();
        left.iter().chain(&others).for_each(|path| fs::write(path, "half").unwrap());
        let mut file = AtomicFile::create(&folder.path().join("file")).unwrap();
        assert_eq!(left.each_ref().map(|path| path.exists()), [false, true, true]);
        file.write(b"whole").unwrap();
        sweep(folder.path()).unwrap();
        file.commit().unwrap();
        assert_eq!(fs::read(folder.path().join("file")).unwrap(), b"whole");
        assert!(!left.iter().any(|path| path.exists()) && others.iter().all(|path| path.exists()));
        sweep(&folder.path().join("missing")).unwrap();
    }

    #[test]
    fn threads_that_write_one_file_do_not_tear_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("file");
        let texts = ["a", "b"].map(|letter| letter.repeat(100_000));
        std::thread::scope(|scope| {
            for text in &texts {
                scope.spawn(|| {
                    for _ in 0..20 {
                        let mut file = AtomicFile::create(&path).unwrap();
                        file.write(text.as_bytes()).unwrap();
                        file.commit().unwrap();
                    }
                });
            }
        });
        assert!(texts.contains(&fs::read_to_string(&path).unwrap()));
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
