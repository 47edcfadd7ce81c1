//! The contract of all rasterizers, kept on the adapter.

use l4d_splat::raster::{
    Contribution, Drawing, DrawingGradient, Projected, RasterError, check_length, check_pixel,
};
use l4d_splat::splats::SplatGradients;

use crate::projection::Projection;
use crate::{backward, carry, picture};

impl Projected for Projection<'_> {
    fn draw(&self) -> Result<Drawing, RasterError> {
        self.gpu.watched(|| picture::draw(self))
    }

    fn spread(&self, features: &[f32], channels: usize) -> Result<Vec<f32>, RasterError> {
        check_length("features", features.len(), self.splats.len().checked_mul(channels))?;
        self.gpu.watched(|| carry::spread(self, features, channels))
    }

    fn gather(&self, pixels: &[f32], channels: usize) -> Result<Vec<f32>, RasterError> {
        check_length("pixels", pixels.len(), self.view.pixel_count().checked_mul(channels))?;
        self.gpu.watched(|| carry::gather(self, pixels, channels))
    }

    fn contributors(&self, column: u32, row: u32) -> Result<Vec<Contribution>, RasterError> {
        check_pixel(&self.view, column, row)?;
        self.gpu.watched(|| carry::contributors(self, column, row))
    }

    fn radii_px(&self) -> Result<Vec<f32>, RasterError> {
        self.gpu.watched(|| backward::radii(self))
    }

    fn backward(&self, drawing: &Drawing, gradient: &DrawingGradient) -> Result<SplatGradients, RasterError> {
        drawing.check(&self.view)?;
        gradient.check(&self.view)?;
        self.gpu.watched(|| backward::backward(self, drawing, gradient))
    }
}
