//! Gaussians at one moment as a rasterizer draws them, and the way of gradients back to what is optimised.
//!
//! Owns the activations (exponential, sigmoid, unit quaternion) and the promise that whatever is a [`Splats`] can be
//! drawn. Knows no camera.

use crate::gaussians::{BadValue, Gaussians, ShDegree};

mod gradients;

pub use gradients::SplatGradients;

/// Quaternions shorter than this have no direction; they count as no rotation.
const SHORTEST_QUATERNION: f64 = 1e-12;
/// How far the length of a quaternion may be from 1.
const UNIT_TOLERANCE: f64 = 1e-3;

/// Gaussians that can be drawn: every value is finite and lies where its meaning allows it.
///
/// `F` is the width of the numbers: rasterizers take `f32`, the reference and its finite differences also compute
/// in `f64`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Splats<F = f32> {
    pub(crate) parts: SplatParts<F>,
}

/// The values of [`Splats`], not yet checked.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SplatParts<F = f32> {
    /// Degree of `sh`.
    pub sh_degree: ShDegree,
    /// Centres in world axes, metres.
    pub means: Vec<[F; 3]>,
    /// Standard deviations along the own axes, metres; 0 makes a Gaussian flat.
    pub scales: Vec<[F; 3]>,
    /// Rotations from own to world axes, unit quaternions (w, x, y, z).
    pub rotations: Vec<[F; 4]>,
    /// Opacities, 0 to 1.
    pub opacities: Vec<F>,
    /// Spherical harmonics as in [`Gaussians::sh`].
    pub sh: Vec<[F; 3]>,
}

/// Why something cannot be drawn: the field, the Gaussian and the hint.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct SplatError(String);

impl From<BadValue> for SplatError {
    fn from(bad: BadValue) -> Self {
        Self(format!("{bad}, which cannot be drawn: mend the value or remove the Gaussian"))
    }
}

/// A quaternion and its negative are the same rotation: the one is taken that is nearer to another, so that what is between
/// them can be interpolated.
pub fn turn_towards(rotation: &mut [f32], other: &[f32]) {
    let dot: f32 = rotation.iter().zip(other).map(|(a, b)| a * b).sum();
    if dot < 0.0 {
        rotation.iter_mut().for_each(|part| *part = 0.0 - *part);
    }
}

impl Splats {
    /// Splats of these values, unless one of them cannot be drawn. The first offender is named, field by field.
    ///
    /// # Errors
    /// Lists of different lengths, and a value that cannot be drawn.
    pub fn new(parts: SplatParts) -> Result<Self, SplatError> {
        parts.check_lengths()?;
        parts.check_values()?;
        Ok(Self { parts })
    }

    /// The same values in f64.
    pub fn to_f64(&self) -> Splats<f64> {
        Splats { parts: self.parts.map(f64::from) }
    }
}

impl<F> Splats<F> {
    /// Number of Gaussians.
    pub fn len(&self) -> usize {
        self.parts.means.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.parts.means.is_empty()
    }

    /// Degree of the spherical harmonics.
    pub fn sh_degree(&self) -> ShDegree {
        self.parts.sh_degree
    }

    /// Centres in world axes, metres.
    pub fn means(&self) -> &[[F; 3]] {
        &self.parts.means
    }

    /// Standard deviations along the own axes, metres.
    pub fn scales(&self) -> &[[F; 3]] {
        &self.parts.scales
    }

    /// Unit quaternions (w, x, y, z) from own to world axes.
    pub fn rotations(&self) -> &[[F; 4]] {
        &self.parts.rotations
    }

    /// Opacities, 0 to 1.
    pub fn opacities(&self) -> &[F] {
        &self.parts.opacities
    }

    /// Spherical harmonics of all Gaussians, [`ShDegree::coefficients`] a Gaussian.
    pub fn sh(&self) -> &[[F; 3]] {
        &self.parts.sh
    }

    /// Spherical harmonics of one Gaussian.
    pub fn sh_of(&self, index: usize) -> &[[F; 3]] {
        let count = self.parts.sh_degree.coefficients();
        &self.parts.sh[index * count..(index + 1) * count]
    }

    /// The values, to be changed and checked again.
    pub fn into_parts(self) -> SplatParts<F> {
        self.parts
    }
}

impl<F: Copy> SplatParts<F> {
    /// The same with every number changed.
    pub(crate) fn map<G>(&self, change: impl Fn(F) -> G + Copy) -> SplatParts<G> {
        SplatParts {
            sh_degree: self.sh_degree,
            means: self.means.iter().map(|row| row.map(change)).collect(),
            scales: self.scales.iter().map(|row| row.map(change)).collect(),
            rotations: self.rotations.iter().map(|row| row.map(change)).collect(),
            opacities: self.opacities.iter().copied().map(change).collect(),
            sh: self.sh.iter().map(|row| row.map(change)).collect(),
        }
    }
}

