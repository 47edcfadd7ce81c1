//! Rows, and how they reach people: CSV, text, a figure.

use anyhow::Result;
use l4d_board::{TradePoint, Tradeoff};
use serde::Serialize;

use super::measure::{CLIP_VIEWS, Measured};
use super::stage::Stage;
use super::variants::{BASE, Backends, Variant};

/// From here on no difference is visible, dB.
const INVISIBLE_DB: f64 = 60.0;

/// One way of drawing. Fields that end in `_ms` are times; everything else is the same in every run on a backend.
#[derive(Debug, Clone, Serialize)]
pub(super) struct Row {
    sweep: String,
    setting: String,
    gaussians: usize,
    dynamic: usize,
    sh_degree: u8,
    alpha_min: f32,
    transmittance_min: f32,
    still_below_m: f32,
    width: u32,
    height: u32,
    stored: String,
    megabytes: f64,
    rasterizer: String,
    pictures: usize,
    psnr_db: Option<f64>,
    reference_psnr_db: f64,
    error_max: f64,
    error_mean: f64,
    depth_error_mean_m: Option<f64>,
    deform_ms: f64,
    draw_ms: f64,
    picture_ms: f64,
}

impl Row {
    pub(super) fn new(variant: &Variant, backends: &Backends, measured: &Measured) -> Self {
        let rounded = |value: f64, digits: i32| (value * 10_f64.powi(digits)).round() / 10_f64.powi(digits);
        Self {
            sweep: variant.sweep.to_owned(),
            setting: variant.setting.clone(),
            gaussians: variant.model.gaussians.len(),
            dynamic: variant.model.dynamic.len(),
            sh_degree: variant.model.gaussians.sh_degree.get(),
            alpha_min: variant.settings.alpha_min,
            transmittance_min: variant.settings.transmittance_min,
            still_below_m: variant.still_below_m,
            width: variant.size[0],
            height: variant.size[1],
            stored: variant.stored.to_owned(),
            megabytes: rounded(variant.bytes as f64 * 1e-6, 3),
            rasterizer: backends.name(variant.backend),
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
    fn gain_db(&self) -> f64 {
        self.psnr_db.unwrap_or(self.reference_psnr_db.min(INVISIBLE_DB))
    }
}

pub(super) fn csv_of(rows: &[Row]) -> Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    rows.iter().try_for_each(|row| writer.serialize(row))?;
    Ok(writer.into_inner()?)
}

/// The table for a terminal.
pub(super) fn text(rows: &[Row]) -> String {
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

pub(super) fn figure(stage: &Stage, rows: &[Row]) -> Tradeoff {
    let points = rows.iter().map(|row| TradePoint {
        series: row.sweep.clone(),
        label: row.setting.clone(),
        cost: row.picture_ms.max(1e-3),
        gain: row.gain_db(),
        is_base: row.setting == BASE,
    });
    let gain = if stage.seen.is_some() {
        "PSNR of the held-out view, dB".to_owned()
    } else {
        format!("PSNR against the unreduced model in f64, dB; {INVISIBLE_DB} stands for more")
    };
    let backend = rows.first().map_or("", |row| row.rasterizer.as_str());
    Tradeoff {
        name: "splats",
        title: "Drawing a model: speed against error".to_owned(),
        notes: vec![
            format!("Of {}.", stage.about),
            format!("{backend}."),
            format!(
                "A picture is colour, alpha and depths, with its share of a state that {CLIP_VIEWS} views share. Ring: the model as it is. Grey: what nothing beats."
            ),
        ],
        cost: "milliseconds a picture".to_owned(),
        gain,
        points: points.collect(),
    }
}
