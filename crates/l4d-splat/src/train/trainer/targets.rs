//! What the model is compared with at an iteration.

use rand_chacha::ChaCha8Rng;

use super::super::TrainError;
use super::super::learn::Target;
use super::super::motion::Kind;
use super::super::survey::chosen;
use super::super::window::Window;
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
            ignored: (0..ground.kind.len()).map(|pixel| !stays(pixel)).collect(),
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
        let window = |shot: usize| self.windows[shot * moments + moment];
        let busy: Vec<usize> =
            (0..self.footage.shots().len()).filter(|&shot| whole || window(shot).is_some()).collect();
        chosen(&busy, self.settings.views, random)
            .into_iter()
            .map(|shot| {
                let all = Window::whole(self.footage.size());
                let part = if whole { all } else { window(shot).unwrap_or(all) };
                self.clip_target(shot, moment, part)
            })
            .collect()
    }

    fn clip_target(&self, shot: usize, moment: usize, window: Window) -> Result<Target, TrainError> {
        let [width, height] = self.footage.size();
        let shot = &self.footage.shots()[shot];
        let picture = shot.picture(moment);
        let pixels = || window.pixels(width as usize);
        Ok(Target {
            view: window.of(shot.view(moment))?,
            colour: pixels().flat_map(|pixel| picture.colour_of(pixel)).collect(),
            depth_m: pixels().map(|pixel| picture.depth_m[pixel].to_f32()).collect(),
            ignored: Vec::new(),
            zoom: [width as f32 / window.width as f32, height as f32 / window.height as f32],
        })
    }
}
