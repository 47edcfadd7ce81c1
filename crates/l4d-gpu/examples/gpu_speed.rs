//! How long an adapter takes for a picture and its gradient, and how long the processor takes, in one run:
//! `cargo run --release -p l4d-gpu --example gpu_speed -- [ADAPTER]`, where ADAPTER is what `--adapter` would take.
//!
//! Best of several, milliseconds. On a software adapter both sides are the same processor.

use std::error::Error;
use std::hint::black_box;
use std::io::Write as _;
use std::time::Instant;

use l4d_gpu::{AdapterChoice, Gpu};
use l4d_splat::raster::{Cpu, DrawingGradient, RasterError, RasterSettings, Rasterizer};
use l4d_splat::splats::{SplatError, SplatParts, Splats};
use l4d_splat::view::View;
use rand::{RngExt as _, SeedableRng as _};
use rand_chacha::ChaCha8Rng;

const REPEAT: usize = 8;
/// Gaussians, and the size of the picture.
const RUNS: [(usize, [u32; 2]); 4] =
    [(10_000, [256, 192]), (50_000, [256, 192]), (10_000, [640, 480]), (50_000, [640, 480])];

/// Milliseconds: projecting and drawing, its backward pass, one channel of pixels to Gaussians.
struct Times {
    forward: f64,
    backward: f64,
    gather: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let choice: AdapterChoice = std::env::args().nth(1).unwrap_or_default().parse()?;
    let (gpu, cpu) = (Gpu::open(&choice)?, Cpu::new());
    let mut out = std::io::stdout().lock();
    writeln!(out, "a: {}\nb: {}, {} threads\n", gpu.name(), cpu.name(), rayon::current_num_threads())?;
    writeln!(out, "| Gaussians | pixels | forward a, b, a/b | backward a, b, a/b | gather a, b, a/b |")?;
    writeln!(out, "|---|---|---|---|---|")?;
    for (count, size) in RUNS {
        let splats = room(count)?;
        let (ours, theirs) = (measure(&gpu, &splats, size)?, measure(&cpu, &splats, size)?);
        let cell = |ours: f64, theirs: f64| format!("{ours:.1}, {theirs:.1}, {:.1}", ours / theirs);
        writeln!(
            out,
            "| {count} | {} x {} | {} | {} | {} |",
            size[0],
            size[1],
            cell(ours.forward, theirs.forward),
            cell(ours.backward, theirs.backward),
            cell(ours.gather, theirs.gather),
        )?;
    }
    Ok(())
}

fn measure(rasterizer: &dyn Rasterizer, splats: &Splats, size: [u32; 2]) -> Result<Times, Box<dyn Error>> {
    let pose = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];
    let [width, height] = size.map(f64::from);
    let view = View::new(size, [0.86 * width; 2], [0.5 * width, 0.5 * height], pose)?;
    let settings = RasterSettings { quantiles: false, ..RasterSettings::default() };
    let projected = rasterizer.prepare(splats, &view, &settings)?;
    let drawing = projected.draw()?;
    let slopes = vec![[0.1, -0.2, 0.3]; view.pixel_count()];
    let gradient = DrawingGradient { colour: slopes, ..DrawingGradient::zeros(&view) };
    let mask: Vec<f32> = (0..view.pixel_count()).map(|pixel| f32::from(u8::from(pixel % 3 == 0))).collect();
    Ok(Times {
        forward: best_ms(|| {
            black_box(rasterizer.prepare(splats, &view, &settings)?.draw()?);
            Ok(())
        })?,
        backward: best_ms(|| {
            black_box(projected.backward(&drawing, &gradient)?);
            Ok(())
        })?,
        gather: best_ms(|| {
            black_box(projected.gather_features(&mask, 1)?);
            Ok(())
        })?,
    })
}

fn best_ms(work: impl Fn() -> Result<(), RasterError>) -> Result<f64, RasterError> {
    let mut best = f64::INFINITY;
    for _ in 0..REPEAT {
        let start = Instant::now();
        work()?;
        best = best.min(start.elapsed().as_secs_f64() * 1e3);
    }
    Ok(best)
}

/// Discs on the walls of a room of 6 x 4 x 6 metres.
fn room(count: usize) -> Result<Splats, SplatError> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut parts = SplatParts::default();
    for index in 0..count {
        let (a, b) = (random.random_range(-1.0..1.0_f32), random.random_range(-1.0..1.0_f32));
        parts.means.push(match index % 5 {
            0 => [3.0 * a, 2.0 * b, 6.0],
            1 => [3.0 * a, 2.0, 3.0 + 3.0 * b],
            2 => [3.0 * a, -2.0, 3.0 + 3.0 * b],
            3 => [3.0, 2.0 * a, 3.0 + 3.0 * b],
            _ => [-3.0, 2.0 * a, 3.0 + 3.0 * b],
        });
        let size = random.random_range(0.03..0.12_f32);
        parts.scales.push([size, size * random.random_range(0.3..1.0), 0.2 * size]);
        let q: [f32; 4] = std::array::from_fn(|_| random.random_range(-1.0..1.0));
        let length = q.iter().map(|value| value * value).sum::<f32>().sqrt().max(1e-3);
        parts.rotations.push(q.map(|value| value / length));
        parts.opacities.push(random.random_range(0.3..0.99));
        parts.sh.push(std::array::from_fn(|_| random.random_range(-1.5..1.5)));
    }
    Splats::new(parts)
}
