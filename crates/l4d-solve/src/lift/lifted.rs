//! An answer as a part of a scene: which Gaussians, at which times.
//!
//! Owns what is common to all kinds of answers: asked for a time it gives a [`Layer`], and with that masks from any
//! camera. Refuses to know how it was found.

use l4d_masks::Mask;
use l4d_splat::Model;
use l4d_splat::view::View;

use super::canvas::{Canvas, check_time};
use super::digest::ModelDigest;
use super::error::LiftError;
use super::field::Field;
use super::labels::Labels;
use super::layer::Layer;

/// What lifting gives.
#[derive(Debug, Clone, PartialEq)]
pub struct Lifted {
    /// The model that the answer belongs to.
    pub model: ModelDigest,
    /// What was found.
    pub answer: Answer,
}

/// An answer over Gaussians and time.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// A label a Gaussian.
    Labels(Labels),
    /// A network that is asked for each Gaussian.
    Field(Box<Field>),
}

impl Lifted {
    /// The answer at a time from 0 to 1, to be drawn from any number of cameras.
    ///
    /// # Errors
    /// A time outside the clip; another model than the answer belongs to, as far as its size tells (the full check is
    /// [`Self::check_model`]).
    pub fn layer_at(&self, model: &Model, time: f32) -> Result<Layer, LiftError> {
        check_time(time)?;
        if model.gaussians.len() != self.model.gaussians {
            self.model.check(model)?;
        }
        match &self.answer {
            Answer::Labels(labels) => Ok(labels.layer(time)),
            Answer::Field(field) => Ok(field.layer(&model.gaussians.means, time)),
        }
    }

    /// The pixels of the answer for a camera at a time from 0 to 1.
    ///
    /// # Errors
    /// As [`Self::layer_at`], and what the rasterizer refuses.
    pub fn mask(&self, canvas: &Canvas<'_>, view: &View, time: f32) -> Result<Mask, LiftError> {
        let layer = self.layer_at(canvas.model, time)?;
        let splats = canvas.shapes_at(time)?;
        let projected = canvas.rasterizer.prepare(&splats, view, canvas.raster)?;
        layer.mask(projected.as_ref(), view)
    }

    /// What it consists of, for logs and tables.
    pub fn describe(&self) -> String {
        match &self.answer {
            Answer::Labels(labels) => {
                format!("{} states, threshold {}", labels.states.len(), labels.threshold)
            }
            Answer::Field(field) => format!("a field, read out as {:?}", field.read_out),
        }
    }

    /// Refuses any model but the one that the answer was lifted onto.
    ///
    /// # Errors
    /// Another model.
    pub fn check_model(&self, model: &Model) -> Result<(), LiftError> {
        self.model.check(model)
    }
}
