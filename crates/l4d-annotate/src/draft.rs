//! The answer in the making: what would be saved if it were saved now.

use std::collections::BTreeSet;

use l4d_data::Interval;
use l4d_votes::{Answer, Choice};

use crate::scene::SceneInfo;

/// What the prompt means, in numbers on the screen.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum DraftChoice {
    /// These; nothing said yet if there are none.
    Objects(BTreeSet<usize>),
    None,
    /// One cannot tell, because.
    Ambiguous(String),
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Draft {
    pub(crate) choice: DraftChoice,
    /// When; none is the whole clip.
    pub(crate) frames: Option<Interval>,
    /// The first digits of a number that is not complete.
    pub(crate) typed: String,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Digit {
    /// It completed a number, which was put in or taken out.
    Took,
    /// It may be the start of a longer number.
    Waits,
    /// No object has such a number.
    Unknown,
}

impl Default for Draft {
    fn default() -> Self {
        Self { choice: DraftChoice::Objects(BTreeSet::new()), frames: None, typed: String::new() }
    }
}

impl Draft {
    /// Whether nothing is said yet.
    pub(crate) fn is_blank(&self) -> bool {
        matches!(&self.choice, DraftChoice::Objects(numbers) if numbers.is_empty()) && self.typed.is_empty()
    }

    pub(crate) fn numbers(&self) -> impl Iterator<Item = usize> {
        let numbers = match &self.choice {
            DraftChoice::Objects(numbers) => Some(numbers.iter().copied()),
            DraftChoice::None | DraftChoice::Ambiguous(_) => None,
        };
        numbers.into_iter().flatten()
    }

    /// Puts a number in, or takes it out; whatever else was said is withdrawn.
    pub(crate) fn toggle(&mut self, number: usize) {
        self.typed.clear();
        let mut numbers: BTreeSet<usize> = self.numbers().collect();
        if !numbers.remove(&number) {
            numbers.insert(number);
        }
        self.choice = DraftChoice::Objects(numbers);
    }

    /// Reads a number of 1 to `count`, digit by digit; it is complete when no further digit can follow.
    pub(crate) fn digit(&mut self, digit: char, count: usize) -> Digit {
        let typed = format!("{}{digit}", self.typed);
        let Some(number) = typed.parse().ok().filter(|number| (1..=count).contains(number)) else {
            self.typed.clear();
            return Digit::Unknown;
        };
        if number * 10 <= count {
            self.typed = typed;
            return Digit::Waits;
        }
        self.toggle(number);
        Digit::Took
    }

    /// Takes what was typed so far for the whole number.
    pub(crate) fn finish_number(&mut self) {
        if let Ok(number) = self.typed.parse() {
            self.toggle(number);
        }
    }

    pub(crate) fn holds(&self, scene: &SceneInfo) -> Interval {
        self.frames.unwrap_or_else(|| scene.whole())
    }

    /// What would be saved; none while nothing is said.
    pub(crate) fn answer(&self, scene: &SceneInfo) -> Option<Answer> {
        let choice = match &self.choice {
            DraftChoice::None => Choice::None,
            DraftChoice::Ambiguous(reason) => Choice::Ambiguous { reason: reason.clone() },
            DraftChoice::Objects(numbers) if numbers.is_empty() => return None,
            DraftChoice::Objects(numbers) => {
                let name = |number: &usize| scene.object(*number).map(|object| object.name.clone());
                Choice::Objects(numbers.iter().filter_map(name).collect())
            }
        };
        Some(Answer { choice, frames: self.holds(scene) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn after(digits: &str, count: usize) -> (Vec<usize>, String, Digit) {
        let mut draft = Draft::default();
        let last = digits.chars().map(|digit| draft.digit(digit, count)).last().unwrap();
        (draft.numbers().collect(), draft.typed, last)
    }

    #[test]
    fn up_to_nine_objects_a_digit_is_a_number() {
        assert_eq!(after("35", 5), (vec![3, 5], String::new(), Digit::Took));
        assert_eq!(after("353", 5), (vec![5], String::new(), Digit::Took));
        assert_eq!(after("6", 5), (vec![], String::new(), Digit::Unknown));
        assert_eq!(after("0", 5), (vec![], String::new(), Digit::Unknown));
    }

    #[test]
    fn with_more_objects_a_first_digit_waits_for_the_second() {
        assert_eq!(after("1", 12), (vec![], "1".to_owned(), Digit::Waits));
        assert_eq!(after("11", 12), (vec![11], String::new(), Digit::Took));
        assert_eq!(after("2", 12), (vec![2], String::new(), Digit::Took));
        assert_eq!(after("13", 12), (vec![], String::new(), Digit::Unknown));
        let mut draft = Draft::default();
        draft.digit('1', 12);
        draft.finish_number();
        assert_eq!(draft.numbers().collect::<Vec<usize>>(), [1]);
    }

    #[test]
    fn a_number_withdraws_what_was_said_before() {
        for choice in [DraftChoice::None, DraftChoice::Ambiguous("two cats".to_owned())] {
            let mut draft = Draft { choice, ..Draft::default() };
            draft.toggle(2);
            assert_eq!(draft.choice, DraftChoice::Objects([2].into()));
        }
    }
}
