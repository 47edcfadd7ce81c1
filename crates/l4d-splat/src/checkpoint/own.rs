//! Our own checkpoint: numbers as safetensors, everything else as JSON.
//!
//! ```text
//! <folder>/checkpoint.json
//! <folder>/splats-<digest>.safetensors
//! ```

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::store::read_bounded;
use l4d_data::{DataError, Name, Profile, json};
use serde::{Deserialize, Serialize};

use l4d_formats::fault::quoted;
use l4d_formats::tensor::element_count;
use l4d_formats::tensor_file::{Column, Found, TensorFile, TensorFileKind};
use l4d_formats::{Fault, Tensor};

use super::{MAX_BYTES, build_field, check_gaussians};
use crate::deform::{DeformConfig, DeformationField};
use crate::gaussians::{FIELDS, Gaussians, ShDegree};
use crate::model::Model;

/// The file that makes a folder a checkpoint.
pub const CARD: &str = "checkpoint.json";

/// No `checkpoint.json` is longer, bytes: the state of training takes a few thousand.
const MAX_CARD_BYTES: u64 = 4 << 20;

const HINT: &str = "copy the whole checkpoint folder again, or train again";

const KIND: TensorFileKind = TensorFileKind {
    card: CARD,
    stem: "splats",
    whole: "a checkpoint",
    // A model's takes about 10 000.
    longest_header: 1 << 20,
    longest_file: MAX_BYTES,
    hint: HINT,
};

/// Names of the tensors, or what they begin with.
const GAUSSIANS: &str = "gaussians/";
const DYNAMIC: &str = "dynamic";
const DEFORMATION: &str = "deformation/";
const TRAINING: &str = "training/";

/// A model, where it comes from, and how far its training got.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Checkpoint {
    pub model: Model,
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

/// Schema tag of a checkpoint.
pub(crate) const SCHEMA: &str = "l4d/splats/1";

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Card {
    schema: String,
    scene: Option<Name>,
    profile: Option<Profile>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    sampling: Option<Sampling>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    saw_depth: Option<bool>,
    iteration: u64,
    gaussians: usize,
    dynamic: usize,
    sh_degree: u8,
    deformation: Option<DeformConfig>,
    tensors: TensorFile,
    inputs: BTreeMap<String, String>,
    training: serde_json::Map<String, serde_json::Value>,
}

impl Card {
    /// Refuses what no checkpoint says; gives the degree of the harmonics.
    fn check(&self) -> Result<ShDegree, Fault> {
        if self.schema != SCHEMA {
            let message = format!("is {}, but this l4d reads `{SCHEMA}`", quoted(&self.schema));
            return Err(Fault::new(
                "field `schema`",
                message,
                "read the checkpoint with the l4d that wrote it",
            ));
        }
        KIND.check(&self.tensors)?;
        ShDegree::new(self.sh_degree).ok_or_else(|| {
            Fault::new("field `sh_degree`", format!("is {}, but degrees end at 3", self.sh_degree), HINT)
        })
    }
}

