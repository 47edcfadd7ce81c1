//! A deformation field as one would write it on paper: f64, one row, one number at a time. Slow and obvious.

use std::collections::BTreeMap;

use l4d_splat::Tensor;
use l4d_splat::deform::{DeformConfig, TimeAxis};

use crate::fixtures::wide;

pub(crate) type Doubles = BTreeMap<String, (Vec<usize>, Vec<f64>)>;

pub(crate) fn doubles(tensors: &BTreeMap<String, Tensor>) -> Doubles {
    let double = |tensor: &Tensor| (tensor.shape.clone(), wide(&tensor.data));
    tensors.iter().map(|(name, tensor)| (name.clone(), double(tensor))).collect()
}

/// Offsets of one Gaussian: a list a head, in the order of the fields of `Offsets`, empty where it is off.
pub(crate) fn offsets(
    config: &DeformConfig,
    tensors: &Doubles,
    position: [f64; 3],
    time: f64,
) -> [Vec<f64>; 5] {
    let corners = &tensors["deformation_net.grid.aabb"].1;
    let mut at: Vec<f64> = (0..3)
        .map(|axis| 2.0 * (position[axis] - corners[axis]) / (corners[3 + axis] - corners[axis]) - 1.0)
        .collect();
    at.push(if config.time_axis == TimeAxis::Whole { 2.0 * time - 1.0 } else { time });

    let mut features = Vec::new();
    for level in 0..config.multires.len() {
        for channel in 0..config.channels {
            let pairs = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];
            let factors = pairs.iter().enumerate().map(|(index, &(a, b))| {
                let plane = &tensors[&format!("deformation_net.grid.grids.{level}.{index}")];
                bilinear(plane, channel, at[a], at[b])
            });
            features.push(factors.product::<f64>());
        }
    }
    let hidden = linear(tensors, "feature_out.0", &features);
    let heads = [
        ("pos", config.no_dx),
        ("scales", config.no_ds),
        ("rotations", config.no_dr),
        ("opacity", config.no_do),
        ("shs", config.no_dshs),
    ];
    heads.map(|(head, is_off)| {
        if is_off {
            return Vec::new();
        }
        let inner = linear(tensors, &format!("{head}_deform.1"), &relu(&hidden));
        linear(tensors, &format!("{head}_deform.3"), &relu(&inner))
    })
}

fn bilinear((shape, plane): &(Vec<usize>, Vec<f64>), channel: usize, across: f64, along: f64) -> f64 {
    let (rows, columns) = (shape[2], shape[3]);
    let index = |coordinate: f64, count: usize| {
        ((coordinate + 1.0) / 2.0 * (count as f64 - 1.0)).clamp(0.0, count as f64 - 1.0)
    };
    let (x, y) = (index(across, columns), index(along, rows));
    let texel = |column: f64, row: f64| {
        let (column, row) = ((column as usize).min(columns - 1), (row as usize).min(rows - 1));
        plane[(channel * rows + row) * columns + column]
    };
    let (left, top) = (x.floor(), y.floor());
    let (right_share, bottom_share) = (x - left, y - top);
    let line = |row: f64| texel(left, row) * (1.0 - right_share) + texel(left + 1.0, row) * right_share;
    line(top) * (1.0 - bottom_share) + line(top + 1.0) * bottom_share
}

fn linear(tensors: &Doubles, name: &str, input: &[f64]) -> Vec<f64> {
    let weight = &tensors[&format!("deformation_net.{name}.weight")].1;
    let bias = &tensors[&format!("deformation_net.{name}.bias")].1;
    let row = |(row, bias): (&[f64], &f64)| row.iter().zip(input).map(|(w, x)| w * x).sum::<f64>() + bias;
    weight.chunks(input.len()).zip(bias).map(row).collect()
}

fn relu(values: &[f64]) -> Vec<f64> {
    values.iter().map(|value| value.max(0.0)).collect()
}
