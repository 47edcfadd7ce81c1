//! What the cameras saw: pictures, depth and ids of a rendered scene, small.

use glam::UVec2;
use l4d_data::layout::SceneDir;
use l4d_data::{Camera, Progress, Role, Scene, StageError};
use l4d_frames::drawn::{Rgb, RgbImage, encode_colour};
use l4d_frames::exr::read_frame;
use l4d_frames::overlay::{encode_jpeg, object_colour};
use l4d_frames::preview::{shrunk, shrunk_size};
use l4d_frames::{Display, Frame, Surfaces};
use rayon::prelude::*;
use serde::Serialize;

/// Pictures of a page, at most; of more, every second, third, ... moment is kept.
pub const MOST_PICTURES: usize = 700;
/// Columns of a picture, about, at most.
pub const WIDEST_PX: u32 = 256;
/// Where nothing was hit, and where nothing is annotated.
const NOTHING: Rgb<u8> = Rgb([16, 16, 20]);
/// Greys of landmarks, which repeat.
const LANDMARK_GREYS: [u8; 4] = [96, 132, 72, 156];

/// Where the pictures of the cameras are.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Pictures {
    /// Pixels.
    pub(crate) width: u32,
    /// Pixels.
    pub(crate) height: u32,
    /// Moments, ascending.
    pub(crate) frames: Vec<u32>,
    /// Depths of both ends of the colours, metres.
    pub(crate) depth_range_m: [f32; 2],
    /// Whether light was rendered, or depth and ids alone.
    pub(crate) colour: bool,
    /// A camera each, in the order of the rig.
    pub(crate) cameras: Vec<Album>,
}

/// The pictures of a camera: lengths of the files in its block, in which pictures, depths and ids of a moment follow
/// each other.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub(crate) struct Album {
    /// Name of the camera; of its block `pictures-<name>`.
    pub(crate) name: String,
    /// Bytes of picture, depth and ids of each moment.
    pub(crate) lengths: Vec<[usize; 3]>,
}

type Packed = (Option<Pictures>, Vec<(String, Vec<u8>)>);

/// The pictures of all cameras, and a block of bytes for each.
pub(crate) fn of_scene(scene: &Scene, dir: &SceneDir, progress: &dyn Progress) -> Result<Packed, StageError> {
    let size = UVec2::new(scene.width, scene.height);
    let clip: Vec<u32> = scene.profile.frames().collect();
    let step = (clip.len() * scene.cameras.len()).div_ceil(MOST_PICTURES).max(1);
    let frames: Vec<u32> = clip.into_iter().step_by(step).collect();
    let Some(&first) = frames.first() else { return Ok((None, Vec::new())) };
    let read = |camera: &Camera, frame: u32| read_frame(&dir.frame(&camera.name, frame), size);
    let mut depth_range_m = [f32::INFINITY, 0.0_f32];
    let mut colour = false;
    for camera in &scene.cameras {
        let frame = read(camera, first)?;
        colour |= frame.rgb.iter().flatten().any(|light| light.to_f32() > 0.0);
        for depth_m in frame.surfaces.depth_m.iter().filter(|depth_m| depth_m.is_finite()) {
            depth_range_m = [depth_range_m[0].min(*depth_m), depth_range_m[1].max(*depth_m)];
        }
    }
    if depth_range_m[0] >= depth_range_m[1] {
        depth_range_m = [0.1, 100.0];
    }
    let painter = Painter { scene, display: Display::new(scene.exposure), depth_range_m };
    let jobs: Vec<(&Camera, u32)> =
        scene.cameras.iter().flat_map(|camera| frames.iter().map(move |&frame| (camera, frame))).collect();
    progress.start("pictures", jobs.len() as u64);
    let paint = |&(camera, frame): &(&Camera, u32)| {
        let files = painter.files(&read(camera, frame)?);
        progress.advance(1);
        Ok(files)
    };
    let files: Vec<[Vec<u8>; 3]> = jobs.par_iter().map(paint).collect::<Result<_, StageError>>()?;
    progress.finish();
    let albums = scene.cameras.iter().zip(files.chunks(frames.len()));
    let packed = albums.map(|(camera, files)| {
        let lengths = files.iter().map(|files| files.each_ref().map(Vec::len)).collect();
        (Album { name: camera.name.to_string(), lengths }, files.concat().concat())
    });
    let (cameras, blocks): (Vec<Album>, Vec<Vec<u8>>) = packed.unzip();
    let names = cameras.iter().map(|album| format!("pictures-{}", album.name));
    let blocks = names.zip(blocks).collect();
    let (width, height) = shrunk_size((scene.width, scene.height), WIDEST_PX);
    Ok((Some(Pictures { width, height, frames, depth_range_m, colour, cameras }), blocks))
}

