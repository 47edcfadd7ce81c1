//! Segmenters in processes of their own: prompts and frames in, masks out, over JSON Lines (docs/workers.md).
//!
//! This module owns the other end of the protocol: starting a worker, asking it, and what becomes of a view when it
//! dies, hangs, floods or says what cannot be. It refuses to know what runs inside a worker and who wrote the prompts.

mod book;
pub mod error;
pub mod frames;
mod process;
pub mod protocol;
mod segmenter;
mod text;

use std::ffi::OsString;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

pub use book::{Answer, Found};
pub use error::WorkerError;
pub use frames::{FrameStore, Frames};
pub use protocol::{Hello, Prompt, TextKind, What};
pub use segmenter::{ClipPrompt, Object, Segmented, Segmenter};
pub use text::TextGrounder;

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
    /// Its arguments.
    pub arguments: Vec<OsString>,
    /// Variables that are set for it beside those of this process.
    pub environment: Vec<(String, OsString)>,
}

/// How long a worker is waited for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Patience {
    /// From its start to its hello: large weights take their time.
    pub hello: Duration,
    /// Without any line while something is asked.
    pub silence: Duration,
    /// For one answer, from when everything before it was answered.
    pub answer: Duration,
    /// To leave by itself when it is told to.
    pub farewell: Duration,
}

impl Default for Patience {
    fn default() -> Self {
        let seconds = Duration::from_secs;
        Self { hello: seconds(600), silence: seconds(120), answer: seconds(3600), farewell: seconds(2) }
    }
}

/// A worker. Threads share it by reference; what they ask waits in its queue. It dies with this value, with
/// everything that it started.
#[derive(Debug)]
pub struct Worker {
    launch: Launch,
    patience: Patience,
    hello: Hello,
    next_id: AtomicU64,
    state: Mutex<State>,
}

#[derive(Debug)]
struct State {
    process: Option<Arc<Process>>,
    failures_in_a_row: u32,
    last_failure: String,
}

impl Worker {
    /// Starts a worker and waits for its hello.
    pub fn start(launch: Launch, patience: Patience) -> Result<Self, WorkerError> {
        let process = Process::start(&launch, patience)?;
        let hello = process.hello().clone();
        let state =
            State { process: Some(Arc::new(process)), failures_in_a_row: 0, last_failure: String::new() };
        Ok(Self { launch, patience, hello, next_id: AtomicU64::new(1), state: Mutex::new(state) })
    }

    /// Who it says it is.
    pub fn hello(&self) -> &Hello {
        &self.hello
    }

    /// Asks for masks and waits. A process that fails is replaced once; what it was asked is asked again.
    pub fn segment(
        &self,
        frames: &Frames,
        prompts: &[Prompt],
        range: [u32; 2],
        threshold: f64,
    ) -> Result<Answer, WorkerError> {
        let mut is_first_try = true;
        loop {
            let process = self.running()?;
            let id = self.next_id.fetch_add(1, Ordering::Relaxed);
            let result = process.segment(&Segment { id, frames, prompts, range, threshold });
            match &result {
                Ok(_) => self.state().failures_in_a_row = 0,
                Err(error) if error.is_of_process() => {
                    self.bury(&process, error);
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
    fn running(&self) -> Result<Arc<Process>, WorkerError> {
        let mut state = self.state();
        if let Some(process) = &state.process {
            return Ok(Arc::clone(process));
        }
        if state.failures_in_a_row >= FAILURES_IN_A_ROW {
            let (worker, last) = (self.hello.name.clone(), state.last_failure.clone());
            return Err(WorkerError::GivenUp { worker, failures: state.failures_in_a_row, last });
        }
        let started = Process::start(&self.launch, self.patience).and_then(|process| {
            // Answers are kept under the hello of the first one.
            if process.hello() == &self.hello { Ok(process) } else { Err(self.changed()) }
        });
        match started {
            Ok(process) => {
                let process = Arc::new(process);
                state.process = Some(Arc::clone(&process));
                Ok(process)
            }
            Err(error) => {
                state.failures_in_a_row += 1;
                state.last_failure = error.to_string();
                Err(error)
            }
        }
    }

    fn changed(&self) -> WorkerError {
        let message = "says another hello than when it was first started".to_owned();
        WorkerError::Protocol { worker: self.hello.name.clone(), message }
    }

    /// Lets go of a process that failed. Several threads may notice; it counts once.
    fn bury(&self, process: &Arc<Process>, error: &WorkerError) {
        let mut state = self.state();
        if state.process.as_ref().is_some_and(|current| Arc::ptr_eq(current, process)) {
            state.process = None;
            state.failures_in_a_row += 1;
            state.last_failure = error.to_string();
        }
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
