//! What moves and is not where the pictures show it: things that came into view, or that could not be followed.

use rayon::prelude::*;

use crate::model::Model;
use crate::raster::{RasterSettings, Rasterizer};

use super::TrainError;
use super::depth::depths_at;
use super::motion::{Motion, tolerance};
use super::points::{Point, moving_points, thinned};
use super::views::TrainingViews;

/// Moments that are looked at.
const MOMENTS: usize = 9;
/// Depths farther apart than so many tolerances are those of different things.
const APART: f32 = 6.0;
/// Less alpha than this is a hole.
const FILLED: f32 = 0.6;
/// Where depth was not measured, a larger difference of colour is a hole, display units.
const OTHER_COLOUR: f32 = 0.15;

/// At most `count` points where the model lacks something that moves.
pub(super) fn missing_points(
    model: &Model,
    rasterizer: &dyn Rasterizer,
    views: &TrainingViews,
    motion: &Motion,
    count: usize,
) -> Result<Vec<Point>, TrainError> {
    let settings = RasterSettings { quantiles: false, ..RasterSettings::default() };
    let last = views.moments() - 1;
    let mut moments: Vec<usize> = (0..MOMENTS).map(|index| index * last / (MOMENTS - 1)).collect();
    moments.dedup();
    let mut points = Vec::new();
    for moment in moments {
        let splats = model.at(views.time(moment))?;
        let lacking: Vec<Vec<bool>> = views
            .cameras()
            .par_iter()
            .enumerate()
            .map(|(index, camera)| {
                if !camera.has_picture(moment) {
                    return Ok(Vec::new());
                }
                let picture = camera.picture(moment);
                let drawing = rasterizer.prepare(&splats, camera.view(moment), &settings)?.draw()?;
                let depth_m = drawing.depth_expected_m();
                let is_other = |pixel: usize| match picture.depth_m.get(pixel) {
                    Some(seen_m) => {
                        let seen_m = seen_m.to_f32();
                        (depth_m[pixel] - seen_m).abs() > APART * tolerance(seen_m)
                    }
                    None => std::iter::zip(drawing.colour[pixel], picture.colour_of(pixel))
                        .any(|(drawn, seen)| (drawn - seen).abs() > OTHER_COLOUR),
                };
                let lacks = |pixel: usize| {
                    motion.moves(views, index, moment, pixel)
                        && (drawing.alpha[pixel] < FILLED || is_other(pixel))
                };
                Ok((0..views.pixel_count()).map(lacks).collect())
            })
            .collect::<Result<_, TrainError>>()?;
        let wanted = |camera: usize, pixel| lacking[camera][pixel] && inside(&lacking[camera], pixel, views);
        points.extend(moving_points(views, moment, &depths_at(views, moment, wanted), wanted));
    }
    Ok(thinned(&points, count))
}

/// Whether the neighbours in the row and in the column lack something too: single pixels are edges.
fn inside(lacking: &[bool], pixel: usize, views: &TrainingViews) -> bool {
    let [width, height] = views.size().map(|side| side as usize);
    let (row, column) = (pixel / width, pixel % width);
    let beside = column > 0 && lacking[pixel - 1] && column + 1 < width && lacking[pixel + 1];
    let along = row > 0 && lacking[pixel - width] && row + 1 < height && lacking[pixel + width];
    beside && along
}
