//! Every way in which a server can fail, played by a scripted one.

use std::time::Duration;

use l4d_endpoint::{Client, EndpointError, Failure, Finish, Link, Reply};
use serde_json::{Value, json};

use crate::common::{client, client_with, patient, question};
use crate::scripted::{Server, Turn, completion, ok, says, status};

/// Asks a server that plays these turns; the answer, and how often it was asked.
fn ask(turns: Vec<Turn>) -> (Result<Reply, EndpointError>, usize) {
    let server = Server::start(turns);
    let result = client(&server).ask(&question("hello"));
    (result, server.count())
}

/// The failure of a server, and how often it was asked.
fn failure(turns: Vec<Turn>) -> (Failure, usize) {
    let (result, count) = ask(turns);
    (failure_in(result), count)
}

fn failure_in(result: Result<Reply, EndpointError>) -> Failure {
    match result.unwrap_err() {
        EndpointError::Server(failure) => {
            assert!(!failure.hint.is_empty(), "{failure} has no hint");
            failure
        }
        other => panic!("{other:?}"),
    }
}

/// Asserts that a server that plays these turns is asked three times and answers in the end.
fn passes(turns: [Turn; 2]) {
    let (result, count) = ask([&turns[..], &[says("there")]].concat());
    assert_eq!((result.unwrap().text.as_str(), count), ("there", 3));
}

fn page(status: u16, body: &str) -> Turn {
    Turn::Say(status, vec![("content-type", "text/html".to_owned())], body.to_owned())
}

#[test]
fn a_server_that_is_down_or_does_not_exist() {
    let port = Server::start(vec![says("x")]).port;
    let ask = |url: &str| Client::open(patient(url), &Link::Live).unwrap().ask(&question("hello"));
    let failure = failure_in(ask(&format!("http://127.0.0.1:{port}/v1")));
    assert!(failure.is_passing && failure.hint.contains("start the server"), "{failure:?}");
    assert!(failure.to_string().contains(&port.to_string()));
    failure_in(ask("http://no-such-host.invalid/v1"));
}

#[test]
fn a_slow_server_gets_its_time_and_no_more() {
    let slow = || Turn::Late(Duration::from_secs(5), Box::new(says("too late")));
    let ask = |turns, request_seconds, total_seconds, tries| {
        let server = Server::start(turns);
        let client = client_with(&server, |endpoint| {
            endpoint.timeouts.request_seconds = request_seconds;
            endpoint.timeouts.total_seconds = total_seconds;
            endpoint.retry.tries = tries;
        });
        (client.ask(&question("hello")), server.count())
    };
    assert_eq!(ask(vec![slow(), says("in time")], 0.3, 30.0, 3).0.unwrap().text, "in time");
    let (result, count) = ask(vec![slow()], 0.3, 0.8, 100);
    let failure = failure_in(result);
    assert!(failure.may_have_cost && failure.to_string().contains("timeout"), "{failure:?}");
    assert!((2..=5).contains(&count), "{count}");
    // One byte at a time is bounded by the same time.
    assert!(
        failure_in(ask(vec![Turn::Endless(1, Duration::from_millis(20))], 0.5, 30.0, 1).0)
            .to_string()
            .contains("timeout")
    );
}

#[test]
fn connections_that_end_early_are_tried_again() {
    for broken in [Turn::Cut, Turn::Reset, Turn::Raw(Vec::new())] {
        passes([broken.clone(), broken.clone()]);
        let (failure, count) = failure(vec![broken]);
        assert!(failure.may_have_cost && failure.hint.contains("ended the connection"), "{failure:?}");
        assert_eq!(count, 3);
    }
}

#[test]
fn a_connection_that_the_server_ends_after_an_answer_is_not_used_again() {
    let server = Server::start(vec![Turn::Last(completion("there").to_string())]);
    let client = client_with(&server, |endpoint| endpoint.retry.tries = 1);
    for text in ["a", "b", "c", "d"] {
        assert_eq!(client.ask(&question(text)).unwrap().text, "there");
    }
    assert_eq!(server.count(), 4);
}

