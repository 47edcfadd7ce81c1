//! Stable codes of what reading a round and its ballots finds.

/// The log of an annotator is missing or cannot be read.
pub const NO_BALLOT: &str = "L4D503";
/// A log of an annotator whom the round does not name.
pub const STRANGER: &str = "L4D504";
/// The last line of a log was not written to its end.
pub const TORN_LINE: &str = "L4D510";
/// A log was edited: a line is not the one that its successor names.
pub const EDITED: &str = "L4D511";
/// A line that this l4d cannot read, though it was not edited since.
pub const UNREADABLE_LINE: &str = "L4D512";
/// A line of another round or of another annotator.
pub const FOREIGN_LINE: &str = "L4D513";
/// A line about an item that the round does not have.
pub const UNKNOWN_ITEM: &str = "L4D514";
/// The clock went backwards between two lines.
pub const CLOCK_BACKWARDS: &str = "L4D515";
/// An undo where nothing was left to undo.
pub const IDLE_UNDO: &str = "L4D516";
/// A line after the seal.
pub const AFTER_SEAL: &str = "L4D517";
/// A seal that does not fit the lines before it.
pub const BROKEN_SEAL: &str = "L4D518";
/// Answers to an earlier wording or scene.
pub const STALE_VOTES: &str = "L4D519";
/// A ballot that is not sealed yet.
pub const NOT_SEALED: &str = "L4D520";
/// A query was changed or removed after the round was opened.
pub const STALE_ITEM: &str = "L4D521";
/// An annotator is wrong on more control items than the round allows.
pub const GOLD_MISSED: &str = "L4D522";
