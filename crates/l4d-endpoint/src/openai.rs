//! The OpenAI protocol: how a question is written for a server, and how its answer is read back.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Map, Value, json};
use ureq::http::Uri;

use crate::config::Endpoint;
use crate::error::{EndpointError, Failure, excerpt};
use crate::exchange::{Call, Response};
use crate::reply::{Finish, Origin, Reply, Usage, without_thinking};
use crate::request::{Image, Message, Part, Request};
use crate::retry::{is_passing, retry_after};

/// The call that asks a question.
pub(crate) fn chat(endpoint: &Endpoint, request: &Request) -> Call {
    let route = "chat/completions";
    let sent = body(endpoint, request, &|image| {
        format!("data:{};base64,{}", image.mime(), STANDARD.encode(image.bytes()))
    });
    let bare = body(endpoint, request, &|image| format!("{} sha256 {}", image.mime(), image.digest()));
    let mut identity = json!({ "route": route, "body": bare });
    if request.repeat > 0 {
        identity["repeat"] = request.repeat.into();
    }
    Call::new(endpoint.url(route), Some(sent.to_string().into_bytes()), identity)
}

fn body(endpoint: &Endpoint, request: &Request, picture: &dyn Fn(&Image) -> String) -> Value {
    let messages: Vec<Value> = request.messages.iter().map(|message| written(message, picture)).collect();
    // OpenAI's newer models insist on the newer name.
    let max_tokens = if endpoint.server == "openai" { "max_completion_tokens" } else { "max_tokens" };
    let mut body = Map::new();
    let mut set = |name: &str, value: Value| body.insert(name.to_owned(), value);
    set("model", endpoint.model.as_str().into());
    set("messages", messages.into());
    set(max_tokens, request.max_tokens.into());
    if let Some(temperature) = request.temperature {
        set("temperature", temperature.into());
    }
    if let Some(seed) = request.seed {
        set("seed", seed.into());
    }
    if let Some(schema) = &request.schema {
        let schema = json!({ "name": schema.name, "strict": true, "schema": schema.value });
        set("response_format", json!({ "type": "json_schema", "json_schema": schema }));
    }
    set("stream", false.into());
    for field in &endpoint.omit {
        body.shift_remove(field);
    }
    body.extend(endpoint.body.iter().map(|(name, value)| (name.clone(), value.clone())));
    body.into()
}

fn written(message: &Message, picture: &dyn Fn(&Image) -> String) -> Value {
    let written_part = |part: &Part| match part {
        Part::Text(text) => json!({ "type": "text", "text": text }),
        Part::Image(image) => json!({ "type": "image_url", "image_url": { "url": picture(image) } }),
    };
    let content: Value = match message.parts.as_slice() {
        // Servers without pictures know content as a string alone.
        [Part::Text(text)] => text.as_str().into(),
        parts => parts.iter().map(written_part).collect(),
    };
    json!({ "role": message.role, "content": content })
}

/// Reads what a model said.
pub(crate) fn read_chat(call: &Call, response: &Response) -> Result<Reply, EndpointError> {
    let document = read_json(call, response)?;
    let message = &document["choices"][0]["message"];
    if !message.is_object() {
        return Err(garbage(call, "has no `choices[0].message`", response).into());
    }
    // Some servers put the whole answer where the thinking belongs.
    let texts = ["content", "reasoning_content", "reasoning"].map(|field| text_of(&message[field]));
    let text = texts.into_iter().find(|text| !text.trim().is_empty()).unwrap_or_default();
    let usage = &document["usage"];
    Ok(Reply {
        text: without_thinking(&text).to_owned(),
        finish: finish(&document["choices"][0]["finish_reason"], &message["refusal"]),
        usage: Usage {
            prompt_tokens: usage["prompt_tokens"].as_u64(),
            completion_tokens: usage["completion_tokens"].as_u64(),
        },
        model: document["model"].as_str().map(str::to_owned),
        origin: Origin::Server,
        digest: call.digest.clone(),
        notes: Vec::new(),
    })
}

fn finish(reason: &Value, refusal: &Value) -> Finish {
    if let Some(words) = refusal.as_str().filter(|words| !words.is_empty()) {
        return Finish::Refused(words.to_owned());
    }
    match reason.as_str() {
        Some("length" | "max_tokens") => Finish::Length,
        Some("content_filter" | "safety") => Finish::Refused("a content filter of the server".to_owned()),
        _ => Finish::Stop,
    }
}

/// Content is a string, or a list of parts with strings.
fn text_of(content: &Value) -> String {
    match content {
        Value::String(text) => text.clone(),
        Value::Array(parts) => parts.iter().filter_map(|part| part["text"].as_str()).collect(),
        _ => String::new(),
    }
}

