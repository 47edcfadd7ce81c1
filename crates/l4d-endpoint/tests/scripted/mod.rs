//! A model server that answers as a test wants, however badly.

#![allow(dead_code, clippy::allow_attributes, reason = "each test target uses its own part of it")]

use std::collections::BTreeMap;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread::JoinHandle;
use std::time::Duration;

use serde_json::{Value, json};

/// A request as it arrived.
#[derive(Debug, Clone)]
pub(crate) struct Seen {
    pub(crate) line: String,
    pub(crate) headers: BTreeMap<String, String>,
    pub(crate) body: String,
}

impl Seen {
    /// The body; `null` for a GET.
    pub(crate) fn json(&self) -> Value {
        if self.body.is_empty() {
            return Value::Null;
        }
        serde_json::from_str(&self.body).unwrap()
    }
}

/// What the server does with one connection.
#[derive(Clone)]
pub(crate) enum Turn {
    /// A whole HTTP response.
    Say(u16, Vec<(&'static str, String)>, String),
    /// A response made from the request.
    Think(Arc<dyn Fn(&Seen) -> Turn + Send + Sync>),
    /// These bytes, whatever they are.
    Raw(Vec<u8>),
    /// The head and half of a body, then the end of the connection.
    Cut,
    /// Closes with the request unread, which makes the other side see a reset.
    Reset,
    /// An answer, after which the connection seems to stay open, but ends with the next request on it.
    Last(String),
    /// Nothing for so long, then the next one.
    Late(Duration, Box<Turn>),
    /// A body without end: so many bytes at a time, with a pause after each.
    Endless(usize, Duration),
}

/// A success with this body.
pub(crate) fn ok(body: &Value) -> Turn {
    status(200, body)
}

/// Any status with this body.
pub(crate) fn status(status: u16, body: &Value) -> Turn {
    Turn::Say(status, vec![("content-type", "application/json".to_owned())], body.to_string())
}

/// A chat completion with this text.
pub(crate) fn says(text: &str) -> Turn {
    ok(&completion(text))
}

pub(crate) fn completion(text: &str) -> Value {
    json!({
        "id": "x", "object": "chat.completion", "created": 0, "model": "scripted-1",
        "choices": [{ "index": 0, "message": { "role": "assistant", "content": text }, "finish_reason": "stop" }],
        "usage": { "prompt_tokens": 40, "completion_tokens": 2, "total_tokens": 42 },
    })
}

pub(crate) fn thinks(think: impl Fn(&Seen) -> Turn + Send + Sync + 'static) -> Turn {
    Turn::Think(Arc::new(think))
}

/// Serves its turns in order, one per connection; the last one again and again.
pub(crate) struct Server {
    pub(crate) port: u16,
    seen: Arc<Mutex<Vec<Seen>>>,
    ended: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Server {
    pub(crate) fn start(turns: Vec<Turn>) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let port = listener.local_addr().unwrap().port();
        let seen = Arc::new(Mutex::new(Vec::new()));
        let ended = Arc::new(AtomicBool::new(false));
        let (log, end) = (Arc::clone(&seen), Arc::clone(&ended));
        let thread = std::thread::spawn(move || {
            for (index, stream) in listener.incoming().enumerate() {
                if end.load(Ordering::SeqCst) {
                    return;
                }
                let turn = turns[index.min(turns.len() - 1)].clone();
                let log = Arc::clone(&log);
                // The other side may leave at any time; that is its right.
                std::thread::spawn(move || serve(stream.unwrap(), turn, &log).ok());
            }
        });
        Self { port, seen, ended, thread: Some(thread) }
    }

    pub(crate) fn url(&self) -> String {
        format!("http://127.0.0.1:{}/v1", self.port)
    }

    /// All requests so far.
    pub(crate) fn seen(&self) -> Vec<Seen> {
        self.seen.lock().unwrap().clone()
    }

    pub(crate) fn count(&self) -> usize {
        self.seen.lock().unwrap().len()
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::SeqCst);
        TcpStream::connect(("127.0.0.1", self.port)).ok();
        if let Some(thread) = self.thread.take() {
            thread.join().ok();
        }
    }
}

fn serve(mut stream: TcpStream, turn: Turn, log: &Mutex<Vec<Seen>>) -> std::io::Result<()> {
    if matches!(turn, Turn::Reset) {
        stream.read_exact(&mut [0])?;
        log.lock().unwrap().push(Seen { line: String::new(), headers: BTreeMap::new(), body: String::new() });
        return Ok(());
    }
    let seen = read(&mut stream)?;
    log.lock().unwrap().push(seen.clone());
    play(&mut stream, turn, &seen)
}

fn play(stream: &mut TcpStream, turn: Turn, seen: &Seen) -> std::io::Result<()> {
    let mut answer = |status: u16, more: &str, length: usize, body: &str| {
        let head = format!("HTTP/1.1 {status} X\r\ncontent-length: {length}\r\n{more}\r\n");
        stream.write_all((head + body).as_bytes())
    };
    match turn {
        Turn::Say(status, headers, body) => {
            let headers: String =
                headers.iter().map(|(name, value)| format!("{name}: {value}\r\n")).collect();
            answer(status, &format!("connection: close\r\n{headers}"), body.len(), &body)
        }
        Turn::Think(think) => play(stream, think(seen), seen),
        Turn::Raw(bytes) => stream.write_all(&bytes),
        Turn::Cut => answer(200, "", 1000, "{\"choices\": [{\"mess"),
        Turn::Reset => Ok(()),
        Turn::Last(body) => {
            answer(200, "", body.len(), &body)?;
            stream.set_read_timeout(Some(Duration::from_secs(5)))?;
            stream.read_exact(&mut [0])
        }
        Turn::Late(pause, turn) => {
            std::thread::sleep(pause);
            play(stream, *turn, seen)
        }
        Turn::Endless(bytes, pause) => {
            stream.write_all(b"HTTP/1.1 200 OK\r\ncontent-type: application/json\r\n\r\n")?;
            loop {
                stream.write_all(&vec![b' '; bytes])?;
                std::thread::sleep(pause);
            }
        }
    }
}

fn read(stream: &mut TcpStream) -> std::io::Result<Seen> {
    let mut reader = BufReader::new(stream);
    let mut line = String::new();
    reader.read_line(&mut line)?;
    let mut headers = BTreeMap::new();
    loop {
        let mut header = String::new();
        reader.read_line(&mut header)?;
        let Some((name, value)) = header.trim_end().split_once(": ") else { break };
        headers.insert(name.to_lowercase(), value.to_owned());
    }
    let length = headers.get("content-length").map_or(0, |length| length.parse().unwrap());
    let mut body = vec![0; length];
    reader.read_exact(&mut body)?;
    Ok(Seen { line: line.trim_end().to_owned(), headers, body: String::from_utf8(body).unwrap() })
}
