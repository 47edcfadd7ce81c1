//! Clips: what a model shows cameras over time, as files and in memory (paper, section 4: Vid_v and Depth_v).
//!
//! Owns which views are looked from, the folder that keeps what was drawn, and the order of the work: a picture that
//! is there whole is not drawn again, and the model is deformed once a time for all views of it. Refuses to know
//! who trained the model and what is asked about it.

mod flight;
mod folder;
mod plan;
mod request;
mod writers;

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Mutex;

use half::f16;
use l4d_data::store::write_atomic;
use l4d_data::{At as _, DataError, StageError, Timeline};
use l4d_formats::npy;
use l4d_frames::drawn::{DepthMap, RgbImage};
use l4d_frames::moving_picture::Pages;
use l4d_frames::preview::{Cell, Page};
use l4d_ground::{ClipFrame, ViewClip};
use l4d_splat::clip::{TimeViews, draw};
use l4d_splat::language::Language;
use l4d_splat::model::Model;
use l4d_splat::raster::{Drawing, RasterSettings, Rasterizer};
use l4d_splat::source::Source;
use rayon::prelude::*;

pub use self::flight::Flight;
pub use self::folder::{ClipsFolder, DepthEntry, DepthFormat, DepthKind, Look, ModelEntry, Overwrite};
pub use self::plan::{DrawnTime, PictureIndex, Plan};
pub(crate) use self::plan::{instants_at, spread_views};
pub use self::request::{ClipsRequest, Wanted};
use self::writers::writing;

/// Draws what of a plan the folder lacks, and writes the manifest. `drawn` hears of each picture; gives how many
/// pictures stood there before.
///
/// # Errors
/// A model without a state at one of the times, a rasterizer that fails, a disk that refuses.
pub fn complete(
    folder: &ClipsFolder,
    plan: &Plan,
    model: &Model,
    rasterizer: &dyn Rasterizer,
    drawn: &(dyn Fn() + Sync),
) -> Result<usize, StageError> {
    let finished = folder.finished(plan);
    let there = finished.len();
    // By time: the model is deformed once for all views of it.
    let moment = |instant: usize| -> Result<TimeViews<PictureIndex>, StageError> {
        let pictures = (0..plan.cameras.len()).map(|view| PictureIndex { view, instant });
        let left = pictures.filter(|index| !finished.contains_key(index));
        let views = left.map(|index| Ok((index, plan.view(index)?))).collect::<Result<_, StageError>>()?;
        Ok(TimeViews { time: plan.instants[instant].time, views })
    };
    let moments = (0..plan.instants.len()).map(moment).collect::<Result<Vec<_>, _>>()?;
    let look = folder.look();
    let settings = RasterSettings {
        background: look.background,
        near_m: look.model.near_m,
        ..RasterSettings::default()
    };
    let entries = Mutex::new(finished);
    let written = |index, entry| {
        if let Ok(mut entries) = entries.lock() {
            entries.insert(index, entry);
        }
        drawn();
    };
    writing(written, |hand_over| {
        draw(model, rasterizer, &settings, &moments, |index: &PictureIndex, drawing| {
            hand_over(folder.sheet(plan, *index, &drawing.colour, &depth_of(look.depth.kind, &drawing))?)
        })
        .at("a clip cannot be drawn")
    })?;
    let entries: BTreeMap<_, _> = entries.into_inner().unwrap_or_default();
    folder.settle(plan, entries)?;
    Ok(there)
}

/// Draws what the Gaussians of a model mean at all moments of a plan: `<folder>/<view>/<place of the moment>.npy`, rows of
/// pixels of latents.
///
/// # Errors
/// What drawing meets.
pub fn write_language(
    folder: &Path,
    plan: &Plan,
    (source, language): (&Source, &Language),
    rasterizer: &dyn Rasterizer,
) -> Result<(), StageError> {
    let plain = |error: &dyn std::error::Error| {
        StageError::of(error, "check that the model is whole: train or export it again")
    };
    let [width, height] = plan.size.map(|side| side as usize);
    let settings = RasterSettings { near_m: source.near_m, ..RasterSettings::default() };
    let model = &source.model;
    for (place, instant) in plan.instants.iter().enumerate() {
        let time = model.own_time(instant.time).map_err(|error| plain(&error))?;
        let splats = model.at(instant.time).map_err(|error| plain(&error))?;
        let latents = language.at(&model.gaussians.means, time).map_err(|error| plain(&error))?;
        for (index, camera) in plan.cameras.iter().enumerate() {
            let view = plan.view(PictureIndex { view: index, instant: place })?;
            let projected = rasterizer.prepare(&splats, &view, &settings);
            let values = projected.and_then(|projected| projected.splat_features(&latents, language.width));
            let values = values.map_err(|error| plain(&error))?;
            let bytes = npy::encode_f32(&[height, width, language.width], &values);
            write_atomic(&folder.join(camera.name.as_str()).join(format!("{place:05}.npy")), &bytes)?;
        }
    }
    Ok(())
}

