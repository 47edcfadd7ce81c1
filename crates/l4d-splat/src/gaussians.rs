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
}

/// Gaussians before activation: what training changes and checkpoints hold.
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
    /// Its value.
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
    pub fn select(&self, rows: impl Iterator<Item = usize> + Clone) -> Self {
        Self {
            sh_degree: self.sh_degree,
            means: rows.clone().map(|row| self.means[row]).collect(),
            log_scales: rows.clone().map(|row| self.log_scales[row]).collect(),
            rotations: rows.clone().map(|row| self.rotations[row]).collect(),
            opacity_logits: rows.clone().map(|row| self.opacity_logits[row]).collect(),
            sh: rows.flat_map(|row| self.sh_of(row).iter().copied()).collect(),
        }
    }

    /// Adds Gaussians of the same degree behind the others.
    pub fn append(&mut self, more: Self) {
        self.means.extend(more.means);
        self.log_scales.extend(more.log_scales);
        self.rotations.extend(more.rotations);
        self.opacity_logits.extend(more.opacity_logits);
        self.sh.extend(more.sh);
    }

    /// All numbers, list after list in the order of the fields.
    pub fn flat_mut(&mut self) -> [&mut [f32]; 5] {
        [
            self.means.as_flattened_mut(),
            self.log_scales.as_flattened_mut(),
            self.rotations.as_flattened_mut(),
            &mut self.opacity_logits,
            self.sh.as_flattened_mut(),
        ]
    }

    /// The first value that is not finite, Gaussian by Gaussian within a field.
    pub fn bad_value(&self) -> Option<BadValue> {
        let coefficients = self.sh_degree.coefficients();
        first_bad("means", 1, &self.means)
            .or_else(|| first_bad("log_scales", 1, &self.log_scales))
            .or_else(|| first_bad("rotations", 1, &self.rotations))
            .or_else(|| first_bad("opacity_logits", 1, self.opacity_logits.as_chunks::<1>().0))
            .or_else(|| first_bad("sh", coefficients, &self.sh))
    }
}

fn first_bad<const N: usize>(field: &'static str, rows: usize, list: &[[f32; N]]) -> Option<BadValue> {
    list.iter().enumerate().find_map(|(row, values)| {
        let value = *values.iter().find(|value| !value.is_finite())?;
        Some(BadValue { field, index: row / rows, value })
    })
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
