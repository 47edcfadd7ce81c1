//! The reference's gradients against central differences of its own pictures, in f64.

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::compare::random_gradient;
use super::scenes::Case;
use crate::raster::{Drawing, DrawingGradient, RasterError, Reference, ReferenceScene};
use crate::splats::Splats;

/// How well gradients and central differences agree.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Agreement {
    /// Largest deviation relative to the largest gradient of the field, beyond what rounding explains.
    pub error: f64,
    pub compared: usize,
    /// Derivatives not compared, because a threshold lies within the step.
    pub skipped: usize,
}

/// A step by a number of a field, in the order of [`crate::splats::SplatParts::lists`]: small in the picture and large in f64.
fn step(field: usize, value: f64, metres_per_pixel: f64) -> f64 {
    match field {
        0 => 1e-4 * metres_per_pixel,
        1 => (1e-5 * value).max(1e-5 * metres_per_pixel),
        2 | 3 => 1e-6,
        _ => 1e-5,
    }
}

/// Compares `samples` derivatives of each field, drawn among the visible Gaussians, of a loss that weights every
/// number of the picture at random.
///
/// # Errors
/// As the reference.
pub fn central_differences(case: &Case, samples: usize) -> Result<Agreement, RasterError> {
    let scene = |splats: &Splats<f64>| Reference::scene(splats, &case.view, &case.settings);
    let splats = case.splats.to_f64();
    let base = scene(&splats)?;
    let weights = random_gradient(&case.view, 31).map(f64::from);
    let gradients = base.backward(&weights)?;
    let depths = base.depths_m();
    let visible: Vec<usize> = (0..splats.len()).filter(|&index| gradients.visible[index]).collect();
    let mut agreement = Agreement::default();
    if visible.is_empty() {
        return Ok(agreement);
    }
    let decisions = base.decisions();
    let (_, size) = loss(&base.draw(), &weights);
    let mut random = ChaCha8Rng::seed_from_u64(32);
    for (field, gradient) in gradients.by.lists().into_iter().enumerate() {
        let largest = gradient.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let width = gradient.len() / splats.len();
        for _ in 0..samples {
            let index = visible[random.random_range(0..visible.len())];
            let place = index * width + random.random_range(0..1000_usize) % width;
            let mut moved = splats.clone();
            let value = moved.parts.lists_mut()[field][place];
            let step = step(field, value, depths[index] / case.view.focal()[0]);
            // The step that was really taken: a coordinate far from the origin rounds it.
            let (ahead, behind) = (value + step, value - step);
            let mut at = |value: f64| -> Result<ReferenceScene, RasterError> {
                moved.parts.lists_mut()[field][place] = value;
                scene(&moved)
            };
            let (ahead_scene, behind_scene) = (at(ahead)?, at(behind)?);
            if ahead_scene.decisions() != decisions || behind_scene.decisions() != decisions {
                agreement.skipped += 1;
                continue;
            }
            let rise = loss(&ahead_scene.draw(), &weights).0 - loss(&behind_scene.draw(), &weights).0;
            let difference = rise / (ahead - behind);
            let rounding = 16.0 * f64::EPSILON * size / (ahead - behind);
            let excess = (difference - gradient[place]).abs() - rounding;
            let scale = if largest > 0.0 { largest } else { 1.0 };
            agreement.error = agreement.error.max(excess / scale);
            agreement.compared += 1;
        }
    }
    Ok(agreement)
}

/// The loss, and the sum of the sizes of its terms.
fn loss(drawing: &Drawing<f64>, weights: &DrawingGradient<f64>) -> (f64, f64) {
    let terms = std::iter::zip(drawing.colour.as_flattened(), weights.colour.as_flattened())
        .chain(drawing.alpha.iter().zip(&weights.alpha))
        .chain(drawing.depth_sum_m.iter().zip(&weights.depth_sum_m));
    terms.fold((0.0, 0.0), |(sum, size), (value, weight)| {
        (sum + value * weight, size + (value * weight).abs())
    })
}
