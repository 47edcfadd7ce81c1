//! One line of a log: its JSON, and what it means.

use std::time::{Duration, SystemTime};

use l4d_data::digest::sha256_hex;
use l4d_data::{Interval, Name};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::item::ItemId;
use crate::vote::{Answer, Choice, Event, ShownFrames};

/// The version that this crate writes and reads.
pub(crate) const VERSION: u32 = 1;
/// `prev` of the first line.
pub(crate) const NO_LINE: &str = "0000000000000000000000000000000000000000000000000000000000000000";

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
enum Verb {
    Choose,
    Undo,
    Skip,
    Comment,
    Seal,
}

/// The JSON object as it is read; what is optional depends on `event`.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Line {
    v: u32,
    #[serde(rename = "seq")]
    _seq: u64,
    at: String,
    pub(crate) round: Name,
    pub(crate) annotator: Name,
    item: Option<ItemId>,
    order: Option<usize>,
    digest: Option<String>,
    event: Verb,
    choice: Option<Choice>,
    frames: Option<Interval>,
    text: Option<String>,
    lines: Option<u64>,
    sha256: Option<String>,
    seen: Option<ShownFrames>,
    elapsed_ms: Option<u64>,
    #[serde(rename = "client")]
    _client: String,
    #[serde(rename = "prev")]
    _prev: String,
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
        seen: ShownFrames,
        elapsed: Duration,
    },
    /// The end: so many lines precede it, and the file up to it has this digest.
    Seal { lines: u64, sha256: String },
}

/// What links a line to the one before; read even from versions that this crate does not know.
#[derive(Debug, Deserialize)]
pub(crate) struct Link {
    pub(crate) v: u32,
    pub(crate) seq: u64,
    pub(crate) prev: String,
}

/// The line number `seq`, from 0, of a log, with its newline; `prev` is the digest of the one before.
pub(crate) fn write_line(
    (round, annotator): (&Name, &Name),
    seq: u64,
    at: SystemTime,
    prev: &str,
    act: &Act,
) -> Vec<u8> {
    let at = humantime::format_rfc3339_millis(at).to_string();
    let mut line = json!({ "v": VERSION, "seq": seq, "at": at, "round": round, "annotator": annotator });
    let mut add = |fields: Value| {
        if let (Value::Object(line), Value::Object(fields)) = (&mut line, fields) {
            line.extend(fields);
        }
    };
    match act {
        Act::Seal { lines, sha256 } => add(json!({ "event": Verb::Seal, "lines": lines, "sha256": sha256 })),
        Act::On { item, order, digest, event, seen, elapsed } => {
            add(json!({ "item": item, "order": order, "digest": digest }));
            add(match event {
                Event::Choose(Answer { choice, frames }) => {
                    json!({ "event": Verb::Choose, "choice": choice, "frames": frames })
                }
                Event::Undo => json!({ "event": Verb::Undo }),
                Event::Skip => json!({ "event": Verb::Skip }),
                Event::Comment(text) => json!({ "event": Verb::Comment, "text": text }),
            });
            let elapsed_ms = u64::try_from(elapsed.as_millis()).unwrap_or(u64::MAX);
            add(json!({ "seen": seen, "elapsed_ms": elapsed_ms }));
        }
    }
    add(json!({ "client": concat!("l4d ", env!("CARGO_PKG_VERSION")), "prev": prev }));
    format!("{line}\n").into_bytes()
}

impl Line {
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
        if let Some(problem) = event.problem() {
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

/// What the next line calls this one: the digest of its bytes without the newline.
pub(crate) fn digest_of(line: &[u8]) -> String {
    sha256_hex(line.strip_suffix(b"\n").unwrap_or(line))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{interval, name, objects};

    fn at() -> SystemTime {
        SystemTime::UNIX_EPOCH + Duration::from_millis(1_700_000_000_123)
    }

    fn line(act: Act) -> String {
        String::from_utf8(write_line((&name("r1"), &name("ada")), 3, at(), NO_LINE, &act)).unwrap()
    }

    fn on(event: Event) -> Act {
        Act::On {
            item: "q0007".parse().unwrap(),
            order: 2,
            digest: "d".to_owned(),
            event,
            seen: ShownFrames { views: [name("cam00")].into(), frames: [0, 12].into() },
            elapsed: Duration::from_millis(8300),
        }
    }

    #[test]
    fn a_line_has_the_documented_form() {
        let answer = Answer { choice: objects(&["b", "a"]), frames: Interval::WHOLE };
        let text = line(on(Event::Choose(answer)));
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
        let answer = |choice| Event::Choose(Answer { choice, frames: interval(3, 40) });
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
            let read = Line::parse(line(act.clone()).as_bytes()).unwrap();
            assert_eq!(read.at().unwrap(), at());
            assert_eq!(read.act().unwrap(), act);
        }
    }

    #[test]
    fn lines_that_contradict_themselves_are_refused() {
        let answer = Answer { choice: objects(&["a"]), frames: Interval::WHOLE };
        let good = line(on(Event::Choose(answer)));
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
}
