//! Cosines between the pixels of a picture of latents and known texts.
//!
//! Pixels pass all layers in blocks that stay in a near cache: embeddings of a whole picture would take gigabytes.

use ndarray::linalg::general_mat_mul;
use ndarray::{ArrayView2, ArrayViewMut2};
use rayon::prelude::*;

use super::decoder::Layer;
use super::{Decoder, Found, Latents, Rules, Texts, relevancy, smooth};

/// Pixels that pass all layers together.
const BLOCK: usize = 256;
/// Layers with fewer inputs are multiplied without a library: packing would cost more than the products.
const NARROW: usize = 8;

/// A decoder and the texts that its embeddings are compared with.
#[derive(Debug, Clone)]
pub struct Engine {
    decoder: Decoder,
    texts: Texts,
}

impl Engine {
    /// An engine for these texts; none if the decoder does not end in their width.
    pub fn new(decoder: Decoder, texts: Texts) -> Option<Self> {
        (decoder.outputs() == texts.width()).then_some(Self { decoder, texts })
    }

    /// Channels of a latent.
    pub fn channels(&self) -> usize {
        self.decoder.inputs()
    }

    /// What a level says of each sentence, in the order of the texts.
    ///
    /// # Panics
    /// If the latents have other channels than the decoder takes, or are not as many as their size says.
    pub fn level(&self, latents: Latents<'_>, rules: &Rules) -> Vec<Found> {
        let sentences = self.texts.sentences().len();
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
        let mut maps = vec![vec![0.0; pixels]; self.texts.sentences().len()];
        let mut blocks: Vec<Vec<&mut [f32]>> = (0..pixels.div_ceil(BLOCK)).map(|_| Vec::new()).collect();
        for map in &mut maps {
            blocks.iter_mut().zip(map.chunks_mut(BLOCK)).for_each(|(block, part)| block.push(part));
        }
        let texts = self.texts.len();
        let inputs = latents.data.par_chunks(BLOCK * latents.channels);
        inputs.zip(blocks).for_each_init(
            || Scratch::new(self),
            |scratch, (input, parts)| {
                let cosines = scratch.cosines(self, input);
                for (sentence, part) in parts.into_iter().enumerate() {
                    let pixels = part.iter_mut().zip(cosines.chunks_exact(texts));
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
        let outputs = engine.decoder.layers().iter().map(|layer| layer.outputs);
        let room = vec![0.0; BLOCK * outputs.fold(engine.channels(), usize::max)];
        Self { now: room.clone(), next: room, cosines: vec![0.0; BLOCK * engine.texts.len()] }
    }

    /// Cosines of a block's pixels with all texts, pixel by pixel.
    fn cosines(&mut self, engine: &Engine, input: &[f32]) -> &[f32] {
        let (rows, width, texts) =
            (input.len() / engine.channels(), engine.decoder.outputs(), engine.texts.len());
        self.now[..input.len()].copy_from_slice(input);
        let layers = engine.decoder.layers();
        for (index, layer) in layers.iter().enumerate() {
            let output = &mut self.next[..rows * layer.outputs];
            apply(layer, &self.now[..rows * layer.inputs], output);
            if index + 1 < layers.len() {
                output.iter_mut().for_each(|value| *value = value.max(0.0));
            }
            std::mem::swap(&mut self.now, &mut self.next);
        }
        let embeddings = &self.now[..rows * width];
        let cosines = &mut self.cosines[..rows * texts];
        let vectors = matrix(engine.texts.vectors(), texts, width);
        let mut products = matrix_mut(cosines, rows, texts);
        general_mat_mul(1.0, &matrix(embeddings, rows, width), &vectors.t(), 0.0, &mut products);
        for (cosines, embedding) in cosines.chunks_exact_mut(texts).zip(embeddings.chunks_exact(width)) {
            let length = embedding.iter().map(|value| value * value).sum::<f32>().sqrt();
            // An embedding without a length points nowhere.
            let scale = if length > 0.0 { 1.0 / length } else { 0.0 };
            cosines.iter_mut().for_each(|cosine| *cosine *= scale);
        }
        cosines
    }
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
