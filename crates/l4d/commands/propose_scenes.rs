//! `l4d propose-scenes`: a language model proposes scenarios; those that keep the rules become files for people.

use std::collections::BTreeSet;

use anyhow::Result;
use l4d_data::Progress as _;
use l4d_data::{Benchmark, Report, Scale};
use l4d_endpoint::Plan;
use l4d_propose::Asked;
use l4d_propose::scenarios::{Known, ScaleOutcome, ScenarioProposer};
use serde_json::json;

use crate::cli::models::ProposeScenesArgs;
use crate::models::{about, manner, note_spent, open_client, print_estimate};
use crate::out::{ExitStatus, Printer};

pub(crate) fn run(args: &ProposeScenesArgs, out: &Printer) -> Result<ExitStatus> {
    let known = Known::of(&Benchmark::open(&args.bench)?);
    let client = open_client(&args.ask.server)?;
    let is_wanted = |scale: &Scale| args.scales.is_empty() || args.scales.contains(scale);
    let scales: Vec<Scale> = Scale::ALL.into_iter().filter(is_wanted).collect();
    let inventing = ScenarioProposer {
        known: &known,
        out: &args.out,
        per_scale: args.per_scale,
        manner: manner(&args.ask),
        force: args.force,
    };
    if args.ask.dry_run {
        let plan = |scale: Scale| -> Result<(String, Plan)> {
            Ok((scale.as_str().to_owned(), client.plan([&inventing.request(scale)])))
        };
        let plans: Vec<_> = scales.into_iter().map(plan).collect::<Result<_>>()?;
        return print_estimate("scale", &plans, client.endpoint(), args.json, Report::default(), out);
    }
    let mut report = Report::default();
    let mut taken = BTreeSet::new();
    out.start("asking", scales.len() as u64);
    let mut outcomes = Vec::new();
    for scale in scales {
        outcomes.push(inventing.invent(scale, &client, &mut taken, &mut report));
        out.advance(1);
    }
    out.finish();
    if args.json {
        let (endpoint, spent) = (about(client.endpoint()), client.spent());
        let document = json!({ "out": args.out, "endpoint": endpoint, "scales": outcomes, "spent": spent });
        return out.document(document, report);
    }
    print(&outcomes, out)?;
    note_spent(&client.spent(), out);
    if outcomes.iter().any(|outcome| !outcome.scenarios.is_empty()) {
        out.note(format!("scenarios are in {}; people build scenes from them", args.out.display()));
    }
    out.any_findings(report)
}

fn print(outcomes: &[ScaleOutcome], out: &Printer) -> Result<()> {
    out.data(format!("{:<10}{:<10}{:>10}{:>8}{:>8}", "scale", "answer", "proposed", "taken", "failed"))?;
    for outcome in outcomes {
        let ScaleOutcome { scale, asked: Asked { answer, proposed, failed, notes, .. }, scenarios } = outcome;
        let (scale, answer, taken) = (scale.as_str(), answer.unwrap_or("none"), scenarios.len());
        out.data(format!("{scale:<10}{answer:<10}{proposed:>10}{taken:>8}{failed:>8}"))?;
        for name in scenarios {
            out.data(format!("    {name}"))?;
        }
        for note in notes {
            out.warn(format!("{scale}: {note}"));
        }
    }
    Ok(())
}
