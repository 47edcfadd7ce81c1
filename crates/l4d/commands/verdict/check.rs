//! `l4d verdict --check`: whether the files of a verdict, and the status of the queries, follow from the votes.

use anyhow::Result;
use l4d_data::store::read_bounded;
use l4d_data::{Benchmark, Report};
use l4d_votes::agreement::measure;
use l4d_votes::files::{agreement_json, verdicts_csv};

use super::judged::Judged;
use super::status::{self, Change};
use crate::cli::annotation::VerdictArgs;
use crate::out::{ExitStatus, Printer};

/// No derived file is larger.
const MAX_BYTES: u64 = 64 << 20;

pub(super) fn run(
    args: &VerdictArgs,
    judged: &Judged,
    bench: &Benchmark,
    out: &Printer,
) -> Result<ExitStatus> {
    let Judged { dir, round, key, responses, verdicts, changes, .. } = judged;
    let mut report = Report::default();
    super::findings(judged).into_iter().for_each(|finding| report.add(finding));
    let derived = [
        (dir.verdicts(), verdicts_csv(round, verdicts, changes)?),
        (dir.agreement(), agreement_json(&measure(round, key, responses))?),
    ];
    for (path, bytes) in derived {
        let hint = format!("run `l4d verdict --round {}`", round.name);
        if !path.exists() {
            report.error("L4D530", &path, "file", "is missing", hint);
        } else if read_bounded(&path, MAX_BYTES)? != bytes {
            report.error("L4D530", &path, "bytes", "are not what the votes give", hint);
        }
    }
    for Change { query, file, from, to } in status::changes(judged, &args.rounds, bench)? {
        let (from, to) = (from.as_str(), to.as_str());
        let message = format!("is {from}, but by the votes of people it is {to}");
        let hint = format!("run `l4d verdict --round {}`: nothing else sets it", round.name);
        report.error("L4D531", &file, format!("query {query}, field `status`"), message, hint);
    }
    out.findings(report, args.json)
}
