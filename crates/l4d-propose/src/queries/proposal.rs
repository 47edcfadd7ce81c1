//! One proposal as a model wrote it, read with as much patience as its meaning allows.

use l4d_data::{Category, Interval, Temporal};
use serde_json::{Value, json};

use crate::quote::is_hidden;
use crate::reason::Reason;

const MALFORMED: &str = "L4D561";
/// No list of numbers or intervals is longer.
const MOST_NUMBERS: usize = 64;

/// A query as a model proposes it; nothing of it is checked against the scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Proposal {
    /// What it says its category is.
    pub category: Category,
    /// The sentence, with white space and quotes around it taken off, and a single full stop.
    pub text: String,
    /// Numbers on the pictures.
    pub referents: Vec<u32>,
    /// How the sentence binds time.
    pub temporal: Temporal,
    /// When it says that it holds; empty for `whole`.
    pub frames: Vec<Interval>,
    /// The predicate as JSON, if it gave one that is JSON.
    pub predicate: Option<Value>,
    /// What it gave as predicate if that is no JSON.
    pub unreadable_predicate: Option<String>,
}

/// The shape that an answer should have.
pub(crate) fn schema() -> Value {
    let categories: Vec<&str> = Category::ALL.iter().map(|category| category.as_str()).collect();
    json!({
        "type": "object",
        "additionalProperties": false,
        "required": ["proposals"],
        "properties": { "proposals": { "type": "array", "items": {
            "type": "object",
            "additionalProperties": false,
            "required": ["category", "text", "referents", "temporal", "frames", "predicate"],
            "properties": {
                "category": { "type": "string", "enum": categories },
                "text": { "type": "string" },
                "referents": { "type": "array", "items": { "type": "integer" } },
                "temporal": { "type": "string", "enum": ["whole", "while"] },
                "frames": { "type": "array", "items": { "type": "array", "items": { "type": "integer" } } },
                "predicate": { "type": "string" },
            },
        } } },
    })
}

impl Proposal {
    /// Reads one item of an answer.
    ///
    /// # Errors
    /// All that is wrong with it.
    pub fn read(item: &Value) -> Result<Self, Vec<Reason>> {
        let mut reasons = Vec::new();
        let mut keep = |reason: Reason| reasons.push(reason);
        let category = category(&item["category"]).map_err(&mut keep);
        let text = sentence(&item["text"]).map_err(&mut keep);
        let referents = numbers(&item["referents"]).map_err(&mut keep);
        let temporal = temporal(&item["temporal"]).map_err(&mut keep);
        let frames = match temporal {
            Ok(Temporal::While) => intervals(&item["frames"]).map_err(&mut keep),
            _ => Ok(Vec::new()),
        };
        let (predicate, unreadable_predicate) = predicate(&item["predicate"]);
        match (category, text, referents, temporal, frames) {
            (Ok(category), Ok(text), Ok(referents), Ok(temporal), Ok(frames)) => {
                Ok(Self { category, text, referents, temporal, frames, predicate, unreadable_predicate })
            }
            _ => Err(reasons),
        }
    }
}

fn malformed(field: &str, value: &Value, wanted: &str) -> Reason {
    let found = match value {
        Value::Null => "is missing".to_owned(),
        value => {
            format!("is {}", crate::listing::excerpt(&value.to_string()).chars().take(80).collect::<String>())
        }
    };
    Reason::new(MALFORMED, field, found, format!("wanted: {wanted}"))
}

fn category(value: &Value) -> Result<Category, Reason> {
    let wanted = "attribute, action, spatial or interaction";
    let Some(text) = value.as_str() else { return Err(malformed("category", value, wanted)) };
    let text = text.trim().to_lowercase();
    let found = Category::ALL.into_iter().find(|category| category.as_str() == text);
    found.ok_or_else(|| {
        let message = format!("`{}` is no category", crate::listing::excerpt(&text));
        Reason::new("L4D562", "category", message, format!("wanted: {wanted}"))
    })
}

fn sentence(value: &Value) -> Result<String, Reason> {
    let Some(text) = value.as_str() else { return Err(malformed("text", value, "a sentence")) };
    let quotes = ['"', '\'', '“', '”', '‘', '’'];
    let text = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let text = text.trim_matches(quotes).trim();
    let text = text.strip_suffix('.').filter(|rest| !rest.ends_with('.')).unwrap_or(text);
    if text.chars().any(is_hidden) {
        let message = "has control characters or direction marks in it";
        return Err(Reason::new(MALFORMED, "text", message, "wanted: a plain sentence"));
    }
    Ok(text.to_owned())
}

