//! The log of an annotator at work: locked, replayed, repaired and appended to.
//!
//! Nothing else writes a log, and this module opens no other file of the round than `round.toml` and `items.jsonl`,
//! which the caller has read. An event counts once it is on the disk; one that cannot be written is cut off again
//! and refused. If even that fails, the ballot refuses everything until it is opened anew.

use std::fs::{self, File, Metadata, OpenOptions, TryLockError};
use std::io::{Seek as _, SeekFrom, Write as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use l4d_data::digest::sha256_hex;
use l4d_data::store::{make_folder, read_bounded};
use l4d_data::{DataError, Finding, Name};

use crate::history::History;
use crate::item::{Item, ItemId};
use crate::line::{Act, SealEvent, Source, digest_of, write_line};
use crate::replay::{Replay, replay};
use crate::responses::MAX_BYTES;
use crate::round::Round;
use crate::round_dir::RoundDir;
use crate::vote::{Event, Response, ShownFrames};

/// The open log of one annotator. No second process can open it meanwhile.
#[derive(Debug)]
pub struct Ballot {
    path: PathBuf,
    round: Round,
    annotator: Name,
    order: Vec<ItemId>,
    history: History,
    file: File,
    length: u64,
    lines: u64,
    last: String,
    sealed: bool,
}

impl Ballot {
    /// Locks and replays the log of an annotator; makes it where there is none. A line that was not written to
    /// its end is cut off and reported; a log that was edited is refused, since nothing more would count in it.
    ///
    /// # Errors
    /// The round does not name the annotator, another process has the log, or it was edited or cannot be read.
    pub fn open(dir: &RoundDir, round: &Round, annotator: &Name) -> Result<(Self, Vec<Finding>), DataError> {
        round.require_annotator(annotator)?;
        let path = dir.ballot(annotator);
        let file = open_locked(&path, annotator)?;
        let bytes = read_bounded(&path, MAX_BYTES)?;
        let Replay { history, whole, lines, last, edited, sealed, mut report, last_at } =
            replay(&path, &bytes, round, annotator);
        if let Some((line, how)) = edited {
            return Err(DataError::invalid(
                &path,
                format!("line {line}"),
                format!("is not what was written ({how}): nothing from this line on would count"),
                "restore the file from a copy, or move it away and vote again",
            ));
        }
        if last_at.is_some_and(|last| SystemTime::now() < last) {
            report.warning(
                "L4D515",
                &path,
                format!("line {lines}"),
                "was written later than it is now, by the clock of this machine",
                "set the clock",
            );
        }
        let length = whole as u64;
        if whole < bytes.len() {
            let cut = file.set_len(length).and_then(|()| file.sync_all());
            cut.map_err(|source| DataError::io(&path, "cut off a torn line", source))?;
        }
        let (order, round, annotator) = (round.order(annotator), round.clone(), annotator.clone());
        let ballot = Self { path, round, annotator, order, history, file, length, lines, last, sealed };
        Ok((ballot, report.into_sorted()))
    }

    /// Writes an event. It counts, and survives a power cut, when this returns `Ok`; otherwise nothing happened.
    ///
    /// # Errors
    /// The ballot is sealed, the event cannot be, or it cannot be written.
    pub fn record(
        &mut self,
        item: &ItemId,
        event: Event,
        seen: ShownFrames,
        elapsed: Duration,
    ) -> Result<(), DataError> {
        self.record_from(&Source::now(), item, event, seen, elapsed)
    }

    /// As [`Ballot::record`], of an act that happened elsewhere.
    ///
    /// # Errors
    /// As there.
    pub fn record_from(
        &mut self,
        source: &Source,
        item: &ItemId,
        event: Event,
        seen: ShownFrames,
        elapsed: Duration,
    ) -> Result<(), DataError> {
        let refuse = |message: String, hint: &str| {
            Err(DataError::invalid(&self.path, format!("item {item}"), message, hint))
        };
        if self.sealed {
            return refuse("the ballot is sealed: nothing more counts".to_owned(), "vote in a further round");
        }
        let position = self.order.iter().position(|other| other == item);
        let (Some(asked), Some(position)) = (self.round.item(item), position) else {
            return refuse("the round does not ask it".to_owned(), "choose an item of the round");
        };
        if let Some(problem) = event.problem() {
            return refuse(problem.to_owned(), "change it and try again");
        }
        if event == Event::Undo && self.history.undoable(asked).is_none() {
            return refuse("nothing is left to undo".to_owned(), "go to an item that was answered");
        }
        let digest = asked.digest.clone();
        let act = Act::On {
            item: item.clone(),
            order: position + 1,
            digest: digest.clone(),
            event: event.clone(),
            seen,
            elapsed_ms: u64::try_from(elapsed.as_millis()).unwrap_or(u64::MAX),
        };
        let seq = self.append(source, act)?;
        self.history.apply(seq, item, &digest, event);
        Ok(())
    }

    /// Ends the work for good: nothing after it counts. Refused while an item is neither answered nor skipped.
    ///
    /// # Errors
    /// An item is open, the file is not what was written, or the seal cannot be written.
    pub fn seal(&mut self) -> Result<(), DataError> {
        self.seal_from(&Source::now())
    }

    /// As [`Ballot::seal`], of a ballot that was sealed elsewhere.
    ///
    /// # Errors
    /// As there.
    pub fn seal_from(&mut self, source: &Source) -> Result<(), DataError> {
        let refuse = |place: &str, message: String, hint: &str| {
            Err(DataError::invalid(&self.path, place, message, hint))
        };
        if self.sealed {
            return refuse("seal", "the ballot is sealed already".to_owned(), "nothing to do");
        }
        let open = self.open_count();
        if open > 0 {
            let message = format!("{open} item{} not answered", if open == 1 { " is" } else { "s are" });
            return refuse("seal", message, "answer or skip every item first");
        }
        let bytes = read_bounded(&self.path, MAX_BYTES)?;
        let again = replay(&self.path, &bytes, &self.round, &self.annotator);
        if again.last != self.last || again.lines != self.lines || again.edited.is_some() {
            return refuse(
                "seal",
                "the file is not what was written".to_owned(),
                "start again, and look at it",
            );
        }
        let seal = Act::Seal { event: SealEvent::Seal, lines: self.lines, sha256: sha256_hex(&bytes) };
        self.append(source, seal)?;
        self.sealed = true;
        Ok(())
    }

    /// The file that holds it.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Whether the ballot is sealed.
    pub fn is_sealed(&self) -> bool {
        self.sealed
    }

    /// All items in the order in which this annotator is asked.
    pub fn order(&self) -> &[ItemId] {
        &self.order
    }

    /// What the log says about an item; none for one that the round does not ask.
    pub fn response(&self, item: &ItemId) -> Option<Response> {
        self.round.item(item).map(|item| self.history.response(item))
    }

    /// How many items are neither answered nor skipped.
    pub fn open_count(&self) -> usize {
        let is_open = |item: &&Item| self.history.response(item).is_open();
        self.round.items.iter().filter(is_open).count()
    }

    /// The item whose latest event is the latest of all that an undo could take back.
    pub fn undoable(&self) -> Option<&ItemId> {
        let latest =
            self.round.items.iter().filter_map(|item| Some((self.history.undoable(item)?, &item.id)));
        latest.max().map(|(_, id)| id)
    }

    /// Puts a line on the disk; gives its number.
    fn append(&mut self, source: &Source, act: Act) -> Result<u64, DataError> {
        if !self.is_intact() {
            return Err(DataError::invalid(
                &self.path,
                "file",
                "is not as it was left: it was changed, replaced or removed, or an event could not be cut off again",
                "look at the file and the space on its disk, restore the file from a copy if needed, and start again",
            ));
        }
        let seq = self.lines;
        let log = (&self.round.name, &self.annotator);
        let bytes = write_line(log, seq, source, &self.last, act);
        if self.length + bytes.len() as u64 > MAX_BYTES {
            return Err(DataError::invalid(&self.path, "size", "is full", "vote in a further round"));
        }
        let at_end = self.file.seek(SeekFrom::Start(self.length));
        let written = at_end.and_then(|_| self.file.write_all(&bytes)).and_then(|()| self.file.sync_all());
        if let Err(source) = written {
            // Where even this fails, the file is no longer intact.
            self.file.set_len(self.length).and_then(|()| self.file.sync_all()).ok();
            return Err(DataError::io(&self.path, "write the event, so it does not count", source));
        }
        self.length += bytes.len() as u64;
        self.lines += 1;
        self.last = digest_of(&bytes);
        Ok(seq)
    }

    /// Whether the file is still the one that was opened and has the length that it was left with: a synced write into
    /// a file that was replaced or removed meanwhile would be lost all the same.
    fn is_intact(&self) -> bool {
        match (self.file.metadata(), fs::metadata(&self.path)) {
            (Ok(open), Ok(there)) => open.len() == self.length && is_same_file(&open, &there),
            _ => false,
        }
    }
}

impl Drop for Ballot {
    fn drop(&mut self) {
        // A child that is just being started holds a copy of the handle, and with it the lock, for a moment longer.
        self.file.unlock().ok();
    }
}

#[cfg(unix)]
fn is_same_file(a: &Metadata, b: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt as _;
    (a.dev(), a.ino()) == (b.dev(), b.ino())
}

#[cfg(not(unix))]
fn is_same_file(a: &Metadata, b: &Metadata) -> bool {
    a.len() == b.len()
}

fn open_locked(path: &Path, annotator: &Name) -> Result<File, DataError> {
    let folder = path.parent().unwrap_or(Path::new("."));
    make_folder(folder)?;
    if fs::symlink_metadata(path).is_ok_and(|metadata| !metadata.is_file()) {
        return Err(DataError::invalid(path, "file", "is not a regular file", "move it away"));
    }
    let mut options = OpenOptions::new();
    options.read(true).write(true).create(true).truncate(false);
    let file = options.open(path).map_err(|source| DataError::io(path, "open", source))?;
    match file.try_lock() {
        Ok(()) => {}
        Err(TryLockError::WouldBlock) => {
            return Err(DataError::invalid(
                path,
                "lock",
                format!("another window is open in which {annotator} votes in this round"),
                "go on there, or end it first",
            ));
        }
        Err(TryLockError::Error(source)) => return Err(DataError::io(path, "lock", source)),
    }
    // The entry of a new file must survive a power cut as well; a filesystem that cannot sync folders is no error.
    if let Ok(folder) = File::open(folder) {
        folder.sync_all().ok();
    }
    Ok(file)
}

#[cfg(test)]
mod kill;
#[cfg(test)]
mod tests;
