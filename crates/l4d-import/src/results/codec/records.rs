//! COCO run lengths in JSON: one, a list by position, or by sentence and frame.

use std::path::Path;

use l4d_data::error::inert;
use l4d_data::json;
use l4d_data::store::read_bounded;
use l4d_masks::Mask;
use serde_json::Value;

use super::{Piece, Place, Problem, sane};
use crate::annotations::coco::plain_runs;

/// No file of run lengths is larger.
const MAX_BYTES: u64 = 256 << 20;
/// What to do about run lengths that are none.
const HINT: &str =
    "write what pycocotools' mask.encode gives: {\"size\": [height, width], \"counts\": \"...\"}, or null";

pub(super) fn read(path: &Path) -> Result<Vec<Piece>, Problem> {
    let value: Value = json::parse(path, None, &read_bounded(path, MAX_BYTES)?)?;
    all(&value)
}

/// All answers of a file: of one sentence, or by sentence.
fn all(value: &Value) -> Result<Vec<Piece>, Problem> {
    let mut pieces = Vec::new();
    match value {
        Value::Object(sentences) if !sentences.contains_key("counts") => {
            for (name, value) in sentences {
                of_sentence(value, Some(name), &mut pieces)?;
            }
        }
        value => of_sentence(value, None, &mut pieces)?,
    }
    Ok(pieces)
}

/// The answers to one sentence: one, a list by position, or by frame.
fn of_sentence(value: &Value, name: Option<&str>, pieces: &mut Vec<Piece>) -> Result<(), Problem> {
    let sentence = name.map(|name| format!("[{}]", inert(name))).unwrap_or_default();
    let mut add = |value: &Value, place: Option<Place>, key: String| {
        let mask = mask(value)
            .map_err(|message| Problem::unreadable(format!("entry {sentence}{key}"), message, HINT))?;
        pieces.push(Piece { name: name.map(str::to_owned), place, mask });
        Ok(())
    };
    match value {
        Value::Array(items) => items
            .iter()
            .enumerate()
            .try_for_each(|(index, item)| add(item, Some(Place::Position(index)), format!("[{index}]"))),
        Value::Object(frames) if !frames.contains_key("counts") => {
            frames.iter().try_for_each(|(key, item)| {
                let place = key.parse().ok().map(Place::Frame).ok_or_else(|| {
                    let message = "has a key that is neither sentence nor frame";
                    Problem::unreadable(format!("entry {sentence}[{}]", inert(key)), message, HINT)
                })?;
                add(item, Some(place), format!("[{key}]"))
            })
        }
        value => add(value, None, String::new()),
    }
}

/// A mask; none where the file says that nothing is there.
fn mask(value: &Value) -> Result<Option<Mask>, String> {
    let fields = match value {
        Value::Null => return Ok(None),
        Value::Object(fields) => fields,
        Value::Array(_) => return Err("is a list within a frame".to_owned()),
        _ => return Err("is no run lengths".to_owned()),
    };
    let side = |index: usize| fields.get("size").and_then(|size| size.get(index)).and_then(Value::as_u64);
    let (height, width) = side(0).zip(side(1)).ok_or("has no `size` of [height, width]")?;
    let (width, height) = sane(width, height, "size").map_err(|problem| problem.message)?;
    let mask = match fields.get("counts") {
        Some(Value::String(counts)) => {
            Mask::decode(counts, width, height).map_err(|error| error.to_string())?
        }
        Some(Value::Array(runs)) => {
            let runs: Option<Vec<u64>> = runs.iter().map(Value::as_u64).collect();
            plain_runs(&runs.ok_or("has a run that is no length")?, width, height)?
        }
        _ => return Err("has `counts` that are neither a text nor a list".to_owned()),
    };
    Ok(Some(mask))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    /// Name, place and area.
    type Listed = (Option<String>, Option<Place>, Option<u64>);

    fn pieces(value: &Value) -> Result<Vec<Listed>, Problem> {
        let listed = |piece: Piece| (piece.name, piece.place, piece.mask.map(|mask| mask.area()));
        Ok(all(value)?.into_iter().map(listed).collect())
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
            (json!([[1]]), "list within a frame"),
            (json!({"a": {"b": null}}), "neither sentence nor frame"),
            (json!("x"), "no run lengths"),
        ] {
            let problem = pieces(&value).unwrap_err();
            assert!(problem.message.contains(reason), "{value}: {problem:?}");
        }
    }
}
