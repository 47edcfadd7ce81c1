//! Rows, and how they reach people: CSV, text, a figure.

use serde::Serialize;

use super::measure::{CLIP_VIEWS, Measured};
use super::variants::{BASE, Variant};
use super::{Result, plain};
use crate::reduce::stored_bytes;

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

    pub(super) fn new(variant: &Variant<'_>, measured: &Measured) -> Self {
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

pub(super) fn csv_of(rows: &[Row]) -> Result<Vec<u8>> {
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
