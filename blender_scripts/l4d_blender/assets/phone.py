"""A mobile phone: slab, dark screen, camera bump. It lies flat round its centre, screen up, top towards -Y.

Small scenery for hands to hold.
"""

from __future__ import annotations

import random

import bpy

from l4d_blender.scene.catalogue import kind

from . import mesh
from .materials import products
from .materials.base import principled

SIZE_M = (0.074, 0.152, 0.009)


@kind("phone", (0.074, 0.152, 0.012), "graspable")
def phone(name: str, rng: random.Random) -> bpy.types.Object:
    """The phone, centred on its origin."""
    x, y, z = SIZE_M
    case = mesh.move(mesh.bevel_box(f"{name}_case", SIZE_M, 0.004), z=-0.5 * z)
    mesh.set_material(case, products.satin_plastic(f"{name}_case", (0.030, 0.032, 0.040), rng))
    screen = mesh.move(mesh.bevel_box(f"{name}_screen", (x - 0.006, y - 0.010, 0.001), 0.0004, 1), z=0.5 * z)
    mesh.set_material(screen, principled(f"{name}_screen", (0.01, 0.012, 0.016), roughness=0.1))
    lens = mesh.move(mesh.bevel_box(f"{name}_lens", (0.024, 0.032, 0.002), 0.0008, 2), 0.018, -0.052, -0.006)
    mesh.set_material(lens, products.metal(f"{name}_lens", (0.3, 0.3, 0.32), rng))
    return mesh.join(name, [case, screen, lens])
