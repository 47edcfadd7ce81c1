//! How an answer reaches a folder and comes back.
//!
//! ```text
//! <folder>/lift.json
//! <folder>/lift-<digest>.safetensors
//! ```
//!
//! The JSON names the tensors by their digest and is written last, so that a kill at any moment leaves a folder whose
//! JSON and tensors belong together. Everything that is read is taken as hostile.

mod tensors;

use std::fs;
use std::path::Path;

use l4d_data::digest::sha256_hex;
use l4d_data::store::{list_folder, read_bounded, write_atomic};
use l4d_data::{DataError, json};
use serde::{Deserialize, Serialize};

use super::digest::ModelDigest;
use super::field::{Field, Network, ReadOut};
use super::labels::{Cut, Labels};
use super::lifted::{Answer, Lifted};
use tensors::{Column, Found, encode};

/// The file that makes a folder an answer.
const CARD: &str = "lift.json";
/// Schema tag of an answer.
const SCHEMA: &str = "l4d/lift/1";

/// No card is longer, bytes.
const MAX_CARD_BYTES: u64 = 1 << 16;
/// No file of tensors is longer, bytes.
const MAX_TENSOR_BYTES: u64 = 4 << 30;
/// Layers of a field are no wider than this.
const WIDEST: usize = 4096;

const REMEDY: &str = "lift the answer again, or copy its whole folder";

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Card {
    schema: String,
    model: ModelDigest,
    answer: Kind,
    tensors: TensorsFile,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
enum Kind {
    Labels { times: usize, states: usize, cut: Cut },
    Field { width: usize, features: usize, read_out: ReadOut },
}

#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct TensorsFile {
    file: String,
    bytes: u64,
    sha256: String,
}

impl Lifted {
    /// Writes the answer into a folder, in place of the one that stands there.
    ///
    /// # Errors
    /// What the disk refuses.
    pub fn write(&self, folder: &Path) -> Result<(), DataError> {
        let card_path = folder.join(CARD);
        let (answer, bytes) = match &self.answer {
            Answer::Labels(labels) => (kind_of_labels(labels), encode(columns_of_labels(labels))),
            Answer::Field(field) => (kind_of_field(field), encode(columns_of_field(field))),
        };
        let bytes = bytes.map_err(|message| DataError::invalid(&card_path, "tensors", message, REMEDY))?;
        let sha256 = sha256_hex(&bytes);
        let file = format!("lift-{}.safetensors", sha256.get(..16).unwrap_or(&sha256));
        let tensors = TensorsFile { file: file.clone(), bytes: bytes.len() as u64, sha256 };
        let card = Card { schema: SCHEMA.to_owned(), model: self.model.clone(), answer, tensors };
        write_atomic(&folder.join(&file), &bytes)?;
        json::write(&card_path, &card)?;
        for name in list_folder(folder)? {
            if is_tensors_name(&name) && name != file {
                // A leftover costs room and nothing else.
                fs::remove_file(folder.join(name)).ok();
            }
        }
        Ok(())
    }

    /// Reads the answer in a folder. Which model it belongs to is checked where it meets one
    /// ([`Lifted::check_model`]).
    ///
    /// # Errors
    /// A folder or file that is missing, damaged or of another kind.
    pub fn read(folder: &Path) -> Result<Self, DataError> {
        let card_path = folder.join(CARD);
        let card: Card = json::parse(&card_path, None, &read_bounded(&card_path, MAX_CARD_BYTES)?)?;
        let fault = |place: &str, message: &str| DataError::invalid(&card_path, place, message, REMEDY);
        if card.schema != SCHEMA {
            let message = "is of another version than this l4d reads";
            return Err(DataError::invalid(
                &card_path,
                "field `schema`",
                message,
                "read the answer with the l4d that wrote it",
            ));
        }
        if !is_tensors_name(&card.tensors.file) {
            return Err(fault("field `tensors.file`", "is not `lift-<digest>.safetensors`"));
        }
        let path = folder.join(&card.tensors.file);
        let bytes = read_bounded(&path, MAX_TENSOR_BYTES)?;
        if bytes.len() as u64 != card.tensors.bytes || sha256_hex(&bytes) != card.tensors.sha256 {
            let message = "is not the file that lift.json was written with";
            return Err(DataError::invalid(&path, "digest", message, REMEDY));
        }
        let answer = Found::new(&bytes).and_then(|found| card.answer.read(found, card.model.gaussians));
        let answer = answer.map_err(|message| DataError::invalid(&path, "tensors", message, REMEDY))?;
        Ok(Self { model: card.model, answer })
    }
}

