"""What the worker adds to two bare Cycles loops: wall time, in one run, and its peak memory.

Both render the same images of the same scene. "bare" is one process that builds the recipe and calls
Blender's render operator in a beauty loop and then in an exact loop, and leaves Blender's own files where
they are; "worker" is `python -m l4d_blender render`, which also packs, syncs and reports every frame.

    python perf/build_scenes.py --scene tabletop_mouse_cups --frames 4

prints one JSON object; the ratio has to stay below 1.15 and the peak below 2048 MiB. On a busy machine look
at the ratio of CPU seconds instead. `--threads 1` beside `--threads 2` shows why no worker gets a single thread.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from pathlib import Path

SCRIPTS = Path(__file__).resolve().parents[1] / "blender_scripts"


def main() -> None:
    """Times both, in turn as often as asked, and prints the best of each."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--scene", required=True)
    parser.add_argument("--recipes", type=Path, default=SCRIPTS / "scenes")
    parser.add_argument("--frames", type=int, default=4, help="so many moments, spread over the clip")
    parser.add_argument("--views", type=int, default=8)
    parser.add_argument("--size", default="256x192")
    parser.add_argument("--samples", type=int, default=4)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--repeat", type=int, default=1)
    parser.add_argument("--bare", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.bare:
        bare_loop(json.loads(options.bare.read_text()))
        return
    with tempfile.TemporaryDirectory(prefix="l4d-perf-") as scratch:
        print(json.dumps(compare(options, Path(scratch)), indent=2))


def compare(options: argparse.Namespace, scratch: Path) -> dict:
    """Runs plan once, then bare loop and worker in turn."""
    recipe = ["--scene", options.scene, "--recipes", str(options.recipes.resolve())]
    worker("plan", *recipe, "--out", str(scratch), "--without-usd")
    width, height = map(int, options.size.split("x"))
    frames = [round(i * 96 / max(options.frames - 1, 1)) for i in range(options.frames)]
    views = [f"cam{round(i * 16 / max(options.views - 1, 1)):02}" for i in range(options.views)]
    job = {
        "schema": "l4d/render-job/1",
        "scene": options.scene,
        "variant": 0,
        "seed": 0,
        "profile": "small",
        "width": width,
        "height": height,
        "samples": options.samples,
        "denoise": True,
        "threads": options.threads,
        "out": str(scratch / "out"),
        "images": [{"view": view, "frame": frame} for frame in frames for view in views],
        "tracks": str(scratch / "tracks.json"),
        "recipes": str(options.recipes.resolve()),
    }
    path = scratch / "job.json"
    path.write_text(json.dumps(job))
    bare, ours = [], []
    for _ in range(options.repeat):
        bare.append(timed([sys.executable, __file__, "--scene", options.scene, "--bare", str(path)]))
        ours.append(timed([sys.executable, "-m", "l4d_blender", "render", str(path)]))
    bare_wall, bare_cpu = (min(run[i] for run in bare) for i in (0, 1))
    worker_wall, worker_cpu = (min(run[i] for run in ours) for i in (0, 1))
    images = len(job["images"])
    return {
        "scene": options.scene,
        "images": images,
        "bare_seconds": round(bare_wall, 2),
        "worker_seconds": round(worker_wall, 2),
        "worker_seconds_per_image": round(worker_wall / images, 3),
        "worker_cpu_seconds_per_image": round(worker_cpu / images, 3),
        "ratio": round(worker_wall / bare_wall, 3),
        "cpu_ratio": round(worker_cpu / bare_cpu, 3),
        "worker_peak_rss_mib": max(json.loads(run[2].splitlines()[-1])["peak_rss_mib"] for run in ours),
    }


def timed(command: list[str]) -> tuple[float, float, str]:
    """Wall seconds, CPU seconds and stdout of a command."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    started = time.monotonic()
    done = subprocess.run(command, cwd=SCRIPTS, stdout=subprocess.PIPE, check=False)
    if done.returncode != 0:
        sys.exit(done.stdout.decode().strip() or f"{command} failed")
    wall = time.monotonic() - started
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return wall, cpu, done.stdout.decode()


def worker(*arguments: str) -> None:
    """One command of the worker."""
    subprocess.run(
        [sys.executable, "-m", "l4d_blender", *arguments], cwd=SCRIPTS, check=True, stdout=sys.stderr
    )


def bare_loop(job: dict) -> None:
    """The same two passes without anything of ours round them."""
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 1)
    sys.path.insert(0, str(SCRIPTS))
    import bpy

    from l4d_blender.worker import passes, recipes

    recipes.build(job["scene"], job["seed"], Path(job["recipes"]))
    renderer = passes.Renderer(job["width"], job["height"], job["samples"], threads=job["threads"])
    with tempfile.TemporaryDirectory(prefix="l4d-bare-") as folder:
        for scene in renderer.scenes:
            for image in job["images"]:
                scene.camera = bpy.data.objects[image["view"]]
                scene.render.use_multiview = False
                scene.frame_set(image["frame"])
                scene.render.filepath = f"{folder}/{scene.name}-{image['view']}-{image['frame']}.exr"
                with bpy.context.temp_override(scene=scene):
                    bpy.ops.render.render(write_still=True)
    os._exit(0)


if __name__ == "__main__":
    main()
