//! Splats in the adapter's memory, for as many views as one likes.

use bytemuck::{Pod, Zeroable};
use l4d_splat::raster::{Projected, RasterError, RasterSettings, Rasterizer};
use l4d_splat::splats::Splats;
use l4d_splat::view::View;
use rayon::prelude::*;
use wgpu::{BindingResource, Buffer};

use crate::commands::piece;
use crate::device::Gpu;
use crate::error::{Failure, GpuError};
use crate::projection::Projection;
use crate::shaders::GRADIENT_FLOATS;

/// Gaussians packed by one task.
const PACKED: usize = 4096;
/// Pieces of buffers start at multiples of 256 bytes: so many Gaussians of any number of floats always do.
const ALIGNED: u64 = 64;
const GRADIENT_BYTES: u64 = 4 * GRADIENT_FLOATS as u64;

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
    /// Seen in pieces: up to 192 bytes per Gaussian.
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
            let sh = self.long_buffer("spherical harmonics", size_of_val(splats.sh()) as u64)?;
            self.write(&sh, splats.sh());
            Ok(Uploaded { gpu: self, splats, gaussians: self.filled("gaussians", &gaussians)?, sh })
        })
    }
}

impl<'a> Uploaded<'a> {
    /// Runs of Gaussians whose spherical harmonics, and whose gradients, one pass may see.
    pub(crate) fn pieces(&self) -> Result<Vec<Piece>, Failure> {
        let sh_stride = self.splats.sh_degree().coefficients() as u64 * size_of::<[f32; 3]>() as u64;
        let (stride, has) = (sh_stride.max(GRADIENT_BYTES), self.gpu.limits.binding);
        let length = has / stride / ALIGNED * ALIGNED;
        if length == 0 {
            let needs = ALIGNED * stride;
            let limit = "max_storage_buffer_binding_size";
            return Err(GpuError::TooLarge { what: "gradients", needs, limit, has }.into());
        }
        let count = self.splats.len() as u64;
        let pieces = (0..count).step_by(length as usize);
        Ok(pieces.map(|first| Piece { first, end: count.min(first + length), sh_stride }).collect())
    }
}

/// Consecutive Gaussians.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Piece {
    pub(crate) first: u64,
    pub(crate) end: u64,
    sh_stride: u64,
}

impl Piece {
    pub(crate) fn len(&self) -> u64 {
        self.end - self.first
    }

    /// Its spherical harmonics, or their derivatives, in the buffer of all.
    pub(crate) fn of_sh<'b>(&self, buffer: &'b Buffer) -> BindingResource<'b> {
        piece(buffer, self.first * self.sh_stride, self.len() * self.sh_stride)
    }

    /// Its derivatives by everything else in the buffer of all.
    pub(crate) fn of_gradients<'b>(&self, buffer: &'b Buffer) -> BindingResource<'b> {
        piece(buffer, self.first * GRADIENT_BYTES, self.len() * GRADIENT_BYTES)
    }

    pub(crate) fn part(&self) -> [u32; 4] {
        [self.first as u32, self.end as u32, 0, 0]
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
