//! How close a model comes to pictures.

use rayon::prelude::*;
use serde::Serialize;

use crate::model::Model;
use crate::raster::{RasterSettings, Rasterizer};

use super::TrainError;
use super::ssim::ssim;
use super::views::TrainingViews;

/// What of a picture is looked at more closely, row-major.
#[derive(Debug, Clone, Default)]
pub(crate) struct Region {
    /// Pixels that show something that moves.
    pub(crate) moving: Vec<bool>,
    /// Pixels in which depth counts.
    pub(crate) depth: Vec<bool>,
    /// Whether structure is compared as well, which takes longer than drawing the picture.
    pub(crate) structure: bool,
}

/// Errors over a set of pictures.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub(crate) struct Quality {
    pub(crate) pictures: usize,
    /// Mean over pictures of the peak signal-to-noise ratio of display colour, dB.
    pub(crate) psnr_db: f64,
    /// Mean over pictures of their structural similarity; none where it was not asked for, or for pictures of fewer than 11
    /// pixels a side.
    pub(crate) ssim: Option<f64>,
    /// The ratio over all moving pixels of all pictures; none if nothing moves.
    pub(crate) psnr_moving_db: Option<f64>,
    /// Median over all pixels in which depth counts of the absolute error of the median depth, metres; a pixel that
    /// shows nothing is infinitely wrong. None if there are no such pixels, or if most show nothing.
    pub(crate) depth_error_m: Option<f64>,
}

struct Errors {
    psnr_db: f64,
    ssim: Option<f64>,
    moving: (f64, usize),
    depth_m: Vec<f32>,
}

/// Draws the pictures `(camera, moment)` of `picks`, except those that were not taken, and compares.
pub(crate) fn measure(
    model: &Model,
    rasterizer: &dyn Rasterizer,
    views: &TrainingViews,
    picks: &[(usize, usize)],
    region: &(dyn Fn(usize, usize) -> Region + Sync),
) -> Result<Quality, TrainError> {
    let picks: Vec<(usize, usize)> = picks
        .iter()
        .copied()
        .filter(|&(camera, moment)| views.cameras()[camera].has_picture(moment))
        .collect();
    let mut moments: Vec<usize> = picks.iter().map(|&(_, moment)| moment).collect();
    moments.sort_unstable();
    moments.dedup();
    let errors: Vec<Vec<Errors>> = moments
        .par_iter()
        .map(|&moment| {
            let splats = model.at(views.time(moment))?;
            let cameras = picks.iter().filter(|&&(_, at)| at == moment).map(|&(camera, _)| camera);
            cameras
                .map(|camera| {
                    let view = views.cameras()[camera].view(moment);
                    let drawing = rasterizer.prepare(&splats, view, &RasterSettings::default())?.draw()?;
                    let median_m = drawing.quantiles.map(|quantiles| quantiles.median_m).unwrap_or_default();
                    Ok(compare(&drawing.colour, &median_m, views, (camera, moment), &region(camera, moment)))
                })
                .collect::<Result<Vec<_>, TrainError>>()
        })
        .collect::<Result<_, _>>()?;
    let errors: Vec<Errors> = errors.into_iter().flatten().collect();
    let squares: f64 = errors.iter().map(|errors| errors.moving.0).sum();
    let count: usize = errors.iter().map(|errors| errors.moving.1).sum();
    let mut depth_m: Vec<f32> = errors.iter().flat_map(|errors| errors.depth_m.iter().copied()).collect();
    let middle = depth_m.len() / 2;
    let median_m = (!depth_m.is_empty()).then(|| *depth_m.select_nth_unstable_by(middle, f32::total_cmp).1);
    let mean = |sum: f64| sum / errors.len().max(1) as f64;
    let ssim: Option<f64> = errors.iter().map(|errors| errors.ssim).sum();
    Ok(Quality {
        pictures: errors.len(),
        psnr_db: mean(errors.iter().map(|errors| errors.psnr_db).sum()),
        ssim: ssim.filter(|_| !errors.is_empty()).map(mean),
        psnr_moving_db: (count > 0).then(|| decibels(squares / count as f64)),
        depth_error_m: median_m.filter(|error_m| error_m.is_finite()).map(f64::from),
    })
}

fn compare(
    colour: &[[f32; 3]],
    median_m: &[f32],
    views: &TrainingViews,
    (camera, moment): (usize, usize),
    region: &Region,
) -> Errors {
    let picture = views.cameras()[camera].picture(moment);
    let drawn: Vec<[f32; 3]> =
        colour.iter().map(|colour| colour.map(|value| value.clamp(0.0, 1.0))).collect();
    let seen: Vec<[f32; 3]> = (0..colour.len()).map(|pixel| picture.colour_of(pixel)).collect();
    let (mut squares, mut moving) = (0.0, (0.0, 0));
    for (pixel, (drawn, seen)) in std::iter::zip(&drawn, &seen).enumerate() {
        let square =
            std::iter::zip(drawn, seen).map(|(drawn, seen)| f64::from(drawn - seen).powi(2)).sum::<f64>()
                / 3.0;
        squares += square;
        if region.moving.get(pixel) == Some(&true) {
            moving.0 += square;
            moving.1 += 1;
        }
    }
    let depth_m = std::iter::zip(median_m, &picture.depth_m)
        .enumerate()
        .filter(|(pixel, (_, seen))| region.depth.get(*pixel) == Some(&true) && seen.is_finite())
        .map(|(_, (drawn, seen))| (drawn - seen.to_f32()).abs())
        .collect();
    let [width, _] = views.size();
    Errors {
        psnr_db: decibels(squares / colour.len().max(1) as f64),
        ssim: region.structure.then(|| ssim(&drawn, &seen, width as usize)).flatten(),
        moving,
        depth_m,
    }
}

/// Peak signal-to-noise ratio of a mean squared error of values from 0 to 1; equal pictures count as 100 dB.
pub(crate) fn decibels(mean_square: f64) -> f64 {
    -10.0 * mean_square.max(1e-10).log10()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decibels_of_known_errors() {
        assert_eq!(decibels(0.01), 20.0);
        assert_eq!(decibels(0.0), 100.0);
    }
}
