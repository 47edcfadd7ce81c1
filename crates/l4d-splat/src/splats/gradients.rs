//! Gradients by splats, and by the parameters that they came from.

use super::{Splats, sigmoid, unit};
use crate::deform::Offsets;
use crate::gaussians::Gaussians;

/// Derivatives of a loss by the values of [`Splats`], plus what densification wants to know.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SplatGradients<F = f32> {
    /// By the centres, 1/metre.
    pub means: Vec<[F; 3]>,
    /// By the standard deviations, 1/metre.
    pub scales: Vec<[F; 3]>,
    /// By the quaternions (w, x, y, z) as they enter the rotation matrix; not yet tangent to the unit sphere.
    pub rotations: Vec<[F; 4]>,
    /// By the opacities.
    pub opacities: Vec<F>,
    /// By the spherical harmonics.
    pub sh: Vec<[F; 3]>,
    /// By the projected centres in normalised device coordinates (the picture is 2 wide and 2 high): the length of
    /// this drives densification.
    pub means_ndc: Vec<[F; 2]>,
    /// Whether the Gaussian covers a tile of the picture and is opaque enough to leave a trace.
    pub visible: Vec<bool>,
}

impl<F: Copy + Default> SplatGradients<F> {
    /// No gradient, nothing visible.
    pub fn zeros<G>(splats: &Splats<G>) -> Self {
        let count = splats.len();
        Self {
            means: vec![[F::default(); 3]; count],
            scales: vec![[F::default(); 3]; count],
            rotations: vec![[F::default(); 4]; count],
            opacities: vec![F::default(); count],
            sh: vec![[F::default(); 3]; splats.parts.sh.len()],
            means_ndc: vec![[F::default(); 2]; count],
            visible: vec![false; count],
        }
    }
}

impl<F> SplatGradients<F> {
    /// Derivatives by means, scales, rotations, opacities and spherical harmonics, flat.
    pub fn lists(&self) -> [&[F]; 5] {
        [
            self.means.as_flattened(),
            self.scales.as_flattened(),
            self.rotations.as_flattened(),
            &self.opacities,
            self.sh.as_flattened(),
        ]
    }

    fn lists_mut(&mut self) -> [&mut [F]; 5] {
        [
            self.means.as_flattened_mut(),
            self.scales.as_flattened_mut(),
            self.rotations.as_flattened_mut(),
            &mut self.opacities,
            self.sh.as_flattened_mut(),
        ]
    }
}

impl SplatGradients {
    /// Adds the gradients of another picture of the same splats; visible in either is visible.
    pub fn add(&mut self, other: &Self) {
        for (sums, values) in self.lists_mut().into_iter().zip(other.lists()) {
            sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        }
        let (sums, values) = (self.means_ndc.as_flattened_mut(), other.means_ndc.as_flattened());
        sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        self.visible.iter_mut().zip(&other.visible).for_each(|(any, &seen)| *any |= seen);
    }

    /// Sets the derivatives by all Gaussians but the marked to zero.
    pub(crate) fn clear_all_but(&mut self, marked: &[bool]) {
        for list in self.lists_mut() {
            let width = list.len() / marked.len().max(1);
            for (row, _) in marked.iter().enumerate().filter(|(_, marked)| !**marked) {
                list[row * width..][..width].fill(0.0);
            }
        }
        for (by_mean, _) in self.means_ndc.iter_mut().zip(marked).filter(|(_, marked)| !**marked) {
            *by_mean = [0.0; 2];
        }
    }

    /// Carries the gradients through the activations, back to the parameters that were activated.
    ///
    /// A quaternion without direction (see [`Gaussians::activate`]) gets no gradient.
    pub fn through_activation(self, raw: &Gaussians) -> Offsets {
        let log_scales = std::iter::zip(&self.scales, &raw.log_scales)
            .map(|(gradient, log_scale)| std::array::from_fn(|axis| gradient[axis] * log_scale[axis].exp()))
            .collect();
        let rotations = std::iter::zip(&self.rotations, &raw.rotations)
            .map(|(gradient, quaternion)| through_normalisation(gradient, quaternion))
            .collect();
        let opacity_logits = std::iter::zip(&self.opacities, &raw.opacity_logits)
            // Not o * (1 - o): the difference has no digits left where o is almost 1.
            .map(|(gradient, &logit)| gradient * sigmoid(logit) * sigmoid(-logit))
            .collect();
        Offsets { means: self.means, log_scales, rotations, opacity_logits, sh: self.sh }
    }
}

/// The part of the gradient that is tangent to the unit sphere, over the length.
fn through_normalisation(gradient: &[f32; 4], quaternion: &[f32; 4]) -> [f32; 4] {
    let Some((length, unit)) = unit(quaternion) else { return [0.0; 4] };
    let along: f64 = std::iter::zip(gradient, unit).map(|(&g, u)| f64::from(g) * u).sum();
    std::array::from_fn(|axis| ((f64::from(gradient[axis]) - unit[axis] * along) / length) as f32)
}
