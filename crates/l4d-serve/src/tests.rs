//! The server over real sockets, with an answerer that takes no time.

use std::io::{Read as _, Write as _};
use std::net::{SocketAddr, TcpStream};
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};

use l4d_data::StageError;
use serde_json::{Value, json};

use super::*;
use crate::desk::MOST_WAITING;
use crate::site::LONGEST;

fn answer(text: &str, progress: &dyn Progress) -> Result<Value, StageError> {
    progress.start("grounding", 8);
    progress.advance(3);
    match text {
        "slow" => thread::sleep(Duration::from_millis(600)),
        "wrong" => return Err(StageError::new("cannot read \"wrong\"", "say it in other words")),
        "broken" => panic!("as asked"),
        _ => {}
    }
    Ok(json!({"said": text}))
}

fn start() -> SocketAddr {
    let (sender, receiver) = mpsc::channel();
    let ready = move |address| sender.send(address).unwrap();
    thread::spawn(|| serve(b"<p>page</p>".to_vec(), Box::new(answer), 0, ready));
    receiver.recv().unwrap()
}

/// The status, headers and body that a request gets.
fn send(address: SocketAddr, request: &str) -> (u16, String, String) {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.write_all(request.as_bytes()).unwrap();
    let mut text = String::new();
    stream.read_to_string(&mut text).unwrap();
    let (head, body) = text.split_once("\r\n\r\n").unwrap();
    (head[9..12].parse().unwrap(), head.to_lowercase(), body.to_owned())
}

fn get(address: SocketAddr, path: &str) -> (u16, String, String) {
    send(address, &format!("GET {path} HTTP/1.1\r\nHost: {address}\r\nConnection: close\r\n\r\n"))
}

fn post(address: SocketAddr, body: &str, headers: &str) -> (u16, String) {
    let length = body.len();
    let (status, _, body) = send(
        address,
        &format!(
            "POST /questions HTTP/1.1\r\nConnection: close\r\nContent-Length: {length}\r\n{headers}\r\n{body}"
        ),
    );
    (status, body)
}

fn ask(address: SocketAddr, text: &str) -> (u16, Value) {
    let headers = format!("Host: {address}\r\nContent-Type: application/json\r\n");
    let (status, body) = post(address, &json!({ "text": text }).to_string(), &headers);
    (status, serde_json::from_str(&body).unwrap())
}

fn answered(address: SocketAddr, text: &str) -> Value {
    let (status, taken) = ask(address, text);
    assert_eq!(status, 202, "{taken}");
    let start = Instant::now();
    loop {
        let state: Value =
            serde_json::from_str(&get(address, &format!("/questions/{}", taken["id"])).2).unwrap();
        if state["state"] == "answered" || state["state"] == "failed" {
            return state;
        }
        assert!(start.elapsed() < Duration::from_secs(20), "{state}");
        thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_page_and_answers_to_its_questions() {
    let address = start();
    let (status, head, body) = get(address, "/");
    assert_eq!((status, body.as_str()), (200, "<p>page</p>"));
    assert!(head.contains("content-security-policy: default-src 'none'"), "{head}");
    let first = answered(address, " The red cup ");
    assert_eq!(first, json!({"state": "answered", "answer": {"said": "The red cup"}}));
    let wrong = answered(address, "wrong");
    assert_eq!(wrong["hint"], "say it in other words");
    assert_eq!(answered(address, "broken")["state"], "failed");
    assert_eq!(answered(address, "again")["state"], "answered", "one broken answer is not the end");
}

#[test]
fn pages_of_others_may_not_ask() {
    let address = start();
    let body = json!({"text": "The red cup"}).to_string();
    let json = "Content-Type: application/json\r\n";
    let ours = format!("Host: {address}\r\n{json}");
    let forbidden = [
        format!("Host: evil.example\r\n{json}"),
        format!("Host: evil.example:{}\r\n{json}", address.port()),
        format!("{ours}Origin: http://evil.example\r\n"),
        format!("{ours}Origin: null\r\n"),
        format!("{ours}Origin: https://{address}\r\n"),
    ];
    for headers in forbidden {
        assert_eq!(post(address, &body, &headers).0, 403, "{headers}");
    }
    assert_eq!(post(address, &body, &format!("{ours}Origin: http://{address}\r\n")).0, 202);
    // A form of another page can send text without asking first, but no JSON.
    assert_eq!(post(address, &body, &format!("Host: {address}\r\nContent-Type: text/plain\r\n")).0, 415);
}

#[test]
fn hostile_requests_are_refused() {
    let address = start();
    for path in
        ["/questions/999", "/questions/-1", "/questions/..%2f..%2fetc", "/etc/passwd", "//", "/questions/1/2"]
    {
        assert_eq!(get(address, path).0, 404, "{path}");
    }
    assert_eq!(get(address, "/questions").0, 405);
    for text in ["", "  \n", &"long ".repeat(LONGEST)] {
        let (status, body) = ask(address, text);
        assert_eq!(status, 422, "{body}");
        assert!(body["hint"].is_string());
    }
    let headers = format!("Host: {address}\r\nContent-Type: application/json\r\n");
    for body in ["", "{", "{\"text\": 1}", "[]", "{\"text\": \"a\", \"more\": 1}"] {
        assert!((400..500).contains(&post(address, body, &headers).0), "{body}");
    }
    let flood = json!({"text": "x".repeat(1 << 20)}).to_string();
    let mut stream = TcpStream::connect(address).unwrap();
    let head = format!("POST /questions HTTP/1.1\r\n{headers}Content-Length: {}\r\n\r\n", flood.len());
    stream.write_all(head.as_bytes()).unwrap();
    // The server may have closed before all of it is sent.
    let _closed = stream.write_all(flood.as_bytes());
    assert_eq!(get(address, "/").0, 200);
}

#[test]
fn a_flood_of_questions_waits_or_is_turned_away() {
    let address = start();
    let found: Vec<(u16, Value)> = (0..MOST_WAITING + 8).map(|_| ask(address, "slow")).collect();
    let taken: Vec<u64> = found.iter().filter_map(|(_, body)| body["id"].as_u64()).collect();
    assert!((MOST_WAITING..MOST_WAITING + 3).contains(&taken.len()), "{found:?}");
    assert!(found.iter().all(|(status, _)| [202, 429].contains(status)), "{found:?}");
    let last = get(address, &format!("/questions/{}", taken.last().unwrap())).2;
    assert!(last.contains("\"waiting\""), "{last}");
}
