//! Questions that wait, the one that is being answered, and the answers.

use std::collections::{BTreeMap, VecDeque};
use std::fmt::Display;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use l4d_data::{Progress, StageError};
use serde::Serialize;
use serde_json::Value;

use crate::Answerer;

/// Questions that may wait.
pub(crate) const MOST_WAITING: usize = 8;
/// Answers that are kept; the oldest goes first.
const MOST_KEPT: usize = 64;

/// How far a question is.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[serde(tag = "state", rename_all = "snake_case")]
pub(crate) enum State {
    /// Others are answered before it.
    Waiting { ahead: usize },
    /// It is being answered. `total` is 0 where it is not known.
    Running { stage: &'static str, done: u64, total: u64 },
    /// What came of it.
    Answered { answer: Value },
    /// Why there is no answer.
    Failed { message: String, hint: String },
}

#[derive(Debug, Default)]
struct Book {
    last: u64,
    waiting: VecDeque<(u64, String)>,
    states: BTreeMap<u64, State>,
}

/// One question at a time: the solver takes all cores.
#[derive(Debug, Default)]
pub(crate) struct Desk {
    book: Mutex<Book>,
    asked: Condvar,
}

impl Desk {
    /// Takes a question; none while too many wait.
    pub(crate) fn ask(&self, text: String) -> Option<u64> {
        let mut book = self.book();
        if book.waiting.len() >= MOST_WAITING {
            return None;
        }
        book.last += 1;
        let id = book.last;
        book.waiting.push_back((id, text));
        self.asked.notify_one();
        Some(id)
    }

    /// How far a question is; none for one that was never asked or is long forgotten.
    pub(crate) fn state(&self, id: u64) -> Option<State> {
        let book = self.book();
        let waits = book.waiting.iter().position(|(waiting, _)| *waiting == id);
        waits.map(|ahead| State::Waiting { ahead }).or_else(|| book.states.get(&id).cloned())
    }

    /// Answers one question after the other, for ever.
    pub(crate) fn work(&self, answerer: &Answerer) {
        loop {
            let (id, text) = self.next();
            let told = Told { desk: self, id };
            let answered = catch_unwind(AssertUnwindSafe(|| answerer(&text, &told)));
            let state = match answered {
                Ok(Ok(answer)) => State::Answered { answer },
                Ok(Err(error)) => failed(&error),
                Err(_) => failed(&StageError::new("the solver broke down", "ask again, or something else")),
            };
            self.tell(id, state);
        }
    }

    fn next(&self) -> (u64, String) {
        let mut book = self.book();
        loop {
            if let Some((id, text)) = book.waiting.pop_front() {
                book.states.insert(id, State::Running { stage: "beginning", done: 0, total: 0 });
                return (id, text);
            }
            book = self.asked.wait(book).unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn tell(&self, id: u64, state: State) {
        let mut book = self.book();
        book.states.insert(id, state);
        while book.states.len() > MOST_KEPT {
            book.states.pop_first();
        }
    }

    fn book(&self) -> MutexGuard<'_, Book> {
        self.book.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn failed(error: &StageError) -> State {
    State::Failed { message: error.to_string(), hint: error.hint().to_owned() }
}

/// The progress of a question.
struct Told<'a> {
    desk: &'a Desk,
    id: u64,
}

impl Progress for Told<'_> {
    fn start(&self, stage: &'static str, total: u64) {
        self.desk.tell(self.id, State::Running { stage, done: 0, total });
    }

    fn item(&self, _: &dyn Display) {}

    fn advance(&self, steps: u64) {
        if let Some(State::Running { done, .. }) = self.desk.book().states.get_mut(&self.id) {
            *done += steps;
        }
    }

    fn finish(&self) {}

    fn note(&self, _: &dyn Display) {}

    fn warn(&self, _: &dyn Display) {}
}
