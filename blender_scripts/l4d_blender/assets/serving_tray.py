"""A small wooden tray with a raised rim and two hand holes.

Owns the tray; knows nothing of what stands on it. It lies on z = 0; long side along Y, front = -Y.
"""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets.materials import products
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.colour import Colour

FLOOR_M = 0.007
RIM_M = 0.016


@kind("tray", (0.21, 0.294, 0.032), "surface", "graspable")
def serving_tray(
    name: str,
    rng: random.Random,
    *,
    size_m: tuple[float, float] = (0.21, 0.29),
    paint: Colour = (0.62, 0.56, 0.42),
    inlay: Colour = (0.1, 0.24, 0.27),
) -> bpy.types.Object:
    """A tray whose floor is `FLOOR_M` high: painted rim, stained floor."""
    width, depth = size_m
    rim = products.lacquer(f"{name}_rim", paint, rng)
    stain = products.wood(f"{name}_stain", inlay, products.scaled(inlay, 0.5), rng, grain_axis="Y")
    parts = Parts(name)
    parts.box("floor", stain, (width - 0.004, depth - 0.004, FLOOR_M), 0.0015)
    for side in (-1.0, 1.0):
        parts.box("long", rim, (0.009, depth, RIM_M), 0.0035, x=side * 0.5 * (width - 0.009))
        parts.box("short", rim, (width - 0.012, 0.009, RIM_M), 0.0035, y=side * 0.5 * (depth - 0.009))
        parts.tube(
            "grip",
            rim,
            [
                (-0.035, side * (0.5 * depth - 0.004), RIM_M - 0.002),
                (-0.024, side * (0.5 * depth - 0.002), RIM_M + 0.012),
                (0.024, side * (0.5 * depth - 0.002), RIM_M + 0.012),
                (0.035, side * (0.5 * depth - 0.004), RIM_M - 0.002),
            ],
            0.0038,
            segments=10,
        )
    return parts.join()
