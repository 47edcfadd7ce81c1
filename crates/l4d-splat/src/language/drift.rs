//! `lang_deform` of 4D LangSplat: what three linear layers add to a latent at a time.
//!
//! They get the latent, the time, and sines and cosines of the time by octaves.

use std::collections::BTreeMap;

use l4d_formats::{Fault, Tensor};
use rayon::prelude::*;

use super::HINT;
use crate::deform::{PREFIX, matmul};

/// Latents that go through the layers together.
const BLOCK_ROWS: usize = 256;
/// More octaves than this are no smooth function of a time in single precision.
const MOST_OCTAVES: usize = 24;

/// The layers, each behind a ReLU.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Drift {
    octaves: usize,
    layers: [Layer; 3],
}

#[derive(Debug, Clone, PartialEq)]
struct Layer {
    /// Row-major: outputs x inputs.
    weight: Vec<f32>,
    bias: Vec<f32>,
}

impl Drift {
    /// The layers for latents of so many numbers, from the parameters of the model.
    pub(super) fn new(width: usize, tensors: &BTreeMap<String, Tensor>) -> Result<Self, Fault> {
        let first = input_count("1", tensors)?;
        let octaves = first.checked_sub(width + 1).filter(|rest| rest.is_multiple_of(2)).map(|rest| rest / 2);
        let octaves = octaves.filter(|octaves| *octaves <= MOST_OCTAVES).ok_or_else(|| {
            let message = format!("has {first} inputs, which are no latent of {width} numbers and a time");
            Fault::new(name("1.weight"), message, HINT)
        })?;
        let second = input_count("3", tensors)?;
        let third = input_count("5", tensors)?;
        let layers = [
            Layer::new("1", first, second, tensors)?,
            Layer::new("3", second, third, tensors)?,
            Layer::new("5", third, width, tensors)?,
        ];
        Ok(Self { octaves, layers })
    }

    /// What is added to each of these latents at a time.
    pub(super) fn at(&self, latents: &[f32], width: usize, time: f32) -> Vec<f32> {
        let octaves = || (0..self.octaves).map(|octave| time * (1_u32 << octave) as f32);
        let clock: Vec<f32> =
            std::iter::once(time).chain(octaves().map(f32::sin)).chain(octaves().map(f32::cos)).collect();
        let blocks = latents.par_chunks(BLOCK_ROWS * width).flat_map_iter(|block| {
            let rows = block.chunks(width).flat_map(|latent| latent.iter().chain(&clock)).copied().collect();
            self.layers.iter().fold(rows, |values, layer| layer.forward(values))
        });
        blocks.collect()
    }
}

impl Layer {
    fn new(
        place: &str,
        inputs: usize,
        outputs: usize,
        tensors: &BTreeMap<String, Tensor>,
    ) -> Result<Self, Fault> {
        let part = |part: &str, shape: &[usize]| {
            let name = name(&format!("{place}.{part}"));
            let tensor = found(&name, tensors)?;
            let message = match tensor.data.iter().find(|value| !value.is_finite()) {
                _ if tensor.shape != shape => {
                    format!("has the shape {:?} instead of {shape:?}", tensor.shape)
                }
                Some(value) => format!("holds {value}: training has diverged"),
                None => return Ok(tensor.data.clone()),
            };
            Err(Fault::new(name, message, HINT))
        };
        Ok(Self { weight: part("weight", &[outputs, inputs])?, bias: part("bias", &[outputs])? })
    }

    /// Of rows of inputs the rows of outputs.
    fn forward(&self, mut input: Vec<f32>) -> Vec<f32> {
        input.iter_mut().filter(|value| **value < 0.0).for_each(|value| *value = 0.0);
        let outputs = self.bias.len();
        let mut output = vec![0.0; input.len() * outputs / (self.weight.len() / outputs)];
        matmul::forward(&input, &self.weight, &mut output, outputs);
        for row in output.chunks_exact_mut(outputs) {
            row.iter_mut().zip(&self.bias).for_each(|(value, bias)| *value += bias);
        }
        output
    }
}

fn name(part: &str) -> String {
    format!("{PREFIX}lang_deform.{part}")
}

fn found<'a>(name: &str, tensors: &'a BTreeMap<String, Tensor>) -> Result<&'a Tensor, Fault> {
    tensors.get(name).ok_or_else(|| Fault::new(name, "is missing", HINT))
}

/// How many numbers a layer gets.
fn input_count(place: &str, tensors: &BTreeMap<String, Tensor>) -> Result<usize, Fault> {
    let name = name(&format!("{place}.weight"));
    let shape = &found(&name, tensors)?.shape;
    match shape.as_slice() {
        [outputs, inputs] if *outputs > 0 && *inputs > 0 => Ok(*inputs),
        _ => Err(Fault::new(name, format!("has the shape {shape:?}, which is no layer"), HINT)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tensors() -> BTreeMap<String, Tensor> {
        // Two numbers a latent, one octave: five inputs.
        let shapes =
            [("1.weight", vec![2, 5]), ("1.bias", vec![2]), ("3.weight", vec![1, 2]), ("3.bias", vec![1])];
        let shapes = shapes.into_iter().chain([("5.weight", vec![2, 1]), ("5.bias", vec![2])]);
        let tensor = |(part, shape): (&str, Vec<usize>)| {
            let count = shape.iter().product();
            (name(part), Tensor { shape, data: (0..count).map(|index| index as f32 + 1.0).collect() })
        };
        shapes.map(tensor).collect()
    }

    #[test]
    fn three_layers_by_hand() {
        let drift = Drift::new(2, &tensors()).unwrap();
        // Inputs behind the ReLU: 0.5, 0 (of -2), and of the time 0 its value, sine and cosine 0, 0, 1.
        // First layer: 0.5 + 5 + 1, 3 + 10 + 2. Second: 6.5 + 30 + 1. Third: 37.5 + 1, 75 + 2.
        assert_eq!(drift.at(&[0.5, -2.0], 2, 0.0), [38.5, 77.0]);
    }

    #[test]
    fn layers_that_do_not_fit_are_refused_by_name() {
        type Change = fn(&mut BTreeMap<String, Tensor>);
        let cases: [(&str, Change); 4] = [
            ("lang_deform.1.bias", |tensors| drop(tensors.remove(&name("1.bias")))),
            ("has 5 inputs", |tensors| {
                tensors.get_mut(&name("1.weight")).unwrap().shape = vec![2, 5];
            }),
            ("lang_deform.3.weight", |tensors| {
                tensors.get_mut(&name("3.weight")).unwrap().shape = vec![0, 2];
            }),
            ("holds NaN", |tensors| tensors.get_mut(&name("5.bias")).unwrap().data[1] = f32::NAN),
        ];
        for (said, change) in cases {
            let mut tensors = tensors();
            change(&mut tensors);
            let width = if said == "has 5 inputs" { 3 } else { 2 };
            let fault = Drift::new(width, &tensors).unwrap_err();
            let text = format!("{} {}", fault.place, fault.message);
            assert!(text.contains(said), "{text}");
        }
    }
}
