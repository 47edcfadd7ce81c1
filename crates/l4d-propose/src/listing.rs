//! The list in a model's answer: whatever is around it, and as much of it as arrived.

use l4d_endpoint::{Finish, Reply};
use serde_json::Value;

use crate::reason::Reason;

/// Longer answers are cut before JSON is looked for, bytes.
const LONGEST_ANSWER: usize = 1 << 18;
/// No answer has more items; what follows is not read.
const MOST_ITEMS: usize = 200;
/// Characters of an unreadable answer that are kept.
const EXCERPT: usize = 2000;

/// What could be read of an answer.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Listing {
    /// The items, in order.
    pub(crate) items: Vec<Value>,
    /// Why there may have been more, or none.
    pub(crate) problem: Option<Reason>,
}

/// The items of `list` in an answer. `mark` is a key that every item has: by it whole items of a broken list are
/// recognised.
pub(crate) fn listing(reply: &Reply, list: &str, mark: &str, code: &'static str) -> Listing {
    let text = cut(&reply.text);
    if let Some(mut items) = whole_list(text, list) {
        let mut problem = None;
        if items.len() > MOST_ITEMS {
            let message = format!("has {} items, of which {MOST_ITEMS} were read", items.len());
            problem = Some(Reason::new(code, "answer", message, "ask for fewer with --per-category"));
            items.truncate(MOST_ITEMS);
        }
        return Listing { items, problem };
    }
    let items = loose_items(text, mark);
    let (message, hint) = match (&reply.finish, items.len()) {
        (Finish::Refused(words), _) => (
            format!("the model refused: {}", excerpt(words)),
            "ask another model, or look at what the pictures show",
        ),
        (Finish::Length, count) => (
            format!("was cut off at the limit of tokens; {count} whole items of it were read"),
            "raise the limit of tokens of the endpoint, or ask for fewer",
        ),
        (_, 0) if text.trim().is_empty() => {
            ("is empty".to_owned(), "ask another model, or raise the limit of tokens of the endpoint")
        }
        (_, 0) => (
            format!("holds no list of proposals: {}", excerpt(text)),
            "ask a model that can follow instructions and answer in JSON",
        ),
        (_, count) => (
            format!("is not the list that was asked for; {count} whole items in it were read"),
            "nothing is lost but what the model did not finish",
        ),
    };
    Listing { items, problem: Some(Reason::new(code, "answer", message, hint)) }
}

/// The first complete list: an object with the field, or a bare array of objects, at any depth of wrapping.
fn whole_list(text: &str, list: &str) -> Option<Vec<Value>> {
    let mut position = 0;
    while let Some(found) = text[position..].find(['{', '[']) {
        let start = position + found;
        match leading_value(&text[start..]) {
            Some((value, length)) => match listed(value, list) {
                Some(items) => return Some(items),
                None => position = start + length,
            },
            None => position = start + 1,
        }
    }
    None
}

fn listed(value: Value, list: &str) -> Option<Vec<Value>> {
    match value {
        Value::Array(items) if !items.is_empty() && items.iter().all(Value::is_object) => Some(items),
        Value::Object(mut fields) => match fields.remove(list) {
            Some(Value::Array(items)) => Some(items),
            _ => fields.into_iter().find_map(|(_, value)| match value {
                Value::Object(_) => listed(value, list),
                _ => None,
            }),
        },
        _ => None,
    }
}

/// Complete objects with the marking key, wherever they are.
fn loose_items(text: &str, mark: &str) -> Vec<Value> {
    let mut items = Vec::new();
    let mut position = 0;
    while let Some(found) = text[position..].find('{') {
        let start = position + found;
        match leading_value(&text[start..]) {
            Some((value, length)) if value.get(mark).is_some() => {
                items.push(value);
                position = start + length;
            }
            _ => position = start + 1,
        }
        if items.len() == MOST_ITEMS {
            break;
        }
    }
    items
}

