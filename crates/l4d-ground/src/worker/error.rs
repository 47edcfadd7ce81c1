//! What can go wrong with a worker, and what becomes of the view.

use std::io;
use std::time::Duration;

use l4d_data::DataError;

use crate::grounder::Outcome;
use crate::unread::Unread;

/// An error of a worker, its process or its answer.
#[derive(Debug, thiserror::Error)]
pub enum WorkerError {
    /// The frames could not be written for it.
    #[error(transparent)]
    Data(#[from] DataError),
    /// The program cannot be run.
    #[error("the worker `{program}` cannot be started: {source}")]
    Start {
        /// What was to be run.
        program: String,
        /// The operating system's words.
        source: io::Error,
    },
    /// It ended, or closed its output.
    #[error("the worker `{worker}` ended early ({status}){}", last_words(tail))]
    Died {
        /// Its name, or the program before it told its name.
        worker: String,
        /// Exit status or signal.
        status: String,
        /// The end of what it wrote to stderr.
        tail: String,
    },
    /// It says nothing any more.
    #[error("the worker `{worker}` {what} for {} seconds{}", waited.as_secs_f64(), last_words(tail))]
    Hangs {
        /// Its name.
        worker: String,
        /// What it did not do.
        what: &'static str,
        /// How long it was waited for.
        waited: Duration,
        /// The end of what it wrote to stderr.
        tail: String,
    },
    /// It says what the protocol does not know, or what was not asked.
    #[error("the worker `{worker}` breaks the protocol: {message}")]
    Protocol {
        /// Its name.
        worker: String,
        /// In what way.
        message: String,
    },
    /// A mask, a frame or an object that was not asked for. The process goes on.
    #[error("the answer of the worker `{worker}` is of no use: {message}")]
    Answer {
        /// Its name.
        worker: String,
        /// What is wrong with it.
        message: String,
    },
    /// It refused, in its own words.
    #[error("the worker `{worker}` says `{kind}`: {message}")]
    Refused {
        /// Its name.
        worker: String,
        /// Kind of its error: `bad_text`, `bad_prompt`, `frames`, `oom`, `internal`.
        kind: String,
        /// Its words.
        message: String,
    },
    /// It cannot do what is asked of it at all.
    #[error("the worker `{worker}` cannot be used here: {message}")]
    Unfit {
        /// Its name.
        worker: String,
        /// What it lacks.
        message: String,
    },
    /// It failed so often that it is not started again.
    #[error("the worker `{worker}` was given up after {failures} failures in a row, the last one: {last}")]
    GivenUp {
        /// Its name.
        worker: String,
        /// How many.
        failures: u32,
        /// The last one.
        last: String,
    },
}

impl WorkerError {
    /// Whether the process is of no use any more.
    pub(super) fn is_of_process(&self) -> bool {
        matches!(self, Self::Died { .. } | Self::Hangs { .. } | Self::Protocol { .. })
    }

    /// What becomes of the view that was asked about.
    pub fn outcome(&self) -> Outcome {
        match self {
            Self::Refused { kind, message, .. } if kind == "bad_text" => {
                Outcome::Unsupported(Unread::whole(message))
            }
            Self::Data(error) => Outcome::of_data_error(error),
            error => Outcome::Error(format!("{error}; {}", error.hint())),
        }
    }

    /// What to do about it.
    pub fn hint(&self) -> String {
        match self {
            Self::Data(error) => error.hint().unwrap_or_default(),
            Self::Start { .. } => "check the path of the program, or let l4d make its environment".to_owned(),
            Self::Died { .. } | Self::GivenUp { .. } => {
                "run it by hand with the same arguments and see its log; if memory ran out, use a smaller model or fewer frames"
                    .to_owned()
            }
            Self::Hangs { .. } => {
                "see its log; a slow processor may need more patience, or a smaller model".to_owned()
            }
            Self::Protocol { .. } | Self::Answer { .. } => {
                "see docs/workers.md; `l4d_workers` takes care of stdout for workers in Python".to_owned()
            }
            Self::Refused { kind, .. } if kind == "oom" => {
                "use a smaller model, a shorter range, or --device cpu".to_owned()
            }
            Self::Refused { .. } => "see docs/workers.md for what each worker takes".to_owned(),
            Self::Unfit { .. } => "choose another worker or another coupling".to_owned(),
        }
    }
}

fn last_words(tail: &str) -> String {
    if tail.is_empty() { String::new() } else { format!("; it wrote:\n{tail}") }
}
