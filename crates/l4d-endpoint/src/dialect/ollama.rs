//! Ollama's own protocol.
//!
//! Its imitation of the OpenAI protocol turns each part of a message into a message of its own, cuts the context
//! to a default that cannot be set there, and drops messages from the front when they do not fit: the first
//! pictures are lost without a word. Here the context is stated, and the pictures stay with their message.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Map, Value, json};

use super::Said;
use crate::budget::estimate;
use crate::config::Endpoint;
use crate::message::{Image, Message, Part};
use crate::reply::{Finish, Usage};
use crate::request::Request;

/// Contexts grow in steps of this many tokens, so that a server does not reload its model for every question.
const CONTEXT_STEP: u64 = 4096;

pub(super) fn base64(image: &Image) -> String {
    STANDARD.encode(image.bytes())
}

pub(super) fn body(endpoint: &Endpoint, request: &Request, picture: &dyn Fn(&Image) -> String) -> Value {
    let mut count = 0;
    let messages: Vec<Value> =
        request.messages.iter().map(|message| spelled(message, &mut count, picture)).collect();
    let mut options = Map::new();
    options.insert("num_ctx".to_owned(), context(endpoint, request).into());
    options.insert("num_predict".to_owned(), request.max_tokens.into());
    if let Some(temperature) = request.temperature {
        options.insert("temperature".to_owned(), temperature.into());
    }
    if let Some(seed) = request.seed {
        options.insert("seed".to_owned(), seed.into());
    }
    let mut body = Map::new();
    body.insert("model".to_owned(), endpoint.model.as_str().into());
    body.insert("messages".to_owned(), messages.into());
    body.insert("options".to_owned(), options.into());
    if let Some(schema) = &request.schema {
        body.insert("format".to_owned(), schema.value.clone());
    }
    body.insert("stream".to_owned(), false.into());
    body.extend(endpoint.body.iter().map(|(name, value)| (name.clone(), value.clone())));
    body.into()
}

/// The estimate errs high, and a quarter more costs memory alone; a context that is too small costs pictures.
fn context(endpoint: &Endpoint, request: &Request) -> u64 {
    let needed = estimate(endpoint, request);
    let needed = (needed.prompt + needed.prompt / 4).saturating_add(needed.completion);
    endpoint.limits.context_tokens.unwrap_or_else(|| needed.next_multiple_of(CONTEXT_STEP))
}

/// Pictures stand before the text there, so the text says which one belongs where.
fn spelled(message: &Message, count: &mut usize, picture: &dyn Fn(&Image) -> String) -> Value {
    let mut lines = Vec::new();
    let mut images = Vec::new();
    for part in &message.parts {
        match part {
            Part::Text(text) => lines.push(text.clone()),
            Part::Image(image) => {
                *count += 1;
                lines.push(format!("[picture {count}]"));
                images.push(picture(image));
            }
        }
    }
    let mut spelled = json!({ "role": message.role.as_str(), "content": lines.join("\n") });
    if !images.is_empty() {
        spelled["images"] = images.into();
    }
    spelled
}

/// Reads an answer; the error says what is missing.
pub(super) fn said(document: &Value) -> Result<Said, String> {
    let message = &document["message"];
    if !message.is_object() {
        return Err("has no `message`".to_owned());
    }
    let text = |field: &str| message[field].as_str().unwrap_or_default().to_owned();
    let content = text("content");
    let finish = document["done_reason"].as_str().map(|reason| match reason {
        "stop" => Finish::Stop,
        "length" => Finish::Length,
        other => Finish::Other(other.to_owned()),
    });
    Ok(Said {
        text: if content.trim().is_empty() { text("thinking") } else { content },
        finish,
        usage: Usage {
            prompt_tokens: document["prompt_eval_count"].as_u64(),
            completion_tokens: document["eval_count"].as_u64(),
            reasoning_tokens: None,
        },
        model: document["model"].as_str().map(str::to_owned),
        fingerprint: None,
        notes: Vec::new(),
    })
}
