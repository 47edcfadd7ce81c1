"""A small football goal: white tubes and a knotted net that hangs a little.

Front = -Y, the mouth; the origin lies on the ground in the middle of the goal line.
"""

from __future__ import annotations

import math
import random

import bpy
from mathutils import Vector

from l4d_blender.scene.catalogue import kind

from . import mesh
from .materials import playground, products

_TUBE_M = 0.022


@kind("goal", (1.29, 0.588, 0.822), front="-y")
def goal(
    name: str, rng: random.Random, *, width_m: float = 1.25, height_m: float = 0.8, depth_m: float = 0.55
) -> bpy.types.Object:
    """Frame and net as one object."""
    white = products.lacquer(f"{name}_white", playground.PAINTS["white"], rng)
    half, top = width_m / 2, height_m
    back_y, crown_y = depth_m, 0.42 * depth_m
    parts = []
    for s in (-1, 1):
        side = [(s * half, 0.0, 0.0), (s * half, 0.0, top)]
        stay = [(s * half, 0.0, top), (s * half, crown_y, top * 0.97), (s * half, back_y, _TUBE_M)]
        base = [(s * half, 0.0, _TUBE_M), (s * half, back_y, _TUBE_M)]
        for line, radius in ((side, _TUBE_M), (stay, 0.7 * _TUBE_M), (base, 0.7 * _TUBE_M)):
            parts.append(mesh.tube(f"{name}_pipe", line, radius, 12))
    parts.append(mesh.tube(f"{name}_bar", [(-half, 0.0, top), (half, 0.0, top)], _TUBE_M, 12))
    parts.append(mesh.tube(f"{name}_sill", [(-half, back_y, _TUBE_M), (half, back_y, _TUBE_M)], 0.016, 12))
    frame = mesh.set_material(mesh.join(f"{name}_frame", parts), white)
    net = mesh.join(f"{name}_net", _net(f"{name}_twine", rng, half, top, crown_y, back_y))
    mesh.set_material(net, products.satin_plastic(f"{name}_twine", (0.62, 0.62, 0.58), rng, roughness=0.7))
    return mesh.join(name, [frame, net])


def _net(
    name: str, rng: random.Random, half: float, top: float, crown_y: float, back_y: float
) -> list[bpy.types.Object]:
    """Twine over roof, back and both sides."""
    profile = [Vector((0.0, 0.0, top)), Vector((0.0, crown_y, 0.97 * top)), Vector((0.0, back_y, 0.02))]
    lengths = [(b - a).length for a, b in zip(profile, profile[1:])]
    rows = round(sum(lengths) / 0.10)
    phase = rng.uniform(0.0, 6.28)

    def sheet(x: float, t: float) -> Vector:
        """The net over roof and back: t 0..1 from the bar to the ground."""
        way = t * sum(lengths)
        first = way < lengths[0]
        a, b = profile[0 if first else 1], profile[1 if first else 2]
        point = a.lerp(b, way / lengths[0] if first else (way - lengths[0]) / lengths[1])
        sag = 0.035 * math.sin(math.pi * t) * (1.0 + 0.4 * math.sin(7.0 * x + phase))
        return point + Vector((x, 0.35 * sag, -sag))

    lines = []
    columns = round(2 * half / 0.10)
    for k in range(1, columns):
        x = half * (2 * k / columns - 1)
        lines.append([sheet(x, j / 9) for j in range(10)])
    for j in range(1, rows):
        lines.append([sheet(half * (k / 4 - 1), j / rows) for k in range(9)])
    for s in (-1, 1):
        for k in range(1, 8):
            z = top * k / 8
            end = crown_y + (back_y - crown_y) * (1.0 - z / (0.97 * top)) if z < 0.97 * top else crown_y
            lines.append(
                [
                    Vector((s * half, 0.0, z)),
                    Vector((s * (half - 0.02), end / 2, z - 0.015)),
                    Vector((s * half, end, z)),
                ]
            )
        for k in range(1, 5):
            y = back_y * k / 5
            roof = 0.97 * top if y < crown_y else 0.97 * top * (back_y - y) / (back_y - crown_y)
            lines.append(
                [
                    Vector((s * half, y, 0.02)),
                    Vector((s * (half - 0.015), y, roof / 2)),
                    Vector((s * half, y, roof)),
                ]
            )
    return [mesh.tube(name, line, 0.0035, 4, cap=False) for line in lines]
