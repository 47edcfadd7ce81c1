//! Cosines between the pixels of a picture of latents and known texts.
//!
//! Nothing as wide as an embedding is computed. What is asked of one is its length and its products with texts, and both
//! are functions of the last hidden layer `h`: with `A = [W b]` of the last layer, the products are `T A (h, 1)`, and the
//! length is that of `R (h, 1)` with the triangular factor `R^T R = A^T A`. So the last layer is replaced by one with
//! the rows of `T A` and `R`. A factor rather than the square itself, so that no rounding makes a square negative.
//! Pixels pass all layers in blocks that stay in a near cache.

use ndarray::linalg::general_mat_mul;
use ndarray::{Array2, ArrayView2, ArrayViewMut2, Axis, s};
use rayon::prelude::*;

use super::decoder::Layer;
use super::{Decoder, Found, Latents, Rules, TextEmbeddings, relevancy, smooth};

/// Pixels that pass all layers together.
const BLOCK: usize = 256;
/// Layers with fewer inputs are multiplied without a library: packing would cost more than the products.
const NARROW: usize = 8;

/// A decoder with its last layer folded into texts.
#[derive(Debug, Clone)]
pub struct Engine {
    /// Layers, each but the last followed by a ReLU; the last gives products with texts, then what has the length of the
    /// embedding.
    layers: Vec<Layer>,
    sentences: usize,
    texts: usize,
}

impl Engine {
    /// An engine for these texts; none if the decoder does not end in their width.
    pub fn new(decoder: &Decoder, texts: &TextEmbeddings) -> Option<Self> {
        let (last, hidden) = decoder.layers().split_last()?;
        if last.outputs != texts.width() {
            return None;
        }
        let layers = hidden.iter().cloned().chain([folded(last, texts)]).collect();
        Some(Self { layers, sentences: texts.sentences().len(), texts: texts.len() })
    }

    /// Channels of a latent.
    pub fn channels(&self) -> usize {
        self.layers[0].inputs
    }

    /// What a level says of each sentence, in the order of the texts.
    ///
    /// # Panics
    /// If the latents have other channels than the decoder takes, or are not as many as their size says.
    pub fn level(&self, latents: Latents<'_>, rules: &Rules) -> Vec<Found> {
        let sentences = self.sentences;
        let maps = self.fill(latents, |cosines, sentence| {
            let best_phrase = cosines[sentences..].iter().copied().fold(f32::NEG_INFINITY, f32::max);
            relevancy(cosines[sentence], best_phrase)
        });
        let (width, height) = (latents.width as usize, latents.height as usize);
        maps.into_par_iter().map(|map| smooth::find(map, width, height, rules)).collect()
    }

    /// Cosine between each pixel and each sentence: one map per sentence.
    ///
    /// # Panics
    /// As [`Self::level`].
    pub fn cosines(&self, latents: Latents<'_>) -> Vec<Vec<f32>> {
        self.fill(latents, |cosines, sentence| cosines[sentence])
    }

    /// Fills pictures, one a sentence, by what `combine` makes of a pixel's cosines with all texts.
    fn fill(&self, latents: Latents<'_>, combine: impl Fn(&[f32], usize) -> f32 + Sync) -> Vec<Vec<f32>> {
        let pixels = latents.width as usize * latents.height as usize;
        assert_eq!(latents.channels, self.channels(), "channels of the latents");
        assert_eq!(latents.data.len(), pixels * latents.channels, "numbers of the latents");
        let mut maps = vec![vec![0.0; pixels]; self.sentences];
        let mut blocks: Vec<Vec<&mut [f32]>> = (0..pixels.div_ceil(BLOCK)).map(|_| Vec::new()).collect();
        for map in &mut maps {
            blocks.iter_mut().zip(map.chunks_mut(BLOCK)).for_each(|(block, part)| block.push(part));
        }
        let inputs = latents.data.par_chunks(BLOCK * latents.channels);
        inputs.zip(blocks).for_each_init(
            || Scratch::new(self),
            |scratch, (input, parts)| {
                let cosines = scratch.cosines(self, input);
                for (sentence, part) in parts.into_iter().enumerate() {
                    let pixels = part.iter_mut().zip(cosines.chunks_exact(self.texts));
                    pixels.for_each(|(value, cosines)| *value = combine(cosines, sentence));
                }
            },
        );
        maps
    }
}

/// Room for one block on one thread.
struct Scratch {
    now: Vec<f32>,
    next: Vec<f32>,
    cosines: Vec<f32>,
}

impl Scratch {
    fn new(engine: &Engine) -> Self {
        let outputs = engine.layers.iter().map(|layer| layer.outputs);
        let room = vec![0.0; BLOCK * outputs.fold(engine.channels(), usize::max)];
        Self { now: room.clone(), next: room, cosines: vec![0.0; BLOCK * engine.texts] }
    }

