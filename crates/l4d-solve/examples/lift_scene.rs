//! Lifts every object of a rendered scene from the ids of some of its training views, and scores the held-out view.
//!
//!     cargo run --release -p l4d-solve --example lift_scene -- data/small/room_office work/small/room_office/splats \
//!         --method robust --views 8 --objects 4
//!
//! Prints one JSON line an object and method. A method is `vote`, `sirt`, `robust`, `field`, `distil` or `ceiling` (labels
//! fitted to the held-out view itself), with changed settings behind it: `field:iterations=500:read_out=hard3d`; several
//! stand between commas. `--gate 48` empties all masks after that frame. Uses the truth throughout: it measures
//! lifting alone.
//!
//! With `--render` the answers of all objects are drawn beside the colours of the held-out view, 0 to 100 at once.
//! With `--export FOLDER --pictures 8` nothing is lifted: the first object's masks and the blend weights of some pictures
//! are written for `benchmark/perf/lift_field.py`.

use std::collections::BTreeMap;
use std::error::Error;
use std::io::Write as _;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};
use std::time::Instant;

use glam::UVec2;
use l4d_data::layout::SceneDir;
use l4d_data::{Scene, Split};
use l4d_frames::Surfaces;
use l4d_frames::exr::read_surfaces;
use l4d_masks::Mask;
use l4d_solve::lift::{
    Canvas, ClosedSettings, DistilSettings, Evidence, EvidenceFrame, EvidenceView, FieldSettings,
    LiftSettings, lift, masks,
};
use l4d_splat::model::time_of_frame;
use l4d_splat::raster::{Cpu, RasterSettings};
use l4d_splat::source::Source;
use l4d_splat::view::View;
use rayon::prelude::*;
use serde_json::json;

type Failure = Box<dyn Error + Send + Sync>;

fn main() -> Result<(), Failure> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let option = |name: &str| {
        let place = arguments.iter().position(|argument| argument == name)?;
        arguments.get(place + 1).cloned()
    };
    let number = |name: &str, otherwise: usize| -> Result<usize, Failure> {
        Ok(option(name).map(|text| text.parse()).transpose()?.unwrap_or(otherwise))
    };
    let folder = PathBuf::from(arguments.first().ok_or("a scene folder comes first")?);
    let splats = PathBuf::from(arguments.get(1).ok_or("a splats folder comes second")?);
    let footage = Footage::read(&folder, number("--views", 8)?, number("--every", 1)?)?;
    let source = Source::open(&splats)?;
    let (cpu, raster) = (Cpu::new(), RasterSettings::default());
    let canvas = Canvas { model: &source.model, rasterizer: &cpu, raster: &raster, states: None };
    let methods: Vec<(String, LiftSettings)> =
        option("--method").unwrap_or("robust".into()).split(',').map(method).collect::<Result<_, _>>()?;
    let mut objects = footage.objects.clone();
    objects.truncate(number("--objects", usize::MAX)?);
    if arguments.iter().any(|argument| argument == "--render") {
        return render(&canvas, &footage, &objects, &methods);
    }
    if let (Some(out), Some((id, _))) = (option("--export"), objects.first()) {
        return export(&canvas, &footage, *id, number("--pictures", 8)?, Path::new(&out));
    }
    let gate = option("--gate").map(|text| text.parse::<u32>()).transpose()?;
    let mut out = std::io::stdout().lock();
    for (id, name) in &objects {
        let held_out: BTreeMap<u32, Mask> =
            footage.held_out.masks(*id).into_iter().map(|(frame, mask)| gated(frame, mask, gate)).collect();
        let present: Vec<&Mask> = held_out.values().filter(|mask| !mask.is_empty()).collect();
        let area = present.iter().map(|mask| mask.area()).sum::<u64>() / present.len().max(1) as u64;
        for (method, settings) in &methods {
            let views = if method.starts_with("ceiling") {
                vec![footage.held_out.evidence(*id, gate)]
            } else {
                footage.views.iter().map(|view| view.evidence(*id, gate)).collect()
            };
            let start = Instant::now();
            let lifted = lift(&canvas, &Evidence { views }, settings, &mut |_| ControlFlow::Continue(()))?;
            let seconds = start.elapsed().as_secs_f64();
            let masks: Vec<(u32, Mask)> = held_out
                .par_iter()
                .map(|(&frame, _)| {
                    let view = &footage.held_out.view;
                    Ok((frame, lifted.mask(&canvas, view, time_of_frame(frame))?))
                })
                .collect::<Result<_, Failure>>()?;
            let (mut overlap, mut false_pixels) = (Vec::new(), 0);
            for (frame, mask) in &masks {
                let truth = &held_out[frame];
                if truth.is_empty() {
                    false_pixels += mask.area();
                } else {
                    overlap.push(mask.and_count(truth) as f64 / mask.or_count(truth) as f64);
                }
            }
            let mean = overlap.iter().sum::<f64>() / overlap.len().max(1) as f64;
            let line = json!({
                "object": name, "area_px": area, "method": method, "seconds": seconds, "miou": 100.0 * mean,
                "frames": overlap.len(), "false_px": false_pixels, "about": lifted.describe(),
            });
            writeln!(out, "{line}")?;
            out.flush()?;
        }
    }
    Ok(())
}

