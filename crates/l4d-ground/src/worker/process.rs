//! A worker's process: its three pipes, a thread for each, and its end.

use std::io::{self, BufRead, BufReader, Read, Write as _};
use std::os::unix::process::CommandExt as _;
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use l4d_data::error::inert;
use rustix::process::{Pid, Signal, WaitId, WaitIdOptions, kill_process_group, waitid};

use super::book::{Answer, Book, End};
use super::error::WorkerError;
use super::protocol::{Hello, Order, Segment, read_line, write_line};
use super::{Launch, Patience};

/// A line that is longer holds no mask of a clip.
const LONGEST_LINE: u64 = 16 << 20;
const LONGEST_TALK: u64 = 2 << 10;
const POLL: Duration = Duration::from_millis(10);

/// A running worker. Dropping it ends it, and everything in its process group.
#[derive(Debug)]
pub(super) struct Process {
    name: String,
    hello: Hello,
    patience: Patience,
    child: Mutex<Running>,
    orders: Mutex<Option<Sender<String>>>,
    shared: Arc<Shared>,
}

#[derive(Debug)]
struct Running {
    child: Child,
    /// How it ended, once that is known.
    status: Option<String>,
}

#[derive(Debug)]
struct Shared {
    book: Mutex<Book>,
    changed: Condvar,
}

impl Process {
    /// Starts it and waits for its hello.
    pub(super) fn start(launch: &Launch, patience: Patience) -> Result<Self, WorkerError> {
        let program = launch.program.display().to_string();
        let mut command = Command::new(&launch.program);
        command.args(&launch.arguments).envs(launch.environment.iter().map(|(name, value)| (name, value)));
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        // A group of its own: what it starts must not outlive it, and a Ctrl-C is for l4d to answer.
        command.process_group(0);
        let start = |source| WorkerError::Start { program: program.clone(), source };
        let mut child = command.spawn().map_err(start)?;
        let pipes = (child.stdin.take(), child.stdout.take(), child.stderr.take());
        let shared = Arc::new(Shared { book: Mutex::new(Book::new()), changed: Condvar::new() });
        let (orders, waiting) = channel();
        if let (Some(stdin), Some(stdout), Some(stderr)) = pipes {
            let (reading, talking) = (Arc::clone(&shared), Arc::clone(&shared));
            thread::spawn(move || write_orders(stdin, &waiting));
            thread::spawn(move || read_lines(stdout, &reading));
            let name = program.clone();
            thread::spawn(move || read_talk(stderr, &name, &talking));
        }
        let mut process = Self {
            name: program,
            hello: nobody(),
            patience,
            child: Mutex::new(Running { child, status: None }),
            orders: Mutex::new(Some(orders)),
            shared,
        };
        process.hello = process.wait_for_hello()?;
        process.name.clone_from(&process.hello.name);
        Ok(process)
    }

    /// Who it says it is.
    pub(super) fn hello(&self) -> &Hello {
        &self.hello
    }

    /// Asks and waits.
    pub(super) fn segment(&self, segment: &Segment<'_>) -> Result<Answer, WorkerError> {
        let id = segment.id;
        self.book().open(id, (segment.frames.width, segment.frames.height), segment.range);
        self.order(&Order::Segment(segment));
        let asked = Instant::now();
        let mut book = self.book();
        loop {
            if let Some(result) = book.close(id, &self.name) {
                // The next request's clock begins now.
                self.shared.changed.notify_all();
                if matches!(result, Err(WorkerError::Answer { .. })) {
                    self.order(&Order::Cancel { id });
                }
                return result;
            }
            if let Some(end) = book.end.clone() {
                book.pending.remove(&id);
                drop(book);
                return Err(self.ended(end));
            }
            let turn_since = book.is_turn_of(id);
            let silent = book.last_heard.max(asked).elapsed();
            let working = turn_since.map_or(Duration::ZERO, |since| since.elapsed());
            let (what, waited) = if silent >= self.patience.silence {
                ("said nothing", self.patience.silence)
            } else if working >= self.patience.answer {
                ("worked on one answer", self.patience.answer)
            } else {
                let rest = (self.patience.silence - silent).min(self.patience.answer - working);
                book = self.wait(book, rest);
                continue;
            };
            // Whoever else waits for it waits in vain.
            book.end.get_or_insert(End::Hung(what, waited));
            self.shared.changed.notify_all();
        }
    }

    fn wait_for_hello(&self) -> Result<Hello, WorkerError> {
        let started = Instant::now();
        let mut book = self.book();
        loop {
            if let Some(hello) = &book.hello {
                return Ok(hello.clone());
            }
            if let Some(end) = book.end.clone() {
                drop(book);
                return Err(self.ended(end));
            }
            let Some(rest) =
                self.patience.hello.checked_sub(started.elapsed()).filter(|rest| !rest.is_zero())
            else {
                let (worker, waited) = (self.name.clone(), self.patience.hello);
                let what = "was not ready";
                return Err(WorkerError::Hangs { worker, what, waited, tail: book.tail() });
            };
            book = self.wait(book, rest);
        }
    }

