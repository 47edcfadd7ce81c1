"""A board with a cut loaf, slices and crumbs on one half; the other half is free.

Owns the shapes. The board lies on z = 0 along X, the bread is towards -X; things lie on it at `BOARD_M`.
"""

from __future__ import annotations

import random
from math import cos, pi, sin

import bpy
from mathutils import Matrix, Vector, noise

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products, tableware
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import kind

BOARD_M = 0.016


@kind("board", (0.36, 0.21, 0.083), "surface", "graspable")
def bread_board(
    name: str, rng: random.Random, *, size_m: tuple[float, float] = (0.36, 0.21)
) -> bpy.types.Object:
    """A board of (length, depth) with half a loaf."""
    wood = products.wood(
        f"{name}_wood", (0.33, 0.17, 0.075), (0.16, 0.075, 0.03), rng, grain_axis="X", stave_m=0.06
    )
    parts = Parts(name)
    parts.box("slab", wood, (*size_m, BOARD_M), 0.004, 3)
    skins = [tableware.crust(f"{name}_crust", rng), tableware.crumb(f"{name}_crumb", rng)]
    left = -0.5 * size_m[0]
    loaf = _loaf(f"{name}_loaf", rng, skins, 0.105)
    parts.add(loaf, within=Matrix.Translation((left + 0.075, 0.035, BOARD_M)) @ Matrix.Rotation(0.2, 4, "Z"))
    for k, (x, y, turn, tilt) in enumerate(
        ((left + 0.135, 0.030, 0.25, 1.15), (left + 0.190, 0.040, -0.30, 1.50))
    ):
        slice_ = _loaf(f"{name}_slice{k}", rng, skins, 0.013)
        pose = Matrix.Rotation(turn, 4, "Z") @ Matrix.Rotation(tilt, 4, "Y")
        mesh.drop_to_base(mesh.transform(slice_, pose))
        parts.add(slice_, x=x, y=y, z=BOARD_M)
    for _ in range(34):
        size = rng.uniform(0.0010, 0.0024)
        crumb = mesh.ellipsoid(f"{name}_bit", (size, 0.8 * size, 0.7 * size), 6, 4)
        parts.add(
            crumb,
            x=left + rng.uniform(0.02, 0.20),
            y=rng.uniform(-0.085, 0.085),
            z=BOARD_M + 0.6 * size,
            material=skins[rng.random() < 0.6],
        )
    return parts.join()


def _loaf(name: str, rng: random.Random, skins: list[bpy.types.Material], length: float) -> bpy.types.Object:
    """A piece of a loaf along X with cut faces; a whole end is rounded off at -X if it is long enough."""
    sections, shift = [], rng.uniform(-9, 9)
    steps = 14 if length > 0.03 else 3
    for k in range(steps + 1):
        t = k / steps
        x = length * (t - 0.5)
        fat = min(1.0, (sin(0.5 * pi * min(t / 0.55, 1.0)) ** 0.6 if length > 0.03 else 1.0) + 0.05)
        ring = []
        for j in range(36):
            a = 2 * pi * j / 36
            y, z = 0.047 * fat * cos(a), 0.034 * fat * (sin(a) + 0.92 if sin(a) > -0.75 else 0.17)
            lump = 1.0 + 0.05 * noise.noise(Vector((x * 30, 3 * cos(a), 3 * sin(a) + shift)))
            ring.append((x, y * lump, z * lump))
        sections.append(ring)
    piece = mesh.loft(name, sections)
    return mesh.paint(
        piece,
        skins,
        lambda centre, normal: int(
            (abs(normal.x) > 0.95 and centre.x > -0.3 * length) or (length < 0.03 and abs(normal.x) > 0.9)
        ),
    )
