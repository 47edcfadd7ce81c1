"""A wooden serving tray with a raised rim and two grips, and a trivet of slats for hot pots.

Owns both; things on them stand at `TRAY_M` and `TRIVET_M`. They lie on z = 0, the grips at +X and -X.
"""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.colour import Colour

TRAY_M = 0.010
TRIVET_M = 0.014


@kind("tray", (0.5, 0.284, 0.041), "surface", "graspable")
def tray(
    name: str,
    rng: random.Random,
    *,
    size_m: tuple[float, float] = (0.44, 0.27),
    light: Colour = (0.3, 0.15, 0.06),
    dark: Colour = (0.13, 0.055, 0.02),
) -> bpy.types.Object:
    """A tray of (length, depth) with a rim 28 mm high."""
    length, depth = size_m
    floor = products.wood(f"{name}_floor", light, dark, rng, grain_axis="X", stave_m=0.07, stave_length_m=0.9)
    rim = products.wood(f"{name}_rim", products.scaled(light, 0.8), dark, rng, grain_axis="X")
    brass = products.metal(f"{name}_brass", (0.62, 0.42, 0.16), rng)
    parts = Parts(name)
    parts.box("board", floor, (length, depth, TRAY_M), 0.002, 2)
    for sign in (-1, 1):
        parts.box("side", rim, (length + 0.014, 0.010, 0.028), 0.003, 3, y=sign * (0.5 * depth + 0.002))
        parts.box("end", rim, (0.010, depth + 0.014, 0.028), 0.003, 3, x=sign * (0.5 * length + 0.002))
        out = sign * (0.5 * length + 0.006)
        grip = mesh.tube(
            f"{name}_grip",
            [
                (out, -0.055, 0.020),
                (out + sign * 0.016, -0.050, 0.034),
                (out + sign * 0.022, 0.0, 0.038),
                (out + sign * 0.016, 0.050, 0.034),
                (out, 0.055, 0.020),
            ],
            0.0042,
            12,
        )
        parts.add(mesh.subdivide(grip, 1), brass)
    return parts.join()


@kind("trivet", (0.165, 0.165, 0.014), "surface")
def trivet(
    name: str,
    rng: random.Random,
    *,
    size_m: float = 0.165,
    light: Colour = (0.5, 0.32, 0.15),
    dark: Colour = (0.28, 0.15, 0.06),
) -> bpy.types.Object:
    """Six slats on two cross bars, square."""
    wood = products.wood(f"{name}_wood", light, dark, rng, grain_axis="X")
    parts = Parts(name)
    for k in range(6):
        slat = mesh.bevel_box(f"{name}_slat", (size_m, 0.72 * size_m / 6, 0.008), 0.002, 2)
        parts.add(slat, wood, y=size_m * ((k + 0.5) / 6 - 0.5), z=TRIVET_M - 0.008)
    for sign in (-1, 1):
        parts.box("bar", wood, (0.018, size_m, 0.0065), 0.0015, 2, x=0.3 * sign * size_m)
    return parts.join()
