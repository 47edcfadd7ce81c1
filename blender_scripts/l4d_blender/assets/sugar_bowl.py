"""A bowl heaped with sugar cubes, and a plate of biscuits: what stands beside cups.

Owns both. They stand on z = 0.
"""

from __future__ import annotations

import random
from math import cos, pi, sin

import bpy
from mathutils import Matrix, Vector, noise

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products, tableware
from l4d_blender.scene.catalogue import colours, kind
from l4d_blender.scene.colour import Colour


@kind("sugar_bowl", (0.101, 0.101, 0.073), "graspable", "container", colour=colours("glaze"))
def sugar_bowl(name: str, rng: random.Random, *, glaze: Colour = (0.52, 0.2, 0.1)) -> bpy.types.Object:
    """A footed bowl 10 cm wide; cubes pile up over its rim."""
    wall = [
        (0.026, 0.0),
        (0.028, 0.002),
        (0.024, 0.008),
        (0.034, 0.016),
        (0.046, 0.032),
        (0.050, 0.048),
        (0.0505, 0.0505),
        (0.048, 0.0505),
        (0.0465, 0.048),
        (0.042, 0.034),
        (0.030, 0.020),
        (0.0, 0.016),
    ]
    bowl = mesh.set_material(
        mesh.lathe(f"{name}_bowl", wall, 48), products.glaze(f"{name}_glaze", glaze, rng)
    )
    white = products.paper(f"{name}_sugar", (0.82, 0.80, 0.76), rng)
    parts = [bowl]
    for layer, (count, radius, z) in enumerate(
        ((9, 0.031, 0.036), (7, 0.026, 0.046), (5, 0.015, 0.056), (1, 0.0, 0.066))
    ):
        for k in range(count):
            angle = 2 * pi * (k + 0.4 * layer) / count + rng.uniform(-0.2, 0.2)
            cube = mesh.bevel_box(f"{name}_cube", (0.014, 0.014, 0.012), 0.0016, 2)
            turn = Matrix.Rotation(rng.uniform(0, pi), 4, "Z") @ Matrix.Rotation(
                rng.uniform(-0.5, 0.5), 4, "X"
            )
            at = Vector((radius * cos(angle), radius * sin(angle), z - 0.006))
            parts.append(mesh.set_material(mesh.transform(cube, Matrix.Translation(at) @ turn), white))
    return mesh.join(name, parts)


@kind("plate", (0.19, 0.19, 0.045), "surface")
def biscuits(
    name: str, rng: random.Random, *, glaze: Colour = (0.72, 0.69, 0.62), rim: Colour = (0.16, 0.28, 0.24)
) -> bpy.types.Object:
    """A dessert plate 19 cm wide with round biscuits heaped on it and crumbs."""
    plate = mesh.lathe(
        f"{name}_plate",
        [
            (0.050, 0.0),
            (0.054, 0.002),
            (0.066, 0.006),
            (0.092, 0.016),
            (0.095, 0.0185),
            (0.0935, 0.0195),
            (0.088, 0.0175),
            (0.066, 0.0095),
            (0.052, 0.0065),
            (0.0, 0.0065),
        ],
        64,
    )
    mesh.paint(
        plate,
        [products.glaze(f"{name}_glaze", glaze, rng), products.glaze(f"{name}_rim", rim, rng)],
        lambda centre, normal: int(centre.xy.length > 0.0885 and normal.z > 0.0),
    )
    dough = [
        tableware.crust(f"{name}_dough{k}", rng, colour=c, floured=0.25)
        for k, c in enumerate(((0.50, 0.28, 0.10), (0.34, 0.17, 0.06)))
    ]
    parts = [plate]
    for k in range(11):
        angle, ring = 2.39996 * k, 0.0 if k in (0, 10) else 0.042
        z = 0.0068 + (0.011 if k >= 6 else 0.0) + (0.011 if k >= 10 else 0.0)
        tilt = Matrix.Rotation(rng.uniform(-0.16, 0.16), 4, "X") @ Matrix.Rotation(
            rng.uniform(-0.16, 0.16), 4, "Y"
        )
        at = Vector((ring * cos(angle), ring * sin(angle), z + (0.002 if k else 0.0)))
        parts.append(_biscuit(f"{name}_biscuit{k}", Matrix.Translation(at) @ tilt, dough[k % 2], rng))
    return mesh.join(name, parts)


def _biscuit(name: str, pose: Matrix, dough: bpy.types.Material, rng: random.Random) -> bpy.types.Object:
    disc = mesh.cylinder(name, 0.0275, 0.010, 22, bevel_m=0.004)
    mesh.subdivide(disc, 1)
    shift = Vector([rng.uniform(-9, 9) for _ in range(3)])
    mesh.displace(
        disc, lambda p, _: 0.0011 * noise.noise(p * 160 + shift) + 0.0013 * noise.noise(p * 60 + shift)
    )
    return mesh.set_material(mesh.transform(disc, pose), dough)
