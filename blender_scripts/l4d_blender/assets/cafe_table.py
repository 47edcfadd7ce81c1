"""A small table on one foot, as cafes have them: a wooden, marble or lacquered top on a cast-iron column.

Owns the furniture; knows nothing of what stands on it. The middle of the top is at the origin, z = 0 is where
things stand and the foot reaches down to -`HEIGHT_M`.
"""

from __future__ import annotations

import random
from math import cos, pi, sin

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.scene.catalogue import colours, kind, words
from l4d_blender.scene.colour import Colour

HEIGHT_M = 0.74
_TOP_M = 0.026


@kind(
    "table",
    (1.0, 0.66, 0.74),
    "surface",
    top=words("top", "wood", "marble", "lacquer"),
    shape=words("shape", "square", "round_ended"),
    colour=colours("paint"),
)
def cafe_table(
    name: str,
    rng: random.Random,
    *,
    size_m: tuple[float, float] = (1.0, 0.66),
    top: str = "wood",
    shape: str = "square",
    paint: Colour = (0.05, 0.20, 0.14),
    light: Colour = (0.40, 0.235, 0.115),
    dark: Colour = (0.21, 0.105, 0.045),
) -> bpy.types.Object:
    """A table of (length along X, depth along Y)."""
    length, depth = size_m
    bevel = 0.11 if shape == "round_ended" else 0.012
    slab = mesh.from_pydata(f"{name}_top", *_prism(length, depth, bevel), smooth=False)
    if top == "wood":
        skin = products.wood(
            f"{name}_wood", light, dark, rng, grain_axis="X", stave_m=0.09, stave_length_m=1.2
        )
    elif top == "marble":
        skin = products.stoneware(f"{name}_marble", rng)
    else:
        skin = products.lacquer(f"{name}_lacquer", paint, rng)
    parts = [mesh.set_material(slab, skin)]
    iron = products.lacquer(f"{name}_iron", (0.03, 0.031, 0.033), rng)
    foot_r = 0.36 * min(length, depth) + 0.08
    column = mesh.lathe(
        f"{name}_column",
        [
            (foot_r, -HEIGHT_M),
            (foot_r, -HEIGHT_M + 0.012),
            (0.07, -HEIGHT_M + 0.045),
            (0.035, -HEIGHT_M + 0.09),
            (0.032, -0.16),
            (0.05, -0.10),
            (0.16, -_TOP_M - 0.006),
        ],
        40,
        close_top=True,
    )
    parts.append(mesh.set_material(column, iron))
    return mesh.join(name, parts)


def _prism(length: float, depth: float, corner: float) -> tuple[list, list]:
    """A slab with rounded corners, its upper side at z = 0."""
    ring = []
    for k, (sx, sy) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        for j in range(9):
            a = pi / 2 * (k + j / 8)
            ring.append(
                (sx * (length / 2 - corner) + corner * cos(a), sy * (depth / 2 - corner) + corner * sin(a))
            )
    count = len(ring)
    verts = [(x, y, z) for z in (-_TOP_M, 0.0) for x, y in ring]
    sides = [(k, (k + 1) % count, count + (k + 1) % count, count + k) for k in range(count)]
    return verts, [tuple(range(count - 1, -1, -1)), tuple(range(count, 2 * count)), *sides]
