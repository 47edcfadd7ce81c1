//! The lines that go back and forth (docs/workers.md).

use std::collections::BTreeMap;

use l4d_frames::{Mask, rle};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::frames::Frames;

/// Version of the protocol that this crate speaks.
pub const PROTOCOL: u32 = 1;

/// What a worker says of itself when it is ready.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Hello {
    /// Version of the protocol.
    pub protocol: u32,
    /// Its name.
    pub name: String,
    /// Its version.
    pub version: String,
    /// Kinds of prompts that it takes: `box`, `point`, `text`.
    #[serde(default)]
    pub prompts: Vec<String>,
    /// What kind of text it understands; none if it takes no text.
    #[serde(default)]
    pub text: Option<TextKind>,
    /// Longest text, in tokens of its own.
    #[serde(default)]
    pub text_max_tokens: Option<u32>,
    /// Where it computes: `cpu`, `cuda`, ...
    #[serde(default)]
    pub device: Option<String>,
    /// What its model is.
    #[serde(default)]
    pub weights: Option<Weights>,
    /// Libraries and their versions.
    #[serde(default)]
    pub deps: BTreeMap<String, String>,
    /// Whatever else its answers depend on.
    #[serde(default)]
    pub settings: BTreeMap<String, Value>,
}

/// What kind of text a segmenter understands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TextKind {
    /// The name of a kind of thing; it finds all of them.
    Phrase,
    /// A sentence that tells one thing from others.
    Sentence,
}

/// What a model is, wherever it stands.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Weights {
    /// Name of its folder or file.
    pub id: String,
    /// Digest of its files.
    pub sha256: String,
}

/// What to look for. Frames are indices into the list of files.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Prompt {
    /// Number of the object, from 1. Text may find several: the worker numbers those itself.
    pub obj: u32,
    /// Where or what it is.
    #[serde(flatten)]
    pub what: What,
}

/// A prompt's content.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(untagged)]
pub enum What {
    /// A box in a frame.
    Box {
        /// Index of the frame.
        frame: u32,
        /// Left, upper, right, lower edge, pixels.
        box_px: [f64; 4],
    },
    /// A place on the object in a frame.
    Point {
        /// Index of the frame.
        frame: u32,
        /// Column and row, pixels.
        point_px: [f64; 2],
    },
    /// Words.
    Text {
        /// The words.
        text: String,
    },
}

/// A request for masks.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Segment<'a> {
    pub(super) id: u64,
    pub(super) frames: &'a Frames,
    pub(super) prompts: &'a [Prompt],
    /// First and last frame that masks are wanted of.
    pub(super) range: [u32; 2],
    /// Least score of an object that is wanted.
    pub(super) threshold: f64,
}

/// What is written to a worker.
#[derive(Debug, Serialize)]
#[serde(tag = "op", rename_all = "snake_case")]
pub(super) enum Order<'a> {
    Segment(&'a Segment<'a>),
    Cancel { id: u64 },
    Shutdown,
}

/// What a worker writes, one a line.
#[derive(Debug)]
pub(super) enum Said {
    Hello(Box<Hello>),
    /// It is at work.
    Alive,
    Mask(MaskLine),
    Done {
        id: u64,
        skipped: Vec<String>,
    },
    Failed {
        id: u64,
        kind: String,
        message: String,
    },
}

#[derive(Debug)]
pub(super) struct MaskLine {
    pub(super) id: u64,
    pub(super) frame: u32,
    pub(super) object: u32,
    pub(super) rle: Rle,
    pub(super) score: Option<f64>,
}

/// A mask as COCO's compressed run lengths.
#[derive(Debug, Deserialize)]
pub(super) struct Rle {
    /// Rows and columns.
    pub(super) size: [u32; 2],
    pub(super) counts: String,
}

impl Rle {
    /// The mask, if it has the size of the frames.
    pub(super) fn decode(&self, width: u32, height: u32) -> Result<Mask, String> {
        let [rows, columns] = self.size;
        if (columns, rows) != (width, height) {
            return Err(format!("a mask has {columns}x{rows} pixels, the frames have {width}x{height}"));
        }
        rle::decode(&self.counts, width, height).map_err(|error| format!("a mask cannot be read: {error}"))
    }
}

