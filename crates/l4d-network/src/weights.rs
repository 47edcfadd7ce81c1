//! Weights with their description, checked before they are run.

use l4d_data::digest::sha256_hex;
use serde::Deserialize;
use serde_json::Value;

/// Schema tag of a description.
const SCHEMA: &str = "l4d/perception/2";
/// Most words of a vocabulary.
const MOST_WORDS: usize = 4096;

/// What is written beside the weights: the words of the network and the shapes of its parts.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Description {
    schema: String,
    /// Digest of the weights that it belongs to.
    pub sha256: String,
    /// Nouns; the first means the background.
    pub kinds: Vec<String>,
    /// Properties: key and value.
    pub values: Vec<(String, String)>,
    /// Channels from which pixels are judged.
    pub(crate) dense: usize,
    /// Channels of the levels, finest first.
    pub(crate) widths: Vec<usize>,
    /// Parts of an object that are looked at apart.
    pub(crate) parts: usize,
    /// Numbers that describe an object.
    pub(crate) object: usize,
    /// Unit of offsets, pixels of half resolution.
    pub(crate) offset_px: f32,
    /// Least height of a peak.
    pub(crate) peak: f32,
    /// A peak is the highest within so many pixels of half resolution.
    pub(crate) peak_px: usize,
    /// Most segments of a picture.
    pub(crate) most: usize,
    /// What the training was.
    #[serde(default)]
    pub training: Value,
}

/// Why weights cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum WeightsError {
    /// The description is not one.
    #[error("the description of the weights cannot be read: {0} (take both files from one release)")]
    Description(String),
    /// Weights and description do not belong together, or the file is damaged.
    #[error(
        "the weights have the digest {found}, their description says {expected} (the file is damaged, or of another version: take both from one release)"
    )]
    Digest {
        /// Of the file.
        found: String,
        expected: String,
    },
    /// The runtime refuses the file.
    #[error("the weights cannot be run: {0} (take them from a release)")]
    Model(String),
}

impl Description {
    /// Reads a description and checks that it is of these weights.
    ///
    /// # Errors
    /// Anything else than a description of exactly these weights.
    pub fn of(json: &str, weights: &[u8]) -> Result<Self, WeightsError> {
        let read: Self =
            serde_json::from_str(json).map_err(|error| WeightsError::Description(error.to_string()))?;
        if read.schema != SCHEMA {
            return Err(WeightsError::Description(format!("schema is {:?}, not {SCHEMA:?}", read.schema)));
        }
        read.check().map_err(WeightsError::Description)?;
        let found = sha256_hex(weights);
        if found != read.sha256 {
            return Err(WeightsError::Digest { found, expected: read.sha256 });
        }
        Ok(read)
    }

    fn check(&self) -> Result<(), String> {
        let shapes = self.widths.iter().chain([&self.dense, &self.parts]);
        if shapes.clone().any(|channels| *channels > MOST_WORDS) {
            return Err(format!("a part has more than {MOST_WORDS} channels"));
        }
        let described = self.dense
            + self.widths.iter().sum::<usize>()
            + crate::pool::COLOUR
            + self.parts * (self.dense + 3);
        if described != self.object {
            return Err(format!("object is {}, its parts have {described} numbers", self.object));
        }
        if self.kinds.len() < 2 || self.kinds.len() > MOST_WORDS || self.values.len() > MOST_WORDS {
            return Err(format!("{} kinds and {} values", self.kinds.len(), self.values.len()));
        }
        let are_numbers = self.offset_px.is_finite() && self.offset_px > 0.0 && self.peak.is_finite();
        if are_numbers && self.most > 0 { Ok(()) } else { Err("a number is none".to_owned()) }
    }

    /// The nouns of things.
    pub fn nouns(&self) -> impl Iterator<Item = &str> {
        self.kinds.iter().skip(1).map(String::as_str)
    }
}
