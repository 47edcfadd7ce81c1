//! A worker's process: its three pipes, a thread for each, and its end.

use std::collections::VecDeque;
use std::io::{self, BufRead, BufReader, Read, Write as _};
use std::os::unix::process::CommandExt as _;
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, SyncSender, channel, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use l4d_data::error::inert;
use l4d_endpoint::one_line;
use rustix::process::{Pid, Signal, WaitId, WaitIdOptions, kill_process_group, waitid};

use super::error::WorkerError;
use super::protocol::{Hello, PROTOCOL, Request, Segment, WorkerLine, write_line};
use super::segmenter::{PartialAnswer, Segmented};
use super::{Launch, WorkerTimeouts};

/// A line that is longer holds no mask of a clip.
const LONGEST_LINE: u64 = 16 << 20;
/// Lines that wait to be taken; then the worker waits.
const WAITING_LINES: usize = 64;
const LONGEST_LOG_LINE: u64 = 2 << 10;
/// Lines of stderr that are kept for an error.
const LOG_LINES: usize = 12;
const POLL: Duration = Duration::from_millis(10);

/// A running worker. Dropping it ends it, and everything in its process group.
#[derive(Debug)]
pub(super) struct Process {
    name: String,
    hello: Hello,
    timeouts: WorkerTimeouts,
    child: Child,
    /// How it ended, once that is known.
    status: Option<String>,
    requests: Option<Sender<String>>,
    /// What it says; an error where it breaks the protocol.
    lines: Receiver<Result<WorkerLine, String>>,
    /// The end of what it wrote to stderr, the last line first.
    log: Arc<Mutex<VecDeque<String>>>,
}

impl Process {
    /// Starts it and waits for its hello.
    pub(super) fn start(launch: &Launch, timeouts: WorkerTimeouts) -> Result<Self, WorkerError> {
        let program = launch.program.display().to_string();
        let mut command = Command::new(&launch.program);
        command.args(&launch.arguments).envs(&launch.environment);
        command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
        // A group of its own: what it starts must not outlive it, and a Ctrl-C is for l4d to answer.
        command.process_group(0);
        let mut child = command.spawn().map_err(|source| WorkerError::not_started(&program, &source))?;
        let (requests, to_write) = channel();
        let (read, lines) = sync_channel(WAITING_LINES);
        let log = Arc::new(Mutex::new(VecDeque::new()));
        if let (Some(stdin), Some(stdout), Some(stderr)) =
            (child.stdin.take(), child.stdout.take(), child.stderr.take())
        {
            let (name, log) = (program.clone(), Arc::clone(&log));
            thread::spawn(move || write_requests(stdin, &to_write));
            thread::spawn(move || read_lines(stdout, &read));
            thread::spawn(move || read_log(stderr, &name, &log));
        }
        let mut process = Self {
            name: program,
            hello: Hello::default(),
            timeouts,
            child,
            status: None,
            requests: Some(requests),
            lines,
            log,
        };
        process.hello = process.wait_for_hello()?;
        process.name.clone_from(&process.hello.name);
        Ok(process)
    }

    /// What it says of itself.
    pub(super) fn hello(&self) -> &Hello {
        &self.hello
    }

    fn wait_for_hello(&mut self) -> Result<Hello, WorkerError> {
        let waited = self.timeouts.hello;
        let deadline = Instant::now() + waited;
        loop {
            let rest = deadline.saturating_duration_since(Instant::now());
            match self.next_line(rest, "was not ready", waited)? {
                WorkerLine::Alive { .. } => {}
                WorkerLine::Hello { hello } if hello.protocol == PROTOCOL => return Ok(*hello),
                WorkerLine::Hello { hello } => {
                    let theirs = hello.protocol;
                    let message =
                        format!("it speaks version {theirs} of the protocol, l4d speaks {PROTOCOL}");
                    return Err(WorkerError::breaks_protocol(&self.name, &message));
                }
                _ => {
                    return Err(WorkerError::breaks_protocol(&self.name, "it answers before its hello"));
                }
            }
        }
    }

    /// Asks and waits.
    pub(super) fn segment(&mut self, segment: &Segment<'_>) -> Result<Segmented, WorkerError> {
        self.send(&Request::Segment(segment));
        let mut answer = PartialAnswer::new(segment);
        let WorkerTimeouts { silence, answer: whole, .. } = self.timeouts;
        let deadline = Instant::now() + whole;
        loop {
            let rest = deadline.saturating_duration_since(Instant::now());
            let line = if rest < silence {
                self.next_line(rest, "worked on one answer", whole)?
            } else {
                self.next_line(silence, "said nothing", silence)?
            };
            match line.id() {
                // A request that was given up: late lines do no harm.
                Some(id) if id < segment.id => continue,
                Some(id) if id > segment.id => {
                    let message = format!("it answers request {id}, which was not asked");
                    return Err(WorkerError::breaks_protocol(&self.name, &message));
                }
                _ => {}
            }
            match line {
                WorkerLine::Alive { .. } => {}
                WorkerLine::Hello { .. } => {
                    return Err(WorkerError::breaks_protocol(&self.name, "it says hello twice"));
                }
                WorkerLine::Mask(line) => {
                    if let Err(message) = answer.add(&line) {
                        self.send(&Request::Cancel { id: segment.id });
                        return Err(WorkerError::Answer { worker: self.name.clone(), message });
                    }
                }
                WorkerLine::Done { skipped, .. } => return Ok(answer.finish(&skipped)),
                WorkerLine::Failed { error, .. } => {
                    let (kind, message) = (one_line(&error.kind, 40), one_line(&error.msg, 500));
                    return Err(WorkerError::Refused { worker: self.name.clone(), kind, message });
                }
            }
        }
    }

