"""A flat wooden box with a lid, brass corners and a burnt-in emblem: cigars once, screws now.

Owns the closed box; knows nothing of what stands on it. It stands on z = 0, its clasp to -Y.
"""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.lettering import lettering
from l4d_blender.assets.materials import products
from l4d_blender.assets.parts import CORNERS, Parts
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.colour import Colour


@kind("box", (0.215, 0.157, 0.061), "surface", "container", front="-y")
def wooden_box(
    name: str,
    rng: random.Random,
    *,
    size_m: tuple[float, float, float] = (0.21, 0.15, 0.06),
    light: Colour = (0.36, 0.18, 0.075),
    words: str = "FLOR FINA",
) -> bpy.types.Object:
    """A box of (width, depth, height); its top is flat."""
    width, depth, height = size_m
    wood = products.wood(f"{name}_wood", light, products.scaled(light, 0.5), rng, grain_axis="X")
    brass = products.metal(f"{name}_brass", (0.58, 0.40, 0.14), rng)
    burnt = products.satin_plastic(f"{name}_burnt", (0.06, 0.03, 0.015), rng, roughness=0.8)
    lid_m = 0.014
    parts = Parts(name)
    parts.box("base", wood, (width, depth, height - lid_m - 0.0012), 0.003)
    parts.box("lid", wood, (width + 0.004, depth + 0.004, lid_m), 0.003, z=height - lid_m)
    for x, y in CORNERS:
        corner = mesh.bevel_box(f"{name}_corner", (0.020, 0.020, lid_m + 0.0012), 0.003)
        parts.add(
            corner,
            brass,
            x=x * (0.5 * width - 0.0075),
            y=y * (0.5 * depth - 0.0075),
            z=height - lid_m - 0.0004,
        )
    parts.box("clasp", brass, (0.020, 0.005, 0.024), 0.0015, y=-0.5 * depth - 0.002, z=height - 0.028)
    text = mesh.rotate(lettering(f"{name}_text", words, 0.016, bold_m=0.0004), "X", 90.0)
    parts.add(text, burnt, x=-0.055, y=-0.5 * depth - 0.0003, z=0.022)
    return parts.join()
