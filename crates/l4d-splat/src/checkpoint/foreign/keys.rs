//! Names and shapes in the state dict of a 4DGaussians deformation.

use crate::checkpoint::cfg_args::{CfgArgs, Literal};
use crate::deform::DeformConfig;
use crate::tensor::Tensor;

/// Everything that a field computes with stands below it.
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

/// What the original's loader asks for and nothing computes with: four tables of powers of two, and a network for time.
pub fn ballast(args: &CfgArgs) -> Vec<(String, Tensor)> {
    let size = |option: &str, default: usize| match args.get(option) {
        Some(Literal::Int(value)) => {
            usize::try_from(*value).ok().filter(|size| *size <= 1024).unwrap_or(default)
        }
        _ => default,
    };
    let powers = |name: &str, count: usize| {
        let data: Vec<f32> = (0..count as i32).map(|power| 2_f32.powi(power)).collect();
        (name.to_owned(), Tensor { shape: vec![count], data })
    };
    let zeros = |name: &str, shape: &[usize]| {
        (format!("timenet.{name}"), Tensor { shape: shape.to_vec(), data: vec![0.0; shape.iter().product()] })
    };
    let frequencies = size("timebase_pe", 4);
    let (width, output) = (size("timenet_width", 64), size("timenet_output", 32));
    vec![
        powers("time_poc", frequencies),
        powers("pos_poc", size("posebase_pe", 10)),
        powers("rotation_scaling_poc", size("scale_rotation_pe", 2)),
        powers("opacity_poc", size("opacity_pe", 2)),
        zeros("0.weight", &[width, 2 * frequencies + 1]),
        zeros("0.bias", &[width]),
        zeros("2.weight", &[output, width]),
        zeros("2.bias", &[output]),
    ]
}
