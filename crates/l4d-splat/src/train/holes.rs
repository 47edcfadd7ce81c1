//! What moves and is not where the pictures show it: things that came into view, or that could not be followed.

use rayon::prelude::*;

use crate::model::Model;
use crate::raster::{RasterSettings, Rasterizer};

use super::TrainError;
use super::footage::Footage;
use super::motion::{Motion, tolerance};
use super::points::{Point, of_movers, thinned};

/// Moments that are looked at.
const MOMENTS: usize = 9;
/// Depths farther apart than so many tolerances are those of different things.
const APART: f32 = 6.0;
/// Less alpha than this is a hole.
const FILLED: f32 = 0.6;

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
                let drawing = rasterizer.prepare(&splats, shot.view(moment), &settings)?.draw()?;
                let depth_m = drawing.depth_expected_m();
                let lacks = |pixel: usize| {
                    let seen_m = shot.picture(moment).depth_m[pixel].to_f32();
                    motion.moves(footage, index, moment, pixel)
                        && (drawing.alpha[pixel] < FILLED
                            || (depth_m[pixel] - seen_m).abs() > APART * tolerance(seen_m))
                };
                Ok((0..footage.pixel_count()).map(lacks).collect())
            })
            .collect::<Result<_, TrainError>>()?;
        points.extend(of_movers(footage, moment, |shot, pixel| {
            lacking[shot][pixel] && inside(&lacking[shot], pixel, footage)
        }));
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
