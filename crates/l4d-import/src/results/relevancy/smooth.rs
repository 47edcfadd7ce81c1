//! From a relevancy map to a mask: a box filter, a threshold relative to the map's range, and a majority filter, as
//! LangSplat and 4D LangSplat have them. Knows neither latents nor sentences.
//!
//! Filters are running sums, so that their cost does not depend on the size of the window. The sums are in double
//! precision: a single one would keep errors of numbers that have left the window.

use l4d_masks::Mask;

use super::{Found, Rules, Smoothing, Summit};

/// Finds in the relevancy map of a sentence its mask and its peak; `map` is row-major.
pub(super) fn find(mut map: Vec<f32>, width: usize, height: usize, rules: &Rules) -> Found {
    let summit = blend(&mut map, width, height, rules.smoothing);
    let floor = map.iter().copied().fold(f32::INFINITY, f32::min);
    let peak = map.iter().copied().fold(f32::NEG_INFINITY, f32::max);
    // The originals' order of operations and precision, so that borderline pixels fall on the same side.
    let range = (peak - floor) + 1e-9;
    let is_inside = |value: f32| ((value - floor) / range * 2.0 - 1.0).clamp(0.0, 1.0) > rules.threshold;
    let unsmoothed = Mask::from_fn(width as u32, height as u32, |col, row| {
        is_inside(map[row as usize * width + col as usize])
    });
    let mask = majority(&unsmoothed, rules.smoothing);
    Found { mask, unsmoothed, peak, floor, summit }
}

/// Replaces each number by the average of itself and its window's mean; gives where the window's mean is highest.
fn blend(map: &mut Vec<f32>, width: usize, height: usize, smoothing: Smoothing) -> Summit {
    let (before, after) = match smoothing {
        Smoothing::Box30 => (15, 14),
        Smoothing::Pool29 => (14, 14),
    };
    let is_mirrored = smoothing == Smoothing::Box30;
    let row_windows = windows(height, before, after, is_mirrored);
    let col_windows = windows(width, before, after, is_mirrored);
    let mut blended = Vec::with_capacity(map.len());
    let mut best = (0, f32::NEG_INFINITY);
    let mut column_sums = vec![0.0_f64; width];
    for (row, window) in row_windows.iter().enumerate() {
        for &(other, sign) in &window.changes {
            let line = &map[other * width..][..width];
            column_sums.iter_mut().zip(line).for_each(|(sum, &value)| *sum += sign * f64::from(value));
        }
        let mut sum = 0.0;
        for (col, across) in col_windows.iter().enumerate() {
            across.changes.iter().for_each(|&(other, sign)| sum += sign * column_sums[other]);
            let mean = (sum / (window.count * across.count)) as f32;
            if mean > best.1 {
                best = (row * width + col, mean);
            }
            blended.push(0.5 * (mean + map[row * width + col]));
        }
    }
    *map = blended;
    Summit::at(best.0, best.1, width, height)
}

/// A window along one axis, as its difference from the window before it.
struct Window {
    /// Indices that come in (1.0) or go out (-1.0).
    changes: Vec<(usize, f64)>,
    /// Number of indices in it.
    count: f64,
}

/// The windows around each index of an axis, `before` and `after` it; mirrored at the borders or cut by them.
fn windows(length: usize, before: usize, after: usize, is_mirrored: bool) -> Vec<Window> {
    let place = |index: i64| {
        let last = length as i64 - 1;
        let is_inside = (0..=last).contains(&index);
        if is_inside { Some(index as usize) } else { is_mirrored.then(|| mirrored(index, last)) }
    };
    let mut count = 0.0;
    let mut windows = Vec::with_capacity(length);
    for centre in 0..length as i64 {
        let (first, last) = (centre - before as i64, centre + after as i64);
        let coming = if centre == 0 { first..=last } else { last..=last };
        let mut changes: Vec<(usize, f64)> = coming.filter_map(place).map(|index| (index, 1.0)).collect();
        if centre > 0 {
            changes.extend(place(first - 1).map(|index| (index, -1.0)));
        }
        count += changes.iter().map(|(_, sign)| sign).sum::<f64>();
        windows.push(Window { changes, count });
    }
    windows
}

/// The index in `0..=last` to which mirroring at both ends maps `index`; the ends are not repeated.
fn mirrored(index: i64, last: i64) -> usize {
    if last == 0 {
        return 0;
    }
    let phase = index.rem_euclid(2 * last);
    phase.min(2 * last - phase) as usize
}

/// Majority filter of 7 x 7 pixels; ties are outside. In LangSplat the last row and column do not vote.
fn majority(mask: &Mask, smoothing: Smoothing) -> Mask {
    const REACH: u32 = 3;
    let (width, height) = mask.size();
    let withheld = u32::from(smoothing == Smoothing::Box30);
    // Summed-area table: pixels of the mask above and to the left of each corner of a pixel.
    let corner = |col: u32, row: u32| row as usize * (width as usize + 1) + col as usize;
    let mut table = vec![0_u32; corner(0, height + 1)];
    for row in 0..height {
        let mut of_row = 0;
        for col in 0..width {
            of_row += u32::from(mask.get(col, row));
            table[corner(col + 1, row + 1)] = table[corner(col + 1, row)] + of_row;
        }
    }
    let span = |centre: u32, side: u32| {
        let end = (centre + REACH + 1).min(side - withheld);
        (centre.saturating_sub(REACH).min(end), end)
    };
    Mask::from_fn(width, height, |col, row| {
        let ((left, right), (top, bottom)) = (span(col, width), span(row, height));
        let inside = table[corner(right, bottom)] + table[corner(left, top)]
            - table[corner(left, bottom)]
            - table[corner(right, top)];
        2 * inside > (right - left) * (bottom - top)
    })
}
