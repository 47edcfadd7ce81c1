//! The words of a question, and the shape that its answer should have.

use l4d_data::digest::sha256_hex;
use l4d_endpoint::coordinates::Scale;
use l4d_endpoint::{BoxPx, Convention, Reply};
use serde_json::{Map, Value, json};

use crate::grounder::Outcome;
use crate::plan::document;

/// A prompt, as a file beside this code. Its version is part of its name: a changed text is another file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Template {
    pub(super) name: &'static str,
    text: &'static str,
}

impl Template {
    pub(super) const TEXT: Self = Self { name: "text_v1", text: include_str!("prompts/text_v1.md") };
    pub(super) const BOX: Self = Self { name: "box_v1", text: include_str!("prompts/box_v1.md") };
    pub(super) const NOUN: Self = Self { name: "noun_v1", text: include_str!("prompts/noun_v1.md") };
    pub(super) const PICK: Self = Self { name: "pick_v1", text: include_str!("prompts/pick_v1.md") };

    /// What answers depend on.
    pub(super) fn identity(&self) -> Value {
        json!({ "name": self.name, "sha256": sha256_hex(self.text.as_bytes()) })
    }

    /// The prompt with its places filled, in one pass: what is filled in is never searched for places.
    pub(super) fn fill(self, words: &[(&str, String)]) -> String {
        let mut filled = String::new();
        let mut rest = self.text.trim_end();
        while let Some((before, after)) = rest.split_once('{') {
            filled.push_str(before);
            let place = after.split_once('}');
            let word = place.and_then(|(place, _)| Some(&words.iter().find(|(name, _)| *name == place)?.1));
            match (place, word) {
                (Some((_, after)), Some(word)) => {
                    filled.push_str(word);
                    rest = after;
                }
                _ => {
                    filled.push('{');
                    rest = after;
                }
            }
        }
        filled + rest
    }
}

/// An example of an answer, and its schema.
pub(super) struct Shape {
    pub(super) example: Value,
    pub(super) schema: Value,
}

/// A plan in words alone.
pub(super) fn words_shape() -> Shape {
    let text = json!({ "type": "string" });
    Shape {
        example: json!({ "visible": true, "expression": "...", "noun_phrase": "..." }),
        schema: object(json!({ "visible": { "type": "boolean" }, "expression": text, "noun_phrase": text })),
    }
}

/// A plan with boxes in `pictures` pictures of `size` (width, height).
pub(super) fn boxes_shape(convention: &Convention, size: (u32, u32), pictures: usize) -> Shape {
    // A box in the middle, where it says nothing about the target.
    let [width, height] = [size.0, size.1].map(f64::from);
    let middle = BoxPx { x0: width * 0.4, y0: height * 0.4, x1: width * 0.6, y1: height * 0.6 };
    let numbers = convention.numbers(middle, size);
    // Whole numbers, unless a side is 1.
    let (numbers, number) = match convention.scale {
        Scale::Relative(1.0) => (json!(numbers), json!({ "type": "number", "minimum": 0, "maximum": 1 })),
        scale => {
            let mut number = json!({ "type": "integer", "minimum": 0 });
            if let Scale::Relative(range) = scale {
                number["maximum"] = json!(range as i64);
            }
            (json!(numbers.map(|number| number.round() as i64)), number)
        }
    };
    let Shape { mut example, schema } = words_shape();
    example["boxes"] = json!([{ "time": 0.0, &convention.key: numbers }]);
    let mut properties = schema["properties"].clone();
    properties["boxes"] = json!({ "type": "array", "items": object(json!({
        "time": { "type": "number", "minimum": 0, "maximum": pictures.saturating_sub(1) },
        &convention.key: { "type": "array", "items": number, "minItems": 4, "maxItems": 4 },
    })) });
    Shape { example, schema: object(properties) }
}

/// A choice among candidates.
pub(super) fn choice_shape(candidates: usize) -> Shape {
    let number = json!({ "type": "integer", "minimum": 1, "maximum": candidates });
    Shape {
        example: json!({ "numbers": [2] }),
        schema: object(json!({ "numbers": { "type": "array", "items": number } })),
    }
}

/// An object with all of these properties and no others, as servers in strict mode want it.
fn object(properties: Value) -> Value {
    let required: Vec<&String> = properties.as_object().map(Map::keys).into_iter().flatten().collect();
    json!({ "type": "object", "required": required, "additionalProperties": false, "properties": properties })
}

/// Reads a choice among `count` candidates: their numbers, ascending, at least one.
pub(super) fn read_choice(
    reply: &Reply,
    count: usize,
    notes: &mut Vec<String>,
) -> Result<Vec<usize>, Outcome> {
    let document = document(reply)?;
    let Some(items) = ["numbers", "ids", "chosen"].iter().find_map(|key| document.get(*key)?.as_array())
    else {
        return Err(Outcome::Unparsed("the answer holds no list of numbers".to_owned()));
    };
    if items.is_empty() {
        return Err(Outcome::Absent);
    }
    let number = |item: &Value| -> Option<usize> {
        let number = item.as_u64().or_else(|| item.as_str()?.trim().parse().ok())?;
        usize::try_from(number).ok().filter(|number| (1..=count).contains(number))
    };
    let mut numbers: Vec<usize> = items.iter().filter_map(number).collect();
    if numbers.is_empty() {
        return Err(Outcome::Unparsed(format!("none of {} numbers is a candidate's", items.len())));
    }
    if numbers.len() < items.len() {
        notes.push(format!("{} of {} numbers are no candidate's", items.len() - numbers.len(), items.len()));
    }
    numbers.sort_unstable();
    numbers.dedup();
    Ok(numbers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_candidates_are_chosen_and_others_are_told() {
        let notes = &mut Vec::new();
        let mut choice = |text: &str| read_choice(&Reply::saying(text), 3, notes);
        assert_eq!(choice(r#"{"numbers":[3,1,3]}"#), Ok(vec![1, 3]));
        assert_eq!(choice(r#"It is {"ids":["2", 7, -1, "x"]}."#), Ok(vec![2]));
        assert_eq!(choice(r#"{"numbers":[]}"#), Err(Outcome::Absent));
        assert_eq!(choice(r#"{"numbers":[1"#), Err(Outcome::Truncated));
        for nonsense in [r#"{"numbers":[0,4]}"#, r#"{"number":1}"#, "2", ""] {
            assert!(matches!(choice(nonsense), Err(Outcome::Unparsed(_))), "{nonsense}");
        }
        assert_eq!(*notes, ["3 of 4 numbers are no candidate's"]);
    }
}
