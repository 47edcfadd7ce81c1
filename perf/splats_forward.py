"""How fast splats are drawn: ratios of the CPU rasterizer to other programs on the same scene, and of two threads to one.

    python perf/splats_forward.py
    python perf/splats_forward.py --prototype raster_prototype.rs

Draws colour, alpha and summed depth of 10 000 Gaussians at 256x192 with the CPU rasterizer, with the tiled PyTorch
version of reference_splats.py and, if it is given, with a prototype in Rust, and prints one JSON object. All programs
run in turn, as often as `--rounds` says, and the best time of each counts: on a busy machine only the ratios of one
run mean anything. Needs cargo and PyTorch.

`--scene` takes a JSON file {"width", "height", "fx", "fy", "cx", "cy", "camera_from_world": 3x4, "gaussians": path},
the path being that of little-endian f32 rows (mean 3, scale 3, quaternion 4, opacity, colour 3). With `--prototype`
the scene is the one that the prototype makes for itself. Of its source the harness uses the functions `scene`, `cam`,
`project`, `depth_order`, `bin` and `raster`, with the SIMD crate `wide` 0.7; it is compiled where it lies, with
AVX2 and FMA switched on at compile time, while our own program finds out at run time what the machine has.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
import torch
from reference_splats import Splats, View, draw

ROOT = Path(__file__).resolve().parents[1]
C0 = math.sqrt(1 / (4 * math.pi))


def main() -> None:
    """Times everything in turn and prints the ratios."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--scene", type=Path)
    parser.add_argument("--gaussians", type=int, default=10_000)
    parser.add_argument("--size", default="256x192")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--repeat", type=int, default=40, help="pictures a round and program")
    parser.add_argument("--torch-repeat", type=int, default=3)
    parser.add_argument("--prototype", type=Path, help="source of a rasterizer to compare with; it brings its scene")
    parser.add_argument("--binary", type=Path, help="the built example; without it cargo builds it")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="l4d-perf-") as scratch:
        prototype = options.prototype and build_prototype(options.prototype.resolve())
        if prototype:
            run_prototype(prototype, 1, 1, Path(scratch))
        scene = Path(scratch) / "scene.json" if prototype else options.scene or room(options, Path(scratch))
        print(json.dumps(compare(options, scene, prototype, Path(scratch)), indent=2))


def room(options: argparse.Namespace, scratch: Path) -> Path:
    """Floor, wall and balls of small discs, seen by a camera in front of them."""
    random = np.random.default_rng(1)
    count = options.gaussians
    kind = random.choice(3, count, p=[0.45, 0.2, 0.35])
    u, v = random.uniform(-1, 1, (2, count))
    ball = random.normal(size=(count, 3))
    ball /= np.linalg.norm(ball, axis=1, keepdims=True)
    centres = random.uniform([-2, -1.3, 3], [2, 0.6, 6], (8, 3))
    which = random.integers(0, 8, count)
    means = np.where(
        (kind == 0)[:, None],
        np.stack([3 * u, np.full(count, 1.0), 4.5 + 3 * v], 1),
        np.where((kind == 1)[:, None], np.stack([3 * u, 1.5 * v - 0.5, np.full(count, 7.5)], 1), centres[which] + 0.45 * ball),
    )
    size = 0.085 * math.sqrt(10_000 / count) * random.uniform(0.5, 1.4, (count, 1))
    scales = size * random.uniform([0.5, 0.5, 0.1], [1.6, 1.6, 0.5], (count, 3))
    rotations = random.normal(size=(count, 4))
    rotations /= np.linalg.norm(rotations, axis=1, keepdims=True)
    opacities = np.where(random.random(count) < 0.5, random.uniform(0.8, 0.999, count), random.uniform(0.05, 0.8, count))
    rows = np.concatenate([means, scales, rotations, opacities[:, None], random.random((count, 3))], 1)
    gaussians = scratch / "gaussians.f32"
    gaussians.write_bytes(rows.astype("<f4").tobytes())
    width, height = map(int, options.size.split("x"))
    focal = width / (2 * math.tan(0.5))
    scene = scratch / "scene.json"
    scene.write_text(json.dumps({
        "width": width, "height": height, "fx": focal, "fy": focal, "cx": width / 2, "cy": height / 2,
        "camera_from_world": [[1, 0, 0, 0], [0, 1, 0, 0.3], [0, 0, 1, 0]],
        "gaussians": str(gaussians),
    }))  # fmt: skip
    return scene


