//! Readers of other programs, as far as a model shows by which of them it was trained: at which time each moment was,
//! and how its pictures were drawn, whatever the options of the run say.

use serde::{Deserialize, Serialize};

/// Name of the file in which an export says what it is.
pub const EXPORT_CARD: &str = "l4d-export.json";

/// A reader of data sets in 4DGaussians and the programs that derive from it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Reader {
    /// `train_meta.json`.
    Panoptic,
    /// `poses_bounds.npy`: Neu3D.
    Dynerf,
    /// `points3D_multipleview.ply`.
    MultipleView,
    /// `dataset.json`: Nerfies and HyperNeRF.
    Nerfies,
}

/// What a reader made of an export, and a model knows.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Trained {
    pub reader: Reader,
    /// Time of each moment.
    pub times: Vec<f32>,
    /// Degree of the harmonics that it draws; null: what the run says.
    pub sh_degree: Option<u8>,
    /// What it shows where nothing is, display colour; null: what the run says.
    pub background: Option<[f32; 3]>,
}

impl Reader {
    /// Its name in lower case.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Panoptic => "panoptic",
            Self::Dynerf => "dynerf",
            Self::MultipleView => "multipleview",
            Self::Nerfies => "nerfies",
        }
    }

    /// What it makes of so many moments.
    pub fn trained(self, moments: usize) -> Trained {
        let whole = match self {
            Self::Panoptic | Self::MultipleView => moments,
            // However many there are.
            Self::Dynerf => 300,
            Self::Nerfies => moments.saturating_sub(1),
        };
        let time = |moment: usize| (moment as f64 / whole.max(1) as f64) as f32;
        let has_camera_of_its_own = self == Self::Panoptic;
        Trained {
            reader: self,
            times: (0..moments).map(time).collect(),
            sh_degree: has_camera_of_its_own.then_some(0),
            background: has_camera_of_its_own.then_some([0.0; 3]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_moment_has_another_time_for_each_reader() {
        let fifth = |reader: Reader| reader.trained(9).times[4];
        assert_eq!(fifth(Reader::Panoptic), (4.0_f64 / 9.0) as f32);
        assert_eq!(fifth(Reader::MultipleView), fifth(Reader::Panoptic));
        assert_eq!(fifth(Reader::Dynerf), (4.0_f64 / 300.0) as f32);
        assert_eq!(fifth(Reader::Nerfies), 0.5);
        assert_eq!(Reader::Nerfies.trained(1).times, [0.0]);
    }
}
