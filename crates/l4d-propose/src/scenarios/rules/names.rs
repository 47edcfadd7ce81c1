//! Names that explain themselves, and no two that are the same.

use std::collections::BTreeSet;

use l4d_data::Name;

use super::super::Draft;
use super::Known;
use crate::listing::excerpt;
use crate::reason::Reason;

const CODE: &str = "L4D572";
/// Words that say nothing about a thing.
const EMPTY_WORDS: [&str; 6] = ["object", "thing", "item", "instance", "entity", "scene"];

pub(super) fn problems(draft: &Draft, known: &Known) -> Vec<Reason> {
    let mut reasons = Vec::new();
    reasons.extend(scene_problem(draft, known));
    let mut taken = BTreeSet::new();
    let objects = draft.objects().map(|(_, member)| (&member.name, 2));
    let landmarks = draft.landmarks.iter().map(|landmark| (&landmark.name, 1));
    for (name, fewest_words) in objects.chain(landmarks) {
        if let Some(message) = problem(name, fewest_words) {
            let hint = "say what it is and what becomes of it, such as `cup_by_lamp`";
            reasons.push(Reason::new(CODE, excerpt(name), message, hint));
        }
        if !taken.insert(name) {
            reasons.push(Reason::new(CODE, excerpt(name), "is the name of two things", "rename one of them"));
        }
    }
    reasons
}

fn scene_problem(draft: &Draft, known: &Known) -> Option<Reason> {
    let refuse = |message: String, hint: &str| Some(Reason::new(CODE, "name", message, hint));
    let name = &draft.name;
    let scale = draft.scale.as_str();
    if let Some(message) = problem(name, 2) {
        return refuse(format!("`{}` {message}", excerpt(name)), "write `<scale>_<what>`");
    }
    if name.split('_').next() != Some(scale) {
        return refuse(format!("`{name}` does not begin with `{scale}_`"), "write `<scale>_<what>`");
    }
    if known.scenes.contains(name) {
        return refuse(format!("`{name}` exists already"), "invent another scene");
    }
    None
}

/// Lower-case words joined by `_`, none of them a single letter or empty of meaning.
fn problem(name: &str, fewest_words: usize) -> Option<String> {
    let words: Vec<&str> = name.split('_').collect();
    let is_word = |word: &&str| word.len() >= 2 && word.bytes().all(|byte| byte.is_ascii_lowercase());
    if Name::new(name).is_err() || !words.iter().all(is_word) {
        return Some("is not made of lower-case words joined by `_`".to_owned());
    }
    if words.len() < fewest_words {
        return Some(format!("has fewer than {fewest_words} words"));
    }
    let empty = words.iter().find(|word| EMPTY_WORDS.contains(word))?;
    Some(format!("says `{empty}`, which explains nothing"))
}
