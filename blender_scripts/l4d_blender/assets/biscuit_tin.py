"""A round biscuit tin with a lid: printed bands, a rolled rim, dents.

Owns the closed tin; knows nothing of biscuits. It stands on z = 0.
"""

from __future__ import annotations

import random
from math import pi

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.assets.toy_robot import printed_tin
from l4d_blender.scene.catalogue import colours, kind
from l4d_blender.scene.colour import Colour

RADIUS_M = 0.052
HEIGHT_M = 0.088


@kind("tin", (0.109, 0.109, 0.088), "container", "graspable", "surface", colour=colours("ground"))
def biscuit_tin(
    name: str, rng: random.Random, *, ground: Colour = (0.07, 0.2, 0.12), band: Colour = (0.66, 0.5, 0.22)
) -> bpy.types.Object:
    """A tin 10 cm across and 9 cm tall."""
    r, h = RADIUS_M, HEIGHT_M
    can = mesh.lathe(
        f"{name}_can",
        [
            (r - 0.002, 0.0),
            (r, 0.002),
            (r, h - 0.022),
            (r + 0.0022, h - 0.0215),
            (r + 0.0024, h - 0.018),
            (r + 0.0014, h - 0.017),
            (r + 0.0014, h - 0.003),
            (r - 0.002, h),
            (r - 0.006, h - 0.0015),
            (r - 0.012, h - 0.0022),
            (0.0, h - 0.0015),
        ],
        64,
    )
    mesh.shade_smooth(can, 40.0)
    inks = [printed_tin(f"{name}_ink{k}", colour, rng) for k, colour in enumerate((ground, band))]
    mesh.paint(
        can, inks, lambda at, _: int(0.006 < at.z < 0.012 or 0.052 < at.z < 0.058 or at.z > h - 0.0185)
    )
    parts = [can]
    cream = products.lacquer(f"{name}_cream", (0.70, 0.64, 0.48), rng)
    for k in range(7):
        badge = mesh.cylinder(f"{name}_badge", 0.011, 0.0016, 24)
        mesh.move(mesh.rotate(badge, "X", 90.0), y=-r + 0.0006, z=0.032)
        parts.append(mesh.set_material(mesh.rotate(badge, "Z", 360.0 * k / 7 + 11), cream))
    knob = mesh.torus(f"{name}_ring", 0.020, 0.0012, 36, 8)
    parts.append(mesh.set_material(mesh.move(knob, z=h - 0.0012), inks[0]))
    return mesh.rotate(mesh.join(name, parts), "Z", rng.uniform(0.0, 2 * pi))
