//! Speed against error.

use std::path::{Path, PathBuf};

use anyhow::Result;
use l4d_board::{TradePoint, Tradeoff, publish_tradeoff};
use l4d_experiments::lift::{self, Benched};
use l4d_splat::speed::{CLIP_VIEWS, INVISIBLE_DB, Row, Speed};

use crate::out::Printer;

/// Seconds of a lift against mIoU.
pub(crate) fn publish_lift(
    benched: &Benched,
    rasterizer: &str,
    folder: &Path,
    _: &Printer,
) -> Result<Vec<PathBuf>> {
    let point = |row: &lift::Row| TradePoint {
        series: row.series.to_owned(),
        label: row.setting.clone(),
        cost: row.lift_seconds.max(1e-3),
        gain: row.miou,
        is_base: row.is_base(),
    };
    let figure = Tradeoff {
        name: "lift",
        title: "Lifting an answer: speed against error".to_owned(),
        notes: vec![
            format!("{}.", benched.about),
            format!("{rasterizer}."),
            "Evidence is what training views truly show: this measures lifting alone. Ring: the default. Grey: what nothing \
             beats."
                .to_owned(),
        ],
        cost: "seconds a lift".to_owned(),
        gain: "mIoU of the held-out view, percent".to_owned(),
        points: benched.rows.iter().map(point).collect(),
    };
    Ok(publish_tradeoff(&figure, folder)?)
}

/// Milliseconds of a picture against PSNR.
pub(crate) fn publish_splats(speed: &Speed, folder: &Path, _: &Printer) -> Result<Vec<PathBuf>> {
    let point = |row: &Row| TradePoint {
        series: row.sweep.clone(),
        label: row.setting.clone(),
        cost: row.picture_ms.max(1e-3),
        gain: row.gain_db(),
        is_base: row.is_base(),
    };
    let gain = match speed.has_held_out {
        true => "PSNR of the held-out view, dB".to_owned(),
        false => format!("PSNR against the unreduced model in f64, dB; {INVISIBLE_DB} means that or more"),
    };
    let rasterizer = speed.rows.first().map_or("", |row| row.rasterizer.as_str());
    let figure = Tradeoff {
        name: "splats",
        title: "Drawing a model: speed against error".to_owned(),
        notes: vec![
            format!("Of {}.", speed.about),
            format!("{rasterizer}."),
            format!(
                "A picture is colour, alpha and depths, with its share of a state that {CLIP_VIEWS} views share. Ring: the model as it is. Grey: what nothing beats."
            ),
        ],
        cost: "milliseconds a picture".to_owned(),
        gain,
        points: speed.rows.iter().map(point).collect(),
    };
    Ok(publish_tradeoff(&figure, folder)?)
}
