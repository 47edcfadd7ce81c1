//! When a prompt counts as understood: rules as data, as `round.toml` states them.

use std::fmt;
use std::str::FromStr;

use l4d_data::Interval;
use serde::{Deserialize, Serialize};

/// How many of the annotators have to be right: `unanimous:5`, `majority:3/5`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Rule {
    /// Right answers that make a prompt valid.
    pub needed: usize,
    /// Distinct annotators who have to answer.
    pub annotators: usize,
}

/// Why a string is no rule.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{}` is not a rule: {hint}", text.escape_debug())]
pub struct RuleError {
    text: String,
    hint: &'static str,
}

impl RuleError {
    fn new(text: &str, hint: &'static str) -> Self {
        Self { text: text.chars().take(40).collect(), hint }
    }
}

impl FromStr for Rule {
    type Err = RuleError;

    fn from_str(text: &str) -> Result<Self, RuleError> {
        const HINT: &str =
            "write `unanimous:5`, or `majority:3/5` with more than half, at most 99 annotators";
        let refuse = || RuleError::new(text, HINT);
        let number = |digits: &str| match digits.parse::<usize>() {
            Ok(number @ 1..=99) if digits.bytes().all(|byte| byte.is_ascii_digit()) => Ok(number),
            _ => Err(refuse()),
        };
        let (needed, annotators) = match text.split_once(':') {
            Some(("unanimous", all)) => (number(all)?, number(all)?),
            Some(("majority", share)) => {
                let (needed, all) = share.split_once('/').ok_or_else(refuse)?;
                (number(needed)?, number(all)?)
            }
            _ => return Err(refuse()),
        };
        let possible = needed <= annotators && 2 * needed > annotators;
        if possible { Ok(Self { needed, annotators }) } else { Err(refuse()) }
    }
}

impl TryFrom<String> for Rule {
    type Error = RuleError;

    fn try_from(text: String) -> Result<Self, RuleError> {
        text.parse()
    }
}

impl From<Rule> for String {
    fn from(rule: Rule) -> Self {
        rule.to_string()
    }
}

impl fmt::Display for Rule {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { needed, annotators } = self;
        if needed == annotators {
            write!(formatter, "unanimous:{annotators}")
        } else {
            write!(formatter, "majority:{needed}/{annotators}")
        }
    }
}

/// How well the frames of an answer have to fit a prompt that is bound to a time: `any`, `iou:0.5`.
///
/// Prompts that name an identity hold in the whole clip, so any frames fit them.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum FrameRule {
    /// At least one frame in common.
    #[default]
    Any,
    /// At least this share of the frames that either names is named by both; in (0, 1].
    Iou(f64),
}

impl FrameRule {
    /// Whether an answered interval fits the intervals in which the prompt holds (ascending, disjoint).
    pub fn accepts(self, answered: Interval, holds: &[Interval]) -> bool {
        let shared: u64 = holds.iter().map(|interval| shared_frames(answered, *interval)).sum();
        let named: u64 = holds.iter().map(|interval| shared_frames(*interval, *interval)).sum();
        match self {
            Self::Any => shared > 0,
            Self::Iou(least) => {
                let either = named + shared_frames(answered, answered) - shared;
                shared as f64 >= least * either as f64
            }
        }
    }
}

fn shared_frames(a: Interval, b: Interval) -> u64 {
    let first = a.first().max(b.first());
    let last = a.last().min(b.last());
    (u64::from(last) + 1).saturating_sub(u64::from(first))
}

impl FromStr for FrameRule {
    type Err = RuleError;

    fn from_str(text: &str) -> Result<Self, RuleError> {
        let share = text.strip_prefix("iou:").and_then(|share| share.parse::<f64>().ok());
        match share {
            None if text == "any" => Ok(Self::Any),
            Some(share) if share > 0.0 && share <= 1.0 => Ok(Self::Iou(share)),
            _ => Err(RuleError::new(text, "write `any`, or `iou:` and a share above 0 and up to 1")),
        }
    }
}

impl TryFrom<String> for FrameRule {
    type Error = RuleError;

    fn try_from(text: String) -> Result<Self, RuleError> {
        text.parse()
    }
}

impl From<FrameRule> for String {
    fn from(rule: FrameRule) -> Self {
        rule.to_string()
    }
}

impl fmt::Display for FrameRule {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Any => formatter.write_str("any"),
            Self::Iou(share) => write!(formatter, "iou:{share}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::interval;

    #[test]
    fn rules_round_trip() {
        for (text, needed, annotators) in
            [("unanimous:5", 5, 5), ("majority:3/5", 3, 5), ("unanimous:1", 1, 1)]
        {
            let rule: Rule = text.parse().unwrap();
            assert_eq!((rule.needed, rule.annotators), (needed, annotators));
            assert_eq!(rule.to_string(), text);
        }
    }

    #[test]
    fn rules_that_say_nothing_are_refused() {
        for text in [
            "",
            "unanimous",
            "unanimous:0",
            "unanimous:x",
            "unanimous:+5",
            "unanimous:100",
            "majority:6/5",
            "majority:2/4",
            "majority:3",
            "Unanimous:5",
            "unanimous:5 ",
            "majority:99999999999999999999/5",
        ] {
            assert!(text.parse::<Rule>().is_err(), "{text:?} was taken for a rule");
        }
        for text in ["", "iou", "iou:", "iou:0", "iou:1.1", "iou:NaN", "iou:-1", "iou:inf", "all"] {
            assert!(text.parse::<FrameRule>().is_err(), "{text:?} was taken for a rule");
        }
    }

    #[test]
    fn frames_overlap_by_the_rule() {
        let holds = [interval(10, 19), interval(40, 49)];
        assert!(FrameRule::Any.accepts(Interval::WHOLE, &holds));
        assert!(FrameRule::Any.accepts(interval(0, 10), &holds));
        assert!(!FrameRule::Any.accepts(interval(20, 39), &holds));
        // 10 shared of 20 named by either.
        assert!(FrameRule::Iou(0.5).accepts(interval(10, 19), &holds));
        // 20 shared of 97.
        assert!(!FrameRule::Iou(0.21).accepts(Interval::WHOLE, &holds));
        assert!(FrameRule::Iou(0.2).accepts(Interval::WHOLE, &holds));
        assert!(!FrameRule::Any.accepts(interval(5, 9), &holds));
    }

    #[test]
    fn an_interval_at_the_end_of_numbers_does_not_overflow() {
        let huge = interval(0, u32::MAX);
        assert!(FrameRule::Any.accepts(huge, &[huge]));
        assert!(FrameRule::Iou(1.0).accepts(huge, &[huge]));
        assert!(!FrameRule::Iou(0.1).accepts(huge, &[Interval::WHOLE]));
    }
}
