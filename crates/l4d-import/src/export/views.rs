//! The pictures and cameras of a scene, with the held-out cameras behind a gate.
//!
//! Every layout gets what it shows here, whether the scene was rendered or recorded, so that none can show what the
//! request forbids. What is not known of a scene (depth, masks, points) is `None`, never made up.

mod captured;
mod rendered;

use std::path::{Path, PathBuf};

use l4d_data::scene::Instance;
use l4d_data::store::write_atomic;
use l4d_data::{Camera, DataError, Name, Profile, Split};
use l4d_frames::drawn::{DepthMap, Rgb, RgbImage, encode_colour};
use l4d_masks::Mask;
use rayon::prelude::*;

use super::cloud::{Cloud, Reconstruction};
use super::{ExportRequest, HeldOut, Origin};

use self::captured::Recording;
use self::rendered::Rendering;

/// What replaces a picture that must not be shown.
const PLACEHOLDER: Rgb<u8> = Rgb([128; 3]);

/// A scene and what may be seen of it.
pub(super) struct SceneViews {
    pub(super) name: Name,
    /// What the scene is rendered in, or that it is not.
    pub(super) profile: Profile,
    /// The file that describes the scene.
    pub(super) path: PathBuf,
    /// The file that holds what people drew, where that is what masks come from.
    pub(super) masks_path: Option<PathBuf>,
    /// Columns and rows, pixels.
    pub(super) size: [u32; 2],
    /// Instances that have masks, sorted by number.
    pub(super) instances: Vec<Instance>,
    /// Numbers of the moments that are exported, ascending.
    pub(super) frames: Vec<u32>,
    /// What has to be known of where the scene comes from, a sentence each.
    pub(super) notes: Vec<String>,
    cameras: Vec<Camera>,
    material: Material,
    shows: HeldOut,
    reconstruction: Option<Reconstruction>,
}

/// Where pictures come from.
enum Material {
    Rendered(Rendering),
    Captured(Box<Recording>),
}

/// One picture to be written.
pub(super) struct PictureFile<'a> {
    pub(super) camera: &'a Camera,
    pub(super) frame: u32,
    pub(super) path: PathBuf,
    /// Where its depth goes, for layouts that hold depth and scenes that have some.
    pub(super) depth: Option<PathBuf>,
}

impl SceneViews {
    pub(super) fn open(request: &ExportRequest<'_>) -> Result<Self, DataError> {
        let mut views = match request.origin {
            Origin::Rendered(dir) => Rendering::open(dir, request.held_out)?,
            Origin::Captured(dir) => Recording::open(dir, request.held_out)?,
        };
        // What was opened has all moments.
        if let Some(frame) = request.frames.iter().find(|frame| !views.frames.contains(frame)) {
            let message = match views.profile {
                Profile::Real => format!("frame {frame} was not recorded"),
                profile => format!("frame {frame} is not rendered in profile {profile}"),
            };
            let listed = views.frames.iter().take(3).map(u32::to_string).collect::<Vec<_>>().join(", ");
            let last = views.frames.last().copied().unwrap_or_default();
            return Err(views.wrong("frames", message, &format!("choose from {listed}, ..., {last}")));
        }
        if !request.frames.is_empty() {
            views.frames.retain(|frame| request.frames.contains(frame));
        }
        if let Material::Captured(recording) = &views.material {
            views.notes = recording.notes(&views.frames);
        }
        if views.training().is_empty() {
            let hint = "leave a view out of the held-out ones";
            return Err(views.wrong("field `cameras`", "there is none to train on".to_owned(), hint));
        }
        views.reconstruction = match (request.points_from, &views.material) {
            (Some(folder), _) => Some(Reconstruction::given(folder, &views.cameras, &views.frames)?),
            (None, Material::Captured(recording)) => recording.reconstruction()?,
            (None, Material::Rendered(_)) => None,
        };
        Ok(views)
    }

    /// Cameras that methods may train on.
    pub(super) fn training(&self) -> Vec<&Camera> {
        self.cameras.iter().filter(|camera| camera.split == Split::Train).collect()
    }

    /// The held-out cameras, unless not even their poses may be shown.
    pub(super) fn held_out(&self) -> Vec<&Camera> {
        let is_shown = |camera: &&Camera| camera.split == Split::Test && self.shows != HeldOut::Nothing;
        self.cameras.iter().filter(is_shown).collect()
    }

    /// Training cameras, then the held-out ones that [`Self::held_out`] gives.
    pub(super) fn shown(&self) -> Vec<&Camera> {
        self.training().into_iter().chain(self.held_out()).collect()
    }

    /// The cameras of a test split that may not be empty: the held-out ones, or else a training camera once more.
    pub(super) fn test_split(&self) -> Vec<&Camera> {
        match self.held_out() {
            held_out if held_out.is_empty() => self.training().into_iter().take(1).collect(),
            held_out => held_out,
        }
    }

    /// A camera of the scene, held out or not: for truth, which is a matter of the held-out one.
    pub(super) fn camera(&self, name: &Name) -> Option<&Camera> {
        self.cameras.iter().find(|camera| camera.name == *name)
    }

