"""Wooden rings on a peg, largest at the bottom.

Owns the toy; knows nothing of hands. It stands on z = 0.
"""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.colour import Colour

COLOURS: tuple[Colour, ...] = (
    (0.06, 0.25, 0.30),
    (0.66, 0.40, 0.05),
    (0.24, 0.34, 0.10),
    (0.60, 0.20, 0.04),
    (0.66, 0.60, 0.46),
)


@kind("toy", (0.094, 0.094, 0.147), "graspable")
def ring_stacker(name: str, rng: random.Random) -> bpy.types.Object:
    """Five rings and a ball, about 15 cm tall."""
    beech = products.wood(f"{name}_beech", (0.58, 0.40, 0.23), (0.42, 0.26, 0.13), rng, grain_axis="Z")
    base = mesh.cylinder(f"{name}_base", 0.047, 0.012, 40, bevel_m=0.004)
    peg = mesh.cylinder(f"{name}_peg", 0.008, 0.125, 20)
    parts = [mesh.set_material(base, beech), mesh.set_material(peg, beech)]
    z = 0.012
    for k, colour in enumerate(COLOURS):
        minor, outer = 0.0105 - 0.0006 * k, 0.044 - 0.0055 * k
        ring = mesh.torus(f"{name}_ring{k}", outer - minor, minor, 40, 16)
        mesh.move(ring, x=rng.uniform(-0.002, 0.002), y=rng.uniform(-0.002, 0.002), z=z + minor)
        parts.append(mesh.set_material(ring, products.lacquer(f"{name}_ring{k}", colour, rng)))
        z += 2 * minor
    ball = mesh.ellipsoid(f"{name}_ball", (0.014, 0.014, 0.014), 24, 16, centre=(0.0, 0.0, 0.133))
    parts.append(mesh.set_material(ball, products.lacquer(f"{name}_ball", (0.46, 0.05, 0.04), rng)))
    return mesh.join(name, parts)
