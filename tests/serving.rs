//! `serve` as a browser uses it: the page, a question, the answer over time.

use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::TcpStream;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::solving::world;
use crate::support::Dir;
use crate::world::{SCENE, SIZE};

/// A server that ends with the test.
struct Server {
    child: Child,
    address: String,
}

impl Server {
    fn start(dir: &Dir, more: &str) -> Self {
        let line = format!("serve {SCENE} --profile tiny --data data --port 0 {more}");
        let mut command = dir.command(line);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let address = line.trim().strip_prefix("http://").unwrap().trim_end_matches('/').to_owned();
        Self { child, address }
    }

    fn send(&self, method: &str, path: &str, body: &str) -> String {
        let (host, length) = (&self.address, body.len());
        let mut stream = TcpStream::connect(host).unwrap();
        write!(
            stream,
            "{method} {path} HTTP/1.1\r\nHost: {host}\r\nConnection: close\r\nContent-Type: application/json\r\n\
             Content-Length: {length}\r\n\r\n{body}"
        )
        .unwrap();
        let mut text = String::new();
        stream.read_to_string(&mut text).unwrap();
        text.split_once("\r\n\r\n").unwrap().1.to_owned()
    }

    fn ask(&self, text: &str) -> Value {
        let value = |text: &str| serde_json::from_str::<Value>(text).unwrap();
        let taken = value(&self.send("POST", "/questions", &json!({ "text": text }).to_string()));
        let start = Instant::now();
        loop {
            let now = value(&self.send("GET", &format!("/questions/{}", taken["id"]), ""));
            if now["state"] == "answered" || now["state"] == "failed" {
                return now;
            }
            assert!(start.elapsed() < Duration::from_secs(120), "{now}");
            std::thread::sleep(Duration::from_millis(50));
        }
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        let _gone = self.child.kill();
        let _ended = self.child.wait();
    }
}

#[test]
fn a_sentence_is_answered_as_query_answers_it() {
    let dir = world();
    let server = Server::start(&dir, "--grounder oracle");
    let page = server.send("GET", "/", "");
    assert!(page.contains("\"asks\":true") && page.contains("id=\"ask\""), "{page:.300}");

    let answered = server.ask("The ball that rolls");
    let answer = &answered["answer"];
    assert_eq!(answer["answer"]["status"], "answered", "{answered}");
    assert_eq!((&answer["camera"], &answer["size"]), (&json!("cam04"), &json!(SIZE)), "{answered}");
    let masks = answer["masks"].as_object().unwrap();
    assert_eq!(masks.len(), 9);
    let queried = dir.json(format!(
        "query {SCENE} 'The ball that rolls' --profile tiny --data data --grounder oracle --out elsewhere"
    ));
    let pixels = queried["frames"]["cam04"].as_object().unwrap();
    for (frame, counts) in masks {
        assert_eq!(counts.is_string(), pixels[frame] != 0, "frame {frame}");
    }

    let unknown = server.ask("The ball of another benchmark");
    assert_eq!(unknown["state"], "failed");
    assert!(unknown["hint"].as_str().unwrap().contains("ask with --grounder panoptic"), "{unknown}");
}

#[test]
fn a_port_that_is_taken_is_named() {
    let dir = world();
    let server = Server::start(&dir, "--grounder oracle");
    let port = server.address.rsplit_once(':').unwrap().1;
    let line = format!("serve {SCENE} --profile tiny --data data --grounder oracle --port {port}");
    dir.run(line).says(2, &[&format!("port {port} of this machine cannot be used")]);
}
