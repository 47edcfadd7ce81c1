//! Pictures of a clip for those who answer in words: outlines, numbers and a caption that says view and frame.
//!
//! The same frame always gives the same bytes, since caches and digests hang on them.

use glam::UVec2;
use image::imageops::replace;
use image::{Rgb, RgbImage};
use l4d_data::layout::SceneDir;
use l4d_data::scene::Scene;
use l4d_data::timeline::FPS;
use l4d_data::{Camera, DataError};

use crate::display::Display;
use crate::exr::{FrameError, read_frame};
use crate::overlay::{Mark, annotated, encode_jpeg, marks};
use crate::text::{Style, Weight};

const CAPTION_HEIGHT_PX: u32 = 24;
const CAPTION_PAPER: Rgb<u8> = Rgb([20, 20, 20]);
const CAPTION_INK: Rgb<u8> = Rgb([255; 3]);

/// Draws the pictures of one rendered scene.
#[derive(Debug)]
pub struct Clip<'a> {
    scene: &'a Scene,
    dir: &'a SceneDir,
    display: Display,
    marks: Vec<Mark>,
    factor: u32,
}

impl<'a> Clip<'a> {
    /// Pictures are enlarged by the whole factor that makes them at least `width_px` wide.
    pub fn new(scene: &'a Scene, dir: &'a SceneDir, width_px: u32) -> Self {
        let factor = width_px.div_ceil(scene.width.max(1)).max(1);
        Self { scene, dir, display: Display::new(scene.exposure), marks: marks(&scene.instances), factor }
    }

    /// Width and height of every picture, caption included, pixels.
    pub fn size_px(&self) -> (u32, u32) {
        (self.scene.width * self.factor, self.scene.height * self.factor + CAPTION_HEIGHT_PX)
    }

    /// Number and colour of each instance, in the order of the scene.
    pub fn marks(&self) -> &[Mark] {
        &self.marks
    }

    /// What the camera saw at a rendered frame, with everything annotated outlined and numbered.
    ///
    /// # Errors
    /// A frame that cannot be read.
    pub fn picture(&self, camera: &Camera, frame: u32) -> Result<RgbImage, FrameError> {
        let size = UVec2::new(self.scene.width, self.scene.height);
        let path = self.dir.frame(&camera.name, frame);
        let seen = read_frame(&path, size)?;
        if seen.rgb.iter().flatten().all(|light| light.to_f32() == 0.0) {
            let message = "is black: only depth and ids were rendered";
            let hint = "run `l4d build-scenes --force` with --samples above 0";
            let error = DataError::invalid(&path, "channels R, G, B", message, hint);
            return Err(FrameError::new(FrameError::VALUES, error));
        }
        let picture = annotated(&self.display.picture(&seen), &seen.surfaces.id, self.factor, &self.marks);
        let (width, height) = self.size_px();
        let mut page = RgbImage::from_pixel(width, height, CAPTION_PAPER);
        replace(&mut page, &picture, 0, i64::from(CAPTION_HEIGHT_PX));
        let style = Style { weight: Weight::Semibold, size_px: 18.0, colour: CAPTION_INK };
        style.write(&mut page, 6.0, 2.0, &caption(camera, frame));
        Ok(page)
    }

    /// [`Self::picture`] as JPEG.
    ///
    /// # Errors
    /// A frame that cannot be read.
    pub fn jpeg(&self, camera: &Camera, frame: u32) -> Result<Vec<u8>, FrameError> {
        Ok(encode_jpeg(&self.picture(camera, frame)?))
    }
}

/// What a picture says of itself: `cam08, frame 48, 2.00 s`.
pub fn caption(camera: &Camera, frame: u32) -> String {
    format!("{}, frame {frame}, {:.2} s", camera.name, f64::from(frame) / FPS)
}

#[cfg(test)]
mod tests {
    use l4d_testing::Dataset;

    use super::*;
    use crate::exr::write_frame;

    #[test]
    fn a_picture_has_its_caption_and_its_numbers() {
        let fake = Dataset::new();
        let dir = fake.dir();
        let clip = Clip::new(&fake.scene, &dir, 400);
        let camera = fake.scene.test_camera().unwrap();
        assert_eq!(clip.size_px(), (512, 384 + 24), "128x96 enlarged four times, and the caption");
        let picture = clip.picture(camera, 48).unwrap();
        assert_eq!(picture.dimensions(), clip.size_px());
        let ball = clip.marks().iter().find(|mark| mark.id == Dataset::BALL).unwrap();
        assert_eq!(ball.number, 1);
        assert!(picture.pixels().any(|pixel| *pixel == ball.colour));
        let has_ink = |left: u32, right: u32| {
            (left..right).any(|x| (0..CAPTION_HEIGHT_PX).any(|y| *picture.get_pixel(x, y) == CAPTION_INK))
        };
        assert!(has_ink(0, 256) && !has_ink(400, 512));
        assert_eq!(caption(camera, 48), "cam02, frame 48, 2.00 s");
    }

    #[test]
    fn the_same_frame_gives_the_same_bytes() {
        let fake = Dataset::new();
        let dir = fake.dir();
        let camera = fake.scene.test_camera().unwrap();
        let bytes = |frame: u32| Clip::new(&fake.scene, &dir, 256).jpeg(camera, frame).unwrap();
        assert_eq!(bytes(48), bytes(48));
        assert_ne!(bytes(48), bytes(60));
        assert_eq!(bytes(48)[..3], [0xff, 0xd8, 0xff]);
    }

    #[test]
    fn what_was_not_rendered_is_an_error() {
        let fake = Dataset::new();
        let dir = fake.dir();
        let camera = fake.scene.test_camera().unwrap();
        let clip = Clip::new(&fake.scene, &dir, 256);
        assert_eq!(clip.jpeg(camera, 47).unwrap_err().code(), "L4D104");
        let path = dir.frame(&camera.name, 48);
        let mut frame = read_frame(&path, UVec2::new(128, 96)).unwrap();
        frame.rgb.fill([half::f16::ZERO; 3]);
        write_frame(&path, &frame).unwrap();
        let error = clip.jpeg(camera, 48).unwrap_err();
        assert!(error.to_string().contains("0048.exr: channels R, G, B: is black"), "{error}");
    }
}
