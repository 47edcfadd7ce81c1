//! A ballot that the page saved, into the log of its round.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use l4d_data::digest::sha256_hex;
use l4d_data::store::{read_bounded, write_atomic};
use l4d_data::{DataError, Interval, Name, json};
use l4d_votes::{Answer, Ballot, Choice, Event, ItemId, Round, RoundDir, ShownFrames, Source};
use serde::Deserialize;

use super::{digest_of, pack_digest};
use crate::scene::{SceneInfo, Scenes};

const SCHEMA: &str = "l4d/offline-ballot/1";
/// No ballot is larger.
const MAX_BYTES: u64 = 64 << 20;
/// A clock may be ahead of ours by so much.
const CLOCK_SLACK: Duration = Duration::from_secs(24 * 3600);

/// What came of a ballot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Imported {
    /// Acts of the ballot, without its seal.
    pub acts: usize,
    /// Whether the log held all of it already.
    pub was_there: bool,
}

/// The first line.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Head {
    schema: String,
    round: Name,
    annotator: Name,
    round_sha256: String,
    pack: String,
    program: String,
}

/// Any other line.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    at: String,
    item: Option<ItemId>,
    event: Kind,
    choice: Option<Numbers>,
    text: Option<String>,
    frames: Option<Interval>,
    seen: Option<ShownFrames>,
    elapsed_ms: Option<u64>,
    /// Of a seal: how many acts precede it.
    acts: Option<usize>,
    prev: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Choose,
    Undo,
    Skip,
    Comment,
    Seal,
}

/// A choice by the numbers that the annotator saw.
#[derive(Debug, Deserialize)]
#[serde(rename_all = "lowercase", deny_unknown_fields)]
enum Numbers {
    Objects(BTreeSet<usize>),
    None,
    Ambiguous { reason: String },
}

/// A sealed ballot as the page saved it, whole.
#[derive(Debug)]
pub struct SavedBallot {
    path: PathBuf,
    head: Head,
    /// The acts, and last the seal.
    lines: Vec<Line>,
}

impl SavedBallot {
    /// Reads a ballot, of which each line names the digest of the one before.
    ///
    /// # Errors
    /// The file cannot be read, is no ballot, was edited, or is not sealed.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        let (head, lines) = read(path)?;
        Ok(Self { path: path.to_owned(), head, lines })
    }

    /// The round that it belongs to.
    pub fn round(&self) -> &Name {
        &self.head.round
    }

    /// Who voted.
    pub fn annotator(&self) -> &Name {
        &self.head.annotator
    }

    /// Writes the log, as the terminal would have written it: all of it, or nothing. A log that holds the beginning of the
    /// same acts is completed.
    ///
    /// # Errors
    /// A ballot of another round, an act that the round refuses, a log with other votes, and what cannot be written.
    pub fn import(&self, round: &Round, scenes: &Scenes) -> Result<Imported, DataError> {
        let Self { path, head, lines } = self;
        require_round(path, head, round)?;
        let folder = scratch_folder(round, &head.annotator)?;
        let log = replayed(path, head, lines, round, scenes, &folder);
        fs::remove_dir_all(folder.root()).ok();
        let log = log?;
        let acts = lines.len() - 1;

        // Holds the lock of the log meanwhile, so that no terminal votes beside.
        let (ballot, _) = Ballot::open(round.dir(), round, &head.annotator)?;
        let there = read_bounded(ballot.path(), MAX_BYTES)?;
        if there == log {
            return Ok(Imported { acts, was_there: true });
        }
        if !log.starts_with(&there) {
            return Err(DataError::invalid(
                ballot.path(),
                "file",
                format!("{} has other votes in this round already", head.annotator),
                "decide with the annotator which of the two counts, and move the log away if it is the new one",
            ));
        }
        write_atomic(ballot.path(), &log)?;
        Ok(Imported { acts, was_there: false })
    }
}

fn parse_head(path: &Path, line: &[u8]) -> Result<Head, DataError> {
    let head: Head = json::parse(path, Some(1), line)?;
    if head.schema == SCHEMA {
        return Ok(head);
    }
    let message = format!("is `{}`, but this l4d reads `{SCHEMA}`", head.schema.escape_debug());
    Err(DataError::invalid(path, "field `schema`", message, "import it with the l4d that made the page"))
}

