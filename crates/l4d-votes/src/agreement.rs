//! How much people agreed before anything was thrown out; after filtering, agreement is 1 by construction.
//!
//! An answer to an item as it is in `items.jsonl` counts, sealed or not, whatever its verdict. An edit of the benchmark
//! after the vote makes the *verdict* stale, but not what people said: leaving such items out would leave out the
//! rejected ones, which are the ones that get edited. Control items and the second answer to a repeated prompt do not
//! enter. Items with two categories count in both, and once overall.
//!
//! Identification has no label that means the same for all items, and chance correction needs some. So two readings are
//! reported (`docs/annotation.md` says which to quote). `choice`: the label is what was chosen, behind the name of its
//! scene unless it is "none" or "ambiguous"; chance draws from the labels of the whole set, so alpha and AC1 are near
//! the raw figure. `right`: the label is whether the answer is right, so q = 2.
//!
//! Answers within a scene depend on each other, so all intervals are 95 % percentile intervals of a bootstrap that
//! draws whole scenes, seeded by the round.

mod bootstrap;
mod coefficients;
#[cfg(test)]
mod tests;

use std::collections::{BTreeMap, BTreeSet};

use l4d_data::{Category, Name};
use serde::Serialize;

use self::bootstrap::{DRAWS, Estimate, bootstrap};
use self::coefficients::{NO_VOTES, ac1, alpha, raw};
use crate::control::{self, Consistency};
use crate::key::Key;
use crate::responses::Responses;
use crate::round::Round;
use crate::verdict::{ItemVerdict, Mark, Verdicts, judge};
use crate::vote::{Answer, Choice};

/// `agreement.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Agreement {
    pub schema: &'static str,
    pub round: Name,
    pub simulated: bool,
    pub is_final: bool,
    pub draws: usize,
    pub seed: u64,
    pub overall: Group,
    pub categories: BTreeMap<Category, Group>,
    /// In the order of `round.toml`.
    pub annotators: Vec<Annotator>,
}

