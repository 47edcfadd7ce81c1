//! `benchmark/scenes/<scene>.json`: where everything is at each of the 97 canonical frames.
//!
//! Queries are proved from this file alone; it knows nothing of pictures.

use std::collections::BTreeMap;
use std::path::Path;

use glam::{DMat3, DMat4};
use serde::{Deserialize, Serialize};

use crate::camera::{Camera, Split, is_rotation, rendered_problem};
use crate::error::{DataError, is_line};
use crate::json::{self, Document};
use crate::name::Name;
use crate::scene::{self, Event, Generator, Instance, LONGEST_WORD, Role, Scale, Scene, instance_problem};
use crate::timeline::{FPS, FRAME_COUNT, Interval, LAST_FRAME, MIN_INTERVAL, Profile, is_per_clip};

/// Schema tag of a tracks file.
pub const SCHEMA: &str = "l4d/tracks/1";

/// Bytes of the story.
const LONGEST_STORY: usize = 4000;
/// Lengths that a scene can have.
const LENGTHS_M: std::ops::RangeInclusive<f64> = 0.0..=1e4;

/// Oriented box over time; every list has length 1 (static) or 97.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Track {
    /// Centres, metres, world.
    pub centre: Vec<[f64; 3]>,
    /// Row-major 3x3 `world_from_box` rotations.
    pub axes: Vec<[f64; 9]>,
    /// Full side lengths along the box axes, metres.
    pub extents: Vec<[f64; 3]>,
}

/// An instance with its track.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrackedInstance {
    /// Value of the `id` channel.
    pub id: u32,
    /// Unique in the scene.
    pub name: Name,
    /// Object or landmark.
    pub role: Role,
    pub category: String,
    /// Visible properties.
    pub attributes: BTreeMap<String, String>,
    /// Box axis that points forward, or null.
    pub front: Option<String>,
    /// Where it is.
    pub track: Track,
}

impl TrackedInstance {
    /// The description without the track.
    pub fn instance(&self) -> Instance {
        Instance {
            id: self.id,
            name: self.name.clone(),
            role: self.role,
            category: self.category.clone(),
            attributes: self.attributes.clone(),
            front: self.front.clone(),
        }
    }
}

/// Exact distance between the surfaces of two instances over time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pair {
    pub a: Name,
    pub b: Name,
    /// Mesh distances, metres, 1 or 97; 0 where they touch or overlap.
    pub distance_m: Vec<f64>,
    /// Canonical frames in contact.
    pub contact: Vec<Interval>,
}

/// A view, independent of the picture size.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrackedCamera {
    pub name: Name,
    /// Training or held out.
    pub split: Split,
    /// Profiles that render it.
    pub profiles: Vec<Profile>,
    /// Focal length divided by the picture width; pixels are square, the principal point is the centre.
    pub focal_over_width: f64,
    /// Row-major 4x4 poses, OpenCV axes, metres: 1 or 97.
    pub world_from_camera: Vec<[f64; 16]>,
}

impl TrackedCamera {
    /// The camera for pictures of `[width, height]`.
    pub fn camera(&self, size: [u32; 2]) -> Camera {
        let focal_px = self.focal_over_width * f64::from(size[0]);
        Camera {
            split: self.split,
            world_from_camera: self.world_from_camera.clone(),
            ..Camera::new(self.name.clone(), size, focal_px, DMat4::IDENTITY)
        }
    }
}

/// A tracks file.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tracks {
    /// [`SCHEMA`].
    pub schema: String,
    pub scene: Name,
    pub scale: Scale,
    /// 0 is the benchmark.
    pub variant: u32,
    /// Seed of the recipe.
    pub seed: u64,
    /// Frames per second.
    pub fps: f64,
    /// Always 97.
    pub frame_count: u32,
    /// Display exposure.
    pub exposure: f64,
    /// The story, one paragraph.
    pub description: String,
    /// Instances sorted by id.
    pub instances: Vec<TrackedInstance>,
    /// Events, sorted.
    pub events: Vec<Event>,
    /// Pairs with an object that are not listed never come closer than this, metres.
    pub pair_reach_m: f64,
    /// Pairs that come within reach of each other, or interact.
    pub pairs: Vec<Pair>,
    /// Views sorted by name.
    pub cameras: Vec<TrackedCamera>,
}

impl Tracks {
    /// Reads and checks a tracks file.
    ///
    /// # Errors
    /// A file that is missing or damaged, or contradicts itself.
    pub fn read(path: &Path) -> Result<Self, DataError> {
        json::read_document(path)
    }

    /// The instance of that name.
    pub fn instance(&self, name: &str) -> Option<&TrackedInstance> {
        self.instances.iter().find(|instance| instance.name.as_str() == name)
    }

    /// What a profile renders of it: `scene.json` before there are pictures.
    pub fn scene(&self, profile: Profile, generator: Generator) -> Scene {
        let size = [profile.width(), profile.height()];
        Scene {
            schema: scene::SCHEMA.to_owned(),
            name: self.scene.clone(),
            scale: self.scale,
            variant: self.variant,
            seed: self.seed,
            profile,
            stride: profile.stride(),
            width: size[0],
            height: size[1],
            exposure: self.exposure,
            generator,
            cameras: self.views(profile).map(|camera| camera.camera(size)).collect(),
            instances: self.instances.iter().map(TrackedInstance::instance).collect(),
            events: self.events.clone(),
            digests: BTreeMap::new(),
        }
    }

