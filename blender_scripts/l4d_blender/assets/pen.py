"""A ball pen that lies on a surface.

Owns the pen; knows nothing of paper. It lies along X with its tip to -X, touching z = 0.
"""

from __future__ import annotations

import random
from math import pi

import bpy
from mathutils import Matrix

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.scene.catalogue import colours, kind
from l4d_blender.scene.colour import Colour

LENGTH_M = 0.142
RADIUS_M = 0.0052


@kind("pen", (0.142, 0.011, 0.013), "graspable", "writes", "rolls", colour=colours("barrel"))
def pen(name: str, rng: random.Random, *, barrel: Colour = (0.02, 0.05, 0.22)) -> bpy.types.Object:
    """A click pen 14 cm long with a metal tip, ring and clip."""
    pen_ = upright_pen(name, rng, barrel=barrel)
    mesh.transform(pen_, Matrix.Rotation(0.5 * pi, 4, "Y") @ Matrix.Translation((0.0, 0.0, -0.5 * LENGTH_M)))
    mesh.transform(pen_, Matrix.Rotation(-0.6 * pi, 4, "X"))
    return mesh.drop_to_base(pen_)


@kind("pen", (0.011, 0.013, 0.142), colour=colours("barrel"))
def upright_pen(name: str, rng: random.Random, *, barrel: Colour = (0.02, 0.05, 0.22)) -> bpy.types.Object:
    """The same pen standing on its tip along +Z."""
    r = RADIUS_M
    tip = mesh.lathe(
        f"{name}_tip", [(0.0, 0.0), (0.0006, 0.0005), (0.0012, 0.004), (0.0030, 0.013), (0.0040, 0.016)], 20
    )
    tube = mesh.lathe(
        f"{name}_barrel",
        [
            (0.0040, 0.016),
            (0.0046, 0.018),
            (r, 0.040),
            (r, 0.080),
            (r + 0.0003, 0.081),
            (r + 0.0003, 0.084),
            (r, 0.085),
            (r, 0.126),
            (r - 0.0009, 0.129),
            (0.0024, 0.1295),
            (0.0024, 0.140),
            (0.0017, LENGTH_M),
            (0.0, LENGTH_M),
        ],
        20,
    )
    clip = mesh.bevel_box(f"{name}_clip", (0.0026, 0.0012, 0.040), 0.0005, segments=2)
    mesh.move(clip, y=-(r + 0.0016), z=0.087)
    lug = mesh.bevel_box(f"{name}_lug", (0.0026, 0.0034, 0.004), 0.0006, segments=2)
    mesh.move(lug, y=-(r + 0.0004), z=0.123)
    steel = products.metal(f"{name}_steel", (0.66, 0.66, 0.68), rng, roughness=0.25)
    plastic = products.satin_plastic(f"{name}_plastic", barrel, rng, roughness=0.25)

    mesh.paint(tube, [plastic, steel], lambda centre, _: int(0.080 < centre.z < 0.085 or centre.z > 0.1292))
    for part in (tip, clip, lug):
        mesh.set_material(part, steel)
    return mesh.join(name, [tip, tube, clip, lug])
