//! The Gaussians of a model, sampled over the clip and rounded to 16 bits.
//!
//! A row has [`FIXED`] numbers and its spherical harmonics: centre, logarithms of the scales, quaternion, opacity. Each
//! column is rounded to 65 536 steps between its least and its largest value. What stands still comes first, column by
//! column; then, moment by moment, what moves. The page interpolates between moments.

use l4d_data::{StageError, Timeline};
use l4d_splat::splats::{Splats, turn_towards};
use l4d_splat::{Model, ShDegree};
use serde::Serialize;

/// Moments at which Gaussians that move are sampled, at most: every fourth frame of the canonical clip.
pub const MOST_TIMES: usize = 25;
/// What Gaussians may take, bytes. Degrees of colour above 1 are left out first, then moments.
pub const MOST_BYTES: usize = 24_000_000;
/// Moments that are left at least.
const FEWEST_TIMES: usize = 5;
/// Numbers of a Gaussian without its colour: centre, logarithms of scales, quaternion, opacity.
const FIXED: usize = 11;
/// Which of them are the quaternion.
const ROTATION: std::ops::Range<usize> = 6..10;
/// A Gaussian that is thinner than this is drawn like one of this size, units of the world.
const THINNEST: f32 = 1e-6;

/// What the page has to know to read the numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Layout {
    /// Gaussians that stand still.
    pub(crate) still: usize,
    /// Gaussians that move.
    pub(crate) moving: usize,
    /// Numbers of spherical harmonics of a Gaussian, all channels.
    pub(crate) harmonics: usize,
    /// Moments, 0 to 1 over the clip, ascending; one if nothing moves.
    pub(crate) times: Vec<f32>,
    /// Least and largest value of each column.
    pub(crate) ranges: Vec<[f32; 2]>,
}

/// Layout and numbers of a model; numbers are u16, little-endian.
pub(crate) fn sampled(model: &Model, timeline: Timeline) -> Result<(Layout, Vec<u8>), StageError> {
    let (degree, times) = extent(model, timeline)?;
    let hint = "give another model, or train this one again";
    let states: Vec<Splats> = times
        .iter()
        .map(|&time| model.at(time).map_err(|error| StageError::of(&error, hint)))
        .collect::<Result<_, _>>()?;
    let harmonics = 3 * degree.coefficients();
    let count = model.gaussians.len();
    let mut moves = vec![false; count];
    model.dynamic.iter().for_each(|&row| moves[row as usize] = times.len() > 1);
    let rows = |wanted: bool| (0..count).filter(|&row| moves[row] == wanted).collect::<Vec<usize>>();
    let (still, moving) = (rows(false), rows(true));

    let resting = still.iter().map(|&row| numbers(&states[0], row, degree)).collect();
    let mut tables: Vec<Vec<Vec<f32>>> = vec![resting];
    for state in &states {
        let mut table: Vec<Vec<f32>> = moving.iter().map(|&row| numbers(state, row, degree)).collect();
        if let Some(before) = tables.get(1..).and_then(<[_]>::last) {
            table
                .iter_mut()
                .zip(before)
                .for_each(|(row, before)| turn_towards(&mut row[ROTATION], &before[ROTATION]));
        }
        tables.push(table);
    }
    let ranges = ranges(&tables, FIXED + harmonics);
    let layout = Layout { still: still.len(), moving: moving.len(), harmonics, times, ranges };
    Ok((layout.clone(), rounded(&tables, &layout.ranges)))
}

/// Up to which degree, and at which moments, so that the numbers fit.
fn extent(model: &Model, timeline: Timeline) -> Result<(ShDegree, Vec<f32>), StageError> {
    let (count, moving) = (model.gaussians.len(), model.dynamic.len());
    let bytes = |degree: ShDegree, times: usize| {
        2 * (FIXED + 3 * degree.coefficients()) * (count - moving.min(count) + times * moving)
    };
    let whole = timeline.whole();
    let most = match model.field {
        Some(_) if moving > 0 => MOST_TIMES.min(whole.frame_count() as usize).max(2),
        _ => 1,
    };
    let own = model.gaussians.sh_degree;
    let one = ShDegree::new(1).filter(|one| one.get() < own.get()).unwrap_or(own);
    let fewer = (FEWEST_TIMES..most).rev().map(|times| (one, times));
    let choices = [(own, most), (one, most)].into_iter().chain(fewer).chain([(ShDegree::ZERO, most.min(2))]);
    let fits = |&(degree, times): &(ShDegree, usize)| bytes(degree, times) <= MOST_BYTES;
    let Some((degree, times)) = choices.into_iter().find(fits) else {
        let message = format!("{count} Gaussians, {moving} of which move, do not fit into a page");
        return Err(StageError::new(message, "train with fewer --gaussians"));
    };
    let (first, last) = match (model.moments.first(), model.moments.last()) {
        (Some([first, _]), Some([last, _])) => (*first, *last),
        _ => (0.0, 1.0),
    };
    let time = |index: usize| first + (last - first) * index as f32 / (times.max(2) - 1) as f32;
    Ok((degree, (0..times).map(|index| time(index).clamp(first, last)).collect()))
}

/// The row of a Gaussian at a moment.
fn numbers(state: &Splats, row: usize, degree: ShDegree) -> Vec<f32> {
    let scales = state.scales()[row].map(|scale| scale.max(THINNEST).ln());
    let [centre, rotation] = [state.means()[row].as_slice(), state.rotations()[row].as_slice()];
    let harmonics = state.sh_of(row).iter().take(degree.coefficients()).flatten();
    let fixed = centre.iter().chain(&scales).chain(rotation).chain([&state.opacities()[row]]);
    fixed.chain(harmonics).copied().collect()
}

fn ranges(tables: &[Vec<Vec<f32>>], columns: usize) -> Vec<[f32; 2]> {
    let mut ranges = vec![[f32::INFINITY, f32::NEG_INFINITY]; columns];
    for row in tables.iter().flatten() {
        for ([least, largest], value) in ranges.iter_mut().zip(row) {
            *least = least.min(*value);
            *largest = largest.max(*value);
        }
    }
    // A model without Gaussians.
    ranges.iter_mut().filter(|range| range[0] > range[1]).for_each(|range| *range = [0.0; 2]);
    ranges
}

fn rounded(tables: &[Vec<Vec<f32>>], ranges: &[[f32; 2]]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for table in tables {
        for (column, &[least, largest]) in ranges.iter().enumerate() {
            let steps = f32::from(u16::MAX) / (largest - least).max(f32::MIN_POSITIVE);
            for row in table {
                let step = ((row[column] - least) * steps).round().clamp(0.0, f32::from(u16::MAX)) as u16;
                bytes.extend_from_slice(&step.to_le_bytes());
            }
        }
    }
    bytes
}

#[cfg(test)]
mod tests;
