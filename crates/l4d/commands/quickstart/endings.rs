//! How each query of the quickstart ended and why, a line each.
//!
//! Owns the wording. What was asked, decided and counted is read from the files of `solve` and `score`.

use std::collections::BTreeMap;
use std::fmt;

use anyhow::Result;
use l4d_data::layout::{AnswerDir, WorkDir};
use l4d_data::{Name, Query, QueryId, json};
use l4d_ground::Outcome;
use l4d_score::metrics::{QueryTally, taken};
use l4d_score::score::{counts_path, tallies_of_counts};
use l4d_score::{EvalSet, Options, counts};
use l4d_solve::consensus::{Consensus, Decision, ViewVerdict};
use l4d_solve::grounded::outcomes;

/// A query and how it ended.
#[derive(Debug)]
pub(super) struct Ending<'a> {
    pub(super) query: &'a Query,
    pub(super) why: Why,
    /// Mean IoU, 0 to 1.
    pub(super) miou: f64,
}

/// Why a query ended as it did.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Why {
    /// The referent is what the answer overlaps most.
    Right,
    /// The grounder cannot read it, and says why.
    NotRead(String),
    /// No view shows it, says the grounder.
    NotFound,
    /// A view failed: this is what it said.
    Failed(String),
    /// The views disagree, and none of them is believed.
    Undecided,
    /// Something else, against views that said otherwise.
    Outvoted(Option<Name>),
    /// Something else.
    WrongObject(Option<Name>),
}

impl fmt::Display for Why {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let object = |f: &mut fmt::Formatter<'_>, name: &Option<Name>| match name {
            Some(name) => write!(f, "{name}"),
            None => write!(f, "no object of the scene"),
        };
        match self {
            Self::Right => write!(f, "right"),
            Self::NotRead(why) => write!(f, "not read: {why}"),
            Self::NotFound => write!(f, "not found: no view shows it"),
            Self::Failed(why) => write!(f, "no answer: {why}"),
            Self::Undecided => write!(f, "no answer: the views disagree"),
            Self::Outvoted(name) => {
                write!(f, "outvoted: most views took ")?;
                object(f, name)
            }
            Self::WrongObject(name) => {
                write!(f, "wrong object: ")?;
                object(f, name)
            }
        }
    }
}

/// How the queries of one scene ended for a method, in their order.
pub(super) fn endings<'a>(
    eval_set: &'a EvalSet,
    scene: &Name,
    method: &Name,
    work: &WorkDir,
    scores: &std::path::Path,
) -> Result<Vec<Ending<'a>>> {
    let rows = counts::read(&counts_path(scores, method))?;
    let tallies: BTreeMap<QueryId, QueryTally> = tallies_of_counts(&rows, eval_set, &Options::default())
        .into_iter()
        .map(|tally| (tally.facts.id.clone(), tally))
        .collect();
    let queries = eval_set.scenes.iter().filter(|of| of.name == *scene).flat_map(|of| &of.queries);
    let mut endings = Vec::new();
    for query in queries {
        let Some(tally) = tallies.get(&query.id) else { continue };
        let ratios = tally.ratios();
        let why = match ratios.select {
            Some(select) if select > 0.5 => Why::Right,
            _ => {
                let rows = rows.iter().filter(|row| row.query == query.id);
                reason(&work.answer(method, &query.id.number), taken(&query.referents, rows).cloned())?
            }
        };
        endings.push(Ending { query, why, miou: ratios.miou.unwrap_or(0.0) });
    }
    Ok(endings)
}

/// Why an answer is not the right one. `taken` is what it overlaps most.
fn reason(dir: &AnswerDir, taken: Option<Name>) -> Result<Why> {
    let agreed: Consensus = json::read(&dir.consensus())?;
    let said = outcomes(&dir.grounded())?;
    let unread = said.iter().find_map(|outcome| match outcome {
        Outcome::Unsupported(unread) => Some(unread.to_string()),
        _ => None,
    });
    Ok(match agreed.decision {
        Decision::Absent => Why::NotFound,
        Decision::NoAnswer => match unread {
            Some(why) => Why::NotRead(why),
            None => Why::Failed(said.iter().find_map(Outcome::why).unwrap_or_default()),
        },
        _ if agreed.evidence.is_empty() => Why::Undecided,
        _ if agreed.views.iter().any(|view| view.standing == ViewVerdict::Outvoted) => Why::Outvoted(taken),
        _ => Why::WrongObject(taken),
    })
}
