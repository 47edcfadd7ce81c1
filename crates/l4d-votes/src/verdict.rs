//! Which prompts people understood: the answers that count against what is meant.
//!
//! A prompt is valid if as many distinct annotators as the rule demands chose exactly the instances meant, at
//! frames that fit by the rule of the round. Where it isn't, its verdict keeps every vote and says why:
//!
//! - `stale`: the query or its scene changed after the round was opened, so nobody was asked what it says now; or
//!   an annotator has only answered an earlier wording of the item;
//! - `incomplete`: an annotator has not answered, or skipped;
//! - `rejected`: everybody answered, too few were right.
//!
//! Control items get no verdict (see [`crate::control`]), and the second answer to a repeated prompt never counts.
//! Nothing here writes a query's status: that is what `l4d verdict` does with these verdicts.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::{self, Write as _};

use l4d_data::{Category, DataError, Interval, Name, QueryId, Report};
use serde::{Deserialize, Serialize};

use crate::ballot::Notice;
use crate::codes;
use crate::control;
use crate::event::{Answer, Choice};
use crate::item::{Item, ItemId};
use crate::key::{Behind, Key, Meaning};
use crate::round::{Round, RoundDir};
use crate::sheet::{Sheet, Standing};

/// What becomes of a prompt.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Outcome {
    /// Enough annotators chose exactly what is meant.
    Valid,
    /// They did not.
    Rejected,
    /// Somebody has not answered.
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

impl fmt::Display for Outcome {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.pad(self.as_str())
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
    /// Nothing.
    SaidNone,
    /// Cannot tell.
    SaidAmbiguous,
    /// The objects meant, at other frames.
    OtherFrames,
    /// Skipped.
    Skipped,
    /// Answered to an earlier wording or scene.
    Stale,
    /// Not answered.
    Missing,
}

impl Mark {
    /// All marks.
    pub const ALL: [Self; 8] = [
        Self::Right,
        Self::OtherObjects,
        Self::SaidNone,
        Self::SaidAmbiguous,
        Self::OtherFrames,
        Self::Skipped,
        Self::Stale,
        Self::Missing,
    ];

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
    /// Whose.
    pub annotator: Name,
    /// Against what is meant.
    pub mark: Mark,
    /// What was answered, counted or stale.
    pub answer: Option<Answer>,
    /// Remarks.
    pub comments: Vec<String>,
}

/// The verdict on one query.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ItemVerdict {
    /// The item that asked it.
    pub item: ItemId,
    /// The query.
    pub query: QueryId,
    /// Its categories.
    pub categories: Vec<Category>,
    /// The prompt as it was asked.
    pub text: String,
    /// What it meant then.
    pub meaning: Meaning,
    /// What becomes of it.
    pub outcome: Outcome,
    /// In the order of `round.toml`.
    pub votes: Vec<Vote>,
    /// Why it is not unanimous, one sentence each.
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
    /// By item.
    pub items: Vec<ItemVerdict>,
    /// What was not counted, and why; who was wrong on the control items.
    pub findings: Vec<Notice>,
}

impl Verdicts {
    /// How many verdicts have this outcome.
    pub fn count(&self, outcome: Outcome) -> usize {
        self.items.iter().filter(|verdict| verdict.outcome == outcome).count()
    }
}

/// Judges every query of a round. `current` are the digests that the items would have now
/// ([`crate::key::current_digests`]).
pub fn judge(round: &Round, key: &Key, sheets: &[Sheet], current: &BTreeMap<ItemId, String>) -> Verdicts {
    let sheets = sheets_of(round, sheets);
    let mut report = Report::default();
    let mut items = Vec::new();
    for item in &round.items {
        let Some(Behind::Query { query, categories, meaning }) = key.behind(&item.id) else {
            continue;
        };
        let change = change(item, current);
        if let Some(change) = change {
            report.warning(
                codes::STALE_ITEM,
                &round.dir().items(),
                format!("item {}", item.id),
                format!("{query} {change}: the votes on it do not count"),
                "ask it again in a further round",
            );
        }
        let votes: Vec<Vote> =
            sheets.iter().map(|(name, sheet)| vote(round, item, meaning, name, *sheet)).collect();
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
            verdict.outcome = outcome(round, &verdict);
        }
        verdict.reasons.extend(verdict.votes.iter().filter_map(reason));
        items.push(verdict);
    }
    let unsealed = unsealed(&sheets);
    for annotator in &unsealed {
        report.warning(
            codes::NOT_SEALED,
            &round.dir().ballot(annotator),
            "seal",
            "the ballot is not sealed: this is a look, no verdict",
            "let the annotator finish and seal it",
        );
    }
    control::report_misses(round, key, &sheets, &mut report);
    Verdicts { is_final: unsealed.is_empty(), items, findings: report.into_sorted() }
}

