"""A lamp that hangs from the ceiling on a cord."""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.assets.materials.base import emission
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import colours, kind, words
from l4d_blender.scene.colour import Colour

SHAPES = {
    "dome": [(0.20, 0.0), (0.19, 0.06), (0.13, 0.14), (0.04, 0.19), (0.02, 0.24)],
    "cone": [(0.19, 0.0), (0.05, 0.19), (0.03, 0.20), (0.02, 0.26)],
    "drum": [(0.21, 0.0), (0.21, 0.20), (0.20, 0.205), (0.02, 0.205), (0.015, 0.24)],
    "bowl": [(0.15, 0.0), (0.19, 0.05), (0.20, 0.11), (0.16, 0.17), (0.05, 0.21), (0.02, 0.25)],
}


@kind("lamp", (0.4, 0.4, 1.1), "hangs", colour=colours("colour"), shape=words("shape", *SHAPES))
def pendant_lamp(
    name: str,
    rng: random.Random,
    *,
    colour: Colour = (0.10, 0.20, 0.20),
    shape: str = "dome",
    cord_m: float = 1.1,
    glow: float = 2.5,
) -> bpy.types.Object:
    """The rim of the shade is at z = 0; the cord goes up to `cord_m`."""
    outline = SHAPES[shape]
    inner = [(max(r - 0.006, 0.004), z - 0.004) for r, z in reversed(outline)]
    shade = mesh.lathe(f"{name}_shade", [*outline, *inner], 36, close_bottom=False)
    cord = mesh.move(mesh.cylinder(f"{name}_cord", 0.005, cord_m - 0.2, 8), z=0.2)
    light = emission(f"{name}_bulb", (1.0, 0.78, 0.5), glow)
    light.cycles.emission_sampling = "NONE"
    parts = Parts(name)
    parts.add(shade, products.lacquer(f"{name}_lacquer", colour, rng))
    parts.add(cord, products.rubber(f"{name}_cord", (0.02, 0.02, 0.02), rng))
    parts.ellipsoid("bulb", light, (0.045, 0.045, 0.05), 16, 10, (0.0, 0.0, 0.07))
    return parts.join()
