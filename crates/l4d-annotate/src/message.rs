//! Messages into [`crate::update`], and the effects that come out of it.

use std::sync::Arc;
use std::time::Duration;

use l4d_votes::{Event, ItemId, Response, ShownFrames};
use ratatui::layout::Size;
use tui_input::InputRequest;

use crate::picture::{ExportRequest, Picture, PictureRequest};

/// An event.
#[derive(Debug, Clone)]
pub(crate) enum Message {
    /// A digit of an object's number.
    Digit(char),
    /// The prompt means nothing in the scene.
    None,
    /// The prompt could mean several things; the reason is asked.
    Ambiguous,
    /// Enter: go on with what is on the screen.
    Accept,
    /// Escape: one step back.
    Back,
    /// Take everything back that was not saved.
    Clear,
    /// A key in a line of text.
    Edit(InputRequest),
    /// Text from the clipboard.
    Paste(String),
    /// Frames forwards, or backwards if negative; stops at the ends of the clip.
    StepFrame(i64),
    /// Views forwards, or backwards if negative.
    StepView(i64),
    /// Play or stop.
    Play,
    /// The answer holds from this frame on.
    HoldsFrom,
    /// The answer holds up to this frame.
    HoldsUntil,
    /// The answer holds in the whole clip.
    HoldsAlways,
    /// Zoom in by steps, or out if negative.
    Zoom(i32),
    /// Zoom to the chosen objects, or out to the whole picture.
    ZoomToChosen,
    /// Move the shown part, in eighths of it, right and down.
    Pan(i32, i32),
    /// Show or hide outlines.
    Outlines,
    /// Leave the item without an answer.
    Skip,
    /// Write a remark.
    Comment,
    /// Take the latest event back.
    Undo,
    /// Items forwards, or backwards if negative.
    StepItem(i64),
    /// Write the picture with outlines to a file and open it.
    Export,
    /// The list of what is left, where the ballot is sealed.
    Summary,
    /// Seal the ballot, in the summary.
    Seal,
    /// Lines down in a list, or up if negative.
    StepLine(i64),
    /// The list of keys.
    Help,
    /// Leave.
    Quit,
    /// The left button went down on a cell.
    Press(u16, u16),
    /// The pointer moved with the button down.
    Drag(u16, u16),
    /// The button went up.
    Release(u16, u16),
    /// The wheel turned over a cell, away from the hand if positive.
    Wheel(u16, u16, i32),
    /// The terminal has another size.
    Resize(Size),
    /// Time passed.
    Tick,
    /// A picture is ready.
    Painted(Arc<Picture>),
    /// A picture cannot be shown, and why.
    NotPainted(PictureRequest, String),
    /// What the log said to an event.
    Recorded(Result<Recorded, String>),
    /// What the log said to the seal.
    Sealed(Result<(), String>),
    /// What became of an export, in one sentence.
    Exported(Result<String, String>),
}

/// An event that is on disk.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Recorded {
    /// The item.
    pub(crate) item: ItemId,
    /// What the log says about it now.
    pub(crate) response: Response,
    /// The item that an undo would change now.
    pub(crate) undoable: Option<ItemId>,
}

/// What the session does for the model.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Effect {
    /// Paint a picture instead of any that was asked for before.
    Paint {
        /// The picture.
        request: PictureRequest,
        /// Frames that are likely to be asked for next.
        ahead: Vec<u32>,
    },
    /// Write an event to the log and answer with [`Message::Recorded`].
    Record {
        /// The item.
        item: ItemId,
        /// The event.
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
    /// Draw every cell again: what was on the screen is not what the terminal shows.
    Redraw,
    /// Leave.
    Quit,
}
