//! `l4d leaderboard`: scores of methods in, ranked tables, figures and a page out.

mod page;
mod reliability;

use std::path::Path;

use anyhow::Result;
use l4d_board::{
    Board, BoardError, Details, Gathered, ProtocolTable, Statistics, gather, gather_protocols, publish,
    publish_reliability, text_statistics, text_table,
};
use l4d_data::results::Track;
use l4d_data::workspace::{default_leaderboard, default_scores};
use l4d_data::{Benchmark, Report};
use l4d_score::{Exam, QuerySet};
use serde_json::{Value, json};

use crate::cli::judging::LeaderboardArgs;
use crate::out::{ExitStatus, Printer, refusal};

/// What the scores became.
struct Made<'a> {
    board: &'a Board,
    statistics: &'a Statistics,
    details: &'a Details<'a>,
    protocols: &'a [ProtocolTable],
}

pub(crate) fn run(args: &LeaderboardArgs, out: &Printer) -> Result<ExitStatus> {
    let mut report = Report::default();
    let bench = Benchmark::open(&args.bench.bench)?;
    let set: QuerySet = args.set.into();
    let exam = Exam::open(bench, args.bench.profile, set, &args.bench.scenes, &mut report)?;
    let scores = args.scores.clone().unwrap_or_else(|| default_scores(set.as_str(), None));
    let output = args.output.clone().unwrap_or_else(|| default_leaderboard(set.as_str()));
    let Gathered { board, statistics, report: found } =
        gather(&scores, &exam, args.seed).map_err(|error| with_hint(error, &scores))?;
    report.extend(found);
    let details = Details::read(&board, &scores, &exam)?;
    let protocols = gather_protocols(&scores, &board, &exam, &mut report)?;
    let mut paths = publish(&board, &statistics, &details, &protocols, &exam.bench.dir, &output)
        .map_err(|error| with_hint(error, &scores))?;
    let certainties = reliability::of_methods(args, &exam, &details)?;
    if !certainties.is_empty() {
        let figures = output.join("figures");
        paths.extend(publish_reliability(&certainties, &reliability::about(&board), &figures)?);
    }
    if args.html {
        let made = Made { board: &board, statistics: &statistics, details: &details, protocols: &protocols };
        paths.push(page::write(args, &exam, &made, [&scores, &output], out)?);
    }

    for finding in report.into_sorted() {
        out.warn(format!("{}: {}; {}", finding.path, finding.message, finding.hint));
    }
    if args.json {
        out.json(&as_json(&board, &statistics, &protocols))?;
    } else {
        out.data(text_table(&board))?;
        out.data(format!("\n{}", text_statistics(&board, &statistics)))?;
        if !protocols.is_empty() {
            let names: Vec<&str> = protocols.iter().map(|table| table.protocol.as_str()).collect();
            let folder = output.join("protocols");
            out.data(format!("\nApart and never ranked, in {}: {}.", folder.display(), names.join(", ")))?;
        }
    }
    out.note(format!("\n{} files in {}:", paths.len(), output.display()));
    for path in paths {
        out.note(format!("  {}", path.display()));
    }
    Ok(ExitStatus::Success)
}

fn with_hint(error: BoardError, folder: &Path) -> anyhow::Error {
    let scores = folder.display();
    let message = error.to_string();
    match error {
        _ if !folder.exists() => refusal(
            format!("{scores}: there is no such folder"),
            "run `l4d score` first, or name the folder of scores",
        ),
        BoardError::NoMethods => refusal(
            format!("{scores}: {message}"),
            "run `l4d score` first, or name the folder of scores; what `--protocol` wrote is never ranked",
        ),
        BoardError::NoneHere { .. } => refusal(
            message,
            "choose the --profile and --bench that the scores were made with, or run `l4d score` again",
        ),
        // As itself, so that its own hint is found.
        BoardError::Data(error) => error.into(),
        error => error.into(),
    }
}

fn as_json(board: &Board, statistics: &Statistics, protocols: &[ProtocolTable]) -> Value {
    let heading = &board.heading;
    let ranked = board.ranked.iter().map(|entry| json!({
        "name": entry.row.name, "rank": entry.rank, "track": entry.row.track, "seconds": entry.row.seconds, "scores": entry.row.scores,
        "miou": entry.row.miou, "reported": entry.row.reported,
    }));
    let unranked = board.unranked.iter().map(|entry| json!({
        "name": entry.row.name, "unranked_because": entry.reasons, "track": entry.row.track, "seconds": entry.row.seconds, "scores": entry.row.scores,
        "miou": entry.row.miou, "reported": entry.row.reported,
    }));
    let name = |index: usize| &statistics.methods[index].name;
    let tracks: Vec<Track> = board.rows().map(|(_, row)| row.track).collect();
    let tracks = &tracks;
    let pairs = statistics.comparisons.iter().flat_map(|found| {
        found.pairs.iter().map(|pair| {
            json!({
                "metric": found.metric.key(), "track": tracks[pair.first], "first": name(pair.first), "second": name(pair.second),
                "difference": pair.comparison.difference, "p": pair.comparison.p, "holm_p": pair.holm_p,
                "detectable": pair.comparison.detectable, "different": pair.is_different(),
            })
        })
    });
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
        "comparisons": pairs.collect::<Vec<_>>(),
        "protocols": protocols.iter().map(ProtocolTable::to_json).collect::<Value>(),
    })
}
