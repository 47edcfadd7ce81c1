//! Masks of methods in, sheets of a protocol out.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::layout::ResultsDir;
use l4d_data::results::MethodCard;
use l4d_data::store::FolderLock;
use l4d_data::{DataError, Name, Query, QueryId, Report};
use rayon::prelude::*;
use serde_json::{Value, json};

use super::clip::{Clip, QueryScores, Summits};
use super::record::{Origin, Record};
use super::sheet::{Row, Sheet};
use super::{OnMissing, Protocol};
use crate::eval_set::{EvalScene, EvalSet};
use crate::judge::Answer;
use crate::metrics::{Missing, Options};
use crate::reading::{Holes, SceneReader};
use crate::results::each_method;
use crate::truth::SceneTruth;

const COUNTED: &str = "have no answer and count as empty, where the source would stop or take another frame";
const SKIPPED: &str = "have no answer and are left out by request, where the source would stop";

/// What a protocol says of all methods of a folder that have no error.
#[derive(Debug)]
pub struct Protocolled {
    pub protocol: Protocol,
    /// One sheet a method, in the order of their names.
    pub sheets: Vec<Sheet>,
    /// What is wrong with the others.
    pub report: Report,
}

impl Protocolled {
    /// What `l4d score --protocol NAME --json` prints.
    pub fn into_document(self, eval_set: &EvalSet) -> Value {
        let methods: Vec<Value> = self.sheets.iter().map(Sheet::to_json).collect();
        json!({
            "protocol": self.protocol.as_str(),
            "source": self.protocol.rules().source,
            "is_headline": false,
            "profile": eval_set.profile,
            "set": eval_set.set,
            "benchmark_version": eval_set.bench.manifest.version,
            "truth_digest": eval_set.truth_digest,
            "remark": self.protocol.rules().remark,
            "methods": methods,
            "findings": self.report.into_sorted(),
        })
    }
}

/// Judges one method or a folder of them and writes `<scores>/<method>/protocol-<name>.{csv,json}`. A method with an
/// error finding has no numbers. Files of others are replaced only if `force` is set. `progress` gets the name of each
/// method that was read.
///
/// # Errors
/// A folder that cannot be listed, truth that is damaged, a folder that another run writes into, files of others, and
/// what the disk refuses.
pub fn judge_results(
    root: &Path,
    eval_set: &EvalSet,
    protocol: Protocol,
    options: &Options,
    scores: &Path,
    force: bool,
    progress: impl Fn(&str),
) -> Result<Protocolled, DataError> {
    let mut report = Report::default();
    let resize = options.resize || protocol.rules().resizes;
    let options = Options { resize, ..*options };
    let _lock = FolderLock::take(scores)?;
    let sheets = each_method(root, eval_set, resize, &mut report, progress, |dir, card, found| {
        let sheet = judge_method(dir, &card, eval_set, protocol, &options, found)?;
        if found.has_errors() {
            return Ok(None);
        }
        let record = Record { origin: Origin::new(card, eval_set, &options), sheet };
        record.write(scores, force)?;
        Ok(Some(record.sheet))
    })?;
    Ok(Protocolled { protocol, sheets, report })
}

fn judge_method(
    dir: &ResultsDir,
    card: &MethodCard,
    eval_set: &EvalSet,
    protocol: Protocol,
    options: &Options,
    report: &mut Report,
) -> Result<Sheet, DataError> {
    let mut rows = Vec::new();
    let mut is_partial = false;
    for scene in &eval_set.scenes {
        let truth = eval_set.truth(scene);
        let queries: Vec<&Query> = scene.queries.iter().filter(|query| options.takes(query)).collect();
        let answers = read_scene(dir, scene, &truth, &queries, protocol, options, report);
        is_partial |= options.missing == Missing::Skip
            && answers.values().flatten().any(|answer| *answer == Answer::Missing);
        let asked =
            Asked { truth: &truth, queries: &queries, path: &scene.queries_path, missing: options.missing };
        rows.extend(judge_scene(protocol, &asked, &answers, &Summits::new())?);
    }
    Ok(Sheet::new(protocol, card.name.clone(), rows, is_partial))
}

