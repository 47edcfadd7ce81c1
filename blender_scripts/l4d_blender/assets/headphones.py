"""Over-ear headphones lying on a surface.

Owns the headphones. They lie flat on z = 0, the band arching towards +Y.
"""

from __future__ import annotations

import random
from math import cos, pi, sin

import bpy
from mathutils import Matrix, Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.scene.catalogue import colours, kind
from l4d_blender.scene.colour import Colour


@kind("headphones", (0.177, 0.169, 0.072), "graspable", colour=colours("shell"))
def headphones(name: str, rng: random.Random, *, shell: Colour = (0.5, 0.48, 0.44)) -> bpy.types.Object:
    """Headphones about 17 cm wide: padded band, two cups with soft cushions."""
    body = products.satin_plastic(f"{name}_shell", shell, rng, roughness=0.35)
    pad = products.leather(f"{name}_pad", (0.035, 0.030, 0.028), rng)
    steel = products.metal(f"{name}_yoke", (0.5, 0.5, 0.52), rng)

    arch = [Vector((0.078 * cos(pi * k / 24), 0.025 + 0.105 * sin(pi * k / 24), 0.026)) for k in range(25)]
    band = mesh.tube(f"{name}_band", arch, [(0.0035, 0.012)] * 25, segments=14)
    lining = mesh.tube(
        f"{name}_lining",
        [p + (Vector((0.0, 0.03, 0.026)) - p).normalized() * 0.006 for p in arch[6:19]],
        [(0.006, 0.0135)] * 13,
        segments=14,
    )
    parts = [mesh.set_material(band, body), mesh.set_material(lining, pad)]
    for side in (-1.0, 1.0):
        lean = Matrix.Translation((0.074 * side, 0.0, 0.036)) @ Matrix.Rotation(0.5 * pi * side, 4, "Y")
        cup = mesh.lathe(
            f"{name}_cup",
            [(0.026, 0.014), (0.033, 0.010), (0.036, 0.0), (0.034, -0.006)],
            36,
            close_top=False,
        )
        cushion = mesh.torus(f"{name}_cushion", 0.025, 0.0105, 36, 14)
        mesh.move(cushion, z=-0.011)
        for part, material in ((cup, body), (cushion, pad)):
            parts.append(mesh.set_material(mesh.transform(part, lean), material))
        yoke = mesh.tube(
            f"{name}_yoke",
            [(0.078 * side, 0.026, 0.026), (0.079 * side, 0.010, 0.030), (0.086 * side, 0.0, 0.036)],
            0.003,
            segments=8,
        )
        parts.append(mesh.set_material(yoke, steel))
    return mesh.join(name, parts)
