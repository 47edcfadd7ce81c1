//! Small pictures of the held-out view, to lie under masks where people look at answers.
//!
//! Knows rendered scenes and captures alike; refuses to know what is drawn on top.

use std::path::Path;

use glam::UVec2;
use image::RgbImage;
use image::imageops::thumbnail;
use l4d_data::capture::{CAPTURE, Capture};
use l4d_data::layout::{CaptureDir, SceneDir};
use l4d_data::store::read_bounded;
use l4d_data::{DataError, Name, Profile, Scene};

use crate::display::Display;
use crate::exr::read_frame;
use crate::overlay::encode_jpeg_of;
use crate::photo;

/// Enough under a mask: a picture of 256x192 takes about 8 kB.
const JPEG_QUALITY: u8 = 72;
/// No picture of a capture is larger.
const MAX_PHOTO_BYTES: u64 = 64 << 20;

/// The held-out view of one scene.
#[derive(Debug)]
pub struct Backdrop {
    source: Source,
    longest_px: u32,
}

#[derive(Debug)]
enum Source {
    Rendered { dir: SceneDir, view: Name, size: UVec2, display: Display },
    Captured { dir: CaptureDir, view: Name, capture: Box<Capture> },
}

impl Backdrop {
    /// Opens `<data>/<scene>`; none if no scene is there. Pictures have no side above `longest_px`.
    ///
    /// # Errors
    /// A scene of another profile or another draw than the truth: its pictures would show something else.
    pub fn open(
        data: &Path,
        scene: &Name,
        profile: Profile,
        variant: u32,
        longest_px: u32,
    ) -> Result<Option<Self>, DataError> {
        let folder = data.join(scene.as_str());
        if folder.join(CAPTURE).is_file() {
            let capture = Capture::read(&folder)?;
            let view = capture.held_out().next().map(|camera| camera.name.clone());
            let dir = CaptureDir::new(data, scene);
            return Ok(view.map(|view| Self {
                source: Source::Captured { dir, view, capture: Box::new(capture) },
                longest_px,
            }));
        }
        let dir = SceneDir::new(data, scene);
        if !dir.scene().is_file() {
            return Ok(None);
        }
        let card = Scene::read(&dir.scene())?;
        let Some(camera) = card.test_camera() else { return Ok(None) };
        if card.profile != profile || card.variant != variant {
            let found = format!("is of profile {}, variant {}", card.profile, card.variant);
            let message = format!("{found}, but the truth is of profile {profile}, variant {variant}");
            return Err(DataError::invalid(&dir.scene(), "scene", message, "choose another --data"));
        }
        let (view, size) = (camera.name.clone(), UVec2::new(card.width, card.height));
        let source = Source::Rendered { dir, view, size, display: Display::new(card.exposure) };
        Ok(Some(Self { source, longest_px }))
    }

    /// What the camera saw, as JPEG.
    ///
    /// # Errors
    /// A picture that cannot be read.
    pub fn jpeg(&self, frame: u32) -> Result<Vec<u8>, DataError> {
        Ok(encode_jpeg_of(&shrunk(self.picture(frame)?, self.longest_px), JPEG_QUALITY))
    }

    fn picture(&self, frame: u32) -> Result<RgbImage, DataError> {
        match &self.source {
            Source::Rendered { dir, view, size, display } => {
                Ok(display.picture(&read_frame(&dir.frame(view, frame), *size)?))
            }
            Source::Captured { dir, view, capture } => {
                let path = dir.picture(view, frame);
                let damaged =
                    |message: String| DataError::invalid(&path, "file", message, "import the scene again");
                if !capture.saw(view, frame) {
                    return Err(damaged("the view did not see this moment".to_owned()));
                }
                let bytes = read_bounded(&path, MAX_PHOTO_BYTES)?;
                photo::decode(&bytes).map_err(|error| damaged(error.to_string()))
            }
        }
    }
}

fn shrunk(picture: RgbImage, longest_px: u32) -> RgbImage {
    let (width, height) = picture.dimensions();
    let longest = width.max(height);
    if longest <= longest_px {
        return picture;
    }
    let scaled = |side: u32| ((side * longest_px + longest / 2) / longest).max(1);
    thumbnail(&picture, scaled(width), scaled(height))
}

#[cfg(test)]
mod tests {
    use l4d_testing::Dataset;

    use super::*;

    #[test]
    fn the_held_out_view_is_shown_small_and_of_this_truth_alone() {
        let fake = Dataset::new();
        let name = fake.scene.name.clone();
        let open = |profile, variant| Backdrop::open(&fake.data(), &name, profile, variant, 64);
        let backdrop = open(Profile::Tiny, fake.scene.variant).unwrap().unwrap();
        let picture = photo::decode(&backdrop.jpeg(48).unwrap()).unwrap();
        assert_eq!(picture.dimensions(), (64, 48));
        assert_eq!(backdrop.jpeg(48).unwrap(), backdrop.jpeg(48).unwrap());
        assert!(backdrop.jpeg(1).is_err(), "a frame that was not rendered");
        let refused = open(Profile::Small, fake.scene.variant).unwrap_err().to_string();
        assert!(refused.contains("profile small"), "{refused}");
        assert!(open(Profile::Tiny, 7).unwrap_err().to_string().contains("variant 7"));
        let elsewhere = Name::new("elsewhere").unwrap();
        assert!(Backdrop::open(&fake.data(), &elsewhere, Profile::Tiny, 0, 64).unwrap().is_none());
    }

    #[test]
    fn pictures_keep_their_shape_and_small_ones_their_size() {
        let picture = |width, height| RgbImage::new(width, height);
        assert_eq!(shrunk(picture(1352, 1014), 320).dimensions(), (320, 240));
        assert_eq!(shrunk(picture(100, 1000), 320).dimensions(), (32, 320));
        assert_eq!(shrunk(picture(256, 192), 320).dimensions(), (256, 192));
    }
}
