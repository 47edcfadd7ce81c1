//! From a folder of scores to a board. Every number of this board follows from `counts.csv`; the summary beside it
//! says what was scored, and must agree.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::store::list_folder;
use l4d_data::{DataError, Query, Report, Status};
use l4d_score::Exam;
use l4d_score::counts::{self, FrameCount, State};
use l4d_score::exam::SceneExam;
use l4d_score::score::{counts_path, summary_path, tallies_of_counts};
use l4d_score::{Breakdown, Estimate, Missing, Options, QuerySet, Summary};
use rayon::prelude::*;

use crate::codes;
use crate::error::BoardError;
use crate::rank::Board;
use crate::row::{BoardRow, Heading, Metric};
use crate::statistics::Statistics;

/// A board and what was odd among the scores.
#[derive(Debug)]
pub struct Gathered {
    /// The board.
    pub board: Board,
    /// What its means can tell.
    pub statistics: Statistics,
    /// Warnings.
    pub report: Report,
}

/// Reads `scores/<method>/` of every method and sorts them into a board of `exam`. `seed` is that of the draws behind
/// intervals.
pub fn gather(scores: &Path, exam: &Exam, seed: u64) -> Result<Gathered, BoardError> {
    let mut report = Report::default();
    let summaries = read_summaries(scores, &mut report)?;
    let heading = heading(exam, &summaries);
    let of_method = |summary: Summary| match is_of_exam(&summary, exam) {
        true => counted_row(scores, summary, exam, seed),
        false => Ok(row(summary, None, BTreeMap::new())),
    };
    let rows = summaries.into_par_iter().map(of_method).collect::<Result<Vec<BoardRow>, DataError>>()?;
    let board = Board::new(heading, rows)?;
    let statistics = Statistics::of(&board, scores, exam, seed)?;
    for row in board.others.iter().flat_map(|other| &other.rows) {
        let message = format!(
            "was scored on benchmark {} · protocol {} · profile {}",
            row.benchmark_version, row.protocol, row.profile
        );
        let hint = "it stands apart and is not ranked here; score it again, or choose its --profile";
        report.warning(codes::OTHER_BOARD, &summary_path(scores, &row.name), "", message, hint);
    }
    Ok(Gathered { board, statistics, report })
}

fn read_summaries(scores: &Path, report: &mut Report) -> Result<Vec<Summary>, DataError> {
    let mut summaries = Vec::new();
    for entry in list_folder(scores)? {
        if !scores.join(&entry).is_dir() {
            continue;
        }
        let path = summary_path(scores, &entry);
        if !path.exists() {
            let message = "holds no summary.json, so it is left out";
            report.warning(
                codes::NOT_SCORED,
                &scores.join(&entry),
                "",
                message,
                "run `l4d score`, or remove the folder",
            );
            continue;
        }
        let summary = Summary::read(&path)?;
        if summary.name.as_str() != entry {
            let message = format!("is `{}`, but the folder is `{entry}`", summary.name);
            return Err(DataError::invalid(&path, "field `name`", message, "run `l4d score` again"));
        }
        summaries.push(summary);
    }
    Ok(summaries)
}

fn is_of_exam(summary: &Summary, exam: &Exam) -> bool {
    summary.set == exam.set
        && summary.profile == exam.profile
        && summary.benchmark_version == exam.bench.manifest.version
        && summary.truth_digest == exam.truth_digest
}

