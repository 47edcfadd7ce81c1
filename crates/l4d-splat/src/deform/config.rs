//! How large a deformation field is, what it changes, and how its time axis is read.

use serde::{Deserialize, Serialize};

use super::DeformError;

/// Planes and layers together may hold this many numbers (1 GiB); a 4DGaussians field holds 2 to 8 million.
const MAX_PARAMETERS: u64 = 1 << 28;

/// Which part of the time axis of the planes the clip uses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum TimeAxis {
    /// Time 0..1 is looked up as it is on an axis from -1 to 1, so that the first half of the samples is never
    /// read. This is what 4DGaussians does: the only choice for its checkpoints.
    #[default]
    Half,
    /// Time 0..1 spans all samples: as fine as `Half` with half of them.
    Whole,
}

impl TimeAxis {
    /// Coordinate on the axis from -1 to 1 of a time from 0 to 1.
    pub(super) fn coordinate(self, time: f32) -> f32 {
        match self {
            Self::Half => time,
            Self::Whole => 2.0 * time - 1.0,
        }
    }
}

/// Sizes and switches of a deformation field: a HexPlane, one linear layer and five heads.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct DeformConfig {
    /// Channels of every plane.
    pub channels: usize,
    /// Samples of the spatial axes (x, y, z) at a multiplier of 1.
    pub spatial_resolution: [usize; 3],
    /// Samples of the time axis; no level multiplies it.
    pub time_resolution: usize,
    /// Multiplier of the spatial resolution, a level each.
    pub multires: Vec<u32>,
    /// Width of the hidden layers.
    pub width: usize,
    /// The field leaves centres alone.
    pub no_dx: bool,
    /// The field leaves scales alone.
    pub no_ds: bool,
    /// The field leaves rotations alone.
    pub no_dr: bool,
    /// The field leaves opacities alone.
    pub no_do: bool,
    /// The field leaves spherical harmonics alone.
    pub no_dshs: bool,
    /// Spherical harmonics a colour channel that the last head gives.
    pub sh_coefficients: usize,
    /// How time is looked up.
    pub time_axis: TimeAxis,
}

impl DeformConfig {
    /// What 4DGaussians calls its configuration for multi-camera video (`dynerf`, `multipleview`).
    pub fn dynerf() -> Self {
        Self {
            channels: 16,
            spatial_resolution: [64; 3],
            time_resolution: 150,
            multires: vec![1, 2],
            width: 128,
            no_dx: false,
            no_ds: false,
            no_dr: false,
            no_do: false,
            no_dshs: false,
            sh_coefficients: 16,
            time_axis: TimeAxis::Half,
        }
    }

    /// Numbers that each head gives for a row, in the order of [`FIELDS`](crate::gaussians::FIELDS).
    pub(super) fn outputs(&self) -> [usize; 5] {
        [3, 3, 4, 1, 3 * self.sh_coefficients]
    }

    /// Whether the field changes each of these lists at all.
    pub(super) fn is_on(&self) -> [bool; 5] {
        [self.no_dx, self.no_ds, self.no_dr, self.no_do, self.no_dshs].map(|off| !off)
    }

    /// Numbers that each list of offsets has for so many rows.
    pub(super) fn lengths(&self, rows: usize) -> [usize; 5] {
        let (outputs, is_on) = (self.outputs(), self.is_on());
        std::array::from_fn(|head| if is_on[head] { rows * outputs[head] } else { 0 })
    }

    /// Width of what the planes say of a place at a time: channels of all levels.
    pub fn features(&self) -> usize {
        self.channels * self.multires.len()
    }

    /// Samples along x, y, z, t of one level.
    pub(super) fn axes(&self, multiplier: u32) -> [usize; 4] {
        let [x, y, z] = self.spatial_resolution.map(|samples| samples * multiplier as usize);
        [x, y, z, self.time_resolution]
    }

