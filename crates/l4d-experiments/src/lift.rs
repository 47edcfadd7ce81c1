//! What each lift and its settings make of the same evidence, and how long that takes.
//!
//! Evidence is what the training views truly show, with the errors that are asked for, after consensus. Masks of the
//! held-out view are judged as `l4d score` judges them, in memory. Measures lifting alone: no result of a method.

mod flicker;
mod measure;
mod samples;
mod table;
mod variants;

use std::path::Path;

use l4d_data::store::write_atomic;
use l4d_data::{DataError, Progress, Workspace};
use l4d_ground::oracle::NoisePreset;
use l4d_score::Exam;
use l4d_solve::consensus::Preset;
use l4d_solve::grounders::Grounders;
use l4d_splat::raster::Rasterizer;
use serde_json::Value;

use self::measure::{Measurement, Sums};
pub use self::table::{Row, text};
use self::variants::{Variant, variants};
use crate::Result;
use crate::csv_file::csv_of;
use crate::judged_scene::JudgedScene;

/// What is measured, and on what.
pub struct Order<'a> {
    /// Scenes, queries and truth.
    pub exam: &'a Exam,
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
    /// What draws.
    pub rasterizer: &'a dyn Rasterizer,
    /// What it draws on, for manifests; none for the processor.
    pub adapter: Option<Value>,
}

/// What was measured.
#[derive(Debug)]
pub struct Benched {
    /// One line about what was lifted.
    pub about: String,
    /// One row per lift and reading of it.
    pub rows: Vec<Row>,
}

/// Lifts the evidence of queries in every way and judges the masks. A killed run goes on where it was.
///
/// # Errors
/// Whatever opening scenes, lifting and judging meet.
pub fn bench(order: &Order<'_>, progress: &dyn Progress) -> Result<Benched> {
    let Order { exam, folder, .. } = order;
    let is_exact = order.noise.is_none();
    let grounders = Grounders::Oracle(order.noise.clone().unwrap_or_else(NoisePreset::none));
    let variants = variants(order.is_quick);
    let clips = Preset::Robust.clip_settings(order.views, 0);
    let samples = folder.join("samples");
    let measurement = Measurement {
        grounders: &grounders,
        rasterizer: order.rasterizer,
        variants: &variants,
        queries: order.queries,
        samples: &samples,
    };
    let mut sums: Vec<Sums> =
        variants.iter().flat_map(|variant| variant.rows()).map(|_| Sums::default()).collect();
    progress.start("lifting", (exam.scenes.len() * order.queries * variants.len()) as u64);
    for scene in &exam.scenes {
        progress.item(&scene.name);
        let draws = (order.rasterizer, order.adapter.clone());
        let judged = JudgedScene::open(exam, scene, order.space, &clips, draws)?;
        measurement.add_scene(&judged, &mut sums, &|| progress.advance(1))?;
    }
    progress.finish();
    let named = variants.iter().flat_map(Variant::rows);
    let rows: Vec<Row> =
        named.zip(&sums).filter_map(|((series, name), sums)| Row::new(series, name, sums)).collect();
    let queries = rows.iter().map(|row| row.queries).max().unwrap_or_default();
    let names: Vec<&str> = exam.scenes.iter().map(|scene| scene.name.as_str()).collect();
    let about = format!(
        "{queries} {} of {} at profile {}, {} views; the oracle {}",
        if queries == 1 { "query" } else { "queries" },
        names.join(", "),
        exam.profile,
        order.views,
        if is_exact { "makes no errors" } else { "errs as it was told" }
    );
    write_atomic(&folder.join("lift.csv"), &csv_of(&rows)?)?;
    if samples.exists() {
        std::fs::remove_dir_all(&samples).map_err(|error| DataError::io(&samples, "remove", error))?;
    }
    Ok(Benched { about, rows })
}
