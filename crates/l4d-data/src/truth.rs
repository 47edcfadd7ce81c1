//! `benchmark/truth/<profile>/<scene>.json`: what the held-out view sees, and how much every view sees.
//!
//! Scoring needs only this file and the queries: no render.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::error::DataError;
use crate::json;
use crate::name::Name;
use crate::scene::{Role, Scale};
use crate::timeline::Profile;

/// Schema tag of a truth file.
pub const SCHEMA: &str = "l4d/truth/1";

/// One instance in the held-out view.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct InstanceTruth {
    /// Instance name.
    pub name: Name,
    /// Value of the `id` channel.
    pub id: u32,
    /// Object or landmark.
    pub role: Role,
    /// Common noun, so that look-alikes are known without the tracks.
    pub category: String,
    /// Four-digit frame -> compressed COCO counts (column-major); frames without a visible pixel are absent.
    pub masks: BTreeMap<String, String>,
}

/// A truth file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Truth {
    /// [`SCHEMA`].
    pub schema: String,
    /// Scene name.
    pub scene: Name,
    /// Spatial scale, so that scores by scale need no tracks.
    pub scale: Scale,
    /// Variant of the recipe.
    pub variant: u32,
    /// Profile that was rendered.
    pub profile: Profile,
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// The held-out view.
    pub test_view: Name,
    /// Canonical frames, ascending.
    pub frames: Vec<u32>,
    /// Instances sorted by id.
    pub instances: Vec<InstanceTruth>,
    /// View -> instance -> visible pixels at each of `frames`.
    pub visible: BTreeMap<Name, BTreeMap<Name, Vec<u32>>>,
}

impl Truth {
    /// Reads and checks a truth file. Masks stay encoded: decoding them is the business of `l4d-frames`.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        let truth: Self = json::read(path)?;
        match truth.problem() {
            None => Ok(truth),
            Some((location, message)) => Err(DataError::invalid(
                path,
                location,
                message,
                "restore the file from the release, or build the scene again",
            )),
        }
    }

    /// The instance of that name.
    pub fn instance(&self, name: &str) -> Option<&InstanceTruth> {
        self.instances.iter().find(|instance| instance.name.as_str() == name)
    }

    fn problem(&self) -> Option<(String, String)> {
        if self.schema != SCHEMA {
            return Some((
                "field `schema`".into(),
                format!("is `{}`, but this l4d reads `{SCHEMA}`", self.schema),
            ));
        }
        if (self.width, self.height) != (self.profile.width(), self.profile.height()) {
            let message =
                format!("{}x{} is not the size of profile {}", self.width, self.height, self.profile);
            return Some(("fields `width`, `height`".into(), message));
        }
        if !self.frames.iter().copied().eq(self.profile.frames()) {
            return Some((
                "field `frames`".into(),
                format!("are not the frames of profile {}", self.profile),
            ));
        }
        self.instances.iter().find_map(|instance| {
            let frame = instance
                .masks
                .keys()
                .find(|key| !self.frames.iter().any(|&frame| frame_key(frame) == **key))?;
            Some((
                format!("instance {}", instance.name),
                format!("has a mask at `{frame}`, which is no frame of the clip"),
            ))
        })
    }
}

/// The four-digit form of a frame number used as JSON key and file stem.
pub fn frame_key(frame: u32) -> String {
    format!("{frame:04}")
}
