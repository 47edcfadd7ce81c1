//! What all views of a scene show parts of: the Gaussians of its model.

use l4d_data::StageError;

use crate::clip::ViewClip;

/// The Gaussians of a scene, and how views show them.
pub trait GaussianProjector: Sync {
    /// For each of them the sums of its blend weights over the pixels of a picture, times what `pixels` holds there:
    /// `channels` numbers each.
    ///
    /// # Errors
    /// What drawing meets.
    fn gather(
        &self,
        clip: &ViewClip,
        frame: u32,
        pixels: &[f32],
        channels: usize,
    ) -> Result<Vec<f32>, StageError>;

    /// Blends numbers that they carry over the pixels of a picture: `channels` numbers each.
    ///
    /// # Errors
    /// What drawing meets.
    fn splat(
        &self,
        clip: &ViewClip,
        frame: u32,
        features: &[f32],
        channels: usize,
    ) -> Result<Vec<f32>, StageError>;
}
