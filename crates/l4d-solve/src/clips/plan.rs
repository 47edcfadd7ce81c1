//! What is to be drawn: from where, when, how large.

use l4d_data::truth::frame_key;
use l4d_data::{Camera, Timeline};
use l4d_splat::view::View;

use super::ClipsError;

/// Index of a camera and of a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Shot {
    /// Index among the cameras.
    pub view: usize,
    /// Index among the times.
    pub instant: usize,
}

/// A time that is drawn.
#[derive(Debug, Clone, PartialEq)]
pub struct Instant {
    /// File stem.
    pub key: String,
    /// Number on the timeline; none for times between frames, at which moving cameras have no pose.
    pub frame: Option<u32>,
    /// From 0 to 1.
    pub time: f32,
}

impl Instant {
    /// A frame of a clip.
    pub fn at_frame(frame: u32, timeline: Timeline) -> Self {
        Self { key: frame_key(frame), frame: Some(frame), time: timeline.time(frame) }
    }

    /// A time from 0 to 1.
    pub fn at_time(time: f32) -> Self {
        Self { key: format!("t{time:.6}"), frame: None, time }
    }
}

/// Cameras, times and the size of the pictures.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// From where.
    pub cameras: Vec<Camera>,
    /// Width and height, pixels, that the numbers of the cameras belong to.
    pub camera_size: [u32; 2],
    /// Width and height of the pictures, pixels.
    pub size: [u32; 2],
    /// When, ascending.
    pub instants: Vec<Instant>,
}

impl Plan {
    /// Some frames of a clip, as large as the cameras say.
    pub fn of_frames(
        cameras: Vec<Camera>,
        camera_size: [u32; 2],
        frames: impl IntoIterator<Item = u32>,
        timeline: Timeline,
    ) -> Self {
        let instants = frames.into_iter().map(|frame| Instant::at_frame(frame, timeline)).collect();
        Self { cameras, camera_size, size: camera_size, instants }
    }

    /// All pictures, view by view.
    pub fn shots(&self) -> impl Iterator<Item = Shot> + use<> {
        let (views, instants) = (self.cameras.len(), self.instants.len());
        (0..views).flat_map(move |view| (0..instants).map(move |instant| Shot { view, instant }))
    }

    /// How many pictures.
    pub fn shot_count(&self) -> usize {
        self.cameras.len() * self.instants.len()
    }

    /// From where a picture is drawn.
    ///
    /// # Errors
    /// A camera from which no picture can be drawn.
    pub fn view(&self, shot: Shot) -> Result<View, ClipsError> {
        let (camera, instant) = (&self.cameras[shot.view], &self.instants[shot.instant]);
        let frame = instant.frame.unwrap_or(0);
        View::of_camera(camera, frame, self.camera_size, self.size)
            .map_err(|source| ClipsError::View { camera: camera.name.to_string(), source })
    }

    /// A camera with the numbers that belong to the pictures that are drawn.
    pub fn drawn_camera(&self, view: usize) -> Camera {
        self.cameras[view].resized(self.camera_size, self.size)
    }
}
