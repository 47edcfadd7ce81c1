//! Names and shapes of a field's parameters in a checkpoint: those of 4DGaussians' `state_dict`.
//!
//! There a plane is \[1, channels, second axis, first axis\]; here the channels of a texel are adjacent.

use std::collections::BTreeMap;

use l4d_formats::fault::quoted;

use crate::tensor::Tensor;

use super::DeformError;
use super::bounds::Bounds;
use super::config::DeformConfig;
use super::field::{DeformationField, FieldGradients};
use super::grid::{Grid, PAIRS, Plane};
use super::network::Network;

/// What everything that a field computes with begins with.
pub(crate) const PREFIX: &str = "deformation_net.";

/// Corners of the box in which planes are sampled: row 0 is the maximum, row 1 the minimum.
const BOX: &str = "deformation_net.grid.aabb";

/// Name of a plane.
pub(crate) fn plane_name(level: usize, pair: usize) -> String {
    format!("{PREFIX}grid.grids.{level}.{pair}")
}

impl DeformConfig {
    /// Names and shapes of all parameters that a field computes with: box (row 0 the maximum, row 1 the minimum),
    /// planes, weights \[out\]\[in\] and biases of the linear layers, all five heads among them.
    fn shapes(&self) -> Vec<(String, Vec<usize>)> {
        let mut shapes = vec![(BOX.to_owned(), vec![2, 3])];
        for (level, &multiplier) in self.multires.iter().enumerate() {
            let axes = self.axes(multiplier);
            shapes.extend(PAIRS.iter().enumerate().map(|(pair, &(first, second))| {
                (plane_name(level, pair), vec![1, self.channels, axes[second], axes[first]])
            }));
        }
        let mut linear = |name: String, outputs: usize, inputs: usize| {
            shapes.push((format!("{PREFIX}{name}.weight"), vec![outputs, inputs]));
            shapes.push((format!("{PREFIX}{name}.bias"), vec![outputs]));
        };
        linear("feature_out.0".to_owned(), self.width, self.features());
        for (head, outputs) in ["pos", "scales", "rotations", "opacity", "shs"].iter().zip(self.outputs()) {
            linear(format!("{head}_deform.1"), self.width, self.width);
            linear(format!("{head}_deform.3"), outputs, self.width);
        }
        shapes
    }
}

impl DeformationField {
    /// Every parameter by its name in 4DGaussians' `deformation.pth`, the box included. What that file has beyond
    /// them (frequency lists and a time network that is never called) is not part of a field.
    pub fn tensors(&self) -> BTreeMap<String, Tensor> {
        self.named(self.bounds().corners(), &self.grid, &self.network)
    }

    /// Every derivative by the name of its parameter.
    pub fn gradient_tensors(&self, gradients: &FieldGradients) -> BTreeMap<String, Tensor> {
        let mut tensors = self.named([[0.0; 3]; 2], &gradients.grid, &gradients.network);
        tensors.remove(BOX);
        tensors
    }

    fn named(&self, corners: [[f32; 3]; 2], grid: &Grid, network: &Network) -> BTreeMap<String, Tensor> {
        let layers = network.layers().flat_map(|layer| layer.lists());
        let lists = std::iter::once(corners.as_flattened().to_vec())
            .chain(grid.planes().map(written_plane))
            .chain(layers.map(<[f32]>::to_vec));
        let tensor = |((name, shape), data)| (name, Tensor { shape, data });
        self.config().shapes().into_iter().zip(lists).map(tensor).collect()
    }

    /// A field with these sizes from tensors by their names in `deformation.pth`; others may be beside them.
    ///
    /// # Errors
    /// A configuration that cannot be, a box without inside, and a parameter that is missing, unknown, has another
    /// shape than the configuration says, or holds a value that is not finite, by name.
    pub fn from_tensors(
        config: DeformConfig,
        tensors: &BTreeMap<String, Tensor>,
    ) -> Result<Self, DeformError> {
        config.validate()?;
        // All shapes first: a field makes room for what its configuration says, and that came from a file too.
        let shapes = config.shapes();
        let lists =
            shapes.iter().map(|(name, shape)| found(tensors, name, shape)).collect::<Result<Vec<_>, _>>()?;
        let is_known = |name: &str| shapes.iter().any(|(known, _)| known == name);
        if let Some(name) = tensors.keys().find(|name| name.starts_with(PREFIX) && !is_known(name)) {
            return Err(DeformError(format!(
                "parameter {} is no part of a field with this configuration",
                quoted(name)
            )));
        }
        let mut lists = lists.into_iter();
        let corners = lists.next().unwrap_or_default().as_chunks().0;
        let mut field = Self::zeros(config, Bounds::new([corners[0], corners[1]])?)?;
        for (plane, values) in field.grid.planes_mut().zip(&mut lists) {
            read_plane(values, plane);
        }
        for (list, values) in field.network.layers_mut().flat_map(|layer| layer.lists_mut()).zip(lists) {
            list.copy_from_slice(values);
        }
        Ok(field)
    }
}

fn written_plane(plane: &Plane) -> Vec<f32> {
    let channel = |channel| plane.texels.iter().skip(channel).step_by(plane.channels).copied();
    (0..plane.channels).flat_map(channel).collect()
}

