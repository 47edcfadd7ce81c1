//! Every way in which a server can fail, played by a scripted one.
#![expect(clippy::unwrap_used, reason = "a test that cannot go on should stop where it stands")]

mod common;
mod scripted;

use std::time::{Duration, Instant};

use common::{client, endpoint, patient, question};
use l4d_endpoint::error::Fault;
use l4d_endpoint::{Client, EndpointError, Finish, Kind, Link};
use scripted::{Server, Turn, completion, ok, says, status};
use serde_json::{Value, json};

/// Asks a server that plays these turns.
fn ask(turns: Vec<Turn>) -> (Result<l4d_endpoint::Reply, EndpointError>, usize) {
    let server = Server::start(turns);
    let result = client(&server).ask(&question("hello"));
    (result, server.count())
}

fn failure(turns: Vec<Turn>) -> (EndpointError, usize) {
    let (result, count) = ask(turns);
    let error = result.unwrap_err();
    assert!(!error.hint().is_empty(), "{error} has no remedy");
    (error, count)
}

fn page(status: u16, body: &str) -> Turn {
    Turn::Say(status, vec![("content-type", "text/html".to_owned())], body.to_owned())
}

fn limited(retry_after: &str) -> Turn {
    let headers = vec![("retry-after", retry_after.to_owned())];
    Turn::Say(429, headers, json!({"error": {"message": "slow down"}}).to_string())
}

#[test]
fn a_server_that_is_down() {
    let port = Server::start(vec![says("x")]).port;
    let client = Client::open(patient(&format!("http://127.0.0.1:{port}/v1")), &Link::Live).unwrap();
    let error = client.ask(&question("hello")).unwrap_err();
    assert!(matches!(error, EndpointError::Transport { fault: Fault::NoConnection, .. }), "{error:?}");
    assert!(error.hint().contains("start the server"));
    assert!(error.to_string().contains(&port.to_string()));
}

#[test]
fn a_host_that_does_not_exist() {
    let client = Client::open(patient("http://no-such-host.invalid/v1"), &Link::Live).unwrap();
    let error = client.ask(&question("hello")).unwrap_err();
    assert_eq!(error.kind(), Kind::Transport);
}

#[test]
fn a_slow_server_gets_its_time_and_no_more() {
    let slow = Turn::Late(Duration::from_secs(5), Box::new(says("too late")));
    let server = Server::start(vec![slow.clone(), says("in time")]);
    let mut endpoint = endpoint(&server);
    endpoint.timeouts.request_seconds = 0.3;
    let patient = Client::open(endpoint.clone(), &Link::Live).unwrap();
    assert_eq!(patient.ask(&question("hello")).unwrap().text, "in time");

    let server = Server::start(vec![slow]);
    endpoint.base_url = server.url().parse().unwrap();
    endpoint.timeouts.total_seconds = 0.8;
    endpoint.retry.tries = 100;
    let start = Instant::now();
    let error = Client::open(endpoint, &Link::Live).unwrap().ask(&question("hello")).unwrap_err();
    assert!(matches!(error, EndpointError::Transport { fault: Fault::Timeout, .. }), "{error:?}");
    assert!(start.elapsed() < Duration::from_secs(3), "{:?}", start.elapsed());
    assert!((2..=5).contains(&server.count()), "{}", server.count());
}

#[test]
fn a_trickle_is_bounded_by_the_same_time() {
    let server = Server::start(vec![Turn::Trickle]);
    let mut endpoint = endpoint(&server);
    endpoint.timeouts.request_seconds = 0.5;
    endpoint.retry.tries = 1;
    let start = Instant::now();
    let error = Client::open(endpoint, &Link::Live).unwrap().ask(&question("hello")).unwrap_err();
    assert!(matches!(error, EndpointError::Transport { fault: Fault::Timeout, .. }), "{error:?}");
    assert!(start.elapsed() < Duration::from_secs(3), "{:?}", start.elapsed());
}

#[test]
fn connections_that_end_early_are_tried_again() {
    for broken in [Turn::Cut, Turn::Reset, Turn::Raw(Vec::new())] {
        let (result, count) = ask(vec![broken.clone(), broken.clone(), says("there")]);
        assert_eq!((result.unwrap().text.as_str(), count), ("there", 3));
        let (error, count) = failure(vec![broken]);
        assert!(matches!(error, EndpointError::Transport { fault: Fault::Reset, .. }), "{error:?}");
        assert_eq!(count, 3);
    }
}

#[test]
fn a_connection_that_the_server_ends_after_an_answer_is_not_used_again() {
    let server = Server::start(vec![Turn::Last(completion("there").to_string())]);
    let mut endpoint = endpoint(&server);
    endpoint.retry.tries = 1;
    let client = Client::open(endpoint, &Link::Live).unwrap();
    for text in ["a", "b", "c", "d"] {
        assert_eq!(client.ask(&question(text)).unwrap().text, "there");
    }
    assert_eq!(server.count(), 4);
}

