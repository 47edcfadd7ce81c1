//! The loop: inputs become messages, messages become effects, effects are carried out, the screen is drawn.

use std::io;
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

use l4d_votes::{Ballot, Event, ItemId, Round, ShownFrames};
use ratatui::Terminal;
use ratatui::backend::Backend;
use ratatui::crossterm::event::Event as TerminalEvent;

use crate::error::{AnnotateError, in_full};
use crate::keys;
use crate::message::{Effect, Message, Recorded};
use crate::model::{Model, Question};
use crate::paint_thread::PaintThread;
use crate::painter::Painter;
use crate::update::{start, update};
use crate::view;

/// What comes from outside.
#[derive(Debug)]
pub(crate) enum Input {
    Event(TerminalEvent),
    Message(Message),
    Signal(&'static str),
    Lost(io::Error),
    PainterDied,
}

/// Keeps an event; with `Ok` it survives whatever happens to the process.
pub(crate) fn record(
    ballot: &mut Ballot,
    item: ItemId,
    event: Event,
    seen: ShownFrames,
    elapsed: Duration,
) -> Result<Recorded, String> {
    ballot.record(&item, event.clone(), seen, elapsed).map_err(|error| in_full(&error))?;
    let response = ballot.response(&item).unwrap_or_default();
    Ok(Recorded { item, event, response, undoable: ballot.undoable().cloned() })
}

pub(crate) struct Session {
    pub(crate) model: Model,
    ballot: Ballot,
    paint_thread: PaintThread,
    started: Instant,
    redraw: bool,
    over: bool,
}

impl Session {
    /// A session whose first picture is asked for already.
    pub(crate) fn new(mut model: Model, ballot: Ballot, paint_thread: PaintThread) -> Self {
        let effects = start(&mut model);
        let mut session =
            Self { model, ballot, paint_thread, started: Instant::now(), redraw: false, over: false };
        effects.into_iter().for_each(|effect| session.carry_out(effect));
        session
    }

    /// Serves the terminal until the person leaves.
    ///
    /// # Errors
    /// The terminal or the painter is lost, or a signal came.
    pub(crate) fn serve<B: Backend>(
        &mut self,
        terminal: &mut Terminal<B>,
        inputs: &Receiver<Input>,
    ) -> Result<(), AnnotateError> {
        while !self.over {
            self.draw(terminal)?;
            let Some(input) = self.wait(inputs) else { continue };
            self.take(input)?;
            // Whatever piled up meanwhile is one change of the screen, not many.
            while let Ok(input) = inputs.try_recv() {
                self.take(input)?;
            }
        }
        Ok(())
    }

    fn draw<B: Backend>(&mut self, terminal: &mut Terminal<B>) -> Result<(), AnnotateError> {
        let failed = |error: B::Error| AnnotateError::Terminal(io::Error::other(error.to_string()));
        if std::mem::take(&mut self.redraw) {
            terminal.clear().map_err(failed)?;
        }
        let mut size = self.model.size;
        terminal
            .draw(|frame| {
                size = frame.area().as_size();
                if size == self.model.size {
                    view::draw(&self.model, frame.area(), frame.buffer_mut());
                }
            })
            .map_err(failed)?;
        // The terminal can be ahead of its own news.
        if size != self.model.size {
            self.tell(Message::Resize(size));
            return self.draw(terminal);
        }
        Ok(())
    }

    /// The next input; none if only time passed.
    fn wait(&mut self, inputs: &Receiver<Input>) -> Option<Input> {
        let received = match self.model.wakes_at() {
            None => inputs.recv().map_err(RecvTimeoutError::from),
            Some(due) => inputs.recv_timeout(due.saturating_sub(self.started.elapsed())),
        };
        match received {
            Ok(input) => Some(input),
            Err(RecvTimeoutError::Timeout) => {
                self.tell(Message::Tick);
                None
            }
            Err(RecvTimeoutError::Disconnected) => {
                self.over = true;
                None
            }
        }
    }

    fn take(&mut self, input: Input) -> Result<(), AnnotateError> {
        match input {
            Input::Event(event) if keys::is_interrupt(&event) => self.over = true,
            Input::Event(event) => {
                if let Some(message) = keys::message(&self.model.mode, event) {
                    self.tell(message);
                }
            }
            Input::Message(message) => self.tell(message),
            Input::Signal(name) => return Err(AnnotateError::Signal(name)),
            Input::Lost(error) => return Err(AnnotateError::Terminal(error)),
            Input::PainterDied => return Err(AnnotateError::PainterDied),
        }
        Ok(())
    }

    fn tell(&mut self, message: Message) {
        if self.over {
            return;
        }
        let effects = update(&mut self.model, message, self.started.elapsed());
        effects.into_iter().for_each(|effect| self.carry_out(effect));
    }

    fn carry_out(&mut self, effect: Effect) {
        match effect {
            Effect::Paint { request, ahead } => self.paint_thread.paint(request, ahead),
            Effect::Export(request) => self.paint_thread.export(request),
            Effect::Record { item, event, seen, elapsed } => {
                let result = record(&mut self.ballot, item, event, seen, elapsed);
                self.tell(Message::Recorded(result));
            }
            Effect::Seal => {
                let result = self.ballot.seal().map_err(|error| in_full(&error));
                self.tell(Message::Sealed(result));
            }
            Effect::Redraw => self.redraw = true,
            Effect::Quit => self.over = true,
        }
    }
}

/// The questions of a ballot, in asking order.
pub(crate) fn questions(round: &Round, ballot: &Ballot) -> Vec<Question> {
    let question = |id: &ItemId| {
        let item = round.item(id)?;
        Some(Question {
            id: id.clone(),
            text: item.text.clone(),
            scene: item.scene.clone(),
            response: ballot.response(id).unwrap_or_default(),
        })
    };
    ballot.order().iter().filter_map(question).collect()
}

pub(crate) type Sender = mpsc::Sender<Input>;

/// A painter in a thread of its own that answers to a loop.
pub(crate) fn paint_thread(painter: Painter, inputs: &Sender) -> PaintThread {
    let (news, alarm) = (inputs.clone(), inputs.clone());
    // A loop that is over needs no news.
    let send = move |message| drop(news.send(Input::Message(message)));
    let died = move || drop(alarm.send(Input::PainterDied));
    PaintThread::open(painter, send, died)
}

#[cfg(test)]
mod tests;
