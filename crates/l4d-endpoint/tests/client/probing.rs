//! What a probe says about good and poor servers.

use l4d_endpoint::probe::{Line, State, probe};
use l4d_endpoint::{Client, Link};
use serde_json::{Value, json};

use crate::common::{client, patient, picture};
use crate::scripted::{self, Seen, Server, ok, says, status, thinks};

fn lines(server: &Server) -> Vec<Line> {
    probe(&client(server), (&picture(200), "grey"), |_| ())
}

fn states(lines: &[Line]) -> Vec<(&'static str, State)> {
    lines.iter().map(|line| (line.name, line.state)).collect()
}

fn text_of(seen: &Seen) -> String {
    seen.json()["messages"].to_string()
}

#[test]
fn a_good_server_is_called_good() {
    let server = Server::start(vec![thinks(|seen| {
        let body = seen.json();
        let text = text_of(seen);
        if seen.line.starts_with("GET") {
            ok(&json!({"data": [{"id": "other"}, {"id": "tiny"}]}))
        } else if !body["response_format"].is_null() {
            says(r#"{"sky": "clear", "warm": true}"#)
        } else if text.contains("random") {
            says(&format!("word {}", body["seed"]))
        } else if text.contains("How many pictures") {
            let mut said = scripted::completion("3");
            said["usage"]["prompt_tokens"] = 900.into();
            ok(&said)
        } else if text.contains("Which colour") {
            says("Grey.")
        } else {
            says("ready")
        }
    })]);
    let lines = lines(&server);
    let expected = ["key", "models", "chat", "usage", "picture", "pictures", "schema", "seed"];
    assert_eq!(states(&lines), expected.map(|name| (name, State::Ok)), "{lines:#?}");
    assert!(lines.iter().all(|line| line.hint.is_empty()));
}

#[test]
fn a_poor_server_is_told_apart_line_by_line() {
    let server = Server::start(vec![thinks(|seen| {
        let body = seen.json();
        let text = text_of(seen);
        if seen.line.starts_with("GET") {
            ok(&json!({"data": [{"id": "other"}]}))
        } else if text.matches("image_url").count() > 2 {
            status(400, &json!({"error": {"message": "At most 1 image(s) may be provided"}}))
        } else if body["temperature"] != 0.0 {
            status(400, &json!({"error": {"message": "unsupported", "param": "temperature"}}))
        } else {
            let mut said = scripted::completion("I am a small model.");
            said["usage"] = Value::Null;
            ok(&said)
        }
    })]);
    let lines = lines(&server);
    let expected = [
        ("key", State::Ok),
        ("models", State::Unclear),
        ("chat", State::Ok),
        ("usage", State::Lacking),
        ("picture", State::Unclear),
        ("pictures", State::Lacking),
        ("schema", State::Lacking),
        ("seed", State::Lacking),
    ];
    assert_eq!(states(&lines), expected, "{lines:#?}");
    assert!(lines.iter().skip(3).all(|line| !line.hint.is_empty()), "{lines:#?}");
    assert!(lines[1].hint.contains("other"));
}

#[test]
fn a_server_that_is_down_is_looked_at_no_longer_than_needed() {
    let server = Server::start(vec![status(401, &json!({"error": "who are you?"}))]);
    let lines = lines(&server);
    let expected = [("key", State::Ok), ("models", State::Lacking), ("chat", State::Failed)];
    assert_eq!(states(&lines), expected);
    assert!(lines[2].hint.contains("api_key_env"), "{lines:#?}");
}

#[test]
fn a_key_in_the_clear_is_warned_about() {
    let server = Server::start(vec![says("ready")]);
    let mut endpoint = patient(&server.url());
    endpoint.api_key_env = Some("A_KEY".to_owned());
    endpoint.base_url = "http://gpu-box.invalid:8000/v1".parse().unwrap();
    let key = |_: &str| Some("0123456789".into());
    let client = Client::open_in(endpoint, &Link::Live, &key).unwrap();
    let line = probe(&client, (&picture(1), "grey"), |_| ()).remove(0);
    assert_eq!(line.state, State::Lacking);
    assert!(line.hint.contains("https"));
}
