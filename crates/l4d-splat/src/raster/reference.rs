//! The slow rasterizer: the equations written out, one pixel and one Gaussian at a time, in f32 or f64.
//!
//! It is the specification that other rasterizers are measured against, so it owns the order of all tests and takes
//! the shortest way to every number, never the fastest. Two forms differ from the textbook, for digits alone: the
//! determinant of a projected covariance is a sum of squares (no difference of two large products), and the exponent
//! has its square completed (so that it cannot come out positive).

mod blend;
mod matrix;
mod projected;
mod projection;

use std::marker::PhantomData;

use super::{Projected, RasterError, RasterSettings, Rasterizer, TILE};
use crate::real::Real;
use crate::splats::Splats;
use crate::view::View;
use projection::{ProjectedGaussian, Projection};

/// Draws by the book, computing in `F`.
#[derive(Debug, Clone, Copy, Default)]
pub struct Reference<F> {
    width: PhantomData<F>,
}

impl<F: Real> Reference<F> {
    /// A reference rasterizer.
    pub fn new() -> Self {
        Self { width: PhantomData }
    }

    /// Projects splats, keeping the width of their numbers: for central differences and exact comparisons.
    pub fn scene(
        &self,
        splats: &Splats<F>,
        view: &View,
        settings: &RasterSettings,
    ) -> Result<ReferenceScene<F>, RasterError> {
        settings.check()?;
        let projection = Projection::new(view, settings);
        let mut gaussians = Vec::new();
        for index in 0..splats.len() {
            gaussians.extend(projection.project(splats, index).map_err(RasterError::Overflow)?);
        }
        // Stable: equal depths keep the order of their indices. The key is an f32 at any width, so that widths agree
        // on the order.
        gaussians.sort_by(|a, b| a.depth.narrow().total_cmp(&b.depth.narrow()));
        let columns = (view.width() as usize).div_ceil(TILE);
        let rows = (view.height() as usize).div_ceil(TILE);
        let mut tiles = vec![Vec::new(); columns * rows];
        for (rank, gaussian) in gaussians.iter().enumerate() {
            for row in gaussian.tiles.rows.clone() {
                for column in gaussian.tiles.columns.clone() {
                    tiles[row * columns + column].push(rank);
                }
            }
        }
        Ok(ReferenceScene {
            splats: splats.clone(),
            view: *view,
            settings: *settings,
            projection,
            gaussians,
            tiles,
            columns,
        })
    }
}

/// Splats as the reference sees them from one view.
#[derive(Debug, Clone)]
pub struct ReferenceScene<F> {
    splats: Splats<F>,
    view: View,
    settings: RasterSettings,
    projection: Projection<F>,
    /// Visible Gaussians, front to back.
    gaussians: Vec<ProjectedGaussian<F>>,
    /// Positions in `gaussians` of the Gaussians of each tile, front to back; tiles row-major.
    tiles: Vec<Vec<usize>>,
    /// Tiles in a row.
    columns: usize,
}

impl<F: Real> Rasterizer for Reference<F> {
    fn name(&self) -> String {
        format!("reference in f{}", 8 * size_of::<F>())
    }

    fn prepare<'a>(
        &'a self,
        splats: &'a Splats,
        view: &View,
        settings: &RasterSettings,
    ) -> Result<Box<dyn Projected + 'a>, RasterError> {
        Ok(Box::new(self.scene(&splats.cast(), view, settings)?))
    }
}

#[cfg(test)]
mod tests;
