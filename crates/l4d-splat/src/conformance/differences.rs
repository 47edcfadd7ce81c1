//! The reference's gradients against central differences of its own pictures, in f64.

use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

use super::compare::random_gradient;
use super::scenes::Case;
use crate::raster::{Drawing, DrawingGradient, RasterError, Reference, ReferenceScene};
use crate::splats::{SplatGradients, Splats};

/// How well gradients and central differences agree.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Agreement {
    /// Largest deviation relative to the largest gradient of the field, beyond what rounding explains.
    pub error: f64,
    /// Derivatives compared.
    pub compared: usize,
    /// Derivatives not compared, because a threshold lies within the step.
    pub skipped: usize,
}

#[derive(Debug, Clone, Copy)]
enum Field {
    Means,
    Scales,
    Rotations,
    Opacities,
    Sh,
}

const FIELDS: [Field; 5] = [Field::Means, Field::Scales, Field::Rotations, Field::Opacities, Field::Sh];

impl Field {
    fn entry(self, splats: &mut Splats<f64>, index: usize, choice: usize) -> &mut f64 {
        let parts = &mut splats.parts;
        match self {
            Self::Means => &mut parts.means[index][choice % 3],
            Self::Scales => &mut parts.scales[index][choice % 3],
            Self::Rotations => &mut parts.rotations[index][choice % 4],
            Self::Opacities => &mut parts.opacities[index],
            Self::Sh => {
                let count = parts.sh_degree.coefficients();
                &mut parts.sh[index * count + choice / 3 % count][choice % 3]
            }
        }
    }

    fn gradient(self, gradients: &SplatGradients<f64>, index: usize, choice: usize) -> f64 {
        match self {
            Self::Means => gradients.means[index][choice % 3],
            Self::Scales => gradients.scales[index][choice % 3],
            Self::Rotations => gradients.rotations[index][choice % 4],
            Self::Opacities => gradients.opacities[index],
            Self::Sh => {
                let count = gradients.sh.len() / gradients.means.len();
                gradients.sh[index * count + choice / 3 % count][choice % 3]
            }
        }
    }

    fn largest(self, gradients: &SplatGradients<f64>) -> f64 {
        let list = match self {
            Self::Means => gradients.means.as_flattened(),
            Self::Scales => gradients.scales.as_flattened(),
            Self::Rotations => gradients.rotations.as_flattened(),
            Self::Opacities => &gradients.opacities,
            Self::Sh => gradients.sh.as_flattened(),
        };
        list.iter().fold(0.0, |most, value| most.max(value.abs()))
    }

    /// A step that is small in the picture and large in f64.
    fn step(self, value: f64, metres_per_pixel: f64) -> f64 {
        match self {
            Self::Means => 1e-4 * metres_per_pixel,
            Self::Scales => (1e-5 * value).max(1e-5 * metres_per_pixel),
            Self::Rotations | Self::Opacities => 1e-6,
            Self::Sh => 1e-5,
        }
    }
}

/// Compares `samples` derivatives of each field, drawn among the visible Gaussians, of a loss that weights every
/// number of the picture at random.
pub fn central_differences(case: &Case, samples: usize) -> Result<Agreement, RasterError> {
    let scene = |splats: &Splats<f64>| Reference::<f64>::new().scene(splats, &case.view, &case.settings);
    let splats = case.splats.cast::<f64>();
    let base = scene(&splats)?;
    let weights = random_gradient(&case.view, 31).cast();
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
    for field in FIELDS {
        let largest = field.largest(&gradients);
        for _ in 0..samples {
            let index = visible[random.random_range(0..visible.len())];
            let choice = random.random_range(0..1000);
            let mut moved = splats.clone();
            let value = *field.entry(&mut moved, index, choice);
            let step = field.step(value, depths[index] / case.view.focal()[0]);
            // The step that was really taken: a coordinate far from the origin rounds it.
            let (ahead, behind) = (value + step, value - step);
            let mut at = |value: f64| -> Result<ReferenceScene<f64>, RasterError> {
                *field.entry(&mut moved, index, choice) = value;
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
            let excess = (difference - field.gradient(&gradients, index, choice)).abs() - rounding;
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
