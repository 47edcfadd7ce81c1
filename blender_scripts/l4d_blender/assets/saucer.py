"""Things that go under a cup: a saucer and a round coaster.

Owns both; knows nothing of cups. They lie on z = 0.
"""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.colour import Colour

SAUCER_WELL_M = 0.0055
COASTER_M = 0.006


@kind("saucer", (0.145, 0.145, 0.018), "surface", "graspable")
def saucer(
    name: str, rng: random.Random, *, glaze: Colour = (0.78, 0.76, 0.71), rim: Colour = (0.03, 0.06, 0.2)
) -> bpy.types.Object:
    """A porcelain saucer 14.5 cm wide with a rim band; a cup stands at `SAUCER_WELL_M`."""
    plate = mesh.lathe(
        name,
        [
            (0.034, 0.0),
            (0.037, 0.0015),
            (0.052, 0.006),
            (0.066, 0.0125),
            (0.0715, 0.0155),
            (0.0725, 0.0170),
            (0.0712, 0.0178),
            (0.0675, 0.0166),
            (0.064, 0.0150),
            (0.051, 0.0090),
            (0.037, 0.0062),
            (0.032, SAUCER_WELL_M),
            (0.0, SAUCER_WELL_M),
        ],
        64,
    )
    materials = [products.glaze(f"{name}_glaze", glaze, rng), products.glaze(f"{name}_rim", rim, rng)]
    return mesh.paint(
        plate, materials, lambda centre, normal: int(normal.z > 0.3 and 0.0640 < centre.xy.length < 0.0676)
    )


@kind("coaster", (0.104, 0.104, 0.006), "surface")
def coaster(name: str, rng: random.Random, *, radius_m: float = 0.052) -> bpy.types.Object:
    """A cork coaster with a top at `COASTER_M`."""
    disc = mesh.cylinder(name, radius_m, COASTER_M, 48, bevel_m=0.0012)
    return mesh.set_material(disc, products.cork(f"{name}_cork", rng))
