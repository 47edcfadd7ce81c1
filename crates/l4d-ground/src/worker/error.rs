//! What can go wrong with a worker, and what becomes of the view.

use std::time::Duration;

use l4d_data::DataError;

use crate::grounder::Outcome;
use crate::unreadable::Unreadable;

/// An error of a worker, its process or its answer.
#[derive(Debug, thiserror::Error)]
pub enum WorkerError {
    /// The frames could not be written for it.
    #[error(transparent)]
    Data(#[from] DataError),
    /// Its process cannot be started, ended, hangs, breaks the protocol or was given up.
    #[error("the worker `{worker}` {message}")]
    Process {
        /// Its name, or the program before it told its name.
        worker: String,
        /// What it did.
        message: String,
        /// What to do about it.
        hint: &'static str,
    },
    /// A mask, a frame or an object that was not asked for. The process goes on.
    #[error("the answer of the worker `{worker}` is of no use: {message}")]
    Answer {
        worker: String,
        /// What is wrong with it.
        message: String,
    },
    /// It refused, in its own words. The process goes on.
    #[error("the worker `{worker}` says `{kind}`: {message}")]
    Refused {
        worker: String,
        /// Kind of its error: `bad_text`, `bad_prompt`, `frames`, `oom`, `internal`.
        kind: String,
        message: String,
    },
    /// It cannot do what is asked of it at all.
    #[error("the worker `{worker}` cannot be used here: {message}")]
    Unfit {
        worker: String,
        /// What it lacks.
        message: String,
    },
}

const RUN_BY_HAND: &str = "run it by hand with the same arguments and see its log; if memory ran out, use a smaller model or fewer frames";
const READ_THE_PROTOCOL: &str =
    "see docs/workers.md; `l4d_workers` takes care of stdout for workers in Python";

impl WorkerError {
    pub(super) fn not_started(program: &str, source: &std::io::Error) -> Self {
        let hint = "check the path of the program, or let l4d make its environment";
        Self::process(program, format!("cannot be started: {source}"), hint)
    }

    /// `log` is the end of what it wrote to stderr.
    pub(super) fn died(worker: &str, status: &str, log: &str) -> Self {
        Self::process(worker, format!("ended early ({status}){}", last_words(log)), RUN_BY_HAND)
    }

    pub(super) fn hangs(worker: &str, what: &str, waited: Duration, log: &str) -> Self {
        let hint = "see its log; a slow processor may need longer timeouts, or a smaller model";
        let message = format!("{what} for {} seconds{}", waited.as_secs_f64(), last_words(log));
        Self::process(worker, message, hint)
    }

    pub(super) fn breaks_protocol(worker: &str, message: &str) -> Self {
        Self::process(worker, format!("breaks the protocol: {message}"), READ_THE_PROTOCOL)
    }

    pub(super) fn given_up(worker: &str, failures: u32, last: &str) -> Self {
        let message = format!("was given up after {failures} failures in a row, the last one: {last}");
        Self::process(worker, message, RUN_BY_HAND)
    }

    fn process(worker: &str, message: String, hint: &'static str) -> Self {
        Self::Process { worker: worker.to_owned(), message, hint }
    }

    /// What becomes of the view that was asked about.
    pub fn outcome(&self) -> Outcome {
        match self {
            Self::Refused { kind, message, .. } if kind == "bad_text" => {
                Outcome::Unsupported(Unreadable::whole(message))
            }
            Self::Data(error) => Outcome::of_data_error(error),
            error => Outcome::Error(format!("{error}; {}", error.hint())),
        }
    }

    /// What to do about it.
    pub fn hint(&self) -> &str {
        match self {
            Self::Data(error) => error.hint(),
            Self::Process { hint, .. } => hint,
            Self::Answer { .. } => READ_THE_PROTOCOL,
            Self::Refused { kind, .. } if kind == "oom" => {
                "use a smaller model, a shorter range, or --device cpu"
            }
            Self::Refused { .. } => "see docs/workers.md for what each worker takes",
            Self::Unfit { .. } => "choose another worker or another coupling",
        }
    }
}

fn last_words(log: &str) -> String {
    if log.is_empty() { String::new() } else { format!("; it wrote:\n{log}") }
}