/// The answers of a method to the queries of a scene, one per annotated frame.
fn read_scene(
    dir: &ResultsDir,
    scene: &EvalScene,
    truth: &SceneTruth,
    queries: &[&Query],
    protocol: Protocol,
    options: &Options,
    report: &mut Report,
) -> BTreeMap<QueryId, Vec<Answer>> {
    let is_refused = options.missing == Missing::Error && protocol.rules().on_missing == OnMissing::Stops;
    let reader = SceneReader::open(dir, scene, options.resize, Holes::reported_if(is_refused), report);
    let read = |query: &&Query| {
        let mut found = Report::default();
        let answers = reader.read(query, &mut found);
        let judged = scene.clip.iter().zip(answers).filter(|(frame, _)| truth.position(**frame).is_some());
        (query.id.clone(), judged.map(|(_, answer)| answer).collect(), found)
    };
    let read: Vec<(QueryId, Vec<Answer>, Report)> = queries.par_iter().map(read).collect();
    let keep = |(id, answers, found)| {
        report.extend(found);
        (id, answers)
    };
    read.into_iter().map(keep).collect()
}

/// What is asked of one scene.
struct Asked<'a> {
    truth: &'a SceneTruth,
    queries: &'a [&'a Query],
    /// The file to blame for them.
    path: &'a Path,
    missing: Missing,
}

/// Judges answers in memory under several protocols: one per annotated frame of the truth and query, those
/// of other queries are missing. `queries_path` is the file to blame for queries; a frame without an answer counts as
/// empty where the source would stop.
///
/// # Errors
/// Queries that name no instance of the truth.
pub fn judge_answers(
    protocols: &[Protocol],
    method: &Name,
    truth: &SceneTruth,
    queries: &[&Query],
    queries_path: &Path,
    answers: &BTreeMap<QueryId, Vec<Answer>>,
    summits: &Summits,
) -> Result<Vec<Sheet>, DataError> {
    let asked = Asked { truth, queries, path: queries_path, missing: Missing::Zero };
    let judge = |&protocol: &Protocol| {
        let rows = judge_scene(protocol, &asked, answers, summits)?;
        Ok(Sheet::new(protocol, method.clone(), rows, false))
    };
    protocols.iter().map(judge).collect()
}

fn judge_scene(
    protocol: Protocol,
    asked: &Asked<'_>,
    answers: &BTreeMap<QueryId, Vec<Answer>>,
    summits: &Summits,
) -> Result<Vec<Row>, DataError> {
    let is_scene_answered = answers.values().flatten().any(|answer| *answer != Answer::Missing);
    let unanswered = vec![Answer::Missing; asked.truth.frames.len()];
    let judge = |query: &&Query| {
        let referents = asked.truth.referents(query, asked.path)?;
        let answers = answers.get(&query.id).unwrap_or(&unanswered);
        let mut clip = Clip::new(asked.truth, query, &referents, answers, summits);
        clip.is_scene_answered = is_scene_answered;
        Ok(Row { id: query.id.clone(), judged: judge(protocol, clip, asked.missing) })
    };
    asked.queries.par_iter().map(judge).collect()
}

/// A source that stops has no rule for missing answers: what was asked for says what they mean.
fn judge(protocol: Protocol, mut clip: Clip<'_>, missing: Missing) -> QueryScores {
    if protocol.rules().on_missing == OnMissing::OwnRule {
        return (protocol.rules().judge)(&clip);
    }
    let count = clip.seen.iter().filter(|seen| seen.is_missing()).count();
    match missing {
        Missing::Skip => {
            clip.seen.retain(|seen| !seen.is_missing());
            (protocol.rules().judge)(&clip).leaving_out(SKIPPED, count)
        }
        Missing::Zero | Missing::Error => (protocol.rules().judge)(&clip).leaving_out(COUNTED, count),
    }
}
