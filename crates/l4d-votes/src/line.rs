//! One line of a log: its JSON, and what it means.

use std::time::SystemTime;

use l4d_data::Name;
use l4d_data::digest::sha256_hex;
use serde::{Deserialize, Serialize};

use crate::item::ItemId;
use crate::vote::{Event, ShownFrames};

/// The version that this crate writes and reads.
pub(crate) const VERSION: u32 = 1;
/// `prev` of the first line.
pub(crate) const NO_LINE: &str = "0000000000000000000000000000000000000000000000000000000000000000";

/// A line; its fields are written in this order.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Line {
    v: u32,
    /// Number of the line, from 0.
    seq: u64,
    at: String,
    pub(crate) round: Name,
    pub(crate) annotator: Name,
    #[serde(flatten)]
    pub(crate) act: Act,
    client: String,
    /// Digest of the line before.
    prev: String,
}

/// What a line says.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(untagged)]
pub(crate) enum Act {
    /// Something about an item.
    On {
        item: ItemId,
        /// Position in the annotator's order, from 1.
        order: usize,
        digest: String,
        #[serde(flatten)]
        event: Event,
        seen: ShownFrames,
        elapsed_ms: u64,
    },
    /// The end: so many lines precede it, and the file up to it has this digest.
    Seal { event: SealEvent, lines: u64, sha256: String },
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum SealEvent {
    Seal,
}

/// What links a line to the one before; read even from versions that this crate does not know.
#[derive(Debug, Deserialize)]
pub(crate) struct Link {
    pub(crate) v: u32,
    pub(crate) seq: u64,
    pub(crate) prev: String,
}

/// When an act happened, and in which program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    pub at: SystemTime,
    /// For example `l4d 0.1.0`.
    pub client: String,
}

impl Source {
    /// This moment and this program.
    pub fn now() -> Self {
        Self { at: SystemTime::now(), client: concat!("l4d ", env!("CARGO_PKG_VERSION")).to_owned() }
    }
}

/// The line number `seq` of a log, with its newline; `prev` is the digest of the one before.
pub(crate) fn write_line(
    (round, annotator): (&Name, &Name),
    seq: u64,
    source: &Source,
    prev: &str,
    act: Act,
) -> Vec<u8> {
    Line {
        v: VERSION,
        seq,
        at: humantime::format_rfc3339_millis(source.at).to_string(),
        round: round.clone(),
        annotator: annotator.clone(),
        act,
        client: source.client.clone(),
        prev: prev.to_owned(),
    }
    .bytes()
}

impl Line {
    /// Reads a line with its newline. It has to be what would be written: no field more, less or elsewhere.
    pub(crate) fn parse(bytes: &[u8]) -> Result<Self, String> {
        let line: Self = serde_json::from_slice(bytes).map_err(|error| error.to_string())?;
        if line.v != VERSION {
            return Err(format!("version {}", line.v));
        }
        if line.bytes() != bytes {
            return Err("the fields do not fit the event".to_owned());
        }
        let problem = match &line.act {
            Act::On { event, .. } => event.problem(),
            Act::Seal { .. } => None,
        };
        problem.map_or(Ok(line), |problem| Err(problem.to_owned()))
    }

    pub(crate) fn at(&self) -> Result<SystemTime, String> {
        humantime::parse_rfc3339(&self.at).map_err(|error| format!("field `at`: {error}"))
    }

    fn bytes(&self) -> Vec<u8> {
        let mut bytes = serde_json::to_vec(self).unwrap_or_default();
        bytes.push(b'\n');
        bytes
    }
}

