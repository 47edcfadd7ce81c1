//! `l4d render-splats`: clips of colour and depth of a model, from any cameras at any times.

mod folder;
mod plan;
mod preview;
mod writers;

use std::sync::Mutex;
use std::time::Instant;

use anyhow::Result;
use half::f16;
use l4d_frames::drawn::DepthMap;
use l4d_splat::clip::{Moment, draw};
use l4d_splat::raster::{Drawing, RasterSettings};
use l4d_splat::source::Source;

use self::folder::{ClipsFolder, DepthEntry, FrameEntry, Look, ModelEntry};
use self::plan::{Plan, Shot};
use self::writers::writing;
use crate::cli::{DepthArg, RenderSplatsArgs};
use crate::out::{ExitStatus, Printer};
use crate::rasterizer;

pub(crate) fn run(args: &RenderSplatsArgs, out: &Printer) -> Result<ExitStatus> {
    let plan = Plan::of(args)?;
    let source = Source::open(&plan.model)?;
    source.notes.iter().for_each(|note| out.note(format!("{}: {note}", plan.model.display())));
    let opened = rasterizer::open(&args.adapter.adapter)?;
    let background = args.background.map(|colour| colour.0).or(source.background).unwrap_or_default();
    let settings = RasterSettings { background, ..RasterSettings::default() };
    let look = Look {
        model: ModelEntry {
            family: source.family.to_string(),
            scene: source.scene.clone(),
            gaussians: source.model.gaussians.len(),
            dynamic: source.model.dynamic.len(),
            inputs: source.inputs.clone(),
        },
        rasterizer: opened.rasterizer.name(),
        adapter: opened.adapter.map(serde_json::to_value).transpose()?,
        width: plan.size[0],
        height: plan.size[1],
        background,
        depth: DepthEntry::new(args.depth, args.depth_format),
    };
    let folder = ClipsFolder::claim(plan.out.clone(), look, &plan, args.overwrite)?;
    let finished = folder.finished(&plan);
    let moments = left_to_draw(&plan, |shot| finished.contains_key(&shot))?;
    let entries = Mutex::new(finished);
    let (there, total) = (entries.lock().map_or(0, |entries| entries.len()), plan.shot_count());

    let bar = out.bar((total - there) as u64, "drawing");
    let start = Instant::now();
    let written = |shot: Shot, entry: FrameEntry| {
        if let Ok(mut entries) = entries.lock() {
            entries.insert(shot, entry);
        }
        bar.inc(1);
    };
    writing(written, |hand_over| {
        draw(&source.model, opened.rasterizer.as_ref(), &settings, &moments, |shot: &Shot, drawing| {
            hand_over(folder.sheet(&plan, *shot, &drawing.colour, &depth_of(args.depth, &drawing))?)
        })
    })?;
    bar.finish_and_clear();
    let seconds = start.elapsed().as_secs_f64();

    let entries = entries.into_inner().unwrap_or_default();
    let manifest = folder.settle(&plan, entries)?;
    out.note(format!(
        "{} pictures ({} views, {} times) in {seconds:.1} s, {there} more were there",
        total - there,
        plan.cameras.len(),
        plan.instants.len(),
    ));
    out.data(manifest.display())?;
    if args.preview {
        out.data(preview::write(&folder, &plan, out)?.display())?;
    }
    Ok(ExitStatus::Success)
}

/// The pictures that are not there yet, by time: the model is deformed once for all views of a time.
fn left_to_draw(plan: &Plan, is_finished: impl Fn(Shot) -> bool) -> Result<Vec<Moment<Shot>>> {
    let moment = |(instant, at): (usize, &plan::Instant)| -> Result<Moment<Shot>> {
        let shots = (0..plan.cameras.len()).map(|view| Shot { view, instant });
        let left = shots.filter(|shot| !is_finished(*shot));
        let views = left.map(|shot| Ok((shot, plan.view(shot)?))).collect::<Result<_>>()?;
        Ok(Moment { time: at.time, views })
    };
    plan.instants.iter().enumerate().map(moment).collect()
}

fn depth_of(kind: DepthArg, drawing: &Drawing) -> DepthMap {
    let half = |values: &[f32]| values.iter().map(|&value| f16::from_f32(value)).collect();
    let empty = DepthMap::empty(drawing.width, drawing.height);
    let (near_m, median_m, far_m) = match &drawing.quantiles {
        Some(quantiles) => (half(&quantiles.near_m), quantiles.median_m.clone(), half(&quantiles.far_m)),
        None => (empty.near_m, empty.depth_m, empty.far_m),
    };
    let depth_m = match kind {
        DepthArg::Median => median_m,
        DepthArg::Expected => drawing.depth_expected_m(),
        DepthArg::Sum => drawing.depth_sum_m.clone(),
    };
    let (width, height) = (drawing.width, drawing.height);
    DepthMap { width, height, depth_m, alpha: half(&drawing.alpha), near_m, far_m }
}