def compare(options: argparse.Namespace, scene: Path, prototype: Path | None, scratch: Path) -> dict:
    """Best times of all programs over all rounds, their ratios, and how far the pictures differ."""
    binary = options.binary or build()
    ours: dict[int, list[dict]] = {1: [], 2: []}
    torches: dict[int, list[float]] = {1: [], 2: []}
    prototypes: dict[int, list[float]] = {1: [], 2: []}
    picture = scratch / "picture.f32"
    for _ in range(options.rounds):
        for threads in ours:
            ours[threads].append(run_ours(binary, scene, threads, options.repeat, picture))
            if prototype:
                prototypes[threads].append(run_prototype(prototype, threads, options.repeat, scratch))
        for threads, runs in torches.items():
            seconds, drawn = run_torch(scene, threads, options.torch_repeat)
            runs.append(seconds * 1e3)
    mine = np.frombuffer(picture.read_bytes(), "<f4").reshape(-1, 5)
    theirs = torch.cat([drawn["colour"], drawn["alpha"][..., None], drawn["depth_sum"][..., None]], 2).reshape(-1, 5).numpy()
    error = np.abs(mine - theirs)[:, :4]
    best = {threads: {name: min(run[name] for run in runs) for name in runs[0] if name.endswith("_ms")} for threads, runs in ours.items()}
    forward = {threads: parts["forward_ms"] for threads, parts in best.items()}
    result = {
        "gaussians": ours[1][0]["gaussians"],
        "size": ours[1][0]["size"],
        "rasterizer": ours[1][0]["rasterizer"],
        "best_ms": {str(threads): {name: round(value, 3) for name, value in parts.items()} for threads, parts in best.items()},
        "torch_ms": {str(threads): round(min(runs), 1) for threads, runs in torches.items()},
        "two_threads_over_one": round(forward[1] / forward[2], 2),
        "backward_two_threads_over_one": round(best[1]["backward_ms"] / best[2]["backward_ms"], 2),
        "backward_over_forward": round(best[1]["backward_ms"] / forward[1], 2),
        "over_torch_1_thread": round(min(torches[1]) / forward[1], 1),
        "over_torch_2_threads": round(min(torches[2]) / forward[2], 1),
        "colour_and_alpha_off_by": {"median": float(np.median(error)), "worst": float(error.max()), "pixels_over_1e-4": int((error.max(1) > 1e-4).sum())},
    }  # fmt: skip
    if prototype:
        result["prototype_ms"] = {str(threads): round(min(runs), 3) for threads, runs in prototypes.items()}
        result["over_prototype_1_thread"] = round(min(prototypes[1]) / forward[1], 2)
        result["over_prototype_2_threads"] = round(min(prototypes[2]) / forward[2], 2)
    return result


def build() -> Path:
    """The example, built plainly: it finds out by itself what the machine can do."""
    command = ["cargo", "build", "--release", "-p", "l4d-splat", "--example", "raster_speed", "--message-format", "json"]
    said = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True, check=True).stdout
    built = [json.loads(line).get("executable") for line in said.splitlines()]
    return Path(next(path for path in reversed(built) if path))


