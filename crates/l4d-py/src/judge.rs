//! Scores, findings and baselines: what `l4d score`, `l4d check-results` and `l4d baseline` do.

use std::path::PathBuf;

use l4d_data::{self as data, Report};
use l4d_score::baseline::write_baseline as write;
use l4d_score::results::MEGABYTE;
use l4d_score::{Baseline, Options, check_results, score_results};
use pyo3::prelude::*;

use crate::benchmark::Benchmark;
use crate::error::{Failure, Result, choice, unknown};
use crate::query::{json_to_python, word};

/// One problem that a check found, with a stable code (docs/findings.md).
#[pyclass(frozen, get_all, module = "l4d")]
pub(crate) struct Finding {
    /// `L4D` and three digits.
    code: &'static str,
    /// `"error"` or `"warning"`.
    severity: String,
    /// File or folder.
    path: String,
    /// Field, line, view, frame or entry inside it.
    place: String,
    /// What is wrong.
    message: String,
    /// What to do.
    hint: String,
}

impl From<data::Finding> for Finding {
    fn from(found: data::Finding) -> Self {
        let data::Finding { code, severity, path, location, message, hint, .. } = found;
        Self { code, severity: word(&severity), path, place: location, message, hint }
    }
}

#[pymethods]
impl Finding {
    fn __repr__(&self) -> String {
        let Self { code, severity, path, place, message, hint } = self;
        let place = if place.is_empty() { String::new() } else { format!(": {place}") };
        format!("{path}{place}: {severity}[{code}]: {message} (hint: {hint})")
    }
}

/// Scores a results folder, or a folder of them: the document that `l4d score --json` prints, number for number.
///
/// Percentages are under `document["methods"]`; a method with an error finding is not among them, and
/// `document["findings"]` says why. `set` is `"queries"` or `"composites"`; `scenes` are all by default; `missing` is
/// `"error"`, `"zero"` or `"skip"`; mAcc counts frames whose IoU is above `hit_iou`. `counts.csv` and `summary.json` of
/// each method are written below `scores`, or nowhere; files of others there are replaced only if `force` is set. A
/// method with more than `max_megabytes` of masks is not read.
#[pyfunction]
#[pyo3(signature = (results, benchmark, *, set = "queries", scenes = None, missing = "error", hit_iou = 0.0, verified_only = false, resize = false, scores = None, max_megabytes = 4000, force = false))]
#[expect(clippy::too_many_arguments, reason = "those of the verb")]
pub(crate) fn score<'py>(
    py: Python<'py>,
    results: PathBuf,
    benchmark: &Benchmark,
    set: &str,
    scenes: Option<Vec<String>>,
    missing: &str,
    hit_iou: f64,
    verified_only: bool,
    resize: bool,
    scores: Option<PathBuf>,
    max_megabytes: u64,
    force: bool,
) -> Result<Bound<'py, PyAny>> {
    let missing = choice("missing", missing, &["error", "zero", "skip"])?;
    if !(0.0..1.0).contains(&hit_iou) {
        let message = format!("{hit_iou} is no threshold");
        return Err(Failure::argument("hit_iou", message, "give a number from 0 to below 1"));
    }
    let options = Options { missing, hit_iou, verified_only, resize };
    let document = py.detach(|| {
        let mut report = Report::default();
        let mut eval_set = benchmark.eval_set(set, scenes.as_deref().unwrap_or_default(), &mut report)?;
        eval_set.most_bytes = max_megabytes.saturating_mul(MEGABYTE);
        let nowhere = tempfile::tempdir().map_err(|error| Failure::of_chain(&error))?;
        let folder = scores.as_deref().unwrap_or(nowhere.path());
        let mut scored = score_results(&results, &eval_set, &options, folder, force, |_| {})?;
        report.extend(std::mem::take(&mut scored.report));
        scored.report = report;
        Ok::<_, Failure>(scored.into_document(&eval_set))
    })?;
    json_to_python(py, &document)
}

/// Every problem of a results folder, or of a folder of them: what `l4d check-results` finds. A method with more than
/// `max_megabytes` of masks is not read.
#[pyfunction]
#[pyo3(signature = (results, benchmark, *, set = "queries", scenes = None, max_megabytes = 4000))]
pub(crate) fn check(
    py: Python<'_>,
    results: PathBuf,
    benchmark: &Benchmark,
    set: &str,
    scenes: Option<Vec<String>>,
    max_megabytes: u64,
) -> Result<Vec<Finding>> {
    let report = py.detach(|| {
        let mut report = Report::default();
        let mut eval_set = benchmark.eval_set(set, scenes.as_deref().unwrap_or_default(), &mut report)?;
        eval_set.most_bytes = max_megabytes.saturating_mul(MEGABYTE);
        check_results(&results, &eval_set, &mut report)?;
        Ok::<_, Failure>(report)
    })?;
    Ok(report.into_sorted().into_iter().map(Finding::from).collect())
}

/// Writes the results of a baseline to `<results>/<name>/` and gives that folder: what `l4d baseline` does.
///
/// `name` is `"oracle"`, `"time-agnostic"`, `"look-alike-union"`, `"random-look-alike"`, `"all"` or `"none"`. Files with
/// the right bytes are kept; other bytes are replaced only if `force` is set.
#[pyfunction]
#[pyo3(signature = (name, benchmark, results, *, scenes = None, seed = 0, force = false))]
pub(crate) fn write_baseline(
    py: Python<'_>,
    name: &str,
    benchmark: &Benchmark,
    results: PathBuf,
    scenes: Option<Vec<String>>,
    seed: u64,
    force: bool,
) -> Result<PathBuf> {
    let known = Baseline::ALL.map(Baseline::as_str);
    let found = Baseline::ALL.into_iter().find(|baseline| baseline.as_str() == name);
    let baseline = found.ok_or_else(|| unknown("name", name, &known))?;
    py.detach(|| {
        // `check` and `score` report scenes that are left out.
        let eval_set =
            benchmark.eval_set("queries", scenes.as_deref().unwrap_or_default(), &mut Report::default())?;
        write(baseline, &eval_set, seed, &results, force)?;
        Ok(results.join(baseline.as_str()))
    })
}
