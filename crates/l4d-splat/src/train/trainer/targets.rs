//! What the model is compared with at an iteration.

use half::slice::HalfFloatSliceExt as _;
use rand_chacha::ChaCha8Rng;

use super::super::TrainError;
use super::super::crop::{ChangedRegion, Crop};
use super::super::loss::Target;
use super::super::motion::SurfaceKind;
use super::super::scene_stats::sample;
use super::super::views::unit;
use super::Trainer;

impl Trainer<'_> {
    pub(super) fn background_target(&self, camera: usize) -> Option<Target> {
        let background = self.motion.background(camera)?;
        let stays = |pixel: usize| background.kind[pixel] != SurfaceKind::Moving;
        let depth = |(pixel, &depth_m): (usize, &f32)| if stays(pixel) { depth_m } else { f32::INFINITY };
        Some(Target {
            view: *self.views.cameras()[camera].view(0),
            colour: background.colour.as_flattened().to_vec(),
            depth_m: background.depth_m.iter().enumerate().map(depth).collect(),
            marked: (0..background.kind.len()).map(stays).collect(),
            zoom: [1.0; 2],
        })
    }

    pub(super) fn clip_targets(
        &self,
        moment: usize,
        whole: bool,
        random: &mut ChaCha8Rng,
    ) -> Result<Vec<Target>, TrainError> {
        let moments = self.views.moments();
        let region = |camera: usize| self.regions[camera * moments + moment].as_ref();
        let busy: Vec<usize> =
            self.views.cameras_at(moment).filter(|&camera| whole || region(camera).is_some()).collect();
        let target = |camera| self.clip_target(camera, moment, region(camera).filter(|_| !whole));
        // A whole picture costs several times what changes in it does, unless nothing is known to stand still.
        let is_dear = whole && self.motion.tells_apart();
        let views = if is_dear { self.settings.views.div_ceil(2) } else { self.settings.views };
        sample(&busy, views, random).into_iter().map(target).collect()
    }

    /// A part of a picture, or all of it.
    fn clip_target(
        &self,
        camera: usize,
        moment: usize,
        region: Option<&ChangedRegion>,
    ) -> Result<Target, TrainError> {
        let [width, height] = self.views.size();
        let crop = region.map_or(Crop::whole(self.views.size()), |region| region.crop);
        let marked = region.map(ChangedRegion::marks).unwrap_or_default();
        let camera = &self.views.cameras()[camera];
        let picture = camera.picture(moment);
        let (mut colour, mut depth_m) = (Vec::new(), Vec::new());
        for pixels in crop.rows(width as usize) {
            colour.extend(picture.colour[pixels.clone()].as_flattened().iter().copied().map(unit));
            if self.views.has_depth() {
                depth_m.extend(picture.depth_m[pixels].to_f32_vec());
            }
        }
        for (depth_m, marked) in depth_m.iter_mut().zip(&marked) {
            *depth_m = if *marked { *depth_m } else { f32::INFINITY };
        }
        Ok(Target {
            view: crop.of(camera.view(moment))?,
            colour,
            depth_m,
            marked,
            zoom: [width as f32 / crop.width as f32, height as f32 / crop.height as f32],
        })
    }
}
