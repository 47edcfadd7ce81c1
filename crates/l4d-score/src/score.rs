//! Scores methods: reads their masks, counts, writes `counts.csv` and sums up.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use l4d_data::layout::ResultsDir;
use l4d_data::results::MethodCard;
use l4d_data::store::{AtomicFile, Claim, Earlier, FolderLock};
use l4d_data::{DataError, Query, QueryId, Report, json};
use rayon::prelude::*;
use serde_json::Value;

use crate::codes;
use crate::counts::{FrameCount, to_csv};
use crate::eval_set::{EvalScene, EvalSet};
use crate::judge::{Answer, QueryJudge};
use crate::metrics::{Missing, Options, QueryFacts, QueryTally};
use crate::reading::{Holes, SceneReader};
use crate::results::{PROTOCOL, admit, each_method, find_methods, read_card};
use crate::summary::{SCHEMA, Summary};

/// Scores of all methods of a folder that have no error.
#[derive(Debug)]
pub struct Scored {
    /// One summary a method, in the order of their names.
    pub summaries: Vec<Summary>,
    /// What is wrong with the others, and with the benchmark.
    pub report: Report,
}

impl Scored {
    /// What `l4d score --json` prints: the scores with everything that they depend on, and the findings in order.
    pub fn into_document(self, eval_set: &EvalSet) -> Value {
        let scenes: Vec<&str> = eval_set.scenes.iter().map(|scene| scene.name.as_str()).collect();
        serde_json::json!({
            "protocol": PROTOCOL,
            "profile": eval_set.profile,
            "set": eval_set.set,
            "benchmark_version": eval_set.bench.manifest.version,
            "truth_digest": eval_set.truth_digest,
            "scenes": scenes,
            "methods": self.summaries,
            "findings": self.report.into_sorted(),
        })
    }
}

const COUNTS: &str = "counts.csv";
const SUMMARY: &str = "summary.json";

/// Where the counts of a method are written.
pub fn counts_path(scores: &Path, method: &str) -> PathBuf {
    scores.join(method).join(COUNTS)
}

/// Where the summary of a method is written.
pub fn summary_path(scores: &Path, method: &str) -> PathBuf {
    scores.join(method).join(SUMMARY)
}

/// Scores one method or a folder of them into `scores/<method>/`. A method with an error finding is not scored and
/// the scores that it had before stay. Files of others are replaced only if `force` is set. `progress` gets the name of
/// each method that was read.
///
/// # Errors
/// No query to score, a folder that cannot be listed, truth that is damaged, scores that another run writes or that are
/// not l4d's, and what the disk refuses.
pub fn score_results(
    root: &Path,
    eval_set: &EvalSet,
    options: &Options,
    scores: &Path,
    force: bool,
    progress: impl Fn(&str),
) -> Result<Scored, DataError> {
    let mut report = Report::default();
    let asked =
        eval_set.scenes.iter().flat_map(|scene| &scene.queries).filter(|query| options.takes(query)).count();
    if asked == 0 {
        let (message, place) = ("no query is left to score", "folder `queries`");
        let hint = match options.verified_only {
            true => "drop --verified-only, or have queries verified",
            false => "write queries, or choose other --scenes or another --set",
        };
        return Err(DataError::invalid(eval_set.bench.root(), place, message, hint));
    }
    let _lock = FolderLock::take(scores)?;
    let summaries =
        each_method(root, eval_set, options.resize, &mut report, progress, |dir, card, found| {
            score_method(dir, card, eval_set, options, (scores, force), found)
        })?;
    if let Some(first) = summaries.first() {
        report_never_present(first, eval_set, &mut report);
    }
    Ok(Scored { summaries, report })
}

fn score_method(
    dir: &ResultsDir,
    card: MethodCard,
    eval_set: &EvalSet,
    options: &Options,
    (scores, force): (&Path, bool),
    report: &mut Report,
) -> Result<Option<Summary>, DataError> {
    let earlier = Earlier { file: SUMMARY, says: SCHEMA };
    let names = [COUNTS, SUMMARY].map(str::to_owned).to_vec();
    let _claim = Claim::take(&scores.join(card.name.as_str()), names, Some(earlier), force)?;
    // Query by query; the file appears when all rows are there.
    let mut file = AtomicFile::create(&counts_path(scores, &card.name))?;
    file.write(&to_csv(&[], true))?;
    let mut tallies = Vec::new();
    // As many scenes at once as there are threads: their truth is all that memory must hold.
    for batch in eval_set.scenes.chunks(rayon::current_num_threads()) {
        let judged: Vec<JudgedScene> = batch
            .par_iter()
            .map(|scene| judge_scene(dir, scene, eval_set, options))
            .collect::<Result<_, DataError>>()?;
        for JudgedScene { queries, report: found } in judged {
            report.extend(found);
            for (tally, rows) in queries {
                file.write(&rows)?;
                tallies.push(tally);
            }
        }
    }
    if report.has_errors() {
        return Ok(None);
    }
    file.commit()?;
    let summary = Summary::new(card, eval_set, options, &tallies);
    json::write(&summary_path(scores, &summary.name), &summary)?;
    Ok(Some(summary))
}

