//! What each lift and its settings make of the same evidence, and how long that takes.
//!
//! Evidence is what the training views truly show, with the errors that are asked for, after consensus. Masks of the
//! held-out view are judged as `l4d score` judges them, in memory. Measures lifting alone: no result of a method.

mod flicker;
mod measure;

use std::path::Path;

use l4d_data::store::write_atomic;
use l4d_data::{At as _, Progress, Query, Workspace};
use l4d_ground::oracle::NoisePreset;
use l4d_score::EvalSet;
use l4d_solve::consensus::Preset;
use l4d_solve::grounders::Grounders;
use l4d_solve::lift::{ClosedSettings, FieldSettings, LiftSettings};
use l4d_splat::raster::Rasterizer;
use serde::Serialize;
use serde_json::Value;

use self::measure::{Sample, Subject};
use crate::Result;
use crate::csv_file::{csv_of, rounded};
use crate::judged_scene::JudgedScene;

/// The row against which the others stand.
const BASE: &str = "closed form, as users get it";

/// What is measured, and on what.
pub struct LiftRequest<'a> {
    /// Scenes, queries and truth.
    pub eval_set: &'a EvalSet,
    /// Profile and folders.
    pub space: &'a Workspace,
    /// Errors of what training views show; none for none.
    pub noise: Option<NoisePreset>,
    /// Views at most.
    pub views: usize,
    /// Queries per scene, evenly from its list.
    pub queries: usize,
    /// Few lifts and short learning.
    pub is_quick: bool,
    /// Receives `lift.csv`.
    pub folder: &'a Path,
    pub rasterizer: &'a dyn Rasterizer,
    /// What it draws on, for manifests; none for the processor.
    pub adapter: Option<Value>,
}

/// What was measured.
#[derive(Debug)]
pub struct Benched {
    /// One line about what was lifted.
    pub about: String,
    /// One row per lift.
    pub rows: Vec<Row>,
}

/// One lift, as means over queries. Fields that end in `_seconds` are times; everything else is the same in every run.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    /// Rows that belong together.
    pub series: &'static str,
    /// The lift and its settings.
    pub setting: String,
    /// Per query.
    pub lift_seconds: f64,
    /// Per query.
    pub mask_seconds: f64,
    /// Of the held-out view, percent.
    pub miou: f64,
    /// The same over all frames together.
    pub tube_iou: f64,
    /// Pixels that come and go, percent of the true area per frame.
    pub flicker: Option<f64>,
    /// That were measured.
    pub queries: usize,
}

/// Lifts the evidence of queries in every way and judges the masks.
///
/// # Errors
/// Whatever opening scenes, lifting and judging meet.
pub fn bench(request: &LiftRequest<'_>, progress: &dyn Progress) -> Result<Benched> {
    let LiftRequest { eval_set, rasterizer, .. } = *request;
    let grounders = Grounders::Oracle(request.noise.clone().unwrap_or_else(NoisePreset::none));
    let lifts = lifts(request.is_quick);
    let clips = Preset::Robust.clip_settings(request.views, 0);
    let mut samples: Vec<Vec<Sample>> = vec![Vec::new(); lifts.len()];
    progress.start("lifting", (eval_set.scenes.len() * request.queries * lifts.len()) as u64);
    for scene in &eval_set.scenes {
        progress.item(&scene.name);
        let draws = (rasterizer, request.adapter.clone());
        let judged = JudgedScene::open(eval_set, scene, request.space, &clips, draws)?;
        let queries: Vec<Query> = judged.queries().cloned().collect();
        let grounder = grounders.of_scene(&judged.scene, rasterizer, &judged.places.data, &queries)?;
        for query in evenly(&queries, request.queries) {
            let subject = Subject::new(&judged, query, grounder.as_ref()).at(&query.id)?;
            for ((_, _, lift), samples) in lifts.iter().zip(&mut samples) {
                samples.extend(subject.measure(lift, rasterizer).at(&query.id)?);
                progress.advance(1);
            }
        }
    }
    progress.finish();
    let rows: Vec<Row> = lifts
        .into_iter()
        .zip(&samples)
        .filter_map(|((series, setting, _), samples)| Row::new(series, setting, samples))
        .collect();
    let queries = rows.iter().map(|row| row.queries).max().unwrap_or_default();
    let names: Vec<&str> = eval_set.scenes.iter().map(|scene| scene.name.as_str()).collect();
    let about = format!(
        "{queries} {} of {} at profile {}, {} views; the oracle {}",
        if queries == 1 { "query" } else { "queries" },
        names.join(", "),
        eval_set.profile,
        request.views,
        if request.noise.is_none() { "makes no errors" } else { "errs as it was told" }
    );
    write_atomic(&request.folder.join("lift.csv"), &csv_of(&rows)?)?;
    Ok(Benched { about, rows })
}

