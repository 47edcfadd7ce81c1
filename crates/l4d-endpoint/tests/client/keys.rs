//! Keys go into headers and nowhere else.

use std::ffi::OsString;

use l4d_endpoint::{CacheUse, Client, Endpoint, Link};
use serde_json::json;

use crate::common::{files_under, patient, question};
use crate::scripted::{Server, Turn, completion, ok, says, status};

const KEY: &str = "sk-canary/7Yq+0123456789";
const SECOND: &str = "org-canary-8Zr-987654321";

fn environment(variable: &str) -> Option<OsString> {
    match variable {
        "L4D_TEST_KEY" => Some(format!(" {KEY}\n").into()),
        "L4D_TEST_ORG" => Some(SECOND.into()),
        _ => None,
    }
}

fn locked(server: &Server) -> Endpoint {
    let mut endpoint = patient(&server.url());
    endpoint.api_key_env = Some("L4D_TEST_KEY".to_owned());
    endpoint.header_env.insert("x-org".to_owned(), "L4D_TEST_ORG".to_owned());
    endpoint.retry.tries = 2;
    endpoint
}

#[test]
fn keys_stay_secret_whatever_the_server_echoes() {
    let slashed = KEY.replace('/', "\\/");
    let escaped: String = KEY.chars().map(|letter| format!("\\u{:04x}", u32::from(letter))).collect();
    let spaced = |between: &str| KEY.chars().map(String::from).collect::<Vec<_>>().join(between);
    let raw = |status, body: String| Turn::Say(status, vec![("retry-after", format!("0; {KEY}"))], body);
    let echoes = [
        status(401, &json!({"error": {"message": format!("Incorrect API key provided: {KEY} / {SECOND}")}})),
        raw(401, format!(r#"{{"error": {{"message": "no {slashed}"}}}}"#)),
        raw(403, format!(r#"{{"error": "no {escaped}"}}"#)),
        raw(500, format!("<html><title>{KEY}</title>Authorization: Bearer {KEY}</html>")),
        raw(429, format!("Bearer {}", spaced("\u{200b}"))),
        raw(401, spaced("\0")),
        raw(400, KEY.chars().rev().collect()),
        raw(200, spaced("\u{1b}")),
        ok(&json!({"error": {"message": spaced("\u{200b}")}})),
        says(&format!("your key is {}, {}", spaced("\u{200d}"), spaced("\u{7f}"))),
        raw(200, format!("garbage {KEY}")),
        raw(200, format!(r#"{{"error": "{escaped}"}}"#)),
        raw(200, format!("data: {{\"error\": \"{KEY}\"}}\n\n")),
        raw(200, format!("<!doctype html><title>{SECOND}</title>")),
        says(&format!("your key is {KEY}, your organisation {SECOND}")),
        ok(&{
            let mut body = completion("fine");
            body["model"] = KEY.into();
            body
        }),
        Turn::Say(307, vec![("location", format!("http://127.0.0.1:1/{KEY}?{SECOND}"))], String::new()),
        Turn::Raw(format!("HTTP/1.1 200 OK\r\n{KEY}: x\r\nbroken {KEY}\r\n\r\n").into_bytes()),
        Turn::Raw(KEY.as_bytes().to_vec()),
    ];
    for (index, turn) in echoes.into_iter().enumerate() {
        let server = Server::start(vec![turn]);
        let folder = tempfile::tempdir().unwrap();
        let mut told = String::new();
        for link in [Link::Live, Link::Record(folder.path().join("recording"))] {
            let client = Client::open_in(locked(&server), &link, &environment).unwrap();
            let client = client.with_cache(&folder.path().join("cache"), CacheUse::Take);
            told += &match client.ask(&question("who am I?")) {
                Ok(reply) => format!("{reply:?}"),
                Err(error) => format!("{error} {error:?} {}", error.hint()),
            };
            told += &format!("{client:?}");
        }
        for seen in server.seen() {
            assert_eq!(seen.headers["authorization"], format!("Bearer {KEY}"));
            assert_eq!(seen.headers["x-org"], SECOND);
        }
        told += &files_under(folder.path());
        // What hides between letters is left out where text is shown: so it is here.
        told.retain(|letter| letter.is_ascii_graphic());
        let told = told.replace("\\u{200b}", "").replace("\\u{200d}", "").replace("\\u{7f}", "");
        for word in ["canary", "7Yq", "8Zr", "\\u0063", "L4D_TEST_ORG\":", "qY7"] {
            assert!(!told.contains(word), "echo {index} told `{word}`:\n{told}");
        }
        assert!(server.count() >= 2);
    }
}

#[test]
fn a_redirect_is_reported_and_not_followed() {
    let elsewhere = Server::start(vec![says("thanks for the key")]);
    let location = format!("http://localhost:{}/v1/chat/completions", elsewhere.port);
    let server = Server::start(vec![Turn::Say(308, vec![("location", location)], String::new())]);
    let client = Client::open_in(locked(&server), &Link::Live, &environment).unwrap();
    let error = client.ask(&question("hello")).unwrap_err();
    assert!(error.to_string().contains("HTTP 308: the server points to http://localhost"), "{error}");
    assert_eq!((server.count(), elsewhere.count()), (1, 0));
}
