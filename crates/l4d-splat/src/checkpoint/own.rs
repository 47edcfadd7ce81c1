//! Our own checkpoint: numbers as safetensors, everything else as JSON.
//!
//! ```text
//! <folder>/checkpoint.json
//! <folder>/splats-<digest>.safetensors
//! ```

mod card;
mod tensors;

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::store::read_bounded;
use l4d_data::{DataError, Name, Profile, json};
use serde::{Deserialize, Serialize};

use l4d_formats::fault::quoted;
use l4d_formats::tensor::element_count;
use l4d_formats::tensor_file::TensorFileKind;
use l4d_formats::{Fault, Tensor};

use super::{MAX_BYTES, build_field, check_gaussians};
use crate::deform::DeformationField;
use crate::gaussians::{Gaussians, ShDegree};
use card::Card;

pub use card::SCHEMA;

/// The file that makes a folder a checkpoint.
pub const CARD: &str = "checkpoint.json";

/// No `checkpoint.json` is longer, bytes: the state of training takes a few thousand.
const MAX_CARD_BYTES: u64 = 4 << 20;

const REMEDY: &str = "copy the whole checkpoint folder again, or train again";

const KIND: TensorFileKind = TensorFileKind {
    card: CARD,
    stem: "splats",
    whole: "a checkpoint",
    // A model's takes about 10 000.
    longest_header: 1 << 20,
    longest_file: MAX_BYTES,
    remedy: REMEDY,
};

/// A model, where it comes from, and how far its training got.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Checkpoint {
    /// The canonical Gaussians.
    pub gaussians: Gaussians,
    /// The Gaussians that go through the field, ascending.
    pub dynamic: Vec<u32>,
    /// The deformation field; none for a scene that does not move.
    pub field: Option<DeformationField>,
    /// Steps of training so far.
    pub iteration: u64,
    /// Scene of the benchmark, where there is one.
    pub scene: Option<Name>,
    /// Profile of the training pictures, where there is one.
    pub profile: Option<Profile>,
    /// Which pictures were trained on; none for the pictures of a profile, and where it is not known.
    pub sampling: Option<Sampling>,
    /// Whether rendered depth of the training views was looked at; none where it is not known.
    pub saw_depth: Option<bool>,
    /// SHA-256 of what the model was made from, by name.
    pub inputs: BTreeMap<String, String>,
    /// What training needs to go on.
    pub training: Training,
}

/// Which pictures of a capture a model is trained on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sampling {
    /// Pixels on either side of a square that becomes one; what does not fill a square at the right and lower border is
    /// left out.
    pub shrink: u32,
    /// Every so many moments one, from the first on.
    pub every: u32,
}

impl Sampling {
    /// All of every picture.
    pub const WHOLE: Self = Self { shrink: 1, every: 1 };

    /// Width and height of shrunk pictures, and of what of the whole ones they show, pixels.
    pub fn sizes(self, [width, height]: [u32; 2]) -> ([u32; 2], [u32; 2]) {
        let shrink = self.shrink.max(1);
        let small = [width / shrink, height / shrink];
        (small, small.map(|side| side * shrink))
    }

    /// The moments that are taken.
    pub fn moments(self, frames: &[u32]) -> Vec<u32> {
        frames.iter().copied().step_by(self.every.max(1) as usize).collect()
    }
}

/// State of training under names that training chooses.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Training {
    /// Moments and the like, to the last bit.
    pub tensors: BTreeMap<String, Tensor>,
    /// Counters, seeds and settings. Decimal text may cost a fraction its last bit: exact numbers belong into `tensors`.
    pub values: serde_json::Map<String, serde_json::Value>,
}

