//! What goes into [`crate::update`] (messages: keys, ticks, results of effects) and what comes out of it (effects: work
//! that the session does outside the model). Knows neither keys nor the terminal's protocol.

use std::sync::Arc;
use std::time::Duration;

use l4d_votes::{Event, ItemId, Response, ShownFrames};
use ratatui::layout::Size;
use tui_input::InputRequest;

use crate::picture::{ExportRequest, Picture, PictureRequest};

#[derive(Debug, Clone)]
pub(crate) enum Message {
    Digit(char),
    /// The answer that no object fits the prompt.
    None,
    /// The prompt could mean several things; the annotator is asked for the reason.
    Ambiguous,
    Accept,
    Back,
    /// Discard everything that was not saved.
    Clear,
    Edit(InputRequest),
    Paste(String),
    /// Frames forwards, or backwards if negative; stops at the ends of the clip.
    StepFrame(i64),
    StepView(i64),
    Play,
    /// The answer holds from the shown frame on.
    HoldsFrom,
    HoldsUntil,
    HoldsAlways,
    /// Steps in, or out if negative.
    Zoom(i32),
    /// Zoom to the chosen objects, or out to the whole picture.
    ZoomToChosen,
    /// Move the shown part, in eighths of it, right and down.
    Pan(i32, i32),
    Outlines,
    Skip,
    Comment,
    Undo,
    StepItem(i64),
    /// Write the picture with outlines to a file and open it.
    Export,
    /// The list of what is left, where the ballot is sealed.
    Summary,
    /// Seal the ballot, in the summary.
    Seal,
    StepLine(i64),
    Help,
    Quit,
    Resize(Size),
    Tick,
    Painted(Arc<Picture>),
    /// A picture cannot be shown; the text says why.
    NotPainted(PictureRequest, String),
    Recorded(Result<Recorded, String>),
    Sealed(Result<(), String>),
    /// What became of an export, in one sentence.
    Exported(Result<String, String>),
}

/// An event that is on disk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Recorded {
    pub(crate) item: ItemId,
    pub(crate) event: Event,
    /// The answer to the item after the event, as the log has it.
    pub(crate) response: Response,
    /// The item that an undo would change now.
    pub(crate) undoable: Option<ItemId>,
}

/// What the session does for the model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Effect {
    /// Paint a picture instead of any that was asked for before.
    Paint {
        request: PictureRequest,
        /// Frames that are likely to be asked for next.
        ahead: Vec<u32>,
    },
    /// Write an event to the log and answer with [`Message::Recorded`].
    Record {
        item: ItemId,
        event: Event,
        /// What was on the screen before it.
        seen: ShownFrames,
        /// How long the item was on the screen.
        elapsed: Duration,
    },
    /// Seal the ballot and answer with [`Message::Sealed`].
    Seal,
    /// Write a picture to a file and answer with [`Message::Exported`].
    Export(ExportRequest),
    /// Draw every cell again: the terminal may show something else than what was last drawn.
    Redraw,
    Quit,
}
