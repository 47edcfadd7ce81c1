//! Scores a folder of results as `l4d score` does, in a binary without the rest of the toolkit, which
//! `perf/score.py` times.
//!
//!     score_masks PROFILE RESULTS SCORES [SCENE...]
//!
//! The benchmark is in `benchmark`.

use std::path::PathBuf;

use l4d_data::{Benchmark, Report, Severity};
use l4d_score::{EvalSet, Options, QuerySet, score_results};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut next = |what: &str| arguments.next().ok_or(format!("name {what}"));
    let profile = next("a profile")?.parse()?;
    let (results, scores) = (PathBuf::from(next("results")?), PathBuf::from(next("a folder for scores")?));
    let scenes: Vec<String> = arguments.collect();
    let mut report = Report::default();
    let eval_set =
        EvalSet::open(Benchmark::open("benchmark")?, profile, QuerySet::Queries, &scenes, &mut report)?;
    let scored = score_results(&results, &eval_set, &Options::default(), &scores, false, |_| {})?;
    match scored.report.into_sorted().iter().find(|finding| finding.severity == Severity::Error) {
        None => Ok(()),
        Some(finding) => Err(format!("{}: {}", finding.path, finding.message).into()),
    }
}
