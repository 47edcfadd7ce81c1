//! What words imply: verbs for geometry (one in no list implies nothing), and which words are colours.

use std::collections::BTreeSet;

const HOLDING: &str = "hold carry pull push move drag grip hug ride wear curl";
const MEETING: &str = "lift put_down pick_up take bat kick touch pet stroke tap poke press hit catch turn_over spin \
                       drink eat type grasp hand_over turn nudge stack throw drink_from type_on turn_page open \
                       roll_down";
const MOVING: &str = "walk run roll slide drive swim fly trot glide chase swing fall jump jog waddle rise circle land \
                      pull_out brake";
const RESTING: &str = "stand sit sleep lie rest wait kneel crouch perch stay lean";
const QUIET: &str = "watch look_at face hold grip wear listen point_at phone fill empty";
/// As sentences and attributes use them.
const COLOURS: &str = "red orange yellow green blue purple violet pink brown black white grey gray beige cream russet \
                       silver golden gold turquoise teal navy maroon ginger tan ochre olive mint lilac crimson dark \
                       light coral mustard";

/// Every verb of the lists, sorted, none twice.
pub fn lexicon() -> BTreeSet<&'static str> {
    [HOLDING, MEETING, MOVING, RESTING, QUIET].into_iter().flat_map(str::split_whitespace).collect()
}

/// Both are in contact all the time.
pub fn is_holding(verb: &str) -> bool {
    is_among(HOLDING, verb)
}

/// Both meet at some time.
pub fn is_meeting(verb: &str) -> bool {
    is_among(MEETING, verb)
}

/// The box of the subject travels.
pub fn is_moving(verb: &str) -> bool {
    is_among(MOVING, verb)
}

/// A mere state rather than something that happens: the box of the subject stays where it is.
pub fn is_state(verb: &str) -> bool {
    is_among(RESTING, verb)
}

/// Whether it can be done without moving.
pub fn is_quiet(verb: &str) -> bool {
    is_state(verb) || is_among(QUIET, verb)
}

/// Whether it names a colour.
pub fn is_colour(word: &str) -> bool {
    is_among(COLOURS, word)
}

/// Whether a list of words has this one.
pub(crate) fn is_among(list: &str, word: &str) -> bool {
    list.split_whitespace().any(|other| other == word)
}
