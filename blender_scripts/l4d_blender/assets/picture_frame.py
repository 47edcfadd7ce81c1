"""A framed painting to hang on a wall."""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior
from l4d_blender.assets.materials.base import principled
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import kind

PALETTES = (
    ((0.05, 0.10, 0.07), (0.14, 0.24, 0.12), (0.45, 0.42, 0.20), (0.75, 0.55, 0.34), (0.52, 0.66, 0.74)),
    ((0.03, 0.06, 0.13), (0.06, 0.18, 0.30), (0.20, 0.42, 0.52), (0.78, 0.68, 0.50), (0.85, 0.50, 0.28)),
    ((0.16, 0.07, 0.04), (0.45, 0.15, 0.07), (0.76, 0.42, 0.16), (0.85, 0.72, 0.50), (0.60, 0.70, 0.72)),
)


@kind("picture", (0.36, 0.028, 0.46), "hangs", front="-y")
def picture_frame(
    name: str, rng: random.Random, *, size_m: tuple[float, float] = (0.36, 0.46), palette: int = 0
) -> bpy.types.Object:
    """The wall is the plane y = 0, the picture looks to -Y, its lower edge is at z = 0."""
    width, height = size_m
    rail = 0.032
    wood = interior.wood(
        f"{name}_wood", rng.choice([(0.09, 0.06, 0.045), (0.42, 0.27, 0.13)]), rng, gloss=0.35
    )
    mount = principled(f"{name}_mount", (0.78, 0.75, 0.68), roughness=0.9, variation=0.06)
    canvas = interior.painting(f"{name}_canvas", PALETTES[palette % len(PALETTES)], rng)
    parts = Parts(name)
    for size, x, z in (
        ((width, 0.028, rail), 0, 0),
        ((width, 0.028, rail), 0, height - rail),
        ((rail, 0.028, height), -(width - rail) / 2, 0),
        ((rail, 0.028, height), (width - rail) / 2, 0),
    ):
        parts.box("rail", wood, size, 0.005, x=x, y=-0.015, z=z)
    for inset, y, material in ((rail, -0.010, mount), (rail + 0.045, -0.012, canvas)):
        w, h = width / 2 - inset, height - 2 * inset
        sheet = mesh.from_pydata(
            f"{name}_sheet",
            [(-w, y, inset), (w, y, inset), (w, y, inset + h), (-w, y, inset + h)],
            [(0, 1, 2, 3)],
            smooth=False,
        )
        parts.add(sheet, material)
    return parts.join()
