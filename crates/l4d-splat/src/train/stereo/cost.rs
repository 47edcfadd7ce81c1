//! What it costs to take a pixel for a point on a plane: how much its colour differs from what other views show there.

use crate::view::View;

use super::super::pinhole::Pinhole;
use super::{NEIGHBOURS, PlaneSweep, StereoImage};

/// A larger difference of colour counts as this one, bytes.
pub(super) const DEAREST: u8 = 60;

/// Another view, as seen along the rays of one.
struct Other<'a> {
    /// What the view shows of the ray of a pixel at inverse depth w: `along * ray + w * aside`.
    along: [[f32; 3]; 3],
    aside: [f32; 3],
    colour: &'a [[u8; 3]],
    size: [usize; 2],
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
    let others: Vec<Other<'_>> = others.iter().map(|other| Other::new(image.view, other)).collect();
    let mut volume = vec![DEAREST; wanted.len() * planes];
    for (pixel, costs) in volume.chunks_exact_mut(planes).enumerate().filter(|(pixel, _)| wanted[*pixel]) {
        let [u, v] = pinhole.centre_of(pixel);
        let own = image.colour[pixel];
        let mut bases = [[0.0; 3]; NEIGHBOURS];
        for (base, other) in bases.iter_mut().zip(&others) {
            *base = other.along.map(|row| row[0] * u + row[1] * v + row[2]);
        }
        for (plane, cost) in costs.iter_mut().enumerate() {
            let inverse_depth = sweep.inverse_depth(plane as f32);
            let mut found = [DEAREST; NEIGHBOURS];
            let mut count = 0;
            for (base, other) in bases.iter().zip(&others) {
                let at: [f32; 3] = std::array::from_fn(|axis| base[axis] + inverse_depth * other.aside[axis]);
                if let Some(difference) = other.difference(at, own) {
                    found[count] = difference;
                    count += 1;
                }
            }
            if count > 0 {
                // The better half: something may be in front of the point in the others.
                found[..count].sort_unstable();
                let better = count.div_ceil(2);
                let sum: u16 = found[..better].iter().map(|&cost| u16::from(cost)).sum();
                *cost = (sum / better as u16) as u8;
            }
        }
    }
    volume
}

impl<'a> Other<'a> {
    fn new(view: &View, other: &StereoImage<'a>) -> Self {
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
            size: [other.view.width() as usize, other.view.height() as usize],
        }
    }

    /// Mean difference to the colour at a place, bytes; none outside the picture.
    fn difference(&self, [x, y, z]: [f32; 3], own: [u8; 3]) -> Option<u8> {
        if z <= 1e-6 {
            return None;
        }
        let (u, v) = (x / z - 0.5, y / z - 0.5);
        let [width, height] = self.size;
        if !(u >= 0.0 && v >= 0.0 && u < (width - 1) as f32 && v < (height - 1) as f32) {
            return None;
        }
        let (column, row) = (u as usize, v as usize);
        let (right, down) = (u - column as f32, v - row as f32);
        let first = row * width + column;
        let corners = [first, first + 1, first + width, first + width + 1].map(|pixel| self.colour[pixel]);
        let weights =
            [(1.0 - right) * (1.0 - down), right * (1.0 - down), (1.0 - right) * down, right * down];
        let channel = |channel: usize| {
            let seen: f32 =
                corners.iter().zip(weights).map(|(corner, weight)| weight * f32::from(corner[channel])).sum();
            (seen - f32::from(own[channel])).abs()
        };
        let mean = (channel(0) + channel(1) + channel(2)) / 3.0;
        Some(mean.min(f32::from(DEAREST)) as u8)
    }
}
