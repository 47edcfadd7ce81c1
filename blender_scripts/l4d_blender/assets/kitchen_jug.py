"""A stout enamelled jug with its lip at -X and its handle at +X, and the stream that leaves it."""

from __future__ import annotations

import random
from math import atan2, cos, exp, pi, sin

import bpy
from mathutils import Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import kitchen
from l4d_blender.assets.materials.base import principled
from l4d_blender.scene.catalogue import colours, kind

HEIGHT_M = 0.23
LIP = (-0.104, 0.0, 0.236)
GRIP = (0.122, 0.0, 0.135)
STREAM_RADIUS_M = 0.0150

_PROFILE = (
    (0.072, 0.000), (0.078, 0.008), (0.083, 0.030), (0.084, 0.070), (0.079, 0.120), (0.069, 0.165),
    (0.064, 0.190), (0.066, 0.212), (0.071, 0.230),
)  # fmt: skip


@kind("jug", (0.24, 0.168, 0.241), "graspable", "pours", "container", front="-x", colour=colours("colour"))
def kitchen_jug(
    name: str, rng: random.Random, *, colour: tuple[float, float, float] = (0.66, 0.63, 0.54)
) -> bpy.types.Object:
    """The jug, standing on its base."""
    wall = 0.0035
    rim_r, rim_z = _PROFILE[-1]
    inner = [(r - wall, z) for r, z in reversed(_PROFILE[1:])]
    profile = [
        *_PROFILE,
        (rim_r + 0.002, rim_z + 0.003),
        (rim_r - 0.002, rim_z + 0.004),
        *inner,
        (0.0, 0.012),
    ]
    body = mesh.lathe(f"{name}_body", profile, segments=56)
    mesh.displace(body, _spout)
    skin = kitchen.enamel(f"{name}_enamel", colour, rng)
    trim = principled(f"{name}_trim", (0.03, 0.06, 0.17), roughness=0.2, variation=0.15)
    mesh.paint(
        body, (skin, trim), lambda centre, normal: 1 if centre.z > rim_z - 0.008 or centre.z < 0.012 else 0
    )
    curve = [
        (0.062, 0.0, 0.206), (0.086, 0.0, 0.213), (0.110, 0.0, 0.203), (0.121, 0.0, 0.175),
        (0.122, 0.0, 0.135), (0.117, 0.0, 0.098), (0.101, 0.0, 0.072), (0.079, 0.0, 0.062),
    ]  # fmt: skip
    bar = mesh.tube(f"{name}_handle", curve, [(0.013, 0.007)] * len(curve), segments=14)
    return mesh.join(name, [body, mesh.set_material(bar, trim)])


def _spout(position: Vector, normal: Vector) -> Vector:
    """Pulls the rim out to a lip at -X and pinches it."""
    turn = abs(atan2(position.y, -position.x))
    high = max(0.0, (position.z - 0.155) / (HEIGHT_M - 0.155)) ** 1.6
    pull = high * exp(-((turn / 0.42) ** 2))
    pinch = high * exp(-(((turn - 0.75) / 0.30) ** 2))
    out = Vector((position.x, position.y, 0.0)).normalized()
    return out * (0.036 * pull - 0.007 * pinch) + Vector((0.0, 0.0, 0.006 * pull))


def stream(name: str, *, colour: tuple[float, float, float]) -> bpy.types.Object:
    """One metre of falling liquid below its origin, to be scaled in Z to the fall; 3 cm wide throughout."""
    rows, sides = 24, 16
    verts = []
    for j in range(rows + 1):
        t = j / rows
        radius = STREAM_RADIUS_M * (1.0 - 0.10 * t + 0.05 * sin(9.0 * pi * t))
        bow = -0.022 * (1.0 - (1.0 - t) ** 2)
        for i in range(sides):
            a = 2 * pi * i / sides
            verts.append((bow + radius * cos(a), 1.05 * radius * sin(a), -t))
    faces: list[tuple[int, ...]] = [
        (j * sides + i, (j + 1) * sides + i, (j + 1) * sides + (i + 1) % sides, j * sides + (i + 1) % sides)
        for j in range(rows)
        for i in range(sides)
    ]
    faces += [tuple(range(sides)), tuple(reversed(range(rows * sides, (rows + 1) * sides)))]
    body = mesh.from_pydata(name, verts, faces)
    return mesh.set_material(body, kitchen.poured(f"{name}_liquid", colour))
