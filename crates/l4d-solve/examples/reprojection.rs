//! How well each way of carrying a mask into another view does, on rendered scenes:
//! `cargo run --release -p l4d-solve --example reprojection -- DATA SCENE...`, where DATA holds rendered scenes
//! (`data/small`) and SCENE is a name, or NAME=CLIPS with a folder of drawn clips (EXR depth) of that scene.
//!
//! The mask of an object in view i, carried to j, is compared with the pixels of j that show a point of the object
//! which i sees, by rendered depth and ids. The depth that carries is the rendered one, or that of the clips.

use std::collections::BTreeMap;
use std::error::Error;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use glam::{DVec2, DVec3, UVec2};
use half::f16;
use l4d_data::scene::{OBJECT_IDS, Scene};
use l4d_data::{Camera, Split, Timeline, layout::SceneDir, store::read_bounded};
use l4d_frames::drawn::{DepthMap, RgbImage};
use l4d_frames::exr::{decode_depth, read_surfaces};
use l4d_frames::{Mask, Surfaces};
use l4d_ground::{ClipFrame, ViewClip};
use l4d_solve::consensus::reproject::reproject;
use l4d_solve::consensus::settings::{Method, ReprojectionSettings};
use l4d_solve::consensus::{ConsensusSettings, Sight};

const VIEWS: usize = 8;
const FRAMES: usize = 4;
/// Smaller masks, and exact ones, are left out, pixels.
const SMALLEST: u64 = 4;
/// Upper bounds of the classes of size, pixels of the exact mask.
const CLASSES: [u64; 3] = [100, 1000, u64::MAX];
/// From this share of its points on a mask counts as seen (the paper's 60 %).
const SEEN: f64 = 0.6;
/// Depths that a render may get wrong at a silhouette, as a share.
const SAME_SURFACE: f64 = 2e-3;
const MOST_BYTES: u64 = 1 << 26;

struct View {
    clip: ViewClip,
    surfaces: BTreeMap<u32, Surfaces>,
}

#[derive(Default)]
struct Score {
    iou: [f64; 3],
    masks: [u32; 3],
    right: u32,
    asked: u32,
    time: Duration,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let data = PathBuf::from(args.next().ok_or("say where the rendered scenes are, and which")?);
    let variants = variants();
    let mut scores: Vec<Score> = variants.iter().map(|_| Score::default()).collect();
    for scene in args {
        let (name, clips) = match scene.split_once('=') {
            Some((name, clips)) => (name, Some(Path::new(clips))),
            None => (scene.as_str(), None),
        };
        let views = read_views(&data, name, clips)?;
        measure(&views, &variants, &mut scores);
    }
    let mut out = std::io::stdout().lock();
    writeln!(
        out,
        "| method, tolerance | IoU < 100 px | < 1000 px | larger | visibility right | us a mask |"
    )?;
    writeln!(out, "|---|---|---|---|---|---|")?;
    for (score, (name, _)) in scores.iter().zip(&variants) {
        let [small, middle, large] =
            [0, 1, 2].map(|class| score.iou[class] / f64::from(score.masks[class].max(1)));
        writeln!(
            out,
            "| {name} | {small:.3} | {middle:.3} | {large:.3} | {:.4} | {:.0} |",
            f64::from(score.right) / f64::from(score.asked.max(1)),
            score.time.as_secs_f64() * 1e6 / f64::from(score.asked.max(1)),
        )?;
    }
    if let Some(score) = scores.first() {
        writeln!(out, "masks by size {:?}, {} asked for visibility", score.masks, score.asked)?;
    }
    Ok(())
}

fn variants() -> Vec<(String, ReprojectionSettings)> {
    let robust = ConsensusSettings::robust().reprojection;
    let mut variants = Vec::new();
    for method in [Method::Footprint, Method::InverseWarp] {
        for tolerance in [0.005, 0.01, 0.02, 0.05, 0.1] {
            for with_spread in [false, true] {
                let name = format!("{method:?}, {tolerance}{}", if with_spread { " + spread" } else { "" });
                variants.push((name, ReprojectionSettings { method, tolerance, with_spread, ..robust }));
            }
        }
    }
    variants
}

fn read_views(data: &Path, name: &str, clips: Option<&Path>) -> Result<Vec<View>, Box<dyn Error>> {
    let dir = SceneDir::new(data, name);
    let scene = Scene::read(&dir.scene())?;
    let all: Vec<u32> = scene.profile.frames().collect();
    let frames: Vec<u32> =
        (0..FRAMES).filter_map(|at| all.get(at * (all.len() - 1) / (FRAMES - 1)).copied()).collect();
    let is_there = |camera: &&Camera| clips.is_none_or(|clips| clips.join(camera.name.as_str()).is_dir());
    let cameras = scene.cameras.iter().filter(|camera| camera.split == Split::Train).filter(is_there);
    cameras.take(VIEWS).map(|camera| read_view(&dir, &scene, camera, &frames, clips)).collect()
}

fn read_view(
    dir: &SceneDir,
    scene: &Scene,
    camera: &Camera,
    frames: &[u32],
    clips: Option<&Path>,
) -> Result<View, Box<dyn Error>> {
    let (width, height) = (scene.width, scene.height);
    let size = UVec2::new(width, height);
    let mut surfaces = BTreeMap::new();
    let mut seen = Vec::new();
    for &frame in frames {
        let shown = read_surfaces(&dir.frame(camera.name.as_str(), frame), size)?;
        let depth = match clips {
            None => depth_of(&shown),
            Some(clips) => {
                let path = clips.join(camera.name.as_str()).join(format!("{frame:04}.exr"));
                decode_depth(&path, &read_bounded(&path, MOST_BYTES)?, size)?
            }
        };
        seen.push(ClipFrame { frame, colour: RgbImage::new(width, height), depth });
        surfaces.insert(frame, shown);
    }
    Ok(View {
        clip: ViewClip { camera: camera.clone(), width, height, timeline: Timeline::CANONICAL, frames: seen },
        surfaces,
    })
}