#[test]
fn garbage_is_named_and_not_asked_for_again() {
    let binary = Turn::Say(200, Vec::new(), "\u{1}\u{2}\u{fffd} not json".to_owned());
    for (turn, words) in [
        (Turn::Raw(b"SSH-2.0-OpenSSH_9.9\r\n\r\n".to_vec()), "not HTTP"),
        (binary, "no whole JSON document"),
        (Turn::Say(200, Vec::new(), String::new()), "(empty)"),
        (
            Turn::Say(200, Vec::new(), r#"{"choices": [{"message": {"con"#.to_owned()),
            "no whole JSON document",
        ),
        (ok(&json!({"choices": []})), "no `choices`"),
        (ok(&json!({"choices": [{"text": "old protocol"}]})), "no `choices[0].message`"),
        (ok(&json!({"answer": 42})), "no `choices`"),
        (ok(&json!([1, 2])), "no `choices`"),
    ] {
        let (error, count) = failure(vec![turn]);
        assert!(matches!(error, EndpointError::Protocol { .. }), "{error:?}");
        assert!(error.to_string().contains(words), "{error}");
        assert!(!error.to_string().contains('\u{1}'));
        assert_eq!((count, error.kind()), (1, Kind::Garbage));
    }
}

#[test]
fn a_stream_that_nobody_asked_for_is_put_together() {
    let chunk = |value: &Value| format!("data: {value}\n\n");
    let delta = |text: &str| json!({"model": "m", "choices": [{"delta": {"content": text}}]});
    let head = vec![("content-type", "text/event-stream".to_owned())];
    let start = format!(": ping\n\n{}{}", chunk(&delta("Hello, ")), chunk(&delta("world")));
    let last = json!({"choices": [{"delta": {}, "finish_reason": "stop"}], "usage": {"prompt_tokens": 3}});
    let whole = format!("{start}{}data: [DONE]\n\n", chunk(&last));
    let reply = ask(vec![Turn::Say(200, head.clone(), whole)]).0.unwrap();
    assert_eq!((reply.text.as_str(), reply.usage.prompt_tokens), ("Hello, world", Some(3)));
    assert!(reply.notes[0].contains("streamed"));

    let (error, _) = failure(vec![Turn::Say(200, head.clone(), start.clone())]);
    assert!(error.to_string().contains("ends early"), "{error}");
    let (error, _) = failure(vec![Turn::Say(200, head.clone(), format!("{start}data: {{\"choi"))]);
    assert!(error.to_string().contains("chunk 3 is no JSON"), "{error}");
    let boom = chunk(&json!({"error": {"message": "out of memory"}}));
    let (error, _) = failure(vec![Turn::Say(200, head, format!("{start}{boom}"))]);
    assert!(matches!(error, EndpointError::ErrorBody { .. }) && error.to_string().contains("out of memory"));
}

#[test]
fn half_a_json_answer_and_other_shapes() {
    let json_of = |text: &str| ask(vec![says(text)]).0.unwrap().json::<Value>();
    assert!(matches!(json_of(r#"{"boxes": [[1, 2"#), Err(EndpointError::HalfJson { .. })));
    assert!(matches!(json_of("I would rather not."), Err(EndpointError::NoJson { .. })));
    assert!(matches!(json_of("  "), Err(EndpointError::Empty)));
    assert!(matches!(json_of("<think>hm"), Err(EndpointError::Empty)));
    assert_eq!(json_of("<think>{}</think>```json\n[7]\n```").unwrap(), json!([7]));
}

#[test]
fn cut_refused_and_displaced_answers() {
    let edited = |edit: &dyn Fn(&mut Value)| {
        let mut body = completion("[1, 2");
        edit(&mut body["choices"][0]);
        ask(vec![ok(&body)]).0.unwrap()
    };
    let cut = edited(&|choice| choice["finish_reason"] = "length".into());
    assert_eq!(cut.finish, Finish::Length);
    assert!(matches!(cut.json::<Value>(), Err(EndpointError::Truncated { .. })));
    let refused = edited(&|choice| choice["message"]["refusal"] = "I will not.".into());
    assert_eq!(refused.whole().unwrap_err().kind(), Kind::Refused);
    let filtered = edited(&|choice| choice["finish_reason"] = "content_filter".into());
    assert_eq!(filtered.whole().unwrap_err().kind(), Kind::Refused);
    let displaced =
        edited(&|choice| choice["message"] = json!({"content": null, "reasoning_content": "[3]"}));
    assert_eq!(displaced.json::<Value>().unwrap(), json!([3]));
    let parts = edited(&|choice| choice["message"]["content"] = json!([{"type": "text", "text": "[4]"}]));
    assert_eq!(parts.json::<Value>().unwrap(), json!([4]));
}

#[test]
fn a_success_that_is_an_error() {
    for body in [
        json!({"error": {"message": "CUDA out of memory", "code": 400}}),
        json!({"error": "CUDA out of memory"}),
        json!({"object": "error", "message": "CUDA out of memory"}),
        json!({"detail": "CUDA out of memory"}),
    ] {
        let (error, count) = failure(vec![ok(&body)]);
        assert!(matches!(error, EndpointError::ErrorBody { .. }), "{error:?}");
        assert!(error.to_string().contains("CUDA out of memory"), "{error}");
        assert_eq!(count, 1);
    }
    // A router that wraps somebody else's passing failure.
    let overloaded = ok(&json!({"error": {"message": "upstream", "code": 503}}));
    let (result, count) = ask(vec![overloaded, says("there")]);
    assert_eq!((result.unwrap().text.as_str(), count), ("there", 2));
}

#[test]
fn a_web_page_is_called_one() {
    let login = "<!DOCTYPE html><html><head><title> Sign in\n</title></head></html>";
    for turn in [page(200, login), Turn::Say(200, Vec::new(), format!("\n  {login}"))] {
        let (error, count) = failure(vec![turn]);
        assert!(matches!(error, EndpointError::WebPage { .. }), "{error:?}");
        assert!(error.to_string().contains("\"Sign in\"") && error.hint().contains("/v1"), "{error}");
        assert_eq!(count, 1);
    }
    let gateway = page(502, "<html><title>502 Bad Gateway</title></html>");
    let (error, count) = failure(vec![gateway.clone()]);
    assert!(error.to_string().contains("502 Bad Gateway"), "{error}");
    assert_eq!(count, 3);
    assert!(ask(vec![gateway, says("there")]).0.is_ok());
}

#[test]
fn retry_after_is_waited_for_or_given_up_on() {
    let start = Instant::now();
    let (result, count) = ask(vec![limited("1"), says("there")]);
    assert_eq!((result.unwrap().text.as_str(), count), ("there", 2));
    assert!(start.elapsed() >= Duration::from_secs(1), "{:?}", start.elapsed());

    let start = Instant::now();
    let (error, count) = failure(vec![limited("3600")]);
    assert!(
        matches!(error, EndpointError::RateLimit { retry_after: Some(wait), .. } if wait.as_secs() == 3600)
    );
    assert_eq!(count, 1);
    assert!(start.elapsed() < Duration::from_secs(5));

    // An HTTP date, two seconds after what the server says is now.
    let mut dated = limited("Fri, 20 Nov 2026 10:00:02 GMT");
    if let Turn::Say(_, headers, _) = &mut dated {
        headers.push(("date", "Fri, 20 Nov 2026 10:00:00 GMT".to_owned()));
    }
    let start = Instant::now();
    ask(vec![dated, says("there")]).0.unwrap();
    assert!(start.elapsed() >= Duration::from_secs(2), "{:?}", start.elapsed());
}

#[test]
fn passing_failures_pass_and_lasting_ones_are_told_at_once() {
    let boom = |code| status(code, &json!({"error": {"message": "boom"}}));
    for code in [408, 409, 429, 500, 502, 503, 504] {
        let (result, count) = ask(vec![boom(code), boom(code), says("there")]);
        assert_eq!((result.unwrap().text.as_str(), count), ("there", 3), "{code}");
        assert_eq!(failure(vec![boom(code)]).1, 3, "{code}");
    }
    for code in [400, 401, 403, 404, 413, 422] {
        let (error, count) = failure(vec![boom(code)]);
        assert!(error.to_string().contains(&format!("HTTP {code}: boom")), "{error}");
        assert_eq!(count, 1, "{code}");
    }
}

#[test]
fn an_endless_answer_is_cut_at_the_limit() {
    let server = Server::start(vec![Turn::Flood]);
    let mut endpoint = endpoint(&server);
    endpoint.limits.response_bytes = 1 << 20;
    let start = Instant::now();
    let error = Client::open(endpoint, &Link::Live).unwrap().ask(&question("hello")).unwrap_err();
    assert!(matches!(error, EndpointError::AnswerTooLarge { limit_bytes: 1_048_576, .. }), "{error:?}");
    assert_eq!(server.count(), 1);
    assert!(start.elapsed() < Duration::from_secs(10));
}

#[test]
fn an_answer_of_megabytes_within_the_limit_is_read_whole() {
    let text = "x".repeat(3 << 20);
    assert_eq!(ask(vec![says(&text)]).0.unwrap().text.len(), text.len());
}

#[test]
fn a_failing_endpoint_is_left_alone_after_a_while() {
    let server = Server::start(vec![status(500, &json!({"error": "boom"}))]);
    let mut endpoint = endpoint(&server);
    endpoint.retry.tries = 1;
    endpoint.retry.failures_in_a_row = 3;
    let client = Client::open(endpoint, &Link::Live).unwrap();
    let kinds: Vec<Kind> = (0..5).map(|_| client.ask(&question("hello")).unwrap_err().kind()).collect();
    assert_eq!(kinds, [Kind::Status, Kind::Status, Kind::Status, Kind::Broken, Kind::Broken]);
    assert_eq!(server.count(), 3);
}
