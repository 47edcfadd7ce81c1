//! Feature splatting and its transpose: numbers from Gaussians to pixels, and from pixels to Gaussians.

use std::ops::Range;

use wgpu::Buffer;

use crate::commands::{Commands, groups_of, whole};
use crate::error::{Failure, GpuError};
use crate::projection::{PIXEL_BYTES, Projection};
use crate::shaders::{CHANNELS, LANES, Pass};

const WIDTH: usize = CHANNELS as usize;

/// Features to pixels, `channels` each.
pub(crate) fn splat_features(
    scene: &Projection<'_>,
    features: &[f32],
    channels: usize,
) -> Result<Vec<f32>, Failure> {
    let mut pixels = vec![0.0; scene.view.pixel_count() * channels];
    for block in blocks(channels) {
        let features = scene.gpu.filled("features", &pack(features, channels, &block))?;
        let bytes = PIXEL_BYTES * scene.view.pixel_count() as u64;
        let values = scene.gpu.buffer("pixels", bytes)?;
        let mut commands = scene.gpu.commands();
        scene.over_tiles(&mut commands, Pass::SplatFeatures, &[&features, &values])?;
        let values: Vec<[f32; WIDTH]> = commands.answer(&values, bytes)?;
        unpack(&values, channels, &block, &mut pixels);
    }
    Ok(pixels)
}

/// Pixels to Gaussians, `channels` each.
pub(crate) fn gather_features(
    scene: &Projection<'_>,
    pixels: &[f32],
    channels: usize,
) -> Result<Vec<f32>, Failure> {
    let mut features = vec![0.0; scene.splats.len() * channels];
    for block in blocks(channels) {
        let pixels = scene.gpu.filled("pixels", &pack(pixels, channels, &block))?;
        let mut commands = scene.gpu.commands();
        let sums = sum_over_pairs(scene, &mut commands, CHANNELS, Pass::GatherFeatures, &pixels)?;
        let values: Vec<[f32; WIDTH]> =
            commands.answer(&sums, 4 * u64::from(CHANNELS) * scene.splats.len() as u64)?;
        unpack(&values, channels, &block, &mut features);
    }
    Ok(features)
}

/// For each Gaussian the sums over its tiles of the `width` numbers that a pass leaves for each pair.
pub(crate) fn sum_over_pairs(
    scene: &Projection<'_>,
    commands: &mut Commands<'_>,
    width: u32,
    pass: Pass,
    pixels: &Buffer,
) -> Result<Buffer, GpuError> {
    let count = scene.splats.len() as u32;
    let numbers = u64::from(width) * u64::from(count);
    let sums = scene.gpu.buffer("sums of Gaussians", 4 * numbers)?;
    let partials = scene.gpu.buffer("sums of pairs", 4 * u64::from(width) * u64::from(scene.pair_count))?;
    scene.over_tiles(commands, pass, &[pixels, &partials])?;
    let bindings = [&scene.order, &scene.offsets, &partials, &sums].map(whole);
    commands.run(Pass::Reduce, groups_of(numbers, LANES), &[count, width], &bindings)?;
    Ok(sums)
}

/// As many channels as one pass carries, and the rest.
fn blocks(channels: usize) -> impl Iterator<Item = Range<usize>> {
    (0..channels).step_by(WIDTH).map(move |first| first..channels.min(first + WIDTH))
}

/// A block of the channels of all rows, padded with zeros.
fn pack(rows: &[f32], channels: usize, block: &Range<usize>) -> Vec<[f32; WIDTH]> {
    let pack_row = |row: &[f32]| {
        let mut packed = [0.0; WIDTH];
        packed[..block.len()].copy_from_slice(&row[block.clone()]);
        packed
    };
    rows.chunks_exact(channels).map(pack_row).collect()
}

/// A block of channels to its place in rows of all channels.
fn unpack(packed: &[[f32; WIDTH]], channels: usize, block: &Range<usize>, rows: &mut [f32]) {
    for (row, packed) in rows.chunks_exact_mut(channels).zip(packed) {
        row[block.clone()].copy_from_slice(&packed[..block.len()]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn channels_travel_in_blocks_and_come_back() {
        assert_eq!(blocks(0).count(), 0);
        assert_eq!(blocks(19).collect::<Vec<_>>(), [0..8, 8..16, 16..19]);
        let rows: Vec<f32> = (0..3 * 19).map(|i| i as f32).collect();
        let mut back = vec![f32::NAN; rows.len()];
        for block in blocks(19) {
            let packed = pack(&rows, 19, &block);
            assert!(packed.iter().all(|row| row[block.len()..].iter().all(|&padding| padding == 0.0)));
            unpack(&packed, 19, &block, &mut back);
        }
        assert_eq!(back, rows);
    }
}
