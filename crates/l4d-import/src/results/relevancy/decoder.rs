//! The decoder of an autoencoder: what leads from latents to the width of CLIP or E5.
//!
//! Read from the `state_dict` that the originals' training leaves; widths follow from the shapes and are never asked
//! for. The encoder and its running statistics are left alone.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::DataError;
use l4d_formats::fault::quoted;
use l4d_formats::{Fault, Tensor, arrays, pickle};

/// Numbers of a layer's output: E5 has 4096.
const WIDEST: usize = 1 << 14;
/// Layers; the deepest published one has 8.
const DEEPEST: usize = 64;

/// A linear layer.
#[derive(Debug, Clone, PartialEq)]
pub struct Layer {
    /// Numbers that go in.
    pub inputs: usize,
    /// Numbers that come out.
    pub outputs: usize,
    /// A row of `inputs` numbers for each output.
    pub weight: Vec<f32>,
    /// What is added to each output.
    pub bias: Vec<f32>,
}

/// Linear layers, each but the last followed by a ReLU; what comes out is divided by its length.
#[derive(Debug, Clone, PartialEq)]
pub struct Decoder {
    layers: Vec<Layer>,
}

impl Decoder {
    /// A decoder of these layers, unless they do not follow upon each other.
    pub fn new(layers: Vec<Layer>) -> Option<Self> {
        let is_sound = |layer: &Layer| {
            layer.inputs > 0
                && layer.outputs > 0
                && layer.weight.len() == layer.inputs * layer.outputs
                && layer.bias.len() == layer.outputs
        };
        let follows = layers.windows(2).all(|pair| pair[0].outputs == pair[1].inputs);
        (!layers.is_empty() && follows && layers.iter().all(is_sound)).then_some(Self { layers })
    }

    /// Reads a `state_dict` (`.pth`) or an `.npz` of the same names.
    ///
    /// # Errors
    /// Files that cannot be read, and parameters that make no decoder.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        let tensors =
            if arrays::extension(path) == "npz" { from_npz(path)? } else { pickle::read_state_dict(path)? };
        Self::from_tensors(&tensors).map_err(|fault| fault.at(path))
    }

    pub fn layers(&self) -> &[Layer] {
        &self.layers
    }

    /// Channels of a latent.
    pub fn inputs(&self) -> usize {
        self.layers[0].inputs
    }

    /// Numbers of an embedding.
    pub fn outputs(&self) -> usize {
        self.layers[self.layers.len() - 1].outputs
    }

    /// The widths as a person would write them.
    pub fn widths(&self) -> String {
        let outputs = self.layers.iter().map(|layer| layer.outputs.to_string());
        let all: Vec<String> = std::iter::once(self.inputs().to_string()).chain(outputs).collect();
        all.join(" -> ")
    }

    fn from_tensors(tensors: &BTreeMap<String, Tensor>) -> Result<Self, Fault> {
        let mut numbers: Vec<usize> = tensors.keys().filter_map(|name| layer_number(name)).collect();
        numbers.sort_unstable();
        numbers.dedup();
        if numbers.is_empty() || numbers.len() > DEEPEST {
            let known = tensors.keys().take(6).map(String::as_str).collect::<Vec<_>>().join(", ");
            let (count, known) = (numbers.len(), quoted(&known));
            let message = format!("has {count} layers called `decoder.<n>.weight` (it has {known})");
            let hint = "give the autoencoder's best_ckpt.pth, not the checkpoint of the Gaussians";
            return Err(Fault::new("state dict", message, hint));
        }
        let layers: Vec<Layer> =
            numbers.iter().map(|&number| layer(tensors, number)).collect::<Result<_, _>>()?;
        for (pair, number) in layers.windows(2).zip(&numbers[1..]) {
            let (given, taken) = (pair[0].outputs, pair[1].inputs);
            if given != taken {
                let message = format!("takes {taken} numbers, but the layer before gives {given}");
                return Err(fault(&format!("decoder.{number}.weight"), message));
            }
        }
        Ok(Self { layers })
    }
}

fn fault(parameter: &str, message: String) -> Fault {
    let hint = "give the whole state dict of one autoencoder: linear layers, as the originals build them";
    Fault::new(format!("parameter `{parameter}`"), message, hint)
}

