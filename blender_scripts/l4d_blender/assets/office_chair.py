"""An upholstered swivel chair.

Owns the chair; knows nothing of who sits on it. The seat faces -Y; the castors stand on z = 0.
"""

from __future__ import annotations

import random
from math import cos, pi, sin

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import colours, kind
from l4d_blender.scene.colour import Colour

SEAT_M = 0.46


@kind("chair", (0.581, 0.623, 0.973), "seat", front="-y", colour=colours("cloth"))
def office_chair(name: str, rng: random.Random, *, cloth: Colour = (0.09, 0.1, 0.12)) -> bpy.types.Object:
    """A chair with a seat at `SEAT_M` and a back up to 0.98 m."""
    cover = products.woven_cloth(f"{name}_cover", cloth, rng, threads_per_m=320.0)
    shell = products.satin_plastic(f"{name}_shell", (0.03, 0.03, 0.032), rng)
    steel = products.metal(f"{name}_steel", (0.45, 0.45, 0.46), rng)
    seat = mesh.move(mesh.bevel_box(f"{name}_seat", (0.48, 0.46, 0.09), 0.035, segments=4), z=SEAT_M - 0.09)
    back = mesh.move(mesh.bevel_box(f"{name}_back", (0.44, 0.07, 0.50), 0.033, segments=4), z=SEAT_M + 0.02)
    mesh.move(mesh.rotate(back, "X", -7.0), y=0.17)
    parts = Parts(name)
    parts.add(seat, cover)
    parts.add(back, cover)
    parts.cylinder("post", steel, 0.028, 0.30, 20, z=0.08)
    for k in range(5):
        a = 2 * pi * k / 5
        parts.tube("leg", shell, [(0.0, 0.0, 0.10), (0.29 * cos(a), 0.29 * sin(a), 0.065)], [0.024, 0.016])
        parts.ellipsoid("castor", shell, (0.028, 0.028, 0.028), 14, 10, (0.29 * cos(a), 0.29 * sin(a), 0.028))
    return parts.join()