impl<F> SplatParts<F> {
    /// All numbers, list after list in the order of the fields.
    pub fn lists(&self) -> [&[F]; 5] {
        [
            self.means.as_flattened(),
            self.scales.as_flattened(),
            self.rotations.as_flattened(),
            &self.opacities,
            self.sh.as_flattened(),
        ]
    }

    /// As [`Self::lists`], to be changed.
    pub(crate) fn lists_mut(&mut self) -> [&mut [F]; 5] {
        [
            self.means.as_flattened_mut(),
            self.scales.as_flattened_mut(),
            self.rotations.as_flattened_mut(),
            &mut self.opacities,
            self.sh.as_flattened_mut(),
        ]
    }
}

impl SplatParts {
    fn check_lengths(&self) -> Result<(), SplatError> {
        let Self { means, scales, rotations, opacities, sh, .. } = self;
        let lengths = [means.len(), scales.len(), rotations.len(), opacities.len(), sh.len()];
        let Some((list, found, expected)) = self.sh_degree.wrong_length(lengths) else { return Ok(()) };
        let field = ["means", "scales", "rotations", "opacities", "sh"][list];
        Err(SplatError(format!("field `{field}` has {found} entries where {expected} are needed")))
    }

    fn check_values(&self) -> Result<(), SplatError> {
        let bad = first("means", &self.means, |mean| not_finite(mean))
            .or_else(|| first("scales", &self.scales, |scale| not_finite(scale).or_else(|| negative(scale))))
            .or_else(|| first("rotations", &self.rotations, |q| not_finite(q).or_else(|| not_unit(q))))
            .or_else(|| {
                first("opacities", &self.opacities, |opacity| {
                    (!(0.0..=1.0).contains(opacity)).then_some(*opacity)
                })
            })
            .or_else(|| {
                let bad = first("sh", &self.sh, |coefficient| not_finite(coefficient))?;
                Some(BadValue { index: bad.index / self.sh_degree.coefficients(), ..bad })
            });
        bad.map_or(Ok(()), |bad| Err(bad.into()))
    }
}

fn first<T>(field: &'static str, list: &[T], offence: impl Fn(&T) -> Option<f32>) -> Option<BadValue> {
    list.iter().enumerate().find_map(|(index, entry)| Some(BadValue { field, index, value: offence(entry)? }))
}

fn not_finite(values: &[f32]) -> Option<f32> {
    values.iter().copied().find(|value| !value.is_finite())
}

fn negative(values: &[f32]) -> Option<f32> {
    values.iter().copied().find(|value| *value < 0.0)
}

fn not_unit(quaternion: &[f32; 4]) -> Option<f32> {
    let length = quaternion_length(quaternion);
    ((length - 1.0).abs() > UNIT_TOLERANCE).then_some(length as f32)
}

/// In f64, where no square of an f32 overflows or vanishes.
fn quaternion_length(quaternion: &[f32; 4]) -> f64 {
    quaternion.iter().map(|&value| f64::from(value).powi(2)).sum::<f64>().sqrt()
}

/// Length to divide by, and the unit quaternion; none if the quaternion has no direction.
fn unit(quaternion: &[f32; 4]) -> Option<(f64, [f64; 4])> {
    let length = quaternion_length(quaternion);
    (length >= SHORTEST_QUATERNION).then(|| (length, quaternion.map(|value| f64::from(value) / length)))
}

fn sigmoid(logit: f32) -> f32 {
    1.0 / (1.0 + (-logit).exp())
}

impl Gaussians {
    /// What a rasterizer draws: exponential of `log_scales`, sigmoid of `opacity_logits`, unit quaternions.
    ///
    /// A quaternion shorter than 1e-12 counts as no rotation. Values that are not finite, and scales that overflow,
    /// are refused with the raw field and the index.
    ///
    /// # Errors
    /// A value that is not finite, and a scale that overflows.
    pub fn activate(&self) -> Result<Splats, SplatError> {
        if let Some(bad) = self.bad_value() {
            return Err(bad.into());
        }
        let scales = self.log_scales.iter().map(|row| row.map(f32::exp)).collect();
        let parts = SplatParts {
            sh_degree: self.sh_degree,
            means: self.means.clone(),
            scales,
            rotations: self.rotations.iter().map(unit_or_identity).collect(),
            opacities: self.opacity_logits.iter().copied().map(sigmoid).collect(),
            sh: self.sh.clone(),
        };
        parts.check_lengths()?;
        if let Some(bad) = first("log_scales", &parts.scales, |scale| not_finite(scale)) {
            let value = self.log_scales[bad.index].iter().copied().fold(f32::NEG_INFINITY, f32::max);
            return Err(BadValue { value, ..bad }.into());
        }
        Ok(Splats { parts })
    }
}

fn unit_or_identity(quaternion: &[f32; 4]) -> [f32; 4] {
    unit(quaternion).map_or([1.0, 0.0, 0.0, 0.0], |(_, unit)| unit.map(|value| value as f32))
}

#[cfg(test)]
mod tests;
