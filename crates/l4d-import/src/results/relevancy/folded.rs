//! The fast path: nothing as wide as an embedding is ever computed.
//!
//! Everything that is asked of an embedding is its length and its products with known vectors. Both are functions of
//! the last hidden layer: the length through a triangular factor ([`super::gram`]), the products through vectors that
//! were multiplied with the last layer beforehand. Pixels pass all layers in blocks that stay in a near cache.

use ndarray::linalg::general_mat_mul;
use ndarray::{ArrayView2, ArrayViewMut2, s};
use rayon::prelude::*;

use super::decoder::Layer;
use super::{Decoder, Found, Latents, Rules, Texts, gram, relevancy, smooth};

/// Pixels that pass all layers together.
const BLOCK: usize = 256;
/// Rows of the triangle that are multiplied at once: what lies left of them is zero and left out.
const STRIP: usize = 64;
/// Layers with fewer inputs are multiplied without a library: packing would cost more than the products.
const NARROW: usize = 8;

/// A decoder with its last layer folded into texts.
#[derive(Debug, Clone)]
pub struct Folded {
    channels: usize,
    hidden: Vec<Layer>,
    /// Numbers of the last hidden layer, or channels where there is none.
    width: usize,
    /// Triangle of `width + 1` rows and columns.
    factor: Vec<f32>,
    sentences: usize,
    /// A row of `width` numbers for each text, sentences first.
    texts: Vec<f32>,
    /// What is added to the product with each text.
    offsets: Vec<f32>,
}

impl Folded {
    /// An engine for these sentences; none if the decoder does not end in their width.
    pub fn new(decoder: &Decoder, texts: &Texts) -> Option<Self> {
        let (last, hidden) = decoder.layers().split_last()?;
        if last.outputs != texts.width() {
            return None;
        }
        let mut folded = Vec::new();
        let mut offsets = Vec::new();
        for text in texts.sentences().chain(texts.phrases()) {
            let mut products = vec![0.0_f64; last.inputs];
            for (row, &number) in last.weight.chunks_exact(last.inputs).zip(text) {
                products
                    .iter_mut()
                    .zip(row)
                    .for_each(|(sum, &weight)| *sum += f64::from(weight) * f64::from(number));
            }
            folded.extend(products.iter().map(|&sum| sum as f32));
            offsets
                .push(last.bias.iter().zip(text).map(|(a, b)| f64::from(*a) * f64::from(*b)).sum::<f64>()
                    as f32);
        }
        Some(Self {
            channels: decoder.inputs(),
            hidden: hidden.to_vec(),
            width: last.inputs,
            factor: gram::factor(last),
            sentences: texts.sentences().len(),
            texts: folded,
            offsets,
        })
    }

    /// Fills pictures, one a sentence, by what `combine` makes of a pixel's cosines with all texts.
    fn fill(&self, latents: Latents<'_>, combine: impl Fn(&[f32], usize) -> f32 + Sync) -> Vec<Vec<f32>> {
        let pixels = latents.width as usize * latents.height as usize;
        assert_eq!(latents.channels, self.channels, "channels of the latents");
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
                    let pixels = cosines.chunks_exact(self.offsets.len());
                    part.iter_mut()
                        .zip(pixels)
                        .for_each(|(value, cosines)| *value = combine(cosines, sentence));
                }
            },
        );
        maps
    }
}

impl Folded {
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
}

/// Room for one block on one thread.
struct Scratch {
    now: Vec<f32>,
    next: Vec<f32>,
    cosines: Vec<f32>,
}

impl Scratch {
    fn new(engine: &Folded) -> Self {
        let widest = engine.hidden.iter().map(|layer| layer.outputs).max().unwrap_or(0);
        let room = BLOCK * widest.max(engine.width).max(engine.channels);
        Self { now: vec![0.0; room], next: vec![0.0; room], cosines: vec![0.0; BLOCK * engine.offsets.len()] }
    }

