//! The pictures that a model is trained on, in memory.
//!
//! Three bytes of colour and two of depth per pixel: 145 MB for 12 views of 49 moments at 256 x 192. Depth is there for all
//! pictures or for none; a camera may have missed moments. Knows nothing of files, of what the pictures show, and of
//! held-out views: those are views of their own.

use glam::DVec3;
use half::f16;
use l4d_data::{Camera, Timeline};

use crate::view::View;

/// One camera at one moment; empty if it did not look then.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Picture {
    /// Display colour, row-major.
    pub(crate) colour: Vec<[u8; 3]>,
    /// Planar depth, metres, row-major; +inf where nothing is hit. Empty where there is none.
    pub(crate) depth_m: Vec<f16>,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TrainingCamera {
    /// One for a static camera, or one per moment.
    views: Vec<View>,
    /// One per moment.
    pictures: Vec<Picture>,
}

/// The same clip from all cameras.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TrainingViews {
    size: [u32; 2],
    frames: Vec<u32>,
    timeline: Timeline,
    has_depth: bool,
    cameras: Vec<TrainingCamera>,
}

/// Why pictures cannot be trained on: camera, moment, list, and the hint.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub(crate) struct TrainingViewsError(String);

impl TrainingViewsError {
    pub(super) fn nothing(what: &str, hint: &str) -> Self {
        Self(format!("there are no {what}: {hint}"))
    }
}

impl TrainingViews {
    /// An empty clip of pictures of `size` (width, height) at these frames of a timeline.
    pub(crate) fn new(
        size: [u32; 2],
        frames: Vec<u32>,
        timeline: Timeline,
    ) -> Result<Self, TrainingViewsError> {
        if frames.is_empty() {
            return Err(TrainingViewsError::nothing("frames", "train on at least one"));
        }
        let whole = timeline.whole();
        let beyond = |&frame: &u32| !whole.contains(frame);
        let backwards = frames.windows(2).find(|pair| pair[0] >= pair[1]).map(|pair| pair[1]);
        if let Some(frame) = backwards.or_else(|| frames.iter().copied().find(beyond)) {
            return Err(TrainingViewsError(format!(
                "frame {frame} is out of order or beyond the clip: frames ascend from {} to {}",
                whole.first(),
                whole.last()
            )));
        }
        Ok(Self { size, frames, timeline, has_depth: false, cameras: Vec::new() })
    }

    /// Adds what a camera saw, one picture per frame; an error for a camera that cannot be or saw nothing, and for
    /// depths that are not positive or that some pictures have and others lack. `camera_size` is the size that the
    /// camera's intrinsics are for.
    pub(crate) fn add(
        &mut self,
        camera: &Camera,
        camera_size: [u32; 2],
        pictures: Vec<Picture>,
    ) -> Result<(), TrainingViewsError> {
        let name = &camera.name;
        let poses = if camera.world_from_camera.len() == 1 { &self.frames[..1] } else { &self.frames[..] };
        let views = poses
            .iter()
            .map(|&frame| View::of_camera(camera, frame, camera_size, self.size))
            .collect::<Result<Vec<_>, _>>()
            .map_err(|error| TrainingViewsError(format!("camera `{name}` is unusable: {error}")))?;
        let seen = || pictures.iter().enumerate().filter(|(_, picture)| !picture.colour.is_empty());
        let Some((_, first)) = seen().next() else {
            return Err(TrainingViewsError::nothing("pictures of a camera", "leave the camera out"));
        };
        let has_depth = if self.cameras.is_empty() { !first.depth_m.is_empty() } else { self.has_depth };
        let (pixels, depths) = (self.pixel_count(), if has_depth { self.pixel_count() } else { 0 });
        let wrong =
            |moment, message| Err(TrainingViewsError(format!("camera `{name}`, moment {moment}: {message}")));
        for (moment, Picture { colour, depth_m }) in seen() {
            for (what, found, expected) in
                [("colour", colour.len(), pixels), ("depth", depth_m.len(), depths)]
            {
                if found != expected {
                    return wrong(moment, format!("{what} has {found} entries where {expected} are needed"));
                }
            }
            let is_bad = |depth_m: &f16| depth_m.is_nan() || *depth_m <= f16::ZERO;
            if let Some(pixel) = depth_m.iter().position(is_bad) {
                let value = depth_m[pixel];
                let message = format!("the depth of pixel {pixel} is {value} m, but depths are positive");
                return wrong(moment, message);
            }
        }
        self.has_depth = has_depth;
        self.cameras.push(TrainingCamera { views, pictures });
        Ok(())
    }

