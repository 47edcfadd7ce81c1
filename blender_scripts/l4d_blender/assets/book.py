"""A hardback book: two boards, a rounded spine, a page block, a title in foil.

Owns the book; knows nothing of shelves. It lies on z = 0 with its spine to -X; the title reads from -Y.
"""

from __future__ import annotations

import random
from math import cos, pi, sin

import bpy
from mathutils import Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.lettering import lettering
from l4d_blender.assets.materials import products
from l4d_blender.scene.catalogue import colours, kind
from l4d_blender.scene.colour import Colour

BOARD_M = 0.0026
OVERHANG_M = 0.004


@kind("book", (0.154, 0.225, 0.03), "graspable", "pushable", "stacks", "surface", colour=colours("cover"))
def book(
    name: str,
    rng: random.Random,
    *,
    size_m: tuple[float, float, float] = (0.155, 0.225, 0.03),
    cover: Colour = (0.035, 0.16, 0.075),
    foil: Colour = (0.62, 0.5, 0.24),
    title: tuple[str, str] = ("THE QUIET", "HARBOUR"),
    author: str = "E. Lindqvist",
) -> bpy.types.Object:
    """A book of (width, height, thickness) that lies on its back cover."""
    width, height, thickness = size_m
    cloth = products.book_cloth(f"{name}_cloth", cover, rng)
    print_ = products.satin_plastic(f"{name}_foil", foil, rng, roughness=0.38)

    boards = []
    for side, z in (("back", 0.0), ("front", thickness - BOARD_M)):
        board = mesh.bevel_box(f"{name}_{side}", (width - 0.006, height, BOARD_M), 0.0009, segments=2)
        boards.append(mesh.set_material(mesh.move(board, x=0.003, z=z), cloth))
    spine = mesh.set_material(_spine(f"{name}_spine", width, height, thickness), cloth)

    block = mesh.bevel_box(
        f"{name}_pages",
        (width - 0.004 - OVERHANG_M, height - 2 * OVERHANG_M, thickness - 2 * BOARD_M + 0.0004),
        0.0012,
    )
    mesh.move(block, x=-0.5 * OVERHANG_M + 0.001, z=BOARD_M - 0.0002)
    mesh.set_material(block, products.page_block(f"{name}_paper", rng))

    printed = [
        mesh.set_material(part, print_)
        for part in (
            *_front_print(name, width, height, thickness, title, author),
            *_spine_bands(name, width, height, thickness),
        )
    ]
    return mesh.join(name, [*boards, spine, block, *printed])


def _spine(name: str, width: float, height: float, thickness: float, lift_m: float = 0.0) -> bpy.types.Object:
    """The rounded back of the cover as a thin shell along Y."""
    bulge = 0.0045
    arc = [
        (
            -0.5 * width + 0.006 - (bulge + lift_m) * sin(pi * k / 8) - lift_m,
            thickness * 0.5 * (1 - cos(pi * k / 8)),
        )
        for k in range(9)
    ]
    inner = [(x + BOARD_M, min(max(z, BOARD_M), thickness - BOARD_M)) for x, z in reversed(arc)]
    ring = arc + inner
    spine = mesh.loft(name, [[Vector((x, y, z)) for x, z in ring] for y in (-0.5 * height, 0.5 * height)])
    return mesh.shade_smooth(spine, 40.0)


def _front_print(
    name: str, width: float, height: float, thickness: float, title: tuple[str, str], author: str
) -> list[bpy.types.Object]:
    """Foil on the front cover: two lines of a title, a rule, the author, a frame."""
    x, z = 0.005, thickness + 0.0002
    size = 0.082 * width
    lines = [
        (title[0], 0.26 * height, size),
        (title[1], 0.26 * height - 1.6 * size, size),
        (author, -0.35 * height, 0.5 * size),
    ]
    printed = [
        mesh.move(lettering(f"{name}_title", text, tall, spacing=1.05, bold_m=0.0002), x, y, z)
        for text, y, tall in lines
    ]
    bars = [(0.0, 0.26 * height - 3.0 * size, 0.18 * width, 0.0014)]
    bars += [(0.0, side * 0.44 * height, 0.80 * width, 0.0012) for side in (-1.0, 1.0)]
    bars += [(side * 0.40 * width, 0.0, 0.0012, 0.88 * height) for side in (-1.0, 1.0)]
    for bar_x, y, size_x, size_y in bars:
        printed.append(mesh.move(mesh.box(f"{name}_rule", (size_x, size_y, 0.0002)), x + bar_x, y, thickness))
    return printed


def _spine_bands(name: str, width: float, height: float, thickness: float) -> list[bpy.types.Object]:
    """Foil bands and a label across the spine."""
    bands = ((0.36 * height, 0.004), (0.16 * height, 0.036), (-0.36 * height, 0.004))
    return [
        mesh.move(_spine(f"{name}_band", width, size, thickness, lift_m=0.0003), y=y) for y, size in bands
    ]
