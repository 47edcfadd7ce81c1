//! The contract of all rasterizers, kept on the adapter: splats in its memory, and what is asked of them.

use bytemuck::{Pod, Zeroable};
use l4d_splat::raster::{
    Drawing, DrawingGradient, Projected, RasterError, RasterSettings, Rasterizer, check_length,
};
use l4d_splat::splats::{SplatGradients, Splats};
use l4d_splat::view::View;
use rayon::prelude::*;
use wgpu::Buffer;

use crate::device::Gpu;
use crate::projection::Projection;
use crate::{backward, features, forward};

/// Gaussians packed by one task.
const PACKED: usize = 4096;

/// As `shared/gaussian.wgsl` has it.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
struct PackedGaussian {
    mean: [f32; 3],
    opacity: f32,
    scale: [f32; 3],
    unused: f32,
    rotation: [f32; 4],
}

/// Splats that an adapter holds.
#[derive(Debug)]
pub(crate) struct Uploaded<'a> {
    pub(crate) gpu: &'a Gpu,
    pub(crate) splats: &'a Splats,
    pub(crate) gaussians: Buffer,
    pub(crate) sh: Buffer,
}

impl Gpu {
    /// Copies splats to the adapter.
    fn upload<'a>(&'a self, splats: &'a Splats) -> Result<Uploaded<'a>, RasterError> {
        self.with_error_scopes(|| {
            let gaussians: Vec<PackedGaussian> =
                (splats.means(), splats.scales(), splats.rotations(), splats.opacities())
                    .into_par_iter()
                    .with_min_len(PACKED)
                    .map(|(&mean, &scale, &rotation, &opacity)| PackedGaussian {
                        mean,
                        opacity,
                        scale,
                        unused: 0.0,
                        rotation,
                    })
                    .collect();
            let sh = self.filled("spherical harmonics", splats.sh())?;
            Ok(Uploaded { gpu: self, splats, gaussians: self.filled("gaussians", &gaussians)?, sh })
        })
    }
}

impl Rasterizer for Gpu {
    fn name(&self) -> String {
        self.title()
    }

    fn prepare<'a>(
        &'a self,
        splats: &'a Splats,
        view: &View,
        settings: &RasterSettings,
    ) -> Result<Box<dyn Projected + 'a>, RasterError> {
        settings.check()?;
        let uploaded = self.upload(splats)?;
        Ok(Box::new(self.with_error_scopes(|| Projection::new(&uploaded, view, settings))?))
    }
}

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

    fn backward(&self, drawing: &Drawing, gradient: &DrawingGradient) -> Result<SplatGradients, RasterError> {
        drawing.check(&self.view)?;
        gradient.check(&self.view)?;
        self.gpu.with_error_scopes(|| backward::backward(self, drawing, gradient))
    }
}
