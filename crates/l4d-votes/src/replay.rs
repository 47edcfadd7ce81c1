//! Reads the bytes of a log: which lines count, what they add up to, and what is wrong with the others.
//!
//! Lines form a chain: each names the digest of the one before. Where the chain breaks, the file was edited, and
//! nothing counts from the first line on that is not what was written. (No line names the last one: only a seal, or
//! the next event, protects it.) A line that was not edited but is not about this round, annotator or
//! any of its items is left out by itself. Whatever is left out stays in the file and is reported.

use std::path::Path;
use std::time::SystemTime;

use l4d_data::digest::RunningDigest;
use l4d_data::{Name, Report};

use crate::history::History;
use crate::line::{Act, Line, Link, NO_LINE, VERSION, digest_of};
use crate::round::Round;

/// What a log adds up to.
#[derive(Debug)]
pub(crate) struct Replay {
    pub(crate) history: History,
    /// Bytes up to the last newline.
    pub(crate) whole: usize,
    /// Lines that are what was written, counted or not.
    pub(crate) lines: u64,
    /// Digest of the last of them.
    pub(crate) last: String,
    /// When the last line that counts was written.
    pub(crate) last_at: Option<SystemTime>,
    /// The first line, from 1, that is not what was written, with what gives it away.
    pub(crate) edited: Option<(usize, String)>,
    /// Whether a seal that fits ends what counts.
    pub(crate) sealed: bool,
    pub(crate) report: Report,
}

/// Replays the log of an annotator. `path` only serves messages.
pub(crate) fn replay(path: &Path, bytes: &[u8], round: &Round, annotator: &Name) -> Replay {
    let whole = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |place| place + 1);
    let Chain { lines, last, edited } = Chain::follow(&bytes[..whole]);

    let mut reader = Reader {
        path,
        round,
        annotator,
        before: RunningDigest::default(),
        history: History::default(),
        last_at: None,
        sealed: false,
        report: Report::default(),
    };
    for (index, line) in lines.iter().enumerate() {
        reader.take(index, line);
        reader.before.add(line);
    }
    let Reader { history, last_at, sealed, mut report, .. } = reader;
    if let Some((line, how)) = &edited {
        report.error(
            "L4D511",
            path,
            format!("line {line}"),
            format!("is not what was written ({how}): nothing from this line on counts"),
            "restore the file from a copy, or move it away and let the annotator vote again",
        );
    }
    if whole < bytes.len() {
        let before = bytes.iter().filter(|&&byte| byte == b'\n').count();
        report.warning(
            "L4D510",
            path,
            format!("line {}", before + 1),
            format!("was not written to its end ({} bytes): the event was never taken", bytes.len() - whole),
            "nothing to do: it is cut off when the annotator goes on",
        );
    }
    Replay { history, whole, lines: lines.len() as u64, last, last_at, edited, sealed, report }
}

/// The lines from the first on that are what was written.
struct Chain<'a> {
    lines: Vec<&'a [u8]>,
    /// Digest of the last of them.
    last: String,
    /// The first line, from 1, that is not, with what gives it away.
    edited: Option<(usize, String)>,
}

impl<'a> Chain<'a> {
    /// Stops at the first line that breaks the chain, so that a file of garbage costs nothing.
    fn follow(bytes: &'a [u8]) -> Self {
        let mut chain = Self { lines: Vec::new(), last: NO_LINE.to_owned(), edited: None };
        for line in bytes.split_inclusive(|&byte| byte == b'\n') {
            let before = chain.lines.len();
            let number = before + 1;
            chain.edited = match serde_json::from_slice::<Link>(line) {
                Err(_) => Some((number, "it is no event".to_owned())),
                Ok(link) if link.prev != chain.last && before == 0 => {
                    Some((number, "it continues another file".to_owned()))
                }
                Ok(link) if link.prev != chain.last => {
                    chain.lines.pop();
                    Some((before, format!("line {number} continues another one")))
                }
                Ok(link) if link.seq != before as u64 => {
                    Some((number, format!("it says that {} precede it", link.seq)))
                }
                Ok(_) => None,
            };
            if chain.edited.is_some() {
                break;
            }
            chain.lines.push(line);
            chain.last = digest_of(line);
        }
        chain
    }
}

struct Reader<'a> {
    path: &'a Path,
    round: &'a Round,
    annotator: &'a Name,
    /// Digest of the lines before the one at hand.
    before: RunningDigest,
    history: History,
    last_at: Option<SystemTime>,
    sealed: bool,
    report: Report,
}

impl Reader<'_> {
    fn take(&mut self, index: usize, bytes: &[u8]) {
        let number = index + 1;
        if self.sealed {
            let message = "follows the seal and does not count".to_owned();
            self.error("L4D517", number, message, "let the annotator vote in a further round");
            return;
        }
        let line = match Line::parse(bytes) {
            Ok(line) => line,
            Err(message) => return self.unreadable(number, bytes, message),
        };
        if line.round != self.round.name || line.annotator != *self.annotator {
            let message = format!("is by {} in round {} and does not count", line.annotator, line.round);
            self.error("L4D513", number, message, "put the log back where it was written");
            return;
        }
        let at = match line.at() {
            Ok(at) => at,
            Err(message) => return self.unreadable(number, bytes, message),
        };
        if self.last_at.is_some_and(|last| at < last) {
            let message = "was written before the line above it, by its clock; it counts".to_owned();
            self.warning("L4D515", number, message, "check the clock of the annotator's machine");
        }
        self.last_at = Some(at);
        match line.act {
            Act::Seal { lines, sha256, .. } => {
                if lines == index as u64 && sha256 == self.before.hex() {
                    self.sealed = true;
                } else {
                    let message = "is a seal that does not fit the lines above it".to_owned();
                    self.error("L4D518", number, message, "restore the file from a copy");
                }
            }
            Act::On { item, digest, event, .. } => {
                if self.round.item(&item).is_none() {
                    let message =
                        format!("is about {item}, which the round does not ask, and does not count");
                    return self.error("L4D514", number, message, "restore the items.jsonl of the round");
                }
                if !self.history.apply(index as u64, &item, &digest, event) {
                    let message = format!("takes back something about {item}, but nothing is left");
                    self.warning("L4D516", number, message, "nothing to do");
                }
            }
        }
    }

    fn unreadable(&mut self, number: usize, bytes: &[u8], message: String) {
        let version = serde_json::from_slice::<Link>(bytes).map_or(VERSION, |link| link.v);
        let (message, hint) = if version == VERSION {
            (message, "ask who wrote this file, and with what")
        } else {
            (format!("is of version {version}, this l4d reads {VERSION}"), "use the l4d that wrote it")
        };
        let message = format!("cannot be read and does not count: {message}");
        self.error("L4D512", number, message, hint);
    }

    fn error(&mut self, code: &'static str, line: usize, message: String, hint: &str) {
        self.report.error(code, self.path, format!("line {line}"), message, hint);
    }

    fn warning(&mut self, code: &'static str, line: usize, message: String, hint: &str) {
        self.report.warning(code, self.path, format!("line {line}"), message, hint);
    }
}

#[cfg(test)]
mod tests;