/// What a drawing says of depth.
fn depth_of(kind: DepthKind, drawing: &Drawing) -> DepthMap {
    let half = |values: &[f32]| values.iter().map(|&value| f16::from_f32(value)).collect();
    let empty = DepthMap::empty(drawing.width, drawing.height);
    let (near_m, median_m, far_m) = match &drawing.quantiles {
        Some(quantiles) => (half(&quantiles.near_m), quantiles.median_m.clone(), half(&quantiles.far_m)),
        None => (empty.near_m, empty.depth_m, empty.far_m),
    };
    let depth_m = match kind {
        DepthKind::Median => median_m,
        DepthKind::Expected => drawing.depth_expected_m(),
        DepthKind::Sum => drawing.depth_sum_m.clone(),
    };
    let (width, height) = (drawing.width, drawing.height);
    DepthMap { width, height, depth_m, alpha: half(&drawing.alpha), near_m, far_m }
}

/// What a grounder is shown: all views of a plan whose pictures are in the folder, in the order of its cameras. Times
/// between frames are left out: a sentence is asked about frames.
pub(crate) fn read_views(
    folder: &ClipsFolder,
    plan: &Plan,
    timeline: Timeline,
) -> Result<Vec<ViewClip>, DataError> {
    let frames: Vec<(usize, u32)> =
        plan.instants.iter().enumerate().filter_map(|(at, instant)| Some((at, instant.frame?))).collect();
    let read = |view: usize| {
        let frame = |&(instant, frame): &(usize, u32)| {
            let (colour, depth) = folder.read(plan, PictureIndex { view, instant })?;
            Ok(ClipFrame { frame, colour, depth })
        };
        let frames = frames.par_iter().map(frame).collect::<Result<_, DataError>>()?;
        let [width, height] = plan.size;
        Ok(ViewClip { camera: plan.drawn_camera(view), width, height, timeline, frames })
    };
    (0..plan.cameras.len()).map(read).collect()
}

/// Pages of a moving picture: all views of a clip side by side, colour above depth.
pub struct Preview<'a> {
    folder: &'a ClipsFolder,
    plan: &'a Plan,
    page: Page,
}

impl<'a> Preview<'a> {
    /// Pages of about this width, with greys for the depths of the first moment.
    ///
    /// # Errors
    /// A picture that cannot be read.
    pub fn new(folder: &'a ClipsFolder, plan: &'a Plan, widest_px: u32) -> Result<Self, DataError> {
        let names = plan.cameras.iter().map(|camera| camera.name.to_string()).collect();
        let depths: Vec<f32> = cells(folder, plan, 0)?.into_iter().flat_map(|cell| cell.depth_m).collect();
        Ok(Self { folder, plan, page: Page::new(names, plan.size.into(), widest_px, depths) })
    }
}

impl Pages for Preview<'_> {
    fn size_px(&self) -> (u32, u32) {
        self.page.size_px()
    }

    fn page(&self, index: usize) -> Result<RgbImage, StageError> {
        Ok(self.page.draw(&cells(self.folder, self.plan, index)?))
    }
}

fn cells(folder: &ClipsFolder, plan: &Plan, instant: usize) -> Result<Vec<Cell>, DataError> {
    let cell = |view: usize| {
        let (colour, depth) = folder.read(plan, PictureIndex { view, instant })?;
        Ok(Cell { colour, depth_m: depth.depth_m })
    };
    (0..plan.cameras.len()).map(cell).collect()
}
