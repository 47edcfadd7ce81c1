//! How a question is spelled for a server and how its answer is read back.

mod ollama;
mod openai;
mod sse;

use serde_json::{Value, json};

use crate::call::{Call, Response};
use crate::config::Endpoint;
use crate::error::{EndpointError, excerpt};
use crate::learned::Learned;
use crate::message::Image;
use crate::reply::{Finish, Usage};
use crate::request::Request;
use crate::retry::retry_after;
use crate::server::Dialect;

/// What a model said, before anybody knows where the answer came from.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct Said {
    pub(crate) text: String,
    pub(crate) finish: Option<Finish>,
    pub(crate) usage: Usage,
    pub(crate) model: Option<String>,
    pub(crate) fingerprint: Option<String>,
    pub(crate) notes: Vec<String>,
}

/// Spells a question.
pub(crate) fn chat(endpoint: &Endpoint, request: &Request, learned: &Learned) -> Call {
    let spell = |picture: &dyn Fn(&Image) -> String| {
        let mut body = match endpoint.kind().dialect {
            Dialect::Openai => openai::body(endpoint, request, picture),
            Dialect::Ollama => ollama::body(endpoint, request, picture),
        };
        learned.apply(&mut body);
        body
    };
    let (route, body) = match endpoint.kind().dialect {
        Dialect::Openai => ("chat/completions", spell(&openai::data_url)),
        Dialect::Ollama => ("api/chat", spell(&ollama::base64)),
    };
    let bare = spell(&|image: &Image| format!("{} sha256 {}", image.mime(), image.digest()));
    let mut identity = json!({ "route": route, "body": bare });
    if !endpoint.headers.is_empty() {
        identity["headers"] = json!(endpoint.headers);
    }
    if request.repeat > 0 {
        identity["repeat"] = request.repeat.into();
    }
    Call::post(endpoint.url(route), &body, identity)
}

/// Asks for the list of models.
pub(crate) fn models(endpoint: &Endpoint) -> Call {
    let route = match endpoint.kind().dialect {
        Dialect::Openai => "models",
        Dialect::Ollama => "api/tags",
    };
    Call::get(endpoint.url(route), route)
}

/// Reads what a model said.
pub(crate) fn read_chat(
    endpoint: &Endpoint,
    call: &Call,
    response: &Response,
) -> Result<Said, EndpointError> {
    let (document, streamed) = read_json(call, response)?;
    let mut said = match endpoint.kind().dialect {
        Dialect::Openai => openai::said(&document),
        Dialect::Ollama => ollama::said(&document),
    }
    .map_err(|message| protocol(call, message, response))?;
    if streamed {
        said.notes.push("the server streamed although it was asked not to".to_owned());
    }
    Ok(said)
}

/// Reads the list of models.
pub(crate) fn read_models(
    endpoint: &Endpoint,
    call: &Call,
    response: &Response,
) -> Result<Vec<String>, EndpointError> {
    let (document, _) = read_json(call, response)?;
    let (list, name) = match endpoint.kind().dialect {
        Dialect::Openai => ("data", "id"),
        Dialect::Ollama => ("models", "name"),
    };
    let models = document[list].as_array();
    let models = models.ok_or_else(|| protocol(call, format!("has no list `{list}`"), response))?;
    Ok(models.iter().filter_map(|model| model[name].as_str()).map(str::to_owned).collect())
}

/// The document of a success, and whether it came as a stream.
fn read_json(call: &Call, response: &Response) -> Result<(Value, bool), EndpointError> {
    let url = || call.url.clone();
    let status = response.status;
    if !response.is_success() {
        return Err(failure(call, response));
    }
    if is_web_page(response) {
        return Err(EndpointError::WebPage { url: url(), status, title: title(&response.body) });
    }
    let streamed = sse::is_stream(response);
    let document = if streamed {
        sse::fold(&response.body).map_err(|message| protocol(call, message, response))?
    } else {
        serde_json::from_str(&response.body)
            .map_err(|error| protocol(call, format!("is no whole JSON document ({error})"), response))?
    };
    match error_in(&document) {
        Some((message, code)) => Err(EndpointError::ErrorBody { url: url(), status, code, message }),
        None => Ok((document, streamed)),
    }
}

fn failure(call: &Call, response: &Response) -> EndpointError {
    let url = call.url.clone();
    let status = response.status;
    if (300..400).contains(&status) {
        return EndpointError::Redirect { url, status, target: target(response) };
    }
    let retry_after = retry_after(response);
    let message = match serde_json::from_str(&response.body) {
        Ok(document) => error_in(&document).map_or_else(|| excerpt(&response.body), |(message, _)| message),
        Err(_) if is_web_page(response) => {
            format!("a web page, {}", title(&response.body).unwrap_or_else(|| "without a title".to_owned()))
        }
        Err(_) => excerpt(&response.body),
    };
    match status {
        429 => EndpointError::RateLimit { url, status, retry_after, message },
        _ => EndpointError::Status { url, status, retry_after, message },
    }
}

/// The error that a document speaks of, however it is wrapped, with the status that it names.
fn error_in(document: &Value) -> Option<(String, Option<u16>)> {
    let document = if let Value::Array(items) = document { items.first()? } else { document };
    let is_answer = document["message"].is_object()
        || ["choices", "data", "models"].iter().any(|field| document[*field].is_array());
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

fn protocol(call: &Call, message: impl Into<String>, response: &Response) -> EndpointError {
    let excerpt = excerpt(&response.body);
    let excerpt = if excerpt.is_empty() { "(empty)".to_owned() } else { excerpt };
    EndpointError::Protocol { url: call.url.clone(), message: message.into(), excerpt }
}

fn is_web_page(response: &Response) -> bool {
    let start: String = response.body.trim_start().chars().take(15).collect::<String>().to_lowercase();
    response.header("content-type").is_some_and(|kind| kind.contains("text/html"))
        || start.starts_with("<!doctype html")
        || start.starts_with("<html")
}

fn title(page: &str) -> Option<String> {
    // Lowered letter by letter, so that places in both texts agree.
    let lower = page.to_ascii_lowercase();
    let start = lower.find("<title")?;
    let start = start + lower[start..].find('>')? + 1;
    let end = start + lower[start..].find("</title")?;
    Some(excerpt(&page[start..end])).filter(|title| !title.is_empty())
}

/// Scheme and host alone: the rest of such a URL may be a secret of its own.
fn target(response: &Response) -> String {
    let uri = response.header("location").and_then(|target| target.parse::<ureq::http::Uri>().ok());
    let host = uri.as_ref().and_then(|uri| Some(format!("{}://{}", uri.scheme_str()?, uri.host()?)));
    host.unwrap_or_else(|| "another path of the same host".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_are_found_in_every_wrapping() {
        let cases = [
            (json!({"error": {"message": "boom", "code": 503}}), Some(("boom", Some(503)))),
            (json!({"error": "boom"}), Some(("boom", None))),
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
            (json!({"message": {"content": "fine"}}), None),
            (json!({"choices": [{}], "detail": "fine"}), None),
            (json!(3), None),
        ];
        for (document, expected) in cases {
            let expected = expected.map(|(message, code)| (message.to_owned(), code));
            assert_eq!(error_in(&document), expected, "{document}");
        }
    }

    #[test]
    fn titles_are_found_whatever_their_case() {
        assert_eq!(title("<HTML><Title a=b>\n502 Bad Gateway\n</TITLE>").as_deref(), Some("502 Bad Gateway"));
        assert_eq!(title("<title>never ends"), None);
        assert_eq!(title("İ<title>ä</title>").as_deref(), Some("ä"));
    }
}
