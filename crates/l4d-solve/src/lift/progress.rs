//! How far a lift is, step by step, and how it is stopped between steps.

use std::ops::ControlFlow;

use super::error::LiftError;

/// What a lift is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Phase {
    /// Pixels vote on Gaussians.
    Votes,
    /// SIRT.
    Steps,
    /// Levels are tried.
    Threshold,
    /// The identity field learns.
    Learning,
}

/// A step that is about to be taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// What is done.
    pub phase: Phase,
    /// Steps taken so far, over all phases.
    pub done: usize,
    /// Steps in all, as far as is known: some phases learn from those before how long they take.
    pub all: usize,
    /// The last loss of the field, where one learns.
    pub loss: Option<f64>,
}

/// Told before every step; `Break` ends the lift.
pub type Listener<'a> = dyn FnMut(Progress) -> ControlFlow<()> + 'a;

/// Counts steps for a listener.
pub(super) struct Reporter<'a> {
    listener: &'a mut Listener<'a>,
    done: usize,
    all: usize,
    loss: Option<f64>,
}

impl<'a> Reporter<'a> {
    pub(super) fn new(listener: &'a mut Listener<'a>) -> Self {
        Self { listener, done: 0, all: 0, loss: None }
    }

    /// So many steps are to come.
    pub(super) fn expect(&mut self, steps: usize) {
        self.all += steps;
    }

    /// The loss of the step just taken.
    pub(super) fn loss(&mut self, loss: f64) {
        self.loss = Some(loss);
    }

    /// One step begins.
    pub(super) fn step(&mut self, phase: Phase) -> Result<(), LiftError> {
        let progress = Progress { phase, done: self.done, all: self.all, loss: self.loss };
        self.done += 1;
        match (self.listener)(progress) {
            ControlFlow::Continue(()) => Ok(()),
            ControlFlow::Break(()) => Err(LiftError::Cancelled),
        }
    }
}
