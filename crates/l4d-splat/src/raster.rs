//! Rasterization of splats, forward and backward.
//!
//! Owns the contract that every rasterizer keeps ([`Rasterizer`], [`Projected`]) and two that keep it on the CPU:
//! [`Reference`] is the equations written out, [`Cpu`] is fast. Anisotropic Gaussians are projected with the local
//! affine approximation (EWA), ordered by depth and blended front to back: C = sum over i of c_i a_i T_i with
//! T_i the product of (1 - a_j) over all j in front (paper, section 4, equation of C(v,t)).

mod cpu;
mod drawing;
mod reference;
mod settings;
mod sh;

pub use cpu::Cpu;
pub use drawing::{DepthQuantiles, Drawing, DrawingGradient};
pub use reference::{Reference, ReferenceScene};
pub use settings::RasterSettings;

use crate::gaussians::BadValue;
use crate::splats::{SplatGradients, Splats};
use crate::view::View;

/// Side of the square tiles to which Gaussians are assigned, pixels.
pub const TILE: usize = 16;

/// Colours and depths beyond this are refused as overflowing: f32 could not hold the products that a gradient is
/// made of.
const LARGEST: f32 = 1e30;

/// Something that draws splats.
pub trait Rasterizer: Send + Sync {
    /// What it is and on what it runs, for manifests and tables.
    fn name(&self) -> String;

    /// Projects and orders the splats once, for everything that is then asked about one picture.
    ///
    /// # Errors
    /// Settings out of range, a Gaussian that overflows in this view, and what the backend reports.
    fn prepare<'a>(
        &'a self,
        splats: &'a Splats,
        view: &View,
        settings: &RasterSettings,
    ) -> Result<Box<dyn Projected + 'a>, RasterError>;

    /// As [`Self::prepare`], for a caller that looks at some pixels alone, marked row-major. A rasterizer may leave
    /// the others empty (as if there were no splats) and count Gaussians that show in none of the marked as not
    /// visible; the marked pixels, and what their gradients say, are the same.
    ///
    /// # Errors
    /// As [`Self::prepare`], and a list of another length than the picture.
    fn prepare_marked<'a>(
        &'a self,
        splats: &'a Splats,
        view: &View,
        settings: &RasterSettings,
        marked: &[bool],
    ) -> Result<Box<dyn Projected + 'a>, RasterError> {
        check_length("marked pixels", marked.len(), Some(view.pixel_count()))?;
        self.prepare(splats, view, settings)
    }
}

/// Splats as one view sees them. Pixels are row-major; per-Gaussian results are in the order of the splats.
pub trait Projected: Send + Sync {
    /// Colour, accumulated alpha and depths.
    ///
    /// # Errors
    /// What the backend reports.
    fn draw(&self) -> Result<Drawing, RasterError>;

    /// Blends any numbers that the Gaussians carry, as colours are blended, without a background: A s.
    /// `features` holds `channels` numbers per Gaussian; the result as many per pixel.
    ///
    /// # Errors
    /// Features of another length, too many channels, and what the backend reports.
    fn splat_features(&self, features: &[f32], channels: usize) -> Result<Vec<f32>, RasterError>;

    /// The transpose of [`Self::splat_features`]: A^T m, for each Gaussian the sum over pixels of its blend weight times
    /// what `pixels` holds there, `channels` numbers each.
    ///
    /// # Errors
    /// Pixels of another length, too many channels, and what the backend reports.
    fn gather_features(&self, pixels: &[f32], channels: usize) -> Result<Vec<f32>, RasterError>;

    /// Derivatives of a loss by the splats, given those by the picture. `drawing` is what [`Self::draw`] gave.
    ///
    /// # Errors
    /// A drawing or gradient of another size, and what the backend reports.
    fn backward(&self, drawing: &Drawing, gradient: &DrawingGradient) -> Result<SplatGradients, RasterError>;

    /// As [`Self::backward`] for those Gaussians that `trainable` marks; the derivatives by all others are left at zero.
    ///
    /// # Errors
    /// As [`Self::backward`], and a list of another length than the splats.
    fn backward_for(
        &self,
        drawing: &Drawing,
        gradient: &DrawingGradient,
        trainable: &[bool],
    ) -> Result<SplatGradients, RasterError> {
        let mut gradients = self.backward(drawing, gradient)?;
        check_length("trainable Gaussians", trainable.len(), Some(gradients.visible.len()))?;
        gradients.clear_all_but(trainable);
        Ok(gradients)
    }
}

/// Why nothing was drawn.
#[derive(Debug, thiserror::Error)]
pub enum RasterError {
    /// A setting, list or pixel that does not fit, or more work than any picture is worth: what, and the hint.
    #[error("{0}")]
    Invalid(String),
    /// A Gaussian whose projection overflows.
    #[error("{0}, which overflows in this view: mend the value or remove the Gaussian")]
    Overflow(BadValue),
    /// The backend failed.
    #[error("rasterizer {rasterizer} failed")]
    Backend {
        /// Name of the rasterizer.
        rasterizer: String,
        /// What it met.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
}

/// Channels that can be splatted at once.
const MOST_CHANNELS: usize = 1 << 12;

/// Whether so many channels can be splatted: without splats, a list of any number of channels has the right length.
fn check_channels(channels: usize) -> Result<(), RasterError> {
    if channels <= MOST_CHANNELS {
        Ok(())
    } else {
        Err(RasterError::Invalid(format!(
            "channels: {channels} where at most {MOST_CHANNELS} can be splatted"
        )))
    }
}

/// Whether a list has the length that was asked for.
///
/// # Errors
/// Another length.
pub fn check_length(what: &str, found: usize, expected: Option<usize>) -> Result<(), RasterError> {
    // An expectation that overflows is met by no list.
    let expected = expected.unwrap_or(usize::MAX);
    if found == expected {
        return Ok(());
    }
    Err(RasterError::Invalid(format!("{what}: {found} numbers where {expected} are needed")))
}
