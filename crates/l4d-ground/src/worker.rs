//! Segmenters in processes of their own: prompts and frames in, masks out, over JSON Lines (docs/workers.md).
//!
//! This module owns the other end of the protocol: starting a worker, asking it, and what becomes of a view when it
//! dies, hangs, floods or says what cannot be. It knows nothing of what runs inside a worker and where prompts come
//! from.

mod error;
mod frames;
mod process;
mod protocol;
mod segmenter;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

pub use error::WorkerError;
pub use frames::{FrameStore, Frames};
pub use protocol::{Hello, TextKind};
pub(crate) use segmenter::{ClipPrompt, Object, Segmented};
pub use segmenter::{Segmenter, TextGrounder};
use serde_json::Value;

use self::process::Process;
use self::protocol::Segment;

/// Processes that may fail one after the other, without an answer in between, before the worker is given up: the
/// two tries of two questions.
const FAILURES_IN_A_ROW: u32 = 4;

/// How a worker is started.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Launch {
    /// The program: an interpreter, a script, anything that speaks the protocol.
    pub program: PathBuf,
    pub arguments: Vec<OsString>,
    /// Variables that are set for it beside those of this process.
    pub environment: BTreeMap<String, OsString>,
}

/// How long a worker is waited for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WorkerTimeouts {
    /// From its start to its hello: large weights take their time.
    pub hello: Duration,
    /// Without any line while something is asked.
    pub silence: Duration,
    /// For one answer.
    pub answer: Duration,
    /// To leave by itself at `shutdown`.
    pub farewell: Duration,
}

impl Default for WorkerTimeouts {
    fn default() -> Self {
        let seconds = Duration::from_secs;
        Self { hello: seconds(600), silence: seconds(120), answer: seconds(3600), farewell: seconds(2) }
    }
}

/// A worker. Threads share it by reference and take turns. It dies with this value, with everything that it started.
#[derive(Debug)]
pub struct Worker {
    launch: Launch,
    timeouts: WorkerTimeouts,
    hello: Hello,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    process: Option<Process>,
    /// Of the latest request.
    id: u64,
    failures_in_a_row: u32,
    last_failure: String,
}

impl Worker {
    /// Starts a worker and waits for its hello.
    ///
    /// # Errors
    /// The program cannot be run, or does not get ready.
    pub fn start(launch: Launch, timeouts: WorkerTimeouts) -> Result<Self, WorkerError> {
        let process = Process::start(&launch, timeouts)?;
        let hello = process.hello().clone();
        let state =
            State { process: Some(process), id: 0, failures_in_a_row: 0, last_failure: String::new() };
        Ok(Self { launch, timeouts, hello, state: Mutex::new(state) })
    }

    /// What it says of itself.
    fn hello(&self) -> &Hello {
        &self.hello
    }

    /// Asks for masks and waits; masks are by index of the frame. A process that fails is replaced once; what it was
    /// asked is asked again.
    fn segment(
        &self,
        frames: &Frames,
        prompts: &[Value],
        range: [u32; 2],
        threshold: f64,
    ) -> Result<Segmented, WorkerError> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let mut is_first_try = true;
        loop {
            state.id += 1;
            let id = state.id;
            let process = self.running(&mut state)?;
            let result = process.segment(&Segment { id, frames, prompts, range, threshold });
            match &result {
                Ok(_) => state.failures_in_a_row = 0,
                Err(error @ WorkerError::Process { .. }) => {
                    state.process = None;
                    state.fail(error);
                    if is_first_try {
                        tracing::warn!("{error}; starting it again");
                        is_first_try = false;
                        continue;
                    }
                }
                Err(_) => {}
            }
            return result;
        }
    }

    /// The process, started anew if the last one failed.
    fn running<'a>(&self, state: &'a mut State) -> Result<&'a mut Process, WorkerError> {
        if state.process.is_none() {
            if state.failures_in_a_row >= FAILURES_IN_A_ROW {
                let State { failures_in_a_row: failures, last_failure: last, .. } = state;
                return Err(WorkerError::given_up(&self.hello.name, *failures, last));
            }
            let started = Process::start(&self.launch, self.timeouts).and_then(|process| {
                // Answers are kept under the hello of the first one.
                if process.hello() == &self.hello {
                    return Ok(process);
                }
                let message = "it says another hello than when it was first started";
                Err(WorkerError::breaks_protocol(&self.hello.name, message))
            });
            match started {
                Ok(process) => state.process = Some(process),
                Err(error) => {
                    state.fail(&error);
                    return Err(error);
                }
            }
        }
        Ok(state.process.as_mut().expect("it was just started"))
    }
}

impl State {
    fn fail(&mut self, error: &WorkerError) {
        self.failures_in_a_row += 1;
        self.last_failure = error.to_string();
    }
}
