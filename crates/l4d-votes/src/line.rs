//! One line of a log: its JSON, and what it means.

use std::time::{Duration, SystemTime};

use l4d_data::digest::sha256_hex;
use l4d_data::{Interval, Name};
use serde::{Deserialize, Serialize};

use crate::event::{Answer, Choice, Event, Seen};
use crate::item::ItemId;

/// The version that this crate writes and reads.
pub(crate) const VERSION: u32 = 1;
/// `prev` of the first line.
pub(crate) const NO_LINE: &str = "0000000000000000000000000000000000000000000000000000000000000000";
/// No clip is longer; keeps arithmetic on frames far from its limits.
pub(crate) const MAX_FRAME: u32 = 999_999;
/// Longest reason or comment, bytes.
pub(crate) const MAX_REMARK: usize = 2000;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Verb {
    Choose,
    Undo,
    Skip,
    Comment,
    Seal,
}

/// The JSON object; what is optional depends on `event`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Line {
    v: u32,
    seq: u64,
    at: String,
    pub(crate) round: Name,
    pub(crate) annotator: Name,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    item: Option<ItemId>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    order: Option<usize>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    digest: Option<String>,
    event: Verb,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    choice: Option<Choice>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    frames: Option<Interval>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    text: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    lines: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sha256: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    seen: Option<Seen>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    elapsed_ms: Option<u64>,
    client: String,
    prev: String,
}

/// Where in which log a line stands.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Place {
    pub(crate) round: Name,
    pub(crate) annotator: Name,
    pub(crate) seq: u64,
    pub(crate) at: SystemTime,
    pub(crate) prev: String,
}

/// What a line says.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Act {
    /// Something about an item.
    On {
        item: ItemId,
        /// Position in the annotator's order, from 1.
        order: usize,
        digest: String,
        event: Event,
        seen: Seen,
        elapsed: Duration,
    },
    /// The end: as many lines stand before it, and the file up to it has this digest.
    Seal { lines: u64, sha256: String },
}

/// What links a line to the one before; read even from versions that this crate does not know.
#[derive(Debug, Deserialize)]
pub(crate) struct Link {
    pub(crate) v: u32,
    pub(crate) seq: u64,
    pub(crate) prev: String,
}

impl Line {
    pub(crate) fn new(place: Place, act: Act) -> Self {
        let Place { round, annotator, seq, at, prev } = place;
        let mut line = Self {
            v: VERSION,
            seq,
            at: humantime::format_rfc3339_millis(at).to_string(),
            round,
            annotator,
            item: None,
            order: None,
            digest: None,
            event: Verb::Seal,
            choice: None,
            frames: None,
            text: None,
            lines: None,
            sha256: None,
            seen: None,
            elapsed_ms: None,
            client: concat!("l4d ", env!("CARGO_PKG_VERSION")).to_owned(),
            prev,
        };
        match act {
            Act::Seal { lines, sha256 } => {
                line.lines = Some(lines);
                line.sha256 = Some(sha256);
            }
            Act::On { item, order, digest, event, seen, elapsed } => {
                line.item = Some(item);
                line.order = Some(order);
                line.digest = Some(digest);
                line.seen = Some(seen);
                line.elapsed_ms = Some(u64::try_from(elapsed.as_millis()).unwrap_or(u64::MAX));
                line.take(event);
            }
        }
        line
    }

    fn take(&mut self, event: Event) {
        match event {
            Event::Choose(Answer { choice, frames }) => {
                self.event = Verb::Choose;
                self.choice = Some(choice);
                self.frames = Some(frames);
            }
            Event::Undo => self.event = Verb::Undo,
            Event::Skip => self.event = Verb::Skip,
            Event::Comment(text) => {
                self.event = Verb::Comment;
                self.text = Some(text);
            }
        }
    }

    /// The line with its newline.
    pub(crate) fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = serde_json::to_vec(self).expect("a line of strings and numbers serialises");
        bytes.push(b'\n');
        bytes
    }

    pub(crate) fn parse(bytes: &[u8]) -> Result<Self, String> {
        let line: Self = serde_json::from_slice(bytes).map_err(|error| error.to_string())?;
        if line.v == VERSION { Ok(line) } else { Err(format!("version {}", line.v)) }
    }

    pub(crate) fn at(&self) -> Result<SystemTime, String> {
        humantime::parse_rfc3339(&self.at).map_err(|error| format!("field `at`: {error}"))
    }

    /// What the line says; complains of fields that its event lacks or has no use for.
    pub(crate) fn act(self) -> Result<Act, String> {
        let Self {
            item, order, digest, event, choice, frames, text, lines, sha256, seen, elapsed_ms, ..
        } = self;
        let event = match (event, choice, frames, text) {
            (Verb::Seal, None, None, None) => {
                return match (lines, sha256) {
                    (Some(lines), Some(sha256)) if item.is_none() => Ok(Act::Seal { lines, sha256 }),
                    _ => Err("a seal has `lines`, `sha256` and no item".to_owned()),
                };
            }
            (Verb::Choose, Some(choice), Some(frames), None) => Event::Choose(Answer { choice, frames }),
            (Verb::Comment, None, None, Some(text)) => Event::Comment(text),
            (Verb::Undo, None, None, None) => Event::Undo,
            (Verb::Skip, None, None, None) => Event::Skip,
            _ => return Err("the fields do not fit the event".to_owned()),
        };
        if let Some(problem) = event_problem(&event) {
            return Err(problem.to_owned());
        }
        match (item, order, digest) {
            (Some(item), Some(order), Some(digest)) if lines.is_none() && sha256.is_none() => Ok(Act::On {
                item,
                order,
                digest,
                event,
                seen: seen.unwrap_or_default(),
                elapsed: Duration::from_millis(elapsed_ms.unwrap_or_default()),
            }),
            _ => Err("an event has `item`, `order` and `digest`".to_owned()),
        }
    }
}