/// The object with a field, or the array of objects, that a text begins with, and its length.
fn leading_value(text: &str) -> Option<(Value, usize)> {
    // Most brackets of an answer that is no JSON are recognised by what follows them, which is quick.
    let next = text[1..].trim_start().bytes().next();
    let is_likely = if text.starts_with('{') { next == Some(b'"') } else { next == Some(b'{') };
    if !is_likely {
        return None;
    }
    let mut values = serde_json::Deserializer::from_str(text).into_iter::<Value>();
    let value = values.next()?.ok()?;
    Some((value, values.byte_offset()))
}

fn cut(text: &str) -> &str {
    let mut end = text.len().min(LONGEST_ANSWER);
    while !text.is_char_boundary(end) {
        end -= 1;
    }
    &text[..end]
}

/// The beginning of an answer, on one line.
pub(crate) fn excerpt(text: &str) -> String {
    let line = text.split_whitespace().collect::<Vec<_>>().join(" ");
    let mut excerpt: String = crate::quote::printable(&line).chars().take(EXCERPT).collect();
    if line.chars().count() > EXCERPT {
        excerpt.push_str(" ...");
    }
    excerpt
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn read(text: &str) -> Listing {
        listing(&Reply::saying(text), "proposals", "text", "L4D560")
    }

    #[test]
    fn prose_fences_and_wrapping_do_not_matter() {
        let item = json!({ "text": "The cat" });
        for text in [
            r#"{"proposals":[{"text":"The cat"}]}"#,
            "Sure! [1] Here {you} go:\n```json\n{\"proposals\": [{\"text\": \"The cat\"}]}\n```\nAnything else?",
            r#"[{"text":"The cat"}]"#,
            r#"{"answer":{"proposals":[{"text":"The cat"}]}}"#,
        ] {
            assert_eq!(read(text), Listing { items: vec![item.clone()], problem: None }, "{text}");
        }
        assert_eq!(read(r#"{"proposals":[]}"#), Listing { items: vec![], problem: None });
    }

    #[test]
    fn whole_items_of_half_a_list_are_kept() {
        let half = r#"{"proposals":[{"text":"a","frames":[[1,2]]},{"text":"b"},{"text":"c","fra"#;
        let found = read(half);
        let texts: Vec<&str> = found.items.iter().map(|item| item["text"].as_str().unwrap()).collect();
        assert_eq!(texts, ["a", "b"]);
        assert!(found.problem.unwrap().message.contains("2 whole items"));
        let cut = Reply { finish: Finish::Length, ..Reply::saying(half) };
        let problem = listing(&cut, "proposals", "text", "L4D560").problem.unwrap();
        assert!(problem.message.contains("limit of tokens"), "{problem:?}");
    }

    #[test]
    fn garbage_has_a_reason() {
        for (text, reason) in [
            ("", "is empty"),
            ("I am sorry, I see nothing.", "I am sorry, I see nothing."),
            ("{\"proposals\":", "no list"),
            ("{{{{[[[[]]}}", "no list"),
            ("<html><body>502</body></html>", "<html>"),
        ] {
            let found = read(text);
            assert!(found.items.is_empty(), "{text}");
            let problem = found.problem.unwrap();
            assert!(problem.message.contains(reason), "{text}: {problem:?}");
        }
        let refused = Reply { finish: Finish::Refused("no people".into()), ..Reply::saying("") };
        let problem = listing(&refused, "proposals", "text", "L4D560").problem.unwrap();
        assert_eq!(problem.message, "the model refused: no people");
    }

    #[test]
    fn an_absurd_answer_ends() {
        let deep = "{\"a\":[".repeat(2_000);
        assert!(read(&deep).items.is_empty());
        let many = format!("[{}]", vec![r#"{"text":"x"}"#; 1000].join(","));
        let found = read(&many);
        assert_eq!(found.items.len(), MOST_ITEMS);
        assert!(found.problem.unwrap().message.contains("1000 items"));
        let wide = "ä{".repeat(LONGEST_ANSWER);
        assert!(read(&wide).items.is_empty());
    }
}
