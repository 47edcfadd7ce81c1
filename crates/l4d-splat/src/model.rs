//! A whole 4D scene: Gaussians in a canonical state, the field that moves some of them, and which ones it moves.
//!
//! Owns how a model becomes what a rasterizer draws at a moment, and how it is read and written.
//! Refuses to know how it was trained and what is drawn with it.

use std::borrow::Cow;
use std::path::Path;

use l4d_data::DataError;
use l4d_data::Timeline;

use crate::checkpoint::foreign::ForeignModel;
use crate::checkpoint::own::{self, Checkpoint};
use crate::deform::{DeformError, DeformationField};
use crate::gaussians::Gaussians;
use crate::splats::{SplatError, Splats};

/// What can be drawn at any time of a clip.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Model {
    /// Canonical Gaussians.
    pub gaussians: Gaussians,
    /// Those that go through the field, ascending; the others are static.
    pub dynamic: Vec<u32>,
    /// How the dynamic ones change; none for a static scene.
    pub field: Option<DeformationField>,
    /// Moments of training: time in the clip and time that the field knows it by, both ascending. Empty where they are
    /// the same.
    pub moments: Vec<[f32; 2]>,
}

/// Why a model has no state at a time.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// The field cannot be evaluated.
    #[error("the deformation field has no answer")]
    Deform(#[from] DeformError),
    /// The result cannot be drawn.
    #[error("the model cannot be drawn")]
    Splat(#[from] SplatError),
    /// The time lies outside of what was trained on.
    #[error("the model saw the clip from {first} to {last} alone, where 0 is its start and 1 its end")]
    Unseen {
        /// First time of training.
        first: f32,
        /// Last time of training.
        last: f32,
    },
}

impl Model {
    /// The Gaussians at a time from 0 to 1, ready for any number of views of that moment.
    ///
    /// # Errors
    /// A time outside the clip or outside of training; a dynamic row that names no Gaussian; parameters that are not
    /// finite.
    pub fn at(&self, time: f32) -> Result<Splats, ModelError> {
        Ok(self.gaussians_at(time)?.activate()?)
    }

    /// The same before activation: what files of Gaussians hold.
    ///
    /// # Errors
    /// A time outside the clip or outside of training; a dynamic row that names no Gaussian.
    pub fn gaussians_at(&self, time: f32) -> Result<Cow<'_, Gaussians>, ModelError> {
        Ok(match &self.field {
            Some(field) => {
                Cow::Owned(field.deformed(&self.gaussians, &self.dynamic, self.own_time(time)?)?)
            }
            None => Cow::Borrowed(&self.gaussians),
        })
    }

    /// What the field calls a time of the clip; between two moments of training in proportion.
    ///
    /// # Errors
    /// A time outside of training.
    pub fn own_time(&self, time: f32) -> Result<f32, ModelError> {
        let (Some([first, _]), Some([last, own_last])) = (self.moments.first(), self.moments.last()) else {
            return Ok(time);
        };
        if !(*first..=*last).contains(&time) {
            return Err(ModelError::Unseen { first: *first, last: *last });
        }
        let after = self.moments.partition_point(|[clip, _]| *clip <= time);
        let Some(&[end, own_end]) = self.moments.get(after) else { return Ok(*own_last) };
        let [start, own_start] = self.moments[after - 1];
        Ok(own_start + (own_end - own_start) * ((time - start) / (end - start)))
    }

    /// The model with these Gaussians alone; indices ascend, those that name none are left out.
    #[must_use]
    pub fn keep(&self, indices: &[u32]) -> Self {
        let count = self.gaussians.len();
        let rows: Vec<u32> = indices.iter().copied().filter(|&row| (row as usize) < count).collect();
        let moves = |&(_, row): &(usize, &u32)| self.dynamic.binary_search(row).is_ok();
        let dynamic = rows.iter().enumerate().filter(moves).map(|(place, _)| place as u32).collect();
        let (field, moments) = (self.field.clone(), self.moments.clone());
        Self { gaussians: self.gaussians.select(&rows), dynamic, field, moments }
    }

    /// The model in a folder of [`crate::checkpoint::own`], without what training needs to go on.
    ///
    /// # Errors
    /// A folder or file that is missing, damaged or of another kind.
    pub fn read(folder: &Path) -> Result<Self, DataError> {
        Ok(own::read(folder)?.model)
    }

    /// Writes the model alone into a folder, in place of the checkpoint that is there.
    ///
    /// # Errors
    /// Values that no checkpoint holds, and what the disk refuses.
    pub fn write(&self, folder: &Path) -> Result<(), DataError> {
        own::write(folder, &Checkpoint { model: self.clone(), ..Checkpoint::default() })
    }
}