/// The lines of a sealed ballot, each of which names the digest of the one before; the last one is the seal.
fn read(path: &Path) -> Result<(Head, Vec<Line>), DataError> {
    let bytes = read_bounded(path, MAX_BYTES)?;
    let text = bytes.strip_suffix(b"\n").unwrap_or(&bytes);
    let mut texts = text.split(|&byte| byte == b'\n');
    let first = texts.next().unwrap_or(&[]);
    let head = parse_head(path, first)?;
    let mut before = first;
    let mut lines: Vec<Line> = Vec::new();
    for (index, text) in texts.enumerate() {
        let number = index + 2;
        let refuse = |message: &str, hint: &str| {
            Err(DataError::invalid(path, format!("line {number}"), message.to_owned(), hint.to_owned()))
        };
        let line: Line = json::parse(path, Some(number), text)?;
        if line.prev != sha256_hex(before) {
            return refuse(
                "does not follow the line before it: the file was edited, or lost a line",
                "ask the annotator to save the ballot again",
            );
        }
        if lines.last().is_some_and(|last| last.event == Kind::Seal) {
            return refuse("follows the seal", "ask the annotator to save the ballot again");
        }
        if line.event == Kind::Seal && line.acts != Some(lines.len()) {
            return refuse("counts other acts than precede it", "ask the annotator to save the ballot again");
        }
        before = text;
        lines.push(line);
    }
    match lines.last() {
        Some(last) if last.event == Kind::Seal => Ok((head, lines)),
        _ => Err(DataError::invalid(
            path,
            "seal",
            "the ballot is not sealed".to_owned(),
            "open the page, choose \"Go on from a copy\" with this file, answer or skip what is left, and seal it",
        )),
    }
}

fn require_round(path: &Path, head: &Head, round: &Round) -> Result<(), DataError> {
    let round_sha256 = digest_of(round)?;
    let is_ours =
        head.round_sha256 == round_sha256 && head.pack == pack_digest(&round_sha256, &head.annotator);
    if is_ours && head.round == round.name {
        return round.require_annotator(&head.annotator);
    }
    Err(DataError::invalid(
        path,
        "field `round_sha256`",
        format!("is of another round than {}: its settings or items differ", round.dir().root().display()),
        "name the folder of the round that the page was made of with --rounds",
    ))
}

/// A folder of its own, in which the log is written before it replaces the one of the round.
fn scratch_folder(round: &Round, annotator: &Name) -> Result<RoundDir, DataError> {
    let name = format!("l4d-ballot-{}-{annotator}-{}", round.name, std::process::id());
    let folder = std::env::temp_dir().join(name);
    fs::remove_dir_all(&folder).ok();
    l4d_data::store::make_folder(&folder)?;
    Ok(RoundDir::new(folder))
}

/// The bytes of the log after all acts.
fn replayed(
    path: &Path,
    head: &Head,
    lines: &[Line],
    round: &Round,
    scenes: &Scenes,
    folder: &RoundDir,
) -> Result<Vec<u8>, DataError> {
    let (mut ballot, _) = Ballot::open(folder, round, &head.annotator)?;
    for (index, line) in lines.iter().enumerate() {
        let at_line = |message: String, hint: &str| {
            DataError::invalid(path, format!("line {}", index + 2), message, hint.to_owned())
        };
        let at = humantime::parse_rfc3339(&line.at)
            .map_err(|error| at_line(format!("field `at`: {error}"), "save the ballot again"))?;
        if at > SystemTime::now() + CLOCK_SLACK {
            return Err(at_line(
                "is more than a day ahead of this machine's clock".to_owned(),
                "set the clock",
            ));
        }
        let source = Source { at, client: format!("{}, browser", head.program) };
        let written = match &line.item {
            Some(item) => act(line, item, round, scenes)
                .map_err(|message| at_line(message, "save the ballot again"))
                .and_then(|event| {
                    let seen = line.seen.clone().unwrap_or_default();
                    let elapsed = Duration::from_millis(line.elapsed_ms.unwrap_or(0));
                    ballot.record_from(&source, item, event, seen, elapsed)
                }),
            None if line.event == Kind::Seal => ballot.seal_from(&source),
            None => Err(at_line("names no item".to_owned(), "save the ballot again")),
        };
        written.map_err(|error: DataError| at_line(error.place_and_message().1, error.hint()))?;
    }
    read_bounded(ballot.path(), MAX_BYTES)
}

/// The event of a line, with names in place of numbers.
fn act(line: &Line, item: &ItemId, round: &Round, scenes: &Scenes) -> Result<Event, String> {
    match (line.event, &line.choice, line.frames, &line.text) {
        (Kind::Choose, Some(choice), Some(frames), None) => {
            let asked = round.item(item).ok_or_else(|| format!("the round does not ask {item}"))?;
            let card = scenes.get(&asked.scene).ok_or_else(|| format!("{} is not here", asked.scene))?;
            Ok(Event::Choose(Answer { choice: named(choice, card)?, frames }))
        }
        (Kind::Undo, None, None, None) => Ok(Event::Undo),
        (Kind::Skip, None, None, None) => Ok(Event::Skip),
        (Kind::Comment, None, None, Some(text)) => Ok(Event::Comment { text: text.clone() }),
        _ => Err("the fields do not fit the event".to_owned()),
    }
}

fn named(choice: &Numbers, card: &SceneInfo) -> Result<Choice, String> {
    let name = |&number: &usize| {
        let object = card.object(number).ok_or_else(|| format!("no object has the number {number}"))?;
        Ok(object.name.clone())
    };
    Ok(match choice {
        Numbers::Objects(numbers) => {
            Choice::Objects(numbers.iter().map(name).collect::<Result<_, String>>()?)
        }
        Numbers::None => Choice::None,
        Numbers::Ambiguous { reason } => Choice::Ambiguous { reason: reason.clone() },
    })
}