/// What the next line calls this one: the digest of its bytes without the newline.
pub(crate) fn digest_of(line: &[u8]) -> String {
    sha256_hex(line.strip_suffix(b"\n").unwrap_or(line))
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use l4d_data::Interval;

    use super::*;
    use crate::fixture::{interval, name, objects};
    use crate::vote::{Answer, Choice};

    fn at() -> SystemTime {
        SystemTime::UNIX_EPOCH + Duration::from_millis(1_700_000_000_123)
    }

    fn source() -> Source {
        Source { at: at(), ..Source::now() }
    }

    fn line(act: Act) -> String {
        String::from_utf8(write_line((&name("r1"), &name("ada")), 3, &source(), NO_LINE, act)).unwrap()
    }

    fn on(event: Event) -> Act {
        Act::On {
            item: "q0007".parse().unwrap(),
            order: 2,
            digest: "d".to_owned(),
            event,
            seen: ShownFrames { views: [name("cam00")].into(), frames: [0, 12].into() },
            elapsed_ms: 8300,
        }
    }

    fn choose(choice: Choice, frames: Interval) -> Act {
        on(Event::Choose(Answer { choice, frames }))
    }

    #[test]
    fn lines_have_the_documented_form_and_come_back() {
        let reason = "two \"cats\" \\ sit \u{1F408}".to_owned();
        let acts = [
            choose(objects(&["b", "a"]), Interval::WHOLE),
            choose(Choice::None, interval(3, 40)),
            choose(Choice::Ambiguous { reason }, Interval::WHOLE),
            on(Event::Undo),
            on(Event::Skip),
            on(Event::Comment { text: "too dark".to_owned() }),
            Act::Seal { event: SealEvent::Seal, lines: 3, sha256: "s".to_owned() },
        ];
        for act in &acts {
            let read = Line::parse(line(act.clone()).as_bytes()).unwrap();
            assert_eq!((read.at().unwrap(), &read.act), (at(), act));
        }
        let lines =
            acts.map(line).concat().replace(env!("CARGO_PKG_VERSION"), "1.2.3").replace(NO_LINE, "00");
        insta::assert_snapshot!(lines, @r#"
        {"v":1,"seq":3,"at":"2023-11-14T22:13:20.123Z","round":"r1","annotator":"ada","item":"q0007","order":2,"digest":"d","event":"choose","choice":{"objects":["a","b"]},"frames":[0,96],"seen":{"views":["cam00"],"frames":[0,12]},"elapsed_ms":8300,"client":"l4d 1.2.3","prev":"00"}
        {"v":1,"seq":3,"at":"2023-11-14T22:13:20.123Z","round":"r1","annotator":"ada","item":"q0007","order":2,"digest":"d","event":"choose","choice":"none","frames":[3,40],"seen":{"views":["cam00"],"frames":[0,12]},"elapsed_ms":8300,"client":"l4d 1.2.3","prev":"00"}
        {"v":1,"seq":3,"at":"2023-11-14T22:13:20.123Z","round":"r1","annotator":"ada","item":"q0007","order":2,"digest":"d","event":"choose","choice":{"ambiguous":{"reason":"two \"cats\" \\ sit 🐈"}},"frames":[0,96],"seen":{"views":["cam00"],"frames":[0,12]},"elapsed_ms":8300,"client":"l4d 1.2.3","prev":"00"}
        {"v":1,"seq":3,"at":"2023-11-14T22:13:20.123Z","round":"r1","annotator":"ada","item":"q0007","order":2,"digest":"d","event":"undo","seen":{"views":["cam00"],"frames":[0,12]},"elapsed_ms":8300,"client":"l4d 1.2.3","prev":"00"}
        {"v":1,"seq":3,"at":"2023-11-14T22:13:20.123Z","round":"r1","annotator":"ada","item":"q0007","order":2,"digest":"d","event":"skip","seen":{"views":["cam00"],"frames":[0,12]},"elapsed_ms":8300,"client":"l4d 1.2.3","prev":"00"}
        {"v":1,"seq":3,"at":"2023-11-14T22:13:20.123Z","round":"r1","annotator":"ada","item":"q0007","order":2,"digest":"d","event":"comment","text":"too dark","seen":{"views":["cam00"],"frames":[0,12]},"elapsed_ms":8300,"client":"l4d 1.2.3","prev":"00"}
        {"v":1,"seq":3,"at":"2023-11-14T22:13:20.123Z","round":"r1","annotator":"ada","event":"seal","lines":3,"sha256":"s","client":"l4d 1.2.3","prev":"00"}
        "#);
    }

    #[test]
    fn lines_that_contradict_themselves_are_refused() {
        let good = line(choose(objects(&["a"]), Interval::WHOLE));
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
            let said = Line::parse(bad.as_bytes());
            assert!(said.is_err(), "{bad} was taken: {said:?}");
        }
    }
}