/// The board is of the protocol that most methods were scored with, among equals the plainest.
fn heading(exam: &Exam, summaries: &[Summary]) -> Heading {
    let mut votes: BTreeMap<String, (usize, Options)> = BTreeMap::new();
    for summary in summaries.iter().filter(|summary| is_of_exam(summary, exam)) {
        votes.entry(protocol(summary)).or_insert((0, summary.options)).0 += 1;
    }
    let mut chosen: Option<(String, usize, Options)> = None;
    for (label, (count, options)) in votes {
        if chosen.as_ref().is_none_or(|(_, most, _)| count > *most) {
            chosen = Some((label, count, options));
        }
    }
    let (protocol, _, options) =
        chosen.unwrap_or_else(|| (l4d_score::results::PROTOCOL.to_owned(), 0, Options::default()));
    let asked = || exam.scenes.iter().flat_map(|scene| &scene.queries).filter(|query| options.takes(query));
    let is_verified = |query: &&Query| query.status == Status::Verified;
    let has_any = |scene: &&SceneExam| scene.queries.iter().any(|query| options.takes(query));
    Heading {
        benchmark: exam.bench.manifest.name.clone(),
        version: exam.bench.manifest.version.clone(),
        truth_digest: exam.truth_digest.clone(),
        protocol,
        profile: exam.profile,
        queries: asked().count(),
        scenes: exam.scenes.iter().filter(has_any).count(),
        verified: asked().filter(is_verified).count(),
        rejected: exam.rejected(),
    }
}

/// The protocol with the choices that make its numbers incomparable with others.
fn protocol(summary: &Summary) -> String {
    let mut label = summary.protocol.clone();
    if summary.options.hit_iou != 0.0 {
        label.push_str(&format!(" with hits above IoU {}", summary.options.hit_iou));
    }
    if summary.set != QuerySet::default() {
        label.push_str(&format!(" on {}", summary.set.as_str()));
    }
    if summary.options.verified_only {
        label.push_str(" on verified queries only");
    }
    label
}

fn counted_row(scores: &Path, mut summary: Summary, exam: &Exam, seed: u64) -> Result<BoardRow, DataError> {
    let path = counts_path(scores, &summary.name);
    let counts = counts::read(&path)?;
    let tallies = tallies_of_counts(&counts, exam, &summary.options);
    let derived = Breakdown::of(&tallies);
    // A method that was scored on other scenes cannot be derived from the queries of these.
    if summary.asked_queries == tallies.len() {
        if !agree(&derived, &summary.scores) {
            let message = "the numbers of summary.json do not follow from these rows";
            return Err(DataError::invalid(&path, "rows", message, "run `l4d score` again"));
        }
        summary.scores = derived;
    }
    let miou = Estimate::of_ratio(&tallies, |ratios| ratios.miou, seed);
    let frames = mean_iou_of_frames(&counts, &summary.options);
    Ok(row(summary, miou, frames))
}

fn agree(derived: &Breakdown, told: &Breakdown) -> bool {
    let same = |metric: &Metric| match (metric.of(&derived.headline), metric.of(&told.headline)) {
        (Some(derived), Some(told)) => (derived - told).abs() < 1e-6,
        (derived, told) => derived == told,
    };
    derived.headline.queries == told.headline.queries && Metric::ALL.iter().all(same)
}

/// Frame -> mean IoU, percent, over the queries with a true or predicted pixel there; a false alarm counts 0.
fn mean_iou_of_frames(counts: &[FrameCount], options: &Options) -> BTreeMap<u32, f64> {
    let mut sums: BTreeMap<u32, (f64, u32)> = BTreeMap::new();
    for count in counts {
        let is_left_out = match count.state {
            State::NotAnnotated => true,
            State::Missing => options.missing == Missing::Skip,
            State::Hit | State::Miss | State::FalseAlarm | State::TrueAbsent => false,
        };
        if is_left_out || count.union == 0 {
            continue;
        }
        let (sum, queries) = sums.entry(count.frame).or_default();
        *sum += count.intersection as f64 / count.union as f64;
        *queries += 1;
    }
    sums.into_iter().map(|(frame, (sum, queries))| (frame, 100.0 * sum / f64::from(queries))).collect()
}

fn row(summary: Summary, miou: Option<Estimate>, frames: BTreeMap<u32, f64>) -> BoardRow {
    let protocol = protocol(&summary);
    let unranked_because = summary.unranked_because();
    let Summary { name, version, link, seconds, profile, reported, .. } = summary;
    BoardRow {
        name,
        version,
        link,
        profile,
        protocol,
        benchmark_version: summary.benchmark_version,
        truth_digest: summary.truth_digest,
        track: summary.used.track(),
        unranked_because,
        partial: summary.partial,
        seconds,
        asked: summary.asked_queries,
        scores: summary.scores,
        miou,
        reported,
        frames,
    }
}