/// Agreement on a group of queries.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Group {
    pub items: usize,
    /// Queries that all annotators answered.
    pub complete: usize,
    pub answers: usize,
    pub choice: Coefficients,
    pub right: Coefficients,
    /// Of the complete queries: the share to which all answers are the same choice.
    pub unanimous: Estimate,
    /// Of the complete queries: the share to which all answers are right.
    pub understood: Estimate,
    /// Complete queries by the number of right answers, from 0 to all.
    pub histogram: Vec<usize>,
    /// The human ceiling: the share of single answers that are right.
    pub ceiling: Estimate,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Coefficients {
    /// Labels that chance draws from (q).
    pub labels: usize,
    pub raw: Estimate,
    pub alpha: Estimate,
    pub ac1: Estimate,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Annotator {
    pub name: Name,
    pub sealed: bool,
    pub answered: usize,
    pub skipped: usize,
    /// Answers to queries that are right.
    pub right: usize,
    /// Sentences whose right answer is known.
    pub gold: Consistency,
    /// Prompts that were asked twice.
    pub repeats: Consistency,
}

/// Agreement, consistency and the human ceiling of a round.
pub fn measure(round: &Round, key: &Key, responses: &[Responses]) -> Agreement {
    // What became of the benchmark since changes nothing of what was said.
    let verdicts = judge(round, key, responses, &BTreeMap::new());
    let group = |category: Option<Category>| {
        let is_in =
            |verdict: &&ItemVerdict| category.is_none_or(|wanted| verdict.categories.contains(&wanted));
        let chosen: Vec<&ItemVerdict> = verdicts.items.iter().filter(is_in).collect();
        measure_group(round, &chosen, category.map_or("overall", Category::as_str))
    };
    let occurring: BTreeSet<Category> =
        verdicts.items.iter().flat_map(|verdict| verdict.categories.iter().copied()).collect();
    Agreement {
        schema: "l4d/agreement/1",
        round: round.name.clone(),
        simulated: round.simulated,
        is_final: verdicts.is_final,
        draws: DRAWS,
        seed: round.seed,
        overall: group(None),
        categories: occurring.into_iter().map(|category| (category, group(Some(category)))).collect(),
        annotators: responses
            .iter()
            .enumerate()
            .map(|(place, given)| annotator(key, &verdicts, place, given))
            .collect(),
    }
}

/// The answers to a query that count, with whether they are right.
fn answers(verdict: &ItemVerdict) -> Vec<(&Answer, bool)> {
    let counted = verdict.votes.iter().filter(|vote| vote.mark.counts());
    counted.filter_map(|vote| Some((vote.answer.as_ref()?, vote.mark == Mark::Right))).collect()
}

/// The answers to a query that count, as codes of what was chosen, and 1 where that is right.
struct Unit {
    chosen: Vec<u32>,
    right: Vec<u32>,
}

fn measure_group(round: &Round, verdicts: &[&ItemVerdict], name: &str) -> Group {
    let mut codes: BTreeMap<String, u32> = BTreeMap::new();
    let mut scenes: BTreeMap<&Name, Vec<Unit>> = BTreeMap::new();
    for verdict in verdicts {
        let (scene, answers) = (&verdict.query.scene, answers(verdict));
        let code = |(answer, _): &(&Answer, bool)| {
            let label = match &answer.choice {
                Choice::Objects(_) => format!("{scene}/{}", answer.choice.label()),
                Choice::None | Choice::Ambiguous { .. } => answer.choice.label(),
            };
            let next = codes.len() as u32;
            *codes.entry(label).or_insert(next)
        };
        let chosen = answers.iter().map(code).collect();
        let right = answers.iter().map(|(_, right)| u32::from(*right)).collect();
        scenes.entry(scene).or_default().push(Unit { chosen, right });
    }
    let scenes: Vec<Vec<Unit>> = scenes.into_values().collect();
    let all = round.annotators.len();
    let is_complete = |unit: &&Unit| unit.right.len() == all;
    let mut histogram = vec![0; all + 1];
    for unit in scenes.iter().flatten().filter(is_complete) {
        histogram[unit.right.iter().sum::<u32>() as usize] += 1;
    }

    let estimates = bootstrap(scenes.len(), round.seed, name, |drawn| {
        let units: Vec<&Unit> = drawn.iter().flat_map(|&scene| &scenes[scene]).collect();
        let chosen: Vec<&[u32]> = units.iter().map(|unit| unit.chosen.as_slice()).collect();
        let right: Vec<&[u32]> = units.iter().map(|unit| unit.right.as_slice()).collect();
        let complete: Vec<&Unit> = units.into_iter().filter(is_complete).collect();
        let is_same = |unit: &Unit| unit.chosen.iter().all(|code| *code == unit.chosen[0]);
        let is_right = |unit: &Unit| unit.right.iter().all(|right| *right == 1);
        [
            raw(&chosen),
            alpha(&chosen),
            ac1(&chosen, codes.len()),
            raw(&right),
            alpha(&right),
            ac1(&right, 2),
            share(complete.iter().map(|unit| is_same(unit))),
            share(complete.iter().map(|unit| is_right(unit))),
            share(right.concat().into_iter().map(|right| right == 1)),
        ]
    });
    let [choice_raw, choice_alpha, choice_ac1, raw, alpha, ac1, unanimous, understood, ceiling] = estimates;
    Group {
        items: verdicts.len(),
        complete: histogram.iter().sum(),
        answers: scenes.iter().flatten().map(|unit| unit.right.len()).sum(),
        choice: Coefficients { labels: codes.len(), raw: choice_raw, alpha: choice_alpha, ac1: choice_ac1 },
        right: Coefficients { labels: 2, raw, alpha, ac1 },
        unanimous,
        understood,
        histogram,
        ceiling,
    }
}

fn share(holds: impl Iterator<Item = bool>) -> Result<f64, &'static str> {
    let (part, all) =
        holds.fold((0.0, 0.0), |(part, all), holds| (part + f64::from(u8::from(holds)), all + 1.0));
    if all > 0.0 { Ok(part / all) } else { Err(NO_VOTES) }
}

/// The annotator of this place in `round.toml`.
fn annotator(key: &Key, verdicts: &Verdicts, place: usize, given: &Responses) -> Annotator {
    let count = |is_meant: fn(Mark) -> bool| {
        verdicts.items.iter().filter(|verdict| is_meant(verdict.votes[place].mark)).count()
    };
    Annotator {
        name: given.annotator.clone(),
        sealed: given.sealed,
        answered: count(Mark::counts),
        skipped: count(|mark| mark == Mark::Skipped),
        right: count(|mark| mark == Mark::Right),
        gold: control::gold(key, given),
        repeats: control::repeats(key, given),
    }
}
