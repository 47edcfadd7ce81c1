//! The pictures that a model is trained on, in memory.
//!
//! Three bytes of colour and two of depth a pixel: 145 MB for 12 views of 49 moments at 256 x 192. Knows nothing of
//! files, of what the pictures show, and of held-out views: those are footage of their own.

use half::f16;
use l4d_data::Camera;

use crate::model::time_of_frame;
use crate::view::{View, ViewError};

/// One camera at one moment.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Picture {
    /// Display colour, row-major.
    pub colour: Vec<[u8; 3]>,
    /// Planar depth, metres, row-major; +inf where nothing is hit.
    pub depth_m: Vec<f16>,
}

/// A clip from one camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Shot {
    /// Name of the camera.
    pub name: String,
    /// One for a camera that stands still, or one a moment.
    views: Vec<View>,
    /// One a moment.
    pictures: Vec<Picture>,
}

/// The same clip from all cameras.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Footage {
    size: [u32; 2],
    frames: Vec<u32>,
    shots: Vec<Shot>,
}

/// Why pictures are no footage.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FootageError {
    /// Nothing to train on.
    #[error("there are no {what}: {remedy}")]
    Nothing {
        /// What is missing.
        what: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// Frames that are out of order, repeated or beyond the clip.
    #[error("frame {0} is out of order or beyond the clip: frames ascend from 0 to 96")]
    Frame(u32),
    /// A list that does not fit.
    #[error("camera `{camera}`, moment {moment}: {what} has {found} entries where {expected} are needed")]
    Length {
        /// Name of the camera.
        camera: String,
        /// Index of the moment.
        moment: usize,
        /// Which list.
        what: &'static str,
        /// Entries found.
        found: usize,
        /// Entries needed.
        expected: usize,
    },
    /// A depth that no camera measures.
    #[error(
        "camera `{camera}`, moment {moment}: the depth of pixel {pixel} is {value} m, but depths are positive"
    )]
    Depth {
        /// Name of the camera.
        camera: String,
        /// Index of the moment.
        moment: usize,
        /// Index of the pixel.
        pixel: usize,
        /// What stands there.
        value: f32,
    },
    /// A camera that nothing can be seen through.
    #[error("camera `{camera}` is unusable")]
    View {
        /// Name of the camera.
        camera: String,
        /// What is wrong with it.
        source: ViewError,
    },
}

impl Footage {
    /// An empty clip of pictures of `size` (width, height) at these canonical frames.
    ///
    /// # Errors
    /// No frames, or frames that do not ascend within the clip.
    pub fn new(size: [u32; 2], frames: Vec<u32>) -> Result<Self, FootageError> {
        if frames.is_empty() {
            return Err(FootageError::Nothing { what: "frames", remedy: "train on at least one" });
        }
        let beyond = |&frame: &u32| frame > l4d_data::timeline::LAST_FRAME;
        let backwards = frames.windows(2).find(|pair| pair[0] >= pair[1]).map(|pair| pair[1]);
        if let Some(frame) = backwards.or_else(|| frames.iter().copied().find(beyond)) {
            return Err(FootageError::Frame(frame));
        }
        Ok(Self { size, frames, shots: Vec::new() })
    }

    /// Adds what a camera saw, a picture a frame. `camera_size` is the size that its intrinsics are for.
    ///
    /// # Errors
    /// A camera that cannot be, pictures of another size, depths that are not positive.
    pub fn add(
        &mut self,
        camera: &Camera,
        camera_size: [u32; 2],
        pictures: Vec<Picture>,
    ) -> Result<(), FootageError> {
        let name = camera.name.to_string();
        let poses = if camera.world_from_camera.len() == 1 { &self.frames[..1] } else { &self.frames[..] };
        let views = poses
            .iter()
            .map(|&frame| View::of_camera(camera, frame, camera_size, self.size))
            .collect::<Result<Vec<_>, _>>()
            .map_err(|source| FootageError::View { camera: name.clone(), source })?;
        let pixels = self.pixel_count();
        let length = |moment: usize, what, found: usize, expected: usize| {
            let camera = name.clone();
            if found == expected {
                Ok(())
            } else {
                Err(FootageError::Length { camera, moment, what, found, expected })
            }
        };
        length(0, "the clip", pictures.len(), self.frames.len())?;
        for (moment, picture) in pictures.iter().enumerate() {
            length(moment, "colour", picture.colour.len(), pixels)?;
            length(moment, "depth", picture.depth_m.len(), pixels)?;
            let is_bad = |depth_m: &f16| depth_m.is_nan() || *depth_m <= f16::ZERO;
            if let Some(pixel) = picture.depth_m.iter().position(is_bad) {
                let value = picture.depth_m[pixel].to_f32();
                return Err(FootageError::Depth { camera: name, moment, pixel, value });
            }
        }
        self.shots.push(Shot { name, views, pictures });
        Ok(())
    }

    /// Width and height, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Pixels of a picture.
    pub fn pixel_count(&self) -> usize {
        self.size[0] as usize * self.size[1] as usize
    }

    /// Number of moments.
    pub fn moments(&self) -> usize {
        self.frames.len()
    }

    /// Canonical frames of the moments.
    pub fn frames(&self) -> &[u32] {
        &self.frames
    }

