//! One proposal as a model wrote it, read with as much patience as its meaning allows.

use l4d_data::error::is_hidden;
use l4d_data::{Category, Interval, Temporal};
use serde_json::{Value, json};

use crate::answer::Reason;
use crate::quote::excerpt;

/// No list of numbers or intervals is longer.
const MOST_NUMBERS: usize = 64;

/// A query as a model proposes it; nothing of it is checked against the scene.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Proposal {
    /// What it says its category is.
    pub(super) category: Category,
    /// The sentence, with white space and quotes around it taken off, and a single full stop.
    pub(super) text: String,
    /// Numbers on the pictures.
    pub(super) referents: Vec<u32>,
    /// How the sentence binds time.
    pub(super) temporal: Temporal,
    /// When it says that it holds; empty for `whole`.
    pub(super) frames: Vec<Interval>,
    /// The predicate as JSON, or what it gave in its place if that is none.
    pub(super) predicate: Option<Result<Value, String>>,
}

/// The shape that an answer should have.
pub(super) fn schema() -> Value {
    let integer = json!({ "type": "integer" });
    json!({
        "type": "object",
        "additionalProperties": false,
        "required": ["proposals"],
        "properties": { "proposals": { "type": "array", "items": {
            "type": "object",
            "additionalProperties": false,
            "required": ["category", "text", "referents", "temporal", "frames", "predicate"],
            "properties": {
                "category": { "type": "string", "enum": Category::ALL.map(Category::as_str) },
                "text": { "type": "string" },
                "referents": { "type": "array", "items": integer },
                "temporal": { "type": "string", "enum": ["whole", "while"] },
                "frames": { "type": "array", "items": { "type": "array", "items": integer } },
                "predicate": { "type": "string" },
            },
        } } },
    })
}

impl Proposal {
    /// Reads one item of an answer; the error is all that is wrong with it.
    pub(super) fn read(item: &Value) -> Result<Self, Vec<Reason>> {
        let reasons = &mut Vec::new();
        let four = "attribute, action, spatial or interaction";
        let category = field(item, "category", four, reasons, plain).and_then(|text| {
            let found = Category::ALL.into_iter().find(|category| category.as_str() == text);
            if found.is_none() {
                let message = format!("`{}` is no category", excerpt(&text));
                reasons.push(Reason::new("L4D562", "category", message, format!("wanted: {four}")));
            }
            found
        });
        let line = "a sentence without control characters or direction marks";
        let text = field(item, "text", line, reasons, sentence);
        let numbered = "a list of numbers that are on the pictures";
        let referents = field(item, "referents", numbered, reasons, numbers);
        let temporal =
            field(item, "temporal", "whole or while", reasons, |value| match plain(value)?.as_str() {
                "whole" => Some(Temporal::Whole),
                "while" => Some(Temporal::While),
                _ => None,
            });
        let frames = match temporal {
            Some(Temporal::While) => {
                field(item, "frames", "[[first, last], ...], ascending", reasons, intervals)
            }
            _ => Some(Vec::new()),
        };
        let predicate = predicate(&item["predicate"]);
        match (category, text, referents, temporal, frames) {
            (Some(category), Some(text), Some(referents), Some(temporal), Some(frames)) => {
                Ok(Self { category, text, referents, temporal, frames, predicate })
            }
            _ => Err(std::mem::take(reasons)),
        }
    }
}

/// A field that can be read, or the reason that it cannot.
fn field<T>(
    item: &Value,
    name: &str,
    wanted: &str,
    reasons: &mut Vec<Reason>,
    read: impl FnOnce(&Value) -> Option<T>,
) -> Option<T> {
    let value = &item[name];
    let found = read(value);
    if found.is_none() {
        let message = match value {
            Value::Null => "is missing".to_owned(),
            value => format!("is {:.80}", excerpt(&value.to_string())),
        };
        reasons.push(Reason::new("L4D561", name, message, format!("wanted: {wanted}")));
    }
    found
}

fn plain(value: &Value) -> Option<String> {
    Some(value.as_str()?.trim().to_lowercase())
}

fn sentence(value: &Value) -> Option<String> {
    let text = value.as_str()?.split_whitespace().collect::<Vec<_>>().join(" ");
    let text = text.trim_matches(['"', '\'', '“', '”', '‘', '’']).trim();
    let text = text.strip_suffix('.').filter(|rest| !rest.ends_with('.')).unwrap_or(text);
    (!text.chars().any(is_hidden)).then(|| text.to_owned())
}

/// Numbers, each once; a single one needs no list.
fn numbers(value: &Value) -> Option<Vec<u32>> {
    let items = match value {
        Value::Array(items) if items.len() <= MOST_NUMBERS => items.as_slice(),
        Value::Number(_) | Value::String(_) => std::slice::from_ref(value),
        _ => return None,
    };
    let mut numbers: Vec<u32> = Vec::new();
    for item in items {
        let number = whole_number(item)?;
        if !numbers.contains(&number) {
            numbers.push(number);
        }
    }
    Some(numbers)
}

