//! The parameters of 3D Gaussians as they are optimised and stored, one list a parameter.
//!
//! Knows shapes, units and which values cannot be. Activations turn them into what a rasterizer draws
//! ([`crate::splats`]).

use std::fmt;

/// Degree of the spherical harmonics that describe colour by direction: 0 to 3.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct ShDegree(u8);

impl ShDegree {
    /// The same colour from everywhere.
    pub const ZERO: Self = Self(0);
    /// The largest degree.
    pub const MAX: Self = Self(3);

    /// A degree, unless it is larger than 3.
    pub fn new(degree: u8) -> Option<Self> {
        (degree <= Self::MAX.0).then_some(Self(degree))
    }

    /// The degree as a number.
    pub fn get(self) -> u8 {
        self.0
    }

    /// Coefficients a colour channel: 1, 4, 9 or 16.
    pub fn coefficients(self) -> usize {
        let order = usize::from(self.0) + 1;
        order * order
    }

    /// Numbers that a Gaussian has in each list, in the order of [`FIELDS`].
    pub fn widths(self) -> [usize; 5] {
        [3, 3, 4, 1, 3 * self.coefficients()]
    }

    /// The first of five lists that has not one entry per mean (a coefficient each of the harmonics): its place, its
    /// length, and the right one.
    pub(crate) fn wrong_length(self, lengths: [usize; 5]) -> Option<(usize, usize, usize)> {
        let count = lengths[0];
        let expected = [count, count, count, count, count.saturating_mul(self.coefficients())];
        (0..5).find(|&list| lengths[list] != expected[list]).map(|list| (list, lengths[list], expected[list]))
    }
}

/// Names of the lists of [`Gaussians`].
pub const FIELDS: [&str; 5] = ["means", "log_scales", "rotations", "opacity_logits", "sh"];

/// Gaussians before activation: what training changes and checkpoints hold; also offsets of them, or derivatives by them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Gaussians {
    /// Degree of `sh`.
    pub sh_degree: ShDegree,
    /// Centres in world axes, metres.
    pub means: Vec<[f32; 3]>,
    /// Natural logarithms of the standard deviations along the own axes, ln metres.
    pub log_scales: Vec<[f32; 3]>,
    /// Rotations from own to world axes, quaternions (w, x, y, z), not normalised.
    pub rotations: Vec<[f32; 4]>,
    /// Opacities before the sigmoid.
    pub opacity_logits: Vec<f32>,
    /// Spherical harmonics: coefficient `k` of Gaussian `i` is at `i * sh_degree.coefficients() + k`, as
    /// (red, green, blue) of display colour. Colour = 0.5 + their sum, clamped below at 0.
    pub sh: Vec<[f32; 3]>,
}

/// A value that no Gaussian can have.
#[derive(Debug, Clone, PartialEq)]
pub struct BadValue {
    /// Name of the parameter, as the fields of [`Gaussians`].
    pub field: &'static str,
    /// Which Gaussian.
    pub index: usize,
    pub value: f32,
}

impl fmt::Display for BadValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Gaussian {}, field `{}` is {}", self.index, self.field, self.value)
    }
}

impl Gaussians {
    /// Number of Gaussians.
    pub fn len(&self) -> usize {
        self.means.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.means.is_empty()
    }

    /// Coefficients of one Gaussian.
    pub fn sh_of(&self, index: usize) -> &[[f32; 3]] {
        let count = self.sh_degree.coefficients();
        &self.sh[index * count..(index + 1) * count]
    }

    /// The Gaussians that `rows` names, in that order.
    #[must_use]
    pub fn select(&self, rows: &[u32]) -> Self {
        self.rows(self.sh_degree.coefficients(), rows)
    }

    /// As [`Self::select`], of lists that may be empty and have so many coefficients.
    pub(crate) fn rows(&self, coefficients: usize, rows: &[u32]) -> Self {
        fn picked<T: Copy>(from: &[T], rows: &[u32], width: usize) -> Vec<T> {
            let row = |&row: &u32| from[row as usize * width..][..width].iter().copied();
            if from.is_empty() { Vec::new() } else { rows.iter().flat_map(row).collect() }
        }
        Self {
            sh_degree: self.sh_degree,
            means: picked(&self.means, rows, 1),
            log_scales: picked(&self.log_scales, rows, 1),
            rotations: picked(&self.rotations, rows, 1),
            opacity_logits: picked(&self.opacity_logits, rows, 1),
            sh: picked(&self.sh, rows, coefficients),
        }
    }

    /// Without the harmonics above a degree.
    #[must_use]
    pub fn up_to(self, degree: ShDegree) -> Self {
        if degree >= self.sh_degree {
            return self;
        }
        let kept = |coefficients: &[[f32; 3]]| coefficients[..degree.coefficients()].to_vec();
        let sh = self.sh.chunks(self.sh_degree.coefficients()).flat_map(kept).collect();
        Self { sh_degree: degree, sh, ..self }
    }

    /// Adds Gaussians of the same degree behind the others.
    pub fn append(&mut self, more: Self) {
        self.means.extend(more.means);
        self.log_scales.extend(more.log_scales);
        self.rotations.extend(more.rotations);
        self.opacity_logits.extend(more.opacity_logits);
        self.sh.extend(more.sh);
    }

    /// All numbers, list after list in the order of [`FIELDS`].
    pub fn flat(&self) -> [&[f32]; 5] {
        [
            self.means.as_flattened(),
            self.log_scales.as_flattened(),
            self.rotations.as_flattened(),
            &self.opacity_logits,
            self.sh.as_flattened(),
        ]
    }

    /// As [`Self::flat`], to be changed.
    pub fn flat_mut(&mut self) -> [&mut [f32]; 5] {
        [
            self.means.as_flattened_mut(),
            self.log_scales.as_flattened_mut(),
            self.rotations.as_flattened_mut(),
            &mut self.opacity_logits,
            self.sh.as_flattened_mut(),
        ]
    }

    /// Entries of each list.
    pub(crate) fn lengths(&self) -> [usize; 5] {
        let Self { means, log_scales, rotations, opacity_logits, sh, .. } = self;
        [means.len(), log_scales.len(), rotations.len(), opacity_logits.len(), sh.len()]
    }

    /// The first value that is not finite, Gaussian by Gaussian within a field.
    pub fn bad_value(&self) -> Option<BadValue> {
        self.bad_value_of(self.sh_degree.widths())
    }

    /// As [`Self::bad_value`], of lists with so many numbers a row.
    pub(crate) fn bad_value_of(&self, widths: [usize; 5]) -> Option<BadValue> {
        FIELDS.into_iter().zip(self.flat()).zip(widths).find_map(|((field, list), width)| {
            let place = list.iter().position(|value| !value.is_finite())?;
            Some(BadValue { field, index: place / width, value: list[place] })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_have_as_many_coefficients_as_squares() {
        let counts: Vec<usize> = (0..=3).map(|d| ShDegree::new(d).unwrap().coefficients()).collect();
        assert_eq!(counts, [1, 4, 9, 16]);
        assert_eq!(ShDegree::new(4), None);
    }
}
