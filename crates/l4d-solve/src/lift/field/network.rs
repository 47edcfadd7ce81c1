//! The layers: phi (paper, equation 2), four linear layers with rectifiers between them, and the 1x1 convolution behind the blend.
//!
//! With two classes only the difference of the logits counts, which is linear in the last hidden layer h: z = u h + c
//! with u and c made of the last layer and the convolution ([`Collapsed`]). Parameters and what Adam knows of them stay
//! those of the layers as the paper has them, so that learning takes the same way.

use std::array::from_fn;

use l4d_splat::deform::matmul;
use l4d_splat::tensor::Tensor;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::encoding::{self, PLACE, Places, TIME};
use crate::lift::answer::Layer;

/// Gaussians evaluated together: enough for the matrix products to run at full speed.
pub(super) const BLOCK_ROWS: usize = 256;

/// Names of the parameters. The first layer's weights are in two parts, of the encoded place and of the encoded time;
/// rows of the decoder: not the answer, the answer.
const NAMES: [&str; 11] = [
    "phi.0.weight_place",
    "phi.0.weight_time",
    "phi.0.bias",
    "phi.1.weight",
    "phi.1.bias",
    "phi.2.weight",
    "phi.2.bias",
    "phi.3.weight",
    "phi.3.bias",
    "decoder.weight",
    "decoder.bias",
];

/// All parameters, or their gradient.
#[derive(Debug, Clone, PartialEq)]
pub struct Network {
    pub(super) width: usize,
    pub(super) features: usize,
    /// In the order of the names; matrices are \[outputs\]\[inputs\].
    pub(super) lists: [Vec<f32>; NAMES.len()],
}

impl Network {
    pub(super) fn zeros(width: usize, features: usize) -> Self {
        let lists = shapes(width, features).map(|shape| vec![0.0; shape.iter().product()]);
        Self { width, features, lists }
    }

    /// A network that has learned nothing; the same seed gives the same numbers. Weights of phi are uniform by Xavier's
    /// rule (SA4D), all else begins as PyTorch's layers do, uniform within one over the root of the inputs.
    pub(super) fn untrained(width: usize, features: usize, seed: u64) -> Self {
        let xavier = |inputs: usize, outputs: usize| (6.0 / (inputs + outputs) as f32).sqrt();
        let one_over_root = |inputs: usize| 1.0 / (inputs as f32).sqrt();
        let inputs = PLACE + TIME;
        let bounds = [
            xavier(inputs, width),
            xavier(inputs, width),
            one_over_root(inputs),
            xavier(width, width),
            one_over_root(width),
            xavier(width, width),
            one_over_root(width),
            xavier(width, features),
            one_over_root(width),
            one_over_root(features),
            one_over_root(features),
        ];
        let mut network = Self::zeros(width, features);
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        for (list, bound) in network.lists.iter_mut().zip(bounds) {
            list.fill_with(|| random.random_range(-bound..bound));
        }
        network
    }

