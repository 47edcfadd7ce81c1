//! Text embeddings of sentences and phrases (CLIP; E5 for the temporal gate), exported once by
//! `docs/import/export_text_embeddings.py`. Encodes no text itself.

use std::path::Path;

use l4d_data::DataError;

use l4d_formats::arrays;
use l4d_formats::npy::Contents;

/// Most sentences of one file.
const MAX_SENTENCES: usize = 10_000;
const HINT: &str = "make it with docs/import/export_text_embeddings.py";

/// Embeddings of one dimension (`width`), of length 1.
#[derive(Debug, Clone, PartialEq)]
pub struct TextEmbeddings {
    width: usize,
    /// Number of sentences.
    sentences: usize,
    /// \[sentences, then phrases\]\[width\].
    vectors: Vec<f32>,
}

impl TextEmbeddings {
    /// From the embeddings of sentences, and of the phrases that they compete with; none if they do not fill rows of
    /// `width`. Each is brought to length 1.
    pub fn new(width: usize, mut sentences: Vec<f32>, phrases: Vec<f32>) -> Option<Self> {
        if width == 0 || !sentences.len().is_multiple_of(width) || !phrases.len().is_multiple_of(width) {
            return None;
        }
        let count = sentences.len() / width;
        sentences.extend(phrases);
        sentences.chunks_exact_mut(width).for_each(to_unit_length);
        Some(Self { width, sentences: count, vectors: sentences })
    }

    /// Dimension of the embeddings.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of sentences and phrases.
    pub(super) fn len(&self) -> usize {
        self.vectors.len() / self.width
    }

    /// All embeddings, sentences first: [`Self::len`] rows of [`Self::width`] numbers.
    pub(super) fn vectors(&self) -> &[f32] {
        &self.vectors
    }

    pub fn sentences(&self) -> impl ExactSizeIterator<Item = &[f32]> {
        self.vectors[..self.sentences * self.width].chunks_exact(self.width)
    }

    pub fn phrases(&self) -> impl ExactSizeIterator<Item = &[f32]> {
        self.vectors[self.sentences * self.width..].chunks_exact(self.width)
    }

    /// The same phrases with some of the sentences, in the order of `chosen`.
    ///
    /// # Panics
    /// If an index is not that of a sentence.
    pub fn select(&self, chosen: &[usize]) -> Self {
        let vector = |&index: &usize| &self.vectors[index * self.width..][..self.width];
        let phrases = &self.vectors[self.sentences * self.width..];
        let vectors = chosen.iter().map(vector).chain([phrases]).collect::<Vec<_>>().concat();
        Self { width: self.width, sentences: chosen.len(), vectors }
    }
}

/// An `.npz` of sentences and embeddings.
#[derive(Debug, Clone, PartialEq)]
pub struct TextEmbeddingsFile {
    /// The sentences, in the order of their embeddings.
    pub queries: Vec<String>,
    pub texts: TextEmbeddings,
}

impl TextEmbeddingsFile {
    /// Reads `queries`, `positives` and `negatives`. The file of the temporal gate (`--time-texts`) has no `negatives`.
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
        if queries.len() * width != positives.len() || queries.is_empty() || queries.len() > MAX_SENTENCES {
            let message = format!("has {} sentences for {} vectors", queries.len(), positives.len() / width);
            return Err(fault("queries", message));
        }
        let texts = TextEmbeddings::new(width, positives, negatives);
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
