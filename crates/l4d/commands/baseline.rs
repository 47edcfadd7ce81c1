//! `l4d baseline`: results that bracket the scale.

use anyhow::Result;
use l4d_data::{Benchmark, Report};
use l4d_score::baseline::{Written, write_baseline};
use l4d_score::{Baseline, Exam, QuerySet};

use crate::cli::judging::{BaselineArgs, BaselineName};
use crate::out::{ExitStatus, Printer};

pub(crate) fn run(args: &BaselineArgs, out: &Printer) -> Result<ExitStatus> {
    let mut report = Report::default();
    let bench = Benchmark::open(&args.bench.bench)?;
    let exam = Exam::open(bench, args.bench.profile, QuerySet::Queries, &args.bench.scenes, &mut report)?;
    for finding in report.into_sorted() {
        out.warn(format!("{} {}", finding.path, finding.message));
    }
    let mut chosen: Vec<Baseline> = args.names.iter().map(|&name| name.into()).collect();
    if chosen.is_empty() {
        chosen = Baseline::ALL.to_vec();
    }
    for baseline in chosen {
        let Written { new, kept } = write_baseline(baseline, &exam, args.seed, &args.results, args.force)?;
        let folder = args.results.join(baseline.as_str());
        out.note(format!("{:>18}: {new} files written, {kept} were there", baseline.as_str()));
        out.data(folder.display())?;
    }
    Ok(ExitStatus::Success)
}

impl From<BaselineName> for Baseline {
    fn from(name: BaselineName) -> Self {
        match name {
            BaselineName::Oracle => Self::Oracle,
            BaselineName::None => Self::None,
            BaselineName::All => Self::All,
            BaselineName::TimeAgnostic => Self::TimeAgnostic,
            BaselineName::RandomLookAlike => Self::RandomLookAlike,
            BaselineName::LookAlikeUnion => Self::LookAlikeUnion,
        }
    }
}
