//! A stream of chunks, from servers that stream although asked not to, folded into the one document that was due.

use serde_json::{Value, json};

use crate::call::Response;

pub(super) fn is_stream(response: &Response) -> bool {
    response.header("content-type").is_some_and(|kind| kind.contains("text/event-stream"))
        || response.body.trim_start().starts_with("data:")
}

/// Folds `data:` lines; the error says why they make no answer.
pub(super) fn fold(body: &str) -> Result<Value, String> {
    let mut content = String::new();
    let mut reasoning = String::new();
    let mut folded = json!({});
    let mut finish = Value::Null;
    let mut done = false;
    let data = body.lines().filter_map(|line| line.strip_prefix("data:")).map(str::trim);
    for (index, line) in data.enumerate() {
        if line == "[DONE]" {
            done = true;
            break;
        }
        let chunk: Value = serde_json::from_str(line)
            .map_err(|error| format!("is a stream whose chunk {} is no JSON ({error})", index + 1))?;
        if !chunk["error"].is_null() {
            return Ok(chunk);
        }
        for field in ["model", "system_fingerprint", "usage"] {
            if !chunk[field].is_null() {
                folded[field] = chunk[field].clone();
            }
        }
        let choice = &chunk["choices"][0];
        let delta = if choice["delta"].is_object() { &choice["delta"] } else { &choice["message"] };
        content.push_str(delta["content"].as_str().unwrap_or_default());
        let thought = delta["reasoning_content"].as_str().or_else(|| delta["reasoning"].as_str());
        reasoning.push_str(thought.unwrap_or_default());
        if !choice["finish_reason"].is_null() {
            finish = choice["finish_reason"].clone();
        }
    }
    if !done && finish.is_null() {
        return Err("is a stream that ends early".to_owned());
    }
    let message = json!({ "content": content, "reasoning_content": reasoning });
    folded["choices"] = json!([{ "message": message, "finish_reason": finish }]);
    Ok(folded)
}
