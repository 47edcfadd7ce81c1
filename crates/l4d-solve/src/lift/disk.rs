//! How an answer reaches a folder and comes back.
//!
//! ```text
//! <folder>/lift.json
//! <folder>/lift-<digest>.safetensors
//! ```
//!
//! `l4d_formats::tensor_file` keeps the two together.

use std::borrow::Cow;
use std::path::Path;

use l4d_data::store::read_bounded;
use l4d_data::{DataError, json};
use l4d_formats::tensor_file::{Column, Found, TensorFile, TensorFileKind};
use l4d_formats::{Fault, Tensor};
use serde::{Deserialize, Serialize};

use super::digest::ModelDigest;
use super::field::{Field, Network, ReadOut};
use super::labels::{Cut, Labels};
use super::lifted::{Answer, Lifted};

/// The file that makes a folder an answer.
const CARD: &str = "lift.json";
/// Schema tag of an answer.
const SCHEMA: &str = "l4d/lift/1";

/// No card is longer, bytes.
const MAX_CARD_BYTES: u64 = 1 << 16;
/// Layers of a field are no wider than this.
const WIDEST: usize = 4096;

const REMEDY: &str = "lift the answer again, or copy its whole folder";

const FILES: TensorFileKind = TensorFileKind {
    card: CARD,
    stem: "lift",
    whole: "an answer",
    // An answer's takes about a thousand.
    longest_header: 1 << 16,
    longest_file: 4 << 30,
    remedy: REMEDY,
};

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Card {
    schema: String,
    model: ModelDigest,
    answer: Kind,
    tensors: TensorFile,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
enum Kind {
    Labels { times: usize, states: usize, cut: Cut },
    Field { width: usize, features: usize, read_out: ReadOut },
}

impl Lifted {
    /// Writes the answer into a folder, in place of the one that is there.
    ///
    /// # Errors
    /// What the disk refuses.
    pub fn write(&self, folder: &Path) -> Result<(), DataError> {
        let (answer, columns) = match &self.answer {
            Answer::Labels(labels) => (kind_of_labels(labels), columns_of_labels(labels)),
            Answer::Field(field) => (kind_of_field(field), columns_of_field(field)),
        };
        let model = self.model.clone();
        FILES.write(folder, columns, |tensors| Card { schema: SCHEMA.to_owned(), model, answer, tensors })
    }

    /// Reads the answer in a folder. Which model it belongs to is checked where it meets one
    /// ([`Lifted::check_model`]).
    ///
    /// # Errors
    /// A folder or file that is missing, damaged or of another kind.
    pub fn read(folder: &Path) -> Result<Self, DataError> {
        let card_path = folder.join(CARD);
        let card: Card = json::parse(&card_path, None, &read_bounded(&card_path, MAX_CARD_BYTES)?)?;
        if card.schema != SCHEMA {
            let message = "is of another version than this l4d reads";
            return Err(DataError::invalid(
                &card_path,
                "field `schema`",
                message,
                "read the answer with the l4d that wrote it",
            ));
        }
        FILES.check(&card.tensors).map_err(|fault| fault.at(&card_path))?;
        let (path, bytes) = FILES.read(folder, &card.tensors)?;
        let answer = FILES.found(&bytes).and_then(|found| card.answer.read(found, card.model.gaussians));
        let answer = answer.map_err(|fault| fault.at(&path))?;
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

fn columns_of_labels(labels: &Labels) -> Vec<(String, Column<'_>)> {
    let gaussians = labels.states.first().map_or(0, Vec::len);
    let (times, states) = (labels.times.len(), labels.states.len());
    let columns = [
        ("times", Column::F32(vec![times], Cow::Borrowed(&labels.times))),
        ("state_of", Column::U32(vec![labels.state_of.len()], Cow::Borrowed(&labels.state_of))),
        ("states", Column::F32(vec![states, gaussians], Cow::Owned(labels.states.concat()))),
        ("threshold", Column::F32(vec![1], Cow::Owned(vec![labels.threshold]))),
    ];
    columns.into_iter().map(|(name, column)| (name.to_owned(), column)).collect()
}

fn columns_of_field(field: &Field) -> Vec<(String, Column<'_>)> {
    let column = |(name, tensor): (&str, Tensor)| {
        (name.to_owned(), Column::F32(tensor.shape, Cow::Owned(tensor.data)))
    };
    field.tensors().into_iter().map(column).collect()
}

impl Kind {
    fn read(self, mut found: Found<'_>, gaussians: usize) -> Result<Answer, Fault> {
        let answer = match self {
            Self::Labels { times, states, cut } => {
                let labels = Labels {
                    times: found.finite("times", &[times])?,
                    state_of: found.u32("state_of", &[times])?,
                    states: split(found.finite("states", &[states, gaussians])?, states, gaussians),
                    threshold: found.finite("threshold", &[1])?[0],
                    cut,
                };
                check(&labels).map_err(wrong)?;
                Answer::Labels(labels)
            }
            Self::Field { width, features, read_out } => {
                if !((1..=WIDEST).contains(&width) && (1..=WIDEST).contains(&features)) {
                    let message = format!("layers of {width} and {features}: they are 1 to {WIDEST} wide");
                    return Err(wrong(message));
                }
                let mut first = None;
                let network = Network::from_tensors(width, features, |name, shape| {
                    found.finite(name, shape).map_err(|fault| first = Some(fault)).ok()
                });
                let network = network.map_err(|name| first.unwrap_or_else(|| wrong(name.to_owned())))?;
                Answer::Field(Box::new(Field { network, read_out }))
            }
        };
        found.finish()?;
        Ok(answer)
    }
}

fn wrong(message: String) -> Fault {
    Fault::new("tensors", message, REMEDY)
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
