//! The part of `perf/lift_field.py` that l4d does, on the first object of a rendered scene:
//!
//!     lift_scene data/small/room_office work/small/room_office/splats learn 2000
//!     lift_scene data/small/room_office work/small/room_office/splats export FOLDER 8
//!
//! `learn` learns the paper's field from eight training views and prints the seconds. `export` writes masks and blend
//! weights of some pictures. Uses the truth: it measures speed alone.

use std::error::Error;
use std::io::Write as _;
use std::path::Path;
use std::time::Instant;

use glam::UVec2;
use l4d_data::Scene;
use l4d_data::layout::SceneDir;
use l4d_frames::exr::read_surfaces;
use l4d_masks::Mask;
use l4d_solve::lift::{
    Evidence, EvidenceFrame, EvidenceView, FieldSettings, LiftSettings, RenderedModel, lift,
};
use l4d_splat::model::time_of_frame;
use l4d_splat::raster::{Cpu, RasterSettings, Reference};
use l4d_splat::source::{ReaderOptions, Source};
use l4d_splat::view::View;
use rayon::prelude::*;
use serde_json::json;

const VIEWS: usize = 8;

type Failure = Box<dyn Error + Send + Sync>;

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let [scene, splats, what @ ..] = &words[..] else { return Err("SCENE SPLATS come first".into()) };
    let evidence = evidence(Path::new(scene))?;
    let source = Source::open(Path::new(splats), ReaderOptions::default())?;
    let (cpu, raster) = (Cpu::new(), RasterSettings::default());
    let rendered = RenderedModel { model: &source.model, rasterizer: &cpu, raster: &raster, states: None };
    match what {
        ["learn", iterations] => {
            let settings = FieldSettings { iterations: iterations.parse()?, ..FieldSettings::paper() };
            let start = Instant::now();
            lift(&rendered, &evidence, &LiftSettings::Field(settings))?;
            let line = json!({ "seconds": start.elapsed().as_secs_f64() });
            Ok(writeln!(std::io::stdout(), "{line}")?)
        }
        ["export", folder, pictures] => export(&rendered, &evidence, pictures.parse()?, Path::new(folder)),
        _ => Err("then `learn ITERATIONS` or `export FOLDER PICTURES`".into()),
    }
}

/// What training views show of the first object.
fn evidence(folder: &Path) -> Result<Evidence, Failure> {
    let scene = Scene::read(&folder.join("scene.json"))?;
    let dir = SceneDir::new(folder.parent().ok_or("a scene folder has a parent")?, scene.name.as_str());
    let size = [scene.width, scene.height];
    let object = scene.instances.iter().find(|instance| instance.id < 1000).ok_or("no object")?.id;
    let frames: Vec<u32> = (0..97).step_by(scene.stride as usize).collect();
    let training: Vec<&l4d_data::Camera> =
        scene.cameras.iter().filter(|camera| camera.split == l4d_data::Split::Train).collect();
    let count = VIEWS.min(training.len());
    let see = |index: usize| -> Result<EvidenceView, Failure> {
        let camera = training[index * training.len() / count];
        let view = View::of_camera(camera, 0, size, size)?;
        let frame = |&frame: &u32| -> Result<EvidenceFrame, Failure> {
            let surfaces = read_surfaces(&dir.frame(camera.name.as_str(), frame), UVec2::from(size))?;
            let mask = Mask::from_ids(size[0], size[1], &surfaces.id, object)?;
            Ok(EvidenceFrame { frame, time: time_of_frame(frame), view, mask })
        };
        Ok(EvidenceView {
            name: camera.name.to_string(),
            frames: frames.par_iter().map(frame).collect::<Result<_, _>>()?,
        })
    };
    Ok(Evidence { views: (0..count).map(see).collect::<Result<_, _>>()? })
}

/// Canonical centres, and for some pictures the time, the view, the Gaussians as they are then (centres; scales,
/// rotation and opacity in rows of eight), the mask, and the blend weights as rows of a sparse matrix; little-endian
/// files beside an `index.json`.
fn export(
    rendered: &RenderedModel<'_>,
    evidence: &Evidence,
    count: usize,
    out: &Path,
) -> Result<(), Failure> {
    std::fs::create_dir_all(out)?;
    let floats = |name: String, numbers: &[f32]| {
        let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        std::fs::write(out.join(name), bytes)
    };
    let integers = |name: String, numbers: Vec<u32>| {
        let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        std::fs::write(out.join(name), bytes)
    };
    floats("means.f32".into(), rendered.model.gaussians.means.as_flattened())?;
    let (mut times, mut views) = (Vec::new(), Vec::new());
    for picture in 0..count {
        let frames = &evidence.views[picture % evidence.views.len()].frames;
        let EvidenceFrame { time, view, mask, .. } = &frames[picture * frames.len() / count];
        let splats = rendered.at(*time)?;
        let projected = Reference::scene(&splats.to_f64(), view, rendered.raster)?;
        let (width, height) = mask.size();
        let pixels: Vec<_> = (0..width * height)
            .into_par_iter()
            .map(|pixel| projected.contributors((pixel % width) as usize, (pixel / width) as usize))
            .collect();
        let mut starts = vec![0_u32];
        for shown in &pixels {
            starts.push(starts[starts.len() - 1] + shown.len() as u32);
        }
        let shown = || pixels.iter().flatten();
        integers(format!("{picture}.starts.u32"), starts)?;
        integers(format!("{picture}.gaussians.u32"), shown().map(|&(index, _)| index as u32).collect())?;
        floats(
            format!("{picture}.weights.f32"),
            &shown().map(|&(_, weight)| weight as f32).collect::<Vec<_>>(),
        )?;
        floats(format!("{picture}.means.f32"), splats.means().as_flattened())?;
        integers(format!("{picture}.mask.u32"), mask.to_bools().into_iter().map(u32::from).collect())?;
        let rows = (0..splats.len()).flat_map(|row| {
            let (scale, rotation) = (splats.scales()[row], splats.rotations()[row]);
            scale.into_iter().chain(rotation).chain([splats.opacities()[row]])
        });
        floats(format!("{picture}.shapes.f32"), &rows.collect::<Vec<f32>>())?;
        views.push(json!({
            "width": width, "height": height,
            "fx": view.focal()[0], "fy": view.focal()[1], "cx": view.principal()[0], "cy": view.principal()[1],
            "camera_from_world": view.camera_from_world(),
        }));
        times.push(time);
    }
    std::fs::write(out.join("index.json"), json!({ "times": times, "views": views }).to_string())?;
    Ok(())
}
