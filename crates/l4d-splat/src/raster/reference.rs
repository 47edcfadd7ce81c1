//! The slow rasterizer: the equations written out in f64, one pixel and one Gaussian at a time.
//!
//! The specification that other rasterizers are measured against. Two forms differ from the textbook to keep digits:
//! the determinant of a projected covariance is a sum of squares, and the exponent has its square completed.

mod blend;
mod projection;

use super::{
    Contribution, DepthQuantiles, Drawing, DrawingGradient, Projected, RasterError, RasterSettings,
    Rasterizer, TILE, check_channels, check_length, check_pixel,
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
        let drawing = self.draw();
        Ok(Drawing {
            width: drawing.width,
            height: drawing.height,
            colour: narrow_rows(&drawing.colour),
            alpha: narrow(&drawing.alpha),
            transmittance: narrow(&drawing.transmittance),
            depth_sum_m: narrow(&drawing.depth_sum_m),
            quantiles: drawing.quantiles.map(|quantiles| DepthQuantiles {
                near_m: narrow(&quantiles.near_m),
                median_m: narrow(&quantiles.median_m),
                far_m: narrow(&quantiles.far_m),
            }),
        })
    }

    fn splat_features(&self, features: &[f32], channels: usize) -> Result<Vec<f32>, RasterError> {
        check_channels(channels)?;
        check_length("features", features.len(), self.splats.len().checked_mul(channels))?;
        Ok(narrow(&self.splat_features(&wide(features), channels)))
    }

    fn gather_features(&self, pixels: &[f32], channels: usize) -> Result<Vec<f32>, RasterError> {
        check_channels(channels)?;
        check_length("pixels", pixels.len(), self.view.pixel_count().checked_mul(channels))?;
        Ok(narrow(&self.gather_features(&wide(pixels), channels)))
    }

    fn contributors(&self, column: u32, row: u32) -> Result<Vec<Contribution>, RasterError> {
        check_pixel(&self.view, column, row)?;
        let list = self.contributors(column as usize, row as usize);
        let narrow = |(index, weight)| Contribution { index: index as u32, weight: weight as f32 };
        Ok(list.into_iter().map(narrow).collect())
    }

    fn radii_px(&self) -> Result<Vec<f32>, RasterError> {
        let mut radii = vec![0.0; self.splats.len()];
        for gaussian in &self.gaussians {
            radii[gaussian.index] = gaussian.radius as f32;
        }
        Ok(radii)
    }

    fn backward(&self, drawing: &Drawing, gradient: &DrawingGradient) -> Result<SplatGradients, RasterError> {
        drawing.check(&self.view)?;
        let gradients = self.backward(&gradient.to_f64())?;
        Ok(SplatGradients {
            means: narrow_rows(&gradients.means),
            scales: narrow_rows(&gradients.scales),
            rotations: narrow_rows(&gradients.rotations),
            opacities: narrow(&gradients.opacities),
            sh: narrow_rows(&gradients.sh),
            means_ndc: narrow_rows(&gradients.means_ndc),
            visible: gradients.visible,
        })
    }
}

fn wide(list: &[f32]) -> Vec<f64> {
    list.iter().copied().map(f64::from).collect()
}

fn narrow(list: &[f64]) -> Vec<f32> {
    list.iter().map(|&value| value as f32).collect()
}

fn narrow_rows<const N: usize>(list: &[[f64; N]]) -> Vec<[f32; N]> {
    list.iter().map(|row| row.map(|value| value as f32)).collect()
}

#[cfg(test)]
mod tests;
