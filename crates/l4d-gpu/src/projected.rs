//! The contract of all rasterizers, kept on the adapter.

use l4d_splat::raster::{
    Contribution, Drawing, DrawingGradient, Projected, RasterError, check_length, check_pixel,
};
use l4d_splat::splats::SplatGradients;

use crate::projection::Projection;
use crate::{backward, features, forward};

impl Projected for Projection<'_> {
    fn draw(&self) -> Result<Drawing, RasterError> {
        self.gpu.with_error_scopes(|| forward::draw(self))
    }

    fn splat_features(&self, features: &[f32], channels: usize) -> Result<Vec<f32>, RasterError> {
        check_length("features", features.len(), self.splats.len().checked_mul(channels))?;
        self.gpu.with_error_scopes(|| features::splat_features(self, features, channels))
    }

    fn gather_features(&self, pixels: &[f32], channels: usize) -> Result<Vec<f32>, RasterError> {
        check_length("pixels", pixels.len(), self.view.pixel_count().checked_mul(channels))?;
        self.gpu.with_error_scopes(|| features::gather_features(self, pixels, channels))
    }

    fn contributors(&self, column: u32, row: u32) -> Result<Vec<Contribution>, RasterError> {
        check_pixel(&self.view, column, row)?;
        self.gpu.with_error_scopes(|| features::contributors(self, column, row))
    }

    fn radii_px(&self) -> Result<Vec<f32>, RasterError> {
        self.gpu.with_error_scopes(|| backward::radii(self))
    }

    fn backward(&self, drawing: &Drawing, gradient: &DrawingGradient) -> Result<SplatGradients, RasterError> {
        drawing.check(&self.view)?;
        gradient.check(&self.view)?;
        self.gpu.with_error_scopes(|| backward::backward(self, drawing, gradient))
    }
}
