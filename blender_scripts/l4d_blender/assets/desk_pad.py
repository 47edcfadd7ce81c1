"""A leather desk pad with a stitched border.

Owns the pad; knows nothing of what lies on it. It lies on z = 0, long side along X.
"""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.colour import Colour

THICKNESS_M = 0.003


@kind("desk_pad", (0.86, 0.46, 0.004), "surface")
def desk_pad(
    name: str,
    rng: random.Random,
    *,
    size_m: tuple[float, float] = (0.86, 0.46),
    hide: Colour = (0.16, 0.085, 0.05),
    thread: Colour = (0.52, 0.42, 0.28),
) -> bpy.types.Object:
    """A pad of (width, depth)."""
    width, depth = size_m
    pad = mesh.bevel_box(f"{name}_pad", (width, depth, THICKNESS_M), 0.0012)
    parts = [mesh.set_material(pad, products.leather(f"{name}_hide", hide, rng))]
    yarn = products.woven_cloth(f"{name}_thread", thread, rng)
    for along, across, turn in ((width, depth, 0.0), (depth, width, 90.0)):
        for side in (-1.0, 1.0):
            stitches = int(along / 0.009) - 2
            for k in range(stitches):
                stitch = mesh.bevel_box(f"{name}_stitch", (0.0055, 0.0009, 0.0005), 0.0002, segments=1)
                mesh.move(
                    stitch,
                    x=(k - 0.5 * (stitches - 1)) * 0.009,
                    y=side * (0.5 * across - 0.008),
                    z=THICKNESS_M,
                )
                parts.append(mesh.set_material(mesh.rotate(stitch, "Z", turn), yarn))
    return mesh.join(name, parts)
