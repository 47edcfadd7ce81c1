//! What the model is compared with at an iteration.

use half::slice::HalfFloatSliceExt as _;
use rand_chacha::ChaCha8Rng;

use super::super::TrainError;
use super::super::footage::unit;
use super::super::learn::Target;
use super::super::motion::Kind;
use super::super::survey::chosen;
use super::super::window::{Part, Window};
use super::Trainer;

impl Trainer<'_> {
    pub(super) fn ground_target(&self, shot: usize) -> Option<Target> {
        let ground = self.motion.ground(shot)?;
        let stays = |pixel: usize| ground.kind[pixel] != Kind::Moves;
        let depth = |(pixel, &depth_m): (usize, &f32)| if stays(pixel) { depth_m } else { f32::INFINITY };
        Some(Target {
            view: *self.footage.shots()[shot].view(0),
            colour: ground.colour.as_flattened().to_vec(),
            depth_m: ground.depth_m.iter().enumerate().map(depth).collect(),
            marked: (0..ground.kind.len()).map(stays).collect(),
            zoom: [1.0; 2],
        })
    }

    pub(super) fn clip_targets(
        &self,
        moment: usize,
        whole: bool,
        random: &mut ChaCha8Rng,
    ) -> Result<Vec<Target>, TrainError> {
        let moments = self.footage.moments();
        let part = |shot: usize| self.parts[shot * moments + moment].as_ref();
        let busy: Vec<usize> =
            self.footage.seeing(moment).filter(|&shot| whole || part(shot).is_some()).collect();
        let target = |shot| self.clip_target(shot, moment, part(shot).filter(|_| !whole));
        // A whole picture costs several times what changes in it does, unless nothing is known to stand still.
        let is_dear = whole && self.motion.tells_apart();
        let views = if is_dear { self.settings.views.div_ceil(2) } else { self.settings.views };
        chosen(&busy, views, random).into_iter().map(target).collect()
    }

    /// A part of a picture, or all of it.
    fn clip_target(&self, shot: usize, moment: usize, part: Option<&Part>) -> Result<Target, TrainError> {
        let [width, height] = self.footage.size();
        let window = part.map_or(Window::whole(self.footage.size()), |part| part.window);
        let marked = part.map(Part::marks).unwrap_or_default();
        let shot = &self.footage.shots()[shot];
        let picture = shot.picture(moment);
        let (mut colour, mut depth_m) = (Vec::new(), Vec::new());
        for pixels in window.rows(width as usize) {
            colour.extend(picture.colour[pixels.clone()].as_flattened().iter().copied().map(unit));
            if self.footage.has_depth() {
                depth_m.extend(picture.depth_m[pixels].to_f32_vec());
            }
        }
        for (depth_m, marked) in depth_m.iter_mut().zip(&marked) {
            *depth_m = if *marked { *depth_m } else { f32::INFINITY };
        }
        Ok(Target {
            view: window.of(shot.view(moment))?,
            colour,
            depth_m,
            marked,
            zoom: [width as f32 / window.width as f32, height as f32 / window.height as f32],
        })
    }
}
