//! Times the CPU rasterizer on a scene from a file: `raster_speed SCENE.json THREADS REPEAT PICTURE.f32`.
//!
//! The format of the scene is in `perf/splats_forward.py`, which calls this. Prints one JSON object with
//! the best times of `REPEAT` pictures, and writes the picture as rows of red, green, blue, alpha, summed depth.

use std::error::Error;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use l4d_splat::raster::{Cpu, DrawingGradient, RasterError, RasterSettings, Rasterizer};
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
    let features = vec![1.0; splats.len()];
    let projected = cpu.prepare(splats, view, &bare)?;
    let full = cpu.prepare(splats, view, &RasterSettings::default())?;
    let drawing = projected.draw()?;
    let best = |work: &dyn Fn() -> Result<(), RasterError>| -> Result<f64, RasterError> {
        (0..repeat).try_fold(f64::INFINITY, |best, _| {
            let start = Instant::now();
            work()?;
            Ok(best.min(start.elapsed().as_secs_f64() * 1e3))
        })
    };
    let times = json!({
        "rasterizer": cpu.name(),
        "gaussians": splats.len(),
        "size": [view.width(), view.height()],
        "threads": rayon::current_num_threads(),
        "forward_ms": best(&|| cpu.prepare(splats, view, &bare)?.draw().map(drop))?,
        "prepare_ms": best(&|| cpu.prepare(splats, view, &bare).map(drop))?,
        "draw_ms": best(&|| projected.draw().map(drop))?,
        "draw_with_quantiles_ms": best(&|| full.draw().map(drop))?,
        "backward_ms": best(&|| projected.backward(&drawing, &gradient).map(drop))?,
        "gather_ms": best(&|| projected.gather_features(&mask, 1).map(drop))?,
        "spread_ms": best(&|| projected.splat_features(&features, 1).map(drop))?,
    });
    let rows = drawing.colour.iter().zip(&drawing.alpha).zip(&drawing.depth_sum_m);
    let bytes: Vec<u8> = rows
        .flat_map(|((&[red, green, blue], &alpha), &depth)| [red, green, blue, alpha, depth])
        .flat_map(f32::to_le_bytes)
        .collect();
    std::fs::write(picture, bytes)?;
    Ok(times)
}
