//! Feature splatting and its transpose: numbers from Gaussians to pixels, and from pixels to Gaussians.

use std::ops::Range;

use l4d_splat::raster::Contribution;
use wgpu::Buffer;

use crate::bands::Band;
use crate::commands::{Commands, groups_of, whole};
use crate::error::{Failure, GpuError};
use crate::projection::Projection;
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
        for band in scene.bands()? {
            let values = splat_band(scene, band, &features)?;
            unpack(&values, channels, &block, &mut pixels[band.first_pixel * channels..]);
        }
    }
    Ok(pixels)
}

fn splat_band(scene: &Projection<'_>, band: Band, features: &Buffer) -> Result<Vec<[f32; WIDTH]>, Failure> {
    let values = scene.gpu.buffer("pixels", band.bytes())?;
    let mut commands = scene.gpu.commands();
    scene.over_tiles(
        &mut commands,
        Pass::SplatFeatures,
        band,
        [0, 0],
        &[&scene.transmittances(band)?, features, &values],
    )?;
    let readback = commands.copy_out(&values, 0, band.bytes())?;
    commands.submit();
    Ok(scene.gpu.read_back(&readback)?)
}

/// Pixels to Gaussians, `channels` each.
pub(crate) fn gather_features(
    scene: &Projection<'_>,
    pixels: &[f32],
    channels: usize,
) -> Result<Vec<f32>, Failure> {
    let mut features = vec![0.0; scene.splats.len() * channels];
    for block in blocks(channels) {
        let packed = pack(pixels, channels, &block);
        let sums = sum_over_pairs(scene, CHANNELS, |commands, band, pairs, partials| {
            let channels_of_pixels = scene.gpu.filled("pixels", &packed[band.first_pixel..band.end_pixel])?;
            scene.over_tiles(
                commands,
                Pass::GatherFeatures,
                band,
                pairs,
                &[&scene.transmittances(band)?, &channels_of_pixels, partials],
            )
        })?;
        let mut commands = scene.gpu.commands();
        let readback = commands.copy_out(&sums, 0, sums_bytes(scene, CHANNELS))?;
        commands.submit();
        let values: Vec<[f32; WIDTH]> = scene.gpu.read_back(&readback)?;
        unpack(&values, channels, &block, &mut features);
    }
    Ok(features)
}

/// For each Gaussian the sums over its tiles of `width` numbers that `fill` leaves for each pair. As many pairs at
/// a time as the adapter has room for, which changes nothing about the order in which they are added.
pub(crate) fn sum_over_pairs(
    scene: &Projection<'_>,
    width: u32,
    fill: impl Fn(&mut Commands<'_>, Band, [u32; 2], &Buffer) -> Result<(), GpuError>,
) -> Result<Buffer, Failure> {
    let gpu = scene.gpu;
    let count = scene.splats.len() as u32;
    let sums = gpu.buffer("sums of Gaussians", sums_bytes(scene, width))?;
    let pair_bytes = 4 * u64::from(width);
    // At least one, so that a limit without room for it is named where the buffer is made.
    let batch = (gpu.limits.binding / pair_bytes).clamp(1, scene.pair_count.max(1).into()) as u32;
    let partials = gpu.buffer("sums of pairs", pair_bytes * u64::from(batch))?;
    let bands = scene.bands()?;
    for first in (0..scene.pair_count).step_by(batch as usize) {
        let pairs = [first, scene.pair_count.min(first.saturating_add(batch))];
        for &band in &bands {
            let mut commands = gpu.commands();
            fill(&mut commands, band, pairs, &partials)?;
            commands.submit();
        }
        let mut commands = gpu.commands();
        commands.run(
            Pass::Reduce,
            groups_of(u64::from(count) * u64::from(width), LANES),
            &[count, width, pairs[0], pairs[1]],
            &[whole(&scene.order), whole(&scene.offsets), whole(&partials), whole(&sums)],
        )?;
        commands.submit();
    }
    Ok(sums)
}

fn sums_bytes(scene: &Projection<'_>, width: u32) -> u64 {
    4 * u64::from(width) * scene.splats.len() as u64
}

/// The Gaussians blended into one pixel.
pub(crate) fn contributors(
    scene: &Projection<'_>,
    column: u32,
    row: u32,
) -> Result<Vec<Contribution>, Failure> {
    let gpu = scene.gpu;
    let [first, end] = scene.ranges[scene.tile_of([column, row]) as usize];
    let bytes = 8 * u64::from(end - first);
    let shown = gpu.buffer("weights of a pixel", bytes)?;
    let mut commands = gpu.commands();
    scene.over_tile(&mut commands, Pass::Contributors, [column, row], &shown)?;
    let shown = commands.copy_out(&shown, 0, bytes)?;
    commands.submit();
    let shown: Vec<[u32; 2]> = gpu.read_back(&shown)?;
    let contributions = shown
        .into_iter()
        .map(|[index, weight]| Contribution { index, weight: f32::from_bits(weight) })
        .filter(|contribution| contribution.weight > 0.0);
    Ok(contributions.collect())
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