fn kind_of_labels(labels: &Labels) -> Kind {
    Kind::Labels { times: labels.times.len(), states: labels.states.len(), cut: labels.cut }
}

fn kind_of_field(field: &Field) -> Kind {
    let (width, features) = field.network.sizes();
    Kind::Field { width, features, read_out: field.read_out }
}

fn columns_of_labels(labels: &Labels) -> Vec<(String, Column)> {
    let gaussians = labels.states.first().map_or(0, Vec::len);
    vec![
        ("times".to_owned(), Column::F32(vec![labels.times.len()], labels.times.clone())),
        ("state_of".to_owned(), Column::U32(vec![labels.state_of.len()], labels.state_of.clone())),
        ("states".to_owned(), Column::F32(vec![labels.states.len(), gaussians], labels.states.concat())),
        ("threshold".to_owned(), Column::F32(vec![1], vec![labels.threshold])),
    ]
}

fn columns_of_field(field: &Field) -> Vec<(String, Column)> {
    let tensors = field.tensors().into_iter();
    tensors.map(|(name, tensor)| (name.to_owned(), Column::F32(tensor.shape, tensor.data))).collect()
}

impl Kind {
    fn read(self, mut found: Found<'_>, gaussians: usize) -> Result<Answer, String> {
        let answer = match self {
            Self::Labels { times, states, cut } => {
                let labels = Labels {
                    times: found.f32("times", &[times])?,
                    state_of: found.u32("state_of", &[times])?,
                    states: split(found.f32("states", &[states, gaussians])?, states, gaussians),
                    threshold: found.f32("threshold", &[1])?[0],
                    cut,
                };
                check(&labels)?;
                Answer::Labels(labels)
            }
            Self::Field { width, features, read_out } => {
                if !((1..=WIDEST).contains(&width) && (1..=WIDEST).contains(&features)) {
                    return Err(format!("layers of {width} and {features}: they are 1 to {WIDEST} wide"));
                }
                let mut message = None;
                let network = Network::from_tensors(width, features, |name, shape| {
                    found.f32(name, shape).map_err(|fault| message = Some(fault)).ok()
                });
                let network = network.map_err(|name| message.unwrap_or_else(|| name.to_owned()))?;
                Answer::Field(Box::new(Field { network, read_out }))
            }
        };
        found.finish()?;
        Ok(answer)
    }
}

fn split(numbers: Vec<f32>, states: usize, gaussians: usize) -> Vec<Vec<f32>> {
    if gaussians == 0 {
        return vec![Vec::new(); states.min(1)];
    }
    numbers.chunks_exact(gaussians).map(<[f32]>::to_vec).collect()
}

fn check(labels: &Labels) -> Result<(), String> {
    if labels.times.is_empty() || labels.times.iter().any(|time| !(0.0..=1.0).contains(time)) {
        return Err("times are at least one, from 0 to 1".to_owned());
    }
    if labels.times.windows(2).any(|pair| pair[0] >= pair[1]) {
        return Err("times do not ascend".to_owned());
    }
    match labels.state_of.iter().find(|&&state| state as usize >= labels.states.len()) {
        Some(state) => Err(format!("a time is in state {state}, but there are {}", labels.states.len())),
        None => Ok(()),
    }
}

/// `lift-<16 hex digits>.safetensors`
fn is_tensors_name(name: &str) -> bool {
    let digest = name.strip_prefix("lift-").and_then(|rest| rest.strip_suffix(".safetensors"));
    digest.is_some_and(|digest| {
        digest.len() == 16 && digest.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'))
    })
}