    /// The parameters by name.
    pub(in crate::lift) fn tensors(&self) -> [(&'static str, Tensor); NAMES.len()] {
        let shapes = shapes(self.width, self.features);
        from_fn(|at| (NAMES[at], Tensor { shape: shapes[at].clone(), data: self.lists[at].clone() }))
    }

    /// Width of the hidden layers, and numbers of a feature.
    pub(in crate::lift) fn sizes(&self) -> (usize, usize) {
        (self.width, self.features)
    }

    /// What a field says of Gaussians with these canonical centres (metres) at a time from 0 to 1: the difference of the two
    /// classes' logits without the convolution's bias. softmax(conv(E)) is largest for the answer where the blend of
    /// these is above minus the bias.
    pub(in crate::lift) fn layer(&self, means: &[[f32; 3]], time: f32) -> Layer {
        let places = Places::new(means);
        let collapsed = Collapsed::new(self, time);
        let mut values = vec![0.0; means.len()];
        let rows: Vec<u32> = (0..means.len() as u32).collect();
        rows.par_chunks(BLOCK_ROWS).zip(values.par_chunks_mut(BLOCK_ROWS)).for_each_init(
            Scratch::default,
            |scratch, (rows, values)| {
                collapsed.logits(self, &places, rows, scratch, values);
            },
        );
        Layer { values, cut: -self.bias() }
    }

    /// Difference of the convolution's biases.
    pub(super) fn bias(&self) -> f32 {
        let [.., bias] = &self.lists;
        bias[1] - bias[0]
    }

    pub(super) fn clear(&mut self) {
        self.lists.iter_mut().for_each(|list| list.fill(0.0));
    }

    pub(super) fn add(&mut self, other: &Self) {
        self.lists.iter_mut().zip(&other.lists).for_each(|(sums, values)| add(sums, values));
    }
}

fn shapes(width: usize, features: usize) -> [Vec<usize>; NAMES.len()] {
    [
        vec![width, PLACE],
        vec![width, TIME],
        vec![width],
        vec![width, width],
        vec![width],
        vec![width, width],
        vec![width],
        vec![features, width],
        vec![features],
        vec![2, features],
        vec![2],
    ]
}

/// What is the same for all Gaussians of a step.
#[derive(Debug)]
pub(super) struct Collapsed {
    /// First layer's bias with the encoded time's part.
    bias: Vec<f32>,
    time: [f32; TIME],
    /// Last layer and convolution as one: z = `row` h + `offset`.
    row: Vec<f32>,
    offset: f32,
    /// Difference of the convolution's rows.
    contrast: Vec<f32>,
}

/// Room for the hidden layers of a block.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    places: Vec<f32>,
    layers: [Vec<f32>; 3],
    /// Gradients of a hidden layer and of the one before it.
    slopes: [Vec<f32>; 2],
}

impl Collapsed {
    pub(super) fn new(network: &Network, time: f32) -> Self {
        let [_, from_time, first_bias, .., last, last_bias, decoder, _] = &network.lists;
        let time = encoding::time(time);
        let read = from_time.chunks_exact(TIME);
        let bias = first_bias.iter().zip(read).map(|(bias, weights)| bias + dot(weights, &time)).collect();
        let (not, is) = decoder.split_at(network.features);
        let contrast: Vec<f32> = is.iter().zip(not).map(|(is, not)| is - not).collect();
        let mut row = vec![0.0; network.width];
        for (weights, &share) in last.chunks_exact(network.width).zip(&contrast) {
            for (sum, weight) in row.iter_mut().zip(weights) {
                *sum += share * weight;
            }
        }
        Self { bias, time, row, offset: dot(last_bias, &contrast), contrast }
    }

    /// z of some Gaussians; their hidden layers stay in `scratch` for [`Self::backward`].
    pub(super) fn logits(
        &self,
        network: &Network,
        places: &Places,
        rows: &[u32],
        scratch: &mut Scratch,
        logits: &mut [f32],
    ) {
        let Scratch { places: encoded, layers, .. } = scratch;
        places.of(rows, encoded);
        let width = network.width;
        let [first, second, third] = layers;
        for layer in [&mut *first, &mut *second, &mut *third] {
            layer.resize(rows.len() * width, 0.0);
        }
        let [from_place, _, _, to_second, second_bias, to_third, third_bias, ..] = &network.lists;
        matmul::forward(encoded, from_place, first, width);
        rectify(first, &self.bias);
        matmul::forward(first, to_second, second, width);
        rectify(second, second_bias);
        matmul::forward(second, to_third, third, width);
        rectify(third, third_bias);
        for (logit, hidden) in logits.iter_mut().zip(third.chunks_exact(width)) {
            *logit = dot(hidden, &self.row) + self.offset;
        }
    }

