"""A stand of reeds and bulrushes that grows out of shallow water. Scenery or landmark, one mesh."""

from __future__ import annotations

import math
import random
from collections.abc import Sequence

import bpy
from mathutils import Vector

from l4d_blender.scene.catalogue import kind

from . import mesh
from .materials import lakeside


@kind("reeds", (1.24, 1.35, 1.3))
def reeds(
    name: str,
    rng: random.Random,
    *,
    clumps: Sequence[tuple[float, float, float, int]] = ((0.0, 0.0, 0.4, 60),),
    foot_m: float = 0.0,
    height_m: tuple[float, float] = (0.75, 1.35),
) -> bpy.types.Object:
    """Clumps are (x, y, radius, blades) in world metres; blades are rooted at `foot_m`."""
    verts: list[Vector] = []
    faces: list[tuple[int, ...]] = []
    heads = []
    for cx, cy, radius, blades in clumps:
        for _ in range(blades):
            reach, way = radius * math.sqrt(rng.random()), rng.uniform(0.0, 2.0 * math.pi)
            root = Vector((cx + reach * math.cos(way), cy + reach * math.sin(way), foot_m))
            height, lean = rng.uniform(*height_m), rng.uniform(0.04, 0.34)
            heading = rng.uniform(0.0, 2.0 * math.pi)
            _blade(verts, faces, root, height, lean, heading, rng.uniform(0.010, 0.019))
            if rng.random() < 0.07:
                heads.append(_bulrush(f"{name}_bulrush", root, height * 0.9, 0.25 * lean, heading))
    stand = mesh.from_pydata(name, verts, faces, smooth=True)
    mesh.set_material(stand, lakeside.reed(f"{name}_blades"))
    return mesh.join(name, [stand, *heads])


def _blade(
    verts: list[Vector],
    faces: list[tuple[int, ...]],
    root: Vector,
    height_m: float,
    lean: float,
    heading: float,
    width_m: float,
) -> None:
    out = Vector((math.cos(heading), math.sin(heading), 0.0))
    side = Vector((-out.y, out.x, 0.0))
    first, stations = len(verts), 6
    for k in range(stations + 1):
        t = k / stations
        centre = root + height_m * (Vector((0, 0, t - 0.35 * lean * t**3)) + out * lean * t**2.4)
        half = 0.5 * width_m * (1.0 - t**2.5) + 0.0008
        verts += [centre - side * half, centre + side * half]
    for k in range(stations):
        a = first + 2 * k
        faces.append((a, a + 1, a + 3, a + 2))


def _bulrush(name: str, root: Vector, height_m: float, lean: float, heading: float) -> bpy.types.Object:
    out = Vector((math.cos(heading), math.sin(heading), 0.0))
    points = [root + height_m * (Vector((0, 0, t)) + out * lean * t * t) for t in (0.0, 0.5, 0.86, 1.0)]
    stalk = mesh.tube(f"{name}_stalk", points, [0.005, 0.004, 0.003, 0.002], segments=6)
    mesh.set_material(stalk, lakeside.reed(f"{name}_stalk"))
    low, high = points[2].lerp(points[1], 0.25), points[2].lerp(points[3], 0.35)
    head = mesh.tube(
        f"{name}_head",
        [low, low.lerp(high, 0.08), low.lerp(high, 0.92), high],
        [0.004, 0.013, 0.013, 0.004],
        segments=9,
    )
    return mesh.join(name, [stalk, mesh.set_material(head, lakeside.cattail(f"{name}_velvet"))])