/// Milliseconds of a colour picture of the held-out view: alone, and with the masks of 1, 10 and 100 answers beside it.
fn render(
    canvas: &Canvas<'_>,
    footage: &Footage,
    objects: &[(u32, String)],
    methods: &[(String, LiftSettings)],
) -> Result<(), Failure> {
    let (name, settings) = methods.first().ok_or("a method comes first")?;
    let view = &footage.held_out.view;
    let mut answers = Vec::new();
    for (id, _) in objects {
        let views = footage.views.iter().map(|view| view.evidence(*id, None)).collect();
        answers.push(lift(canvas, &Evidence { views }, settings, &mut |_| ControlFlow::Continue(()))?);
    }
    let mut moments = Vec::new();
    for (frame, _) in footage.held_out.frames.iter().step_by(footage.held_out.frames.len().div_ceil(8)) {
        let time = time_of_frame(*frame);
        let layers: Vec<_> =
            answers.iter().map(|answer| answer.layer_at(canvas.model, time)).collect::<Result<_, _>>()?;
        moments.push((canvas.at(time)?, layers));
    }
    for count in [0, 1, 10, 100] {
        let mut best = f64::INFINITY;
        for _ in 0..5 {
            let start = Instant::now();
            for (splats, layers) in &moments {
                let shown: Vec<_> = layers.iter().cycle().take(count).collect();
                let projected = canvas.rasterizer.prepare(splats, view, canvas.raster)?;
                projected.draw()?;
                masks(projected.as_ref(), view, &shown)?;
            }
            best = best.min(start.elapsed().as_secs_f64() / moments.len() as f64);
        }
        let line = json!({ "method": name, "answers": count, "picture_ms": 1e3 * best });
        writeln!(std::io::stdout(), "{line}")?;
    }
    Ok(())
}

fn gated(frame: u32, mask: Mask, gate: Option<u32>) -> (u32, Mask) {
    let is_off = gate.is_some_and(|last| frame > last);
    (frame, if is_off { Mask::empty(mask.width(), mask.height()) } else { mask })
}

fn method(name: &str) -> Result<(String, LiftSettings), Failure> {
    let closed = match name.split(':').next().unwrap_or_default() {
        "vote" => ClosedSettings::vote(),
        "sirt" => ClosedSettings::sirt(),
        "robust" => ClosedSettings::robust(),
        "ceiling" => {
            ClosedSettings { steps: 5, step_times: u32::MAX, smoothness: 0.0, ..ClosedSettings::robust() }
        }
        "field" => return Ok((name.to_owned(), LiftSettings::Field(changed(FieldSettings::paper(), name)?))),
        "distil" => {
            let usual = DistilSettings::usual();
            let settings = DistilSettings { field: changed(usual.field, name)?, ..usual };
            return Ok((name.to_owned(), LiftSettings::Distil(settings)));
        }
        _ => return Err(format!("no method `{name}`").into()),
    };
    Ok((name.to_owned(), LiftSettings::Closed(changed(closed, name)?)))
}

/// Settings with `field=value` of a method's name changed.
fn changed<S: serde::Serialize + serde::de::DeserializeOwned>(settings: S, name: &str) -> Result<S, Failure> {
    let mut values = serde_json::to_value(settings)?;
    for change in name.split(':').skip(1) {
        let (field, value) = change.split_once('=').ok_or("changes are field=value")?;
        values[field] = serde_json::from_str(value).unwrap_or(value.into());
    }
    Ok(serde_json::from_value(values)?)
}