/// Writes a checkpoint into a folder, in place of the one that is there.
///
/// # Errors
/// Lists of several lengths, numbers that are not finite, and what the disk refuses.
pub fn write(folder: &Path, checkpoint: &Checkpoint) -> Result<(), DataError> {
    check(checkpoint).map_err(|fault| fault.at(&folder.join(CARD)))?;
    let model = &checkpoint.model;
    let field = model.field.as_ref().map(DeformationField::tensors).unwrap_or_default();
    let dynamic = Column::U32(vec![model.dynamic.len()], Cow::Borrowed(&model.dynamic));
    let mut columns = vec![(DYNAMIC.to_owned(), dynamic)];
    let shapes = shapes(model.gaussians.len(), model.gaussians.sh_degree);
    for ((field, shape), list) in FIELDS.into_iter().zip(shapes).zip(model.gaussians.flat()) {
        columns.push((format!("{GAUSSIANS}{field}"), Column::F32(shape, Cow::Borrowed(list))));
    }
    for (prefix, tensors) in [(TRAINING, &checkpoint.training.tensors), (DEFORMATION, &field)] {
        columns.extend(tensors.iter().map(|(name, tensor)| {
            (format!("{prefix}{name}"), Column::F32(tensor.shape.clone(), Cow::Borrowed(&tensor.data)))
        }));
    }
    KIND.write(folder, columns, |tensors| Card {
        schema: SCHEMA.to_owned(),
        scene: checkpoint.scene.clone(),
        profile: checkpoint.profile,
        sampling: checkpoint.sampling,
        saw_depth: checkpoint.saw_depth,
        iteration: checkpoint.iteration,
        gaussians: model.gaussians.len(),
        dynamic: model.dynamic.len(),
        sh_degree: model.gaussians.sh_degree.get(),
        deformation: model.field.as_ref().map(|field| field.config().clone()),
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
    Ok(read_card(folder)?.0.saw_depth)
}

fn read_card(folder: &Path) -> Result<(Card, ShDegree), DataError> {
    let path = folder.join(CARD);
    let card: Card = json::parse(&path, None, &read_bounded(&path, MAX_CARD_BYTES)?)?;
    let degree = card.check().map_err(|fault| fault.at(&path))?;
    Ok((card, degree))
}

fn decode(card: Card, degree: ShDegree, bytes: &[u8]) -> Result<Checkpoint, Fault> {
    let mut found = KIND.found(bytes)?;
    let gaussians = gaussians(&mut found, card.gaussians, degree)?;
    let dynamic = found.u32(DYNAMIC, &[card.dynamic])?;
    let field_tensors = found.below(DEFORMATION)?;
    let training_tensors = found.below(TRAINING)?;
    found.finish()?;
    let field = match card.deformation {
        Some(config) => Some(build_field(config, &field_tensors)?),
        None if field_tensors.is_empty() => None,
        None => {
            return Err(Fault::new("field `deformation`", "is null, but the tensors hold a field", HINT));
        }
    };
    let checkpoint = Checkpoint {
        model: Model { gaussians, dynamic, field, moments: Vec::new() },
        iteration: card.iteration,
        scene: card.scene,
        profile: card.profile,
        sampling: card.sampling,
        saw_depth: card.saw_depth,
        inputs: card.inputs,
        training: Training { tensors: training_tensors, values: card.training },
    };
    check(&checkpoint)?;
    Ok(checkpoint)
}

/// Of the lists of Gaussians.
fn shapes(count: usize, degree: ShDegree) -> [Vec<usize>; 5] {
    [vec![count, 3], vec![count, 3], vec![count, 4], vec![count], vec![count, degree.coefficients(), 3]]
}

fn gaussians(found: &mut Found<'_>, count: usize, degree: ShDegree) -> Result<Gaussians, Fault> {
    let mut lists = FIELDS.into_iter().zip(shapes(count, degree));
    let mut list = || match lists.next() {
        Some((field, shape)) => found.f32(&format!("{GAUSSIANS}{field}"), &shape),
        None => Ok(Vec::new()),
    };
    Ok(Gaussians {
        sh_degree: degree,
        means: rows(list()?),
        log_scales: rows(list()?),
        rotations: rows(list()?),
        opacity_logits: list()?,
        sh: rows(list()?),
    })
}

fn rows<const N: usize>(numbers: Vec<f32>) -> Vec<[f32; N]> {
    numbers.as_chunks::<N>().0.to_vec()
}

/// What holds for every checkpoint, read or written. A field checks itself when it is built.
fn check(checkpoint: &Checkpoint) -> Result<(), Fault> {
    let Model { gaussians, dynamic, field, moments } = &checkpoint.model;
    if !moments.is_empty() {
        let message = "has other times than the clip, which this format cannot say";
        return Err(Fault::new("model", message, "keep the files of the program that trained it"));
    }
    check_gaussians(gaussians)?;
    let count = gaussians.len();
    let fault = |message: String| Fault::new("field `dynamic`", message, HINT);
    if let Some(pair) = dynamic.windows(2).find(|pair| pair[0] >= pair[1]) {
        return Err(fault(format!("has {} before {}, but the list ascends", pair[0], pair[1])));
    }
    if let Some(beyond) = dynamic.last().filter(|&&last| last as usize >= count) {
        return Err(fault(format!("names Gaussian {beyond}, but there are {count}")));
    }
    if field.is_none() && !dynamic.is_empty() {
        return Err(fault("says that Gaussians move, but there is no deformation field".to_owned()));
    }
    for (name, tensor) in &checkpoint.training.tensors {
        if element_count(&tensor.shape) != Some(tensor.data.len()) {
            let message = format!("has {} numbers for the shape {:?}", tensor.data.len(), tensor.shape);
            return Err(Fault::new(quoted(name), message, HINT));
        }
        tensor.check_finite(&quoted(name))?;
    }
    Ok(())
}
