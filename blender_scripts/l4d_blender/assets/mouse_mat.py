"""A cloth mouse mat: thin foam, rounded corners, stitched rim.

Owns the mat; knows nothing of mice. It lies on z = 0, its long side along X.
"""

from __future__ import annotations

import random
from math import cos, pi, sin

import bpy
from mathutils import Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.scene.catalogue import colours, kind
from l4d_blender.scene.colour import Colour

THICKNESS_M = 0.003


@kind("mouse_mat", (0.24, 0.2, 0.003), "surface", colour=colours("cloth"))
def mouse_mat(
    name: str,
    rng: random.Random,
    *,
    size_m: tuple[float, float] = (0.24, 0.2),
    cloth: Colour = (0.1, 0.16, 0.19),
    thread: Colour = (0.03, 0.045, 0.055),
) -> bpy.types.Object:
    """A mat with its top at `THICKNESS_M`."""
    outline = _rounded_rectangle(size_m, radius_m=0.018)
    inner = _rounded_rectangle((size_m[0] - 0.006, size_m[1] - 0.006), radius_m=0.015)
    top = THICKNESS_M
    sheet = mesh.loft(
        f"{name}_sheet",
        [
            [Vector((x, y, 0.0)) for x, y in outline],
            [Vector((x, y, 0.7 * top)) for x, y in outline],
            [Vector((x, y, top)) for x, y in inner],
        ],
    )
    mesh.shade_smooth(sheet, 30.0)
    mesh.set_material(
        sheet, products.woven_cloth(f"{name}_cloth", cloth, rng, threads_per_m=700.0, contrast=0.3)
    )

    rim_path = _rounded_rectangle((size_m[0] - 0.004, size_m[1] - 0.004), radius_m=0.016)
    rim = mesh.tube(
        f"{name}_rim", [Vector((x, y, 0.8 * top)) for x, y in rim_path], 0.0012, segments=6, closed=True
    )
    mesh.set_material(rim, products.woven_cloth(f"{name}_thread", thread, rng, threads_per_m=900.0))
    return mesh.join(name, [sheet, rim])


def _rounded_rectangle(
    size_m: tuple[float, float], radius_m: float, steps: int = 6
) -> list[tuple[float, float]]:
    half_x, half_y = 0.5 * size_m[0] - radius_m, 0.5 * size_m[1] - radius_m
    corners = [(half_x, half_y), (-half_x, half_y), (-half_x, -half_y), (half_x, -half_y)]
    return [
        (
            x + radius_m * cos(0.5 * pi * (corner + step / steps)),
            y + radius_m * sin(0.5 * pi * (corner + step / steps)),
        )
        for corner, (x, y) in enumerate(corners)
        for step in range(steps + 1)
    ]
