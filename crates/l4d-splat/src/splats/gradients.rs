//! What a picture's error says about splats, and about the parameters that they came from.

use super::{Splats, sigmoid, unit};
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

/// Derivatives of a loss by the parameters of [`Gaussians`].
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GaussianGradients {
    /// By [`Gaussians::means`].
    pub means: Vec<[f32; 3]>,
    /// By [`Gaussians::log_scales`].
    pub log_scales: Vec<[f32; 3]>,
    /// By [`Gaussians::rotations`].
    pub rotations: Vec<[f32; 4]>,
    /// By [`Gaussians::opacity_logits`].
    pub opacity_logits: Vec<f32>,
    /// By [`Gaussians::sh`].
    pub sh: Vec<[f32; 3]>,
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

impl SplatGradients {
    /// Adds the gradients of another picture of the same splats; visible in either is visible.
    pub fn add(&mut self, other: &Self) {
        add_rows(&mut self.means, &other.means);
        add_rows(&mut self.scales, &other.scales);
        add_rows(&mut self.rotations, &other.rotations);
        self.opacities.iter_mut().zip(&other.opacities).for_each(|(sum, value)| *sum += value);
        add_rows(&mut self.sh, &other.sh);
        add_rows(&mut self.means_ndc, &other.means_ndc);
        self.visible.iter_mut().zip(&other.visible).for_each(|(any, &seen)| *any |= seen);
    }

    /// Sets the derivatives by all Gaussians but the marked to zero.
    pub(crate) fn clear_all_but(&mut self, marked: &[bool]) {
        let coefficients = self.sh.len() / self.means.len().max(1);
        for row in (0..self.means.len()).filter(|&row| !marked[row]) {
            self.means[row] = [0.0; 3];
            self.scales[row] = [0.0; 3];
            self.rotations[row] = [0.0; 4];
            self.opacities[row] = 0.0;
            self.sh[row * coefficients..][..coefficients].fill([0.0; 3]);
            self.means_ndc[row] = [0.0; 2];
        }
    }

    /// Length of the gradient by the projected centre of one Gaussian (normalised device coordinates).
    pub fn mean_ndc_norm(&self, index: usize) -> f32 {
        let [x, y] = self.means_ndc[index];
        x.hypot(y)
    }

    /// Carries the gradients through the activations, back to the parameters that were activated.
    ///
    /// A quaternion without direction (see [`Gaussians::activate`]) gets no gradient.
    pub fn through_activation(self, raw: &Gaussians) -> GaussianGradients {
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
        GaussianGradients { means: self.means, log_scales, rotations, opacity_logits, sh: self.sh }
    }
}

/// The part of the gradient that is tangent to the unit sphere, over the length.
fn through_normalisation(gradient: &[f32; 4], quaternion: &[f32; 4]) -> [f32; 4] {
    let Some((length, unit)) = unit(quaternion) else { return [0.0; 4] };
    let along: f64 = std::iter::zip(gradient, unit).map(|(&g, u)| f64::from(g) * u).sum();
    std::array::from_fn(|axis| ((f64::from(gradient[axis]) - unit[axis] * along) / length) as f32)
}

fn add_rows<const N: usize>(sums: &mut [[f32; N]], values: &[[f32; N]]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        for (sum, value) in sum.iter_mut().zip(value) {
            *sum += value;
        }
    }
}
