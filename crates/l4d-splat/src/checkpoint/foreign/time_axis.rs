//! The original looks times 0 to 1 up on an axis from -1 to 1, so that the first half of a plane is never read.

use std::collections::BTreeMap;

use super::keys;
use crate::deform::{DeformConfig, TimeAxis};
use crate::tensor::Tensor;

/// The same field on the half axis. T samples of a whole axis become 2 T - 1: the last T are the same, and times meet
/// them at the same places, since (t + 1) / 2 * (2 T - 2) = (T - 1) + t * (T - 1).
pub(super) fn on_half(
    config: &DeformConfig,
    mut tensors: BTreeMap<String, Tensor>,
) -> (DeformConfig, BTreeMap<String, Tensor>) {
    let mut config = config.clone();
    if config.time_axis == TimeAxis::Half {
        return (config, tensors);
    }
    let padding = config.time_resolution.saturating_sub(1);
    for level in 0..config.multires.len() {
        for pair in (0..keys::PAIRS.len()).filter(|&pair| keys::PAIRS[pair][1] == TIME) {
            if let Some(plane) = tensors.get_mut(&keys::plane(level, pair)) {
                *plane = padded(plane, padding);
            }
        }
    }
    config.time_axis = TimeAxis::Half;
    config.time_resolution += padding;
    (config, tensors)
}

const TIME: usize = 3;

/// A plane `[1, channels, time, space]` with copies of its first row before it, channel by channel.
fn padded(plane: &Tensor, padding: usize) -> Tensor {
    let &[one, channels, rows, columns] = plane.shape.as_slice() else { return plane.clone() };
    let mut data = Vec::with_capacity(channels * (rows + padding) * columns);
    for channel in plane.data.chunks_exact((rows * columns).max(1)) {
        (0..padding).for_each(|_| data.extend_from_slice(&channel[..columns]));
        data.extend_from_slice(channel);
    }
    Tensor { shape: vec![one, channels, rows + padding, columns], data }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_row_of_every_channel_is_repeated_before_it() {
        let plane = Tensor { shape: vec![1, 2, 2, 2], data: vec![1., 2., 3., 4., 5., 6., 7., 8.] };
        let expected = vec![1., 2., 1., 2., 3., 4., 5., 6., 5., 6., 7., 8.];
        assert_eq!(padded(&plane, 1), Tensor { shape: vec![1, 2, 3, 2], data: expected });
    }
}
