//! How much people agreed before anything was thrown out; after filtering, agreement is 1 by construction.
//!
//! # What counts
//!
//! Every answer that was given to an item as it is in `items.jsonl`, sealed or not, whatever its verdict. An
//! edit of the benchmark after the vote makes the *verdict* stale, but not what people said: leaving such items
//! out would leave out the rejected ones, which are the ones that get edited. Control items and the second answer
//! to a repeated prompt do not enter. Items with two categories count in both, and once overall.
//!
//! # Two codings of one answer
//!
//! Identification has no label that means the same for all items, and chance correction needs some. So both
//! readings are reported, under their names:
//!
//! - `choice`: the label is what was chosen ([`Choice::label`](crate::Choice::label), behind the name of its scene
//!   unless it is "none" or "ambiguous"). Its *raw* agreement is how often two people gave the same answer, right
//!   or wrong, and needs no ground truth: quote that one. Its alpha and AC1 let chance draw from the labels of the
//!   whole set, most of which are impossible for any one item; so chance comes out near 0 and both near the raw
//!   figure. They are there for completeness, not to be quoted as corrected for chance.
//! - `right`: the label is whether the answer is right (objects, and frames by the rule of the round), so q = 2.
//!   All items share these two labels, so alpha and AC1 mean what their authors say. Two different wrong answers
//!   agree in it. Answers are lopsided (mostly right), where alpha falls to 0 however well people agree: quote
//!   AC1, with alpha and raw beside it.
//!
//! Neither coding contains the frames except through "right". q of AC1 is 2 for `right` and the number of distinct
//! labels that occur for `choice`.
//!
//! # Uncertainty
//!
//! Answers within a scene depend on each other, so intervals of raw, alpha, AC1 and the human ceiling are 95 %
//! percentile intervals of a bootstrap that draws whole scenes ([`DRAWS`] draws, seeded by the round). Shares of
//! items come with Wilson's interval, which takes items for independent and is therefore too narrow, if anything.

mod coefficients;
mod estimate;

use std::collections::{BTreeMap, BTreeSet};

use l4d_data::{Category, Name};
use serde::Serialize;

use self::coefficients::Parts;
pub use self::coefficients::{Undefined, Unit, gwet_ac1, krippendorff_alpha, raw};
use self::estimate::bootstrap;
pub use self::estimate::{Estimate, Share, wilson};
use crate::control::{self, Consistency};
use crate::key::Key;
use crate::responses::Responses;
use crate::round::Round;
use crate::verdict::{ItemVerdict, Mark, Verdicts, by_annotator, judge};
use crate::vote::{Answer, Choice};

/// Schema tag of `agreement.json`.
pub const SCHEMA: &str = "l4d/agreement/1";
/// Bootstrap draws.
pub const DRAWS: usize = 1000;

/// `agreement.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Agreement {
    /// [`SCHEMA`].
    pub schema: &'static str,
    /// The round.
    pub round: Name,
    /// Whether the annotators are programs.
    pub simulated: bool,
    /// Whether all ballots are sealed.
    pub is_final: bool,
    /// Bootstrap draws behind each interval.
    pub draws: usize,
    /// Their seed.
    pub seed: u64,
    /// All queries of the round.
    pub overall: Group,
    /// Queries of each category that occurs.
    pub categories: BTreeMap<Category, Group>,
    /// In the order of `round.toml`.
    pub annotators: Vec<Annotator>,
}

/// Agreement on a group of queries.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Group {
    /// Queries that were asked.
    pub items: usize,
    /// Queries that all annotators answered.
    pub complete: usize,
    /// Answers that count.
    pub answers: usize,
    /// Agreement on what was chosen.
    pub choice: Coefficients,
    /// Agreement on whether it is right.
    pub right: Coefficients,
    /// Of the complete queries: those to which all answers are the same choice.
    pub unanimous: Share,
    /// Of the complete queries: those to which all answers are right.
    pub understood: Share,
    /// Complete queries by the number of right answers, from 0 to all.
    pub histogram: Vec<usize>,
    /// The human ceiling: the share of single answers that are right.
    pub ceiling: Estimate,
}

/// Three coefficients over one coding.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Coefficients {
    /// Labels that chance draws from (q).
    pub labels: usize,
    /// Mean over items of the share of agreeing pairs of answers.
    pub raw: Estimate,
    /// Krippendorff's alpha for nominal data.
    pub alpha: Estimate,
    /// Gwet's AC1.
    pub ac1: Estimate,
}

/// One annotator.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Annotator {
    /// Who.
    pub name: Name,
    /// Whether the ballot is sealed.
    pub sealed: bool,
    /// Queries answered.
    pub answered: usize,
    /// Queries skipped.
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
    let given = by_annotator(round, responses).into_iter().enumerate();
    Agreement {
        schema: SCHEMA,
        round: round.name.clone(),
        simulated: round.simulated,
        is_final: verdicts.is_final,
        draws: DRAWS,
        seed: round.seed,
        overall: group(None),
        categories: occurring.into_iter().map(|category| (category, group(Some(category)))).collect(),
        annotators: given
            .map(|(place, (name, given))| annotator(key, &verdicts, place, name, given))
            .collect(),
    }
}