/// What no log may hold, whoever writes it.
pub(crate) fn event_problem(event: &Event) -> Option<&'static str> {
    let is_remark = |text: &str| {
        !text.trim().is_empty() && text.len() <= MAX_REMARK && !text.chars().any(char::is_control)
    };
    match event {
        Event::Choose(answer) if answer.frames.last() > MAX_FRAME => Some("the frames lie beyond any clip"),
        Event::Choose(Answer { choice: Choice::Objects(objects), .. }) if objects.is_empty() => {
            Some("no object is chosen: choose one, or none")
        }
        Event::Choose(Answer { choice: Choice::Ambiguous { reason }, .. }) if !is_remark(reason) => {
            Some("a reason is one line of at most 2000 bytes")
        }
        Event::Comment(text) if !is_remark(text) => Some("a comment is one line of at most 2000 bytes"),
        _ => None,
    }
}

/// What the next line calls this one: the digest of its bytes without the newline.
pub(crate) fn digest_of(line: &[u8]) -> String {
    sha256_hex(line.strip_suffix(b"\n").unwrap_or(line))
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    fn place() -> Place {
        Place {
            round: Name::new("r1").unwrap(),
            annotator: Name::new("ada").unwrap(),
            seq: 3,
            at: SystemTime::UNIX_EPOCH + Duration::from_millis(1_700_000_000_123),
            prev: NO_LINE.to_owned(),
        }
    }

    fn on(event: Event) -> Act {
        Act::On {
            item: "q0007".parse().unwrap(),
            order: 2,
            digest: "d".to_owned(),
            event,
            seen: Seen {
                views: BTreeSet::from([Name::new("cam00").unwrap()]),
                frames: BTreeSet::from([0, 12]),
            },
            elapsed: Duration::from_millis(8300),
        }
    }

    fn objects(names: &[&str]) -> Choice {
        Choice::Objects(names.iter().map(|name| Name::new(*name).unwrap()).collect())
    }

    #[test]
    fn a_line_has_the_documented_form() {
        let answer = Answer { choice: objects(&["b", "a"]), frames: Interval::WHOLE };
        let line = Line::new(place(), on(Event::Choose(answer)));
        let text = String::from_utf8(line.to_bytes()).unwrap();
        let client = env!("CARGO_PKG_VERSION");
        assert_eq!(
            text,
            format!(
                r#"{{"v":1,"seq":3,"at":"2023-11-14T22:13:20.123Z","round":"r1","annotator":"ada","item":"q0007","order":2,"digest":"d","event":"choose","choice":{{"objects":["a","b"]}},"frames":[0,96],"seen":{{"views":["cam00"],"frames":[0,12]}},"elapsed_ms":8300,"client":"l4d {client}","prev":"{NO_LINE}"}}
"#
            )
        );
    }

    #[test]
    fn every_act_comes_back() {
        let answer = |choice| Event::Choose(Answer { choice, frames: Interval::new(3, 40).unwrap() });
        let acts = [
            on(answer(objects(&["a"]))),
            on(answer(Choice::None)),
            on(answer(Choice::Ambiguous { reason: "two \"cats\" \\ sit \u{1F408}".to_owned() })),
            on(Event::Undo),
            on(Event::Skip),
            on(Event::Comment("too dark".to_owned())),
            Act::Seal { lines: 3, sha256: "s".to_owned() },
        ];
        for act in acts {
            let line = Line::new(place(), act.clone());
            let read = Line::parse(line.to_bytes().trim_ascii_end()).unwrap();
            assert_eq!(read, line);
            assert_eq!(read.at().unwrap(), place().at);
            assert_eq!(read.act().unwrap(), act);
        }
    }

    #[test]
    fn lines_that_contradict_themselves_are_refused() {
        let good = String::from_utf8(
            Line::new(
                place(),
                on(Event::Choose(Answer { choice: objects(&["a"]), frames: Interval::WHOLE })),
            )
            .to_bytes(),
        )
        .unwrap();
        for (from, to) in [
            (r#""event":"choose""#, r#""event":"skip""#),
            (r#""event":"choose""#, r#""event":"seal""#),
            (r#""event":"choose""#, r#""event":"bribe""#),
            (r#"["a"]"#, "[]"),
            (r#"["a"]"#, r#"["../a"]"#),
            ("[0,96]", "[96,0]"),
            ("[0,96]", "[0,4294967295]"),
            ("[0,96]", "[0,1e300]"),
            (r#""item":"q0007","#, ""),
            (r#""item":"q0007""#, r#""item":"../7""#),
            (r#""v":1"#, r#""v":1,"extra":0"#),
            (r#""v":1"#, r#""v":2"#),
            (r#"{"objects":["a"]}"#, r#"{"ambiguous":{"reason":" "}}"#),
            (r#"{"objects":["a"]}"#, "\"nothing\""),
        ] {
            let bad = good.replace(from, to);
            assert_ne!(bad, good);
            let said = Line::parse(bad.as_bytes()).and_then(Line::act);
            assert!(said.is_err(), "{bad} was taken: {said:?}");
        }
    }

    #[test]
    fn remarks_are_one_bounded_line() {
        for text in ["", "  ", "a\nb", "\u{1b}[2J", &"x".repeat(2001)] {
            assert!(event_problem(&Event::Comment(text.to_owned())).is_some(), "{text:?}");
        }
        assert!(event_problem(&Event::Comment("x".repeat(2000))).is_none());
    }
}