    /// The next line within `rest`; otherwise it did `what` for as long as `waited`.
    fn next_line(&mut self, rest: Duration, what: &str, waited: Duration) -> Result<WorkerLine, WorkerError> {
        let line =
            if rest.is_zero() { Err(RecvTimeoutError::Timeout) } else { self.lines.recv_timeout(rest) };
        match line {
            Ok(Ok(line)) => Ok(line),
            Ok(Err(message)) => Err(WorkerError::breaks_protocol(&self.name, &message)),
            Err(RecvTimeoutError::Timeout) => Err(WorkerError::hangs(&self.name, what, waited, &self.log())),
            Err(RecvTimeoutError::Disconnected) => {
                let status = self.finish();
                Err(WorkerError::died(&self.name, &status, &self.log()))
            }
        }
    }

    fn send(&self, request: &Request<'_>) {
        if let (Ok(line), Some(requests)) = (write_line(request), &self.requests) {
            // A worker that reads no more is noticed by its end or its silence.
            requests.send(line).ok();
        }
    }

    fn log(&self) -> String {
        let log = self.log.lock().unwrap_or_else(PoisonError::into_inner);
        log.iter().rev().map(String::as_str).collect::<Vec<_>>().join("\n")
    }

    /// Waits a little, ends what is left of its group, and says how it ended.
    fn finish(&mut self) -> String {
        if let Some(status) = &self.status {
            return status.clone();
        }
        let pid = Pid::from_child(&self.child);
        let deadline = Instant::now() + self.timeouts.farewell;
        // Without reaping: the number of the group must stay taken until it is killed.
        let options = WaitIdOptions::EXITED | WaitIdOptions::NOHANG | WaitIdOptions::NOWAIT;
        while matches!(waitid(WaitId::Pid(pid), options), Ok(None)) && Instant::now() < deadline {
            thread::sleep(POLL);
        }
        kill_process_group(pid, Signal::KILL).ok();
        let status = self.child.wait().map_or_else(|error| error.to_string(), |status| status.to_string());
        self.status.insert(status).clone()
    }
}

impl Drop for Process {
    fn drop(&mut self) {
        self.send(&Request::Shutdown);
        // Its stdin ends, too, which says the same.
        self.requests = None;
        self.finish();
    }
}

fn write_requests(mut stdin: ChildStdin, requests: &Receiver<String>) {
    while let Ok(line) = requests.recv() {
        if stdin.write_all(line.as_bytes()).and_then(|()| stdin.flush()).is_err() {
            return;
        }
    }
}

/// Reads up to the end, or up to the first line that breaks the protocol: a flood fills its pipe and stops until the
/// worker is killed.
fn read_lines(stdout: ChildStdout, lines: &SyncSender<Result<WorkerLine, String>>) {
    let mut stdout = BufReader::new(stdout);
    let mut line = Vec::new();
    loop {
        let read = match read_bounded(&mut stdout, &mut line, LONGEST_LINE) {
            Ok(0) | Err(_) => return,
            Ok(_) if line.len() as u64 == LONGEST_LINE => Err("a line without end".to_owned()),
            Ok(_) if line.trim_ascii().is_empty() => continue,
            Ok(_) => serde_json::from_slice(&line).map_err(|error| {
                let excerpt: String = String::from_utf8_lossy(&line).chars().take(80).collect();
                format!("{error}: {}", excerpt.trim())
            }),
        };
        let is_broken = read.is_err();
        if lines.send(read).is_err() || is_broken {
            return;
        }
    }
}

fn read_log(stderr: ChildStderr, name: &str, log: &Mutex<VecDeque<String>>) {
    let mut stderr = BufReader::new(stderr);
    let mut line = Vec::new();
    while read_bounded(&mut stderr, &mut line, LONGEST_LOG_LINE).is_ok_and(|count| count > 0) {
        let text = inert(String::from_utf8_lossy(&line).trim_end());
        if !text.is_empty() {
            tracing::info!(worker = name, "{text}");
            let mut log = log.lock().unwrap_or_else(PoisonError::into_inner);
            log.truncate(LOG_LINES - 1);
            log.push_front(text);
        }
    }
}

fn read_bounded(reader: &mut impl BufRead, line: &mut Vec<u8>, limit: u64) -> io::Result<usize> {
    line.clear();
    reader.take(limit).read_until(b'\n', line)
}
