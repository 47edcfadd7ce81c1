"""A wire-bound notepad, open at a page with some handwriting.

Owns the pad; knows nothing of pens. It lies on z = 0; the wire is at +Y, the writer sits at -Y.
"""

from __future__ import annotations

import random
from math import cos, pi, sin

import bpy
from mathutils import Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.colour import Colour

THICKNESS_M = 0.009
LINE_PITCH_M = 0.007


@kind("notepad", (0.115, 0.163, 0.017), "surface")
def notepad(
    name: str,
    rng: random.Random,
    *,
    size_m: tuple[float, float] = (0.115, 0.16),
    page: Colour = (0.8, 0.76, 0.62),
    ink: Colour = (0.02, 0.03, 0.12),
) -> bpy.types.Object:
    """A pad with the top page at `THICKNESS_M`, its corner a little curled."""
    width, height = size_m
    stack = mesh.bevel_box(f"{name}_stack", (width, height, THICKNESS_M - 0.0012), 0.001, segments=2)
    mesh.set_material(stack, products.page_block(f"{name}_edges", rng, colour=page))

    def curl(x: float, y: float) -> float:
        corner = max(0.0, (x / (0.5 * width) - y / (0.5 * height) - 1.1) / 0.9)
        return THICKNESS_M - 0.0010 + 0.009 * corner**2

    sheet = mesh.grid(f"{name}_sheet", width - 0.001, height - 0.001, 16, 22, curl)
    ruled = products.ruled_paper(f"{name}_ruled", page, (0.36, 0.50, 0.62), rng, pitch_m=LINE_PITCH_M)
    mesh.set_material(mesh.solidify(sheet, 0.0005), ruled)

    writing = _handwriting(f"{name}_writing", rng, width, height)
    mesh.set_material(writing, products.satin_plastic(f"{name}_ink", ink, rng, roughness=0.7))

    wire = products.metal(f"{name}_wire", (0.55, 0.56, 0.58), rng)
    loops = [
        mesh.set_material(_loop(f"{name}_loop{k}", x, 0.5 * height - 0.004), wire)
        for k, x in enumerate(_evenly(-0.5 * width + 0.008, 0.5 * width - 0.008, 14))
    ]
    return mesh.join(name, [stack, sheet, writing, *loops])


def _evenly(first: float, last: float, count: int) -> list[float]:
    return [first + (last - first) * k / (count - 1) for k in range(count)]


def _loop(name: str, x: float, y: float) -> bpy.types.Object:
    """One turn of wire through the stack at its far edge."""
    ring = [
        Vector(
            (x, y + 0.0062 * cos(2 * pi * k / 14), 0.5 * THICKNESS_M + 0.0015 + 0.0062 * sin(2 * pi * k / 14))
        )
        for k in range(14)
    ]
    return mesh.tube(name, ring, 0.0007, segments=5, closed=True)


def _handwriting(name: str, rng: random.Random, width: float, height: float) -> bpy.types.Object:
    """Words as short slanted scribbles on some of the lines."""
    verts: list[Vector] = []
    faces: list[list[int]] = []
    z = THICKNESS_M - 0.0008
    y = 0.5 * height - 0.030
    for _ in range(9):
        x = -0.5 * width + 0.012
        line_end = 0.5 * width - rng.uniform(0.014, 0.055)
        while x < line_end:
            word = rng.uniform(0.007, 0.017)
            strokes = int(word / 0.0022)
            for k in range(strokes):
                first = len(verts)
                tall = rng.choice((0.0018, 0.0022, 0.0034))
                x0 = x + k * 0.0022
                corners = ((x0, y), (x0 + 0.0009, y), (x0 + 0.0021, y + tall), (x0 + 0.0012, y + tall))
                verts.extend(Vector((cx, cy, z)) for cx, cy in corners)
                faces.append([first, first + 1, first + 2, first + 3])
            x += word + 0.004
        y -= LINE_PITCH_M
    return mesh.from_pydata(name, verts, faces, smooth=False)
