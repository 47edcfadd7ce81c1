//! Which prompts people understood: the answers that count against what is meant.
//!
//! A prompt is valid if all annotators chose exactly the instances meant, at a frame at which it holds. Where it isn't, its verdict keeps every vote and says why:
//!
//! - `stale`: the query or its scene changed after the round was opened, so no one was asked what it says now; or
//!   an annotator has only answered an earlier wording of the item;
//! - `incomplete`: an annotator has not answered, or skipped;
//! - `rejected`: all answered, not all were right.
//!
//! Control items get no verdict (see [`crate::control`]), and the second answer to a repeated prompt never counts.
//! Nothing here writes a query's status: that is what `l4d verdict` does with these verdicts.

use std::collections::BTreeMap;

use l4d_data::{Category, DataError, Finding, Name, QueryId, Report};
use serde::{Deserialize, Serialize};

use crate::control;
use crate::item::{Item, ItemId};
use crate::key::{Change, ItemSource, Key, Meaning};
use crate::responses::Responses;
use crate::round::Round;
use crate::vote::{Answer, Choice, Response};

/// What becomes of a prompt.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// All annotators chose exactly what is meant.
    Valid,
    /// They did not.
    Rejected,
    /// An annotator has not answered.
    Incomplete,
    /// The query or its scene changed after the round was opened, or answers belong to an earlier wording.
    Stale,
}

impl Outcome {
    /// All outcomes, best first.
    pub const ALL: [Self; 4] = [Self::Valid, Self::Rejected, Self::Incomplete, Self::Stale];

    /// Name as written in files.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Valid => "valid",
            Self::Rejected => "rejected",
            Self::Incomplete => "incomplete",
            Self::Stale => "stale",
        }
    }
}

/// One annotator's answer against what is meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Mark {
    /// Exactly the objects meant, at fitting frames.
    Right,
    /// Other objects, too many or too few.
    OtherObjects,
    SaidNone,
    SaidAmbiguous,
    /// The objects meant, at other frames.
    OtherFrames,
    Skipped,
    /// Answered to an earlier wording or scene.
    Stale,
    Missing,
}

impl Mark {
    /// Its letter in a vote pattern.
    pub fn letter(self) -> char {
        match self {
            Self::Right => '+',
            Self::OtherObjects => 'x',
            Self::SaidNone => '0',
            Self::SaidAmbiguous => '?',
            Self::OtherFrames => 't',
            Self::Skipped => 's',
            Self::Stale => '~',
            Self::Missing => '.',
        }
    }

    /// Whether it is an answer to what was asked.
    pub fn counts(self) -> bool {
        !matches!(self, Self::Skipped | Self::Stale | Self::Missing)
    }
}

/// One annotator's vote on a prompt.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Vote {
    pub annotator: Name,
    pub mark: Mark,
    /// What was answered, counted or stale.
    pub answer: Option<Answer>,
    pub comments: Vec<String>,
}

/// The verdict on one query.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ItemVerdict {
    /// The item that asked it.
    pub item: ItemId,
    pub query: QueryId,
    pub categories: Vec<Category>,
    /// The prompt as it was asked.
    pub text: String,
    /// What it meant then.
    pub meaning: Meaning,
    /// What becomes of it.
    pub outcome: Outcome,
    /// In the order of `round.toml`.
    pub votes: Vec<Vote>,
    /// Why it is not valid, one sentence each.
    pub reasons: Vec<String>,
}

impl ItemVerdict {
    /// One letter per annotator, in the order of `round.toml` ([`Mark::letter`]).
    pub fn pattern(&self) -> String {
        self.votes.iter().map(|vote| vote.mark.letter()).collect()
    }

    /// How many answers count.
    pub fn counted(&self) -> usize {
        self.votes.iter().filter(|vote| vote.mark.counts()).count()
    }

    /// How many of them are right.
    pub fn right(&self) -> usize {
        self.votes.iter().filter(|vote| vote.mark == Mark::Right).count()
    }
}

/// All verdicts of a round, by item.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Verdicts {
    /// Whether all ballots are sealed; otherwise this is only a look.
    pub is_final: bool,
    pub items: Vec<ItemVerdict>,
    /// What was not counted, and why; who was wrong on the control items.
    pub findings: Vec<Finding>,
}

impl Verdicts {
    /// How many verdicts have this outcome.
    pub fn count(&self, outcome: Outcome) -> usize {
        self.items.iter().filter(|verdict| verdict.outcome == outcome).count()
    }
}

