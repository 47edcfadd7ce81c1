//! What can be said about training, and what happens when.

use l4d_data::Profile;
use serde::Serialize;

use crate::deform::{DeformConfig, TimeAxis};
use crate::gaussians::ShDegree;
use crate::optimise::{LearningRate, OptimiseError};

/// Everything that a result depends on beside pictures and initial points.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Settings {
    /// Of all that is random.
    pub seed: u64,
    /// Most Gaussians.
    pub gaussians: usize,
    /// 0 to 3.
    pub sh_degree: u8,
    /// Share of moments at which something has to be contradicted before it counts as moving. 0: everything is
    /// dynamic; above 1: nothing is.
    pub dynamic_threshold: f32,
    /// Iterations on static Gaussians.
    pub coarse: u64,
    /// Iterations for each step of the fine stage's beginning, in which the clip is unfolded from one moment to both
    /// ends.
    pub unfold: u64,
    /// Iterations on the whole clip.
    pub fine: u64,
    /// Views of one moment that an iteration looks at.
    pub views: usize,
    /// What an error of depth costs, in units of (display colour) per (typical depth).
    pub depth_weight: f32,
    /// Training stops after so many looks at the training pictures without progress; 0: never early.
    pub patience: usize,
    /// Channels of the planes.
    pub channels: usize,
    /// Samples of the planes along each axis of space at the coarser of two levels.
    pub resolution: usize,
    /// Width of the field's layers.
    pub width: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            seed: 0,
            gaussians: 18_000,
            sh_degree: 1,
            dynamic_threshold: 0.05,
            coarse: 1000,
            unfold: 20,
            fine: 4000,
            views: 2,
            depth_weight: 0.1,
            patience: 3,
            channels: 16,
            resolution: 48,
            width: 64,
        }
    }
}

/// A learning rate for each group of parameters.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rates {
    /// In the order of [`FIELDS`](crate::gaussians::FIELDS).
    pub(super) gaussians: [LearningRate; 5],
    /// Layers of the deformation field.
    pub(super) layers: LearningRate,
    /// Planes of the deformation field.
    pub(super) planes: LearningRate,
}

/// What an iteration is about.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stage {
    /// Static Gaussians, without the field.
    Coarse,
    /// The clip up to `reach` moments away from the first one.
    Unfold {
        /// Moments on either side.
        reach: usize,
    },
    Fine,
    Done,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Schedule {
    coarse: u64,
    unfold: u64,
    steps: u64,
    fine: u64,
}

impl Schedule {
    /// `reach`: moments between the first one and the farther end of the clip.
    pub(super) fn new(settings: &Settings, reach: usize) -> Self {
        Self {
            coarse: settings.coarse,
            unfold: settings.unfold,
            steps: reach as u64 + 1,
            fine: settings.fine,
        }
    }

    pub(super) fn at(&self, iteration: u64) -> Stage {
        let Some(after) = iteration.checked_sub(self.coarse) else { return Stage::Coarse };
        match after.checked_div(self.unfold) {
            Some(step) if step < self.steps => Stage::Unfold { reach: step as usize },
            _ if iteration < self.end() => Stage::Fine,
            _ => Stage::Done,
        }
    }

    /// First iteration with the field.
    pub(super) fn fine_start(&self) -> u64 {
        self.coarse
    }

    /// First iteration on the whole clip.
    pub(super) fn whole_start(&self) -> u64 {
        self.coarse + self.unfold * self.steps
    }

    pub(super) fn end(&self) -> u64 {
        self.whole_start() + self.fine
    }
}

impl Settings {
    /// What does well for the pictures of a profile.
    pub fn of_profile(profile: Profile) -> Self {
        let small = Self::default();
        match profile {
            Profile::Tiny => Self { gaussians: 5000, coarse: 400, unfold: 30, fine: 1000, ..small },
            Profile::Small => small,
            // Colour alone says what moves.
            Profile::Real => Self { gaussians: 40_000, dynamic_threshold: 0.2, ..small },
            Profile::Full => Self { gaussians: 60_000, fine: 12_000, resolution: 64, ..small },
        }
    }

    /// The degree of the spherical harmonics; degrees above 3 count as 3.
    pub(super) fn degree(&self) -> ShDegree {
        ShDegree::new(self.sh_degree).unwrap_or(ShDegree::MAX)
    }

    /// The field for a clip of so many moments: a row of its planes each.
    pub(super) fn field(&self, moments: usize) -> DeformConfig {
        DeformConfig {
            channels: self.channels,
            spatial_resolution: [self.resolution; 3],
            time_resolution: moments.max(2),
            multires: vec![1, 2],
            width: self.width,
            no_dx: false,
            no_ds: false,
            no_dr: false,
            no_do: false,
            no_dshs: false,
            sh_coefficients: self.degree().coefficients(),
            time_axis: TimeAxis::Whole,
        }
    }

    /// Learning rates for so many iterations on a scene of this extent: those of 4DGaussians where they concern
    /// Gaussians, steeper ones for the field, which has less time here than there.
    pub(super) fn rates(&self, extent_m: f64, steps: u64) -> Result<Rates, OptimiseError> {
        let falling = |first: f64, last: f64| LearningRate::log_linear(first, last, steps.max(1));
        Ok(Rates {
            gaussians: [
                falling(1.6e-4 * extent_m, 3.2e-6 * extent_m)?,
                falling(5.0e-3, 1.0e-3)?,
                falling(2.0e-3, 5.0e-4)?,
                falling(2.5e-2, 5.0e-3)?,
                falling(5.0e-3, 5.0e-4)?,
            ],
            layers: falling(2.0e-3, 1.0e-4)?,
            planes: falling(2.0e-2, 1.0e-3)?,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stages_follow_each_other() {
        let settings = Settings { coarse: 10, unfold: 3, fine: 5, ..Settings::default() };
        let schedule = Schedule::new(&settings, 2);
        let reach = |reach| Stage::Unfold { reach };
        let expected = [
            (0, Stage::Coarse),
            (9, Stage::Coarse),
            (10, reach(0)),
            (12, reach(0)),
            (13, reach(1)),
            (18, reach(2)),
            (19, Stage::Fine),
            (23, Stage::Fine),
            (24, Stage::Done),
        ];
        for (iteration, stage) in expected {
            assert_eq!(schedule.at(iteration), stage, "{iteration}");
        }
        let short = Schedule::new(&Settings { unfold: 0, fine: 0, ..settings }, 2);
        assert_eq!((short.at(9), short.at(10)), (Stage::Coarse, Stage::Done));
    }
}
