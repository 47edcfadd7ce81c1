//! The fast rasterizer for processors: tiles over threads, eight pixels at a time.
//!
//! Geometry is computed in f64 (so that the decisions which Gaussian covers which tile, in which order, are those of
//! the reference), pixels in f32. Owns the choice of instructions at run time: AVX2 and FMA where the machine has
//! them, whatever the build was told, and the baseline of the target elsewhere. The bytes of a result depend on that
//! choice, but never on the number of threads: tiles are independent, and sums over tiles are taken in tile order.

mod backward;
mod binning;
mod blend;
mod exp2;
mod features;
mod forward;
mod gradients;
mod pixel_mask;
mod project_simd;
mod projection;

use fearless_simd::{Level, Simd};

use super::{
    Drawing, DrawingGradient, Projected, RasterError, RasterSettings, Rasterizer, TILE, check_channels,
    check_length,
};
use crate::splats::{SplatGradients, Splats};
use crate::view::View;
use binning::TileBins;
use blend::{Limits, Tile};
use pixel_mask::PixelMask;
use projection::{Projection, Splat2d};

/// Draws on the processor.
#[derive(Debug, Clone, Copy)]
pub struct Cpu {
    level: Level,
}

/// Work that is compiled once for each set of instructions. `run` must be inlined to profit.
trait Kernel {
    type Output;

    fn run<S: Simd>(self, simd: S) -> Self::Output;
}

impl Cpu {
    /// With the best instructions that this machine has and this crate knows.
    pub fn new() -> Self {
        Self { level: Level::new() }
    }

    /// With the instructions that every machine of this target has.
    pub fn portable() -> Self {
        Self { level: Level::baseline() }
    }

    /// Whether AVX2 and FMA are used.
    pub fn uses_avx2(self) -> bool {
        #[cfg(target_arch = "x86_64")]
        return self.level.as_avx2().is_some();
        #[cfg(not(target_arch = "x86_64"))]
        return false;
    }

    // Not the macro that dispatches over all levels: it would compile each kernel four times on x86-64.
    #[cfg(target_arch = "x86_64")]
    fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match (self.level.as_avx2(), self.level.as_sse2()) {
            (Some(avx2), _) => avx2.vectorize(
                #[inline(always)]
                || kernel.run(avx2),
            ),
            (None, Some(sse2)) => sse2.vectorize(
                #[inline(always)]
                || kernel.run(sse2),
            ),
            (None, None) => unreachable!("SSE2 is part of x86-64"),
        }
    }

    fn project<'a>(
        self,
        splats: &'a Splats,
        view: &View,
        settings: &RasterSettings,
        mask: PixelMask,
    ) -> Result<ProjectedScene<'a>, RasterError> {
        settings.check()?;
        let projection = Projection::new(view, settings);
        let splats2d = binning::front_to_back(self, &projection, splats, &mask)?;
        let limits = Limits::new(settings);
        let bins = TileBins::new(&splats2d, &limits, &mask, view)?;
        Ok(ProjectedScene {
            cpu: self,
            splats,
            view: *view,
            settings: *settings,
            projection,
            limits,
            mask,
            splats2d,
            bins,
        })
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn run<K: Kernel>(self, kernel: K) -> K::Output {
        fearless_simd::dispatch!(self.level, simd => kernel.run(simd))
    }
}

impl Default for Cpu {
    fn default() -> Self {
        Self::new()
    }
}

impl Rasterizer for Cpu {
    fn name(&self) -> String {
        let instructions = if self.uses_avx2() { "AVX2 and FMA" } else { "baseline instructions" };
        format!("CPU, {instructions}")
    }

    fn prepare<'a>(
        &'a self,
        splats: &'a Splats,
        view: &View,
        settings: &RasterSettings,
    ) -> Result<Box<dyn Projected + 'a>, RasterError> {
        Ok(Box::new(self.project(splats, view, settings, PixelMask::all(view))?))
    }

    fn prepare_marked<'a>(
        &'a self,
        splats: &'a Splats,
        view: &View,
        settings: &RasterSettings,
        marked: &[bool],
    ) -> Result<Box<dyn Projected + 'a>, RasterError> {
        check_length("marked pixels", marked.len(), Some(view.pixel_count()))?;
        Ok(Box::new(self.project(splats, view, settings, PixelMask::marked(view, settings, marked))?))
    }
}

/// Splats as one view sees them.
struct ProjectedScene<'a> {
    cpu: Cpu,
    splats: &'a Splats,
    view: View,
    settings: RasterSettings,
    projection: Projection,
    limits: Limits,
    mask: PixelMask,
    /// Visible Gaussians, front to back.
    splats2d: Vec<Splat2d>,
    /// Which of them touch which tile.
    bins: TileBins,
}

impl ProjectedScene<'_> {
    fn tile(&self, index: usize) -> Tile<'_> {
        let origin = self.bins.origin(index);
        let picture = [self.view.width() as usize, self.view.height() as usize];
        let size = [0, 1].map(|axis| TILE.min(picture[axis] - origin[axis]));
        Tile {
            splats2d: &self.splats2d,
            ranks: self.bins.of(index),
            origin,
            size,
            mask: self.mask.of_tile(index),
        }
    }
}

impl Projected for ProjectedScene<'_> {
    fn draw(&self) -> Result<Drawing, RasterError> {
        Ok(forward::draw(self))
    }

    fn splat_features(&self, features: &[f32], channels: usize) -> Result<Vec<f32>, RasterError> {
        check_channels(channels)?;
        check_length("features", features.len(), self.splats.len().checked_mul(channels))?;
        Ok(features::splat_features(self, features, channels))
    }

    fn gather_features(&self, pixels: &[f32], channels: usize) -> Result<Vec<f32>, RasterError> {
        check_channels(channels)?;
        check_length("pixels", pixels.len(), self.view.pixel_count().checked_mul(channels))?;
        Ok(features::gather_features(self, pixels, channels))
    }

    fn backward(&self, drawing: &Drawing, gradient: &DrawingGradient) -> Result<SplatGradients, RasterError> {
        drawing.check(&self.view)?;
        gradient.check(&self.view)?;
        Ok(gradients::splat_gradients(self, &backward::gradient_sums(self, drawing, gradient, None)))
    }

    fn backward_for(
        &self,
        drawing: &Drawing,
        gradient: &DrawingGradient,
        trainable: &[bool],
    ) -> Result<SplatGradients, RasterError> {
        drawing.check(&self.view)?;
        gradient.check(&self.view)?;
        check_length("trainable Gaussians", trainable.len(), Some(self.splats.len()))?;
        Ok(gradients::splat_gradients(
            self,
            &backward::gradient_sums(self, drawing, gradient, Some(trainable)),
        ))
    }
}
