//! Stable codes of what gathering scores finds.

/// A folder among the scores that holds no scored method.
pub const NOT_SCORED: &str = "L4D411";
/// A method that was scored on another profile, protocol, benchmark version or truth.
pub const OTHER_BOARD: &str = "L4D412";
/// Masks of a method that are not those that were scored.
pub const OTHER_MASKS: &str = "L4D413";
