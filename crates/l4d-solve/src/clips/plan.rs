//! What is to be drawn: from where, when, how large.

use glam::DVec3;
use l4d_data::truth::frame_key;
use l4d_data::{At as _, Camera, StageError, Timeline};
use l4d_splat::view::View;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

/// Index of a camera and of a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct PictureIndex {
    /// Index among the cameras.
    pub view: usize,
    /// Index among the times.
    pub instant: usize,
}

/// A time that is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawnTime {
    pub key: String,
    /// Number on the timeline; none for times between frames, at which moving cameras have no pose.
    pub frame: Option<u32>,
    /// From 0 to 1.
    pub time: f32,
}

impl DrawnTime {
    pub(crate) fn at_frame(frame: u32, timeline: Timeline) -> Self {
        Self { key: frame_key(frame), frame: Some(frame), time: timeline.time(frame) }
    }
}

/// Moments at these times, ascending.
///
/// # Errors
/// A time outside 0 to 1, or a camera that moves: it is known at frames alone.
pub(crate) fn instants_at(times: &[f32], cameras: &[Camera]) -> Result<Vec<DrawnTime>, StageError> {
    if let Some(time) = times.iter().find(|time| !(0.0..=1.0).contains(*time)) {
        return Err(StageError::new(format!("time {time} is outside the clip"), "times are 0 to 1"));
    }
    if let Some(camera) = cameras.iter().find(|camera| camera.world_from_camera.len() > 1) {
        return Err(StageError::new(
            format!("camera {} moves, and is known at canonical frames alone", camera.name),
            "choose frames instead of times",
        ));
    }
    let instant = |&time: &f32| DrawnTime { key: format!("t{time:.6}"), frame: None, time };
    let mut instants: Vec<DrawnTime> = times.iter().map(instant).collect();
    instants.sort_by(|a, b| a.time.total_cmp(&b.time));
    instants.dedup_by(|a, b| a.key == b.key);
    Ok(instants)
}

/// Cameras, times and the size of the pictures.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    pub cameras: Vec<Camera>,
    /// Width and height, pixels, that the numbers of the cameras belong to.
    pub camera_size: [u32; 2],
    /// Width and height of the pictures, pixels.
    pub size: [u32; 2],
    /// When, ascending.
    pub instants: Vec<DrawnTime>,
}

impl Plan {
    /// Some frames of a clip, as large as the cameras say.
    pub(crate) fn of_frames(
        cameras: Vec<Camera>,
        camera_size: [u32; 2],
        frames: impl IntoIterator<Item = u32>,
        timeline: Timeline,
    ) -> Self {
        let instants = frames.into_iter().map(|frame| DrawnTime::at_frame(frame, timeline)).collect();
        Self { cameras, camera_size, size: camera_size, instants }
    }

    /// All pictures, view by view.
    pub fn pictures(&self) -> impl Iterator<Item = PictureIndex> + use<> {
        let (views, instants) = (self.cameras.len(), self.instants.len());
        (0..views).flat_map(move |view| (0..instants).map(move |instant| PictureIndex { view, instant }))
    }

    /// The camera and the time of a picture.
    pub(crate) fn of(&self, index: PictureIndex) -> (&Camera, &DrawnTime) {
        (&self.cameras[index.view], &self.instants[index.instant])
    }

    /// From where a picture is drawn.
    ///
    /// # Errors
    /// A camera from which no picture can be drawn.
    pub(crate) fn view(&self, index: PictureIndex) -> Result<View, StageError> {
        let (camera, instant) = self.of(index);
        View::of_camera(camera, instant.frame.unwrap_or(0), self.camera_size, self.size)
            .map_err(|error| {
                StageError::of(&error, "correct the camera in the card of the scene, or choose another size")
            })
            .at(format_args!("camera {}", camera.name))
    }

    /// A camera with the numbers that belong to the pictures that are drawn.
    pub(crate) fn drawn_camera(&self, view: usize) -> Camera {
        self.cameras[view].resized(self.camera_size, self.size)
    }
}

/// Indices of `count` cameras by farthest-point sampling of their positions at frame 0, ascending: the first is drawn
/// by `seed`, each next one is the farthest from all before it, the earlier in the list where several are. All of
/// them if there are no more.
///
/// The paper says "V diverse viewpoints" and no more.
pub(crate) fn spread_views(cameras: &[Camera], count: usize, seed: u64) -> Vec<usize> {
    if cameras.is_empty() || count == 0 {
        return Vec::new();
    }
    let places: Vec<DVec3> =
        cameras.iter().map(|camera| camera.world_from_camera(0).w_axis.truncate()).collect();
    let first = ChaCha8Rng::seed_from_u64(seed).random_range(0..places.len());
    let mut chosen = vec![first];
    while chosen.len() < count.min(places.len()) {
        let nearest = |index: &usize| {
            let distances = chosen.iter().map(|&other| places[*index].distance_squared(places[other]));
            distances.fold(f64::INFINITY, f64::min)
        };
        let left = (0..places.len()).filter(|index| !chosen.contains(index));
        // Reversed, since `max_by` keeps the last of equals.
        match left.rev().max_by(|a, b| nearest(a).total_cmp(&nearest(b))) {
            Some(farthest) => chosen.push(farthest),
            None => break,
        }
    }
    chosen.sort_unstable();
    chosen
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::camera;

    fn row(places: &[f64]) -> Vec<Camera> {
        let at = |(index, x): (usize, &f64)| camera(&format!("cam{index:02}"), *x);
        places.iter().enumerate().map(at).collect()
    }

    #[test]
    fn the_next_view_is_the_farthest_from_all_before() {
        let cameras = row(&[0.0, 1.0, 2.0, 4.0, 10.0]);
        for seed in 0..20 {
            let two = spread_views(&cameras, 2, seed);
            assert!(two == [0, 4] || two == [2, 4] || two == [1, 4] || two == [3, 4], "{two:?}");
            let three = spread_views(&cameras, 3, seed);
            assert!(three.contains(&4) && (three.contains(&0) || three.contains(&1)), "{three:?}");
        }
        assert_eq!(spread_views(&cameras, 9, 1), [0, 1, 2, 3, 4]);
        assert_eq!(spread_views(&cameras, 0, 1), [0; 0]);
        assert_eq!(spread_views(&[], 3, 1), [0; 0]);
        // In one place: the earlier ones, and the first that is drawn.
        let one_place = spread_views(&row(&[5.0; 6]), 3, 7);
        assert!(one_place.len() == 3 && one_place[..2] == [0, 1], "{one_place:?}");
    }
}
