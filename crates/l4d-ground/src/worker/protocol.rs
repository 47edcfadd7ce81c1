//! The lines that go back and forth (docs/workers.md).

use std::collections::BTreeMap;

use l4d_masks::Mask;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::frames::Frames;

/// Version of the protocol that this crate speaks.
pub(super) const PROTOCOL: u32 = 1;

/// What a worker says of itself when it is ready. All of it is part of the identity of every answer.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Hello {
    /// Version of the protocol.
    pub(super) protocol: u32,
    pub name: String,
    /// Kinds of prompts that it takes: `box`, `text`.
    #[serde(default)]
    pub(super) prompts: Vec<String>,
    /// What kind of text it understands; none if it takes no text.
    #[serde(default)]
    pub text: Option<TextKind>,
    /// Its version, where it computes, its weights, its libraries, its settings.
    #[serde(flatten)]
    rest: BTreeMap<String, Value>,
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
#[derive(Debug, Deserialize)]
#[serde(untagged)]
pub(super) enum WorkerLine {
    Hello {
        hello: Box<Hello>,
    },
    Failed {
        id: u64,
        error: Failure,
    },
    Mask(MaskLine),
    Done {
        id: u64,
        #[serde(rename = "done")]
        _done: bool,
        #[serde(default)]
        skipped: Vec<String>,
    },
    Alive {
        #[serde(rename = "alive")]
        _alive: bool,
    },
}

#[derive(Debug, Deserialize)]
pub(super) struct Failure {
    pub(super) kind: String,
    pub(super) msg: String,
}

#[derive(Debug, Deserialize)]
pub(super) struct MaskLine {
    id: u64,
    pub(super) frame: u32,
    pub(super) obj: u32,
    pub(super) rle: Rle,
    pub(super) score: Option<f64>,
}

impl WorkerLine {
    /// The request that it is about.
    pub(super) fn id(&self) -> Option<u64> {
        match self {
            Self::Hello { .. } | Self::Alive { .. } => None,
            Self::Failed { id, .. } | Self::Done { id, .. } => Some(*id),
            Self::Mask(line) => Some(line.id),
        }
    }
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

/// A line for a worker.
pub(super) fn write_line(request: &Request<'_>) -> Result<String, serde_json::Error> {
    let mut line = serde_json::to_string(request)?;
    line.push('\n');
    Ok(line)
}

#[cfg(test)]
mod tests {
    use l4d_endpoint::BoxPx;

    use super::*;
    use crate::worker::ClipPrompt;

    #[test]
    fn requests_are_spelled_as_documented() {
        let frames = Frames { dir: "/clip".into(), files: vec!["a.png".into()], width: 4, height: 3 };
        let prompts = [
            ClipPrompt::Box { object: 1, frame: 12, place: BoxPx { x0: 1.0, y0: 0.5, x1: 2.0, y1: 3.0 } },
            ClipPrompt::Text("a \"cup\"\n".into()),
            ClipPrompt::Box { object: 2, frame: 24, place: BoxPx { x0: 1.0, y0: 0.5, x1: 2.0, y1: 3.0 } },
        ];
        let index = |frame: u32| (frame == 12).then_some(0);
        let prompts: Vec<Value> = prompts.iter().filter_map(|prompt| prompt.indexed(index)).collect();
        let segment = Segment { id: 7, frames: &frames, prompts: &prompts, range: [0, 0], threshold: 0.5 };
        let line = write_line(&Request::Segment(&segment)).unwrap();
        assert_eq!(
            line,
            concat!(
                r#"{"op":"segment","id":7,"frames":{"dir":"/clip","files":["a.png"],"width":4,"height":3},"#,
                r#""prompts":[{"obj":1,"frame":0,"box_px":[1.0,0.5,2.0,3.0]},"#,
                r#"{"obj":1,"text":"a \"cup\"\n"}],"range":[0,0],"threshold":0.5}"#,
                "\n"
            )
        );
        assert_eq!(write_line(&Request::Cancel { id: 7 }).unwrap(), "{\"op\":\"cancel\",\"id\":7}\n");
        assert_eq!(write_line(&Request::Shutdown).unwrap(), "{\"op\":\"shutdown\"}\n");
    }

    #[test]
    fn lines_are_told_apart_and_others_are_refused() {
        let read = |line: &str| serde_json::from_str::<WorkerLine>(line);
        let mask = r#"{"id":7,"frame":1,"obj":2,"rle":{"size":[2,3],"counts":"132"},"score":0.5}"#;
        let Ok(WorkerLine::Mask(line)) = read(mask) else { panic!("no mask") };
        assert_eq!((line.id, line.frame, line.obj, line.score), (7, 1, 2, Some(0.5)));
        assert_eq!(line.rle.decode(3, 2).unwrap().area(), 3);
        assert!(line.rle.decode(2, 3).unwrap_err().contains("3x2"));
        assert!(matches!(read(r#"{"alive":true}"#), Ok(WorkerLine::Alive { .. })));
        let done = read(r#"{"id":7,"done":true,"more":1}"#);
        assert!(matches!(done, Ok(WorkerLine::Done { id: 7, skipped, .. }) if skipped.is_empty()));
        let failed = read(r#"{"id":7,"error":{"kind":"oom","msg":"x"}}"#);
        assert!(matches!(failed, Ok(WorkerLine::Failed { id: 7, error }) if error.kind == "oom"));
        let halves = [r#"{"id":7}"#, r#"{"id":-1,"done":true}"#, r#"{"id":7,"frame":1,"obj":1}"#];
        for bad in ["", "loading...", "[]", "{}"].into_iter().chain(halves) {
            assert!(read(bad).is_err(), "{bad}");
        }
    }
}