# The matrix product that the prototype also measures is not asked for: an empty one stands in for its crate.
DRIVER = """
#![allow(warnings)]
mod prototype {
    include!(SOURCE);
    mod gemm {
        #[derive(Clone, Copy)]
        pub enum Parallelism { None, Rayon(usize) }
        pub unsafe fn gemm<T>(m: usize, n: usize, k: usize, d: *mut T, dc: isize, dr: isize, r: bool, a: *const T,
            ac: isize, ar: isize, b: *const T, bc: isize, br: isize, al: T, be: T, x: bool, y: bool, z: bool,
            p: Parallelism) {}
    }
    pub fn run(threads: usize, repeat: usize, folder: &str) {
        rayon::ThreadPoolBuilder::new().num_threads(threads).build_global().unwrap();
        let (w, h, n) = (256_usize, 192_usize, 10_000_usize);
        let gs = scene(n, 1234567);
        let c = cam([0.0, 1.6, -4.5], [0.0, 0.7, 0.5], w, h);
        let rows = gs.iter().flat_map(|g| [g.p[0], g.p[1], g.p[2], g.s[0], g.s[1], g.s[2], g.q[0], g.q[1], g.q[2],
            g.q[3], g.o, g.c[0], g.c[1], g.c[2]]);
        let bytes: Vec<u8> = rows.flat_map(f32::to_le_bytes).collect();
        std::fs::write(format!("{folder}/gaussians.f32"), bytes).unwrap();
        let row = |k: usize| format!("[{},{},{},{}]", c.r[k][0], c.r[k][1], c.r[k][2], c.t[k]);
        let pose = format!("[{},{},{}]", row(0), row(1), row(2));
        std::fs::write(format!("{folder}/scene.json"), format!("{{\\"width\\":{w},\\"height\\":{h},\\"fx\\":{},\\"fy\\":{},\\"cx\\":{},\\"cy\\":{},\\"camera_from_world\\":{pose},\\"gaussians\\":\\"gaussians.f32\\"}}", c.fx, c.fy, w as f64 / 2.0, h as f64 / 2.0)).unwrap();
        let mask = vec![0.0_f32; w * h];
        let mut best = f64::INFINITY;
        for tight in [false, true] {
            for _ in 0..repeat {
                let start = Instant::now();
                let ps = project(&gs, &c, tight);
                let order = depth_order(&ps);
                let bins = bin(&ps, &order, w, h);
                std::hint::black_box(raster(&ps, &bins, w, h, Mode::Rgbd, &mask, n, tight));
                best = best.min(start.elapsed().as_secs_f64() * 1e3);
            }
        }
        println!("{best}");
    }
}
fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    prototype::run(arguments[1].parse().unwrap(), arguments[2].parse().unwrap(), &arguments[3]);
}
"""


def build_prototype(source: Path) -> Path:
    """A program around the prototype's functions; nothing of it is kept but what cargo keeps in its target folder."""
    crate = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")) / "perf-prototype"
    (crate / "src").mkdir(parents=True, exist_ok=True)
    (crate / "Cargo.toml").write_text(
        '[package]\nname = "prototype"\nversion = "0.0.0"\nedition = "2021"\n[workspace]\n[dependencies]\nwide = "0.7"\nrayon = "1"\n'
    )
    (crate / "src" / "main.rs").write_text(DRIVER.replace("SOURCE", json.dumps(str(source))))
    environment = {**os.environ, "RUSTFLAGS": "-C target-cpu=x86-64-v3", "CARGO_TARGET_DIR": str(crate / "target")}
    subprocess.run(["cargo", "build", "--release", "--quiet"], cwd=crate, env=environment, check=True)
    return crate / "target" / "release" / "prototype"


def run_prototype(binary: Path, threads: int, repeat: int, folder: Path) -> float:
    """Milliseconds of its fastest picture, with whichever of its two ways of culling is faster."""
    command = [binary, str(threads), str(repeat), folder]
    return float(subprocess.run(command, stdout=subprocess.PIPE, check=True).stdout)


def run_ours(binary: Path, scene: Path, threads: int, repeat: int, picture: Path) -> dict:
    """What the example measured."""
    command = [binary, scene, str(threads), str(repeat), picture]
    return json.loads(subprocess.run(command, stdout=subprocess.PIPE, check=True).stdout)


def run_torch(scene: Path, threads: int, repeat: int) -> tuple[float, dict[str, torch.Tensor]]:
    """Seconds of the fastest of some pictures, and one of them."""
    torch.set_num_threads(threads)
    told = json.loads(scene.read_text())
    rows = torch.from_numpy(np.frombuffer((scene.parent / told.pop("gaussians")).read_bytes(), "<f4").reshape(-1, 14).copy())
    splats = Splats(rows[:, :3], rows[:, 3:6], rows[:, 6:10], rows[:, 10], ((rows[:, 11:] - 0.5) / C0)[:, None, :])
    view = View(**told)
    best = math.inf
    with torch.no_grad():
        for _ in range(repeat):
            started = time.perf_counter()
            drawn = draw(splats, view)
            best = min(best, time.perf_counter() - started)
    return best, drawn


if __name__ == "__main__":
    main()
