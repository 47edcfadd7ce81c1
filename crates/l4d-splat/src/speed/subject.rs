//! What is looked at: a trained scene with its held-out pictures, or a made-up room.

use glam::UVec2;
use l4d_data::scene::Scene;
use l4d_data::{Camera, DataError, Name, Split, Timeline};
use l4d_frames::Display;
use l4d_frames::exr::read_frame;

use super::{Result, SpeedRequest, plain};
use crate::Model;
use crate::clip::TimeViews;
use crate::model::time_of_frame;
use crate::source::{ReaderOptions, Source};
use crate::synthetic::Room;
use crate::view::View;

/// Frames of the made-up room.
const ROOM_FRAMES: u32 = 25;
/// Times at which it is asked how much each Gaussian shows.
const RANKING_TIMES: usize = 7;

/// Which picture is meant: camera and time by index.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Key {
    pub(super) camera: usize,
    pub(super) time: usize,
}

#[derive(Debug)]
pub(super) struct Subject {
    /// One line about what is drawn.
    pub(super) about: String,
    pub(super) model: Model,
    /// The held-out one first.
    cameras: Vec<Camera>,
    /// All those that a model may know.
    training: Vec<Camera>,
    camera_size: [u32; 2],
    /// Of the pictures, pixels.
    pub(super) size: [u32; 2],
    /// Canonical frames at which it is looked at.
    frames: Vec<u32>,
    /// Canonical frames at which motion is followed.
    all_frames: Vec<u32>,
    /// What the held-out camera saw, display bytes, one a frame; none for a made-up room.
    pub(super) seen: Option<Vec<Vec<u8>>>,
}

impl Subject {
    pub(super) fn open(request: &SpeedRequest<'_>) -> Result<Self> {
        match request.scene {
            Some(scene) => Self::of_scene(request, scene),
            None => Self::of_room(request),
        }
    }

    fn of_scene(request: &SpeedRequest<'_>, name: &Name) -> Result<Self> {
        let (space, profile) = (request.space, request.space.profile());
        let dir = space.scene(name);
        let scene = Scene::read(&dir.scene())?;
        let default = || space.work(name).splats();
        let path = request.model.clone().unwrap_or_else(default);
        let all_frames: Vec<u32> = profile.frames().collect();
        let source =
            Source::open(&path, ReaderOptions::default())?.on(&path, Timeline::CANONICAL, &all_frames)?;
        let frames = evenly(&all_frames, request.times);
        let held_out = scene.cameras.iter().filter(|camera| camera.split == Split::Test);
        let training: Vec<Camera> =
            scene.cameras.iter().filter(|camera| camera.split == Split::Train).cloned().collect();
        let cameras: Vec<Camera> = held_out.cloned().chain(evenly(&training, request.views - 1)).collect();
        let size = [scene.width, scene.height];
        let display = Display::new(scene.exposure);
        let seen = |frame: &u32| {
            let held_out = &cameras.first().map_or("", |camera| camera.name.as_str());
            let path = dir.frame(held_out, *frame);
            let picture = read_frame(&path, UVec2::from_array(size)).map_err(DataError::from)?;
            Ok(display.picture(&picture).into_raw())
        };
        Ok(Self {
            about: about(
                &format!("{name}, profile {profile}"),
                &source.model,
                size,
                cameras.len() * frames.len(),
            ),
            seen: Some(frames.iter().map(seen).collect::<Result<_>>()?),
            model: source.model,
            camera_size: size,
            size,
            all_frames,
            frames,
            cameras,
            training,
        })
    }

    fn of_room(request: &SpeedRequest<'_>) -> Result<Self> {
        let room = Room { gaussians: request.gaussians, ..Room::ordinary(request.seed) };
        let model = room.model().map_err(plain)?;
        let all_cameras = room.cameras().map_err(plain)?;
        // The held-out one is the last.
        let all_cameras: Vec<Camera> = all_cameras.into_iter().rev().collect();
        let cameras = evenly(&all_cameras, request.views);
        let size = request.size.unwrap_or(room.camera_size());
        let all_frames: Vec<u32> = (0..ROOM_FRAMES).map(|index| index * 96 / (ROOM_FRAMES - 1)).collect();
        let frames = evenly(&all_frames, request.times);
        let pictures = cameras.len() * frames.len();
        Ok(Self {
            about: about(&format!("a made-up room, seed {}", request.seed), &model, size, pictures),
            model,
            camera_size: room.camera_size(),
            size,
            all_frames,
            frames,
            training: all_cameras.into_iter().skip(1).collect(),
            cameras,
            seen: None,
        })
    }

    /// All pictures, in a size.
    pub(super) fn moments(&self, size: [u32; 2]) -> Result<Vec<TimeViews<Key>>> {
        self.moments_of(&self.cameras, &self.frames, size)
    }

    /// Small pictures from all training cameras at some times, that rank Gaussians.
    pub(super) fn training_moments(&self) -> Result<Vec<TimeViews<Key>>> {
        let size = self.size.map(|side| side.div_ceil(2));
        self.moments_of(&self.training, &evenly(&self.all_frames, RANKING_TIMES), size)
    }

    fn moments_of(&self, cameras: &[Camera], frames: &[u32], size: [u32; 2]) -> Result<Vec<TimeViews<Key>>> {
        let moment = |(time, &frame): (usize, &u32)| {
            let view = |(camera, from): (usize, &Camera)| {
                Ok((
                    Key { camera, time },
                    View::of_camera(from, frame, self.camera_size, size).map_err(plain)?,
                ))
            };
            let views = cameras.iter().enumerate().map(view).collect::<Result<_>>()?;
            Ok(TimeViews { time: time_of_frame(frame), views })
        };
        frames.iter().enumerate().map(moment).collect()
    }

    /// Place of a picture in a list of all.
    pub(super) fn place(&self, key: Key) -> usize {
        key.time * self.cameras.len() + key.camera
    }
}

fn about(what: &str, model: &Model, [width, height]: [u32; 2], pictures: usize) -> String {
    format!(
        "{what}: {} Gaussians, {} of them dynamic, degree {}; {pictures} pictures of {width} x {height}",
        model.gaussians.len(),
        model.dynamic.len(),
        model.gaussians.sh_degree.get()
    )
}

/// So many of a list, from its first to its last.
fn evenly<T: Clone>(list: &[T], count: usize) -> Vec<T> {
    let count = count.min(list.len());
    let steps = count.saturating_sub(1).max(1);
    (0..count).filter_map(|index| list.get(index * list.len().saturating_sub(1) / steps).cloned()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_part_of_a_list_reaches_from_end_to_end() {
        assert_eq!(evenly(&[0, 1, 2, 3, 4, 5, 6, 7, 8], 3), [0, 4, 8]);
        assert_eq!(evenly(&[5, 6], 4), [5, 6]);
        assert_eq!(evenly(&[5, 6], 1), [5]);
        assert!(evenly::<u8>(&[], 3).is_empty() && evenly(&[1], 0).is_empty());
    }
}
