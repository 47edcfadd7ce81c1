"""A scratching tree: two sisal posts, plush platforms, a base."""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import cushion
from l4d_blender.assets.materials import interior
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import kind


@kind("cat_tree", (0.618, 0.431, 1.04), "surface")
def cat_tree(
    name: str, rng: random.Random, *, colour: tuple[float, float, float] = (0.5, 0.42, 0.31)
) -> bpy.types.Object:
    """Half a metre wide, the taller post a metre high."""
    plush = interior.felt(f"{name}_plush", colour, rng)
    rope = interior.sisal(f"{name}_rope", rng)
    parts = Parts(name)
    parts.add(cushion.block(f"{name}_base", rng, size_m=(0.50, 0.42, 0.05), bevel_m=0.02, puff_m=0.0), plush)
    for x, y, tall in ((-0.13, 0.05, 0.55), (0.13, 0.0, 0.98)):
        parts.cylinder("post", rope, 0.045, tall - 0.04, 24, x=x, y=y, z=0.04)
        seat = cushion.block(f"{name}_seat", rng, size_m=(0.36, 0.34, 0.06), bevel_m=0.025, puff_m=-0.012)
        parts.add(seat, plush, x=x, y=y, z=tall)
    return parts.join()