/// The colour of an instance on the page, as on contact sheets: objects in turn, landmarks grey.
pub(crate) fn colour_of(objects_before: usize, landmarks_before: usize, role: Role) -> [u8; 3] {
    match role {
        Role::Object => object_colour(objects_before).0,
        Role::Landmark => [LANDMARK_GREYS[landmarks_before % LANDMARK_GREYS.len()]; 3],
    }
}

/// Colours of roles in their order.
pub(crate) fn colours(roles: impl Iterator<Item = Role>) -> Vec<[u8; 3]> {
    let mut before = [0, 0];
    let colour = |role: Role| {
        let colour = colour_of(before[0], before[1], role);
        before[usize::from(role == Role::Landmark)] += 1;
        colour
    };
    roles.map(colour).collect()
}

struct Painter<'a> {
    scene: &'a Scene,
    display: Display,
    depth_range_m: [f32; 2],
}

impl Painter<'_> {
    /// Picture and depth as JPEG, ids as PNG.
    fn files(&self, frame: &Frame) -> [Vec<u8>; 3] {
        let picture = shrunk(self.display.picture(frame), WIDEST_PX);
        let depth = self.sampled(&frame.surfaces, |index| self.depth_colour(frame.surfaces.depth_m[index]));
        let colours = colours(self.scene.instances.iter().map(|instance| instance.role));
        let id_colour = |index: usize| {
            let id = frame.surfaces.id[index];
            let place = self.scene.instances.iter().position(|instance| instance.id == id);
            place.map_or(NOTHING, |place| Rgb(colours[place]))
        };
        let ids = self.sampled(&frame.surfaces, id_colour);
        [encode_jpeg(&picture), encode_jpeg(&depth), encode_colour(&ids)]
    }

    /// A small picture of one pixel in each square: neither depth nor ids can be averaged.
    fn sampled(&self, surfaces: &Surfaces, colour: impl Fn(usize) -> Rgb<u8>) -> RgbImage {
        let size = (surfaces.width, surfaces.height);
        let (width, height) = shrunk_size(size, WIDEST_PX);
        let source = |at: u32, to: u32, from: u32| ((2 * at + 1) * from / (2 * to)).min(from - 1);
        RgbImage::from_fn(width, height, |col, row| {
            colour(surfaces.index(source(col, width, size.0), source(row, height, size.1)))
        })
    }

    fn depth_colour(&self, depth_m: f32) -> Rgb<u8> {
        if !depth_m.is_finite() {
            return NOTHING;
        }
        let [near, far] = self.depth_range_m.map(f32::ln);
        Rgb(ramp(((depth_m.ln() - near) / (far - near)).clamp(0.0, 1.0)))
    }
}

/// Colours of depth, near (0) to far (1), light to dark; `page/gaussians.js` has the same list.
const RAMP: [[f32; 3]; 5] =
    [[253.0, 231.0, 37.0], [94.0, 201.0, 98.0], [33.0, 145.0, 140.0], [59.0, 82.0, 139.0], [68.0, 1.0, 84.0]];

fn ramp(place: f32) -> [u8; 3] {
    let at = place * (RAMP.len() - 1) as f32;
    let left = (at as usize).min(RAMP.len() - 2);
    let share = at - left as f32;
    std::array::from_fn(|channel| {
        (RAMP[left][channel] + (RAMP[left + 1][channel] - RAMP[left][channel]) * share).round() as u8
    })
}
