//! `scene.json`: what was rendered, from where, and what the ids in the frames mean.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::camera::{Camera, Split, rendered_problem};
use crate::error::{DataError, is_line};
use crate::json::{self, Document};
use crate::name::Name;
use crate::timeline::{Interval, Profile};

/// Schema tag of `scene.json`.
pub const SCHEMA: &str = "l4d/scene/1";
/// Ids of objects, which queries may refer to.
pub const OBJECT_IDS: std::ops::RangeInclusive<u32> = 1..=999;
/// Ids of landmarks, which predicates may name but queries never refer to.
pub const LANDMARK_IDS: std::ops::RangeInclusive<u32> = 1001..=32767;

/// Bytes of a noun, a verb, a property.
pub(crate) const LONGEST_WORD: usize = 80;
/// Axes of a box.
const AXES: [&str; 6] = ["+x", "-x", "+y", "-y", "+z", "-z"];

/// Spatial scale of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Scale {
    /// Tens of metres.
    Outdoor,
    /// A few metres.
    Room,
    /// About a metre.
    Tabletop,
}

impl Scale {
    /// All scales in table order.
    pub const ALL: [Self; 3] = [Self::Outdoor, Self::Room, Self::Tabletop];

    /// Name as written in files.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Outdoor => "outdoor",
            Self::Room => "room",
            Self::Tabletop => "tabletop",
        }
    }
}

/// Whether an instance can be what a query refers to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Role {
    /// May be a referent.
    Object,
    /// Only named in relations.
    Landmark,
}

/// One annotated thing. The same id in every camera, frame and profile.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Instance {
    /// Value of the `id` channel.
    pub id: u32,
    /// Unique in the scene.
    pub name: Name,
    /// Object or landmark.
    pub role: Role,
    /// Common noun ("bucket").
    pub category: String,
    /// Visible properties, e.g. colour: red.
    pub attributes: BTreeMap<String, String>,
    /// Box axis that points forward (`-y`), or null where the thing has no front.
    pub front: Option<String>,
}

/// What an instance does, alone or to another, recorded by the code that animated it.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Event {
    pub subject: Name,
    /// Base form, e.g. `lift`.
    pub verb: String,
    /// To whom; null for actions.
    pub object: Option<Name>,
    /// When, canonical frames.
    pub frames: Interval,
}

/// What made a scene.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Generator {
    /// Version of bpy.
    pub bpy: String,
    /// SHA-256 over the names and digests of the scripts that built the scene.
    pub scripts_sha256: String,
}

/// Digests of one decoded frame: little-endian, row-major.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FrameDigest {
    /// SHA-256 of the f32 depths, metres, no hit = +inf.
    pub z: String,
    /// SHA-256 of the u32 instance ids.
    pub id: String,
}

/// `scene.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scene {
    /// [`SCHEMA`].
    pub schema: String,
    pub name: Name,
    pub scale: Scale,
    /// 0 is the benchmark; others permute looks, roles, layout and cameras.
    pub variant: u32,
    /// Seed of everything random in the recipe.
    pub seed: u64,
    /// How much was rendered.
    pub profile: Profile,
    /// Every how many canonical frames.
    pub stride: u32,
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Display colour = clamp(sRGB_OETF(exposure * linear)).
    pub exposure: f64,
    /// What made it.
    pub generator: Generator,
    /// All views, sorted by name.
    pub cameras: Vec<Camera>,
    /// All annotated things, sorted by id.
    pub instances: Vec<Instance>,
    /// Actions and interactions, sorted.
    pub events: Vec<Event>,
    /// View -> four-digit frame -> digests.
    pub digests: BTreeMap<Name, BTreeMap<String, FrameDigest>>,
}

impl Scene {
    /// Reads and checks a `scene.json`.
    ///
    /// # Errors
    /// A file that is missing or damaged, or contradicts itself.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        json::read_document(path)
    }

    /// The held-out view.
    pub fn test_camera(&self) -> Option<&Camera> {
        self.cameras.iter().find(|camera| camera.split == Split::Test)
    }

    /// The view of that name.
    pub fn camera(&self, name: &str) -> Option<&Camera> {
        self.cameras.iter().find(|camera| camera.name.as_str() == name)
    }

    /// The instance of that name.
    pub fn instance(&self, name: &str) -> Option<&Instance> {
        self.instances.iter().find(|instance| instance.name.as_str() == name)
    }
}

impl Document for Scene {
    const SCHEMA: &'static str = SCHEMA;
    const HINT: &'static str = "build the scene again with `l4d build-scenes --force`";

    fn schema(&self) -> &str {
        &self.schema
    }

    fn problem(&self) -> Option<(String, String)> {
        if !self.profile.is_rendered() {
            let message = "is `real`, but a scene.json describes what was rendered";
            return Some(("field `profile`".into(), message.to_owned()));
        }
        if (self.width, self.height) != (self.profile.width(), self.profile.height()) {
            let message =
                format!("{}x{} is not the size of profile {}", self.width, self.height, self.profile);
            return Some(("fields `width`, `height`".into(), message));
        }
        rendered_problem(&self.cameras).or_else(|| instance_problem(&self.instances))
    }
}

/// What is wrong with a list of instances, as (place, message).
pub(crate) fn instance_problem(instances: &[Instance]) -> Option<(String, String)> {
    let mut ids = BTreeMap::new();
    let mut names = BTreeMap::new();
    for instance in instances {
        let place = format!("instance {}", instance.name);
        let range = match instance.role {
            Role::Object => OBJECT_IDS,
            Role::Landmark => LANDMARK_IDS,
        };
        if !range.contains(&instance.id) {
            return Some((place, format!("id {} is outside {range:?}, the ids of its role", instance.id)));
        }
        if let Some(other) = ids.insert(instance.id, &instance.name) {
            return Some((place, format!("id {} is also that of {other}", instance.id)));
        }
        if names.insert(&instance.name, instance.id).is_some() {
            return Some((place, "the name is used twice".to_owned()));
        }
        let words = instance.attributes.iter().flat_map(|(key, value)| [key, value]);
        if !words.chain([&instance.category]).all(|word| is_line(word, LONGEST_WORD)) {
            let message = format!("category and attributes are one line of 1 to {LONGEST_WORD} bytes each");
            return Some((place, message));
        }
        if instance.front.as_ref().is_some_and(|front| !AXES.contains(&front.as_str())) {
            return Some((place, format!("field `front` is none of {}", AXES.join(", "))));
        }
    }
    None
}
