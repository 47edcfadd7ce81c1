"""The plan of a scene: everything about it that needs no picture.

Writes tracks.json (ground truth and cameras, with the test view chosen), scene.usdc, and plan.json last: a
folder with a plan.json is complete.
"""

from __future__ import annotations

from pathlib import Path

import bpy

from . import cameras, files, recipes, tracks, visibility
from .scene import Scene

_RENDER_MODULES = ("l4d_blender/exr.py", "l4d_blender/worker.py")  # imported only when frames are rendered
Warnings = list[tuple[str, dict[str, object]]]


def write(scene: Scene, description: str, out: Path, recipe_folder: Path, *, usd: bool = True) -> Warnings:
    """Writes the three files; what falls short of the gates comes back as warnings."""
    (out / "plan.json").unlink(missing_ok=True)
    seen = visibility.measure(scene)
    test = visibility.choose_test(seen, scene.rng("test view"))
    shapes = tracks.measure(scene)
    content = tracks.tracks(scene, description, shapes, camera_entries(scene, test))
    files.write_bytes(out / "tracks.json", files.canonical_json(content))
    if usd:
        from . import usd as stage

        stage.write(scene, out / "scene.usdc")
    plan = {
        "schema": "l4d/plan/1",
        "scene": scene.name,
        "variant": scene.variant,
        "seed": scene.seed,
        "bpy": bpy.app.version_string.split()[0],
        "scripts": recipes.script_digests(recipe_folder, _RENDER_MODULES),
        "gate": visibility.report(seen, test),
    }
    files.write_bytes(out / "plan.json", files.canonical_json(plan))
    return visibility.warnings(seen, test)


def camera_entries(scene: Scene, test: str) -> list[dict]:
    """The cameras as tracks.json lists them."""
    return [
        {
            "name": camera.name,
            "split": "test" if camera.name == test else "train",
            "profiles": cameras.profiles_of(camera.name, test, scene.camera_rig),
            "focal_over_width": camera.focal_over_width,
            "world_from_camera": [tracks.rounded([x for row in camera.world_from_camera for x in row])],
        }
        for camera in scene.camera_rig
    ]
