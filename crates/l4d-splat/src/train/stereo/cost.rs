//! What it costs to take a pixel for a point on a plane: how much the colours around it differ from what other views show
//! there, by themselves and by their correlation.

use crate::view::View;

use super::super::pinhole::Pinhole;
use super::{NEIGHBOURS, PlaneSweep, StereoImage};

/// A larger difference counts as this one, bytes.
pub(super) const DEAREST: u8 = 60;
/// Half the side of the windows whose correlation counts, pixels.
const RADIUS: usize = 2;
/// Standard deviation of brightness in a window, bytes, from which on correlation counts more than colour, and the share
/// that colour keeps.
const TEXTURE: f32 = 1.0;
const OF_COLOUR: f32 = 0.15;
/// Variance of brightness that is noise, bytes squared.
const NOISE: f32 = 0.3;

/// Another view, as seen along the rays of one.
pub(super) struct Other<'a> {
    /// What the view shows of the ray of a pixel at inverse depth w: `along * ray + w * aside`.
    along: [[f32; 3]; 3],
    aside: [f32; 3],
    colour: &'a [[u8; 3]],
    luma: Vec<f32>,
    size: [usize; 2],
}

/// Columns and rows of a picture, the last ones excluded.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Area {
    first: [usize; 2],
    size: [usize; 2],
}

impl Area {
    /// Around the pixels that are wanted.
    fn around(wanted: &[bool], width: usize) -> Self {
        let height = wanted.len() / width;
        let (mut first, mut end) = ([width, height], [0, 0]);
        for pixel in (0..wanted.len()).filter(|pixel| wanted[*pixel]) {
            let at = [pixel % width, pixel / width];
            for axis in 0..2 {
                first[axis] = first[axis].min(at[axis].saturating_sub(RADIUS));
                end[axis] = end[axis].max((at[axis] + RADIUS + 1).min([width, height][axis]));
            }
        }
        Self { first, size: [0, 1].map(|axis| end[axis].saturating_sub(first[axis])) }
    }

    fn pixels(self, width: usize) -> impl Iterator<Item = usize> {
        (0..self.size[0] * self.size[1])
            .map(move |at| (self.first[1] + at / self.size[0]) * width + self.first[0] + at % self.size[0])
    }
}

