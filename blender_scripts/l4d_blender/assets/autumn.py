"""Autumn: trees in yellow and rust, and what has fallen from them. Scenery only."""

from __future__ import annotations

import math
import random
from collections.abc import Callable

import bpy
from mathutils import Vector

from l4d_blender.scene.catalogue import kind

from ..scene.colour import Colour, rgb
from . import mesh
from .ground import LEVEL, Terrain
from .materials import outdoors

TONES: tuple[Colour, ...] = ((0.42, 0.24, 0.030), (0.36, 0.115, 0.020), (0.20, 0.18, 0.035))


def turned(tree: bpy.types.Object, tone: Colour) -> bpy.types.Object:
    """Gives a tree or bush of assets/tree.py leaves of another colour."""
    for slot in tree.material_slots:
        if "leaves" in slot.material.name:
            slot.material = outdoors.leaves(f"{tree.name}_leaves_turned", tone)
        elif "mass" in slot.material.name:
            slot.material = outdoors.foliage_mass(f"{tree.name}_mass_turned", rgb(0.5 * c for c in tone))
    return tree


@kind("leaves", (11.9, 11.7, 0.07), "backdrop")
def fallen_leaves(
    name: str,
    rng: random.Random,
    *,
    terrain: Terrain = LEVEL,
    count: int = 400,
    radius_m: float = 6.0,
    keep: Callable[[float, float], float] = lambda x, y: 1.0,
) -> bpy.types.Object:
    """Curled leaves strewn over the ground, in drifts."""
    verts: list[Vector] = []
    faces: list[tuple[int, ...]] = []
    while len(verts) < 5 * count:
        r, way = radius_m * math.sqrt(rng.random()), rng.uniform(0.0, 2.0 * math.pi)
        x, y = r * math.cos(way), r * math.sin(way)
        drift = 0.5 + 0.5 * math.sin(1.3 * x + 0.7 * y) * math.sin(0.9 * y - 0.4 * x)
        if rng.random() > (0.25 + 0.75 * drift) * keep(x, y):
            continue
        size, turn, curl = rng.uniform(0.022, 0.045), rng.uniform(0.0, 6.3), rng.uniform(0.15, 0.5)
        c, s, z = math.cos(turn), math.sin(turn), terrain.height(x, y) + 0.006
        first = len(verts)
        for u, v, lift in ((-1, 0, 0.5), (0, -0.7, 0.2), (1.1, 0, 0.7), (0, 0.7, 0.3), (0, 0, 0.0)):
            at = Vector((x + size * (c * u - s * v), y + size * (s * u + c * v), z + size * curl * lift))
            verts.append(at + Vector((0.0, 0.0, 0.02 * rng.random())))
        faces += [(first + 4, first + k, first + (k + 1) % 4) for k in range(4)]
    litter = mesh.from_pydata(name, verts, faces, smooth=False)
    return mesh.set_material(litter, outdoors.leaves(f"{name}_leaves", (0.34, 0.155, 0.030)))
