//! `l4d bench splats`: milliseconds against PSNR of ways to draw a model.

use anyhow::Result;
use l4d_data::Name;
use l4d_splat::speed::{Backend, SpeedRequest, measure_speed, text};
use serde_json::json;

use super::claim;
use crate::cli::splats::BenchSplatsArgs;
use crate::figures;
use crate::out::{ExitStatus, Printer};
use crate::rasterizer;

pub(crate) fn run(args: &BenchSplatsArgs, out: &Printer) -> Result<ExitStatus> {
    let adapters: Vec<Backend> =
        args.adapters.iter().map(|adapter| rasterizer::backend(adapter)).collect::<Result<_>>()?;
    let space = args.work.space(args.profile);
    let scene = args.scene.as_deref().map(Name::new).transpose()?;
    let folder = args.out.clone().unwrap_or_else(|| space.shared().bench("splats"));
    let request = SpeedRequest {
        scene: scene.as_ref(),
        space: &space,
        model: args.splats.clone(),
        gaussians: args.gaussians as usize,
        seed: args.seed,
        size: args.size.map(|size| size.0),
        sweeps: &args.sweeps,
        views: args.view_count as usize,
        times: args.times as usize,
        repeats: args.repeats,
        folder: &folder,
    };
    let _claim = claim(&folder, "splats", args.force)?;
    let speed = measure_speed(&request, adapters, out)?;
    let figures = figures::publish_splats(&speed, &folder, out)?;
    match args.json {
        true => out.json(&json!({ "about": speed.about, "rows": speed.rows }))?,
        false => out.data(text(&speed.rows))?,
    }
    for path in std::iter::once(&folder.join("splats.csv")).chain(&figures) {
        out.note(path.display());
    }
    Ok(ExitStatus::Success)
}