    /// Time of a moment, 0 to 1 over the canonical clip.
    pub fn time(&self, moment: usize) -> f32 {
        time_of_frame(self.frames[moment])
    }

    /// What each camera saw.
    pub fn shots(&self) -> &[Shot] {
        &self.shots
    }

    /// The radius of the cameras about their middle, times 1.1, metres: the scale by which centres learn. At least
    /// 0.1.
    pub fn extent_m(&self) -> f64 {
        let middle = self.middle();
        let distance =
            |centre: &[f64; 3]| (0..3).map(|axis| (centre[axis] - middle[axis]).powi(2)).sum::<f64>().sqrt();
        (1.1 * self.centres().iter().map(distance).fold(0.0, f64::max)).max(0.1)
    }

    /// The middle of the cameras, world axes, metres.
    pub fn middle(&self) -> [f64; 3] {
        let centres = self.centres();
        std::array::from_fn(|axis| {
            centres.iter().map(|centre| centre[axis]).sum::<f64>() / centres.len().max(1) as f64
        })
    }

    fn centres(&self) -> Vec<[f64; 3]> {
        self.shots.iter().flat_map(|shot| shot.views.iter().map(View::centre)).collect()
    }

    /// Bytes of the pictures.
    pub fn bytes(&self) -> u64 {
        let pixels = (self.shots.len() * self.moments() * self.pixel_count()) as u64;
        pixels * (size_of::<[u8; 3]>() + size_of::<f16>()) as u64
    }
}

impl Shot {
    /// The view at a moment.
    pub fn view(&self, moment: usize) -> &View {
        if self.stands() { &self.views[0] } else { &self.views[moment] }
    }

    /// The picture of a moment.
    pub fn picture(&self, moment: usize) -> &Picture {
        &self.pictures[moment]
    }

    /// All pictures, by moment.
    pub fn pictures(&self) -> &[Picture] {
        &self.pictures
    }

    /// Whether the camera stands still.
    pub fn stands(&self) -> bool {
        self.views.len() == 1
    }
}

impl Picture {
    /// Display colour of a pixel, 0 to 1.
    pub fn colour_of(&self, pixel: usize) -> [f32; 3] {
        self.colour[pixel].map(unit)
    }
}

/// A byte of display colour as a fraction.
pub(super) fn unit(byte: u8) -> f32 {
    f32::from(byte) / 255.0
}

#[cfg(test)]
mod tests {
    use l4d_data::{Name, Split};

    use super::*;

    fn camera() -> Camera {
        let pose = [1., 0., 0., 3., 0., 1., 0., 4., 0., 0., 1., 0., 0., 0., 0., 1.];
        Camera {
            name: Name::new("cam00").unwrap(),
            split: Split::Train,
            fx: 4.0,
            fy: 4.0,
            cx: 1.0,
            cy: 1.0,
            world_from_camera: vec![pose],
        }
    }

    fn picture() -> Picture {
        Picture { colour: vec![[255, 0, 51]; 4], depth_m: vec![f16::ONE; 4] }
    }

    #[test]
    fn pictures_that_do_not_fit_are_refused_with_camera_and_moment() {
        let mut footage = Footage::new([2, 2], vec![0, 48]).unwrap();
        let error = footage.add(&camera(), [2, 2], vec![picture()]).unwrap_err().to_string();
        assert!(error.contains("`cam00`") && error.contains("the clip has 1"), "{error}");
        let mut torn = picture();
        torn.depth_m[3] = f16::NAN;
        let error = footage.add(&camera(), [2, 2], vec![picture(), torn]).unwrap_err().to_string();
        assert!(error.contains("moment 1") && error.contains("pixel 3 is NaN"), "{error}");
        let mut blind = camera();
        blind.fx = 0.0;
        let error = footage.add(&blind, [2, 2], vec![picture(), picture()]).unwrap_err();
        assert!(matches!(error, FootageError::View { .. }));
        assert_eq!(footage.shots().len(), 0);
        footage.add(&camera(), [2, 2], vec![picture(), picture()]).unwrap();
        assert_eq!((footage.time(1), footage.bytes()), (0.5, 2 * 4 * 5));
        assert_eq!(footage.shots()[0].picture(1).colour_of(0), [1.0, 0.0, 0.2]);
    }

    #[test]
    fn frames_ascend_within_the_clip() {
        assert!(Footage::new([2, 2], vec![]).is_err());
        assert_eq!(Footage::new([2, 2], vec![0, 4, 4]), Err(FootageError::Frame(4)));
        assert_eq!(Footage::new([2, 2], vec![0, 97]), Err(FootageError::Frame(97)));
    }

    #[test]
    fn the_extent_is_the_radius_of_the_cameras() {
        let mut footage = Footage::new([2, 2], vec![0]).unwrap();
        footage.add(&camera(), [2, 2], vec![picture()]).unwrap();
        assert_eq!(footage.extent_m(), 0.1);
        let mut other = camera();
        other.world_from_camera[0][3] = 13.0;
        footage.add(&other, [2, 2], vec![picture()]).unwrap();
        assert!((footage.extent_m() - 5.5).abs() < 1e-12);
    }
}
