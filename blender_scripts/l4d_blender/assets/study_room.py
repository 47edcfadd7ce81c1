"""A study: plank floor, painted walls, a wide window with sill and curtains.

Owns what is fixed to the building. Knows nothing of furniture. The window wall is at +Y, floor at z = 0.
"""

from __future__ import annotations

import random
from math import pi, sin

import bpy
from mathutils import Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.colour import Colour

HALF_WIDTH_M = 2.6
FRONT_M = 2.4
WALL_HEIGHT_M = 2.5


@kind("room", (5.33, 3.3, 2.52), "backdrop")
def study_room(
    name: str,
    rng: random.Random,
    *,
    wall_y_m: float = 0.74,
    window_x_m: tuple[float, float] = (-1.05, 0.32),
    sill_m: float = 0.86,
    wall: Colour = (0.5, 0.53, 0.5),
    curtain: Colour = (0.46, 0.4, 0.3),
) -> bpy.types.Object:
    """Three walls round the origin with the window wall at `wall_y_m`; open towards -Y, no ceiling."""
    paint = products.plaster(f"{name}_paint", wall, rng)
    white = products.lacquer(f"{name}_white", (0.74, 0.73, 0.70), rng)
    planks = products.wood(
        f"{name}_planks",
        (0.30, 0.20, 0.12),
        (0.17, 0.10, 0.055),
        rng,
        grain_axis="X",
        stave_m=0.14,
        stave_length_m=1.5,
    )
    parts = [_slab(f"{name}_floor", (-HALF_WIDTH_M, -FRONT_M, -0.02), (HALF_WIDTH_M, wall_y_m, 0.0), planks)]
    low, high = window_x_m
    top = 2.1
    for label, left, right, bottom, upper in (
        ("left", -HALF_WIDTH_M, low, 0.0, WALL_HEIGHT_M),
        ("right", high, HALF_WIDTH_M, 0.0, WALL_HEIGHT_M),
        ("below", low, high, 0.0, sill_m),
        ("above", low, high, top, WALL_HEIGHT_M),
    ):
        parts.append(
            _slab(f"{name}_{label}", (left, wall_y_m, bottom), (right, wall_y_m + 0.16, upper), paint)
        )
    for side in (-1.0, 1.0):
        x = side * HALF_WIDTH_M
        parts.append(
            _slab(f"{name}_side", (x - 0.05, -FRONT_M, 0.0), (x + 0.05, wall_y_m, WALL_HEIGHT_M), paint)
        )
        parts.append(
            _slab(f"{name}_skirting", (x - 0.065, -FRONT_M, 0.0), (x + 0.065, wall_y_m, 0.09), white)
        )
    parts.append(
        _slab(
            f"{name}_skirting", (-HALF_WIDTH_M, wall_y_m - 0.014, 0.0), (HALF_WIDTH_M, wall_y_m, 0.09), white
        )
    )

    parts += _window(name, low, high, sill_m, top, wall_y_m, white, rng)
    parts.append(
        _curtain(
            f"{name}_curtain",
            high - 0.02,
            high + 0.30,
            sill_m - 0.35,
            top + 0.1,
            wall_y_m - 0.07,
            curtain,
            rng,
        )
    )
    parts.append(
        _curtain(
            f"{name}_curtain", low - 0.30, low + 0.02, sill_m - 0.35, top + 0.1, wall_y_m - 0.07, curtain, rng
        )
    )
    return mesh.join(name, parts)


def _slab(
    name: str, low: tuple[float, float, float], high: tuple[float, float, float], material: bpy.types.Material
) -> bpy.types.Object:
    """A box between two corners."""
    size = [b - a for a, b in zip(low, high)]
    slab = mesh.bevel_box(name, size, 0.003, segments=2)
    mesh.move(slab, x=0.5 * (low[0] + high[0]), y=0.5 * (low[1] + high[1]), z=low[2])
    return mesh.set_material(slab, material)


def _window(
    name: str,
    low: float,
    high: float,
    sill: float,
    top: float,
    wall_y: float,
    white: bpy.types.Material,
    rng: random.Random,
) -> list[bpy.types.Object]:
    """Frame with two sashes and a board that sticks out; behind it the garden, opaque and self-lit."""
    parts = [
        _slab(
            f"{name}_board",
            (low - 0.05, wall_y - 0.10, sill - 0.025),
            (high + 0.05, wall_y + 0.08, sill),
            white,
        )
    ]
    middle = 0.5 * (low + high)
    for x in (low, middle - 0.025, middle + 0.025, high):
        parts.append(
            _slab(f"{name}_stile", (x - 0.028, wall_y + 0.05, sill), (x + 0.028, wall_y + 0.11, top), white)
        )
    for z in (sill + 0.03, top - 0.03):
        parts.append(
            _slab(f"{name}_rail", (low, wall_y + 0.05, z - 0.03), (high, wall_y + 0.11, z + 0.03), white)
        )
    view = mesh.grid(f"{name}_view", high - low, top - sill, 1, 1)
    mesh.rotate(view, "X", 90.0)
    mesh.move(view, x=middle, y=wall_y + 0.10, z=0.5 * (sill + top))
    parts.append(
        mesh.set_material(
            view, products.window_view(f"{name}_garden", rng, horizon_m=sill + 0.42, strength=2.2)
        )
    )
    return parts


def _curtain(
    name: str,
    left: float,
    right: float,
    bottom: float,
    top: float,
    y: float,
    colour: Colour,
    rng: random.Random,
) -> bpy.types.Object:
    """A drawn-back curtain in folds."""
    folds, steps = 6, 60
    verts = []
    for z in (bottom, top):
        for k in range(steps + 1):
            t = k / steps
            depth = 0.028 * sin(2 * pi * folds * t + 0.6 * sin(5 * t)) * (1.0 if z == bottom else 0.7)
            verts.append(Vector((left + (right - left) * t, y + depth, z)))
    row = steps + 1
    faces = [(k, k + 1, row + k + 1, row + k) for k in range(steps)]
    cloth = mesh.from_pydata(name, verts, faces)
    return mesh.set_material(
        cloth, products.woven_cloth(f"{name}_linen", colour, rng, threads_per_m=260.0, contrast=0.25)
    )
