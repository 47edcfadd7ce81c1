"""A stuffed toy mouse for cats: round felt body, big ears, cord tail, button eyes."""

from __future__ import annotations

import math
import random

import bpy
from mathutils import Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior
from l4d_blender.assets.materials.base import principled
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import colours, kind


@kind("toy", (0.173, 0.271, 0.132), "graspable", front="-y", colour=colours("colour"))
def toy_mouse(
    name: str,
    rng: random.Random,
    *,
    length_m: float = 0.2,
    colour: tuple[float, float, float] = (0.105, 0.107, 0.115),
) -> bpy.types.Object:
    """`length_m` without the tail; the nose points to -Y."""
    s = length_m / 0.20
    plush = interior.felt(f"{name}_plush", colour, rng)
    pink = interior.felt(f"{name}_lining", (0.62, 0.26, 0.26), rng)
    black = principled(f"{name}_button", (0.01, 0.01, 0.01), roughness=0.2)
    cord = interior.wool(f"{name}_cord", (0.58, 0.28, 0.27), rng)
    sections = []
    for i in range(13):
        t = i / 12
        radius = s * 0.054 * (math.sin(math.pi * min(1.0, 0.015 + 0.985 * t) ** 0.72) ** 0.75 + 0.03)
        y = s * (0.10 - 0.20 * (1 - t))
        sections.append(
            [
                Vector(
                    (radius * math.cos(a), y, s * 0.050 + 0.92 * radius * math.sin(a) - s * 0.006 * (1 - t))
                )
                for a in (2 * math.pi * k / 20 for k in range(20))
            ]
        )
    parts = Parts(name)
    parts.add(mesh.subdivide(mesh.loft("body", sections), 1), plush)
    for side in (-1, 1):
        ear = mesh.ellipsoid(f"{name}_ear", (s * 0.030, s * 0.006, s * 0.031), 20, 12)
        lining = mesh.move(
            mesh.ellipsoid(f"{name}_lining", (s * 0.021, s * 0.004, s * 0.022), 16, 10), y=-s * 0.0035
        )
        both = mesh.join(f"{name}_ear", [mesh.set_material(ear, plush), mesh.set_material(lining, pink)])
        both = mesh.rotate(mesh.rotate(both, "X", -14), "Z", 24 * side)
        parts.add(both, x=side * s * 0.036, y=-s * 0.028, z=s * 0.098)
        parts.ellipsoid(
            "eye", black, (s * 0.0075,) * 3, 12, 8, centre=(side * s * 0.021, -s * 0.074, s * 0.068)
        )
    parts.ellipsoid("nose", pink, (s * 0.010, s * 0.009, s * 0.009), 12, 8, centre=(0, -s * 0.101, s * 0.046))
    line = [
        (0, s * 0.095, s * 0.03),
        (s * 0.012, s * 0.125, s * 0.012),
        (s * 0.045, s * 0.155, s * 0.008),
        (s * 0.085, s * 0.150, s * 0.008),
        (s * 0.105, s * 0.120, s * 0.008),
    ]
    parts.tube("tail", cord, line, [s * r for r in (0.008, 0.0075, 0.007, 0.0065, 0.006)], 8)
    return mesh.drop_to_base(parts.join())