fn read_plane(values: &[f32], plane: &mut Plane) {
    let texels = plane.columns * plane.rows;
    for (channel, values) in values.chunks_exact(texels).enumerate() {
        let texels = plane.texels.iter_mut().skip(channel).step_by(plane.channels);
        for (texel, value) in texels.zip(values) {
            *texel = *value;
        }
    }
}

/// The numbers of a parameter that must be there, have this shape and be finite.
fn found<'a>(
    tensors: &'a BTreeMap<String, Tensor>,
    name: &str,
    shape: &[usize],
) -> Result<&'a [f32], DeformError> {
    let wrong = |message: String| Err(DeformError(format!("parameter `{name}`: {message}")));
    let Some(tensor) = tensors.get(name) else { return wrong("is missing".to_owned()) };
    if tensor.shape != shape {
        return wrong(format!("has the shape {:?}, but the configuration needs {shape:?}", tensor.shape));
    }
    let numbers: usize = shape.iter().product();
    if tensor.data.len() != numbers {
        return wrong(format!("has {} numbers, but its shape holds {numbers}", tensor.data.len()));
    }
    match tensor.data.iter().position(|value| !value.is_finite()) {
        Some(place) => wrong(format!("value {place} is {}: the checkpoint has diverged", tensor.data[place])),
        None => Ok(&tensor.data),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deform::{Init, TimeAxis};

    fn small() -> DeformConfig {
        DeformConfig {
            channels: 2,
            spatial_resolution: [2, 3, 4],
            time_resolution: 5,
            multires: vec![1, 2],
            width: 3,
            sh_coefficients: 4,
            time_axis: TimeAxis::Half,
            ..DeformConfig::dynerf()
        }
    }

    fn field() -> DeformationField {
        let bounds = Bounds::new([[1.0; 3], [-1.0; 3]]).unwrap();
        DeformationField::new(small(), bounds, Init::Foreign, 0).unwrap()
    }

    #[test]
    fn names_and_shapes_are_those_of_the_foreign_checkpoint() {
        let tensors = field().tensors();
        let shape = |name: &str| tensors[name].shape.clone();
        assert_eq!(tensors.len(), 1 + 12 + 2 * 11);
        assert_eq!(shape("deformation_net.grid.aabb"), [2, 3]);
        // Plane 2 is (x, t): time is the slower axis, and no level multiplies it.
        assert_eq!(shape("deformation_net.grid.grids.0.2"), [1, 2, 5, 2]);
        assert_eq!(shape("deformation_net.grid.grids.1.3"), [1, 2, 8, 6]);
        assert_eq!(shape("deformation_net.feature_out.0.weight"), [3, 4]);
        assert_eq!(shape("deformation_net.rotations_deform.3.weight"), [4, 3]);
        assert_eq!(shape("deformation_net.shs_deform.3.bias"), [12]);
        assert_eq!(shape("deformation_net.opacity_deform.1.weight"), [3, 3]);
    }

    #[test]
    fn channels_stand_apart_in_the_checkpoint() {
        let mut field = field();
        // Texel (column 1, row 2) of plane (x, z) of level 0 with its 2 columns and 4 rows.
        field.grid.levels[0][1].texel_mut(1, 2).copy_from_slice(&[7.0, 8.0]);
        let tensor = &field.tensors()["deformation_net.grid.grids.0.1"];
        assert_eq!([tensor.data[2 * 2 + 1], tensor.data[8 + 2 * 2 + 1]], [7.0, 8.0]);
    }

    #[test]
    fn tensors_make_the_same_field_again() {
        let tensors = field().tensors();
        assert_eq!(DeformationField::from_tensors(small(), &tensors), Ok(field()));
    }

    #[test]
    fn what_is_missing_misshapen_or_not_finite_is_refused_by_name() {
        let refused = |change: fn(&mut BTreeMap<String, Tensor>)| {
            let mut tensors = field().tensors();
            change(&mut tensors);
            DeformationField::from_tensors(small(), &tensors).unwrap_err().to_string()
        };
        let missing = refused(|tensors| drop(tensors.remove("deformation_net.shs_deform.1.bias")));
        assert!(
            missing.starts_with("parameter `deformation_net.shs_deform.1.bias`: is missing"),
            "{missing}"
        );
        let misshapen = refused(|tensors| {
            tensors.get_mut("deformation_net.grid.grids.0.0").unwrap().shape = vec![1, 2, 2, 3];
        });
        assert!(
            misshapen.contains("`deformation_net.grid.grids.0.0`: has the shape [1, 2, 2, 3]"),
            "{misshapen}"
        );
        let short = refused(|tensors| {
            tensors.get_mut("deformation_net.grid.grids.1.5").unwrap().data.pop().unwrap();
        });
        assert!(short.contains("`deformation_net.grid.grids.1.5`"), "{short}");
        let poisoned = refused(|tensors| {
            tensors.get_mut("deformation_net.pos_deform.3.weight").unwrap().data[4] = f32::NAN;
        });
        assert!(poisoned.contains("`deformation_net.pos_deform.3.weight`: value 4 is NaN"), "{poisoned}");
        let flat = refused(|tensors| tensors.get_mut("deformation_net.grid.aabb").unwrap().data[4] = 1.0);
        assert!(flat.contains("axis y runs from 1 to 1"), "{flat}");
    }
}
