//! `l4d check-results`: every problem of a results folder, with codes.

use anyhow::Result;
use l4d_data::{Benchmark, Report};
use l4d_score::results::MEGABYTE;
use l4d_score::{EvalSet, check_results};

use crate::cli::judging::CheckResultsArgs;
use crate::out::{ExitStatus, Printer};

pub(crate) fn run(args: &CheckResultsArgs, out: &Printer) -> Result<ExitStatus> {
    let mut report = Report::default();
    let bench = Benchmark::open(&args.bench.bench)?;
    let mut eval_set = EvalSet::open(bench, args.bench.profile, args.set, &args.bench.scenes, &mut report)?;
    eval_set.most_bytes = args.max_megabytes.saturating_mul(MEGABYTE);
    let methods = check_results(&args.results, &eval_set, &mut report)?;
    out.note(format!("checked {methods} method{}", if methods == 1 { "" } else { "s" }));
    match args.json || args.all {
        true => out.findings(report, args.json),
        false => out.causes(report, "--all lists each"),
    }
}
