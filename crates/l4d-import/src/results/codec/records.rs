//! COCO run lengths in JSON: one, a list by position, or by sentence and frame.

use std::path::Path;

use l4d_data::json;
use l4d_data::store::read_bounded;
use l4d_masks::Mask;
use serde_json::{Map, Value};

use super::{Piece, Place, Problem, sane};
use crate::annotations::coco::plain_runs;

/// No file of run lengths is larger.
const MAX_BYTES: u64 = 256 << 20;
/// Lists within lists: sentence, frame.
const DEEPEST: usize = 3;
/// What to do about run lengths that are none.
const REMEDY: &str =
    "write what pycocotools' mask.encode gives: {\"size\": [height, width], \"counts\": \"...\"}, or null";

pub(super) fn read(path: &Path) -> Result<Vec<Piece>, Problem> {
    let value: Value = json::parse(path, None, &read_bounded(path, MAX_BYTES)?)?;
    let mut pieces = Vec::new();
    walk(&value, &Trail::default(), &mut pieces)?;
    Ok(pieces)
}

/// Where in the file a value is, and what that says.
#[derive(Debug, Clone, Default)]
struct Trail {
    shown: String,
    depth: usize,
    name: Option<String>,
    place: Option<Place>,
}

impl Trail {
    fn below(&self, key: &str) -> Self {
        Self {
            shown: format!("{}[{}]", self.shown, l4d_data::error::inert(key)),
            depth: self.depth + 1,
            ..self.clone()
        }
    }
}

fn walk(value: &Value, trail: &Trail, pieces: &mut Vec<Piece>) -> Result<(), Problem> {
    let fault = |message: &str| Problem::unreadable(format!("entry {}", trail.shown), message, REMEDY);
    if trail.depth > DEEPEST {
        return Err(fault("is nested deeper than sentence and frame"));
    }
    match value {
        Value::Null => {
            pieces.push(Piece { name: trail.name.clone(), place: trail.place, mask: None, soft: None });
        }
        Value::Array(items) => {
            if trail.place.is_some() {
                return Err(fault("is a list within a frame"));
            }
            for (index, item) in items.iter().enumerate() {
                let below = trail.below(&index.to_string());
                walk(item, &Trail { place: Some(Place::Position(index)), ..below }, pieces)?;
            }
        }
        Value::Object(fields) if fields.contains_key("counts") => {
            let mask = mask(fields, trail)?;
            pieces.push(Piece { name: trail.name.clone(), place: trail.place, mask: Some(mask), soft: None });
        }
        Value::Object(fields) => {
            for (key, item) in fields {
                let below = trail.below(key);
                // Outermost keys are sentences; keys of digits below a sentence are frames.
                let frame = key.parse().ok().filter(|_| trail.depth > 0 && trail.place.is_none());
                let below = match (frame, &trail.name) {
                    (Some(frame), _) => Trail { place: Some(Place::Frame(frame)), ..below },
                    (None, None) => Trail { name: Some(key.clone()), ..below },
                    (None, Some(_)) => return Err(fault("has a key that is neither sentence nor frame")),
                };
                walk(item, &below, pieces)?;
            }
        }
        _ => return Err(fault("is no run lengths")),
    }
    Ok(())
}

fn mask(fields: &Map<String, Value>, trail: &Trail) -> Result<Mask, Problem> {
    let fault = |message: String| Problem::unreadable(format!("entry {}", trail.shown), message, REMEDY);
    let side = |index: usize| fields.get("size").and_then(|size| size.get(index)).and_then(Value::as_u64);
    let (Some(height), Some(width)) = (side(0), side(1)) else {
        return Err(fault("has no `size` of [height, width]".to_owned()));
    };
    let (width, height) = sane(width, height, "field `size`")?;
    match &fields["counts"] {
        Value::String(counts) => {
            Mask::decode(counts, width, height).map_err(|error| fault(error.to_string()))
        }
        Value::Array(runs) => {
            let runs: Option<Vec<u64>> = runs.iter().map(Value::as_u64).collect();
            let runs = runs.ok_or_else(|| fault("has a run that is no length".to_owned()))?;
            plain_runs(&runs, width, height).map_err(fault)
        }
        _ => Err(fault("has `counts` that are neither a text nor a list".to_owned())),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    /// Name, place and area.
    type Listed = (Option<String>, Option<Place>, Option<u64>);

    fn pieces(value: &Value) -> Result<Vec<Listed>, Problem> {
        let mut pieces = Vec::new();
        walk(value, &Trail::default(), &mut pieces)?;
        Ok(pieces
            .into_iter()
            .map(|piece| (piece.name, piece.place, piece.mask.map(|mask| mask.area())))
            .collect())
    }

    #[test]
    fn one_a_list_and_sentences_with_frames() {
        let one = json!({"size": [3, 2], "counts": "024"});
        assert_eq!(pieces(&one).unwrap(), [(None, None, Some(2))]);
        let runs = json!({"size": [3, 2], "counts": [0, 2, 4]});
        let listed = [(None, Some(Place::Position(0)), None), (None, Some(Place::Position(1)), Some(2))];
        assert_eq!(pieces(&json!([null, runs])).unwrap(), listed);
        let name = || Some("the cup".to_owned());
        let both = [(name(), Some(Place::Frame(4)), Some(2)), (name(), Some(Place::Frame(12)), None)];
        assert_eq!(pieces(&json!({"the cup": {"0004": one, "12": null}})).unwrap(), both);
        let number = Some("003".to_owned());
        assert_eq!(pieces(&json!({"003": [one]})).unwrap(), [(number, Some(Place::Position(0)), Some(2))]);
    }

    #[test]
    fn what_is_no_run_length_is_named() {
        for (value, reason) in [
            (json!({"size": [3, 2], "counts": [0, 2, 5]}), "do not cover"),
            (json!({"size": [3, 2], "counts": [0, 2, 3]}), "do not cover"),
            (json!({"size": [3, 2], "counts": [-1, 7]}), "no length"),
            (json!({"size": [3, 99999999], "counts": [0]}), "each side"),
            (json!({"counts": "024"}), "no `size`"),
            (json!([[[1]]]), "list within a frame"),
            (json!({"a": {"b": null}}), "neither sentence nor frame"),
            (json!("x"), "no run lengths"),
        ] {
            let problem = pieces(&value).unwrap_err();
            assert!(problem.message.contains(reason), "{value}: {problem:?}");
        }
    }
}