/// A render as a model that is sure of itself.
fn depth_of(surfaces: &Surfaces) -> DepthMap {
    let half: Vec<f16> = surfaces.depth_m.iter().map(|&depth_m| f16::from_f32(depth_m)).collect();
    let alpha =
        surfaces.depth_m.iter().map(|depth_m| f16::from_f32(f32::from(depth_m.is_finite()))).collect();
    DepthMap {
        width: surfaces.width,
        height: surfaces.height,
        depth_m: surfaces.depth_m.clone(),
        alpha,
        near_m: half.clone(),
        far_m: half,
    }
}

fn measure(views: &[View], variants: &[(String, ReprojectionSettings)], scores: &mut [Score]) {
    for (from, to) in views.iter().flat_map(|from| views.iter().map(move |to| (from, to))) {
        if from.clip.camera.name == to.clip.camera.name {
            continue;
        }
        for (&frame, surfaces) in &from.surfaces {
            let Some(there) = to.surfaces.get(&frame) else { continue };
            for (id, _) in surfaces.visible().into_iter().filter(|(id, _)| OBJECT_IDS.contains(id)) {
                let mask = mask_of(surfaces, id);
                if mask.area() < SMALLEST {
                    continue;
                }
                let seen = points(&from.clip.camera, surfaces, frame, id);
                let in_sight = seen.iter().filter(|point| shows(&to.clip.camera, there, frame, **point, id));
                let truly = in_sight.count() as f64 / seen.len().max(1) as f64;
                let exact = exact(&to.clip.camera, there, (&from.clip.camera, surfaces), frame, id);
                for (score, (_, settings)) in scores.iter_mut().zip(variants) {
                    score.add((from, to, frame), settings, &mask, truly, &exact);
                }
            }
        }
    }
}

impl Score {
    fn add(
        &mut self,
        (from, to, frame): (&View, &View, u32),
        settings: &ReprojectionSettings,
        mask: &Mask,
        truly: f64,
        exact: &Mask,
    ) {
        let sight = |view| Sight::of_clip(view, frame, settings);
        let (Some(from), Some(to)) = (sight(&from.clip), sight(&to.clip)) else { return };
        let start = Instant::now();
        let carried = reproject(&from, mask, &to, settings);
        self.time += start.elapsed();
        let claimed = carried.passing as f64 / carried.projected.max(1) as f64;
        self.asked += 1;
        self.right += u32::from((truly >= SEEN) == (claimed >= SEEN));
        if exact.area() >= SMALLEST && truly >= SEEN {
            let class = CLASSES.iter().position(|&bound| exact.area() < bound).unwrap_or(2);
            self.masks[class] += 1;
            self.iou[class] +=
                exact.and_count(&carried.covered) as f64 / exact.or_count(&carried.covered) as f64;
        }
    }
}

fn mask_of(surfaces: &Surfaces, id: u32) -> Mask {
    Mask::from_fn(surfaces.width, surfaces.height, |column, row| {
        surfaces.id[surfaces.index(column, row)] == id
    })
}

/// World points of the pixels that show an object, metres.
fn points(camera: &Camera, surfaces: &Surfaces, frame: u32, id: u32) -> Vec<DVec3> {
    mask_of(surfaces, id).pixels().map(|(column, row)| point(camera, surfaces, frame, column, row)).collect()
}

fn point(camera: &Camera, surfaces: &Surfaces, frame: u32, column: u32, row: u32) -> DVec3 {
    let position = DVec2::new(f64::from(column) + 0.5, f64::from(row) + 0.5);
    camera.unproject(frame, position, f64::from(surfaces.depth_m[surfaces.index(column, row)]))
}

/// Whether a render shows a point of an object: its depth lies within those of the pixels around it that show the
/// object.
fn shows(camera: &Camera, surfaces: &Surfaces, frame: u32, point: DVec3, id: u32) -> bool {
    let (position, depth_m) = camera.project(frame, point);
    let inside = depth_m > 0.0
        && position.cmpge(DVec2::ZERO).all()
        && position.x < f64::from(surfaces.width)
        && position.y < f64::from(surfaces.height);
    if !inside {
        return false;
    }
    let corner = (position - 0.5).floor();
    let around = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|(right, down)| {
        let column = (corner.x + right).clamp(0.0, f64::from(surfaces.width - 1)) as u32;
        let row = (corner.y + down).clamp(0.0, f64::from(surfaces.height - 1)) as u32;
        surfaces.index(column, row)
    });
    let own = || {
        around
            .iter()
            .filter(|&&index| surfaces.id[index] == id)
            .map(|&index| f64::from(surfaces.depth_m[index]))
    };
    let (near, far) = (own().fold(f64::INFINITY, f64::min), own().fold(0.0, f64::max));
    // One pixel more than what the pixels span: between them and a silhouette the surface goes on.
    let slack = SAME_SURFACE * depth_m + (far - near).max(0.0) / 2.0;
    (near - slack..=far + slack).contains(&depth_m)
}

/// The pixels of a render that show a point of the object which the other one shows.
fn exact(
    camera: &Camera,
    surfaces: &Surfaces,
    (other, others): (&Camera, &Surfaces),
    frame: u32,
    id: u32,
) -> Mask {
    Mask::from_fn(surfaces.width, surfaces.height, |column, row| {
        surfaces.id[surfaces.index(column, row)] == id
            && shows(other, others, frame, point(camera, surfaces, frame, column, row), id)
    })
}