    /// The same pictures without depth.
    #[cfg(test)]
    pub(super) fn of_colour(&self) -> Self {
        let mut views = Self { has_depth: false, ..self.clone() };
        let pictures = views.cameras.iter_mut().flat_map(|camera| &mut camera.pictures);
        pictures.for_each(|picture| picture.depth_m.clear());
        views
    }

    pub(crate) fn size(&self) -> [u32; 2] {
        self.size
    }

    pub(crate) fn pixel_count(&self) -> usize {
        self.size[0] as usize * self.size[1] as usize
    }

    pub(crate) fn moments(&self) -> usize {
        self.frames.len()
    }

    /// Whether depth was measured. Where it was not, it is found by comparing pictures.
    pub(crate) fn has_depth(&self) -> bool {
        self.has_depth
    }

    /// Time of a moment, 0 to 1 over the clip.
    pub(crate) fn time(&self, moment: usize) -> f32 {
        self.timeline.time(self.frames[moment])
    }

    /// Indices of the cameras that saw a moment.
    pub(crate) fn cameras_at(&self, moment: usize) -> impl Iterator<Item = usize> {
        (0..self.cameras.len()).filter(move |&camera| self.cameras[camera].has_picture(moment))
    }

    pub(crate) fn cameras(&self) -> &[TrainingCamera] {
        &self.cameras
    }

    /// The radius of the cameras about their middle, times 1.1, metres: the scale by which centres learn. At least
    /// 0.1.
    pub(crate) fn extent_m(&self) -> f64 {
        let middle = DVec3::from(self.middle());
        let reach = self.centres().map(|centre| centre.distance(middle)).fold(0.0, f64::max);
        (1.1 * reach).max(0.1)
    }

    /// The middle of the cameras, world axes, metres.
    pub(crate) fn middle(&self) -> [f64; 3] {
        (self.centres().sum::<DVec3>() / self.centres().count().max(1) as f64).to_array()
    }

    fn centres(&self) -> impl Iterator<Item = DVec3> {
        self.cameras.iter().flat_map(|camera| camera.views.iter().map(|view| view.centre().into()))
    }

    pub(crate) fn bytes(&self) -> u64 {
        let of_picture = |picture: &Picture| size_of_val(&*picture.colour) + size_of_val(&*picture.depth_m);
        self.cameras.iter().flat_map(|camera| &camera.pictures).map(of_picture).sum::<usize>() as u64
    }
}

impl TrainingCamera {
    pub(crate) fn view(&self, moment: usize) -> &View {
        if self.is_static() { &self.views[0] } else { &self.views[moment] }
    }

    pub(crate) fn picture(&self, moment: usize) -> &Picture {
        &self.pictures[moment]
    }

    pub(crate) fn has_picture(&self, moment: usize) -> bool {
        !self.pictures[moment].colour.is_empty()
    }

    pub(crate) fn pictures(&self) -> &[Picture] {
        &self.pictures
    }

    pub(crate) fn is_static(&self) -> bool {
        self.views.len() == 1
    }
}

impl Picture {
    /// Display colour of a pixel, 0 to 1.
    pub(crate) fn colour_of(&self, pixel: usize) -> [f32; 3] {
        self.colour[pixel].map(unit)
    }
}