    fn wait<'a>(&self, book: MutexGuard<'a, Book>, rest: Duration) -> MutexGuard<'a, Book> {
        self.shared.changed.wait_timeout(book, rest).unwrap_or_else(PoisonError::into_inner).0
    }

    fn order(&self, order: &Order<'_>) {
        let orders = self.orders.lock().unwrap_or_else(PoisonError::into_inner);
        if let (Ok(line), Some(orders)) = (write_line(order), orders.as_ref()) {
            // A worker that reads no more is noticed by its end or its silence.
            orders.send(line).ok();
        }
    }

    fn ended(&self, end: End) -> WorkerError {
        let worker = self.name.clone();
        match end {
            End::Broken(message) => WorkerError::Protocol { worker, message },
            End::Hung(what, waited) => WorkerError::Hangs { worker, what, waited, tail: self.book().tail() },
            End::Closed => {
                let status = self.finish();
                WorkerError::Died { worker, status, tail: self.book().tail() }
            }
        }
    }

    /// Waits a little, ends whatever is left of its group, and tells how it ended.
    fn finish(&self) -> String {
        let mut running = self.child.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(status) = &running.status {
            return status.clone();
        }
        let pid = Pid::from_child(&running.child);
        let deadline = Instant::now() + self.patience.farewell;
        // Without reaping: the number of the group must stay taken until it is killed.
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
        while matches!(waitid(WaitId::Pid(pid), options), Ok(None)) && Instant::now() < deadline {
            thread::sleep(POLL);
        }
        kill_process_group(pid, Signal::KILL).ok();
        let status = running.child.wait().map_or_else(|error| error.to_string(), |status| status.to_string());
        running.status = Some(status.clone());
        status
    }

    fn book(&self) -> MutexGuard<'_, Book> {
        self.shared.book()
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.order(&Order::Shutdown);
        // Its stdin ends, too, which tells it the same.
        self.orders.lock().unwrap_or_else(PoisonError::into_inner).take();
        self.finish();
    }
}

impl Shared {
    fn book(&self) -> MutexGuard<'_, Book> {
        self.book.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn end(&self, end: End) {
        let mut book = self.book();
        book.end.get_or_insert(end);
        self.changed.notify_all();
    }
}

fn nobody() -> Hello {
    Hello {
        protocol: 0,
        name: String::new(),
        version: String::new(),
        prompts: Vec::new(),
        text: None,
        text_max_tokens: None,
        device: None,
        weights: None,
        deps: Default::default(),
        settings: Default::default(),
    }
}

fn write_orders(mut stdin: ChildStdin, orders: &Receiver<String>) {
    while let Ok(line) = orders.recv() {
        if stdin.write_all(line.as_bytes()).and_then(|()| stdin.flush()).is_err() {
            return;
        }
    }
}

fn read_lines(stdout: ChildStdout, shared: &Shared) {
    let mut stdout = BufReader::new(stdout);
    let mut line = Vec::new();
    loop {
        let read = read_bounded(&mut stdout, &mut line, LONGEST_LINE);
        let noted = match read {
            Ok(0) | Err(_) => return shared.end(End::Closed),
            Ok(_) if line.len() as u64 == LONGEST_LINE => Err("a line without end".to_owned()),
            Ok(_) if line.trim_ascii().is_empty() => Ok(()),
            Ok(_) => read_line(&line)
                .map_err(|error| {
                    let excerpt: String = String::from_utf8_lossy(&line).chars().take(80).collect();
                    format!("{error}: {}", inert(excerpt.trim()))
                })
                .and_then(|said| shared.book().note(said)),
        };
        if let Err(message) = noted {
            // Nothing more is read: a flood fills its pipe and stands still until it is killed.
            return shared.end(End::Broken(message));
        }
        shared.changed.notify_all();
    }
}

fn read_talk(stderr: ChildStderr, name: &str, shared: &Shared) {
    let mut stderr = BufReader::new(stderr);
    let mut line = Vec::new();
    while read_bounded(&mut stderr, &mut line, LONGEST_TALK).is_ok_and(|count| count > 0) {
        let text = inert(String::from_utf8_lossy(&line).trim_end());
        if !text.is_empty() {
            tracing::info!(worker = name, "{text}");
            shared.book().note_talk(text);
        }
    }
}

fn read_bounded(reader: &mut impl BufRead, line: &mut Vec<u8>, limit: u64) -> io::Result<usize> {
    line.clear();
    reader.take(limit).read_until(b'\n', line)
}