/// Judges every query of a round by the responses of its annotators, in their order. `changes` are those since the round was opened ([`crate::key::changes`]); an item
/// that is missing there did not change.
pub(crate) fn judge(
    round: &Round,
    key: &Key,
    responses: &[Responses],
    changes: &BTreeMap<ItemId, Change>,
) -> Verdicts {
    let mut report = Report::default();
    let mut items = Vec::new();
    for item in &round.items {
        let Some(ItemSource::Query { query, categories, meaning }) = key.source(&item.id) else {
            continue;
        };
        let change = match changes.get(&item.id).copied().unwrap_or(Change::No) {
            Change::No => None,
            Change::Edited => Some("or its scene has changed since the round was opened"),
            Change::Gone => Some("is gone since the round was opened"),
        };
        if let Some(change) = change {
            report.warning(
                "L4D521",
                &round.dir().items(),
                format!("item {}", item.id),
                format!("{query} {change}: the votes on it do not count"),
                "ask it again in a further round",
            );
        }
        let votes = responses.iter().map(|given| vote(item, meaning, given)).collect();
        let mut verdict = ItemVerdict {
            item: item.id.clone(),
            query: query.clone(),
            categories: categories.clone(),
            text: item.text.clone(),
            meaning: meaning.clone(),
            outcome: Outcome::Stale,
            votes,
            reasons: change.map(|change| format!("the query {change}")).into_iter().collect(),
        };
        if change.is_none() {
            verdict.outcome = outcome(&verdict);
        }
        verdict.reasons.extend(verdict.votes.iter().filter_map(reason));
        items.push(verdict);
    }
    let unsealed = unsealed(responses);
    for annotator in &unsealed {
        report.warning(
            "L4D520",
            &round.dir().ballot(annotator),
            "seal",
            "the ballot is not sealed: this is a look, no verdict",
            "let the annotator finish and seal it",
        );
    }
    control::report_misses(round, key, responses, &mut report);
    Verdicts { is_final: unsealed.is_empty(), items, findings: report.into_sorted() }
}

/// Refuses ballots that are not sealed: who looks at votes early can tell others what to vote.
pub(crate) fn require_sealed(round: &Round, responses: &[Responses]) -> Result<(), DataError> {
    let unsealed = unsealed(responses);
    if unsealed.is_empty() {
        return Ok(());
    }
    let names: Vec<&str> = unsealed.iter().map(|name| name.as_str()).collect();
    Err(DataError::invalid(
        &round.dir().votes(),
        "seals",
        format!("not sealed yet: {}", names.join(", ")),
        "wait until all have sealed, or take a look that changes nothing with `--unsealed`",
    ))
}

fn unsealed(responses: &[Responses]) -> Vec<&Name> {
    responses.iter().filter(|given| !given.sealed).map(|given| &given.annotator).collect()
}

fn vote(item: &Item, meaning: &Meaning, given: &Responses) -> Vote {
    let Response { answer, skipped, stale, comments } =
        given.items.get(&item.id).cloned().unwrap_or_default();
    let mark = match (&answer, skipped, &stale) {
        (Some(answer), _, _) => meaning.mark(answer),
        (None, true, _) => Mark::Skipped,
        (None, false, Some(_)) => Mark::Stale,
        (None, false, None) => Mark::Missing,
    };
    Vote { annotator: given.annotator.clone(), mark, answer: answer.or(stale), comments }
}

fn outcome(verdict: &ItemVerdict) -> Outcome {
    if verdict.votes.iter().any(|vote| vote.mark == Mark::Stale) {
        Outcome::Stale
    } else if verdict.counted() < verdict.votes.len() {
        Outcome::Incomplete
    } else if verdict.right() == verdict.counted() {
        Outcome::Valid
    } else {
        Outcome::Rejected
    }
}

fn reason(vote: &Vote) -> Option<String> {
    let Vote { annotator, mark, answer, .. } = vote;
    Some(match (mark, answer) {
        (Mark::Right, _) => return None,
        (Mark::Skipped, _) => format!("{annotator} skipped it"),
        (Mark::Stale, _) => format!("{annotator} answered an earlier wording or scene"),
        (Mark::Missing, _) | (_, None) => format!("{annotator} has not answered"),
        (Mark::OtherFrames, Some(answer)) => {
            let (first, last) = (answer.frames.first(), answer.frames.last());
            format!("{annotator} chose the objects meant, at frames {first} to {last}")
        }
        (_, Some(answer)) => format!("{annotator} {}", said(&answer.choice)),
    })
}

fn said(choice: &Choice) -> String {
    match choice {
        Choice::Objects(objects) => {
            format!("chose {}", objects.iter().map(Name::as_str).collect::<Vec<_>>().join(", "))
        }
        Choice::None => "found nothing that fits".to_owned(),
        Choice::Ambiguous { reason } => format!("called it ambiguous: {reason}"),
    }
}

#[cfg(test)]
mod tests;
