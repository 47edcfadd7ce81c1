//! Where the pictures of a scene come from: EXR files of a renderer, with depth and ids, or PNG files of a capture, which
//! has neither.

use glam::UVec2;
use half::f16;
use l4d_data::digest::sha256_hex;
use l4d_data::layout::{CaptureDir, SceneDir};
use l4d_data::results::Track;
use l4d_data::scene::{OBJECT_IDS, Scene};
use l4d_data::store::read_bounded;
use l4d_data::workspace::how_scenes_are_made;
use l4d_data::{Camera, DataError, Rig, Split, StageError, Timeline};
use l4d_frames::drawn::RgbImage;
use l4d_frames::exr::{decode_colour, decode_seen, read_bytes};
use l4d_frames::{Display, Frame, photo};

use super::{Result, TrainingRequest};
use crate::checkpoint::own::Sampling;
use crate::train::Picture;

/// No picture file is larger, bytes.
const MAX_BYTES: u64 = 256 << 20;

/// A scene, seen by several cameras over a clip.
pub(super) struct PictureSource {
    source: Source,
    pub(super) cameras: Vec<Camera>,
    /// Width and height that the numbers of the cameras belong to, pixels.
    pub(super) camera_size: [u32; 2],
    /// Width and height of the pictures as they are trained on.
    pub(super) size: [u32; 2],
    pub(super) frames: Vec<u32>,
    pub(super) timeline: Timeline,
    /// Which pictures of a capture are loaded.
    pub(super) sampling: Option<Sampling>,
    /// Whether depth of the training views is learned from.
    pub(super) sees_depth: bool,
}

enum Source {
    Rendered { dir: SceneDir, display: Display },
    Recorded { dir: CaptureDir, rig: Rig },
}

/// What a camera saw at a moment.
pub(super) struct LoadedPicture {
    pub(super) picture: Picture,
    /// Pixels that show objects; none where there are no ids.
    pub(super) objects: Vec<bool>,
    /// Path within the folder of the scene.
    pub(super) file: String,
    pub(super) sha256: String,
}

impl PictureSource {
    pub(super) fn open(request: &TrainingRequest<'_>) -> Result<Self> {
        let TrainingRequest { dir, profile, .. } = request;
        let path = dir.rig(*profile);
        if !path.exists() {
            return Err(StageError::new(
                format!("{}: there is no scene", dir.root().display()),
                format!(
                    "{}, or choose another --data",
                    how_scenes_are_made(request.scene, request.profile, dir.root())
                ),
            ));
        }
        if request.profile.is_rendered() { Self::of_rendered(request) } else { Self::of_capture(request) }
    }

    fn of_rendered(request: &TrainingRequest<'_>) -> Result<Self> {
        let dir = request.dir;
        let path = dir.scene();
        let scene = Scene::read(&path)?;
        if scene.profile != request.profile {
            return Err(StageError::new(
                format!(
                    "{}: field `profile` is {}, but {} was asked for",
                    path.display(),
                    scene.profile,
                    request.profile
                ),
                format!("say --profile {}, or choose another --data", scene.profile),
            ));
        }
        if (request.sampling.shrink, request.sampling.every) != (1, 1) {
            return Err(StageError::new(
                "--shrink and --every are for captures",
                "choose a smaller --profile of a rendered scene",
            ));
        }
        let size = [scene.width, scene.height];
        Ok(Self {
            source: Source::Rendered { dir: dir.clone(), display: Display::new(scene.exposure) },
            cameras: scene.cameras,
            camera_size: size,
            size,
            frames: request.profile.frames().collect(),
            timeline: Timeline::CANONICAL,
            sampling: None,
            sees_depth: request.sees_depth,
        })
    }

    fn of_capture(request: &TrainingRequest<'_>) -> Result<Self> {
        let TrainingRequest { dir, profile, .. } = request;
        let path = dir.rig(*profile);
        if request.sees_depth {
            return Err(StageError::new(
                format!("--depth: {} has no depth", path.display()),
                "leave it out: depth is found by comparing pictures",
            ));
        }
        let rig = Rig::read(&path)?;
        let sampling = request.sampling;
        let (size, camera_size) = sampling.sizes(rig.size());
        if size.contains(&0) {
            return Err(StageError::new(
                format!(
                    "--shrink {} leaves nothing of {}x{} pixels",
                    request.sampling.shrink, rig.width, rig.height
                ),
                "choose a smaller factor",
            ));
        }
        Ok(Self {
            cameras: rig.cameras.clone(),
            camera_size,
            size,
            frames: sampling.moments(&rig.clip(request.profile)),
            timeline: rig.timeline(),
            sampling: Some(sampling),
            sees_depth: false,
            source: Source::Recorded {
                dir: CaptureDir::new(dir.root().parent().unwrap_or(dir.root()), request.scene),
                rig,
            },
        })
    }

    /// With whom methods are ranked that look at a model of these pictures.
    pub(super) fn track(&self) -> Track {
        Track::of_depth(self.sees_depth)
    }

    /// Pictures that can be loaded.
    pub(super) fn picture_count(&self) -> u64 {
        (self.cameras.len() * self.frames.len()) as u64
    }