/// Series, name and settings of what is compared.
fn lifts(is_quick: bool) -> Vec<(&'static str, String, LiftSettings)> {
    let robust = ClosedSettings::robust();
    // Over all pictures.
    let sirt = |steps, smoothness| ClosedSettings { steps, step_times: u32::MAX, smoothness, ..robust };
    let mut closed = vec![
        ("closed form", BASE, robust),
        ("vote", "vote", ClosedSettings::vote()),
        ("SIRT", "SIRT, 1 step", sirt(1, 0.0)),
    ];
    if !is_quick {
        closed.extend([
            ("vote", "vote, graph", ClosedSettings { steps: 0, ..robust }),
            ("SIRT", "SIRT, 3 steps", sirt(3, 0.0)),
            ("SIRT and graph", "SIRT, 1 step, graph", sirt(1, robust.smoothness)),
            ("SIRT and graph", "SIRT, 3 steps, graph", sirt(3, robust.smoothness)),
        ]);
    }
    let closed = closed
        .into_iter()
        .map(|(series, setting, settings)| (series, setting.to_owned(), LiftSettings::Closed(settings)));
    let lengths: &[u32] = if is_quick { &[20] } else { &[250, 500, 1000, 2000] };
    let fields = lengths.iter().map(|&iterations| {
        let settings = FieldSettings { iterations, ..FieldSettings::paper() };
        ("field", format!("field, {iterations}"), LiftSettings::Field(settings))
    });
    closed.chain(fields).collect()
}

/// So many of a list, from the middles of as many equal parts.
fn evenly<T>(list: &[T], count: usize) -> impl Iterator<Item = &T> {
    let count = count.min(list.len());
    (0..count).map(move |part| &list[(2 * part + 1) * list.len() / (2 * count)])
}

impl Row {
    /// Whether it is the lift that users get by default.
    pub fn is_base(&self) -> bool {
        self.setting == BASE
    }

    /// None without a query whose target is ever present.
    fn new(series: &'static str, setting: String, samples: &[Sample]) -> Option<Self> {
        let mean = |of: fn(&Sample) -> Option<f64>| {
            let values: Vec<f64> = samples.iter().filter_map(of).collect();
            (!values.is_empty()).then(|| rounded(values.iter().sum::<f64>() / values.len() as f64))
        };
        Some(Self {
            series,
            setting,
            lift_seconds: mean(|sample| Some(sample.lift_seconds))?,
            mask_seconds: mean(|sample| Some(sample.mask_seconds))?,
            miou: mean(|sample| Some(100.0 * sample.miou))?,
            tube_iou: mean(|sample| Some(100.0 * sample.tube_iou))?,
            flicker: mean(|sample| sample.flicker),
            queries: samples.len(),
        })
    }
}

/// The table for a terminal.
pub fn text(rows: &[Row]) -> String {
    let mut text = format!(
        "{:<42}{:>10}{:>10}{:>9}{:>10}{:>9}",
        "setting", "lift, s", "masks, s", "mIoU", "tube IoU", "flicker"
    );
    for row in rows {
        let flicker = row.flicker.map_or_else(|| "-".to_owned(), |value| format!("{value:.2}"));
        text.push_str(&format!(
            "\n{:<42}{:>10.3}{:>10.3}{:>9.2}{:>10.2}{flicker:>9}",
            row.setting, row.lift_seconds, row.mask_seconds, row.miou, row.tube_iou
        ));
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_a_list_comes_from_all_over_it() {
        let part = |count: usize| evenly(&[0, 1, 2, 3, 4, 5, 6, 7], count).copied().collect::<Vec<_>>();
        assert_eq!((part(2), part(1), part(9).len()), (vec![2, 6], vec![4], 8));
        assert_eq!(evenly::<u8>(&[], 3).count(), 0);
    }
}
