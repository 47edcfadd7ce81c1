"""A pair of reading glasses that lies folded open on its temples, lenses left out (no glass in these scenes).

Owns the frame. It lies on z = 0, the lenses to -Y.
"""

from __future__ import annotations

import random
from math import cos, pi, sin

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.colour import Colour


@kind("glasses", (0.14, 0.143, 0.047), "graspable")
def glasses(name: str, rng: random.Random, *, shell: Colour = (0.1, 0.045, 0.018)) -> bpy.types.Object:
    """A horn-rimmed frame 14 cm wide."""
    horn = products.satin_plastic(f"{name}_horn", shell, rng, roughness=0.25)
    parts = []
    for side in (-1.0, 1.0):
        rim = [
            (side * 0.034 + 0.027 * cos(a), 0.002 * cos(a) ** 2, 0.024 + 0.0205 * sin(a))
            for a in (2 * pi * k / 36 for k in range(36))
        ]
        parts.append(mesh.tube(f"{name}_rim", rim, 0.0023, segments=8, closed=True))
        temple = [
            (side * 0.061, 0.003, 0.034),
            (side * 0.067, 0.010, 0.034),
            (side * 0.068, 0.060, 0.022),
            (side * 0.067, 0.100, 0.010),
            (side * 0.062, 0.128, 0.0028),
            (side * 0.058, 0.138, 0.0030),
        ]
        parts.append(mesh.tube(f"{name}_temple", temple, [0.0026, 0.0028, 0.0022, 0.0022, 0.0026, 0.0022], 8))
    bridge = [(-0.0085, 0.001, 0.030), (0.0, -0.002, 0.0335), (0.0085, 0.001, 0.030)]
    parts.append(mesh.tube(f"{name}_bridge", bridge, 0.0022, 8))
    return mesh.drop_to_base(mesh.set_material(mesh.join(name, parts), horn))