    /// Adds what `slopes`, the derivatives by z, mean for the layers behind the encoding; what they mean for the last
    /// layer and the convolution is collected in `sums`.
    pub(super) fn backward(
        &self,
        network: &Network,
        scratch: &mut Scratch,
        slopes: &[f32],
        gradient: &mut Network,
        sums: &mut Ends,
    ) {
        let width = network.width;
        let Scratch { places, layers: [first, second, third], slopes: [later, earlier] } = scratch;
        later.resize(third.len(), 0.0);
        earlier.resize(third.len(), 0.0);
        let rows = later.chunks_exact_mut(width).zip(third.chunks_exact(width));
        for ((later, hidden), &slope) in rows.zip(slopes) {
            for ((value, &hidden), (&weight, sum)) in
                later.iter_mut().zip(hidden).zip(self.row.iter().zip(&mut sums.hidden))
            {
                *sum += slope * hidden;
                *value = if hidden > 0.0 { slope * weight } else { 0.0 };
            }
            sums.slope += slope;
        }
        let [_, _, _, to_second, _, to_third, ..] = &network.lists;
        let [to_place, _, first_bias, by_second, second_bias, by_third, third_bias, ..] = &mut gradient.lists;
        let hidden =
            [(to_third, by_third, third_bias, &*second), (to_second, by_second, second_bias, &*first)];
        for (weight, by_weight, by_bias, input) in hidden {
            matmul::backward_weight(later, input, by_weight, width);
            add_rows(by_bias, later);
            matmul::backward_input(later, weight, earlier, width, false);
            for (value, &input) in earlier.iter_mut().zip(input) {
                if input <= 0.0 {
                    *value = 0.0;
                }
            }
            std::mem::swap(later, earlier);
        }
        matmul::backward_weight(later, places, to_place, width);
        add_rows(first_bias, later);
    }

    /// Ends the gradient: what was collected for the last layer and the convolution, whose bias has the derivative
    /// `bias`, and the part of the first layer that reads the time, which all Gaussians share.
    pub(super) fn finish(&self, network: &Network, sums: &Ends, bias: f32, gradient: &mut Network) {
        let width = network.width;
        let [.., last, last_bias, _, _] = &network.lists;
        let [_, by_time, by_first_bias, .., by_last, by_last_bias, by_decoder, by_decoder_bias] =
            &mut gradient.lists;
        for (weights, slope) in by_time.chunks_exact_mut(TIME).zip(by_first_bias) {
            for (weight, time) in weights.iter_mut().zip(&self.time) {
                *weight = *slope * time;
            }
        }
        let features = last.chunks_exact(width).zip(by_last.chunks_exact_mut(width)).zip(&self.contrast);
        for (feature, ((weights, slopes), &contrast)) in features.enumerate() {
            for (slope, hidden) in slopes.iter_mut().zip(&sums.hidden) {
                *slope = contrast * hidden;
            }
            by_last_bias[feature] = contrast * sums.slope;
            let decoder = dot(weights, &sums.hidden) + last_bias[feature] * sums.slope;
            by_decoder[feature] = -decoder;
            by_decoder[network.features + feature] = decoder;
        }
        by_decoder_bias.copy_from_slice(&[-bias, bias]);
    }
}

/// Sums over Gaussians from which the gradients of the last layers are made.
#[derive(Debug, Clone)]
pub(super) struct Ends {
    /// Of slope times last hidden layer.
    hidden: Vec<f32>,
    /// Of the slopes.
    slope: f32,
}

impl Ends {
    pub(super) fn zeros(width: usize) -> Self {
        Self { hidden: vec![0.0; width], slope: 0.0 }
    }

    pub(super) fn clear(&mut self) {
        self.hidden.fill(0.0);
        self.slope = 0.0;
    }

    pub(super) fn add(&mut self, other: &Self) {
        add(&mut self.hidden, &other.hidden);
        self.slope += other.slope;
    }
}

fn dot(a: &[f32], b: &[f32]) -> f32 {
    // Eight sums side by side: a single one could not use vector instructions.
    let (heads, tail) = a.as_chunks::<8>();
    let (others, other_tail) = b.as_chunks::<8>();
    let mut sums = [0.0_f32; 8];
    for (a, b) in heads.iter().zip(others) {
        for lane in 0..8 {
            sums[lane] += a[lane] * b[lane];
        }
    }
    sums.iter().sum::<f32>() + tail.iter().zip(other_tail).map(|(a, b)| a * b).sum::<f32>()
}

/// Adds the bias and cuts off below 0. NaN stays: a diverged network is found, not hidden.
fn rectify(layer: &mut [f32], bias: &[f32]) {
    for row in layer.chunks_exact_mut(bias.len()) {
        for (value, bias) in row.iter_mut().zip(bias) {
            let sum = *value + bias;
            *value = if sum < 0.0 { 0.0 } else { sum };
        }
    }
}

fn add_rows(sums: &mut [f32], rows: &[f32]) {
    rows.chunks_exact(sums.len()).for_each(|row| add(sums, row));
}

fn add(sums: &mut [f32], values: &[f32]) {
    for (sum, value) in sums.iter_mut().zip(values) {
        *sum += value;
    }
}
