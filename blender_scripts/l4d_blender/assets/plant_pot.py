"""A potted house plant with many bent leaves on stems.

Owns pot, soil and foliage. Knows nothing of the room; it stands on z = 0.
"""

from __future__ import annotations

import random
from math import cos, pi, sin

import bpy
from mathutils import Matrix, Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.scene import keys
from l4d_blender.scene.catalogue import colours, kind
from l4d_blender.scene.colour import Colour


@kind("plant", (0.261, 0.289, 0.248), "graspable", colour=colours("pot"))
def plant_pot(
    name: str,
    rng: random.Random,
    *,
    pot_radius_m: float = 0.052,
    pot_height_m: float = 0.085,
    leaves: int = 46,
    spread_m: float = 0.11,
    foliage: Colour = (0.045, 0.17, 0.045),
    pot: Colour = (0.46, 0.18, 0.085),
) -> bpy.types.Object:
    """A terracotta pot with a bush of oval leaves about as tall again as the pot."""
    r, h = pot_radius_m, pot_height_m
    clay = mesh.lathe(
        f"{name}_clay",
        [
            (0.66 * r, 0.0),
            (0.70 * r, 0.002),
            (0.90 * r, 0.74 * h),
            (0.92 * r, 0.76 * h),
            (1.0 * r, 0.765 * h),
            (1.02 * r, 0.985 * h),
            (1.0 * r, h),
            (0.93 * r, 0.985 * h),
            (0.90 * r, 0.80 * h),
        ],
        44,
    )
    mesh.set_material(clay, products.stoneware(f"{name}_terracotta", rng, colour=pot))
    earth = mesh.lathe(
        f"{name}_earth", [(0.905 * r, 0.86 * h), (0.5 * r, 0.90 * h), (0.0, 0.92 * h)], 24, close_bottom=False
    )
    mesh.set_material(earth, products.soil(f"{name}_soil", rng))

    green = products.leaf(f"{name}_leaf", foliage, rng)
    stem_green = products.leaf(f"{name}_stem", products.scaled(foliage, 1.5), rng)
    parts = [clay, earth]
    for k in range(leaves):
        azimuth = 2.39996 * k + rng.uniform(-0.3, 0.3)
        reach = spread_m * (0.15 + 0.85 * ((k + 0.5) / leaves) ** 0.6) * rng.uniform(0.85, 1.1)
        rise = h + spread_m * (1.25 - 0.95 * (k + 0.5) / leaves) * rng.uniform(0.85, 1.15)
        out = Vector((cos(azimuth), sin(azimuth), 0.0))
        tip = out * reach + Vector((0.0, 0.0, rise))
        root = out * 0.18 * r + Vector((0.0, 0.0, 0.9 * h))
        path = keys.Path([root, root.lerp(tip, 0.5) + Vector((0.0, 0.0, 0.25 * (rise - h))), tip])
        line = [path.point(path.length * step / 5) for step in range(6)]
        stem = mesh.tube(f"{name}_stem{k}", line, 0.0011, segments=5, cap=False)
        parts.append(mesh.set_material(stem, stem_green))
        size = rng.uniform(0.032, 0.052)
        droop = 0.25 + 0.9 * (k + 0.5) / leaves
        blade = _leaf(f"{name}_leaf{k}", size, 0.62 * size)
        turn = Matrix.Rotation(azimuth - 0.5 * pi + rng.uniform(-0.4, 0.4), 4, "Z") @ Matrix.Rotation(
            0.5 - droop, 4, "X"
        )
        mesh.transform(blade, Matrix.Translation(tip) @ turn)
        parts.append(mesh.set_material(blade, green))
    return mesh.join(name, parts)


def _leaf(name: str, length: float, width: float) -> bpy.types.Object:
    """An oval blade along +Y from its stalk at the origin, folded along the midrib and arched."""
    verts, faces = [], []
    rows = 8
    for j in range(rows + 1):
        t = j / rows
        half = 0.5 * width * max(sin(pi * t**0.85), 0.02)
        arch = 0.16 * length * sin(pi * t) - 0.10 * length * t
        for s in (-1.0, -0.5, 0.0, 0.5, 1.0):
            verts.append(Vector((half * s, length * t, arch + 0.35 * half * abs(s))))
    for j in range(rows):
        for i in range(4):
            a = 5 * j + i
            faces.append((a, a + 1, a + 6, a + 5))
    return mesh.from_pydata(name, verts, faces)
