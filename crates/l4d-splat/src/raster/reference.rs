//! The slow rasterizer: the equations written out in f64, one pixel and one Gaussian at a time.
//!
//! The specification that other rasterizers are measured against. Two forms differ from the textbook to keep digits:
//! the determinant of a projected covariance is a sum of squares, and the exponent has its square completed.

mod blend;
mod projection;

use super::{
    Drawing, DrawingGradient, Projected, RasterError, RasterSettings, Rasterizer, TILE, check_channels,
    check_length,
};
use crate::splats::{SplatGradients, Splats};
use crate::view::View;
use projection::{ProjectedGaussian, Projection};

/// Draws by the book.
#[derive(Debug, Clone, Copy, Default)]
pub struct Reference;

impl Reference {
    /// Projects splats in f64: for central differences and exact comparisons.
    ///
    /// # Errors
    /// Settings with which nothing can be drawn, and values that overflow in this view.
    pub fn scene(
        splats: &Splats<f64>,
        view: &View,
        settings: &RasterSettings,
    ) -> Result<ReferenceScene, RasterError> {
        settings.check()?;
        let projection = Projection::new(view, settings);
        let mut gaussians = Vec::new();
        for index in 0..splats.len() {
            gaussians.extend(projection.project(splats, index).map_err(RasterError::Overflow)?);
        }
        // Stable: equal depths keep the order of their indices. Depths are compared as f32, as everywhere.
        gaussians.sort_by(|a, b| (a.depth as f32).total_cmp(&(b.depth as f32)));
        let columns = (view.width() as usize).div_ceil(TILE);
        let rows = (view.height() as usize).div_ceil(TILE);
        let mut tiles = vec![Vec::new(); columns * rows];
        for (rank, gaussian) in gaussians.iter().enumerate() {
            for row in gaussian.tiles[1].clone() {
                for column in gaussian.tiles[0].clone() {
                    tiles[row * columns + column].push(rank);
                }
            }
        }
        let splats = splats.clone();
        Ok(ReferenceScene { splats, view: *view, settings: *settings, projection, gaussians, tiles, columns })
    }
}

/// Splats as the reference sees them from one view.
#[derive(Debug, Clone)]
pub struct ReferenceScene {
    splats: Splats<f64>,
    view: View,
    settings: RasterSettings,
    projection: Projection,
    /// Visible Gaussians, front to back.
    gaussians: Vec<ProjectedGaussian>,
    /// Positions in `gaussians` of the Gaussians of each tile, front to back; tiles row-major.
    tiles: Vec<Vec<usize>>,
    /// Tiles in a row.
    columns: usize,
}

impl Rasterizer for Reference {
    fn name(&self) -> String {
        "reference in f64".to_owned()
    }

    fn prepare<'a>(
        &'a self,
        splats: &'a Splats,
        view: &View,
        settings: &RasterSettings,
    ) -> Result<Box<dyn Projected + 'a>, RasterError> {
        Ok(Box::new(Self::scene(&splats.to_f64(), view, settings)?))
    }
}

/// `f32` outside, f64 inside.
impl Projected for ReferenceScene {
    fn draw(&self) -> Result<Drawing, RasterError> {
        Ok(self.draw().map(narrow))
    }

    fn splat_features(&self, features: &[f32], channels: usize) -> Result<Vec<f32>, RasterError> {
        check_channels(channels)?;
        check_length("features", features.len(), self.splats.len().checked_mul(channels))?;
        Ok(self.splat_features(&wide(features), channels).into_iter().map(narrow).collect())
    }

    fn gather_features(&self, pixels: &[f32], channels: usize) -> Result<Vec<f32>, RasterError> {
        check_channels(channels)?;
        check_length("pixels", pixels.len(), self.view.pixel_count().checked_mul(channels))?;
        Ok(self.gather_features(&wide(pixels), channels).into_iter().map(narrow).collect())
    }

    fn backward(&self, drawing: &Drawing, gradient: &DrawingGradient) -> Result<SplatGradients, RasterError> {
        drawing.check(&self.view)?;
        let SplatGradients { by, means_ndc, visible } = self.backward(&gradient.map(f64::from))?;
        let means_ndc = means_ndc.into_iter().map(|row| row.map(narrow)).collect();
        Ok(SplatGradients { by: by.map(narrow), means_ndc, visible })
    }
}

fn wide(list: &[f32]) -> Vec<f64> {
    list.iter().copied().map(f64::from).collect()
}

fn narrow(value: f64) -> f32 {
    value as f32
}

#[cfg(test)]
mod tests;
