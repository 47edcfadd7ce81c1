//! The decoder of an autoencoder: what leads from latents to the width of CLIP or E5.
//!
//! Read from the `state_dict` that the originals' training leaves; widths follow from the shapes and are never asked
//! for. The encoder and its running statistics are left alone.

use std::collections::BTreeMap;
use std::path::Path;

use l4d_data::DataError;
use l4d_formats::{Tensor, arrays, pickle};

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
        Self::from_tensors(path, &tensors)
    }

    /// The layers.
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

    fn from_tensors(path: &Path, tensors: &BTreeMap<String, Tensor>) -> Result<Self, DataError> {
        let mut numbers: Vec<usize> = tensors.keys().filter_map(|name| layer_number(name)).collect();
        numbers.sort_unstable();
        numbers.dedup();
        if numbers.is_empty() || numbers.len() > DEEPEST {
            let known: Vec<&str> = tensors.keys().take(6).map(String::as_str).collect();
            return Err(DataError::invalid(
                path,
                "state dict",
                format!(
                    "has {} layers called `decoder.<n>.weight` (it has {})",
                    numbers.len(),
                    l4d_data::error::inert(&known.join(", "))
                ),
                "give the autoencoder's best_ckpt.pth, not the checkpoint of the Gaussians",
            ));
        }
        let mut layers: Vec<Layer> = Vec::new();
        for number in numbers {
            let layer = layer(path, tensors, number)?;
            if let Some(before) = layers.last().filter(|before| before.outputs != layer.inputs) {
                return Err(DataError::invalid(
                    path,
                    format!("parameter `decoder.{number}.weight`"),
                    format!("takes {} numbers, but the layer before gives {}", layer.inputs, before.outputs),
                    "give the whole state dict of one autoencoder",
                ));
            }
            layers.push(layer);
        }
        Ok(Self { layers })
    }
}

fn layer(path: &Path, tensors: &BTreeMap<String, Tensor>, number: usize) -> Result<Layer, DataError> {
    let remedy = "give the whole state dict of one autoencoder: linear layers, as the originals build them";
    let find = |what: &str| {
        let name = format!("decoder.{number}.{what}");
        let found = tensors.iter().find(|(key, _)| **key == name || key.ends_with(&format!(".{name}")));
        let fault =
            |message: String| DataError::invalid(path, format!("parameter `{name}`"), message, remedy);
        found.map(|(_, tensor)| tensor).ok_or_else(|| fault("is missing".to_owned()))
    };
    let (weight, bias) = (find("weight")?, find("bias")?);
    let fault = |what: &str, message: String| {
        DataError::invalid(path, format!("parameter `decoder.{number}.{what}`"), message, remedy)
    };
    let [outputs, inputs] = weight.shape[..] else {
        return Err(fault(
            "weight",
            format!("has the shape {:?}, but a linear layer has two axes", weight.shape),
        ));
    };
    if !(1..=WIDEST).contains(&outputs) || !(1..=WIDEST).contains(&inputs) {
        return Err(fault(
            "weight",
            format!("is {outputs} x {inputs}, but a layer has 1 to {WIDEST} numbers"),
        ));
    }
    if bias.shape != [outputs] {
        return Err(fault(
            "bias",
            format!("has the shape {:?}, but the weight needs [{outputs}]", bias.shape),
        ));
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
        let array = arrays::read(path, Some(&name))?;
        if let Some((index, value)) = array.bad_value() {
            let message = format!("is {value}, but parameters are finite");
            let remedy = "take an earlier checkpoint";
            return Err(DataError::invalid(path, format!("{name}, number {index}"), message, remedy));
        }
        tensors.insert(name, Tensor { shape: array.shape, data: array.data });
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
        let decoder = Decoder::from_tensors(Path::new("x"), &found).unwrap();
        assert_eq!(decoder.widths(), "3 -> 4 -> 5 -> 9");
    }

    #[test]
    fn what_makes_no_decoder_is_named() {
        let refused = |shapes: &[(&str, &[usize])]| {
            Decoder::from_tensors(Path::new("x.pth"), &tensors(shapes)).unwrap_err().to_string()
        };
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
