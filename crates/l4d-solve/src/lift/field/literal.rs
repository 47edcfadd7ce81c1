//! The objective as the paper writes it (equations 2 to 6), in f64: all features blended, the decoder behind the blend, softmax and
//! logarithms of probabilities, two evaluations of phi. The executable specification of `learn`.

use super::encoding::{PLACE, Places, TIME, time};
use super::network::Network;
use super::settings::FieldSettings;

/// What a picture is made of: for each pixel the Gaussians in it with their weights, and whether it is inside.
pub(super) struct Shot {
    pub(super) time: f32,
    pub(super) pixels: Vec<(Vec<(usize, f64)>, bool)>,
    /// Sampled Gaussians, each with its neighbours.
    pub(super) near: Vec<(usize, Vec<usize>)>,
}

/// Parameters or gradients: layers as (weight \[outputs\]\[inputs\], bias), the decoder last.
pub(super) type Layers = Vec<(Vec<Vec<f64>>, Vec<f64>)>;

/// The five layers of a network, the first with places and times side by side.
pub(super) fn layers(network: &Network) -> Layers {
    let wide = |list: &[f32]| list.iter().map(|&value| f64::from(value)).collect::<Vec<f64>>();
    let rows = |list: &[f32], inputs: usize| list.chunks(inputs).map(wide).collect::<Vec<_>>();
    let places = network.from_place.chunks(PLACE).zip(network.from_time.chunks(TIME));
    let first = places.map(|(place, time)| [wide(place), wide(time)].concat()).collect();
    let width = network.width;
    vec![
        (first, wide(&network.first_bias)),
        (rows(&network.hidden[0].0, width), wide(&network.hidden[0].1)),
        (rows(&network.hidden[1].0, width), wide(&network.hidden[1].1)),
        (rows(&network.last, width), wide(&network.last_bias)),
        (rows(&network.decoder, network.features), wide(&network.decoder_bias)),
    ]
}

/// All numbers, layer by layer.
pub(super) fn flat(layers: &Layers) -> Vec<f64> {
    layers.iter().flat_map(|(weight, bias)| weight.iter().flatten().chain(bias)).copied().collect()
}

pub(super) fn set(layers: &mut Layers, numbers: &[f64]) {
    let places = layers.iter_mut().flat_map(|(weight, bias)| weight.iter_mut().flatten().chain(bias));
    places.zip(numbers).for_each(|(place, &number)| *place = number);
}

fn apply((weight, bias): &(Vec<Vec<f64>>, Vec<f64>), input: &[f64]) -> Vec<f64> {
    weight
        .iter()
        .zip(bias)
        .map(|(row, bias)| row.iter().zip(input).map(|(a, b)| a * b).sum::<f64>() + bias)
        .collect()
}

/// phi: what every layer was given, and the feature.
fn phi(layers: &Layers, input: &[f64]) -> (Vec<Vec<f64>>, Vec<f64>) {
    let mut inputs = vec![input.to_vec()];
    for layer in &layers[..3] {
        let hidden = apply(layer, &inputs[inputs.len() - 1]);
        inputs.push(hidden.into_iter().map(|value| value.max(0.0)).collect());
    }
    let feature = apply(&layers[3], &inputs[3]);
    (inputs, feature)
}

fn softmax(logits: &[f64]) -> Vec<f64> {
    let most = logits.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let powers: Vec<f64> = logits.iter().map(|logit| (logit - most).exp()).collect();
    let sum: f64 = powers.iter().sum();
    powers.into_iter().map(|power| power / sum).collect()
}

/// Adds the gradient of a layer, and gives that of its input.
fn back(
    layer: &(Vec<Vec<f64>>, Vec<f64>),
    input: &[f64],
    slopes: &[f64],
    gradient: &mut (Vec<Vec<f64>>, Vec<f64>),
) -> Vec<f64> {
    let mut before = vec![0.0; input.len()];
    for (output, &slope) in slopes.iter().enumerate() {
        gradient.1[output] += slope;
        for (place, &value) in input.iter().enumerate() {
            gradient.0[output][place] += slope * value;
            before[place] += slope * layer.0[output][place];
        }
    }
    before
}

fn back_phi(layers: &Layers, inputs: &[Vec<f64>], slopes: &[f64], gradient: &mut Layers) {
    let mut slopes = slopes.to_vec();
    for layer in (0..4).rev() {
        slopes = back(&layers[layer], &inputs[layer], &slopes, &mut gradient[layer]);
        if layer > 0 {
            slopes
                .iter_mut()
                .zip(&inputs[layer])
                .filter(|(_, value)| **value <= 0.0)
                .for_each(|(s, _)| *s = 0.0);
        }
    }
}