/// Canonical centres, and for some pictures the time, the view, the Gaussians as they are then (centres; scales,
/// rotation and opacity in rows of eight), the mask, and the blend weights as rows of a sparse matrix; little-endian
/// files beside an `index.json`.
fn export(canvas: &Canvas<'_>, footage: &Footage, id: u32, count: usize, out: &Path) -> Result<(), Failure> {
    std::fs::create_dir_all(out)?;
    let floats = |name: String, numbers: &[f32]| {
        let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        std::fs::write(out.join(name), bytes)
    };
    let integers = |name: String, numbers: &[u32]| {
        let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
        std::fs::write(out.join(name), bytes)
    };
    floats("means.f32".into(), canvas.model.gaussians.means.as_flattened())?;
    let (mut times, mut views) = (Vec::new(), Vec::new());
    for picture in 0..count {
        let seen = &footage.views[picture % footage.views.len()];
        let masks = seen.masks(id);
        let (frame, mask) = &masks[picture * masks.len() / count];
        let splats = canvas.at(time_of_frame(*frame))?;
        let projected = canvas.rasterizer.prepare(&splats, &seen.view, canvas.raster)?;
        let (width, height) = mask.size();
        let pixels: Vec<_> = (0..width * height)
            .into_par_iter()
            .map(|pixel| projected.contributors(pixel % width, pixel / width))
            .collect::<Result<_, _>>()?;
        let mut starts = vec![0_u32];
        for shown in &pixels {
            starts.push(starts[starts.len() - 1] + shown.len() as u32);
        }
        integers(format!("{picture}.starts.u32"), &starts)?;
        integers(
            format!("{picture}.gaussians.u32"),
            &pixels.iter().flatten().map(|c| c.index).collect::<Vec<_>>(),
        )?;
        floats(
            format!("{picture}.weights.f32"),
            &pixels.iter().flatten().map(|c| c.weight).collect::<Vec<_>>(),
        )?;
        floats(format!("{picture}.means.f32"), splats.means().as_flattened())?;
        integers(
            format!("{picture}.mask.u32"),
            &mask.to_bools().into_iter().map(u32::from).collect::<Vec<_>>(),
        )?;
        let rows = (0..splats.len()).flat_map(|row| {
            let (scale, rotation) = (splats.scales()[row], splats.rotations()[row]);
            scale.into_iter().chain(rotation).chain([splats.opacities()[row]])
        });
        floats(format!("{picture}.shapes.f32"), &rows.collect::<Vec<f32>>())?;
        let view = &seen.view;
        views.push(json!({
            "width": width, "height": height,
            "fx": view.focal()[0], "fy": view.focal()[1], "cx": view.principal()[0], "cy": view.principal()[1],
            "camera_from_world": view.camera_from_world(),
        }));
        times.push(time_of_frame(*frame));
    }
    std::fs::write(out.join("index.json"), json!({ "times": times, "views": views }).to_string())?;
    Ok(())
}

struct Footage {
    views: Vec<Seen>,
    held_out: Seen,
    objects: Vec<(u32, String)>,
}

struct Seen {
    name: String,
    view: View,
    frames: Vec<(u32, Surfaces)>,
}

impl Footage {
    fn read(folder: &Path, count: usize, every: usize) -> Result<Self, Failure> {
        let scene = Scene::read(&folder.join("scene.json"))?;
        let dir = SceneDir::new(folder.parent().ok_or("a scene folder has a parent")?, scene.name.as_str());
        let size = [scene.width, scene.height];
        let frames: Vec<u32> = (0..97).step_by(scene.stride as usize * every).collect();
        let see = |camera: &l4d_data::Camera| -> Result<Seen, Failure> {
            let frames = frames
                .par_iter()
                .map(|&frame| {
                    let path = dir.frame(camera.name.as_str(), frame);
                    Ok((frame, read_surfaces(&path, UVec2::from(size))?))
                })
                .collect::<Result<_, Failure>>()?;
            Ok(Seen { name: camera.name.to_string(), view: View::of_camera(camera, 0, size, size)?, frames })
        };
        let training: Vec<&l4d_data::Camera> =
            scene.cameras.iter().filter(|camera| camera.split == Split::Train).collect();
        let count = count.min(training.len());
        let chosen = (0..count).map(|index| training[index * training.len() / count]);
        let views = chosen.map(see).collect::<Result<_, _>>()?;
        let held_out = see(scene.test_camera().ok_or("the scene has no held-out camera")?)?;
        let objects =
            scene.instances.iter().filter(|i| i.id < 1000).map(|i| (i.id, i.name.to_string())).collect();
        Ok(Self { views, held_out, objects })
    }
}

impl Seen {
    fn masks(&self, id: u32) -> Vec<(u32, Mask)> {
        let (width, height) = (self.view.width(), self.view.height());
        let mask = |surfaces: &Surfaces| Mask::from_ids(width, height, &surfaces.id, id);
        self.frames.iter().filter_map(|(frame, surfaces)| Some((*frame, mask(surfaces).ok()?))).collect()
    }

    fn evidence(&self, id: u32, gate: Option<u32>) -> EvidenceView {
        let frames = self.masks(id).into_iter().map(|(frame, mask)| {
            let (frame, mask) = gated(frame, mask, gate);
            EvidenceFrame { frame, time: time_of_frame(frame), view: self.view, mask }
        });
        EvidenceView { name: self.name.clone(), frames: frames.collect() }
    }
}
