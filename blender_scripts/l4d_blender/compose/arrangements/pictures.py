"""Pictures of arrangements as frame files, and for each layout a description of what is seen in them.

A layout is there once its `arrangement.json` is: that is written last.
"""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import bpy
import numpy as np

from ...scene.cameras import OPENCV_FROM_BLENDER, Camera
from ...worker import exr, files
from ...worker.passes import Renderer
from ..errors import Rejected
from ..stage import Stage
from . import arrange
from .casting import MOMENTS

SCHEMA = "l4d/arrangement/1"
WIDTH, HEIGHT = 256, 192


def name_of(seed: int, layout: int) -> str:
    """The folder of a layout."""
    return f"arrangement_{seed:06}_{layout}"


def render(out: Path, seed: int, views: int, samples: int, threads: int) -> bool:
    """Builds and renders all layouts of a seed, unless they are there; false if they are."""
    described = [out / name_of(seed, layout) / "arrangement.json" for layout in range(len(MOMENTS))]
    if all(file.is_file() for file in described) or _is_rejected(described[0]):
        return False
    try:
        made = arrange.build(f"arrangement_{seed:06}", seed)
    except Rejected as error:
        rejected = {"schema": SCHEMA, "name": name_of(seed, 0), "seed": seed, "rejected": str(error)}
        files.write_bytes(described[0], files.canonical_json(rejected))
        return True
    _hide_ids_of_what_has_no_identity(made.stage)
    kept = _keep_cameras(made.stage, views)
    renderer = Renderer(WIDTH, HEIGHT, samples, denoise=True, threads=threads)
    for layout, (frame, file) in enumerate(zip(MOMENTS, described)):
        if layout:
            made.lay_out_again()
        chosen = made.views(views)
        if file.is_file():
            continue
        for obj, camera in zip(kept, chosen):
            _pose(obj, camera)
        names = [obj.name for obj in kept]
        exact, digests = renderer.exact(names, frame), {}
        for view in names:
            rgb = renderer.beauty(view, frame)
            exr.write_frame(exr.frame_path(file.parent, view, frame), rgb, *exact[view])
            digests[view] = _digest(*exact[view])
        content = _description(made, name_of(seed, layout), frame, dict(zip(names, chosen)), digests)
        files.write_bytes(file, files.canonical_json(content))
    renderer.close()
    return True


def _is_rejected(file: Path) -> bool:
    return file.is_file() and b'"rejected"' in file.read_bytes()


def _description(
    made: arrange.Arrangement, name: str, frame: int, cameras: dict[str, Camera], digests: dict[str, str]
) -> dict[str, Any]:
    scene = made.stage.scene
    return {
        "schema": SCHEMA,
        "name": name,
        "seed": scene.seed,
        "scale": made.place.scale,
        "place": made.place.name,
        "width": WIDTH,
        "height": HEIGHT,
        "frame": frame,
        "exposure": scene.exposure,
        "cameras": [
            {
                "name": view,
                **camera.intrinsics(WIDTH, HEIGHT),
                "world_from_camera": [[round(x, 9) for x in row] for row in camera.world_from_camera],
            }
            for view, camera in cameras.items()
        ],
        "instances": [
            {
                "id": instance.id,
                "name": instance.name,
                "role": instance.role,
                "category": instance.category,
                "attributes": instance.attributes,
            }
            for instance in scene.instances
        ],
        "depth_and_id_sha256": digests,
    }


def _keep_cameras(stage: Stage, count: int) -> Sequence[bpy.types.Object]:
    """Cycles synchronises every camera of a scene, seen or not: the others go."""
    kept = stage.scene.camera_objects[:count]
    bpy.data.batch_remove([obj for obj in bpy.data.objects if obj.type == "CAMERA" and obj not in kept])
    bpy.context.scene.camera = kept[0]
    return kept


def _pose(obj: bpy.types.Object, camera: Camera) -> None:
    obj.matrix_world = camera.world_from_camera @ OPENCV_FROM_BLENDER
    obj.data.lens = camera.focal_over_width * obj.data.sensor_width


def _hide_ids_of_what_has_no_identity(stage: Stage) -> None:
    with_identity = {obj for instance in stage.scene.instances for obj in instance.objects}
    for obj in bpy.context.scene.objects:
        if obj.type == "MESH" and obj not in with_identity:
            obj.pass_index = 0


def _digest(depth_m: np.ndarray, ids: np.ndarray) -> str:
    """Of what is the same in every process; colour is not, in its last bits."""
    data = (
        np.ascontiguousarray(depth_m, np.float32).tobytes() + np.ascontiguousarray(ids, np.uint32).tobytes()
    )
    return hashlib.sha256(data).hexdigest()
