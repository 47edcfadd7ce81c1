//! What an answer is lifted onto: a model, and how it is drawn.
//!
//! Owns the states of the model without colours, which no lift looks at. Refuses to know what an answer is.

use std::sync::Arc;

use l4d_splat::gaussians::ShDegree;
use l4d_splat::raster::{RasterSettings, Rasterizer};
use l4d_splat::splats::{SplatParts, Splats};
use l4d_splat::{Model, model::ModelError};

use super::error::LiftError;
use super::model_states::ModelStates;

/// A model and what draws it.
#[derive(Clone, Copy)]
pub struct Canvas<'a> {
    /// What the answer is about.
    pub model: &'a Model,
    /// What draws it.
    pub rasterizer: &'a dyn Rasterizer,
    /// How; background and quantiles do not matter.
    pub raster: &'a RasterSettings,
    /// States of the model that others have worked out, or will want; none to work out all of them anew.
    pub states: Option<&'a ModelStates>,
}

impl Canvas<'_> {
    /// The model at a time from 0 to 1.
    ///
    /// # Errors
    /// A time outside the clip, and a model without a state at it.
    pub fn at(&self, time: f32) -> Result<Splats, LiftError> {
        check_time(time)?;
        self.model.at(time).map_err(|source| LiftError::Model { time, source })
    }

    /// The model at a time without its colours: a fifth of the memory, and all that masks are made of.
    ///
    /// # Errors
    /// As [`Self::at`].
    pub fn shapes_at(&self, time: f32) -> Result<Arc<Splats>, LiftError> {
        match self.states {
            Some(states) => states.get(time, || self.work_out_shapes(time)),
            None => self.work_out_shapes(time).map(Arc::new),
        }
    }

    fn work_out_shapes(&self, time: f32) -> Result<Splats, LiftError> {
        let parts = self.at(time)?.into_parts();
        let sh = vec![[0.0; 3]; parts.means.len()];
        Splats::new(SplatParts { sh_degree: ShDegree::ZERO, sh, ..parts })
            .map_err(|source| LiftError::Model { time, source: ModelError::Splat(source) })
    }
}

/// Whether a time lies in the clip.
pub(super) fn check_time(time: f32) -> Result<(), LiftError> {
    if (0.0..=1.0).contains(&time) { Ok(()) } else { Err(LiftError::Time { time }) }
}