    /// Those that methods may train on.
    pub(super) fn training(&self) -> impl Iterator<Item = &Camera> {
        self.cameras.iter().filter(|camera| camera.split == Split::Train)
    }

    /// The one that is held out, if there is one with pictures: those of a private test are not handed out.
    pub(super) fn held_out(&self) -> Option<&Camera> {
        let saw_something = |camera: &&Camera| match &self.source {
            Source::Rendered { .. } => true,
            Source::Recorded { rig, .. } => self.frames.iter().any(|frame| rig.saw(&camera.name, *frame)),
        };
        self.cameras.iter().filter(|camera| camera.split == Split::Test).find(saw_something)
    }

    /// What a camera saw; none where it did not look. Depth and ids of a rendered picture are not looked at unless asked for.
    pub(super) fn load(
        &self,
        camera: &Camera,
        frame: u32,
        with_surfaces: bool,
    ) -> Result<Option<LoadedPicture>> {
        match &self.source {
            Source::Rendered { dir, display } => {
                self.load_rendered(dir, display, camera, frame, with_surfaces).map(Some)
            }
            Source::Recorded { rig, .. } if !rig.saw(&camera.name, frame) => Ok(None),
            Source::Recorded { dir, rig } => self.load_capture(dir, rig, camera, frame).map(Some),
        }
    }

    fn load_rendered(
        &self,
        dir: &SceneDir,
        display: &Display,
        camera: &Camera,
        frame: u32,
        with_surfaces: bool,
    ) -> Result<LoadedPicture> {
        let path = dir.frame(&camera.name, frame);
        let size = UVec2::from_array(self.size);
        let bytes = read_bytes(&path, size).map_err(DataError::from)?;
        let (rgb, surfaces) = if with_surfaces {
            let Frame { rgb, surfaces } = decode_seen(&path, &bytes, size).map_err(DataError::from)?;
            (rgb, Some(surfaces))
        } else {
            (decode_colour(&path, &bytes, size).map_err(DataError::from)?, None)
        };
        let depths = surfaces.iter().flat_map(|surfaces| &surfaces.depth_m);
        let ids = surfaces.iter().flat_map(|surfaces| &surfaces.id);
        Ok(LoadedPicture {
            picture: Picture {
                colour: rgb.iter().map(|pixel| pixel.map(|linear| display.byte(linear))).collect(),
                depth_m: depths.map(|&depth_m| f16::from_f32(depth_m)).collect(),
            },
            objects: ids.map(|id| OBJECT_IDS.contains(id)).collect(),
            file: path.strip_prefix(dir.root()).unwrap_or(&path).display().to_string(),
            sha256: sha256_hex(&bytes),
        })
    }

    fn load_capture(
        &self,
        dir: &CaptureDir,
        rig: &Rig,
        camera: &Camera,
        frame: u32,
    ) -> Result<LoadedPicture> {
        let path = dir.picture(&camera.name, frame);
        let bytes = read_bounded(&path, MAX_BYTES)?;
        let wrong = |message: String| {
            let hint = "import the scene again with `l4d import-scene`";
            DataError::invalid(&path, "picture", message, hint)
        };
        let picture = photo::decode(&bytes).map_err(|error| wrong(error.to_string()))?;
        let (width, height) = picture.dimensions();
        if [width, height] != rig.size() {
            let message = format!("is {width}x{height}, but the capture is {}x{}", rig.width, rig.height);
            return Err(wrong(message).into());
        }
        let shrink = self.sampling.unwrap_or(Sampling::WHOLE).shrink;
        Ok(LoadedPicture {
            picture: Picture { colour: shrunk(&picture, shrink, self.size), depth_m: Vec::new() },
            objects: Vec::new(),
            file: path.strip_prefix(dir.root()).unwrap_or(&path).display().to_string(),
            sha256: sha256_hex(&bytes),
        })
    }
}

/// Means of squares, row-major.
fn shrunk(picture: &RgbImage, factor: u32, [width, height]: [u32; 2]) -> Vec<[u8; 3]> {
    let count = factor * factor;
    let mean = |column: u32, row: u32| {
        let mut sum = [count / 2; 3];
        for at in 0..count {
            let pixel = picture.get_pixel(column * factor + at % factor, row * factor + at / factor);
            for (sum, byte) in sum.iter_mut().zip(pixel.0) {
                *sum += u32::from(byte);
            }
        }
        sum.map(|sum| (sum / count) as u8)
    };
    (0..height)
        .flat_map(|row| (0..width).map(move |column| (column, row)))
        .map(|(column, row)| mean(column, row))
        .collect()
}

#[cfg(test)]
mod tests {
    use l4d_frames::drawn::Rgb;

    use super::*;

    #[test]
    fn squares_become_their_means_and_the_rest_is_left_out() {
        let picture = RgbImage::from_fn(5, 3, |column, row| Rgb([(10 * column + row) as u8, 7, 0]));
        assert_eq!(shrunk(&picture, 2, [2, 1]), [[6, 7, 0], [26, 7, 0]]);
        assert_eq!(shrunk(&picture, 1, [5, 3])[6], [11, 7, 0]);
    }
}
