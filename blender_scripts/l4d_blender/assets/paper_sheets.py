"""Loose printed sheets, fanned, and a block of sticky notes.

Owns the paper; it lies on z = 0, text reads from -Y.
"""

from __future__ import annotations

import random

import bpy
from mathutils import Matrix, Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.lettering import lettering
from l4d_blender.assets.materials import products
from l4d_blender.scene.catalogue import colours, kind
from l4d_blender.scene.colour import Colour

A5_M = (0.148, 0.210)


@kind("paper", (0.179, 0.234, 0.014))
def paper_sheets(name: str, rng: random.Random, *, count: int = 3) -> bpy.types.Object:
    """A few sheets on top of each other, each a little turned, the upper ones curled at a corner."""
    parts = []
    for k in range(count):
        sheet = _sheet(f"{name}_{k}", rng, curl_m=0.004 + 0.004 * k)
        turn = Matrix.Rotation(rng.uniform(-0.16, 0.16), 4, "Z")
        place = Matrix.Translation((rng.uniform(-0.012, 0.012), rng.uniform(-0.012, 0.012), 0.0007 * k))
        parts.append(mesh.transform(sheet, place @ turn))
    return mesh.join(name, parts)


@kind("notes", (0.076, 0.076, 0.025), colour=colours("colour"))
def sticky_notes(name: str, rng: random.Random, *, colour: Colour = (0.78, 0.56, 0.08)) -> bpy.types.Object:
    """A block of sticky notes with a lifted top note."""
    block = mesh.bevel_box(f"{name}_block", (0.076, 0.076, 0.012), 0.0008, segments=1)
    mesh.set_material(block, products.paper(f"{name}_edges", products.scaled(colour, 0.85), rng))
    top = mesh.grid(
        f"{name}_top", 0.076, 0.076, 4, 12, lambda x, y: 0.0126 + 0.012 * max(0.0, (0.01 - y) / 0.048) ** 2
    )
    mesh.set_material(mesh.solidify(top, 0.0004), products.paper(f"{name}_note", colour, rng))
    return mesh.join(name, [block, top])


def _sheet(name: str, rng: random.Random, curl_m: float) -> bpy.types.Object:
    """One printed A5 page: a heading, paragraphs, a small bar chart."""
    width, height = A5_M

    def lift(x: float, y: float) -> float:
        corner = max(0.0, (2 * x / width + 2 * y / height - 1.1) / 0.9)
        return 0.0006 + curl_m * corner**2

    page = mesh.solidify(mesh.grid(f"{name}_page", width, height, 18, 24, lift), 0.0004)
    mesh.set_material(page, products.paper(f"{name}_paper", (0.80, 0.79, 0.75), rng))

    heading = lettering(
        f"{name}_heading", rng.choice(("Quarterly notes", "Field report", "Reading list")), 0.0058
    )
    mesh.move(heading, x=-0.022, y=0.083, z=lift(-0.022, 0.083) + 0.0003)
    marks = []
    y = 0.066
    while y > 0.005:
        marks.append((-0.055, y, rng.uniform(0.085, 0.108), 0.0018))
        y -= 0.0056
    marks += [(-0.050 + 0.012 * k, -0.075, 0.008, rng.uniform(0.015, 0.058)) for k in range(8)]
    verts: list[Vector] = []
    faces: list[tuple[int, ...]] = []
    for x, low, w, h in marks:
        first = len(verts)
        verts += [
            Vector((cx, cy, lift(cx, cy) + 0.0003))
            for cx, cy in ((x, low), (x + w, low), (x + w, low + h), (x, low + h))
        ]
        faces.append((first, first + 1, first + 2, first + 3))
    print_ = mesh.from_pydata(f"{name}_print", verts, faces, smooth=False)
    ink = products.satin_plastic(f"{name}_ink", (0.06, 0.065, 0.075), rng, roughness=0.8)
    accent = products.satin_plastic(f"{name}_accent", (0.08, 0.22, 0.36), rng, roughness=0.8)
    mesh.paint(print_, [ink, accent], lambda centre, _: int(centre.y < 0.0))
    mesh.set_material(heading, ink)
    return mesh.join(name, [page, print_, heading])
