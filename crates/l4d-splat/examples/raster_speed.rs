//! Times the CPU rasterizer on a scene from a file: `raster_speed SCENE.json THREADS REPEAT PICTURE.f32`.
//!
//! The format of the scene stands in `benchmark/perf/splats_forward.py`, which calls this. Prints one JSON object with
//! the best times of `REPEAT` pictures, and writes the picture as rows of red, green, blue, alpha, summed depth.

use std::error::Error;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use l4d_splat::raster::{Cpu, DrawingGradient, RasterSettings, Rasterizer};
use l4d_splat::splats::{SplatParts, Splats};
use l4d_splat::view::View;
use serde::Deserialize;
use serde_json::json;

/// The constant spherical harmonic.
const C0: f32 = 0.282_094_8;
/// Numbers of one Gaussian in the file.
const ROW: usize = 14;

#[derive(Deserialize)]
struct Scene {
    width: u32,
    height: u32,
    fx: f64,
    fy: f64,
    cx: f64,
    cy: f64,
    camera_from_world: [[f64; 4]; 3],
    gaussians: PathBuf,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args_os().skip(1).map(PathBuf::from);
    let mut next = || arguments.next().ok_or("raster_speed SCENE.json THREADS REPEAT PICTURE.f32");
    let (scene, threads, repeat, picture) = (next()?, next()?, next()?, next()?);
    let count = |text: &Path| text.to_string_lossy().parse::<usize>();
    rayon::ThreadPoolBuilder::new().num_threads(count(&threads)?).build_global()?;
    let told: Scene = serde_json::from_slice(&std::fs::read(&scene)?)?;
    let folder = scene.parent().unwrap_or(Path::new("."));
    let splats = splats(&std::fs::read(folder.join(&told.gaussians))?)?;
    let size = [told.width, told.height];
    let view = View::new(size, [told.fx, told.fy], [told.cx, told.cy], told.camera_from_world)?;
    let measured = measure(&splats, &view, count(&repeat)?, &picture)?;
    writeln!(std::io::stdout(), "{measured}")?;
    Ok(())
}

fn splats(bytes: &[u8]) -> Result<Splats, Box<dyn Error>> {
    let numbers: Vec<f32> = bytes.as_chunks().0.iter().copied().map(f32::from_le_bytes).collect();
    let mut parts = SplatParts::default();
    for &[x, y, z, a, b, c, q0, q1, q2, q3, opacity, red, green, blue] in numbers.as_chunks::<ROW>().0 {
        parts.means.push([x, y, z]);
        parts.scales.push([a, b, c]);
        parts.rotations.push([q0, q1, q2, q3]);
        parts.opacities.push(opacity);
        parts.sh.push([red, green, blue].map(|value| (value - 0.5) / C0));
    }
    Ok(Splats::new(parts)?)
}

fn measure(
    splats: &Splats,
    view: &View,
    repeat: usize,
    picture: &Path,
) -> Result<serde_json::Value, Box<dyn Error>> {
    let cpu = Cpu::new();
    let bare = RasterSettings { quantiles: false, ..RasterSettings::default() };
    let mut gradient = DrawingGradient::zeros(view);
    for (pixel, slope) in gradient.colour.iter_mut().enumerate() {
        *slope = [(pixel as f32).sin(), (pixel as f32).cos(), 0.3];
    }
    let mask: Vec<f32> = (0..view.pixel_count()).map(|pixel| f32::from(u8::from(pixel % 3 == 0))).collect();
    let mut best = [f64::INFINITY; 7];
    for _ in 0..repeat {
        let times = {
            let start = Instant::now();
            let projected = cpu.prepare(splats, view, &bare)?;
            let prepared = milliseconds(start);
            let drawing = projected.draw()?;
            let forward = milliseconds(start);
            let start = Instant::now();
            projected.backward(&drawing, &gradient)?;
            let backward = milliseconds(start);
            let start = Instant::now();
            projected.gather_features(&mask, 1)?;
            let gather = milliseconds(start);
            let start = Instant::now();
            let features = vec![1.0; splats.len()];
            projected.splat_features(&features, 1)?;
            let spread = milliseconds(start);
            let full = cpu.prepare(splats, view, &RasterSettings::default())?;
            let start = Instant::now();
            full.draw()?;
            [forward, prepared, forward - prepared, backward, gather, spread, milliseconds(start)]
        };
        for (best, time) in best.iter_mut().zip(times) {
            *best = best.min(time);
        }
    }
    let drawing = cpu.prepare(splats, view, &bare)?.draw()?;
    let rows = drawing.colour.iter().zip(&drawing.alpha).zip(&drawing.depth_sum_m);
    let bytes: Vec<u8> = rows
        .flat_map(|((&[red, green, blue], &alpha), &depth)| [red, green, blue, alpha, depth])
        .flat_map(f32::to_le_bytes)
        .collect();
    std::fs::write(picture, bytes)?;
    let [forward, prepare, draw, backward, gather, spread, draw_with_quantiles] = best;
    Ok(json!({
        "rasterizer": cpu.name(),
        "gaussians": splats.len(),
        "size": [view.width(), view.height()],
        "threads": rayon::current_num_threads(),
        "forward_ms": forward,
        "prepare_ms": prepare,
        "draw_ms": draw,
        "draw_with_quantiles_ms": draw_with_quantiles,
        "backward_ms": backward,
        "gather_ms": gather,
        "spread_ms": spread,
    }))
}

fn milliseconds(since: Instant) -> f64 {
    since.elapsed().as_secs_f64() * 1e3
}
