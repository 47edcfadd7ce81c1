//! What verbs imply for geometry. A verb in no list implies nothing.

use std::collections::BTreeSet;

/// Both are in contact all the time.
pub const HOLDING: [&str; 11] =
    ["hold", "carry", "pull", "push", "move", "drag", "grip", "hug", "ride", "wear", "curl"];
/// Both meet at some time.
pub const MEETING: [&str; 30] = [
    "lift",
    "put_down",
    "pick_up",
    "take",
    "bat",
    "kick",
    "touch",
    "pet",
    "stroke",
    "tap",
    "poke",
    "press",
    "hit",
    "catch",
    "turn_over",
    "spin",
    "drink",
    "eat",
    "type",
    "grasp",
    "hand_over",
    "turn",
    "nudge",
    "stack",
    "throw",
    "drink_from",
    "type_on",
    "turn_page",
    "open",
    "roll_down",
];
/// The box of the subject travels.
pub const MOVING: [&str; 20] = [
    "walk", "run", "roll", "slide", "drive", "swim", "fly", "trot", "glide", "chase", "swing", "fall",
    "jump", "jog", "waddle", "rise", "circle", "land", "pull_out", "brake",
];
/// The box of the subject stays where it is: mere states.
pub const RESTING: [&str; 11] =
    ["stand", "sit", "sleep", "lie", "rest", "wait", "kneel", "crouch", "perch", "stay", "lean"];
/// What can be done without moving.
const QUIET: [&str; 11] =
    ["watch", "look_at", "face", "hold", "grip", "wear", "listen", "point_at", "phone", "fill", "empty"];

/// Every verb of the lists, sorted, none twice.
pub fn lexicon() -> BTreeSet<&'static str> {
    [&HOLDING[..], &MEETING, &MOVING, &RESTING, &QUIET].into_iter().flatten().copied().collect()
}

/// Whether it can be done without moving.
pub fn is_quiet(verb: &str) -> bool {
    RESTING.contains(&verb) || QUIET.contains(&verb)
}

/// Whether it is a mere state rather than something that happens.
pub fn is_state(verb: &str) -> bool {
    RESTING.contains(&verb)
}