/// For each pixel one cost per plane; those of pixels that are not wanted mean nothing.
pub(super) fn costs(
    image: &StereoImage<'_>,
    others: &[StereoImage<'_>],
    sweep: &PlaneSweep,
    wanted: &[bool],
) -> Vec<u8> {
    let planes = sweep.planes;
    let pinhole = Pinhole::new(image.view);
    let width = image.view.width() as usize;
    let others: Vec<Other<'_>> = others.iter().map(|other| Other::new(image.view, other)).collect();
    let area = Area::around(wanted, width);
    let pixels: Vec<usize> = area.pixels(width).collect();
    let own: Vec<f32> = pixels.iter().map(|&pixel| brightness(image.colour[pixel].map(f32::from))).collect();
    let bases: Vec<Vec<[f32; 3]>> = others
        .iter()
        .map(|other| pixels.iter().map(|&pixel| other.base(pinhole.centre_of(pixel))).collect())
        .collect();
    let mut volume = vec![DEAREST; wanted.len() * planes];
    let mut windows = Windows::new(area.size);
    let mut found = vec![[f32::NAN; NEIGHBOURS]; pixels.len()];
    for plane in 0..planes {
        let inverse_depth = sweep.inverse_depth(plane as f32);
        for (index, (other, bases)) in others.iter().zip(&bases).enumerate() {
            for (at, base) in bases.iter().enumerate() {
                let seen =
                    other.colour(std::array::from_fn(|axis| base[axis] + inverse_depth * other.aside[axis]));
                windows.set(at, own[at], image.colour[pixels[at]], seen);
            }
            windows.correlate();
            for (at, found) in found.iter_mut().enumerate() {
                found[index] = windows.cost(at);
            }
        }
        for (found, &pixel) in found.iter().zip(&pixels) {
            let seen = found[..others.len()].iter().copied().filter(|cost| !cost.is_nan());
            volume[pixel * planes + plane] = better_half(seen).map_or(DEAREST, |cost| cost as u8);
        }
    }
    volume
}

/// Mean of the better half: something may be in front of the point in the other views. None without any.
pub(super) fn better_half(costs: impl Iterator<Item = f32>) -> Option<f32> {
    let (mut found, mut count) = ([0.0; NEIGHBOURS], 0);
    for (place, cost) in found.iter_mut().zip(costs) {
        *place = cost;
        count += 1;
    }
    let found = &mut found[..count];
    found.sort_unstable_by(f32::total_cmp);
    let better = count.div_ceil(2);
    (better > 0).then(|| found[..better].iter().sum::<f32>() / better as f32)
}

/// Correlations of two pictures in windows around each pixel of an area.
struct Windows {
    size: [usize; 2],
    /// Difference of colour, bytes; NaN outside the other picture.
    difference: Vec<f32>,
    /// Count, own, other, own squared, other squared, product; of pixels, then of windows.
    sums: [Vec<f32>; 6],
    rows: Vec<f32>,
}

impl Windows {
    fn new(size: [usize; 2]) -> Self {
        let zeros = || vec![0.0; size[0] * size[1]];
        Self { size, difference: zeros(), sums: std::array::from_fn(|_| zeros()), rows: zeros() }
    }

    fn set(&mut self, at: usize, own: f32, colour: [u8; 3], seen: Option<[f32; 3]>) {
        let values = match seen {
            Some(seen) => {
                let differences = seen.iter().zip(colour).map(|(seen, own)| (seen - f32::from(own)).abs());
                self.difference[at] = (differences.sum::<f32>() / 3.0).min(f32::from(DEAREST));
                let other = brightness(seen);
                [1.0, own, other, own * own, other * other, own * other]
            }
            None => {
                self.difference[at] = f32::NAN;
                [0.0; 6]
            }
        };
        for (sums, value) in self.sums.iter_mut().zip(values) {
            sums[at] = value;
        }
    }

    /// From values of pixels to sums over windows.
    fn correlate(&mut self) {
        let [width, height] = self.size;
        for sums in &mut self.sums {
            for (row, sums) in self.rows.chunks_exact_mut(width).zip(sums.chunks_exact(width)) {
                boxes(width, |at| sums[at], |at, sum| row[at] = sum);
            }
            for column in 0..width {
                boxes(height, |at| self.rows[at * width + column], |at, sum| sums[at * width + column] = sum);
            }
        }
    }

    fn cost(&self, at: usize) -> f32 {
        let difference = self.difference[at];
        if difference.is_nan() {
            return f32::NAN;
        }
        let sums = self.sums.each_ref().map(|sums| sums[at]);
        cost_of_window(&sums, difference)
    }
}

/// What a window costs, bytes, from its weighted sums (count, own, other, own squared, other squared, product) and a
/// difference of colour.
pub(super) fn cost_of_window(sums: &[f32], difference: f32) -> f32 {
    let [count, own, other, own_2, other_2, both] = std::array::from_fn(|index| sums[index]);
    let own_variance = (own_2 - own * own / count).max(0.0);
    let other_variance = (other_2 - other * other / count).max(0.0);
    let covariance = both - own * other / count;
    let noise = NOISE * count;
    let correlation = covariance / ((own_variance + noise) * (other_variance + noise)).sqrt();
    let weight = own_variance / (own_variance + count * TEXTURE * TEXTURE);
    let of_correlation = f32::from(DEAREST) * 0.5 * (1.0 - correlation.clamp(-1.0, 1.0));
    (1.0 - weight) * difference + weight * (OF_COLOUR * difference + (1.0 - OF_COLOUR) * of_correlation)
}

/// Sums over runs of `2 RADIUS + 1` of a line.
fn boxes(length: usize, value: impl Fn(usize) -> f32, mut set: impl FnMut(usize, f32)) {
    let mut sum: f32 = (0..RADIUS.min(length)).map(&value).sum();
    for at in 0..length {
        if at + RADIUS < length {
            sum += value(at + RADIUS);
        }
        if at > RADIUS {
            sum -= value(at - RADIUS - 1);
        }
        set(at, sum);
    }
}

pub(super) fn brightness([red, green, blue]: [f32; 3]) -> f32 {
    0.3 * red + 0.6 * green + 0.1 * blue
}

impl<'a> Other<'a> {
    pub(super) fn new(view: &View, other: &StereoImage<'a>) -> Self {
        let [to, from] = [other.view.camera_from_world(), view.camera_from_world()];
        // From the axes of the one camera to those of the other.
        let turn: [[f64; 3]; 3] = std::array::from_fn(|row| {
            std::array::from_fn(|column| (0..3).map(|axis| to[row][axis] * from[column][axis]).sum())
        });
        let move_m: [f64; 3] = std::array::from_fn(|row| {
            to[row][3] - (0..3).map(|axis| turn[row][axis] * from[axis][3]).sum::<f64>()
        });
        let ([fx, fy], [cx, cy]) = (view.focal(), view.principal());
        let rays = turn.map(|[x, y, z]| [x / fx, y / fy, z - x * cx / fx - y * cy / fy]);
        let ([fx, fy], [cx, cy]) = (other.view.focal(), other.view.principal());
        let seen = |[x, y, z]: [f64; 3]| [fx * x + cx * z, fy * y + cy * z, z];
        let columns: [[f64; 3]; 3] =
            std::array::from_fn(|column| seen(std::array::from_fn(|row| rays[row][column])));
        Self {
            along: std::array::from_fn(|row| std::array::from_fn(|column| columns[column][row] as f32)),
            aside: seen(move_m).map(|value| value as f32),
            colour: other.colour,
            luma: other.colour.iter().map(|colour| brightness(colour.map(f32::from))).collect(),
            size: [other.view.width() as usize, other.view.height() as usize],
        }
    }

    /// The brightness along the ray of a place at an inverse depth, bytes; none outside the picture.
    pub(super) fn brightness(&self, place: [f32; 2], inverse: f32) -> Option<f32> {
        let base = self.base(place);
        let at = std::array::from_fn(|axis| base[axis] + inverse * self.aside[axis]);
        let (first, [right, down]) = self.corner(at)?;
        let width = self.size[0];
        let row = |first: usize| self.luma[first] + right * (self.luma[first + 1] - self.luma[first]);
        let (above, below) = (row(first), row(first + width));
        Some(above + down * (below - above))
    }

    fn base(&self, [u, v]: [f32; 2]) -> [f32; 3] {
        self.along.map(|row| row[0] * u + row[1] * v + row[2])
    }

    /// The colour at a place, bytes; none outside the picture.
    fn colour(&self, at: [f32; 3]) -> Option<[f32; 3]> {
        let (first, [right, down]) = self.corner(at)?;
        let width = self.size[0];
        let corners = [first, first + 1, first + width, first + width + 1].map(|pixel| self.colour[pixel]);
        let weights =
            [(1.0 - right) * (1.0 - down), right * (1.0 - down), (1.0 - right) * down, right * down];
        Some(std::array::from_fn(|channel| {
            corners.iter().zip(weights).map(|(corner, weight)| weight * f32::from(corner[channel])).sum()
        }))
    }

    /// The upper left of the four pixels around a place, and how far it is from its centre.
    fn corner(&self, [x, y, z]: [f32; 3]) -> Option<(usize, [f32; 2])> {
        if z <= 1e-6 {
            return None;
        }
        let (u, v) = (x / z - 0.5, y / z - 0.5);
        let [width, height] = self.size;
        if !(u >= 0.0 && v >= 0.0 && u < (width - 1) as f32 && v < (height - 1) as f32) {
            return None;
        }
        let (column, row) = (u as usize, v as usize);
        Some((row * width + column, [u - column as f32, v - row as f32]))
    }
}
