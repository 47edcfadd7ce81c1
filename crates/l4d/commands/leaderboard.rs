//! `l4d leaderboard`: scores of methods in, ranked tables and figures out.

use anyhow::Result;
use l4d_board::{Board, BoardError, Gathered, gather, publish, text_table};
use l4d_data::{Benchmark, Report};
use l4d_score::{Exam, QuerySet};
use serde_json::{Value, json};

use crate::cli::judging::LeaderboardArgs;
use crate::out::{ExitStatus, Printer, refusal};

pub(crate) fn run(args: &LeaderboardArgs, out: &Printer) -> Result<ExitStatus> {
    let mut report = Report::default();
    let bench = Benchmark::open(&args.bench.bench)?;
    let exam = Exam::open(bench, args.bench.profile, QuerySet::Queries, &args.bench.scenes, &mut report)?;
    let Gathered { board, report: found } =
        gather(&args.scores, &exam).map_err(|error| with_hint(error, args))?;
    report.extend(found);
    let paths = publish(&board, &args.output).map_err(|error| with_hint(error, args))?;

    for finding in report.into_sorted() {
        out.warn(format!("{}: {}; {}", finding.path, finding.message, finding.hint));
    }
    if args.json {
        out.json(&as_json(&board))?;
    } else {
        out.data(text_table(&board))?;
    }
    out.note(format!("\n{} files in {}:", paths.len(), args.output.display()));
    for path in paths {
        out.note(format!("  {}", path.display()));
    }
    Ok(ExitStatus::Success)
}

fn with_hint(error: BoardError, args: &LeaderboardArgs) -> anyhow::Error {
    let scores = args.scores.display();
    let message = error.to_string();
    match error {
        _ if !args.scores.exists() => refusal(
            format!("{scores}: there is no such folder"),
            "run `l4d score` first, or name the folder of scores",
        ),
        BoardError::NoMethods => {
            refusal(format!("{scores}: {message}"), "run `l4d score` first, or name the folder of scores")
        }
        BoardError::NoneHere { .. } => refusal(
            message,
            "choose the --profile and --bench that the scores were made with, or run `l4d score` again",
        ),
        // As itself, so that its own hint is found.
        BoardError::Data(error) => error.into(),
        error => error.into(),
    }
}

fn as_json(board: &Board) -> Value {
    let heading = &board.heading;
    let ranked = board.ranked.iter().map(|entry| json!({
        "name": entry.row.name, "rank": entry.rank, "seconds": entry.row.seconds, "scores": entry.row.scores,
    }));
    let unranked = board.unranked.iter().map(|entry| json!({
        "name": entry.row.name, "unranked_because": entry.reasons, "seconds": entry.row.seconds, "scores": entry.row.scores,
    }));
    json!({
        "benchmark": heading.benchmark,
        "benchmark_version": heading.version,
        "protocol": heading.protocol,
        "profile": heading.profile,
        "queries": heading.queries,
        "verified_queries": heading.verified,
        "rejected_queries": heading.rejected,
        "ranked": ranked.collect::<Vec<_>>(),
        "unranked": unranked.collect::<Vec<_>>(),
    })
}
