//! Which pixels of the training views show which instance: as they were rendered, or as people drew them.

mod drawn;

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use glam::UVec2;
use l4d_data::digest::sha256_file;
use l4d_data::layout::SceneDir;
use l4d_data::scene::{Instance, Scene};
use l4d_data::{DataError, Name, Profile, Split};
use l4d_frames::exr::read_surfaces;
use l4d_frames::truth::Observation;
use l4d_masks::Mask;
use serde_json::{Value, json};

use self::drawn::DrawnIds;

/// Which pixels show which instance.
pub trait IdSource: Send + Sync {
    /// What the ids depend on.
    fn identity(&self) -> Value;

    /// What ids mean.
    fn instances(&self) -> &[Instance];

    /// The pixels of a picture that show any of these instances.
    ///
    /// # Errors
    /// The view is held out or unknown, or the picture cannot be read.
    fn pixels_of(&self, view: &Name, frame: u32, ids: &[u32]) -> Result<Mask, DataError>;
}

/// The ids of a scene, rendered or a capture. Clips have `size` (width, height) pixels, and show `of` of the pictures'
/// ones, which are at least as many.
///
/// # Errors
/// A scene that is not there; a capture without masks on a training view.
pub fn open_ids(
    dir: SceneDir,
    profile: Profile,
    size: [u32; 2],
    of: [u32; 2],
) -> Result<Arc<dyn IdSource>, DataError> {
    Ok(match profile.is_rendered() {
        true => Arc::new(RenderedIds::open(dir)?),
        false => Arc::new(DrawnIds::open(dir, size, of)?),
    })
}

/// The id channel of the rendered training views of one scene. Pictures are read once and kept as run lengths.
#[derive(Debug)]
pub(super) struct RenderedIds {
    dir: SceneDir,
    scene: Scene,
    scene_sha256: String,
    seen: Mutex<BTreeMap<(Name, u32), Arc<Observation>>>,
}

impl RenderedIds {
    /// Opens a rendered scene.
    pub(super) fn open(dir: SceneDir) -> Result<Self, DataError> {
        let path = dir.scene();
        let scene = Scene::read(&path)?;
        let scene_sha256 = sha256_file(&path)?;
        Ok(Self { dir, scene, scene_sha256, seen: Mutex::default() })
    }

    fn observed(&self, view: &Name, frame: u32) -> Result<Arc<Observation>, DataError> {
        let key = (view.clone(), frame);
        if let Some(known) = self.lock().get(&key) {
            return Ok(Arc::clone(known));
        }
        // Not under the lock: views are asked side by side. A picture that is read twice gives the same.
        let size = UVec2::new(self.scene.width, self.scene.height);
        let surfaces = read_surfaces(&self.dir.frame(view, frame), size)?;
        let observation = Arc::new(Observation::of(&surfaces, true));
        self.lock().insert(key, Arc::clone(&observation));
        Ok(observation)
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, BTreeMap<(Name, u32), Arc<Observation>>> {
        self.seen.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl IdSource for RenderedIds {
    /// The digest of `scene.json`, which holds those of all id channels.
    fn identity(&self) -> Value {
        json!({ "scene_json_sha256": self.scene_sha256 })
    }

    fn instances(&self) -> &[Instance] {
        &self.scene.instances
    }

    fn pixels_of(&self, view: &Name, frame: u32, ids: &[u32]) -> Result<Mask, DataError> {
        let refuse = |message: String, hint: &str| {
            Err(DataError::invalid(&self.dir.scene(), "field `cameras`", message, hint))
        };
        match self.scene.camera(view).map(|camera| camera.split) {
            Some(Split::Train) => {}
            Some(Split::Test) => {
                let hint = "ask about training views: the held-out one is for the judge alone";
                return refuse(format!("holds view `{view}` out"), hint);
            }
            None => return refuse(format!("has no view `{view}`"), "ask about a view that was rendered"),
        }
        let observation = self.observed(view, frame)?;
        let (width, height) = (self.scene.width, self.scene.height);
        let mut pixels = Mask::empty(width, height);
        for (_, mask) in observation.masks.iter().filter(|(id, _)| ids.contains(id)) {
            pixels.union_with(&Mask::from_rle(mask, width, height));
        }
        Ok(pixels)
    }
}
