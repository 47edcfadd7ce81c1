"""A painter's easel with a canvas that somebody is working on."""

from __future__ import annotations

import random
from math import radians

import bpy
from mathutils import Matrix

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior
from l4d_blender.assets.materials.base import principled
from l4d_blender.assets.parts import Parts
from l4d_blender.assets.picture_frame import PALETTES
from l4d_blender.scene.catalogue import kind


@kind("easel", (0.7, 0.693, 1.657), "surface", front="-y")
def easel(
    name: str,
    rng: random.Random,
    *,
    canvas_m: tuple[float, float] = (0.70, 0.85),
    palette: int = 0,
    timber: tuple[float, float, float] = (0.46, 0.32, 0.19),
) -> bpy.types.Object:
    """Three legs; the painter stands at -Y."""
    wood = interior.wood(f"{name}_wood", timber, rng, grain_axis="Z")
    width, height = canvas_m
    lean = Matrix.Translation((0.0, -0.12, 0.0)) @ Matrix.Rotation(radians(-8.0), 4, "X")
    parts = Parts(name)
    for x in (-1, 1):
        parts.tube("leg", wood, [(0.30 * x, -0.16, 0.0), (0.04 * x, 0.07, 1.62)], 0.017, 8)
    parts.tube("leg", wood, [(0.0, 0.50, 0.0), (0.0, 0.08, 1.55)], 0.017, 8)
    parts.box("ledge", wood, (0.62, 0.07, 0.03), 0.004, 1, y=-0.03, z=0.70, within=lean)
    parts.box("mast", wood, (0.05, 0.025, 1.25), 0.004, 1, y=0.02, z=0.42, within=lean)
    frame = mesh.move(mesh.bevel_box(f"{name}_frame", (width, 0.02, height), 0.003, 1), y=-0.03, z=0.73)
    linen = principled(f"{name}_linen", (0.66, 0.62, 0.54), roughness=0.9, variation=0.1)
    parts.add(frame, linen, within=lean)
    half, low = width / 2 - 0.03, 0.76
    paint = mesh.from_pydata(
        f"{name}_paint",
        [
            (-half, -0.0415, low),
            (half, -0.0415, low),
            (half, -0.0415, low + height - 0.06),
            (-half, -0.0415, low + height - 0.06),
        ],
        [(0, 1, 2, 3)],
        smooth=False,
    )
    picture = interior.painting(f"{name}_picture", PALETTES[palette % len(PALETTES)], rng)
    parts.add(paint, picture, within=lean)
    return mesh.drop_to_base(parts.join())