    /// Names of the views that a profile renders.
    pub fn views(&self, profile: Profile) -> impl Iterator<Item = &TrackedCamera> {
        self.cameras.iter().filter(move |camera| camera.profiles.contains(&profile))
    }

    fn unknown<'a>(&self, names: impl IntoIterator<Item = &'a Name>) -> Option<String> {
        let name = names.into_iter().find(|name| self.instance(name).is_none())?;
        Some(format!("names `{name}`, which is no instance of the scene"))
    }

    fn event_problem(&self, event: &Event) -> Option<(String, String)> {
        if !is_line(&event.verb, LONGEST_WORD) {
            let message = format!("the verb is one line of 1 to {LONGEST_WORD} bytes");
            return Some((format!("event of {}", event.subject), message));
        }
        let place = format!("event {} {}", event.subject, event.verb);
        if let Some(message) = self.unknown(std::iter::once(&event.subject).chain(&event.object)) {
            return Some((place, message));
        }
        if event.frames.last() > LAST_FRAME || event.frames.frame_count() < MIN_INTERVAL {
            let message = format!(
                "[{}, {}] must lie in 0..={LAST_FRAME} and be at least {MIN_INTERVAL} frames long",
                event.frames.first(),
                event.frames.last()
            );
            return Some((place, message));
        }
        None
    }

    fn pair_problem(&self, pair: &Pair) -> Option<(String, String)> {
        let place = format!("pair {}, {}", pair.a, pair.b);
        if let Some(message) = self.unknown([&pair.a, &pair.b]) {
            return Some((place, message));
        }
        if !is_per_clip(&pair.distance_m) || !pair.distance_m.iter().all(|d| LENGTHS_M.contains(d)) {
            return Some((place, "distance_m holds 1 or 97 distances, 0 to 10000 m".into()));
        }
        if pair.contact.iter().any(|interval| interval.last() > LAST_FRAME) {
            return Some((place, format!("contact lies in 0..={LAST_FRAME}")));
        }
        None
    }
}

impl Document for Tracks {
    const SCHEMA: &'static str = SCHEMA;
    const HINT: &'static str = "mend the recipe and run `l4d build-scenes --tracks-only` again";

    fn schema(&self) -> &str {
        &self.schema
    }

    fn problem(&self) -> Option<(String, String)> {
        if self.frame_count != FRAME_COUNT {
            let message = format!("is {}, but a clip has {FRAME_COUNT}", self.frame_count);
            return Some(("field `frame_count`".into(), message));
        }
        if self.fps != FPS {
            return Some(("field `fps`".into(), format!("is {}, but scenes have {FPS}", self.fps)));
        }
        if !(self.exposure.is_finite() && self.exposure > 0.0) {
            return Some(("field `exposure`".into(), "is positive".into()));
        }
        if !LENGTHS_M.contains(&self.pair_reach_m) {
            return Some(("field `pair_reach_m`".into(), "is a distance, 0 to 10000 m".into()));
        }
        if !self.description.is_empty() && !is_line(&self.description, LONGEST_STORY) {
            return Some((
                "field `description`".into(),
                format!("is one line of at most {LONGEST_STORY} bytes"),
            ));
        }
        let instances: Vec<Instance> = self.instances.iter().map(TrackedInstance::instance).collect();
        let cameras: Vec<Camera> = self.cameras.iter().map(|camera| camera.camera([1, 1])).collect();
        instance_problem(&instances)
            .or_else(|| rendered_problem(&cameras))
            .or_else(|| self.instances.iter().find_map(track_problem))
            .or_else(|| self.events.iter().find_map(|event| self.event_problem(event)))
            .or_else(|| self.pairs.iter().find_map(|pair| self.pair_problem(pair)))
    }
}

fn track_problem(instance: &TrackedInstance) -> Option<(String, String)> {
    let Track { centre, axes, extents } = &instance.track;
    let is_turned = |axes| is_rotation(&DMat3::from_cols_array(axes));
    let wrong = if !(is_per_clip(centre) && is_per_clip(axes) && is_per_clip(extents)) {
        "each list has 1 or 97 entries"
    } else if !centre.as_flattened().iter().all(|place| LENGTHS_M.contains(&place.abs())) {
        "each `centre` lies within 10000 m"
    } else if !extents.as_flattened().iter().all(|side| LENGTHS_M.contains(side)) {
        "`extents` are 0 to 10000 m"
    } else if !axes.iter().all(is_turned) {
        "each of `axes` is a rotation"
    } else {
        return None;
    };
    Some((format!("instance {}, field `track`", instance.name), wrong.to_owned()))
}

/// The value of a 1-or-97 list at a canonical frame.
pub fn at_frame<T>(values: &[T], frame: u32) -> &T {
    &values[if values.len() == 1 { 0 } else { frame as usize }]
}