    /// Cosines of a block's pixels with all texts, pixel by pixel.
    fn cosines(&mut self, engine: &Engine, input: &[f32]) -> &[f32] {
        let rows = input.len() / engine.channels();
        self.now[..input.len()].copy_from_slice(input);
        let mut width = engine.channels();
        for (index, layer) in engine.layers.iter().enumerate() {
            let output = &mut self.next[..rows * layer.outputs];
            apply(layer, &self.now[..rows * layer.inputs], output);
            if index + 1 < engine.layers.len() {
                output.iter_mut().for_each(|value| *value = value.max(0.0));
            }
            std::mem::swap(&mut self.now, &mut self.next);
            width = layer.outputs;
        }
        let cosines = &mut self.cosines[..rows * engine.texts];
        let pixels = cosines.chunks_exact_mut(engine.texts).zip(self.now.chunks_exact(width));
        for (cosines, output) in pixels {
            let (products, rest) = output.split_at(engine.texts);
            let length = rest.iter().map(|value| value * value).sum::<f32>().sqrt();
            // An embedding without a length points nowhere.
            let scale = if length > 0.0 { 1.0 / length } else { 0.0 };
            cosines.iter_mut().zip(products).for_each(|(cosine, product)| *cosine = product * scale);
        }
        cosines
    }
}

/// The layer that gives, instead of an embedding, its products with texts and then a vector of its length.
fn folded(last: &Layer, texts: &TextEmbeddings) -> Layer {
    let size = last.inputs + 1;
    let affine = Array2::from_shape_fn((last.outputs, size), |(row, col)| {
        f64::from(if col < last.inputs { last.weight[row * last.inputs + col] } else { last.bias[row] })
    });
    let texts = matrix(texts.vectors(), texts.len(), texts.width()).mapv(f64::from);
    let (products, factor) = (texts.dot(&affine), cholesky(affine.t().dot(&affine)));
    let rows = || products.rows().into_iter().chain(factor.rows());
    Layer {
        inputs: last.inputs,
        outputs: rows().count(),
        weight: rows().flat_map(|row| row.into_iter().take(last.inputs).map(|&value| value as f32)).collect(),
        bias: rows().map(|row| row[last.inputs] as f32).collect(),
    }
}

/// The upper triangular factor of a positive semidefinite matrix.
///
/// Layers that narrow make it singular: a pivot that is nothing but rounding ends in a row of zeros.
fn cholesky(mut matrix: Array2<f64>) -> Array2<f64> {
    let size = matrix.nrows();
    let least = matrix.diag().fold(0.0, |most: f64, &value| most.max(value)) * 1e-13 * size as f64;
    for pivot in 0..size {
        let (mut above, mut below) = matrix.view_mut().split_at(Axis(0), pivot + 1);
        let mut row = above.row_mut(pivot);
        let diagonal = row[pivot];
        row.slice_mut(s![..pivot]).fill(0.0);
        if diagonal <= least {
            row.fill(0.0);
            continue;
        }
        row /= diagonal.sqrt();
        for (mut other, from) in below.rows_mut().into_iter().zip(pivot + 1..) {
            other.slice_mut(s![from..]).scaled_add(-row[from], &row.slice(s![from..]));
        }
    }
    matrix
}

/// A linear layer.
fn apply(layer: &Layer, input: &[f32], output: &mut [f32]) {
    if layer.inputs < NARROW {
        let pixels = output.chunks_exact_mut(layer.outputs).zip(input.chunks_exact(layer.inputs));
        for (output, input) in pixels {
            let rows = layer.weight.chunks_exact(layer.inputs).zip(&layer.bias);
            for (value, (row, &bias)) in output.iter_mut().zip(rows) {
                *value = row.iter().zip(input).map(|(weight, number)| weight * number).sum::<f32>() + bias;
            }
        }
        return;
    }
    let rows = input.len() / layer.inputs;
    output.chunks_exact_mut(layer.outputs).for_each(|row| row.copy_from_slice(&layer.bias));
    let weight = matrix(&layer.weight, layer.outputs, layer.inputs);
    let mut product = matrix_mut(output, rows, layer.outputs);
    general_mat_mul(1.0, &matrix(input, rows, layer.inputs), &weight.t(), 1.0, &mut product);
}

const SIZED: &str = "layers and blocks are made with matching sizes";

fn matrix(numbers: &[f32], rows: usize, columns: usize) -> ArrayView2<'_, f32> {
    ArrayView2::from_shape((rows, columns), numbers).expect(SIZED)
}

fn matrix_mut(numbers: &mut [f32], rows: usize, columns: usize) -> ArrayViewMut2<'_, f32> {
    ArrayViewMut2::from_shape((rows, columns), numbers).expect(SIZED)
}
