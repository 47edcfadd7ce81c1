//! What may be asked again: words that a panel rejected are not put before people a second time, edited ones are.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::Result;
use l4d_data::{Benchmark, QueryId};
use l4d_votes::key::Change;
use l4d_votes::{Evidence, JudgedRound};
use l4d_votes::{ItemVerdict, Outcome};

use crate::cli::annotation::OpenRoundArgs;
use crate::out::{Printer, refusal};

/// The queries of an earlier round that it did not find valid, as they are now: rejected, edited since, or not
/// answered by everybody.
pub(super) fn left_by(
    args: &OpenRoundArgs,
    earlier: &str,
    bench: &Benchmark,
    out: &Printer,
) -> Result<BTreeSet<QueryId>> {
    let judged = JudgedRound::read(&args.rounds, earlier, bench)?;
    judged.require_sealed()?;
    let chosen = bench.select(&args.bench.scenes)?;
    let here = judged.now.items.iter().filter(|item| chosen.contains(&item.query.scene));
    let left: Vec<&ItemVerdict> = here.filter(|item| item.outcome != Outcome::Valid).collect();
    let is_gone = |item: &&ItemVerdict| judged.changes_now.get(&item.item) == Some(&Change::Gone);
    let (gone, there): (Vec<&ItemVerdict>, Vec<&ItemVerdict>) = left.into_iter().partition(is_gone);
    if !gone.is_empty() {
        let ids: Vec<String> = gone.iter().map(|item| item.query.to_string()).collect();
        out.note(format!("no longer in the benchmark: {}", ids.join(", ")));
    }
    // Programs reject nothing for good, but their own list is worked off in the same way.
    let is_unedited = |item: &&&ItemVerdict| judged.round.simulated && item.outcome == Outcome::Rejected;
    let unedited = there.iter().filter(is_unedited).map(|item| (item.query.clone(), why(item))).collect();
    let ids = there.iter().map(|item| item.query.clone()).collect();
    without(ids, unedited, args, out)
}

/// Leaves out, or refuses, queries whose present words people have rejected.
pub(super) fn not_rejected_before(
    ids: BTreeSet<QueryId>,
    args: &OpenRoundArgs,
    bench: &Benchmark,
    out: &Printer,
) -> Result<BTreeSet<QueryId>> {
    let evidence = Evidence::gather(&args.rounds, bench)?;
    let rejected =
        ids.iter().filter_map(|id| Some((id.clone(), evidence.why_rejected(id)?.to_owned()))).collect();
    without(ids, rejected, args, out)
}

fn without(
    mut ids: BTreeSet<QueryId>,
    unedited: BTreeMap<QueryId, String>,
    args: &OpenRoundArgs,
    out: &Printer,
) -> Result<BTreeSet<QueryId>> {
    if unedited.is_empty() {
        return Ok(ids);
    }
    let what = if args.edited_only { "left out, not edited since it was rejected" } else { "not edited yet" };
    for (id, why) in &unedited {
        out.note(format!("{what}: {id} {why}"));
        ids.remove(id);
    }
    if !args.edited_only {
        return Err(refusal(
            format!("{} prompts were rejected in the words that they still have", unedited.len()),
            "edit their text or remove them, or leave them out with --edited-only",
        ));
    }
    Ok(ids)
}

fn why(item: &ItemVerdict) -> String {
    format!("\"{}\" {} ({})", item.text, item.pattern(), item.reasons.join("; "))
}
