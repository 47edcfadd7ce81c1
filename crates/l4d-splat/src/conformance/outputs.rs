//! Everything that a rasterizer says of a scene, for tests that want the same bytes twice.

use crate::raster::{Drawing, DrawingGradient, RasterError, Rasterizer};
use crate::splats::SplatGradients;

use super::Case;

/// More than any rasterizer carries at a time.
const CHANNELS: usize = 11;

/// What came of each operation; lists of numbers as their bits.
#[derive(Debug, PartialEq)]
pub struct Outputs {
    drawing: Drawing,
    gradients: SplatGradients,
    spread: Vec<u32>,
    gathered: Vec<u32>,
}

impl Outputs {
    /// Asks for all of it.
    ///
    /// # Errors
    /// As the rasterizer.
    pub fn of(rasterizer: &dyn Rasterizer, case: &Case) -> Result<Self, RasterError> {
        let projected = rasterizer.prepare(&case.splats, &case.view, &case.settings)?;
        let drawing = projected.draw()?;
        let mut gradient = DrawingGradient::zeros(&case.view);
        for (pixel, slope) in gradient.colour.iter_mut().enumerate() {
            *slope = [(pixel as f32).sin(), (pixel as f32).cos(), 0.3];
        }
        let gradients = projected.backward(&drawing, &gradient)?;
        let features: Vec<f32> = (0..case.splats.len() * CHANNELS).map(|i| (i as f32).sin()).collect();
        let pixels: Vec<f32> = (0..case.view.pixel_count() * CHANNELS).map(|i| (i as f32).cos()).collect();
        let bits = |list: Vec<f32>| list.into_iter().map(f32::to_bits).collect();
        Ok(Self {
            drawing,
            gradients,
            spread: bits(projected.splat_features(&features, CHANNELS)?),
            gathered: bits(projected.gather_features(&pixels, CHANNELS)?),
        })
    }
}
