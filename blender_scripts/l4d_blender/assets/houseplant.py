"""A potted plant: arching stems with pointed leaves in a ceramic pot."""

from __future__ import annotations

import math
import random

import bpy
from mathutils import Matrix, Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior
from l4d_blender.assets.materials.base import principled
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import Range, kind


@kind("plant", (0.987, 0.996, 0.894), height_m=Range("height_m", 0.4, 1.4))
def houseplant(
    name: str,
    rng: random.Random,
    *,
    height_m: float = 0.95,
    stems: int = 13,
    pot: tuple[float, float, float] = (0.58, 0.54, 0.47),
) -> bpy.types.Object:
    """A pot 0.27 m tall; leaves reach about `height_m`."""
    glaze = interior.ceramic(f"{name}_pot", pot, rng)
    soil = principled(
        f"{name}_soil",
        (0.06, 0.04, 0.03),
        roughness=1.0,
        variation=0.5,
        variation_scale=70,
        bump=(120, 0.006),
    )
    stalk = principled(f"{name}_stalk", (0.13, 0.22, 0.06), roughness=0.6, variation=0.3)
    greens = [
        interior.leaf(f"{name}_leaf{i}", colour, rng)
        for i, colour in enumerate(((0.055, 0.17, 0.035), (0.09, 0.24, 0.05), (0.14, 0.29, 0.07)))
    ]
    profile = [
        (0.0, 0.0),
        (0.105, 0.0),
        (0.115, 0.01),
        (0.15, 0.25),
        (0.158, 0.27),
        (0.146, 0.27),
        (0.138, 0.24),
        (0.0, 0.235),
    ]
    parts = Parts(name)
    parts.lathe("pot", glaze, profile, 40, close_bottom=False)
    parts.cylinder("soil", soil, 0.140, 0.01, 32, z=0.236)
    for k in range(stems):
        azimuth = 2 * math.pi * (k * 0.618) + rng.uniform(-0.2, 0.2)
        out = Vector((math.cos(azimuth), math.sin(azimuth), 0))
        reach, rise = rng.uniform(0.10, 0.30), (height_m - 0.25) * rng.uniform(0.55, 1.0)
        root = Vector((0, 0, 0.24)) + out * rng.uniform(0.01, 0.06)
        line = [
            root + out * (reach * t**1.8) + Vector((0, 0, rise * (t - 0.15 * t * t)))
            for t in (0.0, 0.25, 0.5, 0.75, 1.0)
        ]
        parts.tube("stem", stalk, line, [0.007, 0.006, 0.005, 0.004, 0.003], 6)
        for at, tangent, size in ((line[2], out, 0.75), (line[3], out, 0.9), (line[4], out, 1.0)):
            for turn in (rng.uniform(-0.9, -0.2), rng.uniform(0.2, 0.9)):
                leaf = _leaf(f"{name}_leaf", rng, size * rng.uniform(0.85, 1.15))
                heading = math.atan2(tangent.y, tangent.x) + turn
                place = (
                    Matrix.Translation(at)
                    @ Matrix.Rotation(heading, 4, "Z")
                    @ Matrix.Rotation(-rng.uniform(0.1, 0.9), 4, "Y")
                    @ Matrix.Rotation(0.6 * turn, 4, "X")
                )
                parts.add(leaf, rng.choice(greens), within=place)
    return parts.join()


def _leaf(name: str, rng: random.Random, size: float) -> bpy.types.Object:
    """A folded lance along +X that droops at its tip."""
    length, half = 0.21 * size, 0.034 * size
    droop = rng.uniform(0.25, 0.6)
    verts = []
    for i in range(8):
        t = i / 7
        width = half * math.sin(math.pi * min(1.0, 0.06 + 0.94 * t)) ** 0.8 * (1 - 0.35 * t)
        x, z = length * t, -droop * length * t * t
        verts += [(x, -width, z + 0.35 * width), (x, 0.0, z), (x, width, z + 0.35 * width)]
    faces = []
    for i in range(7):
        a, b = 3 * i, 3 * (i + 1)
        faces += [(a, b, b + 1, a + 1), (a + 1, b + 1, b + 2, a + 2)]
    return mesh.from_pydata(name, verts, faces)