/// As its original draws it: every Gaussian goes through the field, whatever the table says.
impl From<ForeignModel> for Model {
    fn from(foreign: ForeignModel) -> Self {
        let field = foreign.drawn_field().cloned();
        let moving = if field.is_some() { foreign.gaussians.len() as u32 } else { 0 };
        Self { gaussians: foreign.gaussians, dynamic: (0..moving).collect(), field, moments: Vec::new() }
    }
}

/// The time of a canonical frame, 0 to 1 over the clip; frames beyond the clip count as its end.
pub fn time_of_frame(frame: u32) -> f32 {
    Timeline::CANONICAL.time(frame)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deform::{Bounds, DeformConfig, Init};
    use crate::gaussians::ShDegree;
    use crate::synthetic::Room;

    fn model() -> Model {
        let gaussians = Gaussians {
            sh_degree: ShDegree::ZERO,
            means: vec![[0.1, 0.2, 0.3], [-0.4, 0.5, 0.6]],
            log_scales: vec![[-2.0; 3]; 2],
            rotations: vec![[2.0, 0.0, 0.0, 0.0]; 2],
            opacity_logits: vec![1.0; 2],
            sh: vec![[0.1; 3]; 2],
        };
        let config = DeformConfig {
            spatial_resolution: [4; 3],
            time_resolution: 4,
            sh_coefficients: 1,
            ..DeformConfig::dynerf()
        };
        let bounds = Bounds::new([[2.0; 3], [-2.0; 3]]).unwrap();
        let field = DeformationField::new(config, bounds, Init::Foreign, 7).unwrap();
        Model { gaussians, dynamic: vec![1], field: Some(field), ..Model::default() }
    }

    #[test]
    fn only_dynamic_gaussians_change_with_time() {
        let model = model();
        let [first, last] = [0.0, 1.0].map(|time| model.at(time).unwrap());
        assert_eq!(first.means()[0], [0.1, 0.2, 0.3]);
        assert_eq!(first.means()[0], last.means()[0]);
        assert_eq!(first.rotations()[0], [1.0, 0.0, 0.0, 0.0]);
        assert_ne!(first.means()[1], [-0.4, 0.5, 0.6]);
        assert!(model.at(1.5).is_err());
        let still = Model { field: None, dynamic: Vec::new(), ..model };
        assert_eq!(still.at(0.5).unwrap(), still.gaussians.activate().unwrap());
    }

    #[test]
    fn kept_gaussians_keep_their_values_and_whether_they_move() {
        let model = Room::small(11).model().unwrap();
        let kept = model.keep(&[0, 7, 299, 300, 305, 9000]);
        assert_eq!(kept.gaussians.means[1], model.gaussians.means[7]);
        assert_eq!(kept.gaussians.sh_of(4), model.gaussians.sh_of(305));
        assert_eq!(kept.dynamic, [3, 4]);
        assert_eq!(kept.at(0.5).unwrap().means()[4], model.at(0.5).unwrap().means()[305]);
        assert_eq!(model.keep(&(0..400).collect::<Vec<_>>()), model);
    }

    #[test]
    fn moments_of_training_are_met_exactly_and_nothing_beyond_them_is() {
        let model = Model { moments: vec![[0.25, 0.0], [0.5, 0.1], [1.0, 0.4]], ..model() };
        let own = |time: f32| model.own_time(time).ok();
        assert_eq!([0.25, 0.5, 1.0].map(own), [Some(0.0), Some(0.1), Some(0.4)]);
        assert_eq!(own(0.75), Some(0.25));
        assert_eq!([0.2, 1.1, f32::NAN].map(own), [None; 3]);
        assert!(model.at(0.0).unwrap_err().to_string().contains("saw the clip from 0.25 to 1 alone"));
        let single = Model { moments: vec![[0.0, 0.0]], ..model };
        assert_eq!(single.own_time(0.0).unwrap(), 0.0);
    }

    #[test]
    fn the_clip_spans_the_canonical_timeline() {
        assert_eq!([0, 48, 96, 500].map(time_of_frame), [0.0, 0.5, 1.0, 1.0]);
    }
}