/// Refuses ballots that are not sealed: who looks at votes early can tell others what to vote.
pub fn require_sealed(dir: &RoundDir, round: &Round, sheets: &[Sheet]) -> Result<(), DataError> {
    let unsealed = unsealed(&sheets_of(round, sheets));
    if unsealed.is_empty() {
        return Ok(());
    }
    let names: Vec<&str> = unsealed.iter().map(|name| name.as_str()).collect();
    Err(DataError::invalid(
        &dir.votes(),
        "seals",
        format!("not sealed yet: {}", names.join(", ")),
        "wait until everybody has sealed, or take a look that changes nothing with `--unsealed`",
    ))
}

/// The sheet of each annotator of the round, once; whatever else is among the sheets is left out.
pub(crate) fn sheets_of<'a>(round: &'a Round, sheets: &'a [Sheet]) -> Vec<(&'a Name, Option<&'a Sheet>)> {
    let sheet_of = |annotator: &Name| sheets.iter().find(|sheet| sheet.annotator == *annotator);
    round.annotators.iter().map(|annotator| (annotator, sheet_of(annotator))).collect()
}

fn unsealed<'a>(sheets: &[(&'a Name, Option<&'a Sheet>)]) -> Vec<&'a Name> {
    let is_sealed = |sheet: &Option<&Sheet>| sheet.is_some_and(|sheet| sheet.sealed);
    sheets.iter().filter(|(_, sheet)| !is_sealed(sheet)).map(|(name, _)| *name).collect()
}

fn change(item: &Item, current: &BTreeMap<ItemId, String>) -> Option<&'static str> {
    match current.get(&item.id) {
        None => Some("is gone since the round was opened"),
        Some(digest) if *digest != item.digest => Some("or its scene has changed since the round was opened"),
        Some(_) => None,
    }
}

fn vote(round: &Round, item: &Item, meaning: &Meaning, name: &Name, sheet: Option<&Sheet>) -> Vote {
    let standing = sheet.and_then(|sheet| sheet.standing(&item.id)).cloned().unwrap_or_default();
    let Standing { answer, skipped, stale, comments } = standing;
    let mark = match (&answer, skipped, &stale) {
        (Some(answer), _, _) => meaning.mark(answer, round.frames),
        (None, true, _) => Mark::Skipped,
        (None, false, Some(_)) => Mark::Stale,
        (None, false, None) => Mark::Missing,
    };
    Vote { annotator: name.clone(), mark, answer: answer.or(stale), comments }
}

fn outcome(round: &Round, verdict: &ItemVerdict) -> Outcome {
    if verdict.votes.iter().any(|vote| vote.mark == Mark::Stale) {
        Outcome::Stale
    } else if verdict.counted() < round.rule.annotators {
        Outcome::Incomplete
    } else if verdict.right() >= round.rule.needed {
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
            format!("{annotator} chose the objects meant, at {}", frames(answer.frames))
        }
        (_, Some(answer)) => format!("{annotator} {}", said(&answer.choice)),
    })
}

fn frames(interval: Interval) -> String {
    format!("frames {} to {}", interval.first(), interval.last())
}

fn said(choice: &Choice) -> String {
    match choice {
        Choice::Objects(objects) => format!("chose {}", list(objects)),
        Choice::None => "found nothing that fits".to_owned(),
        Choice::Ambiguous { reason } => format!("called it ambiguous: {reason}"),
    }
}

fn list(names: &BTreeSet<Name>) -> String {
    let mut text = String::new();
    for (index, name) in names.iter().enumerate() {
        let joint = if index == 0 { "" } else { ", " };
        write!(text, "{joint}{name}").expect("writing to a string does not fail");
    }
    text
}

#[cfg(test)]
mod tests;
