"""A post-and-rail fence along a line, hand-split and a little askew, and a field gate."""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Sequence

import bpy
from mathutils import Matrix, Vector, noise

from l4d_blender.scene.catalogue import kind

from . import mesh
from .materials import outdoors
from .parts import Parts

Height = Callable[[float, float], float]


def _rough(part: bpy.types.Object, rng: random.Random, amount: float) -> bpy.types.Object:
    shift = Vector([rng.uniform(-9, 9) for _ in range(3)])
    return mesh.displace(part, lambda p, _: amount * noise.noise(p * 4.0 + shift))


@kind("fence", (4.16, 0.19, 1.35))
def fence(
    name: str,
    rng: random.Random,
    *,
    line: Sequence[tuple[float, float]] = ((-2.0, 0.0), (2.0, 0.0)),
    height: Height = lambda x, y: 0.0,
    post_m: float = 1.15,
    spacing_m: float = 1.7,
    rails: int = 3,
) -> bpy.types.Object:
    """Posts and rails along a polyline in world coordinates, standing on `height(x, y)`."""
    feet: list[Vector] = []
    for (ax, ay), (bx, by) in zip(line, line[1:], strict=False):
        length = math.hypot(bx - ax, by - ay)
        count = max(1, round(length / spacing_m))
        for k in range(count if (bx, by) != line[-1] else count + 1):
            x = ax + (bx - ax) * k / count + rng.uniform(-0.05, 0.05)
            y = ay + (by - ay) * k / count + rng.uniform(-0.05, 0.05)
            feet.append(Vector((x, y, height(x, y))))
    parts, tops = [], []
    for foot in feet:
        lean = (
            Vector((rng.uniform(-0.05, 0.05), rng.uniform(-0.05, 0.05), 1.0))
            * post_m
            * rng.uniform(0.95, 1.06)
        )
        tops.append(lean)
        thick = rng.uniform(0.055, 0.07)
        stations = [
            foot - Vector((0, 0, 0.15)),
            foot + 0.3 * lean,
            foot + 0.7 * lean,
            foot + 0.985 * lean,
            foot + lean,
        ]
        post = mesh.tube(
            f"{name}_post", stations, [thick * 1.1, thick, thick * 0.95, thick * 0.9, thick * 0.6], segments=9
        )
        parts.append(_rough(post, rng, 0.02))
    for k in range(len(feet) - 1):
        for rail in range(rails):
            share = 0.24 + 0.62 * rail / max(1, rails - 1)
            ends = []
            for foot, top in ((feet[k], tops[k]), (feet[k + 1], tops[k + 1])):
                ends.append(foot + top * (share + rng.uniform(-0.025, 0.025)))
            way = (ends[1] - ends[0]).normalized()
            ends = [ends[0] - 0.10 * way, ends[1] + 0.10 * way]
            sag = ends[0].lerp(ends[1], 0.5) - Vector((0, 0, rng.uniform(0.0, 0.03)))
            thick = rng.uniform(0.030, 0.040)
            stations = [ends[0], ends[0].lerp(sag, 0.5), sag, sag.lerp(ends[1], 0.5), ends[1]]
            bar = mesh.tube(f"{name}_rail", stations, [(thick * 0.7, thick * 1.2)] * 5, segments=8)
            parts.append(_rough(bar, rng, 0.012))
    whole = mesh.join(name, parts)
    return mesh.set_material(whole, outdoors.weathered_wood(f"{name}_wood", (0.215, 0.185, 0.150)))


@kind("gate", (2.4, 0.1, 1.1), "opens", front="-y")
def gate(name: str, rng: random.Random, *, width_m: float = 2.4, height_m: float = 1.15) -> bpy.types.Object:
    """A five-bar field gate along +X from its hinge at the origin."""
    parts = Parts(name)
    for k in range(5):
        bar = mesh.bevel_box(f"{name}_bar", (width_m, 0.03, 0.075), 0.008, 1)
        parts.add(bar, x=width_m / 2, z=0.16 + (height_m - 0.28) * k / 4)
    for x in (0.05, width_m / 2, width_m - 0.05):
        parts.add(mesh.bevel_box("stile", (0.085, 0.05, height_m - 0.05), 0.008, 1), x=x, y=-0.03, z=0.10)
    rise = height_m - 0.3
    parts.add(
        mesh.bevel_box("brace", (math.hypot(width_m - 0.1, rise), 0.03, 0.07), 0.008, 1),
        within=Matrix.Translation((width_m / 2, 0.03, 0.18 + rise / 2))
        @ Matrix.Rotation(-math.atan2(rise, width_m), 4, "Y"),
    )
    whole = parts.join()
    return mesh.set_material(
        whole, outdoors.weathered_wood(f"{name}_wood", (0.23, 0.195, 0.155), grain_axis="X")
    )
