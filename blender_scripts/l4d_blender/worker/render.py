"""Renders the images of a job, one whole EXR each, and says so line by line.

The exact passes of a few frames come first and stay in memory (all cameras of a frame share one, they are
cheap); then each image gets its beauty pass and is written at once. So whoever kills the worker loses one
beauty pass, and Blender, which keeps only one scene's data between renders, seldom changes scenes. A job with
no samples leaves the colour black: depth and ids are all that the truth needs.
"""

from __future__ import annotations

import json
import resource
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

import numpy as np

from ..scene.timeline import FRAME_COUNT, LAST_FRAME
from . import files, recipes
from .recipes import WorkerError

_CHUNK_IMAGES = 24

Send = Callable[..., None]


@dataclass(frozen=True)
class Job:
    """What a render job asks for; images are (view, frame)."""

    scene: str
    seed: int
    profile: str
    width: int
    height: int
    samples: int
    denoise: bool
    threads: int
    out: Path
    images: list[tuple[str, int]]
    tracks: Path
    recipes: Path


def read_job(path: Path) -> Job:
    """Reads and checks a job file."""
    fields = _read_json(path)
    if fields.get("schema") != "l4d/render-job/1":
        raise WorkerError(f"{path}: schema is {fields.get('schema')!r}", "this worker reads l4d/render-job/1")
    try:
        images = {(str(image["view"]), int(image["frame"])) for image in fields["images"]}
        return Job(
            scene=str(fields["scene"]),
            seed=int(fields["seed"]),
            profile=str(fields["profile"]),
            width=int(fields["width"]),
            height=int(fields["height"]),
            samples=int(fields["samples"]),
            denoise=bool(fields["denoise"]),
            threads=int(fields["threads"]),
            out=Path(fields["out"]),
            images=sorted(images, key=lambda image: (image[1], image[0])),
            tracks=Path(fields["tracks"]),
            recipes=Path(fields.get("recipes", recipes.RECIPES)),
        )
    except KeyError as error:
        raise WorkerError(f"{path}: field {error} is missing") from error
    except (TypeError, ValueError) as error:
        raise WorkerError(f"{path}: {error}") from error


def run(job: Job, send: Send) -> None:
    """Builds the scene, renders what the job lists and reports each image."""
    views = _views(job)
    started = time.monotonic()
    scene, _ = recipes.build(job.scene, job.seed, job.recipes)
    _check_poses(scene, views, job)
    from .exr import frame_path, write_frame
    from .passes import Renderer

    black = np.zeros((job.height, job.width, 3), dtype=np.float32)
    renderer = Renderer(job.width, job.height, max(job.samples, 1), denoise=job.denoise, threads=job.threads)
    send("start", device=renderer.device, images=len(job.images), seconds=_since(started))
    for name, entry in views.items():
        files.write_bytes(job.out / "frames" / name / "view.json", files.canonical_json(entry))
    for chunk in _chunks(job.images):
        started = time.monotonic()
        exact = {frame: renderer.exact(few, frame) for frame, few in chunk.items()}
        share = _since(started) / sum(map(len, chunk.values()))
        for frame, few in chunk.items():
            for view in few:
                started = time.monotonic()
                rgb = renderer.beauty(view, frame) if job.samples else black
                write_frame(frame_path(job.out, view, frame), rgb, *exact[frame][view])
                send("image", view=view, frame=frame, seconds=round(share + _since(started), 3))
    renderer.close()
    peak_kib = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // (1024 if sys.platform == "darwin" else 1)
    send("done", peak_rss_mib=peak_kib // 1024)


def _chunks(images: list[tuple[str, int]]) -> Iterator[dict[int, list[str]]]:
    """The images as frame -> views, in order: whole frames, some dozens of images at a time."""
    chunk: dict[int, list[str]] = {}
    for frame, group in groupby(images, key=lambda image: image[1]):
        chunk[frame] = [view for view, _ in group]
        if sum(map(len, chunk.values())) >= _CHUNK_IMAGES:
            yield chunk
            chunk = {}
    if chunk:
        yield chunk


def _views(job: Job) -> dict[str, dict]:
    """view.json of every view of the job, from tracks.json."""
    tracks = _read_json(job.tracks)
    made_for = tuple(tracks.get(key) for key in ("scene", "seed"))
    if made_for != (job.scene, job.seed):
        raise WorkerError(f"{job.tracks}: made for {made_for}, not for this job", "plan the scene again")
    known = {camera["name"]: camera for camera in tracks["cameras"]}
    views = {}
    for view, frame in job.images:
        if frame not in range(FRAME_COUNT):
            raise WorkerError(f"job: {view} frame {frame} is outside the clip", f"frames are 0..{LAST_FRAME}")
    for name in sorted({view for view, _ in job.images}):
        if name not in known:
            raise WorkerError(f"{job.tracks}: no camera named {name!r}", f"cameras: {', '.join(known)}")
        camera = known[name]
        focal = round(camera["focal_over_width"] * job.width, 6)
        views[name] = {
            "schema": "l4d/view/1",
            "name": name,
            "split": camera["split"],
            "width": job.width,
            "height": job.height,
            "fx": focal,
            "fy": focal,
            "cx": job.width / 2,
            "cy": job.height / 2,
            "world_from_camera": camera["world_from_camera"],
        }
    return views


def _check_poses(scene, views: dict[str, dict], job: Job) -> None:
    """Refuses to render with cameras that differ from the planned ones."""
    for camera in scene.camera_rig:
        if camera.name in views:
            planned = views[camera.name]["world_from_camera"][0]
            built = [x for row in camera.world_from_camera for x in row]
            if max(abs(a - b) for a, b in zip(planned, built)) > 2e-6:
                raise WorkerError(
                    f"{job.tracks}: {camera.name} stands elsewhere than the recipe puts it",
                    "the recipe has changed since: plan the scene again",
                )


def _read_json(path: Path) -> dict:
    try:
        value = json.loads(path.read_bytes())
    except ValueError as error:
        raise WorkerError(f"{path}: not JSON: {error}") from error
    if not isinstance(value, dict):
        raise WorkerError(f"{path}: not a JSON object")
    return value


def _since(started: float) -> float:
    return round(time.monotonic() - started, 3)
