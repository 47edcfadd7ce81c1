//! What describes an object: its colour, the features of all levels averaged over its mask, and the finest level and
//! the colour averaged over parts of it.
//!
//! `training/l4d_network/model.py` (`pool`) does the same.

/// Numbers of a mask's colour: mean and deviation of R, G, B, and the logarithm of its area.
pub(crate) const COLOUR: usize = 7;

/// Features of one level, channel after channel.
pub(crate) struct Level<'a> {
    pub(crate) channels: usize,
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) values: &'a [f32],
}

/// Rows for the objects 1 to `count` of a label picture at half resolution; `colour` has R, G, B a pixel there, `parts`
/// how much a pixel counts for each part. The finest level comes first.
pub(crate) fn rows(
    labels: &[u32],
    [width, height]: [usize; 2],
    count: usize,
    colour: &[f32],
    parts: &Level<'_>,
    levels: &[Level<'_>],
) -> Vec<Vec<f32>> {
    let mut sums = vec![[0.0_f64; 6]; count];
    let mut areas = vec![0_u32; count];
    for (label, pixel) in labels.iter().zip(colour.chunks_exact(3)) {
        let Some(object) = (*label as usize).checked_sub(1) else { continue };
        areas[object] += 1;
        for (channel, value) in pixel.iter().enumerate() {
            sums[object][channel] += f64::from(*value);
            sums[object][channel + 3] += f64::from(value * value);
        }
    }
    let of_colour = |(sums, area): (&[f64; 6], &u32)| {
        let area = f64::from((*area).max(1));
        let means = [0, 1, 2].map(|channel| sums[channel] / area);
        let deviation = |channel: usize| (sums[channel + 3] / area - means[channel].powi(2)).max(1e-8).sqrt();
        let row = [means[0], means[1], means[2], deviation(0), deviation(1), deviation(2), area.ln() / 10.0];
        row.map(|value| value as f32).to_vec()
    };
    let mut rows: Vec<Vec<f32>> = sums.iter().zip(&areas).map(of_colour).collect();
    for level in levels {
        let means = level_means(labels, [width, height], count, level);
        rows.iter_mut().zip(means).for_each(|(row, means)| row.extend(means));
    }
    if let Some(finest) = levels.first() {
        let means = part_means(labels, count, colour, parts, finest);
        rows.iter_mut().zip(means).for_each(|(row, means)| row.extend(means));
    }
    rows
}

/// Means of the finest level and of the colour over each part of each object.
fn part_means(
    labels: &[u32],
    count: usize,
    colour: &[f32],
    parts: &Level<'_>,
    finest: &Level<'_>,
) -> Vec<Vec<f32>> {
    let (size, numbers) = (labels.len(), finest.channels + 3);
    let mut sums = vec![vec![0.0_f32; parts.channels * numbers]; count];
    let mut totals = vec![vec![0.0_f32; parts.channels]; count];
    let mut pixel = vec![0.0_f32; numbers];
    for (at, label) in labels.iter().enumerate() {
        let Some(object) = (*label as usize).checked_sub(1) else { continue };
        for (channel, value) in pixel[..finest.channels].iter_mut().enumerate() {
            *value = finest.values[channel * size + at];
        }
        pixel[finest.channels..].copy_from_slice(&colour[at * 3..][..3]);
        for (part, sums) in sums[object].chunks_exact_mut(numbers).enumerate() {
            let counts = parts.values[part * size + at];
            totals[object][part] += counts;
            sums.iter_mut().zip(&pixel).for_each(|(sum, value)| *sum += counts * value);
        }
    }
    for (sums, totals) in sums.iter_mut().zip(&totals) {
        for (sums, total) in sums.chunks_exact_mut(numbers).zip(totals) {
            sums.iter_mut().for_each(|sum| *sum /= total.max(1e-6));
        }
    }
    sums
}

/// Means of a level over the share of each of its cells that an object covers.
fn level_means(
    labels: &[u32],
    [width, height]: [usize; 2],
    count: usize,
    level: &Level<'_>,
) -> Vec<Vec<f32>> {
    let (by_column, by_row) = (width / level.width.max(1), height / level.height.max(1));
    let cell_px = (by_column * by_row).max(1) as f32;
    // Cells of each object with the share of the cell that it covers.
    let mut cells: Vec<std::collections::BTreeMap<usize, f32>> = vec![Default::default(); count];
    for (at, label) in labels.iter().enumerate() {
        let Some(object) = (*label as usize).checked_sub(1) else { continue };
        let (row, column) = (at / width / by_row.max(1), at % width / by_column.max(1));
        *cells[object].entry(row * level.width + column).or_default() += 1.0 / cell_px;
    }
    let size = level.width * level.height;
    let mean = |cells: &std::collections::BTreeMap<usize, f32>| {
        let total = cells.values().sum::<f32>().max(1e-6);
        let of_channel = |channel: usize| {
            let values = &level.values[channel * size..][..size];
            cells.iter().map(|(cell, share)| share * values[*cell]).sum::<f32>() / total
        };
        (0..level.channels).map(of_channel).collect()
    };
    cells.iter().map(mean).collect()
}
