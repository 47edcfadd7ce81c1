"""A low fence of painted pickets between square posts, as round kindergartens and playgrounds."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Sequence

import bpy
from mathutils import Matrix

from l4d_blender.scene.catalogue import kind

from . import mesh
from .materials import playground, products

Height = Callable[[float, float], float]


@kind("fence", (4.09, 0.086, 0.97))
def picket_fence(
    name: str,
    rng: random.Random,
    *,
    line: Sequence[tuple[float, float]] = ((-2.0, 0.0), (2.0, 0.0)),
    colours: Sequence[str] = ("white",),
    height: Height = lambda x, y: 0.0,
    height_m: float = 0.85,
    spacing_m: float = 0.155,
) -> bpy.types.Object:
    """Pickets along a polyline in world coordinates; colours are names of materials.playground.PAINTS."""
    paints = [
        products.satin_plastic(f"{name}_{c}", playground.PAINTS[c], rng, roughness=0.6) for c in colours
    ]
    rail_paint = products.satin_plastic(f"{name}_rail", (0.44, 0.33, 0.21), rng, roughness=0.7)
    parts = []
    count = 0
    for (ax, ay), (bx, by) in zip(line, line[1:]):
        length, turn = math.hypot(bx - ax, by - ay), math.atan2(by - ay, bx - ax)
        number = max(2, round(length / spacing_m))
        for k in range(number):
            t = (k + 0.5) / number
            x, y = ax + (bx - ax) * t, ay + (by - ay) * t
            tall = height_m * rng.uniform(0.97, 1.02)
            picket = mesh.bevel_box(f"{name}_picket", (0.082, 0.020, tall), 0.018, 2)
            tilt = Matrix.Rotation(rng.uniform(-0.015, 0.015), 4, "Y")
            mesh.transform(
                picket, Matrix.Translation((x, y, height(x, y) + 0.05)) @ Matrix.Rotation(turn, 4, "Z") @ tilt
            )
            parts.append(mesh.set_material(picket, paints[count % len(paints)]))
            count += 1
        for z in (0.24, 0.66):
            rail = mesh.bevel_box(f"{name}_rail", (length, 0.035, 0.07), 0.006, 1)
            mid = ((ax + bx) / 2, (ay + by) / 2)
            low = min(height(ax, ay), height(bx, by))
            mesh.transform(
                rail,
                Matrix.Translation((*mid, low + z * height_m / 0.85))
                @ Matrix.Rotation(turn, 4, "Z")
                @ Matrix.Translation((0.0, 0.026, 0.0)),
            )
            parts.append(mesh.set_material(rail, rail_paint))
        for t in (0.0, 0.5, 1.0):
            x, y = ax + (bx - ax) * t, ay + (by - ay) * t
            post = mesh.bevel_box(f"{name}_post", (0.085, 0.085, height_m + 0.12), 0.010, 2)
            mesh.transform(
                post, Matrix.Translation((x, y, height(x, y) - 0.05)) @ Matrix.Rotation(turn, 4, "Z")
            )
            parts.append(mesh.set_material(post, rail_paint))
    return mesh.join(name, parts)