/// The loss and its gradient.
pub(super) fn loss(
    layers: &Layers,
    means: &[[f32; 3]],
    shot: &Shot,
    settings: &FieldSettings,
) -> (f64, Layers) {
    let places = Places::new(means);
    let encoded = |gaussian: usize| {
        let mut place = Vec::new();
        places.of(&[gaussian as u32], &mut place);
        place.iter().chain(&time(shot.time)).map(|&value| f64::from(value)).collect::<Vec<f64>>()
    };
    let mut gradient: Layers = layers
        .iter()
        .map(|(weight, bias)| (vec![vec![0.0; weight[0].len()]; weight.len()], vec![0.0; bias.len()]))
        .collect();
    let features = layers[3].1.len();
    let mut total = 0.0;

    // L_2d.
    let evaluated: Vec<_> = (0..means.len()).map(|gaussian| phi(layers, &encoded(gaussian))).collect();
    let mut feature_slopes = vec![vec![0.0; features]; means.len()];
    let share = settings.lambda_2d * settings.normalisation.pixels() / shot.pixels.len() as f64;
    for (contributions, inside) in &shot.pixels {
        let mut blended = vec![0.0; features];
        for &(gaussian, weight) in contributions {
            blended.iter_mut().zip(&evaluated[gaussian].1).for_each(|(sum, value)| *sum += weight * value);
        }
        let probabilities = softmax(&apply(&layers[4], &blended));
        let class = usize::from(*inside);
        total -= share * probabilities[class].ln();
        let slopes: Vec<f64> =
            (0..2).map(|c| share * (probabilities[c] - f64::from(u8::from(c == class)))).collect();
        let slopes = back(&layers[4], &blended, &slopes, &mut gradient[4]);
        for &(gaussian, weight) in contributions {
            feature_slopes[gaussian].iter_mut().zip(&slopes).for_each(|(sum, slope)| *sum += weight * slope);
        }
    }
    for ((inputs, _), slopes) in evaluated.iter().zip(&feature_slopes) {
        back_phi(layers, inputs, slopes, &mut gradient);
    }

    // L_3d, from a second evaluation.
    let evaluated: Vec<_> = (0..means.len()).map(|gaussian| phi(layers, &encoded(gaussian))).collect();
    let identities: Vec<Vec<f64>> =
        evaluated.iter().map(|(_, feature)| softmax(&apply(&layers[4], feature))).collect();
    let mut identity_slopes = vec![[0.0; 2]; means.len()];
    let pairs = shot.near.iter().map(|(_, near)| near.len()).sum::<usize>().max(1);
    let share = settings.lambda_3d * settings.normalisation.neighbours() / pairs as f64;
    for (sample, near) in &shot.near {
        for other in near {
            for class in 0..2 {
                let (p, q) = (identities[*sample][class], identities[*other][class]);
                total += share * p * (p / q).ln();
                identity_slopes[*sample][class] += share * ((p / q).ln() + 1.0);
                identity_slopes[*other][class] -= share * p / q;
            }
        }
    }
    for (((inputs, feature), identity), slopes) in evaluated.iter().zip(&identities).zip(&identity_slopes) {
        let mean: f64 = identity.iter().zip(slopes).map(|(p, slope)| p * slope).sum();
        let slopes: Vec<f64> = identity.iter().zip(slopes).map(|(p, slope)| p * (slope - mean)).collect();
        let slopes = back(&layers[4], feature, &slopes, &mut gradient[4]);
        back_phi(layers, inputs, &slopes, &mut gradient);
    }
    (total, gradient)
}

/// Adam, as its authors write it.
pub(super) struct Adam {
    pub(super) first: Vec<f64>,
    pub(super) second: Vec<f64>,
    pub(super) steps: i32,
}

impl Adam {
    pub(super) fn step(&mut self, numbers: &mut [f64], gradient: &[f64], rate: f64) {
        self.steps += 1;
        for (index, (number, gradient)) in numbers.iter_mut().zip(gradient).enumerate() {
            self.first[index] = 0.9 * self.first[index] + 0.1 * gradient;
            self.second[index] = 0.999 * self.second[index] + 0.001 * gradient * gradient;
            let first = self.first[index] / (1.0 - 0.9_f64.powi(self.steps));
            let second = self.second[index] / (1.0 - 0.999_f64.powi(self.steps));
            *number -= rate * first / (second.sqrt() + 1e-15);
        }
    }
}
