//! `l4d check-queries`: one referent each, real distractors, and the count of the set.

use anyhow::Result;
use l4d_data::{Benchmark, Report};
use l4d_query::check_set;
use serde_json::json;

use crate::cli::CheckQueriesArgs;
use crate::out::{ExitStatus, Printer};

pub(crate) fn run(args: &CheckQueriesArgs, out: &Printer) -> Result<ExitStatus> {
    let bench = Benchmark::open(&args.bench.bench)?;
    let scenes = bench.select(&args.bench.scenes)?;
    let mut report = Report::default();
    let summary = check_set(&bench, args.bench.profile, &scenes, &mut report);
    if args.json {
        let failed = report.has_errors();
        let mut document = serde_json::to_value(&summary)?;
        document["findings"] = json!(report.into_sorted());
        out.json(&document)?;
        return Ok(if failed { ExitStatus::Findings } else { ExitStatus::Success });
    }
    out.data(format!("{:<14}{:>8}", "scenes", summary.scenes))?;
    for (scale, count) in &summary.scales {
        out.data(format!("  {scale:<12}{count:>8}"))?;
    }
    out.data(format!("{:<14}{:>8}", "objects", summary.instances))?;
    out.data(format!("{:<14}{:>8}", "queries", summary.total()))?;
    for (category, count) in &summary.queries {
        out.data(format!("  {category:<12}{count:>8}"))?;
    }
    out.data(format!("{:<14}{:>8}", "verified", summary.verified))?;
    out.findings(report, false)
}
