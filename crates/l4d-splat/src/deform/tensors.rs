//! Names and shapes of a field's parameters in a checkpoint: those of 4DGaussians' `state_dict`.
//!
//! There a plane is \[1, channels, second axis, first axis\]; here the channels of a texel are adjacent.

use std::collections::BTreeMap;

use crate::tensor::Tensor;

use super::bounds::Bounds;
use super::config::DeformConfig;
use super::error::DeformError;
use super::field::{DeformationField, FieldGradients};
use super::grid::{Grid, Plane};
use super::network::Network;

const BOX: &str = "deformation_net.grid.aabb";

fn plane_name(level: usize, pair: usize) -> String {
    format!("deformation_net.grid.grids.{level}.{pair}")
}

/// Names of the layers without `.weight` and `.bias`, in the order of [`Network::layers`].
fn layer_names() -> impl Iterator<Item = String> {
    let heads = ["pos", "scales", "rotations", "opacity", "shs"];
    let layers = heads.into_iter().flat_map(|head| [(head, 1), (head, 3)]);
    let names = layers.map(|(head, place)| format!("deformation_net.{head}_deform.{place}"));
    std::iter::once("deformation_net.feature_out.0".to_owned()).chain(names)
}

impl DeformationField {
    /// Every parameter by its name in 4DGaussians' `deformation.pth`, the box included. What that file has beyond
    /// them (frequency lists and a time network that is never called) is not part of a field.
    pub fn tensors(&self) -> BTreeMap<String, Tensor> {
        let mut tensors = tensors(&self.grid, &self.network);
        let corners = self.bounds().corners().as_flattened().to_vec();
        tensors.insert(BOX.to_owned(), Tensor { shape: vec![2, 3], data: corners });
        tensors
    }

    /// A field with these sizes from the tensors that `lookup` finds by their names in `deformation.pth`.
    ///
    /// # Errors
    /// A configuration that cannot be, a box without inside, and a tensor that is missing, has another shape than
    /// the configuration says, or holds a value that is not finite, by name.
    pub fn from_tensors<'a>(
        config: DeformConfig,
        lookup: impl Fn(&str) -> Option<&'a Tensor>,
    ) -> Result<Self, DeformError> {
        config.validate()?;
        let corners = found(&lookup, BOX, &[2, 3])?.as_chunks().0;
        let bounds = Bounds::new([corners[0], corners[1]])?;
        let mut field = Self::zeros(config, bounds)?;
        for (level, planes) in field.grid.levels.iter_mut().enumerate() {
            for (pair, plane) in planes.iter_mut().enumerate() {
                let shape = plane_shape(plane);
                read_plane(found(&lookup, &plane_name(level, pair), &shape)?, plane);
            }
        }
        for (name, layer) in layer_names().zip(field.network.layers_mut()) {
            let shape = [layer.outputs(), layer.inputs()];
            layer.weight.copy_from_slice(found(&lookup, &format!("{name}.weight"), &shape)?);
            layer.bias.copy_from_slice(found(&lookup, &format!("{name}.bias"), &shape[..1])?);
        }
        Ok(field)
    }
}

impl FieldGradients {
    /// Every derivative by the name of its parameter.
    pub fn tensors(&self) -> BTreeMap<String, Tensor> {
        tensors(&self.grid, &self.network)
    }
}

fn tensors(grid: &Grid, network: &Network) -> BTreeMap<String, Tensor> {
    let mut tensors = BTreeMap::new();
    for (level, planes) in grid.levels.iter().enumerate() {
        for (pair, plane) in planes.iter().enumerate() {
            let tensor = Tensor { shape: plane_shape(plane).to_vec(), data: written_plane(plane) };
            tensors.insert(plane_name(level, pair), tensor);
        }
    }
    for (name, layer) in layer_names().zip(network.layers()) {
        let shape = vec![layer.outputs(), layer.inputs()];
        tensors
            .insert(format!("{name}.bias"), Tensor { shape: shape[..1].to_vec(), data: layer.bias.clone() });
        tensors.insert(format!("{name}.weight"), Tensor { shape, data: layer.weight.clone() });
    }
    tensors
}

fn plane_shape(plane: &Plane) -> [usize; 4] {
    [1, plane.channels, plane.rows, plane.columns]
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

/// The numbers of a tensor that must be there, have this shape and be finite.
fn found<'a>(
    lookup: &impl Fn(&str) -> Option<&'a Tensor>,
    name: &str,
    shape: &[usize],
) -> Result<&'a [f32], DeformError> {
    let wrong = |message: String| DeformError(format!("tensor `{name}`: {message}"));
    let tensor = lookup(name).ok_or_else(|| {
        wrong("is missing: the file is not a deformation field, or the configuration is another's".to_owned())
    })?;
    if tensor.shape != shape {
        let message = format!(
            "has the shape {:?}, but the configuration makes it {shape:?}: give the configuration that belongs to the \
             checkpoint",
            tensor.shape
        );
        return Err(wrong(message));
    }
    let numbers: usize = shape.iter().product();
    if tensor.data.len() != numbers {
        return Err(wrong(format!("has {} numbers, but its shape holds {numbers}", tensor.data.len())));
    }
    match tensor.data.iter().position(|value| !value.is_finite()) {
        Some(place) => {
            Err(wrong(format!("value {place} is {}: the checkpoint has diverged", tensor.data[place])))
        }
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
        assert_eq!(DeformationField::from_tensors(small(), |name| tensors.get(name)), Ok(field()));
    }

    #[test]
    fn what_is_missing_misshapen_or_not_finite_is_refused_by_name() {
        let refused = |change: fn(&mut BTreeMap<String, Tensor>)| {
            let mut tensors = field().tensors();
            change(&mut tensors);
            DeformationField::from_tensors(small(), |name| tensors.get(name)).unwrap_err().to_string()
        };
        let missing = refused(|tensors| drop(tensors.remove("deformation_net.shs_deform.1.bias")));
        assert!(missing.starts_with("tensor `deformation_net.shs_deform.1.bias`: is missing"), "{missing}");
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
