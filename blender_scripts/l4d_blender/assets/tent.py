"""A play tent: four poles and cloth, open in front."""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import colours, kind
from l4d_blender.scene.colour import Colour


@kind("tent", (1.095, 1.095, 1.613), "container", front="-y", colour=colours("cloth"))
def tent(
    name: str,
    rng: random.Random,
    *,
    cloth: Colour = (0.62, 0.54, 0.40),
    stripe: Colour = (0.60, 0.57, 0.50),
    half_m: float = 0.52,
    height_m: float = 1.3,
) -> bpy.types.Object:
    """Its opening looks to -Y; the poles cross above the cloth."""
    fabric = interior.striped_cloth(f"{name}_cloth", (cloth, stripe), rng, period_m=rng.uniform(0.12, 0.3))
    wood = interior.wood(f"{name}_poles", (0.52, 0.38, 0.22), rng, grain_axis="Z")
    corners = [(-half_m, -half_m), (half_m, -half_m), (half_m, half_m), (-half_m, half_m)]
    small, parts = 0.05, Parts(name)
    sides = [
        [(*corners[k], 0.015), (*corners[k + 1 - 4], 0.015), *_top(corners, k, small, height_m)]
        for k in (1, 2, 3)
    ]
    for k, side in enumerate(sides):
        sheet = mesh.from_pydata(f"{name}_side_{k}", side, [(0, 1, 2, 3)], smooth=False)
        parts.add(mesh.solidify(sheet, 0.006, offset=0.0), fabric)
    for sign in (-1, 1):
        flap = [
            (sign * half_m, -half_m, 0.015),
            (sign * 0.30, -half_m, 0.015),
            (sign * 0.012, -small - 0.012, height_m - 0.02),
            (sign * small, -small, height_m),
        ]
        sheet = mesh.from_pydata(f"{name}_flap", flap, [(0, 1, 2, 3)], smooth=False)
        parts.add(mesh.solidify(sheet, 0.006, offset=0.0), fabric)
    for x, y in corners:
        lean = -small / half_m
        end = (lean * x * 4.0, lean * y * 4.0, height_m + 0.30)
        parts.tube("pole", wood, [(1.03 * x, 1.03 * y, 0.0), end], 0.013, 10)
    return mesh.drop_to_base(parts.join())


def _top(
    corners: list[tuple[float, float]], k: int, small: float, height: float
) -> list[tuple[float, float, float]]:
    """The upper ends of a side, the far one first."""
    half = abs(corners[0][0])
    ends = [corners[k + 1 - 4], corners[k]]
    return [(small * x / half, small * y / half, height) for x, y in ends]
