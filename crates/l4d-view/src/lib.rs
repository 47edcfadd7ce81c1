//! A scene over time as one self-contained page: its Gaussians, what its cameras saw, boxes, events, and sentences
//! with their masks.
//!
//! Owns what such a page holds and how it is packed: [`page`] turns a [`Request`] into the bytes of an HTML file that
//! needs no network and no server. The page itself (`page/`) draws; it computes nothing but pictures and the overlap of
//! two masks. Refuses to know where files are, how a model was trained, how a method is scored, and what a sentence
//! means.

mod document;
mod gaussians;
mod pictures;
mod sentences;

use l4d_data::html;
use l4d_data::layout::{ResultsDir, SceneDir};
use l4d_data::truth::Truth;
use l4d_data::{Name, Profile, Progress, Query, Rig, Scene, StageError, tracks::Tracks};
use l4d_splat::Model;

pub use gaussians::{MOST_BYTES, MOST_TIMES};
pub use pictures::{MOST_PICTURES, WIDEST_PX};

use document::Document;

/// Methods whose masks one page shows.
pub const MOST_METHODS: usize = 3;
/// No page is larger, bytes.
pub const LARGEST_PAGE: usize = 60_000_000;

/// What a page shows. Only the name, the cameras and the model are needed.
#[derive(Debug)]
pub struct Request<'a> {
    /// Name of the scene.
    pub scene: &'a Name,
    /// Profile of the pictures and masks.
    pub profile: Profile,
    /// Cameras, the size of their pictures, and when those were taken.
    pub rig: &'a Rig,
    /// The Gaussians; their times are those of the clip.
    pub model: &'a Model,
    /// What shows where no Gaussian is, display colour.
    pub background: [f32; 3],
    /// Gaussians that are nearer are not drawn, units of the world.
    pub near_m: f32,
    /// Boxes, tracks, events and the story.
    pub tracks: Option<&'a Tracks>,
    /// Rendered frames: pictures, depth and ids of each camera.
    pub rendered: Option<(&'a Scene, &'a SceneDir)>,
    /// Masks of the held-out view.
    pub truth: Option<&'a Truth>,
    pub queries: &'a [Query],
    /// Methods by name, at most [`MOST_METHODS`], whose masks are shown beside the truth.
    pub methods: &'a [(String, ResultsDir)],
    /// Who answers what the page asks its server (`l4d-serve`), one more method; none for a page without a server.
    pub asks: Option<String>,
}

/// A page and what it holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// The HTML file.
    pub html: Vec<u8>,
    /// Gaussians.
    pub gaussians: usize,
    /// Moments at which those that move were sampled.
    pub times: usize,
    /// Pictures of cameras, each with its depth and ids.
    pub pictures: usize,
    pub sentences: usize,
}

/// The page of a scene.
///
/// # Errors
/// More methods than a page shows, a model that has no state at a time, frames or masks that cannot be read or have
/// another size, and a page above [`LARGEST_PAGE`].
pub fn page(request: &Request<'_>, progress: &dyn Progress) -> Result<Written, StageError> {
    let methods = request.methods.len() + usize::from(request.asks.is_some());
    if methods > MOST_METHODS {
        let message = format!("{methods} methods, but a page shows {MOST_METHODS}");
        return Err(StageError::new(message, format!("choose {MOST_METHODS} of them")));
    }
    let (gaussians, values) = gaussians::sampled(request.model, request.rig.timeline())?;
    let (pictures, blocks) = match request.rendered {
        Some((scene, dir)) => pictures::of_scene(scene, dir, progress)?,
        None => (None, Vec::new()),
    };
    let sentences = sentences::of(request)?;
    let document = Document::new(request, gaussians, pictures, sentences);
    let mut texts = vec![("gaussians".to_owned(), values)];
    texts.extend(blocks);
    let title = request.scene.as_str();
    let file = html::Page { template: TEMPLATE, title, style: STYLE, scripts: &SCRIPTS };
    let html = file.bytes(&document, &texts)?;
    if html.len() > LARGEST_PAGE {
        let message = format!("a page of {} bytes, where {LARGEST_PAGE} is the most", html.len());
        return Err(StageError::new(message, "leave out methods, or show a scene of a smaller profile"));
    }
    Ok(Written {
        gaussians: request.model.gaussians.len(),
        times: document.gaussians.times.len(),
        pictures: document.picture_count(),
        sentences: document.sentences.len(),
        html,
    })
}

const TEMPLATE: &str = include_str!("../page/index.html");
const STYLE: &str = include_str!("../page/style.css");
/// In the order in which they build on each other.
const SCRIPTS: [&str; 8] = [
    include_str!("../page/space.js"),
    include_str!("../page/unpack.js"),
    include_str!("../page/gaussians.js"),
    include_str!("../page/drawing.js"),
    include_str!("../page/software.js"),
    include_str!("../page/overlay.js"),
    include_str!("../page/page.js"),
    include_str!("../page/asking.js"),
];

#[cfg(test)]
mod tests;