struct JudgedScene {
    /// Each with its rows of `counts.csv`.
    queries: Vec<(QueryTally, Vec<u8>)>,
    report: Report,
}

fn judge_scene(
    dir: &ResultsDir,
    scene: &EvalScene,
    eval_set: &EvalSet,
    options: &Options,
) -> Result<JudgedScene, DataError> {
    let mut report = Report::default();
    let truth = eval_set.truth(scene);
    let holes = Holes::reported_if(options.missing == Missing::Error);
    let reader = SceneReader::open(dir, scene, options.resize, holes, &mut report);
    let judge = |query: &&Query| {
        let mut found = Report::default();
        let referents = truth.referents(query, &scene.queries_path)?;
        let judge = QueryJudge::new(&truth, query, &referents);
        let mut counts: Vec<FrameCount> =
            scene.clip.iter().map(|&frame| judge.frame(frame, &Answer::Missing)).collect();
        reader.read_each(query, &mut found, |position, answer| {
            counts[position] = judge.frame(scene.clip[position], answer);
        });
        let tally = QueryTally::of(QueryFacts::of(query, truth.scale), &counts, options);
        Ok((tally, to_csv(&counts, false), found))
    };
    let asked: Vec<&Query> = scene.queries.iter().filter(|query| options.takes(query)).collect();
    let judged = asked.par_iter().map(judge).collect::<Result<Vec<_>, DataError>>()?;
    let mut queries = Vec::with_capacity(judged.len());
    for (tally, rows, found) in judged {
        report.extend(found);
        queries.push((tally, rows));
    }
    Ok(JudgedScene { queries, report })
}

/// The rows of each query, in the order of the file.
fn rows_by_query(counts: &[FrameCount]) -> BTreeMap<&QueryId, Vec<&FrameCount>> {
    let mut rows: BTreeMap<&QueryId, Vec<&FrameCount>> = BTreeMap::new();
    for count in counts {
        rows.entry(&count.query).or_default().push(count);
    }
    rows
}

/// Sums up rows that were read back from `counts.csv`: the same numbers as when they were counted.
pub fn tallies_of_counts(counts: &[FrameCount], eval_set: &EvalSet, options: &Options) -> Vec<QueryTally> {
    let rows = rows_by_query(counts);
    let mut tallies = Vec::new();
    for scene in &eval_set.scenes {
        for query in scene.queries.iter().filter(|query| options.takes(query)) {
            let rows = rows.get(&query.id).map_or(&[][..], Vec::as_slice).iter().copied();
            tallies.push(QueryTally::of(QueryFacts::of(query, scene.scale), rows, options));
        }
    }
    tallies
}

fn report_never_present(summary: &Summary, eval_set: &EvalSet, report: &mut Report) {
    for id in &summary.never_present {
        let path = eval_set.bench.dir.queries(&id.scene);
        let message = format!("what it means is visible in no frame of profile {}", eval_set.profile);
        let hint = "it enters no mean of mIoU, mAcc, tube IoU and select; mend the query or the scene";
        report.warning(codes::NEVER_PRESENT, &path, format!("query {id}"), message, hint);
    }
}

/// Every problem of one method or a folder of them, without a score; gives the number of methods.
///
/// # Errors
/// A folder that cannot be listed, and truth that is damaged.
pub fn check_results(root: &Path, eval_set: &EvalSet, report: &mut Report) -> Result<usize, DataError> {
    let methods = find_methods(root, report)?;
    for dir in &methods {
        // Masks are worth reading even when the card is wrong: all problems shall be known at once.
        read_card(dir, eval_set, false, report);
        if admit(dir, eval_set, false, report) {
            eval_set.scenes.iter().for_each(|scene| check_scene(dir, scene, report));
        }
    }
    Ok(methods.len())
}

fn check_scene(dir: &ResultsDir, scene: &EvalScene, report: &mut Report) {
    let reader = SceneReader::open(dir, scene, false, Holes::Reported, report);
    let check = |query: &Query| {
        let mut found = Report::default();
        reader.read_each(query, &mut found, |_, _| {});
        found
    };
    let found: Vec<Report> = scene.queries.par_iter().map(check).collect();
    found.into_iter().for_each(|found| report.extend(found));
}
