"""A small wooden rocking chair for a doll or a bear. Front = -Y; it stands level on its runners at z = 0.

Owns the shape and how it rolls on its runners (`rocked`).
"""

from __future__ import annotations

import random
from math import cos, sin

import bpy
from mathutils import Matrix

from l4d_blender.scene.catalogue import colours, kind

from . import mesh
from .materials import interior

SEAT_M = 0.175
SEAT_Y_M = 0.005
RUNNER_RADIUS_M = 0.42

_HALF_M = 0.135


def rocked(angle: float) -> Matrix:
    """Where the chair is, relative to level, when it leans forward by an angle: runners roll, not slide."""
    return (
        Matrix.Translation((0.0, -RUNNER_RADIUS_M * angle, RUNNER_RADIUS_M))
        @ Matrix.Rotation(angle, 4, "X")
        @ Matrix.Translation((0.0, 0.0, -RUNNER_RADIUS_M))
    )


@kind("chair", (0.304, 0.5, 0.494), "seat", "rocks", front="-y", colour=colours("colour"))
def rocking_chair(name: str, rng: random.Random, *, colour: tuple = (0.42, 0.22, 0.09)) -> bpy.types.Object:
    """The chair as one object."""
    wood = interior.wood(f"{name}_wood", colour, rng, grain_axis="Z")
    plank = interior.wood(f"{name}_plank", colour, rng, grain_axis="X")
    parts = []
    for s in (-1, 1):
        angles = [-0.62 + 1.24 * k / 18 for k in range(19)]
        curve = [
            (s * _HALF_M, RUNNER_RADIUS_M * sin(a), RUNNER_RADIUS_M * (1 - cos(a)) + 0.011) for a in angles
        ]
        parts.append(mesh.tube(f"{name}_runner", curve, 0.011, 12))
        for y, top, lean in ((-0.10, 0.285, 0.0), (0.115, 0.47, 0.055)):
            low = RUNNER_RADIUS_M - (RUNNER_RADIUS_M**2 - y * y) ** 0.5 + 0.008
            line = [(s * _HALF_M, y, low), (s * _HALF_M, y, SEAT_M), (s * _HALF_M, y + lean, top)]
            parts.append(mesh.tube(f"{name}_post", line, [0.011, 0.013, 0.010], 12))
        rest = [(s * _HALF_M, -0.135, 0.290), (s * _HALF_M, 0.0, 0.295), (s * _HALF_M, 0.130, 0.283)]
        parts.append(mesh.tube(f"{name}_rest", rest, [(0.017, 0.009)] * 3, 12))
    for y, z in ((-0.10, 0.085), (0.115, 0.085), (-0.10, 0.150)):
        parts.append(mesh.tube(f"{name}_rung", [(-_HALF_M, y, z), (_HALF_M, y, z)], 0.008, 10))
    for k in range(5):
        x = _HALF_M * (0.7 * (k / 2 - 1))
        parts.append(
            mesh.tube(f"{name}_slat", [(x, 0.118, SEAT_M), (x, 0.166, 0.44)], [(0.014, 0.006)] * 2, 10)
        )
    seat = mesh.bevel_box(f"{name}_seat", (2 * _HALF_M + 0.02, 0.255, 0.018), 0.007)
    crest = mesh.bevel_box(f"{name}_crest", (2 * _HALF_M + 0.02, 0.020, 0.070), 0.009)
    mesh.transform(crest, Matrix.Translation((0.0, 0.166, 0.425)) @ Matrix.Rotation(-0.20, 4, "X"))
    for part in parts:
        mesh.set_material(part, wood)
    flat = [mesh.move(seat, y=SEAT_Y_M, z=SEAT_M - 0.018), crest]
    return mesh.join(name, [*parts, *(mesh.set_material(part, plank) for part in flat)])
