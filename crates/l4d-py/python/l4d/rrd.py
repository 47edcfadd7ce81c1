"""A scene over time as a recording of the rerun viewer.

    python -m l4d.rrd data/tiny/tabletop_tea --splats work/tiny/tabletop_tea/splats --out tea.rrd

Needs rerun-sdk 0.36 (`pip install "l4d[rerun]"`), which nothing else of the package does. The recording is a file; nothing is
sent anywhere.
"""

import argparse
import json
import os
from pathlib import Path
from typing import Optional

import numpy as np

from l4d._error import L4dError
from l4d._native import Camera, Scene, Splats

# The constant spherical harmonic: colour = 0.5 + this * coefficient.
_CONSTANT_HARMONIC = 0.28209479177387814
# rerun asks once whether it may count its users.
os.environ.setdefault("RERUN_ANALYTICS", "0")


def write(scene: Scene, out: Path, splats: Optional[Splats] = None, tracks: Optional[Path] = None) -> None:
    """Writes cameras with pictures, depth and ids, Gaussians if there are any, and boxes of `tracks`, a tracks.json."""
    try:
        import rerun as rr
    except ImportError as error:
        raise ImportError("l4d.rrd needs rerun-sdk: pip install 'rerun-sdk==0.36.*'") from error
    recording = rr.RecordingStream("l4d", recording_id=scene.name)
    recording.save(str(out))
    recording.log("world", rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    for camera in scene.cameras:
        _log_lens(rr, recording, camera, scene)
    instances = json.loads(tracks.read_text())["instances"] if tracks else []
    for frame in scene.frames:
        recording.set_time("frame", sequence=frame)
        recording.set_time("seconds", duration=scene.timeline.seconds(frame))
        for camera in scene.cameras:
            _log_pictures(rr, recording, camera, scene, frame)
        if splats is not None:
            _log_gaussians(rr, recording, splats.gaussians(frame=frame))
        for instance in instances:
            _log_box(rr, recording, instance, frame)
    recording.disconnect()


def _entity(camera: Camera) -> str:
    return f"world/cameras/{camera.name}"


def _log_lens(rr, recording, camera: Camera, scene: Scene) -> None:
    matrix = camera.intrinsics
    lens = rr.Pinhole(image_from_camera=matrix, resolution=[scene.width, scene.height], camera_xyz=rr.ViewCoordinates.RDF)
    recording.log(_entity(camera), lens, static=True)


def _log_pictures(rr, recording, camera: Camera, scene: Scene, frame: int) -> None:
    pose = np.asarray(camera.world_from_camera(frame))
    entity = _entity(camera)
    recording.log(entity, rr.Transform3D(translation=pose[:3, 3], mat3x3=pose[:3, :3]))
    seen = scene.frame(camera.name, frame)
    depth_m = np.where(np.isfinite(seen.depth_m), seen.depth_m, 0).astype(np.float32)
    recording.log(f"{entity}/colour", rr.Image(seen.display()).compress(90))
    recording.log(f"{entity}/depth", rr.DepthImage(depth_m, meter=1.0))
    recording.log(f"{entity}/ids", rr.SegmentationImage(seen.id.astype(np.uint16)))


def _log_gaussians(rr, recording, gaussians: "dict[str, np.ndarray]") -> None:
    colour = np.clip(0.5 + _CONSTANT_HARMONIC * gaussians["sh"][:, 0], 0, 1)
    rgba = np.concatenate([colour, gaussians["opacities"][:, None]], axis=1)
    splats = rr.GaussianSplats3D(
        gaussians["means"],
        scales=gaussians["scales"],
        quaternions=np.roll(gaussians["rotations"], -1, axis=1),
        colors=np.round(255 * rgba).astype(np.uint8),
    )
    recording.log("world/gaussians", splats)


def _log_box(rr, recording, instance: dict, frame: int) -> None:
    """Rows of tracks are one for all frames, or one a frame."""

    def at(rows: list) -> np.ndarray:
        return np.asarray(rows[0 if len(rows) == 1 else frame], dtype=np.float64)

    track = instance["track"]
    axes = at(track["axes"]).reshape(3, 3)
    box = rr.Boxes3D(half_sizes=[at(track["extents"]) / 2], labels=[instance["name"]])
    recording.log(f"world/boxes/{instance['name']}", rr.Transform3D(translation=at(track["centre"]), mat3x3=axes))
    recording.log(f"world/boxes/{instance['name']}/box", box)


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m l4d.rrd", description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("scene", type=Path, help="folder of the rendered scene")
    parser.add_argument("--splats", type=Path, help="a model of it")
    parser.add_argument("--tracks", type=Path, help="boxes: <bench>/scenes/<scene>.json")
    parser.add_argument("--out", type=Path, required=True, help="the recording, .rrd")
    options = parser.parse_args()
    try:
        splats = Splats(options.splats) if options.splats else None
        write(Scene(options.scene), options.out, splats, options.tracks)
    except L4dError as error:
        parser.exit(2, f"error: {error}\n")
    print(options.out)


if __name__ == "__main__":
    main()
