//! `l4d baseline`: results that bracket the scale.

use anyhow::Result;
use l4d_data::{Benchmark, Report};
use l4d_score::baseline::{Written, write_baseline};
use l4d_score::{Baseline, EvalSet, QuerySet};

use crate::cli::judging::BaselineArgs;
use crate::out::{ExitStatus, Printer};
use crate::readmes;

pub(crate) fn run(args: &BaselineArgs, out: &Printer) -> Result<ExitStatus> {
    let mut report = Report::default();
    let bench = Benchmark::open(&args.bench.bench)?;
    let eval_set =
        EvalSet::open(bench, args.bench.profile, QuerySet::Queries, &args.bench.scenes, &mut report)?;
    out.warnings(report);
    let chosen = if args.names.is_empty() { &Baseline::ALL[..] } else { &args.names };
    for &baseline in chosen {
        let Written { new, kept } =
            write_baseline(baseline, &eval_set, args.seed, &args.results, args.force)?;
        let folder = args.results.join(baseline.as_str());
        out.note(format!("{:>18}: {new} files written, {kept} were there", baseline.as_str()));
        out.data(folder.display())?;
    }
    readmes::leave(&args.results, readmes::RESULTS)?;
    Ok(ExitStatus::Success)
}