/// A byte of display colour as a fraction.
pub(super) fn unit(byte: u8) -> f32 {
    f32::from(byte) / 255.0
}

#[cfg(test)]
mod tests {
    use glam::DMat4;
    use l4d_data::{Interval, Name};

    use super::*;

    fn camera() -> Camera {
        let pose = DMat4::from_translation(DVec3::new(3.0, 4.0, 0.0));
        Camera::new(Name::new("cam00").unwrap(), [2, 2], 4.0, pose)
    }

    fn clip(frames: &[u32]) -> Result<TrainingViews, TrainingViewsError> {
        TrainingViews::new([2, 2], frames.to_vec(), Timeline::CANONICAL)
    }

    fn picture() -> Picture {
        Picture { colour: vec![[255, 0, 51]; 4], depth_m: vec![f16::ONE; 4] }
    }

    #[test]
    fn pictures_that_do_not_fit_are_refused_with_camera_and_moment() {
        let mut views = clip(&[0, 48]).unwrap();
        let mut torn = picture();
        torn.depth_m[3] = f16::NAN;
        let error = views.add(&camera(), [2, 2], vec![picture(), torn]).unwrap_err().to_string();
        assert!(error.contains("moment 1") && error.contains("pixel 3 is NaN"), "{error}");
        let mut blind = camera();
        blind.fx = 0.0;
        let error = views.add(&blind, [2, 2], vec![picture(), picture()]).unwrap_err();
        assert!(error.to_string().contains("`cam00` is unusable"), "{error}");
        assert_eq!(views.cameras().len(), 0);
        views.add(&camera(), [2, 2], vec![picture(), picture()]).unwrap();
        assert_eq!((views.time(1), views.bytes()), (0.5, 2 * 4 * 5));
        assert_eq!(views.cameras()[0].picture(1).colour_of(0), [1.0, 0.0, 0.2]);
    }

    #[test]
    fn all_pictures_have_depth_or_none_and_some_may_be_missing() {
        let bare = || Picture { depth_m: Vec::new(), ..picture() };
        let mut views = clip(&[0, 48]).unwrap();
        views.add(&camera(), [2, 2], vec![Picture::default(), bare()]).unwrap();
        assert!(!views.has_depth() && views.cameras_at(0).next().is_none());
        assert_eq!((views.cameras_at(1).collect::<Vec<_>>(), views.bytes()), (vec![0], 4 * 3));
        let error = views.add(&camera(), [2, 2], vec![bare(), picture()]).unwrap_err().to_string();
        assert!(error.contains("depth has 4 entries where 0 are needed"), "{error}");
        let error = views.add(&camera(), [2, 2], vec![Picture::default(); 2]).unwrap_err();
        assert!(error.to_string().contains("no pictures of a camera"), "{error}");
    }

    #[test]
    fn frames_ascend_within_the_clip() {
        assert!(clip(&[]).is_err());
        for (frames, wrong) in [(&[0, 4, 4][..], "frame 4 "), (&[0, 97][..], "frame 97 ")] {
            assert!(clip(frames).unwrap_err().to_string().starts_with(wrong));
        }
        let whole = Interval::new(151, 161).unwrap();
        let own = |frames: &[u32]| TrainingViews::new([2, 2], frames.to_vec(), Timeline::new(whole, None));
        assert_eq!(own(&[151, 156]).unwrap().time(1), 0.5);
        assert!(own(&[150]).unwrap_err().to_string().contains("frames ascend from 151 to 161"));
    }

    #[test]
    fn the_extent_is_the_radius_of_the_cameras() {
        let mut views = clip(&[0]).unwrap();
        views.add(&camera(), [2, 2], vec![picture()]).unwrap();
        assert_eq!(views.extent_m(), 0.1);
        let mut other = camera();
        other.world_from_camera[0][3] = 13.0;
        views.add(&other, [2, 2], vec![picture()]).unwrap();
        assert!((views.extent_m() - 5.5).abs() < 1e-12);
    }
}
