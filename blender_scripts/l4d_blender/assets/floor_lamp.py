"""A standing lamp with a glowing linen shade."""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior
from l4d_blender.assets.materials.base import principled
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import kind

SHADE_HEIGHT_M = 1.20


@kind("lamp", (0.38, 0.38, 1.33))
def floor_lamp(name: str, rng: random.Random, *, glow: float = 1.4) -> bpy.types.Object:
    """The middle of the shade is at `SHADE_HEIGHT_M`."""
    brass = principled(f"{name}_brass", (0.50, 0.34, 0.14), roughness=0.32, metallic=0.9, variation=0.2)
    shade = mesh.lathe(
        f"{name}_shade",
        [(0.19, 0.0), (0.182, 0.10), (0.140, 0.26), (0.136, 0.26), (0.178, 0.10), (0.186, 0.0)],
        40,
        close_bottom=False,
    )
    parts = Parts(name)
    parts.cylinder("foot", brass, 0.14, 0.025, 40, bevel_m=0.008)
    parts.cylinder("pole", brass, 0.011, SHADE_HEIGHT_M, 16)
    parts.add(shade, interior.lampshade(f"{name}_linen", glow), z=SHADE_HEIGHT_M - 0.13)
    return parts.join()
