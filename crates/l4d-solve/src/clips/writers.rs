//! Files are written by threads of their own: who computes never waits for a disk, and syncs that wait together are
//! done together.

use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::mpsc::sync_channel;
use std::thread;

use l4d_data::store::write_atomic;
use l4d_data::{DataError, StageError};

use super::folder::FrameEntry;
use super::plan::PictureIndex;

const WRITERS: usize = 8;
/// Pictures that wait to be written: bounds memory where the disk is slow.
const WAITING: usize = 32;

/// A picture on its way to the disk.
#[derive(Debug)]
pub(super) struct Sheet {
    pub(super) index: PictureIndex,
    pub(super) entry: FrameEntry,
    /// Files in the order in which they are written.
    pub(super) files: [(PathBuf, Vec<u8>); 2],
}

/// Does some work that hands over pictures, and waits until they are on the disk; `written` hears of each. The first
/// file that cannot be written ends it.
pub(super) fn writing(
    written: impl Fn(PictureIndex, FrameEntry) + Sync,
    work: impl FnOnce(&(dyn Fn(Sheet) -> Result<(), StageError> + Sync)) -> Result<(), StageError>,
) -> Result<(), StageError> {
    let (sender, receiver) = sync_channel::<Sheet>(WAITING);
    let receiver = Mutex::new(receiver);
    let failure: Mutex<Option<DataError>> = Mutex::new(None);
    let has_failed = || failure.lock().is_ok_and(|failure| failure.is_some());
    let result = thread::scope(|scope| {
        for _ in 0..WRITERS {
            scope.spawn(|| {
                let next = || receiver.lock().ok()?.recv().ok();
                while let Some(Sheet { index, entry, files }) = next() {
                    match files.iter().try_for_each(|(path, bytes)| write_atomic(path, bytes)) {
                        Ok(()) => written(index, entry),
                        Err(error) => {
                            if let Ok(mut failure) = failure.lock() {
                                failure.get_or_insert(error);
                            }
                        }
                    }
                }
            });
        }
        // The error of the file is reported instead of this one.
        let stopped = || StageError::new("a file could not be written", "see to the disk");
        let hand_over = |sheet: Sheet| match has_failed() {
            true => Err(stopped()),
            false => sender.send(sheet).map_err(|_closed| stopped()),
        };
        let result = work(&hand_over);
        drop(sender);
        result
    });
    // Whatever stopped the work, a full disk is the reason if there is one.
    match failure.into_inner().ok().flatten() {
        Some(error) => Err(error.into()),
        None => result,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_is_on_the_disk_when_it_returns_and_a_failure_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let sheet = |view: usize, folder: &str| Sheet {
            index: PictureIndex { view, instant: 0 },
            entry: FrameEntry::default(),
            files: ["a", "b"]
                .map(|name| (PathBuf::from(folder).join(format!("{view}{name}")), vec![view as u8])),
        };
        let place = folder.path().join("out").display().to_string();
        let written = Mutex::new(Vec::new());
        let note = |index: PictureIndex, _| written.lock().unwrap().push(index.view);
        writing(note, |hand_over| (0..100).try_for_each(|view| hand_over(sheet(view, &place)))).unwrap();
        assert_eq!(written.lock().unwrap().len(), 100);
        assert_eq!(std::fs::read(folder.path().join("out/99b")).unwrap(), [99]);

        std::fs::write(folder.path().join("blocked"), "a file, not a folder").unwrap();
        let blocked = folder.path().join("blocked").display().to_string();
        let result =
            writing(note, |hand_over| (0..100).try_for_each(|view| hand_over(sheet(view, &blocked))));
        assert!(result.unwrap_err().to_string().contains("blocked"));
    }
}
