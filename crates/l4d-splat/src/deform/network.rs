//! The layers behind the planes: one linear layer, then five heads of ReLU, linear, ReLU, linear.
//!
//! Works on one block of rows at a time, whose intermediate results stay in a near cache.

use super::config::DeformConfig;
use super::matmul;

/// A linear layer, or its gradient.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Linear {
    /// Row-major: outputs x inputs.
    pub(super) weight: Vec<f32>,
    /// One an output.
    pub(super) bias: Vec<f32>,
}

impl Linear {
    fn zeros(inputs: usize, outputs: usize) -> Self {
        Self { weight: vec![0.0; inputs * outputs], bias: vec![0.0; outputs] }
    }

    pub(super) fn outputs(&self) -> usize {
        self.bias.len()
    }

    pub(super) fn inputs(&self) -> usize {
        self.weight.len() / self.bias.len()
    }

    fn forward(&self, input: &[f32], output: &mut [f32]) {
        matmul::forward(input, &self.weight, output, self.outputs());
        for row in output.chunks_exact_mut(self.outputs()) {
            for (value, bias) in row.iter_mut().zip(&self.bias) {
                *value += bias;
            }
        }
    }

    /// What every head begins with, done once: the layer's output is only ever read through a ReLU.
    fn forward_relu(&self, input: &[f32], output: &mut [f32]) {
        matmul::forward(input, &self.weight, output, self.outputs());
        for row in output.chunks_exact_mut(self.outputs()) {
            for (value, bias) in row.iter_mut().zip(&self.bias) {
                *value = rectified(*value + bias);
            }
        }
    }

    fn add_gradient(&mut self, input: &[f32], output_gradient: &[f32]) {
        let outputs = self.outputs();
        matmul::backward_weight(output_gradient, input, &mut self.weight, outputs);
        for row in output_gradient.chunks_exact(outputs) {
            for (sum, gradient) in self.bias.iter_mut().zip(row) {
                *sum += gradient;
            }
        }
    }

    fn add(&mut self, other: &Self) {
        for (sum, value) in self.lists_mut().into_iter().zip([&other.weight, &other.bias]) {
            for (sum, value) in sum.iter_mut().zip(value) {
                *sum += value;
            }
        }
    }

    pub(super) fn lists_mut(&mut self) -> [&mut [f32]; 2] {
        [&mut self.weight, &mut self.bias]
    }

    pub(super) fn lists(&self) -> [&[f32]; 2] {
        [&self.weight, &self.bias]
    }
}

/// All layers, or their gradient. Heads that are switched off are kept, since checkpoints have them.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Network {
    /// From the features of the planes to the width of the hidden layers.
    pub(super) trunk: Linear,
    /// First and last layer of each head, in the order of [`FIELDS`](crate::gaussians::FIELDS).
    pub(super) heads: [[Linear; 2]; 5],
    is_on: [bool; 5],
}

/// What one block of rows was on its way through the network.
#[derive(Debug, Default)]
pub(super) struct Activations {
    /// What the planes said.
    pub(super) features: Vec<f32>,
    /// ReLU of the first layer.
    trunk: Vec<f32>,
    /// ReLU of the first layer of each head; empty where a head is off.
    hidden: [Vec<f32>; 5],
}

/// Numbers of one block of rows for each head; empty where a head is off.
pub(super) type Slices<'a> = [&'a [f32]; 5];

/// As [`Slices`], to be written.
pub(super) type SlicesMut<'a> = [&'a mut [f32]; 5];

impl Network {
    pub(super) fn zeros(config: &DeformConfig) -> Self {
        let width = config.width;
        let head = |outputs: usize| [Linear::zeros(width, width), Linear::zeros(width, outputs)];
        Self {
            trunk: Linear::zeros(config.features(), width),
            heads: config.outputs().map(head),
            is_on: config.is_on(),
        }
    }

    pub(super) fn zeros_like(&self) -> Self {
        let zeros = |layer: &Linear| Linear::zeros(layer.inputs(), layer.outputs());
        let heads = self.heads.each_ref().map(|layers| layers.each_ref().map(zeros));
        Self { trunk: zeros(&self.trunk), heads, is_on: self.is_on }
    }

    pub(super) fn layers(&self) -> impl Iterator<Item = &Linear> {
        std::iter::once(&self.trunk).chain(self.heads.iter().flatten())
    }

