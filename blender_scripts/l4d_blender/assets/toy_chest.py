"""A painted toy chest with its lid leaning back, full of toys. Front = -Y."""

from __future__ import annotations

import random

import bpy
from mathutils import Matrix

from l4d_blender.scene.catalogue import colours, kind

from ..scene.colour import Colour
from . import ball, mesh
from .materials import interior, products

HEIGHT_M = 0.36


@kind("chest", (0.75, 0.51, 0.769), "container", front="-y", colour=colours("paint"))
def toy_chest(
    name: str,
    rng: random.Random,
    *,
    size_xy: tuple[float, float] = (0.72, 0.4),
    paint: Colour = (0.1, 0.3, 0.36),
) -> bpy.types.Object:
    """Box, lid and what sticks out of it, as one object."""
    sx, sy = size_xy
    wall = products.lacquer(f"{name}_paint", paint, rng)
    trim = interior.wood(f"{name}_trim", (0.50, 0.33, 0.17), rng, grain_axis="X")
    board = 0.018
    parts = []
    for width, turn, away in ((sx, 0, sy), (sx, 180, sy), (sy, 90, sx), (sy, -90, sx)):
        side = mesh.bevel_box(f"{name}_side", (width, board, HEIGHT_M - 0.03), 0.004)
        mesh.move(side, y=-away / 2 + board / 2, z=0.03)
        lip = mesh.bevel_box(f"{name}_lip", (width + 0.012, board + 0.012, 0.028), 0.006)
        mesh.move(lip, y=-away / 2 + board / 2, z=HEIGHT_M - 0.022)
        foot = mesh.bevel_box(f"{name}_foot", (width + 0.016, board + 0.014, 0.06), 0.006)
        mesh.move(foot, y=-away / 2 + board / 2)
        for piece, material in ((side, wall), (lip, trim), (foot, trim)):
            parts.append(mesh.set_material(mesh.rotate(piece, "Z", turn), material))
    star = mesh.lathe(f"{name}_star", [(0.055, 0.0), (0.055, 0.006), (0.0, 0.008)], 5)
    mesh.transform(star, Matrix.Translation((0.0, -sy / 2, 0.19)) @ Matrix.Rotation(1.5708, 4, "X"))
    parts.append(mesh.set_material(star, products.lacquer(f"{name}_star", (0.74, 0.50, 0.06), rng)))
    bed = mesh.move(mesh.box(f"{name}_bed", (sx - 0.03, sy - 0.03, 0.01)), z=HEIGHT_M - 0.11)
    parts.append(mesh.set_material(bed, interior.felt(f"{name}_bed", (0.05, 0.045, 0.05), rng)))
    lid = mesh.bevel_box(f"{name}_lid", (sx + 0.03, sy + 0.02, 0.024), 0.008)
    mesh.transform(
        lid,
        Matrix.Translation((0.0, sy / 2 + 0.01, HEIGHT_M + 0.005))
        @ Matrix.Rotation(-1.72, 4, "X")
        @ Matrix.Translation((0.0, -sy / 2, 0.0)),
    )
    parts.append(mesh.set_material(lid, wall))
    return mesh.join(name, [*parts, *_contents(name, rng, sx, sy)])


def _contents(name: str, rng: random.Random, sx: float, sy: float) -> list[bpy.types.Object]:
    made = []
    for k, (x, y, r, colour, mark, pattern) in enumerate(
        (
            (-0.22, -0.04, 0.095, "orange", "white", "striped"),
            (0.01, 0.07, 0.080, "light_blue", "yellow", "dotted"),
            (0.24, 0.03, 0.070, "light_green", "white", "banded"),
        )
    ):
        toy = ball.ball(f"{name}_ball_{k}", rng, radius_m=r, colour=colour, mark=mark, pattern=pattern)
        turn = Matrix.Rotation(rng.uniform(0.3, 1.2), 4, "X") @ Matrix.Rotation(rng.uniform(0, 3), 4, "Z")
        mesh.transform(toy, Matrix.Translation((x, y, HEIGHT_M - 0.07)) @ turn)
        made.append(toy)
    for k, paint in enumerate(
        ((0.62, 0.09, 0.06), (0.70, 0.46, 0.04), (0.09, 0.24, 0.10), (0.30, 0.08, 0.30))
    ):
        size = rng.uniform(0.07, 0.10)
        block = mesh.bevel_box(f"{name}_block", (size, size, size), 0.005)
        at = (rng.uniform(-0.40, 0.40) * sx, rng.uniform(-0.32, 0.30) * sy, HEIGHT_M - 0.06)
        tilt = Matrix.Rotation(rng.uniform(-0.6, 0.6), 4, "X") @ Matrix.Rotation(
            rng.uniform(-0.6, 0.6), 4, "Y"
        )
        mesh.transform(block, Matrix.Translation(at) @ tilt @ Matrix.Rotation(rng.uniform(0, 1.5), 4, "Z"))
        made.append(mesh.set_material(block, products.lacquer(f"{name}_block_{k}", paint, rng)))
    return made
