//! What moves and is not where the pictures show it: things that came into view, or that could not be followed.

use rayon::prelude::*;

use crate::model::Model;
use crate::raster::{RasterSettings, Rasterizer};

use super::TrainError;
use super::footage::Footage;
use super::motion::{Motion, tolerance};
use super::points::{Point, of_movers, thinned};
use super::sight::depths_at;

/// Moments that are looked at.
const MOMENTS: usize = 9;
/// Depths farther apart than so many tolerances are those of different things.
const APART: f32 = 6.0;
/// Less alpha than this is a hole.
const FILLED: f32 = 0.6;
/// Where depth was not measured, a larger difference of colour is a hole, display units.
const OTHER_COLOUR: f32 = 0.15;

/// At most `count` points where the model lacks something that moves.
pub(super) fn holes(
    model: &Model,
    rasterizer: &dyn Rasterizer,
    footage: &Footage,
    motion: &Motion,
    count: usize,
) -> Result<Vec<Point>, TrainError> {
    let settings = RasterSettings { quantiles: false, ..RasterSettings::default() };
    let last = footage.moments() - 1;
    let mut moments: Vec<usize> = (0..MOMENTS).map(|index| index * last / (MOMENTS - 1)).collect();
    moments.dedup();
    let mut points = Vec::new();
    for moment in moments {
        let splats = model.at(footage.time(moment))?;
        let lacking: Vec<Vec<bool>> = footage
            .shots()
            .par_iter()
            .enumerate()
            .map(|(index, shot)| {
                if !shot.saw(moment) {
                    return Ok(Vec::new());
                }
                let picture = shot.picture(moment);
                let drawing = rasterizer.prepare(&splats, shot.view(moment), &settings)?.draw()?;
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
                    motion.moves(footage, index, moment, pixel)
                        && (drawing.alpha[pixel] < FILLED || is_other(pixel))
                };
                Ok((0..footage.pixel_count()).map(lacks).collect())
            })
            .collect::<Result<_, TrainError>>()?;
        let wanted = |shot: usize, pixel| lacking[shot][pixel] && inside(&lacking[shot], pixel, footage);
        points.extend(of_movers(footage, moment, &depths_at(footage, moment, wanted), wanted));
    }
    Ok(thinned(&points, count))
}

/// Whether the neighbours in the row and in the column lack something too: single pixels are edges.
fn inside(lacking: &[bool], pixel: usize, footage: &Footage) -> bool {
    let [width, height] = footage.size().map(|side| side as usize);
    let (row, column) = (pixel / width, pixel % width);
    let beside = column > 0 && lacking[pixel - 1] && column + 1 < width && lacking[pixel + 1];
    let along = row > 0 && lacking[pixel - width] && row + 1 < height && lacking[pixel + width];
    beside && along
}
