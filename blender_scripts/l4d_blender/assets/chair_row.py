"""A row of moulded seats on one steel beam, as in stations and surgeries.

Owns the furniture and where its seats are; knows nothing of who sits there. The row runs along X, the seats
face -Y, feet on z = 0.
"""

from __future__ import annotations

import random
from math import cos, pi, sin

import bpy
from mathutils import Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.assets.parts import placed
from l4d_blender.scene.catalogue import colours, kind
from l4d_blender.scene.colour import Colour

PITCH_M = 0.60
SEAT_M = 0.45
_HALF_SEAT_M = 0.235
# Profile of the moulded shell from the front edge over the seat up the back: (y, z) in metres.
_PROFILE = (
    (-0.235, SEAT_M - 0.030),
    (-0.215, SEAT_M - 0.006),
    (-0.16, SEAT_M),
    (-0.02, SEAT_M - 0.006),
    (0.12, SEAT_M - 0.008),
    (0.185, SEAT_M + 0.012),
    (0.215, SEAT_M + 0.070),
    (0.235, SEAT_M + 0.20),
    (0.262, SEAT_M + 0.36),
    (0.275, SEAT_M + 0.40),
)


def seat_x(number: int, count: int) -> float:
    """Where the middle of a seat is along the row."""
    return (number - 0.5 * (count - 1)) * PITCH_M


@kind("chairs", (2.43, 0.52, 0.848), "seat", front="-y", colour=colours("shell"))
def chair_row(
    name: str, rng: random.Random, *, count: int = 4, shell: Colour = (0.05, 0.16, 0.28)
) -> bpy.types.Object:
    """`count` seats beside each other."""
    plastic = products.satin_plastic(f"{name}_shell", shell, rng, roughness=0.36)
    steel = products.metal(f"{name}_steel", (0.42, 0.43, 0.44), rng, roughness=0.3)
    dark = products.lacquer(f"{name}_dark", (0.045, 0.046, 0.05), rng)
    parts = [mesh.set_material(_seat(f"{name}_seat", seat_x(k, count)), plastic) for k in range(count)]
    length = count * PITCH_M
    beam = mesh.bevel_box(f"{name}_beam", (length, 0.06, 0.045), 0.006)
    parts.append(placed(beam, dark, y=0.04, z=SEAT_M - 0.085))
    for k in range(count):
        bracket = mesh.bevel_box(f"{name}_bracket", (0.06, 0.26, 0.03), 0.006)
        parts.append(placed(bracket, dark, x=seat_x(k, count), y=0.02, z=SEAT_M - 0.045))
    for x in (-0.5 * length + 0.30, 0.5 * length - 0.30):
        post = mesh.bevel_box(f"{name}_post", (0.05, 0.05, SEAT_M - 0.085), 0.006)
        foot = mesh.bevel_box(f"{name}_foot", (0.05, 0.46, 0.03), 0.010)
        parts += [placed(part, steel, x=x, y=0.04) for part in (post, foot)]
    for x in (-0.5 * length, 0.5 * length):
        arm = mesh.tube(
            f"{name}_arm",
            [
                (x, 0.05, SEAT_M - 0.07),
                (x, 0.13, SEAT_M + 0.16),
                (x, 0.08, SEAT_M + 0.20),
                (x, -0.16, SEAT_M + 0.20),
            ],
            0.013,
            segments=12,
        )
        parts.append(mesh.set_material(arm, steel))
    return mesh.join(name, parts)


def _seat(name: str, x: float) -> bpy.types.Object:
    """A shell with rounded upper corners whose sides are drawn up a little."""
    columns = 14
    verts = []
    for n, (y, z) in enumerate(_PROFILE):
        rise = n / (len(_PROFILE) - 1)
        half = _HALF_SEAT_M * (1.0 - 0.10 * rise - (0.18 if n == len(_PROFILE) - 1 else 0.0))
        for i in range(columns + 1):
            u = 2 * i / columns - 1
            lip = 0.018 * abs(u) ** 4 * sin(pi * min(rise * 1.6, 1.0))
            hollow = -0.008 * cos(0.5 * pi * u)
            verts.append(Vector((x + half * u, y - lip * (rise > 0.5), z + lip * (rise <= 0.5) + hollow)))
    row = columns + 1
    faces = [
        (j * row + i, j * row + i + 1, (j + 1) * row + i + 1, (j + 1) * row + i)
        for j in range(len(_PROFILE) - 1)
        for i in range(columns)
    ]
    sheet = mesh.subdivide(mesh.from_pydata(name, verts, faces), 1)
    return mesh.shade_smooth(mesh.solidify(sheet, 0.010, offset=-1.0), 50.0)
