//! From files to a session on the terminal of the process.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::mpsc;

use l4d_data::Name;
use l4d_votes::{Ballot, Round};
use ratatui::Terminal;
use ratatui::backend::CrosstermBackend;
use ratatui::crossterm::event;
use ratatui_image::picker::ProtocolType;
use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
use signal_hook::iterator::Signals;

use crate::error::AnnotateError;
use crate::look::Environment;
use crate::model::Model;
use crate::painter::Painter;
use crate::scene::Scenes;
use crate::session::{Input, Sender, Session, paint_thread, questions};
use crate::terminal::TerminalGuard;

/// Where files are, and how pictures are shown.
#[derive(Debug, Clone)]
pub struct Options {
    /// Folder of the rendered scenes.
    pub data: PathBuf,
    /// Folder that receives pictures which the person opens.
    pub exports: PathBuf,
    /// Whether pictures are characters even where the terminal could show pixels.
    pub characters: bool,
}

/// How far the work is when the person leaves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Outcome {
    /// Items of the round.
    pub items: usize,
    /// Items with an answer.
    pub answered: usize,
    /// Items that were skipped.
    pub skipped: usize,
    /// Whether the work is over.
    pub sealed: bool,
}

/// Lets a person answer on the terminal of the process until they leave.
///
/// # Errors
/// There is no terminal that can show the session, it was lost, or a signal ended the session.
pub fn annotate(
    round: &Round,
    ballot: Ballot,
    annotator: &Name,
    scenes: Scenes,
    options: &Options,
) -> Result<Outcome, AnnotateError> {
    let environment = Environment::of_process();
    let look = environment.look()?;
    let taken = TerminalGuard::take()?;
    let can_ask = !options.characters && taken.answers(!environment.tmux.is_empty());
    let (look, picker) = if can_ask { look.ask() } else { (look, None) };
    if picker.as_ref().is_some_and(|picker| picker.protocol_type() == ProtocolType::Kitty) {
        taken.keeps_pictures();
    }
    let mut terminal =
        Terminal::new(CrosstermBackend::new(std::io::stdout())).map_err(AnnotateError::Terminal)?;
    let (send, inputs) = mpsc::channel();
    listen(&send)?;

    let scenes = Arc::new(scenes);
    let (questions, undoable) = (questions(round, &ballot), ballot.undoable().cloned());
    let size = terminal.size().map_err(AnnotateError::Terminal)?;
    let model = Model::new(round, annotator.clone(), questions, undoable, Arc::clone(&scenes), look, size);
    let painter = Painter::new(&options.data, &options.exports, scenes, look, picker);
    let mut session = Session::new(model, ballot, paint_thread(painter, &send));
    session.serve(&mut terminal, &inputs)?;
    let (answered, skipped) = session.model.progress();
    Ok(Outcome { items: round.items.len(), answered, skipped, sealed: session.model.sealed })
}

/// Sends what the terminal and the system say, until the process ends.
fn listen(send: &Sender) -> Result<(), AnnotateError> {
    let mut signals = Signals::new([SIGTERM, SIGHUP, SIGINT, SIGQUIT]).map_err(AnnotateError::Terminal)?;
    let to_loop = send.clone();
    std::thread::spawn(move || {
        for signal in &mut signals {
            let name = match signal {
                SIGTERM => "SIGTERM",
                SIGHUP => "SIGHUP",
                SIGINT => "SIGINT",
                _ => "SIGQUIT",
            };
            drop(to_loop.send(Input::Signal(name)));
        }
    });
    let to_loop = send.clone();
    std::thread::spawn(move || {
        loop {
            let input = event::read();
            let is_lost = input.is_err();
            if to_loop.send(input.map_or_else(Input::Lost, Input::Event)).is_err() || is_lost {
                return;
            }
        }
    });
    Ok(())
}
