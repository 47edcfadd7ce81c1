"""A public bench: slats of hardwood on cast feet, with a back rest. It faces -Y. Metres."""

from __future__ import annotations

import random

import bpy
from mathutils import Matrix

from l4d_blender.scene.catalogue import kind

from . import mesh
from .materials import outdoors, street

SEAT_M = 0.455


@kind("bench", (1.6, 0.618, 0.875), "seat", front="-y")
def street_bench(
    name: str, rng: random.Random, *, length_m: float = 1.6, metal: tuple[float, float, float] | None = None
) -> bpy.types.Object:
    """The seat's front edge is at y = -0.23, the back rest leans over y = +0.25."""
    wood = outdoors.weathered_wood(f"{name}_wood", (0.30, 0.155, 0.070), grain_axis="X")
    iron = street.street_metal(f"{name}_iron", metal or (0.045, 0.050, 0.055))
    slats, frames = [], []
    for k in range(5):
        slat = mesh.bevel_box(f"{name}_slat", (length_m, 0.078, 0.032), 0.008, 2)
        slats.append(mesh.move(slat, 0.0, -0.19 + 0.095 * k, SEAT_M - 0.032 - 0.004 * k))
    for k in range(3):
        slat = mesh.bevel_box(f"{name}_back", (length_m, 0.030, 0.085), 0.008, 2)
        slat.data.transform(
            Matrix.Translation((0.0, 0.245 + 0.035 * k, SEAT_M + 0.10 + 0.115 * k))
            @ Matrix.Rotation(-0.22, 4, "X")
        )
        slats.append(slat)
    for x in (-0.42 * length_m, 0.42 * length_m):
        line = [(x, -0.20, 0.0), (x, -0.185, 0.22), (x, -0.17, 0.40), (x, 0.02, 0.405)]
        frames.append(mesh.tube(f"{name}_leg", line, [(0.020, 0.028)] * 4, segments=8))
        line = [(x, 0.26, 0.0), (x, 0.215, 0.22), (x, 0.235, 0.42), (x, 0.275, 0.60), (x, 0.365, 0.83)]
        frames.append(mesh.tube(f"{name}_back_leg", line, [(0.020, 0.026)] * 5, segments=8))
        line = [(x, -0.17, 0.40), (x, -0.20, 0.62), (x, -0.05, 0.665), (x, 0.265, 0.62)]
        frames.append(mesh.tube(f"{name}_arm", line, [(0.020, 0.016)] * 4, segments=8))
        line = [(x, 0.02, 0.402), (x, 0.24, 0.40)]
        frames.append(mesh.tube(f"{name}_beam", line, [(0.018, 0.018)] * 2, segments=8))
    for part in slats:
        mesh.set_material(part, wood)
    for part in frames:
        mesh.set_material(part, iron)
    return mesh.join(name, slats + frames)