    pub(super) fn layers_mut(&mut self) -> impl Iterator<Item = &mut Linear> {
        std::iter::once(&mut self.trunk).chain(self.heads.iter_mut().flatten())
    }

    pub(super) fn add(&mut self, other: &Self) {
        for (sum, layer) in self.layers_mut().zip(other.layers()) {
            sum.add(layer);
        }
    }

    /// From the features of a block, which are in `block`, to the output of each head.
    pub(super) fn forward(&self, block: &mut Activations, outputs: SlicesMut<'_>) {
        let numbers = block.features.len() / self.trunk.inputs() * self.trunk.outputs();
        block.trunk.resize(numbers, 0.0);
        self.trunk.forward_relu(&block.features, &mut block.trunk);
        for (index, output) in outputs.into_iter().enumerate().filter(|&(index, _)| self.is_on[index]) {
            let [first, last] = &self.heads[index];
            let hidden = &mut block.hidden[index];
            hidden.resize(numbers, 0.0);
            first.forward_relu(&block.trunk, hidden);
            last.forward(hidden, output);
        }
    }

    /// What some rows of many blocks were on their way, as one block. All blocks but the last have `block_rows` rows.
    pub(super) fn gather(
        &self,
        blocks: &[Activations],
        block_rows: usize,
        rows: &[u32],
        into: &mut Activations,
    ) {
        let gather = |list: &dyn Fn(&Activations) -> &[f32], width: usize, into: &mut Vec<f32>| {
            into.clear();
            for row in rows.iter().map(|&row| row as usize) {
                let start = row % block_rows * width;
                into.extend_from_slice(&list(&blocks[row / block_rows])[start..start + width]);
            }
        };
        gather(&|block| &block.features, self.trunk.inputs(), &mut into.features);
        gather(&|block| &block.trunk, self.trunk.outputs(), &mut into.trunk);
        for (head, hidden) in into.hidden.iter_mut().enumerate().filter(|&(head, _)| self.is_on[head]) {
            gather(&|block| &block.hidden[head], self.trunk.outputs(), hidden);
        }
    }

    /// Adds to `gradient` what the outputs' gradients mean for the layers, and writes what they mean for the
    /// features.
    pub(super) fn backward(
        &self,
        block: &Activations,
        outputs: Slices<'_>,
        gradient: &mut Self,
        scratch: &mut Scratch,
        features: &mut [f32],
    ) {
        scratch.trunk.clear();
        scratch.trunk.resize(block.trunk.len(), 0.0);
        scratch.hidden.resize(block.trunk.len(), 0.0);
        for (index, output) in outputs.into_iter().enumerate().filter(|&(index, _)| self.is_on[index]) {
            let ([first, last], hidden) = (&self.heads[index], &block.hidden[index]);
            let [first_gradient, last_gradient] = &mut gradient.heads[index];
            last_gradient.add_gradient(hidden, output);
            matmul::backward_input(output, &last.weight, &mut scratch.hidden, last.outputs(), false);
            block_where_rectified(&mut scratch.hidden, hidden);
            first_gradient.add_gradient(&block.trunk, &scratch.hidden);
            matmul::backward_input(&scratch.hidden, &first.weight, &mut scratch.trunk, first.outputs(), true);
        }
        block_where_rectified(&mut scratch.trunk, &block.trunk);
        gradient.trunk.add_gradient(&block.features, &scratch.trunk);
        matmul::backward_input(&scratch.trunk, &self.trunk.weight, features, self.trunk.outputs(), false);
    }
}

/// Room for the gradients of one block's intermediate results.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    trunk: Vec<f32>,
    hidden: Vec<f32>,
}

/// ReLU that lets NaN through: `max` would turn a diverged network into a silent zero.
fn rectified(value: f32) -> f32 {
    if value < 0.0 { 0.0 } else { value }
}

/// The derivative of the ReLU whose result was `activation`: nothing passes where it cut off.
fn block_where_rectified(gradient: &mut [f32], activation: &[f32]) {
    for (gradient, &activation) in gradient.iter_mut().zip(activation) {
        // Always written: a store that depends on a test is no vector code.
        *gradient = if activation <= 0.0 { 0.0 } else { *gradient };
    }
}