/// The document of a success.
fn read_json(call: &Call, response: &Response) -> Result<Value, Failure> {
    if !response.is_success() {
        return Err(failure(call, response));
    }
    if is_web_page(response) {
        let message = format!("HTTP {}: the server sent a web page", response.status);
        return Err(Failure::lasting(
            &call.url,
            message,
            "`base_url` is probably not the root of the protocol: it often ends in /v1; a proxy or login page may \
             stand between",
        ));
    }
    let document = serde_json::from_str(&response.body)
        .map_err(|error| garbage(call, &format!("is no whole JSON document ({error})"), response))?;
    match error_in(&document) {
        Some((message, code)) => {
            let message = format!("HTTP {}, but the body is an error: {message}", response.status);
            let hint = "see the server's own log";
            let is_passing = code.is_some_and(is_passing);
            Err(Failure { is_passing, ..Failure::lasting(&call.url, message, hint) })
        }
        None => Ok(document),
    }
}

const CHECK_KEY: &str = "check the key in the variable that `api_key_env` names, and what it may do";

fn failure(call: &Call, response: &Response) -> Failure {
    let status = response.status;
    if (300..400).contains(&status) {
        let message = format!("HTTP {status}: the server points to {}", target(response));
        let hint =
            "set `base_url` to where the server points, if you trust it: keys are not sent after a redirect";
        return Failure::lasting(&call.url, message, hint);
    }
    // What the body says is not shown: it may hold the key.
    let (meaning, hint) = match status {
        401 => ("the key is missing or wrong", CHECK_KEY),
        403 => ("the key is not allowed to do this", CHECK_KEY),
        404 => (
            "the path or the model is not there",
            "check `base_url` (it often ends in /v1) and `model`: the server lists its models under <base_url>/models",
        ),
        413 => ("the question is too large", "send fewer or smaller pictures"),
        429 => (
            "the limit of questions, or the quota, is used up",
            "wait, use fewer --jobs, or ask the provider for a higher limit; answers so far are in the cache",
        ),
        400 | 422 => (
            "the server does not take the question as it is",
            "its own log says which field it rejects: name that under `omit` of the endpoint file",
        ),
        408 | 504 => ("the server gave up waiting", "see the server's own log"),
        502 | 503 => ("the server is overloaded or not there", "see the server's own log"),
        500.. => ("the server failed", "see the server's own log"),
        _ => ("an error", "see the server's own log"),
    };
    Failure {
        is_passing: is_passing(status),
        retry_after: retry_after(response),
        ..Failure::lasting(&call.url, format!("HTTP {status}: {meaning}"), hint)
    }
}

fn garbage(call: &Call, message: &str, response: &Response) -> Failure {
    let body = excerpt(&response.body);
    let body = if body.is_empty() { "(empty)" } else { &body };
    let message = format!("the answer {message}: {body}");
    Failure::lasting(
        &call.url,
        message,
        "check `base_url`, and that the server speaks the OpenAI protocol without streaming",
    )
}

/// The error that a document speaks of, however it is wrapped, with the status that it names.
fn error_in(document: &Value) -> Option<(String, Option<u16>)> {
    let document = if let Value::Array(items) = document { items.first()? } else { document };
    let is_answer = ["choices", "data"].iter().any(|field| document[*field].is_array());
    let candidates = match (&document["error"], is_answer) {
        (Value::Null, true) => return None,
        (Value::Null, false) => [&document["detail"], &document["message"]],
        (error, _) => [error, &Value::Null],
    };
    let error = candidates.into_iter().find(|error| !error.is_null())?;
    let message = [&error["message"], &error["msg"], error].into_iter().find(|text| !text.is_null())?;
    let message = message.as_str().map_or_else(|| message.to_string(), str::to_owned);
    let code = [&error["code"], &error["status"], &document["code"]].into_iter().find_map(|code| {
        let code = code.as_u64().or_else(|| code.as_str()?.parse().ok())?;
        u16::try_from(code).ok().filter(|code| (100..600).contains(code))
    });
    Some((excerpt(&message), code))
}

fn is_web_page(response: &Response) -> bool {
    let start: String = response.body.trim_start().chars().take(15).collect::<String>().to_lowercase();
    response.header("content-type").is_some_and(|kind| kind.contains("text/html"))
        || start.starts_with("<!doctype html")
        || start.starts_with("<html")
}

/// Scheme and host alone: the rest of such a URL may be a secret of its own.
fn target(response: &Response) -> String {
    let uri = response.header("location").and_then(|target| target.parse::<Uri>().ok());
    let host = uri.and_then(|uri| Some(format!("{}://{}", uri.scheme_str()?, uri.host()?)));
    host.unwrap_or_else(|| "another path of the same host".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_found_in_every_wrapping() {
        let cases = [
            (
                json!([{"error": {"message": "boom", "status": "UNAVAILABLE", "code": "429"}}]),
                Some(("boom", Some(429))),
            ),
            (json!({"object": "error", "message": "boom", "code": 400}), Some(("boom", Some(400)))),
            (
                json!({"detail": [{"loc": ["body", "seed"], "msg": "boom"}]}),
                Some((r#"[{"loc":["body","seed"],"msg":"boom"}]"#, None)),
            ),
            (json!({"choices": [], "error": {"message": "boom"}}), Some(("boom", None))),
            (json!({"choices": [], "error": null}), None),
            (json!({"choices": [{}], "detail": "fine"}), None),
            (json!(3), None),
        ];
        for (document, expected) in cases {
            let expected = expected.map(|(message, code)| (message.to_owned(), code));
            assert_eq!(error_in(&document), expected, "{document}");
        }
    }
}