/// The answers to a query that count, with whether they are right.
fn answers(verdict: &ItemVerdict) -> Vec<(&Answer, bool)> {
    let counted = verdict.votes.iter().filter(|vote| vote.mark.counts());
    counted.filter_map(|vote| Some((vote.answer.as_ref()?, vote.mark == Mark::Right))).collect()
}

fn measure_group(round: &Round, verdicts: &[&ItemVerdict], name: &str) -> Group {
    let scenes: BTreeSet<&Name> = verdicts.iter().map(|verdict| &verdict.query.scene).collect();
    let scenes: BTreeMap<&Name, usize> =
        scenes.into_iter().enumerate().map(|(i, scene)| (scene, i)).collect();
    let draw = Draw { seed: round.seed, name, clusters: scenes.len() };

    let mut codes: BTreeMap<String, u32> = BTreeMap::new();
    let mut chosen = Vec::new();
    let mut right = Vec::new();
    let mut correct = vec![[0.0; 2]; scenes.len()];
    for verdict in verdicts {
        let (scene, answers) = (&verdict.query.scene, answers(verdict));
        let cluster = scenes[scene];
        let label = |(answer, _): &(&Answer, bool)| {
            let label = match &answer.choice {
                Choice::Objects(_) => format!("{scene}/{}", answer.choice.label()),
                Choice::None | Choice::Ambiguous { .. } => answer.choice.label(),
            };
            let next = codes.len() as u32;
            *codes.entry(label).or_insert(next)
        };
        chosen.push(Unit { cluster, labels: answers.iter().map(label).collect() });
        right.push(Unit { cluster, labels: answers.iter().map(|(_, right)| u32::from(*right)).collect() });
        correct[cluster][0] += answers.iter().filter(|(_, right)| *right).count() as f64;
        correct[cluster][1] += answers.len() as f64;
    }

    let all = round.annotators.len();
    let complete: Vec<usize> = (0..right.len()).filter(|&index| right[index].labels.len() == all).collect();
    let is_same = |labels: &[u32]| labels.windows(2).all(|pair| pair[0] == pair[1]);
    let mut histogram = vec![0; all + 1];
    for &index in &complete {
        histogram[right[index].labels.iter().filter(|&&label| label == 1).count()] += 1;
    }
    Group {
        items: verdicts.len(),
        complete: complete.len(),
        answers: right.iter().map(|unit| unit.labels.len()).sum(),
        unanimous: Share::new(
            complete.iter().filter(|&&index| is_same(&chosen[index].labels)).count(),
            complete.len(),
        ),
        understood: Share::new(histogram[all], complete.len()),
        histogram,
        choice: coefficients(&chosen, codes.len(), &draw),
        right: coefficients(&right, 2, &draw),
        ceiling: ceiling(&correct, &draw),
    }
}

/// Which draws of which scenes.
struct Draw<'a> {
    seed: u64,
    name: &'a str,
    clusters: usize,
}

fn coefficients(units: &[Unit], labels: usize, draw: &Draw<'_>) -> Coefficients {
    let parts = Parts::new(units, draw.clusters);
    let [raw, alpha, ac1] = bootstrap(draw.clusters, DRAWS, draw.seed, draw.name, {
        let mut totals = parts.totals();
        move |clusters| {
            parts.sum(clusters, &mut totals);
            [totals.raw(), totals.alpha(), totals.ac1(labels)]
        }
    });
    Coefficients { labels, raw, alpha, ac1 }
}

/// `correct`: right answers and answers of each scene.
fn ceiling(correct: &[[f64; 2]], draw: &Draw<'_>) -> Estimate {
    let [share] = bootstrap(draw.clusters, DRAWS, draw.seed, draw.name, |clusters| {
        let sum = |which: usize| clusters.iter().map(|&cluster| correct[cluster][which]).sum::<f64>();
        let (right, all) = (sum(0), sum(1));
        [if all > 0.0 { Ok(right / all) } else { Err(Undefined::NoVotes) }]
    });
    share
}

/// The annotator of this place in `round.toml`.
fn annotator(
    key: &Key,
    verdicts: &Verdicts,
    place: usize,
    name: &Name,
    given: Option<&Responses>,
) -> Annotator {
    let count = |is_meant: fn(Mark) -> bool| {
        verdicts.items.iter().filter(|verdict| is_meant(verdict.votes[place].mark)).count()
    };
    Annotator {
        name: name.clone(),
        sealed: given.is_some_and(|given| given.sealed),
        answered: count(Mark::counts),
        skipped: count(|mark| mark == Mark::Skipped),
        right: count(|mark| mark == Mark::Right),
        gold: given.map(|given| control::gold(key, given)).unwrap_or_default(),
        repeats: given.map(|given| control::repeats(key, given)).unwrap_or_default(),
    }
}

#[cfg(test)]
mod tests;