    /// Whether a field of this size can be built.
    ///
    /// # Errors
    /// The first field that cannot be: a size of zero, or so large that planes and layers would hold more than
    /// 2^28 numbers.
    pub fn validate(&self) -> Result<(), DeformError> {
        let [x, y, z] = self.spatial_resolution;
        let sizes = [
            ("channels", self.channels as u64, 1024),
            ("spatial_resolution", x as u64, 1 << 16),
            ("spatial_resolution", y as u64, 1 << 16),
            ("spatial_resolution", z as u64, 1 << 16),
            ("time_resolution", self.time_resolution as u64, 1 << 16),
            ("multires", self.multires.len() as u64, 16),
            ("multires", self.multires.iter().copied().min().unwrap_or(1).into(), 1 << 16),
            ("multires", self.multires.iter().copied().max().unwrap_or(1).into(), 1 << 16),
            ("width", self.width as u64, 1 << 13),
            ("sh_coefficients", self.sh_coefficients as u64, 16),
        ];
        for (field, value, most) in sizes {
            if value == 0 || value > most {
                return Err(size_error(field, value, most));
            }
        }
        let count = self.parameter_count();
        if count > MAX_PARAMETERS {
            let field = "spatial_resolution, time_resolution, multires, channels";
            return Err(size_error(field, count, MAX_PARAMETERS));
        }
        Ok(())
    }

    /// Numbers in planes and layers. The sizes are below the limits of [`Self::validate`].
    fn parameter_count(&self) -> u64 {
        let planes = |&multiplier: &u32| {
            let [x, y, z] = self.spatial_resolution.map(|samples| samples as u64 * u64::from(multiplier));
            let t = self.time_resolution as u64;
            x * y + x * z + y * z + t * (x + y + z)
        };
        let texels: u64 = self.multires.iter().map(planes).fold(0, u64::saturating_add);
        let width = self.width as u64;
        let heads = self.outputs().into_iter().map(|outputs| (outputs as u64 + width) * (width + 1));
        let layers = width * (self.features() as u64 + 1) + heads.sum::<u64>();
        texels.saturating_mul(self.channels as u64).saturating_add(layers)
    }
}

fn size_error(field: &str, value: u64, most: u64) -> DeformError {
    DeformError(format!("deformation config: `{field}` is {value}: must be at least 1 and at most {most}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_dynerf_field_has_as_many_parameters_as_theirs() {
        // Theirs also counts a time network that is never called, four lists of constants and the box.
        let unused = (64 * 9 + 64 + 32 * 64 + 32) + (4 + 10 + 2 + 2) + 6;
        assert_eq!(DeformConfig::dynerf().parameter_count() + unused, 2_462_579);
    }

    #[test]
    fn sizes_of_zero_and_absurd_sizes_are_refused_by_name() {
        assert_eq!(DeformConfig::dynerf().validate(), Ok(()));
        let refused = |change: fn(&mut DeformConfig)| {
            let mut config = DeformConfig::dynerf();
            change(&mut config);
            config.validate().unwrap_err().to_string()
        };
        assert!(refused(|config| config.channels = 0).contains("`channels` is 0"));
        assert!(refused(|config| config.multires.clear()).contains("`multires` is 0"));
        assert!(refused(|config| config.multires[1] = 0).contains("`multires` is 0"));
        assert!(refused(|config| config.width = usize::MAX).contains("`width`"));
        assert!(refused(|config| config.spatial_resolution = [1 << 16; 3]).contains("at most 268435456"));
        assert!(refused(|config| config.multires = vec![u32::MAX; 16]).contains("`multires`"));
    }

    #[test]
    fn the_whole_axis_starts_where_the_half_one_never_looks() {
        assert_eq!([0.0, 0.5, 1.0].map(|time| TimeAxis::Half.coordinate(time)), [0.0, 0.5, 1.0]);
        assert_eq!([0.0, 0.5, 1.0].map(|time| TimeAxis::Whole.coordinate(time)), [-1.0, 0.0, 1.0]);
    }
}
