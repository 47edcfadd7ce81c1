//! An answer as a part of a scene: which Gaussians, at which times. Asked for a time it gives a [`Layer`], and with that
//! masks from any camera.
//!
//! ```text
//! <folder>/lift.json
//! <folder>/lift-<digest>.safetensors
//! ```

use std::borrow::Cow;
use std::path::Path;

use l4d_data::DataError;
use l4d_data::digest::RunningDigest;
use l4d_formats::Tensor;
use l4d_formats::tensor_file::{Column, TensorFile, TensorFileKind};
use l4d_masks::Mask;
use l4d_splat::Model;
use l4d_splat::raster::Projected;
use l4d_splat::view::View;
use serde::Serialize;

use super::error::LiftError;
use super::field::Network;
use super::labels::Labels;
use super::rendered_model::{RenderedModel, check_time};

/// Schema tag of `lift.json`.
const SCHEMA: &str = "l4d/lift/1";

const FILES: TensorFileKind = TensorFileKind {
    card: "lift.json",
    stem: "lift",
    whole: "an answer",
    // An answer's takes about a thousand.
    longest_header: 1 << 16,
    longest_file: 4 << 30,
    hint: "lift the answer again",
};

/// An answer over Gaussians and time. It means nothing for another model than the one that it was lifted onto.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// A label a Gaussian.
    Labels(Labels),
    /// A network that is asked for each Gaussian.
    Field(Box<Network>),
}

/// What an answer says of the Gaussians at a time. Drawing it is a blend of one channel (paper, equation 3).
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// One a Gaussian. Their blend says what a pixel shows.
    pub values: Vec<f32>,
    /// Pixels whose blend lies above this belong to the answer.
    pub cut: f32,
}

#[derive(Serialize)]
struct Card {
    schema: &'static str,
    model: ModelDigest,
    answer: Kind,
    tensors: TensorFile,
}

/// What tells a model from all others.
#[derive(Serialize)]
struct ModelDigest {
    gaussians: usize,
    /// SHA-256 of all numbers of the model, little-endian, in the order of its fields.
    sha256: String,
}

#[derive(Serialize)]
#[serde(rename_all = "kebab-case")]
enum Kind {
    Labels { times: usize, states: usize },
    Field { width: usize, features: usize },
}

impl Answer {
    /// The answer at a time from 0 to 1, to be drawn from any number of cameras.
    ///
    /// # Errors
    /// A time outside the clip.
    pub fn layer_at(&self, model: &Model, time: f32) -> Result<Layer, LiftError> {
        check_time(time)?;
        Ok(match self {
            Self::Labels(labels) => labels.layer(time),
            Self::Field(network) => network.layer(&model.gaussians.means, time),
        })
    }

    /// The pixels of the answer for a camera at a time from 0 to 1.
    ///
    /// # Errors
    /// As [`Self::layer_at`], and what the rasterizer refuses.
    pub fn mask(&self, rendered: &RenderedModel<'_>, view: &View, time: f32) -> Result<Mask, LiftError> {
        let layer = self.layer_at(rendered.model, time)?;
        let splats = rendered.shapes_at(time)?;
        let projected = rendered.rasterizer.prepare(&splats, view, rendered.raster)?;
        layer.mask(projected.as_ref(), view)
    }

    /// Writes the answer into a folder, in place of the one that is there.
    ///
    /// # Errors
    /// What the disk refuses.
    pub fn write(&self, folder: &Path, model: &Model) -> Result<(), DataError> {
        let (answer, columns) = match self {
            Self::Labels(labels) => {
                let (times, states) = (labels.times.len(), labels.states.len());
                (Kind::Labels { times, states }, columns_of(labels))
            }
            Self::Field(network) => {
                let (width, features) = network.sizes();
                let column = |(name, tensor): (&str, Tensor)| {
                    (name.to_owned(), Column::F32(tensor.shape, Cow::Owned(tensor.data)))
                };
                (Kind::Field { width, features }, network.tensors().into_iter().map(column).collect())
            }
        };
        let model = ModelDigest::of(model);
        FILES.write(folder, columns, |tensors| Card { schema: SCHEMA, model, answer, tensors })
    }
}

fn columns_of(labels: &Labels) -> Vec<(String, Column<'_>)> {
    let gaussians = labels.states.first().map_or(0, Vec::len);
    let (times, states) = (labels.times.len(), labels.states.len());
    let columns = [
        ("times", Column::F32(vec![times], Cow::Borrowed(&labels.times))),
        ("state_of", Column::U32(vec![times], Cow::Borrowed(&labels.state_of))),
        ("states", Column::F32(vec![states, gaussians], Cow::Owned(labels.states.concat()))),
        ("threshold", Column::F32(vec![1], Cow::Owned(vec![labels.threshold]))),
    ];
    columns.into_iter().map(|(name, column)| (name.to_owned(), column)).collect()
}

impl ModelDigest {
    fn of(model: &Model) -> Self {
        let mut digest = RunningDigest::default();
        let mut add = |numbers: &[f32]| {
            digest.add(&(numbers.len() as u64).to_le_bytes());
            let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
            digest.add(&bytes);
        };
        let gaussians = &model.gaussians;
        add(gaussians.means.as_flattened());
        add(gaussians.log_scales.as_flattened());
        add(gaussians.rotations.as_flattened());
        add(&gaussians.opacity_logits);
        add(gaussians.sh.as_flattened());
        for tensor in model.field.iter().flat_map(|field| field.tensors().into_values()) {
            add(&tensor.data);
        }
        let moving: Vec<u8> = model.dynamic.iter().flat_map(|index| index.to_le_bytes()).collect();
        digest.add(&moving);
        Self { gaussians: gaussians.len(), sha256: digest.hex() }
    }
}

impl Layer {
    /// The pixels of the answer in one view.
    ///
    /// # Errors
    /// A layer of other Gaussians than those that are drawn.
    pub fn mask(&self, projected: &dyn Projected, view: &View) -> Result<Mask, LiftError> {
        let blend = projected.splat_features(&self.values, 1)?;
        let width = view.width() as usize;
        Ok(Mask::from_fn(view.width(), view.height(), |column, row| {
            let pixel = row as usize * width + column as usize;
            blend.get(pixel).is_some_and(|&value| value > self.cut)
        }))
    }
}
