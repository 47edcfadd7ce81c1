//! `l4d leaderboard`: scores of methods in, ranked tables, figures and a page out.

mod page;

use std::path::Path;

use anyhow::Result;
use l4d_board::board::Method;
use l4d_board::{Answers, Board, BoardError, ProtocolTable, gather, publish, text_statistics, text_table};
use l4d_data::benchmark::SetSplit;
use l4d_data::workspace::{default_leaderboard, default_scores};
use l4d_data::{Benchmark, Report, counted};
use l4d_score::EvalSet;
use serde_json::{Value, json};

use crate::cli::judging::LeaderboardArgs;
use crate::out::{ExitStatus, Printer, refusal};
use crate::readmes;

pub(crate) fn run(args: &LeaderboardArgs, out: &Printer) -> Result<ExitStatus> {
    let mut report = Report::default();
    let bench = Benchmark::open(&args.bench.bench)?;
    let set = args.set;
    let eval_set = EvalSet::open(bench, args.bench.profile, set, &args.bench.scenes, &mut report)?;
    let scores = args.scores.clone().unwrap_or_else(|| default_scores(set.as_str(), None));
    let output = args.out.clone().unwrap_or_else(|| default_leaderboard(set.as_str()));
    let (board, found) = gather(&scores, &eval_set, args.seed).map_err(|error| with_hint(error, &scores))?;
    report.extend(found);
    let is_withheld = eval_set.bench.manifest.split == SetSplit::Private && !args.with_answers;
    if is_withheld && args.html {
        let hint = "leave out --html, or add --with-answers for a board that stays with you";
        return Err(refusal("the set is private, and the page shows its answers", hint));
    }
    let publish = |answers: Answers<'_>| {
        publish(&board, &output, answers, args.force).map_err(|error| with_hint(error, &scores))
    };
    let paths = match (args.html, is_withheld) {
        (true, _) => page::with_media(args, &eval_set, out, |media| publish(Answers::Shown(media)))?,
        (false, true) => publish(Answers::Withheld)?,
        (false, false) => publish(Answers::Named)?,
    };
    if is_withheld {
        out.note("the set is private: what names its answers (board.json, taken.csv, the page) stays out, and the rest may be published");
    }

    readmes::leave(&output, readmes::LEADERBOARD)?;
    out.warnings(report);
    if args.json {
        out.json(&as_json(&board))?;
    } else {
        out.data(text_table(&board))?;
        out.data(format!("\n{}", text_statistics(&board)))?;
        if !board.protocols.is_empty() {
            let names: Vec<&str> = board.protocols.iter().map(|table| table.protocol.as_str()).collect();
            let folder = output.join("protocols");
            out.data(format!("\nApart and never ranked, in {}: {}.", folder.display(), names.join(", ")))?;
        }
    }
    out.note(format!("\n{} in {}:", counted(paths.len(), "file"), output.display()));
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
        error => error.into(),
    }
}

fn as_json(board: &Board) -> Value {
    let heading = &board.heading;
    let ranked = |method: &Method| {
        json!({
            "name": method.name, "rank": method.rank, "track": method.track, "seconds": method.seconds,
            "scores": method.scores, "miou": method.miou, "reported": method.reported,
        })
    };
    let unranked = |method: &Method| {
        json!({
            "name": method.name, "unranked_because": method.unranked_because, "track": method.track,
            "seconds": method.seconds, "scores": method.scores, "miou": method.miou, "reported": method.reported,
        })
    };
    let method = |index: usize| &board.methods[index];
    let pairs = board.comparisons.iter().flat_map(|found| {
        found.pairs.iter().map(|pair| {
            json!({
                "metric": found.metric.key(), "track": method(pair.first).track, "first": method(pair.first).name,
                "second": method(pair.second).name, "difference": pair.comparison.difference, "p": pair.comparison.p,
                "holm_p": pair.holm_p, "detectable": pair.comparison.detectable, "different": pair.is_different(),
            })
        })
    });
    json!({
        "benchmark": heading.benchmark,
        "benchmark_version": heading.on.benchmark_version,
        "protocol": heading.on.protocol,
        "profile": heading.on.profile,
        "queries": heading.queries,
        "verified_queries": heading.verified,
        "rejected_queries": heading.rejected,
        "ranked": board.ranked().iter().map(ranked).collect::<Value>(),
        "unranked": board.unranked().iter().map(unranked).collect::<Value>(),
        "comparisons": pairs.collect::<Value>(),
        "protocols": board.protocols.iter().map(ProtocolTable::to_json).collect::<Value>(),
    })
}