/// Writes a checkpoint into a folder, in place of the one that is there.
///
/// # Errors
/// Lists of several lengths, numbers that are not finite, and what the disk refuses.
pub fn write(folder: &Path, checkpoint: &Checkpoint) -> Result<(), DataError> {
    check(checkpoint).map_err(|fault| fault.at(&folder.join(CARD)))?;
    let field = checkpoint.field.as_ref().map(DeformationField::tensors).unwrap_or_default();
    let mut columns = tensors::columns(checkpoint);
    columns.extend(tensors::named(tensors::DEFORMATION, &field));
    KIND.write(folder, columns, |tensors| Card {
        schema: SCHEMA.to_owned(),
        scene: checkpoint.scene.clone(),
        profile: checkpoint.profile,
        sampling: checkpoint.sampling,
        saw_depth: checkpoint.saw_depth,
        iteration: checkpoint.iteration,
        gaussians: checkpoint.gaussians.len(),
        dynamic: checkpoint.dynamic.len(),
        sh_degree: checkpoint.gaussians.sh_degree.get(),
        deformation: checkpoint.field.as_ref().map(|field| field.config().clone()),
        tensors,
        inputs: checkpoint.inputs.clone(),
        training: checkpoint.training.values.clone(),
    })
}

/// Reads the checkpoint in a folder.
///
/// # Errors
/// Files that are missing, damaged or do not belong together.
pub fn read(folder: &Path) -> Result<Checkpoint, DataError> {
    let (card, degree) = read_card(folder)?;
    let (path, bytes) = KIND.read(folder, &card.tensors)?;
    decode(card, degree, &bytes).map_err(|fault| fault.at(&path))
}

/// [`Checkpoint::saw_depth`] of the checkpoint in a folder, without its numbers.
///
/// # Errors
/// A card that cannot be read.
pub fn saw_depth(folder: &Path) -> Result<Option<bool>, DataError> {
    Ok(read_card(folder)?.0.saw_depth())
}

fn read_card(folder: &Path) -> Result<(Card, ShDegree), DataError> {
    let path = folder.join(CARD);
    let card: Card = json::parse(&path, None, &read_bounded(&path, MAX_CARD_BYTES)?)?;
    let degree = card.check().map_err(|fault| fault.at(&path))?;
    Ok((card, degree))
}

fn decode(card: Card, degree: ShDegree, bytes: &[u8]) -> Result<Checkpoint, Fault> {
    let mut found = KIND.found(bytes)?;
    let gaussians = tensors::gaussians(&mut found, card.gaussians, degree)?;
    let dynamic = tensors::dynamic(&mut found, card.dynamic)?;
    let saw_depth = card.saw_depth();
    let field_tensors = found.below(tensors::DEFORMATION)?;
    let training_tensors = found.below(tensors::TRAINING)?;
    found.finish()?;
    let field = match card.deformation {
        Some(config) => Some(build_field(config, &field_tensors)?),
        None if field_tensors.is_empty() => None,
        None => {
            return Err(Fault::new("field `deformation`", "is null, but the tensors hold a field", REMEDY));
        }
    };
    let checkpoint = Checkpoint {
        gaussians,
        dynamic,
        field,
        iteration: card.iteration,
        scene: card.scene,
        profile: card.profile,
        sampling: card.sampling,
        saw_depth,
        inputs: card.inputs,
        training: Training { tensors: training_tensors, values: card.training },
    };
    check(&checkpoint)?;
    Ok(checkpoint)
}

/// What holds for every checkpoint, read or written. A field checks itself when it is built.
fn check(checkpoint: &Checkpoint) -> Result<(), Fault> {
    check_gaussians(&checkpoint.gaussians)?;
    let count = checkpoint.gaussians.len();
    let fault = |message: String| Fault::new("field `dynamic`", message, REMEDY);
    if let Some(pair) = checkpoint.dynamic.windows(2).find(|pair| pair[0] >= pair[1]) {
        return Err(fault(format!("has {} before {}, but the list ascends", pair[0], pair[1])));
    }
    if let Some(beyond) = checkpoint.dynamic.last().filter(|&&last| last as usize >= count) {
        return Err(fault(format!("names Gaussian {beyond}, but there are {count}")));
    }
    if checkpoint.field.is_none() && !checkpoint.dynamic.is_empty() {
        return Err(fault("says that Gaussians move, but there is no deformation field".to_owned()));
    }
    for (name, tensor) in &checkpoint.training.tensors {
        if element_count(&tensor.shape) != Some(tensor.data.len()) {
            let message = format!("has {} numbers for the shape {:?}", tensor.data.len(), tensor.shape);
            return Err(Fault::new(quoted(name), message, REMEDY));
        }
        tensor.check_finite(&quoted(name))?;
    }
    Ok(())
}
