//! Routes, and what is refused before it reaches them.

use std::net::SocketAddr;
use std::sync::Arc;

use axum::body::Bytes;
use axum::extract::rejection::JsonRejection;
use axum::extract::{DefaultBodyLimit, Path, Request, State};
use axum::http::header::{
    CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HOST, ORIGIN, REFERRER_POLICY,
    X_CONTENT_TYPE_OPTIONS,
};
use axum::http::{HeaderValue, StatusCode};
use axum::middleware::{Next, from_fn_with_state};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Json, Router};
use serde::Deserialize;
use serde_json::json;

use crate::desk::Desk;

/// Largest body of a request, bytes.
const MOST_BYTES: usize = 16 << 10;
/// Longest sentence, characters.
pub(crate) const LONGEST: usize = 500;
/// The page is one file: nothing is fetched from anywhere else, and no other page may show it in a frame.
const POLICY: &str = "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; \
                      connect-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";

/// The routes, for requests to this address.
pub(crate) fn of(page: Vec<u8>, desk: Arc<Desk>, address: SocketAddr) -> Router {
    let page = Bytes::from(page);
    let shown = move || {
        let page = page.clone();
        async move { ([(CONTENT_TYPE, "text/html; charset=utf-8")], page) }
    };
    Router::new()
        .route("/", get(shown))
        .route("/questions", post(ask))
        .route("/questions/{id}", get(state))
        .fallback(|| async { refusal(StatusCode::NOT_FOUND, "there is nothing here", "open /") })
        .with_state(desk)
        .layer(DefaultBodyLimit::max(MOST_BYTES))
        .layer(from_fn_with_state(address, guard))
}

/// Lets through what pages of this address ask, and adds what browsers must know of every answer.
async fn guard(State(address): State<SocketAddr>, request: Request, next: Next) -> Response {
    let mut response = if is_from(&request, address) {
        next.run(request).await
    } else {
        let hint = "open the page at the address that l4d printed";
        refusal(StatusCode::FORBIDDEN, "only the page of this server may ask", hint)
    };
    let headers = response.headers_mut();
    headers.insert(CONTENT_SECURITY_POLICY, HeaderValue::from_static(POLICY));
    headers.insert(X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    headers.insert(REFERRER_POLICY, HeaderValue::from_static("no-referrer"));
    headers.insert(CACHE_CONTROL, HeaderValue::from_static("no-store"));
    response
}

/// Whether a request names this address as its host and, if it has one, as its origin.
fn is_from(request: &Request, address: SocketAddr) -> bool {
    let port = address.port();
    let hosts = [format!("127.0.0.1:{port}"), format!("localhost:{port}")];
    let header = |name| request.headers().get(name).map(HeaderValue::as_bytes);
    let is_host = |found: Option<&[u8]>| hosts.iter().any(|host| found == Some(host.as_bytes()));
    is_host(header(HOST)) && header(ORIGIN).is_none_or(|origin| is_host(origin.strip_prefix(b"http://")))
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Question {
    text: String,
}

async fn ask(State(desk): State<Arc<Desk>>, body: Result<Json<Question>, JsonRejection>) -> Response {
    let Json(Question { text }) = match body {
        Ok(question) => question,
        Err(error) => return refusal(error.status(), &error.body_text(), "send {\"text\": \"...\"} as JSON"),
    };
    let text = text.trim();
    if text.is_empty() || text.chars().count() > LONGEST {
        let message = format!("a sentence has 1 to {LONGEST} characters");
        return refusal(StatusCode::UNPROCESSABLE_ENTITY, &message, "say what is meant, in one sentence");
    }
    match desk.ask(text.to_owned()) {
        Some(id) => (StatusCode::ACCEPTED, Json(json!({ "id": id }))).into_response(),
        None => refusal(StatusCode::TOO_MANY_REQUESTS, "too many questions wait", "wait for their answers"),
    }
}

async fn state(State(desk): State<Arc<Desk>>, Path(id): Path<String>) -> Response {
    let found = id.parse().ok().and_then(|id| desk.state(id));
    found.map_or_else(
        || refusal(StatusCode::NOT_FOUND, "there is no such question", "ask it again"),
        |state| Json(state).into_response(),
    )
}

fn refusal(status: StatusCode, message: &str, hint: &str) -> Response {
    (status, Json(json!({ "message": message, "hint": hint }))).into_response()
}
