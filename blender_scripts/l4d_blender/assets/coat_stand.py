"""A stand with coats and a hat on its hooks."""

from __future__ import annotations

import random
from math import cos, pi, sin

import bpy
from mathutils import Matrix

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior, products
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import kind

COATS = ((0.10, 0.14, 0.22), (0.34, 0.20, 0.09), (0.30, 0.05, 0.05), (0.10, 0.20, 0.13), (0.45, 0.40, 0.32))


@kind("coat_stand", (0.477, 0.466, 1.8), front=None)
def coat_stand(name: str, rng: random.Random, *, coats: int = 2) -> bpy.types.Object:
    """A turned pole on four feet with six hooks."""
    wood = interior.wood(
        f"{name}_wood", rng.choice(((0.20, 0.10, 0.05), (0.42, 0.27, 0.13))), rng, grain_axis="Z"
    )
    parts = Parts(name)
    parts.lathe(
        "pole", wood, [(0.03, 0.03), (0.022, 0.4), (0.028, 0.9), (0.02, 1.7), (0.03, 1.76), (0.0, 1.8)], 16
    )
    for k in range(4):
        a = pi / 4 + k * pi / 2
        line = [(0.0, 0.0, 0.16), (0.14 * cos(a), 0.14 * sin(a), 0.12), (0.29 * cos(a), 0.29 * sin(a), 0.012)]
        parts.tube("foot", wood, line, [0.02, 0.018, 0.014], 8)
    for k in range(6):
        a = k * pi / 3
        line = [(0.0, 0.0, 1.62), (0.10 * cos(a), 0.10 * sin(a), 1.60), (0.14 * cos(a), 0.14 * sin(a), 1.70)]
        parts.tube("hook", wood, line, 0.009, 8)
    for k, hook in enumerate(rng.sample(range(6), coats)):
        cloth = interior.cloth(f"{name}_coat_{k}", rng.choice(COATS), rng)
        parts.add(_coat(f"{name}_coat_{k}", rng, hook * pi / 3), cloth)
    if rng.random() < 0.6:
        felt = products.rubber(f"{name}_hat", rng.choice(COATS), rng)
        hat = mesh.lathe(
            f"{name}_hat",
            [(0.14, 0.0), (0.145, 0.008), (0.09, 0.014), (0.085, 0.09), (0.05, 0.11), (0.0, 0.10)],
            24,
        )
        parts.add(hat, felt, z=1.77)
    return parts.join()


def _coat(name: str, rng: random.Random, angle: float) -> bpy.types.Object:
    """A coat hanging from one hook: narrow above, wide and folded below."""
    phase, length = rng.uniform(0, 6), rng.uniform(0.75, 1.0)
    sections = []
    for share in (0.0, 0.06, 0.15, 0.4, 0.7, 1.0):
        wide, deep = 0.06 + 0.14 * min(1.0, share * 5), 0.03 + 0.06 * min(1.0, share * 3)
        ring = []
        for i in range(24):
            a = 2 * pi * i / 24
            fold = 1.0 + 0.16 * share * sin(5 * a + phase)
            ring.append((deep * fold * cos(a) + 0.11, wide * fold * sin(a), 1.66 - share * length))
        sections.append(ring)
    return mesh.transform(mesh.shade_smooth(mesh.loft(name, sections)), Matrix.Rotation(angle, 4, "Z"))
