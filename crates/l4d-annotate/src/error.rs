//! Why a session cannot start or go on.

use std::io;

use l4d_data::DataError;

/// Why a session cannot start or go on.
#[derive(Debug, thiserror::Error)]
pub enum AnnotateError {
    /// A file of the round, the scenes or the ballot.
    #[error(transparent)]
    Data(#[from] DataError),
    /// Input or output is no terminal.
    #[error("this needs a terminal, and {0} is none")]
    NoTerminal(&'static str),
    /// The terminal cannot place text.
    #[error("the terminal says that it is `{0}`, which cannot place text on the screen")]
    DumbTerminal(String),
    /// The terminal broke.
    #[error("the terminal cannot be used")]
    Terminal(#[source] io::Error),
    /// A signal ended the session.
    #[error("ended by {0}; everything that was shown as saved is saved")]
    Signal(&'static str),
    /// The thread that paints pictures ended.
    #[error("the painter of the pictures failed; everything that was shown as saved is saved")]
    PainterDied,
}

impl AnnotateError {
    /// What to do about it.
    pub fn hint(&self) -> &str {
        match self {
            Self::Data(error) => error.hint(),
            Self::NoTerminal(_) => "run the command in a terminal window, or over ssh with `ssh -t`",
            Self::DumbTerminal(_) => "set TERM to what the terminal is, for example xterm-256color",
            Self::Terminal(_) | Self::Signal(_) | Self::PainterDied => {
                "run the command again: it goes on where it stopped"
            }
        }
    }
}

/// An error with its causes and its hint, in one line: what fits on the screen of a session.
pub(crate) fn in_full(error: &DataError) -> String {
    let mut text = error.to_string();
    let mut cause = std::error::Error::source(error);
    while let Some(error) = cause {
        text = format!("{text}: {error}");
        cause = error.source();
    }
    format!("{text}; {}", error.hint())
}