fn layer(tensors: &BTreeMap<String, Tensor>, number: usize) -> Result<Layer, Fault> {
    let (weight_name, bias_name) = (format!("decoder.{number}.weight"), format!("decoder.{number}.bias"));
    let find = |name: &str| {
        let is_it =
            |key: &str| key.strip_suffix(name).is_some_and(|rest| rest.is_empty() || rest.ends_with('.'));
        let found = tensors.iter().find(|(key, _)| is_it(key));
        found.map(|(_, tensor)| tensor).ok_or_else(|| fault(name, "is missing".to_owned()))
    };
    let (weight, bias) = (find(&weight_name)?, find(&bias_name)?);
    let [outputs, inputs] = weight.shape[..] else {
        let message = format!("has the shape {:?}, but a linear layer has two axes", weight.shape);
        return Err(fault(&weight_name, message));
    };
    if !(1..=WIDEST).contains(&outputs) || !(1..=WIDEST).contains(&inputs) {
        let message = format!("is {outputs} x {inputs}, but a layer has 1 to {WIDEST} numbers");
        return Err(fault(&weight_name, message));
    }
    if bias.shape != [outputs] {
        let message = format!("has the shape {:?}, but the weight needs [{outputs}]", bias.shape);
        return Err(fault(&bias_name, message));
    }
    Ok(Layer { inputs, outputs, weight: weight.data.clone(), bias: bias.data.clone() })
}

fn layer_number(name: &str) -> Option<usize> {
    let rest = name.strip_suffix(".weight")?;
    let (before, number) = rest.rsplit_once('.')?;
    (before == "decoder" || before.ends_with(".decoder")).then(|| number.parse().ok())?
}

fn from_npz(path: &Path) -> Result<BTreeMap<String, Tensor>, DataError> {
    let mut tensors = BTreeMap::new();
    for name in arrays::names(path)?.into_iter().filter(|name| name.contains("decoder.")) {
        let tensor = arrays::read(path, Some(&name))?;
        tensor.check_finite(&name).map_err(|fault| fault.at(path))?;
        tensors.insert(name, tensor);
    }
    Ok(tensors)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tensors(shapes: &[(&str, &[usize])]) -> BTreeMap<String, Tensor> {
        let tensor =
            |shape: &[usize]| Tensor { shape: shape.to_vec(), data: vec![0.5; shape.iter().product()] };
        shapes.iter().map(|(name, shape)| ((*name).to_owned(), tensor(shape))).collect()
    }

    #[test]
    fn widths_follow_from_the_shapes_in_the_order_of_the_layers() {
        let found = tensors(&[
            ("encoder.0.weight", &[2, 9]),
            ("decoder.10.weight", &[9, 5]),
            ("decoder.10.bias", &[9]),
            ("decoder.2.weight", &[5, 4]),
            ("decoder.2.bias", &[5]),
            ("decoder.0.weight", &[4, 3]),
            ("decoder.0.bias", &[4]),
        ]);
        let decoder = Decoder::from_tensors(&found).unwrap();
        assert_eq!(decoder.widths(), "3 -> 4 -> 5 -> 9");
    }

    #[test]
    fn what_makes_no_decoder_is_named() {
        let refused =
            |shapes: &[(&str, &[usize])]| Decoder::from_tensors(&tensors(shapes)).unwrap_err().to_string();
        let gaussians = refused(&[("_xyz", &[2, 3])]);
        assert!(gaussians.contains("_xyz"), "{gaussians}");
        assert!(refused(&[("decoder.0.weight", &[4, 3])]).contains("`decoder.0.bias`: is missing"));
        assert!(refused(&[("decoder.0.weight", &[4, 3, 1]), ("decoder.0.bias", &[4])]).contains("two axes"));
        assert!(refused(&[("decoder.0.weight", &[4, 3]), ("decoder.0.bias", &[5])]).contains("needs [4]"));
        let gap = [
            ("decoder.0.weight", &[4, 3][..]),
            ("decoder.0.bias", &[4]),
            ("decoder.2.weight", &[5, 7]),
            ("decoder.2.bias", &[5]),
        ];
        assert!(refused(&gap).contains("takes 7 numbers, but the layer before gives 4"));
    }
}