#[test]
fn what_is_no_answer_is_named_and_not_asked_for_again() {
    let text = |text: &str| Turn::Say(200, Vec::new(), text.to_owned());
    let login = "<!DOCTYPE html><html><head><title> Sign in\n</title></head></html>";
    for (turn, words) in [
        (Turn::Raw(b"SSH-2.0-OpenSSH_9.9\r\n\r\n".to_vec()), "not HTTP"),
        (text("\u{1}\u{2}\u{fffd} not json"), "no whole JSON document"),
        (text(""), "(empty)"),
        (text(r#"{"choices": [{"message": {"con"#), "no whole JSON document"),
        (text("data: {\"choices\": []}\n\n"), "no whole JSON document"),
        (ok(&json!({"choices": []})), "no `choices[0].message`"),
        (ok(&json!({"choices": [{"text": "old protocol"}]})), "no `choices[0].message`"),
        (ok(&json!([1, 2])), "no `choices[0].message`"),
        (ok(&json!({"error": {"message": "CUDA out of memory", "code": 400}})), "CUDA out of memory"),
        (ok(&json!({"error": "CUDA out of memory"})), "CUDA out of memory"),
        (ok(&json!({"object": "error", "message": "CUDA out of memory"})), "CUDA out of memory"),
        (ok(&json!({"detail": "CUDA out of memory"})), "CUDA out of memory"),
        (page(200, login), "HTTP 200: the server sent a web page"),
        (text(&format!("\n  {login}")), "HTTP 200: the server sent a web page"),
    ] {
        let (failure, count) = failure(vec![turn]);
        assert!(failure.to_string().contains(words), "{failure}");
        assert!(!failure.to_string().contains('\u{1}'));
        assert_eq!(count, 1);
    }
}

#[test]
fn unusable_answers_are_told_apart() {
    let edited = |edit: &dyn Fn(&mut Value)| {
        let mut body = completion("[1, 2");
        edit(&mut body["choices"][0]);
        ask(vec![ok(&body)]).0.unwrap()
    };
    let cut = edited(&|choice| choice["finish_reason"] = "length".into());
    assert_eq!(cut.finish, Finish::Length);
    assert!(matches!(cut.json::<Value>(), Err(EndpointError::Truncated { .. })));
    let refused = edited(&|choice| choice["message"]["refusal"] = "I will not.".into());
    assert!(matches!(refused.whole(), Err(EndpointError::Refused { .. })));
    let filtered = edited(&|choice| choice["finish_reason"] = "content_filter".into());
    assert!(matches!(filtered.whole(), Err(EndpointError::Refused { .. })));
    let displaced =
        edited(&|choice| choice["message"] = json!({"content": null, "reasoning_content": "[3]"}));
    assert_eq!(displaced.json::<Value>().unwrap(), json!([3]));
    let parts = edited(&|choice| choice["message"]["content"] = json!([{"type": "text", "text": "[4]"}]));
    assert_eq!(parts.json::<Value>().unwrap(), json!([4]));
}

#[test]
fn passing_failures_pass_and_lasting_ones_are_reported_at_once() {
    let boom = |code| status(code, &json!({"error": {"message": "boom"}}));
    for code in [408, 409, 429, 500, 502, 503, 504] {
        passes([boom(code), boom(code)]);
        assert_eq!(failure(vec![boom(code)]).1, 3, "{code}");
    }
    for code in [400, 401, 403, 404, 413, 422] {
        let (failure, count) = failure(vec![boom(code)]);
        let told = failure.to_string();
        assert!(told.contains(&format!("HTTP {code}: the")) && !told.contains("boom"), "{failure}");
        assert_eq!(count, 1, "{code}");
    }
    // A router that wraps a passing failure of another server.
    let overloaded = || ok(&json!({"error": {"message": "upstream", "code": 503}}));
    passes([overloaded(), overloaded()]);
    let gateway = || page(502, "<html><title>502 Bad Gateway</title></html>");
    passes([gateway(), gateway()]);
    assert!(failure(vec![gateway()]).0.to_string().contains("HTTP 502: the server is overloaded"));
    // Longer than all tries may take together.
    let headers = vec![("retry-after", "3600".to_owned())];
    let (failure, count) = failure(vec![Turn::Say(429, headers, "{}".to_owned())]);
    assert_eq!((failure.retry_after, count), (Some(Duration::from_secs(3600)), 1));
}

#[test]
fn an_answer_is_read_whole_up_to_the_limit() {
    let text = "x".repeat(3 << 20);
    assert_eq!(ask(vec![says(&text)]).0.unwrap().text.len(), text.len());
    let (failure, count) = failure(vec![Turn::Endless(1 << 16, Duration::ZERO)]);
    assert!(failure.to_string().contains("larger than 8388608 bytes"), "{failure}");
    assert_eq!(count, 1);
}
