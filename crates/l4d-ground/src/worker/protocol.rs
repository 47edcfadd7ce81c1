//! The lines that go back and forth (docs/workers.md).

use std::collections::BTreeMap;

use l4d_masks::Mask;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::frames::Frames;

/// Version of the protocol that this crate speaks.
pub(super) const PROTOCOL: u32 = 1;

/// What a worker says of itself when it is ready.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
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
    /// What else its answers depend on.
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

/// What a model is, wherever its files are.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Weights {
    /// Name of its folder or file.
    pub id: String,
    /// Digest of its files.
    pub sha256: String,
}

/// A request for masks.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Segment<'a> {
    pub(super) id: u64,
    pub(super) frames: &'a Frames,
    /// As [`super::ClipPrompt::indexed`] spells them.
    pub(super) prompts: &'a [Value],
    /// First and last frame that masks are wanted of.
    pub(super) range: [u32; 2],
    /// Least score of an object that is wanted.
    pub(super) threshold: f64,
}

/// What is written to a worker.
#[derive(Debug, Serialize)]
#[serde(tag = "op", rename_all = "snake_case")]
pub(super) enum Request<'a> {
    Segment(&'a Segment<'a>),
    Cancel { id: u64 },
    Shutdown,
}

/// What a worker writes, one per line.
#[derive(Debug)]
pub(super) enum WorkerLine {
    Hello(Box<Hello>),
    /// It is at work.
    Alive,
    /// About the request of this id.
    About(u64, Part),
}

/// A part of an answer.
#[derive(Debug)]
pub(super) enum Part {
    Mask(MaskLine),
    Done { skipped: Vec<String> },
    Failed { kind: String, message: String },
}

#[derive(Debug)]
pub(super) struct MaskLine {
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
        Mask::decode(&self.counts, width, height).map_err(|error| format!("a mask cannot be read: {error}"))
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
pub(super) fn read_line(bytes: &[u8]) -> Result<WorkerLine, String> {
    let line: Line = serde_json::from_slice(bytes).map_err(|error| error.to_string())?;
    if let Some(hello) = line.hello {
        return Ok(WorkerLine::Hello(hello));
    }
    let Some(id) = line.id else {
        let is_alive = line.alive == Some(true);
        return if is_alive { Ok(WorkerLine::Alive) } else { Err("a line without an id".to_owned()) };
    };
    let part = match (line.error, line.done, line.frame, line.obj, line.rle) {
        (Some(Failure { kind, msg }), ..) => Part::Failed { kind, message: msg },
        (None, Some(true), ..) => Part::Done { skipped: line.skipped },
        (None, _, Some(frame), Some(object), Some(rle)) => {
            Part::Mask(MaskLine { frame, object, rle, score: line.score })
        }
        _ => return Err("a line that is neither mask nor end nor error".to_owned()),
    };
    Ok(WorkerLine::About(id, part))
}

/// A line for a worker.
pub(super) fn write_line(request: &Request<'_>) -> Result<String, serde_json::Error> {
    let mut line = serde_json::to_string(request)?;
    line.push('\n');
    Ok(line)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::worker::ClipPrompt;

    #[test]
    fn requests_are_spelled_as_documented() {
        let frames = Frames { dir: "/clip".into(), files: vec!["a.png".into()], width: 4, height: 3 };
        let prompts = [
            ClipPrompt::Box { object: 1, frame: 12, box_px: [1.0, 0.5, 2.0, 3.0] },
            ClipPrompt::Point { object: 2, frame: 12, point_px: [1.0, 2.0] },
            ClipPrompt::Text("a \"cup\"\n".into()),
            ClipPrompt::Point { object: 2, frame: 24, point_px: [1.0, 2.0] },
        ];
        let index = |frame: u32| (frame == 12).then_some(0);
        let prompts: Vec<Value> = prompts.iter().filter_map(|prompt| prompt.indexed(index)).collect();
        let segment = Segment { id: 7, frames: &frames, prompts: &prompts, range: [0, 0], threshold: 0.5 };
        let line = write_line(&Request::Segment(&segment)).unwrap();
        assert_eq!(
            line,
            concat!(
                r#"{"op":"segment","id":7,"frames":{"dir":"/clip","files":["a.png"],"width":4,"height":3},"#,
                r#""prompts":[{"obj":1,"frame":0,"box_px":[1.0,0.5,2.0,3.0]},{"obj":2,"frame":0,"point_px":[1.0,2.0]},"#,
                r#"{"obj":1,"text":"a \"cup\"\n"}],"range":[0,0],"threshold":0.5}"#,
                "\n"
            )
        );
        assert_eq!(write_line(&Request::Cancel { id: 7 }).unwrap(), "{\"op\":\"cancel\",\"id\":7}\n");
        assert_eq!(write_line(&Request::Shutdown).unwrap(), "{\"op\":\"shutdown\"}\n");
    }

    #[test]
    fn lines_are_told_apart_and_others_are_refused() {
        let mask = br#"{"id":7,"frame":1,"obj":2,"rle":{"size":[2,3],"counts":"132"},"score":0.5}"#;
        let Ok(WorkerLine::About(7, Part::Mask(line))) = read_line(mask) else { panic!("no mask") };
        assert_eq!((line.frame, line.object, line.score), (1, 2, Some(0.5)));
        assert_eq!(line.rle.decode(3, 2).unwrap().area(), 3);
        assert!(line.rle.decode(2, 3).unwrap_err().contains("3x2"));
        for (line, expected) in [
            (r#"{"alive":true}"#, "Ok(Alive)"),
            (r#"{"id":7,"done":true,"more":1}"#, "Ok(About(7, Done { skipped: [] }))"),
            (
                r#"{"id":7,"error":{"kind":"oom","msg":"x"}}"#,
                r#"Ok(About(7, Failed { kind: "oom", message: "x" }))"#,
            ),
        ] {
            assert_eq!(format!("{:?}", read_line(line.as_bytes())), expected);
        }
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
