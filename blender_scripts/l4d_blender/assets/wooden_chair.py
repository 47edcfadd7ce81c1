"""A plain wooden chair: plank seat, turned legs, a back of slats.

Owns the shape. Knows nothing of who sits on it. It faces -Y; the seat is at `SEAT_M`.
"""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets.materials import products
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.colour import Colour

SEAT_M = 0.46


@kind("chair", (0.43, 0.494, 0.925), "seat", front="-y")
def wooden_chair(
    name: str, rng: random.Random, *, light: Colour = (0.34, 0.19, 0.09), dark: Colour = (0.17, 0.085, 0.035)
) -> bpy.types.Object:
    """A chair with a back up to 0.92 m."""
    wood = products.wood(f"{name}_wood", light, dark, rng, grain_axis="Z")
    seat_wood = products.wood(f"{name}_seat_wood", light, dark, rng, grain_axis="Y")
    parts = Parts(name)
    parts.box("seat", seat_wood, (0.43, 0.42, 0.03), 0.01, 3, z=SEAT_M - 0.03)
    for side in (-1, 1):
        parts.tube(
            "leg", wood, [(0.19 * side, -0.18, 0.0), (0.175 * side, -0.165, SEAT_M - 0.02)], [0.014, 0.019]
        )
        parts.tube(
            "post",
            wood,
            [
                (0.19 * side, 0.23, 0.0),
                (0.18 * side, 0.19, SEAT_M),
                (0.18 * side, 0.21, 0.70),
                (0.18 * side, 0.27, 0.92),
            ],
            [0.015, 0.020, 0.018, 0.014],
        )
        parts.tube("rail", wood, [(0.185 * side, -0.17, 0.20), (0.185 * side, 0.21, 0.22)], 0.010)
    for x in (-0.12, -0.04, 0.04, 0.12):
        parts.tube("slat", wood, [(x, 0.20, 0.53), (x, 0.212, 0.70), (x, 0.257, 0.86)], 0.018, 12)
    for z, y in ((0.53, 0.198), (0.87, 0.26)):
        parts.box("crest", wood, (0.38, 0.024, 0.06), 0.010, 3, y=y, z=z - 0.03)
    return parts.join()
