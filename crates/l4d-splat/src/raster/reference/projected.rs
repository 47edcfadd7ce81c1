//! The reference behind the contract of all rasterizers: `f32` outside, its own width inside.

use super::ReferenceScene;
use crate::raster::{
    Contribution, DepthQuantiles, Drawing, DrawingGradient, Projected, RasterError, check_channels,
    check_length, check_pixel,
};
use crate::real::Real;
use crate::splats::SplatGradients;

impl<F: Real> Projected for ReferenceScene<F> {
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
        Ok(list
            .into_iter()
            .map(|(index, weight)| Contribution { index: index as u32, weight: weight.narrow() })
            .collect())
    }

    fn radii_px(&self) -> Result<Vec<f32>, RasterError> {
        Ok(narrow(&self.radii()))
    }

    fn backward(&self, drawing: &Drawing, gradient: &DrawingGradient) -> Result<SplatGradients, RasterError> {
        drawing.check(&self.view)?;
        let gradients = self.backward(&gradient.cast())?;
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

fn wide<F: Real>(list: &[f32]) -> Vec<F> {
    list.iter().map(|&value| F::of(value.into())).collect()
}

fn narrow<F: Real>(list: &[F]) -> Vec<f32> {
    list.iter().map(|value| value.narrow()).collect()
}

fn narrow_rows<F: Real, const N: usize>(list: &[[F; N]]) -> Vec<[f32; N]> {
    list.iter().map(|row| row.map(Real::narrow)).collect()
}