fn numbers(value: &Value) -> Result<Vec<u32>, Reason> {
    let wanted = "a list of numbers that are on the pictures";
    let items = match value {
        Value::Array(items) => items.as_slice(),
        Value::Number(_) | Value::String(_) => std::slice::from_ref(value),
        _ => return Err(malformed("referents", value, wanted)),
    };
    if items.len() > MOST_NUMBERS {
        return Err(malformed("referents", value, wanted));
    }
    let mut numbers: Vec<u32> = Vec::new();
    for item in items {
        let number = whole_number(item).ok_or_else(|| malformed("referents", value, wanted))?;
        if !numbers.contains(&number) {
            numbers.push(number);
        }
    }
    Ok(numbers)
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

fn temporal(value: &Value) -> Result<Temporal, Reason> {
    match value.as_str().map(|text| text.trim().to_lowercase()).as_deref() {
        Some("whole") => Ok(Temporal::Whole),
        Some("while") => Ok(Temporal::While),
        _ => Err(malformed("temporal", value, "whole or while")),
    }
}

/// Ascending intervals that do not overlap; a single `[first, last]` will do.
fn intervals(value: &Value) -> Result<Vec<Interval>, Reason> {
    let wanted = "[[first, last], ...], ascending";
    let refuse = || malformed("frames", value, wanted);
    let Value::Array(items) = value else { return Err(refuse()) };
    if items.len() > MOST_NUMBERS {
        return Err(refuse());
    }
    let pair = |pair: &[Value]| match pair {
        [first, last] => Interval::new(whole_number(first)?, whole_number(last)?).ok(),
        _ => None,
    };
    let is_single = items.iter().all(|item| !item.is_array());
    let found: Option<Vec<Interval>> = if is_single {
        pair(items).map(|interval| vec![interval])
    } else {
        items.iter().map(|item| item.as_array().and_then(|item| pair(item))).collect()
    };
    let mut found = found.ok_or_else(refuse)?;
    found.sort_unstable();
    let is_ascending = found.windows(2).all(|pair| pair[0].last() < pair[1].first());
    if is_ascending && !found.is_empty() { Ok(found) } else { Err(refuse()) }
}

/// The predicate as JSON, written as such or inside a string; what is no JSON comes back as it is.
fn predicate(value: &Value) -> (Option<Value>, Option<String>) {
    match value {
        Value::Array(clauses) if !clauses.is_empty() => (Some(value.clone()), None),
        Value::String(text) if matches!(text.trim(), "" | "null" | "none" | "[]") => (None, None),
        Value::String(text) => match serde_json::from_str::<Value>(text) {
            Ok(inner @ Value::Array(_)) => (Some(inner), None),
            _ => (None, Some(text.chars().take(2000).collect())),
        },
        Value::Null | Value::Array(_) => (None, None),
        other => (None, Some(other.to_string().chars().take(2000).collect())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn item() -> Value {
        json!({
            "category": "action", "text": "The cat that jumps", "referents": [2], "temporal": "whole",
            "frames": [], "predicate": r#"[{"category":"cat"},{"does":{"verb":"jump"}}]"#,
        })
    }

    fn with(field: &str, value: Value) -> Value {
        let mut item = item();
        item[field] = value;
        item
    }

    fn reasons(field: &str, value: Value) -> Vec<(&'static str, String)> {
        let reasons = Proposal::read(&with(field, value)).unwrap_err();
        reasons.into_iter().map(|reason| (reason.code, reason.field)).collect()
    }

    #[test]
    fn small_slips_are_forgiven() {
        let plain = Proposal::read(&item()).unwrap();
        assert_eq!(plain.text, "The cat that jumps");
        assert_eq!(plain.predicate.as_ref().unwrap()[1]["does"]["verb"], "jump");
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
            assert_eq!(Proposal::read(&with(field, value.clone())).unwrap(), plain, "{field} {value}");
        }
    }

    #[test]
    fn gated_frames_are_intervals() {
        let frames = |frames: Value| {
            let mut item = with("temporal", json!("while"));
            item["frames"] = frames;
            let read = Proposal::read(&item).ok()?;
            Some(read.frames.into_iter().map(<[u32; 2]>::from).collect::<Vec<_>>())
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
        assert_eq!(reasons("category", json!("colour")), [("L4D562", "category".into())]);
        assert_eq!(reasons("category", json!(3)), [("L4D561", "category".into())]);
        assert_eq!(reasons("text", json!(["The cat"])), [("L4D561", "text".into())]);
        assert_eq!(reasons("text", json!("The \u{1b}[31mcat")), [("L4D561", "text".into())]);
        assert_eq!(reasons("referents", json!(["the cat"])), [("L4D561", "referents".into())]);
        assert_eq!(reasons("referents", json!([1e300])), [("L4D561", "referents".into())]);
        assert_eq!(reasons("referents", json!(vec![1; 65])), [("L4D561", "referents".into())]);
        assert_eq!(reasons("temporal", json!("sometimes")), [("L4D561", "temporal".into())]);
        let nothing = Proposal::read(&json!("a string")).unwrap_err();
        assert_eq!(nothing.len(), 4, "{nothing:?}");
    }

    #[test]
    fn a_predicate_may_be_missing_or_broken() {
        for missing in [json!(""), json!(null), json!("null"), json!([])] {
            let read = Proposal::read(&with("predicate", missing)).unwrap();
            assert_eq!((read.predicate, read.unreadable_predicate), (None, None));
        }
        let broken = Proposal::read(&with("predicate", json!("cat(x) and jump(x)"))).unwrap();
        assert_eq!(broken.predicate, None);
        assert_eq!(broken.unreadable_predicate.unwrap(), "cat(x) and jump(x)");
    }
}
