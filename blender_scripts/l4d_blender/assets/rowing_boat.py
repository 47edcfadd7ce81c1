"""A clinker rowing boat with thwarts and shipped oars. Bow at -Y; the waterline is z = 0."""

from __future__ import annotations

import math
import random

import bpy
from mathutils import Matrix, Vector

from l4d_blender.scene.catalogue import colours, kind

from ..scene.colour import Colour
from . import mesh
from .materials import lakeside, outdoors

LENGTH_M = 2.7
STRAKES, STATIONS = 7, 26


def _half_beam(t: float) -> float:
    """Half width at the gunwale, t from the bow (0) to the transom (1)."""
    return (
        0.56
        * min(1.0, math.sin(0.5 * math.pi * min(1.0, t / 0.62)) ** 0.8)
        * (1.0 - 0.30 * max(0, t - 0.62) / 0.38)
    )


def _sheer(t: float) -> float:
    return 0.30 + 0.16 * (1.0 - min(t, 1.0)) ** 2.2 + 0.05 * t * t


@kind("boat", (1.14, 2.71, 0.609), "swims", front="-y", colour=colours("colour"))
def rowing_boat(
    name: str, rng: random.Random, *, colour: Colour = (0.62, 0.6, 0.54), trim: Colour = (0.04, 0.13, 0.24)
) -> bpy.types.Object:
    """The hull as overlapping strakes, thwarts across, a pair of oars laid along."""
    verts: list[Vector] = []
    faces: list[tuple[int, ...]] = []
    per_row = 2 * STRAKES * 2
    for i in range(STATIONS + 1):
        t = i / STATIONS
        y, half, top = LENGTH_M * (t - 0.5), max(0.012, _half_beam(t)), _sheer(t)
        keel = -0.14 + 0.42 * (1.0 - min(1.0, t / 0.16)) ** 2.0
        row = []
        for k in range(STRAKES):
            for end in (0.0, 1.0):
                u = (k + end) / STRAKES
                angle = 0.5 * math.pi * u
                lap = 0.012 * (1.0 - end)
                row.append((half * math.sin(angle) ** 0.75 + lap, keel + (top - keel) * u**1.7))
        verts += [Vector((-x, y, z)) for x, z in reversed(row)] + [Vector((x, y, z)) for x, z in row]
    for i in range(STATIONS):
        for k in range(per_row - 1):
            a = i * per_row + k
            faces.append((a, a + 1, a + 1 + per_row, a + per_row))
    last = STATIONS * per_row
    faces.append(tuple(range(last, last + per_row)))
    hull = mesh.from_pydata(f"{name}_hull", verts, faces, smooth=False)
    mesh.solidify(hull, 0.016, offset=0.0)
    paint, inside = (
        lakeside.boat_paint(f"{name}_paint", colour),
        lakeside.boat_paint(f"{name}_inside", (0.34, 0.22, 0.12)),
    )
    band = lakeside.boat_paint(f"{name}_trim", trim)

    def choose(centre: Vector, normal: Vector) -> int:
        outward = normal.x * centre.x + 0.4 * normal.y * centre.y - 0.15 * normal.z
        if outward < 0.0:
            return 1
        return 2 if centre.z > 0.80 * _sheer(centre.y / LENGTH_M + 0.5) else 0

    mesh.paint(hull, [paint, inside, band], choose)
    parts = [hull]
    wood = outdoors.weathered_wood(f"{name}_thwart", (0.30, 0.20, 0.115), grain_axis="X")
    for t, width in ((0.22, 0.20), (0.50, 0.22), (0.86, 0.30)):
        beam = mesh.bevel_box(f"{name}_thwart", (2.0 * _half_beam(t) - 0.05, width, 0.028), 0.006, 2)
        mesh.move(beam, y=LENGTH_M * (t - 0.5), z=0.17)
        parts.append(mesh.set_material(beam, wood))
    for side in (-1.0, 1.0):
        parts.append(_oar(f"{name}_oar", side))
    return mesh.join(name, parts)


def _oar(name: str, side: float) -> bpy.types.Object:
    shaft = mesh.tube(f"{name}_shaft", [(0, -0.95, 0), (0, 0.62, 0)], [0.017, 0.022], segments=10)
    blade = mesh.tube(
        f"{name}_blade",
        [(0, 0.58, 0), (0, 0.68, 0), (0, 1.0, 0), (0, 1.06, 0)],
        [(0.02, 0.012), (0.055, 0.008), (0.065, 0.006), (0.03, 0.004)],
        segments=12,
        up=(0, 0, 1),
    )
    oar = mesh.join(name, [shaft, blade])
    mesh.transform(oar, Matrix.Translation((side * 0.16, 0.02, 0.222)) @ Matrix.Rotation(side * 0.05, 4, "Z"))
    return mesh.set_material(oar, outdoors.turned_wood(f"{name}_ash"))
