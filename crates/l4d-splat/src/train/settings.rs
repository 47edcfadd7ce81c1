//! Settings of training, and the schedule of stages and learning rates that follows from them. Runs no iteration
//! itself.

use l4d_data::Profile;
use serde::{Deserialize, Serialize};

use crate::deform::{DeformConfig, TimeAxis};
use crate::gaussians::ShDegree;
use crate::optimise::{LearningRate, OptimiseError};

/// Whose schedule and learning rates.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
pub enum Preset {
    /// Static and dynamic parts learn apart, and the clip is unfolded from one moment.
    #[default]
    #[serde(rename = "l4d")]
    L4d,
    /// What 4DGaussians published for DyNeRF: everything goes through the field from the first fine iteration on.
    #[serde(rename = "4dgaussians")]
    FourDGaussians,
}

impl Preset {
    fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

/// Everything that a result depends on besides pictures and initial points.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Settings {
    /// Learning rates.
    #[serde(skip_serializing_if = "Preset::is_default")]
    pub preset: Preset,
    /// Seed of everything random.
    pub seed: u64,
    /// Most Gaussians that the model may have.
    pub gaussians: usize,
    /// Degree of the spherical harmonics, 0 to 3.
    pub sh_degree: u8,
    /// Share of moments at which the pictures have to contradict a static surface before it counts as dynamic. 0:
    /// everything is dynamic; above 1: nothing is.
    pub dynamic_threshold: f32,
    /// Iterations of the coarse stage, on static Gaussians.
    pub coarse: u64,
    /// Iterations for each step of unfolding: the fine stage begins with one moment and takes in one more on either
    /// side with each step.
    pub unfold: u64,
    /// Iterations of the fine stage on the whole clip.
    pub fine: u64,
    /// Views of one moment in an iteration: the batch size.
    pub views: usize,
    /// Weight of the depth loss beside the colour loss: display colour per typical depth.
    pub depth_weight: f32,
    /// Share of the Gaussians that sits out an iteration, at the end of training; at its start none does. Without
    /// depth alone.
    pub dropout: f32,
    /// Training stops after so many evaluations on training pictures without progress; 0: never early.
    pub patience: usize,
    /// Channels of the deformation field's planes (HexPlane).
    pub channels: usize,
    /// Spatial resolution of the planes at the coarser of two levels, samples along each axis.
    pub resolution: usize,
    /// Width of the deformation field's layers.
    pub width: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            preset: Preset::L4d,
            seed: 0,
            gaussians: 18_000,
            sh_degree: 1,
            dynamic_threshold: 0.05,
            coarse: 1000,
            unfold: 20,
            fine: 4000,
            views: 2,
            depth_weight: 0.1,
            dropout: 0.2,
            patience: 3,
            channels: 16,
            resolution: 48,
            width: 64,
        }
    }
}

/// Learning rates by group of parameters.
#[derive(Debug, Clone, Copy)]
pub(super) struct Rates {
    /// In the order of [`FIELDS`](crate::gaussians::FIELDS).
    pub(super) gaussians: [LearningRate; 5],
    /// Layers of the deformation field.
    pub(super) layers: LearningRate,
    /// Planes of the deformation field.
    pub(super) planes: LearningRate,
}

/// What an iteration trains on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Stage {
    /// Static Gaussians, without the field.
    Coarse,
    /// The part of the clip up to `reach` moments away from the one where unfolding begins.
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
    /// `reach`: moments from the one where unfolding begins to the farther end of the clip.
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

    /// First iteration with the deformation field.
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
    /// A preset's settings for the pictures of a profile.
    pub fn of(preset: Preset, profile: Profile) -> Self {
        let ours = Self::of_profile(profile);
        match preset {
            Preset::L4d => ours,
            // As many Gaussians as ours: 4DGaussians stops adding some at 360 000, whatever the pictures.
            Preset::FourDGaussians => Self {
                preset,
                sh_degree: 3,
                dynamic_threshold: 0.0,
                coarse: 3000,
                unfold: 0,
                fine: 14_000,
                views: 4,
                dropout: 0.0,
                patience: 0,
                channels: 16,
                resolution: 64,
                width: 128,
                ..ours
            },
        }
    }

    fn of_profile(profile: Profile) -> Self {
        let small = Self::default();
        match profile {
            Profile::Tiny => Self { gaussians: 5000, coarse: 400, unfold: 30, fine: 1000, ..small },
            Profile::Small => small,
            // Captures have no depth: motion is found by colour alone, which is noisier.
            Profile::Real => Self { gaussians: 40_000, dynamic_threshold: 0.2, ..small },
            Profile::Full => Self { gaussians: 60_000, fine: 12_000, resolution: 64, ..small },
        }
    }

    /// The degree of the spherical harmonics; degrees above 3 count as 3.
    pub(super) fn degree(&self) -> ShDegree {
        ShDegree::new(self.sh_degree).unwrap_or(ShDegree::MAX)
    }

    /// The deformation field for a clip of so many moments: a row of the planes for each.
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

    /// Learning rates that fall over `steps` iterations; those that 4DGaussians published fall over its own number.
    /// Ours of Gaussians are near these; of the deformation field they are higher, because it has fewer iterations.
    pub(super) fn rates(&self, extent_m: f64, steps: u64) -> Result<Rates, OptimiseError> {
        let steps = if self.preset == Preset::FourDGaussians { 20_000 } else { steps.max(1) };
        let falling = |first: f64, last: f64| LearningRate::log_linear(first, last, steps);
        if self.preset == Preset::FourDGaussians {
            return Ok(Rates {
                gaussians: [
                    falling(1.6e-4 * extent_m, 1.6e-6 * extent_m)?,
                    LearningRate::constant(5.0e-3)?,
                    LearningRate::constant(1.0e-3)?,
                    LearningRate::constant(5.0e-2)?,
                    LearningRate::constant(2.5e-3)?,
                ],
                layers: falling(1.6e-4 * extent_m, 1.6e-5 * extent_m)?,
                planes: falling(1.6e-3 * extent_m, 1.6e-4 * extent_m)?,
            });
        }
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
