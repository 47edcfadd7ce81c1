//! What a rasterizer hands back, and what it wants to hear about it.

use num_traits::Float;

use super::{RasterError, check_length};
use crate::view::View;

/// A picture of splats; all lists are row-major.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Drawing<F = f32> {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Display colour over the background, not clamped.
    pub colour: Vec<[F; 3]>,
    /// Accumulated alpha, the sum of a_i T_i: how much of a pixel the splats fill.
    pub alpha: Vec<F>,
    /// What shines through: 1 - alpha, with all its digits.
    pub transmittance: Vec<F>,
    /// Sum of z_i a_i T_i, metres: the depth of 4DGaussians, too near wherever alpha is below 1.
    pub depth_sum_m: Vec<F>,
    /// Depths at which the transmittance falls through a level; none unless the settings ask for them.
    pub quantiles: Option<DepthQuantiles<F>>,
}

/// For each pixel the z of the first Gaussian behind which the transmittance is below a level, metres; +inf where it
/// never is.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DepthQuantiles<F = f32> {
    /// Level 0.75.
    pub near_m: Vec<F>,
    /// Level 0.5: does not bleed over edges as a mean does.
    pub median_m: Vec<F>,
    /// Level 0.25.
    pub far_m: Vec<F>,
}

impl DepthQuantiles {
    /// Levels of transmittance in the order of the fields.
    pub const LEVELS: [f32; 3] = [0.75, 0.5, 0.25];
}

/// Derivatives of a loss by a [`Drawing`], row-major.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct DrawingGradient<F = f32> {
    /// By the colour over the background.
    pub colour: Vec<[F; 3]>,
    /// By the accumulated alpha.
    pub alpha: Vec<F>,
    /// By the summed depth, 1/metre.
    pub depth_sum_m: Vec<F>,
}

impl<F: Float> Drawing<F> {
    /// Expected depth given that something was hit, metres: the summed depth over alpha; +inf where alpha is 0.
    pub fn depth_expected_m(&self) -> Vec<F> {
        std::iter::zip(&self.depth_sum_m, &self.alpha)
            .map(|(&sum, &alpha)| if alpha > F::zero() { sum / alpha } else { F::infinity() })
            .collect()
    }
}

impl<F: Copy> Drawing<F> {
    /// The same with every number changed.
    pub(super) fn map<G>(self, change: impl Fn(F) -> G + Copy) -> Drawing<G> {
        let list = |list: Vec<F>| list.into_iter().map(change).collect();
        Drawing {
            width: self.width,
            height: self.height,
            colour: self.colour.into_iter().map(|row| row.map(change)).collect(),
            alpha: list(self.alpha),
            transmittance: list(self.transmittance),
            depth_sum_m: list(self.depth_sum_m),
            quantiles: self.quantiles.map(|quantiles| DepthQuantiles {
                near_m: list(quantiles.near_m),
                median_m: list(quantiles.median_m),
                far_m: list(quantiles.far_m),
            }),
        }
    }
}

impl<F: Copy> DrawingGradient<F> {
    /// The same with every number changed.
    pub(crate) fn map<G>(&self, change: impl Fn(F) -> G + Copy) -> DrawingGradient<G> {
        let list = |list: &[F]| list.iter().copied().map(change).collect();
        DrawingGradient {
            colour: self.colour.iter().map(|row| row.map(change)).collect(),
            alpha: list(&self.alpha),
            depth_sum_m: list(&self.depth_sum_m),
        }
    }
}

impl<F: Copy + Default> DrawingGradient<F> {
    /// A loss that does not depend on the picture.
    pub fn zeros(view: &View) -> Self {
        let pixels = view.pixel_count();
        Self {
            colour: vec![[F::default(); 3]; pixels],
            alpha: vec![F::default(); pixels],
            depth_sum_m: vec![F::default(); pixels],
        }
    }

    /// Whether there is one entry per pixel.
    ///
    /// # Errors
    /// Another size.
    pub fn check(&self, view: &View) -> Result<(), RasterError> {
        let pixels = Some(view.pixel_count());
        check_length("gradient by colour", self.colour.len(), pixels)?;
        check_length("gradient by alpha", self.alpha.len(), pixels)?;
        check_length("gradient by summed depth", self.depth_sum_m.len(), pixels)
    }
}

impl<F> Drawing<F> {
    /// Whether this is a picture of the size of `view`.
    ///
    /// # Errors
    /// Another size.
    pub fn check(&self, view: &View) -> Result<(), RasterError> {
        let pixels = Some(view.pixel_count());
        check_length("width of the drawing", self.width as usize, Some(view.width() as usize))?;
        check_length("colour of the drawing", self.colour.len(), pixels)?;
        check_length("transmittance of the drawing", self.transmittance.len(), pixels)?;
        check_length("summed depth of the drawing", self.depth_sum_m.len(), pixels)
    }
}
