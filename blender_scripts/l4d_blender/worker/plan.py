"""The plan of a scene: everything about it that needs no picture.

Writes tracks.json (ground truth and cameras, with the test view chosen), scene.usdc, and plan.json last: a
folder with a plan.json is complete.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path

import bpy

from ..scene import cameras
from ..scene.scene import Scene
from . import files, recipes, tracks, visibility

# Imported only when frames are rendered.
_RENDER_MODULES = ("l4d_blender/worker/exr.py", "l4d_blender/worker/render.py")
Warnings = list[tuple[str, dict[str, object]]]


@dataclass(frozen=True)
class Measured:
    """What was measured of a scene: who is seen from where, which camera is held out, all surfaces."""

    seen: visibility.Visibility
    test: str
    shapes: list[tracks.Shape]


def measure(scene: Scene) -> Measured:
    """Measures a scene."""
    seen = visibility.measure(scene)
    test = visibility.choose_test(seen, scene.rng("test view"))
    return Measured(seen, test, tracks.measure(scene))


def write(scene: Scene, description: str, out: Path, recipe_folder: Path, *, usd: bool = True) -> Warnings:
    """Writes the three files; what falls short of the gates comes back as warnings."""
    return write_measured(scene, description, measure(scene), out, recipe_folder, usd=usd)


def write_measured(
    scene: Scene, description: str, measured: Measured, out: Path, recipe_folder: Path, *, usd: bool
) -> Warnings:
    """Writes the files of a scene that has been measured."""
    (out / "plan.json").unlink(missing_ok=True)
    cameras = camera_entries(scene, measured.test)
    content = tracks.tracks(scene, description, measured.shapes, cameras)
    files.write_bytes(out / "tracks.json", files.canonical_json(content))
    if usd:
        from . import usd as stage

        stage.write(scene, out / "scene.usdc")
    plan = {
        "schema": "l4d/plan/1",
        "scene": scene.name,
        "seed": scene.seed,
        "bpy": bpy.app.version_string.split()[0],
        "scripts": recipes.script_digests(recipe_folder, _RENDER_MODULES),
        "gate": visibility.report(measured.seen, measured.test),
    }
    composition = recipe_folder / f"{scene.name}.json"
    if composition.is_file():
        plan["composition"] = hashlib.sha256(composition.read_bytes()).hexdigest()
    files.write_bytes(out / "plan.json", files.canonical_json(plan))
    return visibility.warnings(measured.seen, measured.test)


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
