//! Where to cut: the level at which the answer, drawn again, fits the evidence best.
//!
//! Blend weights spill over silhouettes and through half-transparent Gaussians, so that one half is the wrong level
//! for sums of votes. Owns the choice of level; refuses to know how the numbers came about.

use l4d_splat::splats::Splats;
use rayon::prelude::*;

use crate::lift::error::LiftError;
use crate::lift::evidence::{Picture, TimeEvidence, numbers};
use crate::lift::labels::HALF;
use crate::lift::rendered_model::RenderedModel;

/// Levels that are tried.
const LEVELS: [f32; 13] = [0.05, 0.1, 0.15, 0.2, 0.25, 0.3, 0.35, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9];

/// How well each level fits, summed over pictures.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Fit {
    /// Intersections over unions at each level.
    overlaps: [f64; LEVELS.len()],
}

impl Fit {
    /// Adds the pictures of one time that show something.
    pub(super) fn add(
        &mut self,
        rendered: &RenderedModel<'_>,
        splats: &Splats,
        instant: &TimeEvidence<'_>,
        labels: &[f32],
    ) -> Result<(), LiftError> {
        let hard: Vec<f32> =
            labels.iter().flat_map(|&label| LEVELS.map(|level| f32::from(u8::from(label > level)))).collect();
        let shown = instant.pictures.par_iter().filter(|picture| !picture.mask.is_empty());
        let overlaps: Vec<[f64; LEVELS.len()]> = shown
            .map(|picture| {
                let projected = rendered.rasterizer.prepare(splats, picture.view, rendered.raster)?;
                let blend = projected.splat_features(&hard, LEVELS.len())?;
                Ok(overlaps(picture, blend.as_chunks().0))
            })
            .collect::<Result<_, LiftError>>()?;
        for picture in overlaps {
            for (sum, overlap) in self.overlaps.iter_mut().zip(picture) {
                *sum += overlap;
            }
        }
        Ok(())
    }

    /// The best level; of equally good ones the middle one. One half if nothing was ever shown.
    pub(super) fn best(&self) -> f32 {
        let best = self.overlaps.iter().copied().fold(0.0, f64::max);
        if best <= 0.0 {
            return HALF;
        }
        let good: Vec<f32> = std::iter::zip(LEVELS, self.overlaps)
            .filter(|&(_, overlap)| overlap >= best * (1.0 - 1e-9))
            .map(|(level, _)| level)
            .collect();
        good.get(good.len() / 2).copied().unwrap_or(HALF)
    }
}

/// Intersection over union at each level. `pixels` holds what each pixel shows at each level.
fn overlaps(picture: &Picture<'_>, pixels: &[[f32; LEVELS.len()]]) -> [f64; LEVELS.len()] {
    let mut shared = [0_u32; LEVELS.len()];
    let mut drawn = [0_u32; LEVELS.len()];
    for (pixel, inside) in pixels.iter().zip(numbers(picture.mask)) {
        for (level, &value) in pixel.iter().enumerate() {
            drawn[level] += u32::from(value > HALF);
            shared[level] += u32::from(value > HALF && inside > 0.0);
        }
    }
    let area = picture.mask.area() as f64;
    std::array::from_fn(|level| {
        f64::from(shared[level]) / (area + f64::from(drawn[level]) - f64::from(shared[level])).max(1.0)
    })
}