    /// Whether the true pictures of the held-out cameras may be shown.
    pub(super) fn shows_held_out_pictures(&self) -> bool {
        self.shows == HeldOut::Pictures
    }

    /// Whether a camera saw a moment: in captures not all of them do.
    pub(super) fn saw(&self, camera: &Camera, frame: u32) -> bool {
        match &self.material {
            Material::Rendered(_) => true,
            Material::Captured(recording) => recording.capture.saw(&camera.name, frame),
        }
    }

    /// Those of some cameras that saw a moment.
    pub(super) fn present<'a>(&self, cameras: &[&'a Camera], frame: u32) -> Vec<&'a Camera> {
        cameras.iter().copied().filter(|camera| self.saw(camera, frame)).collect()
    }

    /// Whether there is depth.
    pub(super) fn has_depth(&self) -> bool {
        matches!(self.material, Material::Rendered(_))
    }

    /// Whether someone looked at what a picture shows.
    pub(super) fn is_annotated(&self, camera: &Camera, frame: u32) -> bool {
        match &self.material {
            Material::Rendered(_) => true,
            Material::Captured(recording) => recording.is_annotated(camera, frame),
        }
    }

    /// What a picture shows of the instances, leaving out those that it does not show; none if no one looked.
    pub(super) fn masks(
        &self,
        camera: &Camera,
        frame: u32,
    ) -> Result<Option<Vec<(&Instance, Mask)>>, DataError> {
        self.admit(camera, frame)?;
        match &self.material {
            Material::Rendered(rendering) => rendering.masks(&self.instances, camera, frame).map(Some),
            Material::Captured(recording) => recording.masks(&self.instances, camera, frame),
        }
    }

    /// Points of surfaces at a moment, where anything is known of them.
    pub(super) fn cloud(&self, frame: u32) -> Result<Option<Cloud<'_>>, DataError> {
        let training = self.training();
        match (&self.reconstruction, &self.material) {
            (Some(points), _) => {
                Ok(Some(Cloud::Reconstruction(points, self.present(&training, frame), frame)))
            }
            (None, Material::Rendered(rendering)) => rendering.cloud(&training, frame).map(Some),
            (None, Material::Captured(_)) => Ok(None),
        }
    }

    /// Display colours of what a camera saw; grey for a held-out camera unless its pictures are allowed.
    pub(super) fn picture(&self, camera: &Camera, frame: u32) -> Result<RgbImage, DataError> {
        if self.admit(camera, frame).is_err() {
            return Ok(self.placeholder());
        }
        match &self.material {
            Material::Rendered(rendering) => rendering.picture(camera, frame),
            Material::Captured(recording) => recording.picture(camera, frame),
        }
    }

    /// Writes pictures as PNG, several at once.
    pub(super) fn write_png(
        &self,
        pictures: &[PictureFile<'_>],
        tick: &(dyn Fn() + Sync),
    ) -> Result<(), DataError> {
        pictures.par_iter().try_for_each(|picture| {
            self.write_picture(picture)?;
            tick();
            Ok(())
        })
    }

    fn write_picture(&self, picture: &PictureFile<'_>) -> Result<(), DataError> {
        let PictureFile { camera, frame, path, depth } = picture;
        let [width, height] = self.size;
        if self.admit(camera, *frame).is_err() {
            write_png(path, &self.placeholder())?;
            return match depth {
                Some(depth) => write_atomic(depth, &DepthMap::empty(width, height).png()),
                None => Ok(()),
            };
        }
        match &self.material {
            Material::Rendered(rendering) => {
                let seen = rendering.frame(camera, *frame)?;
                write_png(path, &rendering.shown(&seen))?;
                let Some(depth) = depth else { return Ok(()) };
                let depth_m = seen.surfaces.depth_m;
                write_atomic(depth, &DepthMap { depth_m, ..DepthMap::empty(width, height) }.png())
            }
            // It is a PNG of display colours already.
            Material::Captured(recording) => write_atomic(path, &recording.bytes(camera, *frame)?),
        }
    }

    /// A problem of the file that describes the scene.
    pub(super) fn wrong(&self, place: &str, message: String, hint: &str) -> DataError {
        DataError::invalid(&self.path, place, message, hint)
    }

    fn placeholder(&self) -> RgbImage {
        let [width, height] = self.size;
        RgbImage::from_pixel(width, height, PLACEHOLDER)
    }

    /// The gate: nothing that a held-out camera saw gets through unless its pictures are allowed.
    fn admit(&self, camera: &Camera, frame: u32) -> Result<(), DataError> {
        if camera.split == Split::Train || self.shows_held_out_pictures() {
            return Ok(());
        }
        let place = format!("{} at {frame}", camera.name);
        let message = "is of a held-out camera, which this export must not show".to_owned();
        Err(self.wrong(&place, message, "ask for the pictures with `--held-out pictures`"))
    }
}

/// Writes one picture as PNG.
pub(super) fn write_png(path: &Path, picture: &RgbImage) -> Result<(), DataError> {
    write_atomic(path, &encode_colour(picture))
}