/// A number, also as text, with `#` before it, or with a point and zeros behind it.
fn whole_number(value: &Value) -> Option<u32> {
    let number = match value {
        Value::Number(number) => number.as_f64()?,
        Value::String(text) => text.trim().trim_start_matches('#').parse().ok()?,
        _ => return None,
    };
    let fits = number.fract() == 0.0 && (0.0..=1e6).contains(&number);
    fits.then_some(number as u32)
}

/// Intervals that do not overlap, sorted; a single `[first, last]` will do.
fn intervals(value: &Value) -> Option<Vec<Interval>> {
    let items = value.as_array().filter(|items| (1..=MOST_NUMBERS).contains(&items.len()))?;
    let pair = |pair: &[Value]| match pair {
        [first, last] => Interval::new(whole_number(first)?, whole_number(last)?).ok(),
        _ => None,
    };
    let mut found: Vec<Interval> = match items.iter().all(|item| !item.is_array()) {
        true => vec![pair(items)?],
        false => items.iter().map(|item| pair(item.as_array()?)).collect::<Option<_>>()?,
    };
    found.sort_unstable();
    found.windows(2).all(|pair| pair[0].last() < pair[1].first()).then_some(found)
}

/// The predicate as JSON, written as such or inside a string.
fn predicate(value: &Value) -> Option<Result<Value, String>> {
    let unreadable = |text: &str| Some(Err(text.chars().take(2000).collect()));
    match value {
        Value::Null => None,
        Value::Array(clauses) if clauses.is_empty() => None,
        Value::Array(_) => Some(Ok(value.clone())),
        Value::String(text) if matches!(text.trim(), "" | "null" | "none" | "[]") => None,
        Value::String(text) => match serde_json::from_str::<Value>(text) {
            Ok(inner @ Value::Array(_)) => Some(Ok(inner)),
            _ => unreadable(text),
        },
        other => unreadable(&other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(field: &str, value: Value) -> Result<Proposal, Vec<Reason>> {
        let mut item = json!({
            "category": "action", "text": "The cat that jumps", "referents": [2], "temporal": "whole",
            "frames": [], "predicate": r#"[{"category":"cat"},{"does":{"verb":"jump"}}]"#,
        });
        item[field] = value;
        Proposal::read(&item)
    }

    #[test]
    fn small_slips_are_forgiven() {
        let plain = with("referents", json!([2])).unwrap();
        assert_eq!(plain.predicate.as_ref().unwrap().as_ref().unwrap()[1]["does"]["verb"], "jump");
        for (field, value) in [
            ("category", json!(" Action ")),
            ("text", json!(" \"The cat  that\njumps.\" ")),
            ("text", json!("The cat that jumps.")),
            ("referents", json!("2")),
            ("referents", json!(2)),
            ("referents", json!(["#2", 2.0])),
            ("temporal", json!("WHOLE")),
            ("frames", json!("all of them")),
            ("predicate", json!([{"category": "cat"}, {"does": {"verb": "jump"}}])),
        ] {
            assert_eq!(with(field, value.clone()).unwrap(), plain, "{field} {value}");
        }
        for missing in [json!(""), json!(null), json!("null"), json!([])] {
            assert_eq!(with("predicate", missing).unwrap().predicate, None);
        }
        let broken = with("predicate", json!("cat(x) and jump(x)")).unwrap();
        assert_eq!(broken.predicate, Some(Err("cat(x) and jump(x)".to_owned())));
    }

    #[test]
    fn gated_frames_are_intervals() {
        let frames = |frames: Value| {
            let found = intervals(&frames)?;
            Some(found.into_iter().map(<[u32; 2]>::from).collect::<Vec<_>>())
        };
        assert_eq!(frames(json!([[10, 30]])), Some(vec![[10, 30]]));
        assert_eq!(frames(json!([10, 30.0])), Some(vec![[10, 30]]));
        assert_eq!(frames(json!([[50, 70], [10, 30]])), Some(vec![[10, 30], [50, 70]]));
        for bad in [
            json!([]),
            json!(null),
            json!([[30, 10]]),
            json!([[1, 2, 3]]),
            json!([[0, 50], [40, 60]]),
            json!([[-1, 20]]),
            json!([[0.5, 20]]),
            json!(["a", "b"]),
        ] {
            assert_eq!(frames(bad.clone()), None, "{bad}");
        }
    }

    #[test]
    fn what_cannot_be_read_is_named() {
        for (code, field, value) in [
            ("L4D562", "category", json!("colour")),
            ("L4D561", "category", json!(3)),
            ("L4D561", "text", json!(["The cat"])),
            ("L4D561", "text", json!("The \u{1b}[31mcat")),
            ("L4D561", "referents", json!(["the cat"])),
            ("L4D561", "referents", json!([1e300])),
            ("L4D561", "referents", json!(vec![1; 65])),
            ("L4D561", "temporal", json!("sometimes")),
        ] {
            let reasons = with(field, value.clone()).unwrap_err();
            assert_eq!((reasons[0].code, reasons[0].field.as_str()), (code, field), "{value}");
            assert_eq!(reasons.len(), 1);
        }
        assert_eq!(Proposal::read(&json!("a string")).unwrap_err().len(), 4);
    }
}
