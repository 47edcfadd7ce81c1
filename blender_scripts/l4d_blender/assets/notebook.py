"""A notebook, open at a ruled spread or shut with an elastic round it.

Owns paper and cover, and the words that a pen may leave. Knows nothing of pens. It lies on z = 0; the reader
sits at -Y.
"""

from __future__ import annotations

import random
from dataclasses import dataclass

import bpy
from mathutils import Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.assets.materials.base import Nodes
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import Choice, colours, kind
from l4d_blender.scene.colour import Colour

PAGE_M = (0.148, 0.210)
OPEN_M = 0.0100  # of the open pages where they are flat
SHUT_M = 0.0150
PITCH_M = 0.008
INK: Colour = (0.02, 0.03, 0.12)
_COVER_M = 0.0016


@dataclass(frozen=True)
class Look:
    """Cover colour, plain or dotted, and the colour of elastic and ribbon."""

    cover: Colour = (0.06, 0.15, 0.13)
    dotted: bool = False
    trim: Colour = (0.45, 0.06, 0.04)


@kind("notebook", (0.308, 0.249, 0.01), "surface", colour=colours("look.cover"))
def open_notebook(name: str, rng: random.Random, *, look: Look = Look(), lines: int = 11) -> bpy.types.Object:
    """A spread 30 cm wide: the left page is written full, the right one is empty but for a heading."""
    width, depth = PAGE_M
    cover = mesh.bevel_box(f"{name}_cover", (2 * width + 0.012, depth + 0.008, _COVER_M), 0.0007, segments=2)
    parts = Parts(name)
    parts.add(cover, cover_cloth(f"{name}_cloth", look, rng))
    pages = mesh.grid(f"{name}_pages", 2 * width, depth, 72, 4, lambda x, _: page_z(x))
    mesh.solidify(pages, 0.0012)
    ruled = products.ruled_paper(
        f"{name}_ruled", (0.80, 0.77, 0.68), (0.42, 0.54, 0.62), rng, pitch_m=PITCH_M
    )
    parts.add(pages, ruled)
    for side in (-1.0, 1.0):
        block = mesh.bevel_box(f"{name}_block", (width - 0.004, depth, OPEN_M - _COVER_M - 0.0012), 0.0008)
        parts.add(
            block, products.page_block(f"{name}_edges", rng), x=side * (0.5 * width + 0.002), z=_COVER_M
        )
    ink = products.satin_plastic(f"{name}_ink", INK, rng, roughness=0.7)
    for row in range(lines):
        end = -0.016 - rng.choice((0.0, 0.006, 0.014, 0.040))
        x = -width + 0.016
        while x < end:
            word = rng.uniform(0.010, 0.022)
            parts.add(_scribble(f"{name}_word", rng, word, x, 0.078 - PITCH_M * row), ink)
            x += word + 0.005
    parts.add(_scribble(f"{name}_heading", rng, 0.040, 0.018, 0.086, tall=1.6), ink)
    parts.tube(
        "ribbon",
        products.woven_cloth(f"{name}_ribbon", look.trim, rng),
        [
            (0.004, 0.10, 0.0075),
            (0.006, -0.02, 0.0080),
            (0.012, -0.09, 0.0095),
            (0.016, -0.118, 0.0035),
            (0.014, -0.140, 0.0012),
        ],
        [(0.0022, 0.0004)] * 5,
        segments=6,
    )
    return parts.join()


@kind(
    "notebook",
    (0.153, 0.218, 0.016),
    "surface",
    "graspable",
    colour=colours("look.cover"),
    pattern=Choice("look.dotted", {"plain": False, "dotted": True}),
)
def shut_notebook(name: str, rng: random.Random, *, look: Look = Look()) -> bpy.types.Object:
    """A shut book of 15 x 21 cm with an elastic band on its right and a ribbon below."""
    width, depth = PAGE_M
    cloth = cover_cloth(f"{name}_cloth", look, rng)
    trim = products.woven_cloth(f"{name}_trim", look.trim, rng, threads_per_m=1500.0)
    parts = Parts(name)
    for z in (0.0, SHUT_M - _COVER_M):
        parts.box("board", cloth, (width + 0.004, depth + 0.006, _COVER_M), 0.0007, segments=2, z=z)
    spine = mesh.bevel_box(f"{name}_spine", (0.003, depth + 0.006, SHUT_M - 0.0004), 0.0012)
    parts.add(spine, cloth, x=-0.5 * width - 0.0012, z=0.0002)
    block = mesh.bevel_box(f"{name}_block", (width - 0.002, depth - 0.002, SHUT_M - 2 * _COVER_M), 0.0006)
    parts.add(block, products.page_block(f"{name}_edges", rng), z=_COVER_M)
    band = mesh.bevel_box(f"{name}_band", (0.007, depth + 0.0075, SHUT_M + 0.0012), 0.0008, segments=2)
    parts.add(band, trim, x=0.5 * width - 0.018, z=-0.0002)
    label = mesh.bevel_box(f"{name}_label", (0.070, 0.036, 0.0004), 0.0001, segments=1)
    paper = products.paper(f"{name}_label", (0.74, 0.70, 0.60), rng)
    parts.add(label, paper, x=-0.012, y=0.052, z=SHUT_M - 0.0001)
    return mesh.drop_to_base(parts.join())


@kind("word", (0.022, 0.004, 0.0))
def word(name: str, rng: random.Random, *, length_m: float = 0.02) -> bpy.types.Object:
    """A word of fresh ink that starts at the origin and runs along +X, flat on z = 0."""
    ink = products.satin_plastic(f"{name}_ink", INK, rng, roughness=0.6)
    return mesh.set_material(_scribble(name, rng, length_m, 0.0, 0.0, level=0.0), ink)


def page_z(x: float) -> float:
    """Height of the open pages at a distance from the gutter: they dip into it."""
    t = min(abs(x) / 0.022, 1.0)
    return OPEN_M - 0.0035 * (1.0 - t) ** 2 - 0.0012 * (abs(x) / PAGE_M[0]) ** 4


def cover_cloth(name: str, look: Look, rng: random.Random) -> bpy.types.Material:
    """Bookbinder's linen, perhaps printed with dots."""
    material = products.book_cloth(name, look.cover, rng)
    if look.dotted:
        n = Nodes(material)
        base = n.bsdf.inputs["Base Color"].links[0].from_socket
        turned = n.mapping(n.object_coords(), rotation=(0.0, 0.0, 0.785), scale=(1.0, 1.0, 0.0))
        dots = n.math("LESS_THAN", n.voronoi(58.0, randomness=0.0, vector=turned), 0.26)
        n.set("Base Color", n.mix(dots, base, (0.72, 0.68, 0.56)))
    return material


def _scribble(
    name: str,
    rng: random.Random,
    length: float,
    x: float,
    y: float,
    *,
    tall: float = 1.0,
    level: float | None = None,
) -> bpy.types.Object:
    """A word as a chain of slanted strokes on the page."""
    verts: list[Vector] = []
    faces: list[tuple[int, ...]] = []
    at, slant = x, 0.0014 * tall
    while at < x + length:
        high = tall * rng.choice((0.0022, 0.0024, 0.0040))
        wide = 0.0009 * tall
        z = (page_z(at) + 0.0002) if level is None else level
        first = len(verts)
        corners = ((at, y), (at + wide, y), (at + slant + wide, y + high), (at + slant, y + high))
        verts += [Vector((cx, cy, z)) for cx, cy in corners]
        faces.append((first, first + 1, first + 2, first + 3))
        at += 0.0024 * tall
    return mesh.from_pydata(name, verts, faces, smooth=False)
