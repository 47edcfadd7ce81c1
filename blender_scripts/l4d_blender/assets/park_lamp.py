"""An old-fashioned park lamp: a fluted cast-iron post with a lit lantern. Stands on z = 0. Metres."""

from __future__ import annotations

import random
from math import cos, pi, sin

import bpy
from mathutils import Vector

from l4d_blender.scene.catalogue import kind

from . import mesh
from .materials import street
from .materials.base import emission

LANTERN_Z_M = 2.28


@kind("lamp_post", (0.4, 0.34, 2.64))
def park_lamp(name: str, rng: random.Random, *, glow: float = 5.0) -> bpy.types.Object:
    """The lantern's panes are opaque and shine; its light has to come from a lamp of the scene."""
    iron = street.street_metal(f"{name}_iron", (0.018, 0.030, 0.024))
    z = LANTERN_Z_M
    profile = [
        (0.17, 0.0),
        (0.17, 0.05),
        (0.13, 0.09),
        (0.115, 0.30),
        (0.085, 0.40),
        (0.095, 0.43),
        (0.060, 0.50),
        (0.044, 1.90),
        (0.062, 1.94),
        (0.040, 2.00),
        (0.034, z - 0.16),
        (0.080, z - 0.13),
        (0.0, z - 0.125),
    ]
    post = mesh.lathe(f"{name}_post", profile, 20)
    mesh.displace(post, lambda p, n: Vector((n.x, n.y, 0.0)) * (0.004 * sin(10.0 * _angle(p))))
    bar = mesh.tube(f"{name}_bar", [(-0.20, 0, 1.86), (0.20, 0, 1.86)], 0.012, segments=8)
    frame = [post, bar]
    for k in range(6):
        a = 2.0 * pi * k / 6
        low, high = (
            Vector((0.085 * cos(a), 0.085 * sin(a), z - 0.13)),
            Vector((0.135 * cos(a), 0.135 * sin(a), z + 0.16)),
        )
        frame.append(mesh.tube(f"{name}_rib", [low, high], 0.008, segments=6))
    roof = [
        (0.155, z + 0.155),
        (0.150, z + 0.175),
        (0.06, z + 0.26),
        (0.030, z + 0.29),
        (0.022, z + 0.34),
        (0.0, z + 0.36),
    ]
    frame.append(mesh.lathe(f"{name}_roof", roof, 24))
    metal = mesh.set_material(mesh.join(f"{name}_metal", frame), iron)
    panes = mesh.lathe(f"{name}_panes", [(0.078, z - 0.128), (0.128, z + 0.158)], 6, close_bottom=False)
    shine = emission(f"{name}_panes", (1.0, 0.74, 0.42), glow)
    shine.cycles.emission_sampling = "NONE"
    return mesh.join(name, [metal, mesh.set_material(panes, shine)])


def _angle(p: Vector) -> float:
    return Vector((1.0, 0.0)).angle_signed(p.to_2d(), 0.0) if p.to_2d().length > 1e-6 else 0.0
