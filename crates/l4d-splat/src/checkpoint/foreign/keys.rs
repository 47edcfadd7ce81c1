//! Names and shapes in the state dict of a 4DGaussians deformation.

use crate::deform::DeformConfig;

/// What everything that a field computes with begins with.
pub const PREFIX: &str = "deformation_net.";

/// Corners of the box in which planes are sampled, `[2][3]`: row 0 is the maximum, row 1 the minimum.
pub const AABB: &str = "deformation_net.grid.aabb";

/// The axes (x, y, z, t as 0 to 3) of the six planes of a level; the first runs along a plane's last dimension.
pub const PAIRS: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// The heads, and what each adds to.
pub const HEADS: [&str; 5] =
    ["pos_deform", "scales_deform", "rotations_deform", "opacity_deform", "shs_deform"];

/// Name of a plane.
pub fn plane(level: usize, pair: usize) -> String {
    format!("{PREFIX}grid.grids.{level}.{pair}")
}

/// Shape of a plane: `[1, channels, samples of the second axis, samples of the first]`.
pub fn plane_shape(config: &DeformConfig, multiplier: u32, pair: usize) -> Vec<usize> {
    let samples = |axis: usize| match config.spatial_resolution.get(axis) {
        Some(&samples) => samples.saturating_mul(multiplier as usize),
        None => config.time_resolution,
    };
    let [first, second] = PAIRS[pair];
    vec![1, config.channels, samples(second), samples(first)]
}

/// Names and shapes of all parameters that a field computes with: box, planes, linear layers.
///
/// Linear weights are `[out][in]`, biases `[out]`. All five heads are there, also those that are switched off.
pub fn field_shapes(config: &DeformConfig) -> Vec<(String, Vec<usize>)> {
    let mut shapes = vec![(AABB.to_owned(), vec![2, 3])];
    for (level, &multiplier) in config.multires.iter().enumerate() {
        shapes
            .extend((0..PAIRS.len()).map(|pair| (plane(level, pair), plane_shape(config, multiplier, pair))));
    }
    let mut linear = |name: String, outputs: usize, inputs: usize| {
        shapes.push((format!("{PREFIX}{name}.weight"), vec![outputs, inputs]));
        shapes.push((format!("{PREFIX}{name}.bias"), vec![outputs]));
    };
    linear("feature_out.0".to_owned(), config.width, config.channels.saturating_mul(config.multires.len()));
    let outputs = [3, 3, 4, 1, config.sh_coefficients.saturating_mul(3)];
    for (head, outputs) in HEADS.into_iter().zip(outputs) {
        linear(format!("{head}.1"), config.width, config.width);
        linear(format!("{head}.3"), outputs, config.width);
    }
    shapes
}

/// Parameters that the original saves and nothing computes with: tables of powers of two, and a network for time.
pub(super) fn is_unused(name: &str) -> bool {
    let tables = ["time_poc", "pos_poc", "rotation_scaling_poc", "opacity_poc"];
    name.starts_with("timenet.") || tables.contains(&name)
}
