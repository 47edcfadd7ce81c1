//! Clips: what a model shows cameras over time, as files and in memory (paper, section 4: Vid_v and Depth_v).
//!
//! Owns which views are looked from, the folder that keeps what was drawn, and the order of the work: a picture that
//! is there whole is not drawn again, and the model is deformed once a time for all views of it. Refuses to know
//! who trained the model and what is asked about it.

mod choose;
mod folder;
mod order;
mod plan;
mod preview;
mod view_clip;
mod writers;

use std::collections::BTreeMap;
use std::sync::Mutex;

use half::f16;
use l4d_data::{DataError, StageError};
use l4d_frames::drawn::DepthMap;
use l4d_splat::clip::{ClipError, Moment, draw};
use l4d_splat::model::Model;
use l4d_splat::raster::{Drawing, RasterSettings, Rasterizer};
use l4d_splat::view::ViewError;

pub use self::choose::spread_views;
pub use self::folder::{ClipsFolder, DepthEntry, DepthFormat, DepthKind, Look, ModelEntry, Overwrite};
pub use self::order::{Order, Wanted};
pub use self::plan::{Instant, Plan, Shot};
pub use self::preview::Preview;
pub use self::view_clip::read_views;
use self::writers::writing;

/// Why there are no clips.
#[derive(Debug, thiserror::Error)]
pub enum ClipsError {
    /// A file.
    #[error(transparent)]
    Data(#[from] DataError),
    /// The model or the rasterizer.
    #[error("a clip cannot be drawn")]
    Draw(#[from] ClipError),
    /// Nothing more is drawn, since a file could not be written; that error is reported instead of this one.
    #[error("a file could not be written")]
    Stopped,
    /// A camera from which no picture can be drawn.
    #[error("camera {camera}")]
    View {
        /// Its name.
        camera: String,
        /// What is wrong.
        source: ViewError,
    },
}

impl From<ClipsError> for StageError {
    fn from(error: ClipsError) -> Self {
        let hint = error.hint();
        Self::of(&error, hint)
    }
}

impl ClipsError {
    /// What the user can do, where more can be said than the message does.
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::Data(error) => error.hint(),
            Self::Draw(_) | Self::Stopped | Self::View { .. } => None,
        }
    }
}

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
) -> Result<usize, ClipsError> {
    let finished = folder.finished(plan);
    let there = finished.len();
    let moments = left_to_draw(plan, |shot| finished.contains_key(&shot))?;
    let settings = RasterSettings { background: folder.look().background, ..RasterSettings::default() };
    let kind = folder.look().depth.kind;
    let entries = Mutex::new(finished);
    let written = |shot, entry| {
        if let Ok(mut entries) = entries.lock() {
            entries.insert(shot, entry);
        }
        drawn();
    };
    writing(written, |hand_over| {
        draw(model, rasterizer, &settings, &moments, |shot: &Shot, drawing| {
            hand_over(folder.sheet(plan, *shot, &drawing.colour, &depth_of(kind, &drawing))?)
        })
    })?;
    let entries: BTreeMap<_, _> = entries.into_inner().unwrap_or_default();
    folder.settle(plan, entries)?;
    Ok(there)
}

/// The pictures that are not there yet, by time: the model is deformed once for all views of a time.
fn left_to_draw(plan: &Plan, is_finished: impl Fn(Shot) -> bool) -> Result<Vec<Moment<Shot>>, ClipsError> {
    let moment = |(instant, at): (usize, &Instant)| -> Result<Moment<Shot>, ClipsError> {
        let shots = (0..plan.cameras.len()).map(|view| Shot { view, instant });
        let left = shots.filter(|shot| !is_finished(*shot));
        let views = left.map(|shot| Ok((shot, plan.view(shot)?))).collect::<Result<_, ClipsError>>()?;
        Ok(Moment { time: at.time, views })
    };
    plan.instants.iter().enumerate().map(moment).collect()
}

/// What a drawing says of depth.
pub fn depth_of(kind: DepthKind, drawing: &Drawing) -> DepthMap {
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
