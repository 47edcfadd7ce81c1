//! Sentences as vectors, exported once by `docs/import/export_text_embeddings.py`.

use std::path::Path;

use l4d_data::DataError;

use l4d_formats::arrays;
use l4d_formats::npy::Contents;

/// Sentences of one file.
const MOST: usize = 10_000;
/// What to do about a file that this module refuses.
const HINT: &str = "make it with docs/import/export_text_embeddings.py";

/// Vectors of one width and length 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Texts {
    width: usize,
    /// How many of the vectors are sentences; they come first, then the phrases.
    sentences: usize,
    vectors: Vec<f32>,
}

impl Texts {
    /// Vectors of sentences, and of the phrases that they are compared with; none if they do not fill the width.
    /// Each is brought to length 1.
    pub fn new(width: usize, mut sentences: Vec<f32>, phrases: Vec<f32>) -> Option<Self> {
        if width == 0 || !sentences.len().is_multiple_of(width) || !phrases.len().is_multiple_of(width) {
            return None;
        }
        let count = sentences.len() / width;
        sentences.extend(phrases);
        sentences.chunks_exact_mut(width).for_each(to_unit_length);
        Some(Self { width, sentences: count, vectors: sentences })
    }

    /// Numbers a vector.
    pub fn width(&self) -> usize {
        self.width
    }

    /// How many vectors there are.
    pub(super) fn len(&self) -> usize {
        self.vectors.len() / self.width
    }

    /// All vectors, one after the other, sentences first.
    pub(super) fn vectors(&self) -> &[f32] {
        &self.vectors
    }

    /// The vectors of the sentences.
    pub fn sentences(&self) -> impl ExactSizeIterator<Item = &[f32]> {
        self.vectors[..self.sentences * self.width].chunks_exact(self.width)
    }

    /// The vectors of the phrases.
    pub fn phrases(&self) -> impl ExactSizeIterator<Item = &[f32]> {
        self.vectors[self.sentences * self.width..].chunks_exact(self.width)
    }

    /// The same phrases with some of the sentences, in the order of `chosen`.
    ///
    /// # Panics
    /// If there is no such sentence.
    pub fn select(&self, chosen: &[usize]) -> Self {
        let vector = |&index: &usize| &self.vectors[index * self.width..][..self.width];
        let phrases = &self.vectors[self.sentences * self.width..];
        let vectors = chosen.iter().map(vector).chain([phrases]).collect::<Vec<_>>().concat();
        Self { width: self.width, sentences: chosen.len(), vectors }
    }
}

/// An `.npz` of sentences and their vectors.
#[derive(Debug, Clone, PartialEq)]
pub struct TextsFile {
    /// The sentences, in the order of the vectors.
    pub queries: Vec<String>,
    pub texts: Texts,
}

impl TextsFile {
    /// Reads `queries`, `positives` and `negatives`. A file for the gate of time has no `negatives`.
    ///
    /// # Errors
    /// A file that cannot be read, or whose arrays do not belong together.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        let names = arrays::names(path)?;
        let has = |name: &str| names.iter().any(|known| known == name);
        let fault = |place: &str, message: String| {
            DataError::invalid(path, format!("array `{place}`"), message, HINT)
        };
        let text = |name: &str| match arrays::read_contents(path, Some(name))? {
            Contents::Text(texts) => Ok(texts),
            Contents::Numbers(_) => Err(fault(name, "holds no text".to_owned())),
        };
        let queries = text("queries")?;
        let (width, positives) = vectors(path, "positives")?;
        let (other, negatives) =
            if has("negatives") { vectors(path, "negatives")? } else { (width, Vec::new()) };
        if other != width {
            let message = format!("has vectors of {other} numbers, `positives` of {width}");
            return Err(fault("negatives", message));
        }
        if queries.len() * width != positives.len() || queries.is_empty() || queries.len() > MOST {
            let message = format!("has {} sentences for {} vectors", queries.len(), positives.len() / width);
            return Err(fault("queries", message));
        }
        let texts = Texts::new(width, positives, negatives);
        let texts = texts.ok_or_else(|| fault("positives", "does not fill its width".to_owned()))?;
        Ok(Self { queries, texts })
    }
}

fn vectors(path: &Path, name: &str) -> Result<(usize, Vec<f32>), DataError> {
    let array = arrays::read(path, Some(name))?;
    let fault = |message: String| DataError::invalid(path, format!("array `{name}`"), message, HINT);
    let [count, width] = array.shape[..] else {
        return Err(fault(format!("has the shape {:?}, but a row a sentence belongs here", array.shape)));
    };
    if width == 0 {
        return Err(fault("has vectors without numbers".to_owned()));
    }
    if let Some((index, value)) = array.bad_value() {
        return Err(fault(format!("holds {value} at number {index}")));
    }
    let is_zero = |vector: &[f32]| vector.iter().all(|&number| number == 0.0);
    if let Some(row) = array.data.chunks_exact(width).position(is_zero) {
        return Err(fault(format!("has a vector of zeros in row {row} of {count}")));
    }
    Ok((width, array.data))
}

fn to_unit_length(vector: &mut [f32]) {
    let length = vector.iter().map(|&number| f64::from(number).powi(2)).sum::<f64>().sqrt();
    if length > 0.0 {
        vector.iter_mut().for_each(|number| *number = (f64::from(*number) / length) as f32);
    }
}
