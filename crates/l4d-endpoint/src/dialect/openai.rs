//! The OpenAI protocol's chat completions, as all its imitators speak it.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Map, Value, json};

use super::Said;
use crate::config::Endpoint;
use crate::message::{Image, Message, Part};
use crate::reply::{Finish, Usage};
use crate::request::Request;
use crate::server::MaxTokensField;

pub(super) fn data_url(image: &Image) -> String {
    format!("data:{};base64,{}", image.mime(), STANDARD.encode(image.bytes()))
}

pub(super) fn body(endpoint: &Endpoint, request: &Request, picture: &dyn Fn(&Image) -> String) -> Value {
    let messages: Vec<Value> = request.messages.iter().map(|message| spelled(message, picture)).collect();
    let mut body = Map::new();
    body.insert("model".to_owned(), endpoint.model.as_str().into());
    body.insert("messages".to_owned(), messages.into());
    let max_tokens = match endpoint.kind().max_tokens {
        MaxTokensField::MaxTokens => "max_tokens",
        MaxTokensField::MaxCompletionTokens => "max_completion_tokens",
    };
    body.insert(max_tokens.to_owned(), request.max_tokens.into());
    if let Some(temperature) = request.temperature {
        body.insert("temperature".to_owned(), temperature.into());
    }
    if let Some(seed) = request.seed {
        body.insert("seed".to_owned(), seed.into());
    }
    if let Some(schema) = &request.schema {
        let schema = json!({ "name": schema.name, "strict": true, "schema": schema.value });
        body.insert("response_format".to_owned(), json!({ "type": "json_schema", "json_schema": schema }));
    }
    body.insert("stream".to_owned(), false.into());
    body.extend(endpoint.body.iter().map(|(name, value)| (name.clone(), value.clone())));
    body.into()
}

fn spelled(message: &Message, picture: &dyn Fn(&Image) -> String) -> Value {
    let content: Value = match message.parts.as_slice() {
        // Servers without pictures know content as a string alone.
        [Part::Text(text)] => text.as_str().into(),
        parts => parts.iter().map(|part| spelled_part(part, picture)).collect(),
    };
    json!({ "role": message.role.as_str(), "content": content })
}

fn spelled_part(part: &Part, picture: &dyn Fn(&Image) -> String) -> Value {
    match part {
        Part::Text(text) => json!({ "type": "text", "text": text }),
        Part::Image(image) => json!({ "type": "image_url", "image_url": { "url": picture(image) } }),
    }
}

/// Reads a completion; the error says what is missing.
pub(super) fn said(document: &Value) -> Result<Said, String> {
    let choice = document["choices"].get(0).ok_or("has no `choices`")?;
    let message = &choice["message"];
    if !message.is_object() {
        return Err("has no `choices[0].message`".to_owned());
    }
    let content = text_of(&message["content"]);
    // Some servers put the whole answer where the thinking belongs.
    let thinking = || ["reasoning_content", "reasoning"].map(|field| text_of(&message[field]));
    let text = Some(content)
        .filter(|text| !text.trim().is_empty())
        .or_else(|| thinking().into_iter().find(|text| !text.trim().is_empty()));
    let usage = &document["usage"];
    let text_in = |field: &str| document[field].as_str().map(str::to_owned);
    Ok(Said {
        text: text.unwrap_or_default(),
        finish: finish(&choice["finish_reason"], &message["refusal"]),
        usage: Usage {
            prompt_tokens: usage["prompt_tokens"].as_u64(),
            completion_tokens: usage["completion_tokens"].as_u64(),
            reasoning_tokens: usage["completion_tokens_details"]["reasoning_tokens"].as_u64(),
        },
        model: text_in("model"),
        fingerprint: text_in("system_fingerprint"),
        notes: Vec::new(),
    })
}

fn finish(reason: &Value, refusal: &Value) -> Option<Finish> {
    if let Some(words) = refusal.as_str().filter(|words| !words.is_empty()) {
        return Some(Finish::Refused(words.to_owned()));
    }
    Some(match reason.as_str()? {
        "stop" | "eos" | "end_turn" => Finish::Stop,
        "length" | "max_tokens" => Finish::Length,
        "content_filter" | "safety" => Finish::Refused("a content filter of the server".to_owned()),
        other => Finish::Other(other.to_owned()),
    })
}

/// Content is a string, or a list of parts with strings.
fn text_of(content: &Value) -> String {
    match content {
        Value::String(text) => text.clone(),
        Value::Array(parts) => parts.iter().filter_map(|part| part["text"].as_str()).collect(),
        _ => String::new(),
    }
}
