//! The JSON document of a page: everything but Gaussians and pictures, which are in blocks of bytes beside it.

use l4d_data::timeline::Timeline;
use l4d_data::tracks::{Track, TrackedInstance};
use l4d_data::{Event, Name, Profile, Role, Split};
use serde::Serialize;

use crate::Request;
use crate::gaussians::Layout;
use crate::pictures::{Pictures, colours};
use crate::sentences::Sentence;

/// Steps in a metre to which boxes are rounded: finer than a pixel of any picture.
const STEPS: f64 = 1e4;

/// What the page knows.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Document {
    pub(crate) scene: String,
    pub(crate) profile: Profile,
    /// The story; empty where nothing tells it.
    pub(crate) description: String,
    /// First and last frame.
    pub(crate) clip: [u32; 2],
    pub(crate) frames_per_second: f64,
    /// Frames that exist as pictures or masks, ascending: what single steps go through.
    pub(crate) frames: Vec<u32>,
    /// Width and height of the pictures that the cameras' numbers belong to.
    pub(crate) size: [u32; 2],
    pub(crate) cameras: Vec<View>,
    pub(crate) background: [f32; 3],
    pub(crate) near_m: f32,
    pub(crate) gaussians: Layout,
    pub(crate) pictures: Option<Pictures>,
    pub(crate) instances: Vec<Boxed>,
    pub(crate) events: Vec<Event>,
    /// Of which view the masks are, and their width and height.
    pub(crate) masks: Option<(Name, [u32; 2])>,
    /// The last of them is the one that answers questions, if the page asks any.
    pub(crate) methods: Vec<String>,
    /// Whether the server of the page answers questions.
    pub(crate) asks: bool,
    pub(crate) sentences: Vec<Sentence>,
}

/// A camera.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct View {
    pub(crate) name: Name,
    /// Whether methods never see it.
    pub(crate) held_out: bool,
    /// Focal lengths and principal point, pixels: fx, fy, cx, cy.
    pub(crate) lens: [f64; 4],
    /// Row-major 4x4 poses, world from camera; one, or one a frame.
    pub(crate) poses: Vec<[f64; 16]>,
}

/// An instance with its box over time.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Boxed {
    pub(crate) name: Name,
    pub(crate) category: String,
    pub(crate) landmark: bool,
    pub(crate) colour: [u8; 3],
    #[serde(flatten)]
    pub(crate) track: Track,
}

impl Document {
    pub(crate) fn new(
        request: &Request<'_>,
        gaussians: Layout,
        pictures: Option<Pictures>,
        sentences: Vec<Sentence>,
    ) -> Self {
        let timeline: Timeline = request.rig.timeline();
        let whole = timeline.whole();
        let tracked = request.tracks.map_or(&[][..], |tracks| &tracks.instances);
        let palette = colours(tracked.iter().map(|instance| instance.role));
        Self {
            scene: request.scene.to_string(),
            profile: request.profile,
            description: request.tracks.map(|tracks| tracks.description.clone()).unwrap_or_default(),
            clip: [whole.first(), whole.last()],
            frames_per_second: timeline.frames_per_second(),
            frames: request.rig.clip(request.profile),
            size: request.rig.size(),
            cameras: views(request),
            background: request.background,
            near_m: request.near_m,
            gaussians,
            pictures,
            instances: tracked.iter().zip(palette).map(|(one, colour)| boxed(one, colour)).collect(),
            events: request.tracks.map(|tracks| tracks.events.clone()).unwrap_or_default(),
            masks: request.truth.map(|truth| (truth.test_view.clone(), [truth.width, truth.height])),
            methods: request.methods.iter().map(|(name, _)| name).chain(&request.asks).cloned().collect(),
            asks: request.asks.is_some(),
            sentences,
        }
    }

    /// Pictures of all cameras.
    pub(crate) fn picture_count(&self) -> usize {
        self.pictures.iter().flat_map(|pictures| &pictures.cameras).map(|album| album.lengths.len()).sum()
    }
}

fn views(request: &Request<'_>) -> Vec<View> {
    let view = |camera: &l4d_data::Camera| View {
        name: camera.name.clone(),
        held_out: camera.split == Split::Test,
        lens: [camera.fx, camera.fy, camera.cx, camera.cy],
        poses: camera.world_from_camera.clone(),
    };
    request.rig.cameras.iter().map(view).collect()
}

fn boxed(instance: &TrackedInstance, colour: [u8; 3]) -> Boxed {
    let round = |number: f64| (number * STEPS).round() / STEPS;
    let Track { centre, axes, extents } = &instance.track;
    Boxed {
        name: instance.name.clone(),
        category: instance.category.clone(),
        landmark: instance.role == Role::Landmark,
        colour,
        track: Track {
            centre: centre.iter().map(|row| row.map(round)).collect(),
            axes: axes.iter().map(|row| row.map(round)).collect(),
            extents: extents.iter().map(|row| row.map(round)).collect(),
        },
    }
}