    /// Cosines of a block's pixels with all texts, pixel by pixel.
    fn cosines(&mut self, engine: &Folded, input: &[f32]) -> &[f32] {
        let rows = input.len() / engine.channels;
        self.now[..input.len()].copy_from_slice(input);
        for layer in &engine.hidden {
            apply(layer, &self.now[..rows * layer.inputs], &mut self.next[..rows * layer.outputs]);
            std::mem::swap(&mut self.now, &mut self.next);
        }
        let hidden = matrix(&self.now, rows, engine.width);
        let texts = engine.offsets.len();
        let cosines = &mut self.cosines[..rows * texts];
        let folded = matrix(&engine.texts, texts, engine.width);
        general_mat_mul(1.0, &hidden, &folded.t(), 0.0, &mut matrix_mut(cosines, rows, texts));
        let products = &mut self.next[..rows * engine.width];
        triangle(engine, hidden, products);
        for (row, cosines) in cosines.chunks_exact_mut(texts).enumerate() {
            let length = engine.length(&products[row * engine.width..][..engine.width]);
            // An embedding without a length points nowhere.
            let scale = if length > 0.0 { 1.0 / length } else { 0.0 };
            cosines
                .iter_mut()
                .zip(&engine.offsets)
                .for_each(|(cosine, offset)| *cosine = (*cosine + offset) * scale);
        }
        cosines
    }
}

impl Folded {
    /// The length of an embedding from the products of its hidden layer with the triangle.
    fn length(&self, products: &[f32]) -> f32 {
        let size = self.width + 1;
        let last_column = self.factor.iter().skip(self.width).step_by(size);
        let corner = self.factor[size * size - 1];
        let sum: f32 =
            products.iter().zip(last_column).map(|(product, constant)| (product + constant).powi(2)).sum();
        (sum + corner * corner).sqrt()
    }
}

/// Products of the hidden layer with all rows of the triangle but its last, which is a constant.
fn triangle(engine: &Folded, hidden: ArrayView2<'_, f32>, products: &mut [f32]) {
    let (rows, width) = hidden.dim();
    let factor = matrix(&engine.factor, width + 1, width + 1);
    let mut products = matrix_mut(products, rows, width);
    for first in (0..width).step_by(STRIP) {
        let end = (first + STRIP).min(width);
        general_mat_mul(
            1.0,
            &hidden.slice(s![.., first..]),
            &factor.slice(s![first..end, first..width]).t(),
            0.0,
            &mut products.slice_mut(s![.., first..end]),
        );
    }
}

/// A linear layer and its ReLU.
fn apply(layer: &Layer, input: &[f32], output: &mut [f32]) {
    if layer.inputs < NARROW {
        let pixels = output.chunks_exact_mut(layer.outputs).zip(input.chunks_exact(layer.inputs));
        for (output, input) in pixels {
            let rows = layer.weight.chunks_exact(layer.inputs).zip(&layer.bias);
            for (value, (row, &bias)) in output.iter_mut().zip(rows) {
                let sum: f32 = row.iter().zip(input).map(|(weight, number)| weight * number).sum();
                *value = (sum + bias).max(0.0);
            }
        }
        return;
    }
    let rows = input.len() / layer.inputs;
    output.chunks_exact_mut(layer.outputs).for_each(|row| row.copy_from_slice(&layer.bias));
    let weight = matrix(&layer.weight, layer.outputs, layer.inputs);
    let mut product = matrix_mut(output, rows, layer.outputs);
    general_mat_mul(1.0, &matrix(input, rows, layer.inputs), &weight.t(), 1.0, &mut product);
    output.iter_mut().for_each(|value| *value = value.max(0.0));
}

const SIZED: &str = "layers and blocks are made with matching sizes";

fn matrix(numbers: &[f32], rows: usize, columns: usize) -> ArrayView2<'_, f32> {
    ArrayView2::from_shape((rows, columns), &numbers[..rows * columns]).expect(SIZED)
}

fn matrix_mut(numbers: &mut [f32], rows: usize, columns: usize) -> ArrayViewMut2<'_, f32> {
    ArrayViewMut2::from_shape((rows, columns), &mut numbers[..rows * columns]).expect(SIZED)
}
