//! How sure an answer is, and what nearly was the answer.
//!
//! The confidence is the mean over all views of what each says of its own choice, 0 for a view that found nothing. What
//! it is worth was counted on `benchmark/dev` (docs/notes/panopticquery.md, "How sure an answer is").

use std::collections::BTreeMap;
use std::fmt;

use l4d_ground::RunnerUp;
use serde::Serialize;

use crate::consensus::Decision;
use crate::solve::Solved;

/// Below it, at most two answers in five were right on dev.
const UNSURE_BELOW: f64 = 0.35;
/// A runner-up with more than this share of the confidence of the answer is close.
const CLOSE: f64 = 0.8;

/// How sure an answer is.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(super) struct Sureness {
    /// 0 to 1.
    confidence: f64,
    /// Whether the confidence is low, the runner-up of some view close, or no two views agree.
    unsure: bool,
    /// The next best thing, with its mean over all views.
    #[serde(skip_serializing_if = "Option::is_none")]
    runner_up: Option<RunnerUp>,
}

impl Sureness {
    /// Of an answer; none where no view says how sure it is.
    pub(super) fn of(solved: &Solved) -> Option<Self> {
        let evidence = &solved.consensus.evidence;
        let chosen = |&view: &usize| solved.groundings.get(view)?.choice.as_ref();
        let choices: Vec<_> = evidence.iter().filter_map(chosen).collect();
        if choices.is_empty() {
            return None;
        }
        let views = solved.groundings.iter().filter(|grounding| grounding.outcome.is_answer()).count();
        let confidence = choices.iter().map(|choice| choice.confidence).sum::<f64>() / views.max(1) as f64;
        let runners_up = || choices.iter().filter_map(|choice| choice.runner_up.as_ref());
        let is_close = runners_up().any(|next| next.confidence > CLOSE * confidence);
        let no_two_agree = matches!(solved.consensus.decision, Decision::NoneReliableAll | Decision::TiedAll);
        let mut sums: BTreeMap<&str, f64> = BTreeMap::new();
        runners_up().for_each(|next| *sums.entry(&next.noun).or_default() += next.confidence);
        let next_best = sums.into_iter().max_by(|(_, a), (_, b)| a.total_cmp(b));
        let runner_up = next_best
            .map(|(noun, sum)| RunnerUp { noun: noun.to_owned(), confidence: sum / views.max(1) as f64 });
        Some(Self { confidence, unsure: confidence < UNSURE_BELOW || is_close || no_two_agree, runner_up })
    }
}

impl fmt::Display for Sureness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(if self.unsure { "unsure, " } else { "" })?;
        write!(f, "confidence {:.2}", self.confidence)?;
        self.runner_up
            .as_ref()
            .map_or(Ok(()), |next| write!(f, ", next best a {} with {:.2}", next.noun, next.confidence))
    }
}

#[cfg(test)]
mod tests {
    use l4d_ground::{Choice, Grounding, Outcome};

    use super::*;
    use crate::account::Account;
    use crate::consensus::{Preset, consensus};

    fn view(choice: Option<(f64, Option<f64>)>) -> Grounding {
        let outcome = if choice.is_some() { Outcome::Found } else { Outcome::Absent };
        let choice = choice.map(|(confidence, next)| Choice {
            confidence,
            runner_up: next.map(|confidence| RunnerUp { noun: "cup".to_owned(), confidence }),
        });
        Grounding { choice, ..Grounding::without_answer(outcome) }
    }

    fn of(groundings: Vec<Grounding>, evidence: &[usize]) -> Option<String> {
        let mut agreed = consensus(&[], &Preset::Robust.settings());
        agreed.evidence = evidence.to_vec();
        let solved = Solved { groundings, consensus: agreed, lifted: None, account: Account::default() };
        Sureness::of(&solved).map(|sureness| sureness.to_string())
    }

    #[test]
    fn views_that_found_nothing_make_it_less_sure() {
        let two = || vec![view(Some((0.8, Some(0.1)))), view(Some((0.6, None)))];
        assert_eq!(of(two(), &[0, 1]).unwrap(), "confidence 0.70, next best a cup with 0.05");
        let three = [two(), vec![view(None), view(None)]].concat();
        assert_eq!(of(three, &[0, 1]).unwrap(), "confidence 0.35, next best a cup with 0.03");
        assert_eq!(of(two(), &[1]).unwrap(), "unsure, confidence 0.30");
    }

    #[test]
    fn a_close_runner_up_makes_it_unsure_and_silence_says_nothing() {
        let close = of(vec![view(Some((0.9, Some(0.8))))], &[0]).unwrap();
        assert_eq!(close, "unsure, confidence 0.90, next best a cup with 0.80");
        assert_eq!(of(vec![view(None)], &[]), None);
        assert_eq!(of(vec![Grounding::without_answer(Outcome::Found)], &[0]), None);
    }
}
