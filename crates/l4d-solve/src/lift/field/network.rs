//! The layers: phi (paper, equation 2), four linear layers with rectifiers between them, and the 1x1 convolution behind the blend.
//!
//! With two classes only the difference of the logits counts, which is linear in the last hidden layer h: z = u h + c
//! with u and c made of the last layer and the convolution ([`Collapsed`]). Parameters and what Adam knows of them stay
//! those of the layers as the paper has them, so that learning takes the same way.

use l4d_splat::tensor::Tensor;

use super::encoding::{self, PLACE, Places, TIME};
use l4d_splat::deform::matmul;

/// Names of the parameters, in the order of [`Network::lists`].
pub(super) const NAMES: [&str; 11] = [
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

/// All parameters, or their gradient; matrices are \[outputs\]\[inputs\].
#[derive(Debug, Clone, PartialEq)]
pub struct Network {
    pub(super) width: usize,
    pub(super) features: usize,
    /// The part of the first layer that reads the encoded place: \[width\]\[63\].
    pub(super) from_place: Vec<f32>,
    /// The part of the first layer that reads the encoded time: \[width\]\[9\].
    pub(super) from_time: Vec<f32>,
    pub(super) first_bias: Vec<f32>,
    /// The second and third layer: \[width\]\[width\] and a bias.
    pub(super) hidden: [(Vec<f32>, Vec<f32>); 2],
    /// \[features\]\[width\].
    pub(super) last: Vec<f32>,
    pub(super) last_bias: Vec<f32>,
    /// \[2\]\[features\]: not the answer, the answer.
    pub(super) decoder: Vec<f32>,
    pub(super) decoder_bias: Vec<f32>,
}

impl Network {
    pub(super) fn zeros(width: usize, features: usize) -> Self {
        let hidden = || (vec![0.0; width * width], vec![0.0; width]);
        Self {
            width,
            features,
            from_place: vec![0.0; width * PLACE],
            from_time: vec![0.0; width * TIME],
            first_bias: vec![0.0; width],
            hidden: [hidden(), hidden()],
            last: vec![0.0; features * width],
            last_bias: vec![0.0; features],
            decoder: vec![0.0; 2 * features],
            decoder_bias: vec![0.0; 2],
        }
    }

    /// Every parameter once, in the order of [`NAMES`].
    pub(super) fn lists(&self) -> [&[f32]; 11] {
        let [second, third] = &self.hidden;
        [
            &self.from_place,
            &self.from_time,
            &self.first_bias,
            &second.0,
            &second.1,
            &third.0,
            &third.1,
            &self.last,
            &self.last_bias,
            &self.decoder,
            &self.decoder_bias,
        ]
    }

    pub(super) fn lists_mut(&mut self) -> [&mut Vec<f32>; 11] {
        let [second, third] = &mut self.hidden;
        [
            &mut self.from_place,
            &mut self.from_time,
            &mut self.first_bias,
            &mut second.0,
            &mut second.1,
            &mut third.0,
            &mut third.1,
            &mut self.last,
            &mut self.last_bias,
            &mut self.decoder,
            &mut self.decoder_bias,
        ]
    }

    fn shapes(width: usize, features: usize) -> [Vec<usize>; 11] {
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

    pub(super) fn tensors(&self) -> Vec<(&'static str, Tensor)> {
        let shapes = Self::shapes(self.width, self.features);
        let lists = self.lists().into_iter().zip(shapes);
        NAMES.into_iter().zip(lists.map(|(list, shape)| Tensor { shape, data: list.to_vec() })).collect()
    }

    /// A network of tensors by name; the name of the one that is missing or has another shape otherwise.
    pub(in crate::lift) fn from_tensors(
        width: usize,
        features: usize,
        mut tensor: impl FnMut(&str, &[usize]) -> Option<Vec<f32>>,
    ) -> Result<Self, &'static str> {
        let mut network = Self { width, features, ..Self::zeros(0, 0) };
        let shapes = Self::shapes(width, features);
        for ((list, name), shape) in network.lists_mut().into_iter().zip(NAMES).zip(shapes) {
            *list = tensor(name, &shape).ok_or(name)?;
        }
        Ok(network)
    }

    /// Width of the hidden layers, and numbers of a feature.
    pub(in crate::lift) fn sizes(&self) -> (usize, usize) {
        (self.width, self.features)
    }

    /// Difference of the convolution's biases.
    pub(super) fn bias(&self) -> f32 {
        self.decoder_bias[1] - self.decoder_bias[0]
    }

    /// Difference of the convolution's rows.
    fn contrast(&self) -> Vec<f32> {
        let (not, is) = self.decoder.split_at(self.features);
        is.iter().zip(not).map(|(is, not)| is - not).collect()
    }

    pub(super) fn clear(&mut self) {
        self.lists_mut().into_iter().for_each(|list| list.fill(0.0));
    }

    pub(super) fn add(&mut self, other: &Self) {
        for (sums, values) in self.lists_mut().into_iter().zip(other.lists()) {
            for (sum, value) in sums.iter_mut().zip(values) {
                *sum += value;
            }
        }
    }
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
        let time = encoding::time(time);
        let read = network.from_time.chunks_exact(TIME);
        let bias = network.first_bias.iter().zip(read).map(|(bias, weights)| bias + dot(weights, &time));
        let contrast = network.contrast();
        let mut row = vec![0.0; network.width];
        for (weights, &share) in network.last.chunks_exact(network.width).zip(&contrast) {
            for (sum, weight) in row.iter_mut().zip(weights) {
                *sum += share * weight;
            }
        }
        Self { bias: bias.collect(), time, row, offset: dot(&network.last_bias, &contrast), contrast }
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
        matmul::forward(encoded, &network.from_place, first, width);
        rectify(first, &self.bias);
        matmul::forward(first, &network.hidden[0].0, second, width);
        rectify(second, &network.hidden[0].1);
        matmul::forward(second, &network.hidden[1].0, third, width);
        rectify(third, &network.hidden[1].1);
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
        for (layer, input) in [(1, &*second), (0, &*first)] {
            let (weight, bias) = &mut gradient.hidden[layer];
            matmul::backward_weight(later, input, weight, width);
            add_rows(bias, later);
            matmul::backward_input(later, &network.hidden[layer].0, earlier, width, false);
            for (value, &input) in earlier.iter_mut().zip(input) {
                if input <= 0.0 {
                    *value = 0.0;
                }
            }
            std::mem::swap(later, earlier);
        }
        matmul::backward_weight(later, places, &mut gradient.from_place, width);
        add_rows(&mut gradient.first_bias, later);
    }

    /// Ends the gradient: what was collected for the last layer and the convolution, whose bias has the derivative
    /// `bias`, and the part of the first layer that reads the time, which all Gaussians share.
    pub(super) fn finish(&self, network: &Network, sums: &Ends, bias: f32, gradient: &mut Network) {
        let width = network.width;
        for (weights, slope) in gradient.from_time.chunks_exact_mut(TIME).zip(&gradient.first_bias) {
            for (weight, time) in weights.iter_mut().zip(&self.time) {
                *weight = slope * time;
            }
        }
        let features =
            network.last.chunks_exact(width).zip(gradient.last.chunks_exact_mut(width)).zip(&self.contrast);
        for (feature, ((weights, slopes), &contrast)) in features.enumerate() {
            for (slope, hidden) in slopes.iter_mut().zip(&sums.hidden) {
                *slope = contrast * hidden;
            }
            gradient.last_bias[feature] = contrast * sums.slope;
            let decoder = dot(weights, &sums.hidden) + network.last_bias[feature] * sums.slope;
            gradient.decoder[feature] = -decoder;
            gradient.decoder[network.features + feature] = decoder;
        }
        gradient.decoder_bias.copy_from_slice(&[-bias, bias]);
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
        for (sum, value) in self.hidden.iter_mut().zip(&other.hidden) {
            *sum += value;
        }
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
    for row in rows.chunks_exact(sums.len()) {
        for (sum, value) in sums.iter_mut().zip(row) {
            *sum += value;
        }
    }
}
