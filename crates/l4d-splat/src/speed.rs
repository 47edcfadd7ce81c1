//! What makes drawing a model faster, and what that costs (`l4d bench splats`).
//!
//! Everything is measured on the same pictures in one run: times as medians, errors against the unreduced model drawn
//! in f64, and against pictures of the held-out view where there are some.

mod measure;
mod subject;
mod variants;

use std::error::Error;
use std::path::{Path, PathBuf};

use l4d_data::store::write_atomic;
use l4d_data::{Name, Progress, StageError, Workspace};
use serde::Serialize;

pub use self::measure::CLIP_VIEWS;
use self::measure::{Measured, Truth, measure};
use self::subject::Subject;
use self::variants::{BASE, Variant, backends, stored_bytes, variants};
pub use self::variants::{Backend, Sweep};

type Result<T, E = StageError> = std::result::Result<T, E>;

fn plain(error: impl Error) -> StageError {
    StageError::of(&error, "train the scene again, or measure without it")
}

/// What is drawn, and by what.
pub struct SpeedRequest<'a> {
    /// A trained scene; none for a made-up room.
    pub scene: Option<&'a Name>,
    /// Profile and folders.
    pub space: &'a Workspace,
    /// The model, if not the one among the work.
    pub model: Option<PathBuf>,
    /// Gaussians of the made-up room.
    pub gaussians: usize,
    /// Of the made-up room.
    pub seed: u64,
    /// Width and height of its pictures; none for the usual ones.
    pub size: Option<[u32; 2]>,
    /// What is changed; empty for everything.
    pub sweeps: &'a [Sweep],
    /// Views, the held-out one among them.
    pub views: usize,
    /// Times, evenly spaced.
    pub times: usize,
    /// Timed passes over all pictures.
    pub repeats: u32,
    /// Receives `splats.csv`.
    pub folder: &'a Path,
}

/// What was measured.
#[derive(Debug)]
pub struct Speed {
    /// One line about what was drawn.
    pub about: String,
    /// One row per way of drawing, the model as it is first.
    pub rows: Vec<Row>,
    /// Whether there are pictures of a held-out view.
    pub has_held_out: bool,
}

/// Measures ways of drawing a model, on the processor and on these adapters.
///
/// # Errors
/// A scene or model that cannot be read or drawn.
pub fn measure_speed(
    request: &SpeedRequest<'_>,
    adapters: Vec<Backend>,
    progress: &dyn Progress,
) -> Result<Speed> {
    let backends = backends(adapters)?;
    let subject = Subject::open(request)?;
    let variants = variants(&subject, request.sweeps, &backends)?;
    progress.note(&format_args!("{}: {} variants", subject.about, variants.len()));
    let truth = Truth::draw(&subject)?;
    progress.start("measuring", variants.len() as u64 * (u64::from(request.repeats) + 1));
    let advance = || progress.advance(1);
    let measured = measure(&subject, &truth, &variants, request.repeats, &advance)?;
    progress.finish();
    let rows: Vec<Row> =
        variants.iter().zip(&measured).map(|(variant, measured)| Row::new(variant, measured)).collect();
    write_atomic(&request.folder.join("splats.csv"), &csv_of(&rows)?)?;
    Ok(Speed { about: subject.about, rows, has_held_out: subject.seen.is_some() })
}

/// From here on no difference is visible, dB.
pub const INVISIBLE_DB: f64 = 60.0;

/// One way of drawing. Fields that end in `_ms` are times; everything else is the same in every run on a backend.
#[derive(Debug, Clone, Serialize)]
#[expect(missing_docs, reason = "columns of splats.csv, named as they are read")]
pub struct Row {
    pub sweep: String,
    pub setting: String,
    pub gaussians: usize,
    pub dynamic: usize,
    pub sh_degree: u8,
    pub width: u32,
    pub height: u32,
    pub megabytes: f64,
    pub rasterizer: String,
    pub pictures: usize,
    pub psnr_db: Option<f64>,
    pub reference_psnr_db: f64,
    pub error_max: f64,
    pub error_mean: f64,
    pub depth_error_mean_m: Option<f64>,
    pub deform_ms: f64,
    pub draw_ms: f64,
    pub picture_ms: f64,
}

impl Row {
    /// Whether it is the model as it is.
    pub fn is_base(&self) -> bool {
        self.setting == BASE
    }

    fn new(variant: &Variant<'_>, measured: &Measured) -> Self {
        let rounded = |value: f64, digits: i32| (value * 10_f64.powi(digits)).round() / 10_f64.powi(digits);
        Self {
            sweep: variant.sweep.to_owned(),
            setting: variant.setting.clone(),
            gaussians: variant.model.gaussians.len(),
            dynamic: variant.model.dynamic.len(),
            sh_degree: variant.model.gaussians.sh_degree.get(),
            width: variant.size[0],
            height: variant.size[1],
            megabytes: rounded(stored_bytes(&variant.model) as f64 * 1e-6, 3),
            rasterizer: variant.backend.name.clone(),
            pictures: measured.pictures,
            psnr_db: measured.psnr_db.map(|value| rounded(value, 3)),
            reference_psnr_db: rounded(measured.reference_psnr_db, 3),
            error_max: rounded(measured.error_max, 7),
            error_mean: rounded(measured.error_mean, 9),
            depth_error_mean_m: measured.depth_error_mean_m.map(|value| rounded(value, 7)),
            deform_ms: rounded(measured.deform_ms, 4),
            draw_ms: rounded(measured.draw_ms, 4),
            picture_ms: rounded(measured.draw_ms + measured.deform_ms / CLIP_VIEWS, 4),
        }
    }

    /// What the figure shows: how close it comes to held-out pictures, or else to the unreduced model.
    pub fn gain_db(&self) -> f64 {
        self.psnr_db.unwrap_or(self.reference_psnr_db.min(INVISIBLE_DB))
    }
}

fn csv_of(rows: &[Row]) -> Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    rows.iter().try_for_each(|row| writer.serialize(row)).map_err(plain)?;
    writer.into_inner().map_err(|error| plain(error.into_error()))
}

/// The table for a terminal.
pub fn text(rows: &[Row]) -> String {
    let mut lines = vec![format!(
        "{:<39}{:>10}{:>9}{:>9}{:>9}{:>9}{:>10}{:>11}{:>10}",
        "setting", "gaussians", "dynamic", "MB", "deform", "draw", "PSNR, dB", "max error", "mean"
    )];
    for row in rows {
        let psnr = row.psnr_db.map_or_else(|| "-".to_owned(), |value| format!("{value:.2}"));
        lines.push(format!(
            "{:<39}{:>10}{:>9}{:>9.2}{:>6.2} ms{:>6.2} ms{psnr:>10}{:>11.1e}{:>10.1e}",
            row.setting,
            row.gaussians,
            row.dynamic,
            row.megabytes,
            row.deform_ms,
            row.draw_ms,
            row.error_max,
            row.error_mean
        ));
    }
    lines.join("\n")
}