#[derive(Deserialize)]
struct Line {
    hello: Option<Box<Hello>>,
    alive: Option<bool>,
    id: Option<u64>,
    frame: Option<u32>,
    obj: Option<u32>,
    rle: Option<Rle>,
    score: Option<f64>,
    done: Option<bool>,
    #[serde(default)]
    skipped: Vec<String>,
    error: Option<Failure>,
}

#[derive(Deserialize)]
struct Failure {
    kind: String,
    msg: String,
}

/// Reads a line; the error says what is wrong with it.
pub(super) fn read_line(bytes: &[u8]) -> Result<Said, String> {
    let line: Line = serde_json::from_slice(bytes).map_err(|error| error.to_string())?;
    if let Some(hello) = line.hello {
        return Ok(Said::Hello(hello));
    }
    let Some(id) = line.id else {
        return if line.alive == Some(true) {
            Ok(Said::Alive)
        } else {
            Err("a line without an id".to_owned())
        };
    };
    match (line.error, line.done, line.frame, line.obj, line.rle) {
        (Some(Failure { kind, msg }), ..) => Ok(Said::Failed { id, kind, message: msg }),
        (None, Some(true), ..) => Ok(Said::Done { id, skipped: line.skipped }),
        (None, _, Some(frame), Some(object), Some(rle)) => {
            Ok(Said::Mask(MaskLine { id, frame, object, rle, score: line.score }))
        }
        _ => Err("a line that is neither mask nor end nor error".to_owned()),
    }
}

/// A line for a worker.
pub(super) fn write_line(order: &Order<'_>) -> Result<String, serde_json::Error> {
    let mut line = serde_json::to_string(order)?;
    line.push('\n');
    Ok(line)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn orders_are_spelled_as_documented() {
        let frames = Frames { dir: "/clip".into(), files: vec!["a.png".into()], width: 4, height: 3 };
        let prompts = [
            Prompt { obj: 1, what: What::Box { frame: 0, box_px: [1.0, 0.5, 2.0, 3.0] } },
            Prompt { obj: 2, what: What::Point { frame: 0, point_px: [1.0, 2.0] } },
            Prompt { obj: 3, what: What::Text { text: "a \"cup\"\n".into() } },
        ];
        let segment = Segment { id: 7, frames: &frames, prompts: &prompts, range: [0, 0], threshold: 0.5 };
        let line = write_line(&Order::Segment(&segment)).unwrap();
        assert_eq!(
            line,
            concat!(
                r#"{"op":"segment","id":7,"frames":{"dir":"/clip","files":["a.png"],"width":4,"height":3},"#,
                r#""prompts":[{"obj":1,"frame":0,"box_px":[1.0,0.5,2.0,3.0]},{"obj":2,"frame":0,"point_px":[1.0,2.0]},"#,
                r#"{"obj":3,"text":"a \"cup\"\n"}],"range":[0,0],"threshold":0.5}"#,
                "\n"
            )
        );
        assert_eq!(write_line(&Order::Cancel { id: 7 }).unwrap(), "{\"op\":\"cancel\",\"id\":7}\n");
        assert_eq!(write_line(&Order::Shutdown).unwrap(), "{\"op\":\"shutdown\"}\n");
    }

    #[test]
    fn lines_are_told_apart_and_others_are_refused() {
        let mask = br#"{"id":7,"frame":1,"obj":2,"rle":{"size":[2,3],"counts":"132"},"score":0.5}"#;
        let Ok(Said::Mask(line)) = read_line(mask) else { panic!("no mask") };
        assert_eq!((line.id, line.frame, line.object, line.score), (7, 1, 2, Some(0.5)));
        assert_eq!(line.rle.decode(3, 2).unwrap().area(), 3);
        assert!(line.rle.decode(2, 3).unwrap_err().contains("3x2"));
        assert!(matches!(read_line(br#"{"alive":true}"#), Ok(Said::Alive)));
        assert!(matches!(read_line(br#"{"id":7,"done":true,"more":1}"#), Ok(Said::Done { id: 7, .. })));
        assert!(matches!(
            read_line(br#"{"id":7,"error":{"kind":"oom","msg":"x"}}"#),
            Ok(Said::Failed { .. })
        ));
        for bad in [
            "",
            "loading...",
            "[]",
            "{}",
            r#"{"id":7}"#,
            r#"{"id":-1,"done":true}"#,
            r#"{"id":7,"frame":1,"obj":1}"#,
        ] {
            assert!(read_line(bad.as_bytes()).is_err(), "{bad}");
        }
    }
}
