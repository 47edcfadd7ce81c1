//! Gradients by splats, and by the parameters that they came from.

use super::{SplatParts, Splats, sigmoid, unit};
use crate::gaussians::Gaussians;

/// Derivatives of a loss by the values of [`Splats`], plus what densification wants to know.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SplatGradients<F = f32> {
    /// By centres and standard deviations, 1/metre, by opacities and harmonics; those by the quaternions as they enter
    /// the rotation matrix, not yet tangent to the unit sphere.
    pub by: SplatParts<F>,
    /// By the projected centres in normalised device coordinates (the picture is 2 wide and 2 high): the length of
    /// this drives densification.
    pub means_ndc: Vec<[F; 2]>,
    /// Whether the Gaussian covers a tile of the picture and is opaque enough to leave a trace.
    pub visible: Vec<bool>,
}

impl<F: Copy + Default> SplatGradients<F> {
    /// No gradient, nothing visible.
    pub fn zeros<G: Copy>(splats: &Splats<G>) -> Self {
        let by = splats.parts.map(|_| F::default());
        Self { by, means_ndc: vec![[F::default(); 2]; splats.len()], visible: vec![false; splats.len()] }
    }
}

impl SplatGradients {
    /// Adds the gradients of another picture of the same splats; visible in either is visible.
    pub(crate) fn add(&mut self, other: &Self) {
        let lists = self.by.lists_mut().into_iter().zip(other.by.lists());
        let ndc = (self.means_ndc.as_flattened_mut(), other.means_ndc.as_flattened());
        for (sums, values) in lists.chain([ndc]) {
            sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
        }
        self.visible.iter_mut().zip(&other.visible).for_each(|(any, &seen)| *any |= seen);
    }

    /// Sets the derivatives by all Gaussians but the marked to zero.
    pub(crate) fn clear_all_but(&mut self, marked: &[bool]) {
        for list in self.by.lists_mut().into_iter().chain([self.means_ndc.as_flattened_mut()]) {
            let width = list.len() / marked.len().max(1);
            for (row, _) in marked.iter().enumerate().filter(|(_, marked)| !**marked) {
                list[row * width..][..width].fill(0.0);
            }
        }
    }

    /// Carries the gradients through the activations, back to the parameters that were activated.
    ///
    /// A quaternion without direction (see [`Gaussians::activate`]) gets no gradient.
    pub fn through_activation(self, raw: &Gaussians) -> Gaussians {
        let by = self.by;
        let log_scales = std::iter::zip(&by.scales, &raw.log_scales)
            .map(|(gradient, log_scale)| std::array::from_fn(|axis| gradient[axis] * log_scale[axis].exp()))
            .collect();
        let rotations = std::iter::zip(&by.rotations, &raw.rotations)
            .map(|(gradient, quaternion)| through_normalisation(gradient, quaternion))
            .collect();
        let opacity_logits = std::iter::zip(&by.opacities, &raw.opacity_logits)
            // Not o * (1 - o): the difference has no digits left where o is almost 1.
            .map(|(gradient, &logit)| gradient * sigmoid(logit) * sigmoid(-logit))
            .collect();
        Gaussians {
            sh_degree: raw.sh_degree,
            means: by.means,
            log_scales,
            rotations,
            opacity_logits,
            sh: by.sh,
        }
    }
}

/// The part of the gradient that is tangent to the unit sphere, over the length.
fn through_normalisation(gradient: &[f32; 4], quaternion: &[f32; 4]) -> [f32; 4] {
    let Some((length, unit)) = unit(quaternion) else { return [0.0; 4] };
    let along: f64 = std::iter::zip(gradient, unit).map(|(&g, u)| f64::from(g) * u).sum();
    std::array::from_fn(|axis| ((f64::from(gradient[axis]) - unit[axis] * along) / length) as f32)
}
