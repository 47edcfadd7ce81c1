//! Properties, said and denied.

use l4d_query::Clause;

use super::clause::Slot;
use super::{Said, said};
use crate::lexicon::{Way, lexicon};

/// Adjectives in their usual order: size, shape, state, pattern, colour, what it is made of.
fn order(key: &str) -> u8 {
    match key {
        "size" => 1,
        "shape" | "shell" => 2,
        "state" | "content" | "finish" => 3,
        "pattern" => 4,
        "material" | "wicker" => 6,
        _ => 5,
    }
}

/// Where a property may be said, and for how much.
pub(super) fn slots(category: &str, key: &str, value: &str) -> Vec<(Slot, f64)> {
    let is_person = lexicon().is_person(category);
    let mut found = Vec::new();
    let wordings = lexicon().wordings(category, key, value);
    for (index, wording) in wordings.iter().filter(|wording| wording.is_said).enumerate() {
        let price = 0.1 * index as f64;
        let text = &wording.text;
        let mut add = |slot: Slot, more: f64| found.push((slot, price + more));
        match wording.way {
            Way::Adjective => {
                add(Slot::Before(order(key), text.clone()), 0.0);
                add(Slot::Relative(format!("is {text}")), 0.4);
            }
            Way::Before => add(Slot::Before(6, text.clone()), 0.0),
            Way::Noun => {
                add(Slot::Noun(text.clone()), 0.0);
                add(Slot::Relative(format!("is a {text}")), 0.3);
            }
            Way::Contents => add(Slot::After(0, format!("of {text}")), 0.0),
            Way::Is => {
                add(Slot::After(2, text.clone()), 0.1);
                add(Slot::Relative(format!("is {text}")), 0.3);
            }
            Way::Has => {
                add(Slot::After(2, format!("with {text}")), 0.0);
                add(Slot::Relative(format!("has {text}")), 0.3);
            }
            Way::Lacks => {
                add(Slot::After(2, format!("without {text}")), 0.0);
                add(Slot::Relative(format!("has no {}", without_article(text))), 0.4);
            }
            Way::Wears if is_person => {
                add(Slot::After(1, format!("in {text}")), 0.0);
                add(Slot::After(1, format!("wearing {text}")), 0.1);
                add(Slot::Relative(format!("is wearing {text}")), 0.3);
                add(Slot::Relative(format!("wears {text}")), 0.4);
            }
            Way::Wears => {
                add(Slot::After(1, format!("wearing {text}")), 0.1);
                add(Slot::Relative(format!("is wearing {text}")), 0.4);
            }
        }
    }
    found
}

/// The same of a property that it does not have.
pub(super) fn denied(category: &str, key: &str, value: &str) -> Vec<(Slot, f64)> {
    let mut found = Vec::new();
    for (index, wording) in lexicon().wordings(category, key, value).iter().enumerate() {
        let price = 0.1 * index as f64;
        let text = &wording.text;
        let mut add = |slot: Slot, more: f64| {
            if wording.is_said {
                found.push((slot, price + more));
            }
        };
        match wording.way {
            Way::Adjective | Way::Is => add(Slot::Relative(format!("is not {text}")), 0.0),
            Way::Has => {
                add(Slot::After(2, format!("without {text}")), 0.0);
                add(Slot::Relative(format!("does not have {text}")), 0.2);
            }
            Way::Wears => {
                add(Slot::Relative(format!("is not wearing {text}")), 0.0);
                add(Slot::After(1, format!("not wearing {text}")), 0.3);
            }
            Way::Lacks => add(Slot::After(2, format!("with {text}")), 0.0),
            Way::Noun => add(Slot::Relative(format!("is not a {text}")), 0.0),
            Way::Before | Way::Contents => {}
        }
    }
    found
}

/// After "is": only what can be said there.
pub(super) fn after_is(category: &str, clause: &Clause) -> Vec<Said> {
    let slots = match clause {
        Clause::Attribute { key, value } => slots(category, key, value),
        _ => Vec::new(),
    };
    let relative = slots.into_iter().filter_map(|(slot, cost)| match slot {
        Slot::Relative(text) => Some(said(text, cost)),
        _ => None,
    });
    relative.collect()
}

fn without_article(text: &str) -> &str {
    ["a ", "an ", "the "].iter().find_map(|article| text.strip_prefix(article)).unwrap_or(text)
}
