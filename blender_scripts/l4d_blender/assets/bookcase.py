"""An open bookcase filled with books, some leaning, and a few ornaments."""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior
from l4d_blender.assets.materials.base import principled
from l4d_blender.assets.parts import Parts, placed
from l4d_blender.scene.catalogue import Range, kind

BINDINGS = (
    (0.36, 0.06, 0.05),
    (0.05, 0.12, 0.24),
    (0.08, 0.22, 0.13),
    (0.55, 0.36, 0.10),
    (0.20, 0.11, 0.07),
    (0.62, 0.57, 0.47),
    (0.10, 0.10, 0.12),
    (0.42, 0.20, 0.09),
    (0.17, 0.30, 0.36),
)


@kind(
    "bookcase",
    (0.8, 0.29, 1.7),
    "surface",
    front="-y",
    height_m=Range("height_m", 0.35, 2.0),
    width_m=Range("width_m", 0.6, 1.6),
)
def bookcase(
    name: str,
    rng: random.Random,
    *,
    width_m: float = 0.8,
    depth_m: float = 0.29,
    height_m: float = 1.7,
    shelves: int = 5,
) -> bpy.types.Object:
    """The open side faces -Y; shelves are evenly spaced."""
    case = interior.wood(f"{name}_case", (0.30, 0.17, 0.085), rng, grain_axis="Z")
    plank = interior.wood(f"{name}_shelf", (0.30, 0.17, 0.085), rng, grain_axis="X")
    bindings = [
        principled(f"{name}_binding{i}", colour, roughness=0.55, variation=0.25, variation_scale=22)
        for i, colour in enumerate(BINDINGS)
    ]
    paper = principled(f"{name}_paper", (0.74, 0.68, 0.56), roughness=0.9)
    glaze = interior.ceramic(f"{name}_vase", (0.60, 0.56, 0.48), rng)
    board = 0.024
    parts = Parts(name)
    for side in (-1, 1):
        parts.box("side", case, (board, depth_m, height_m), 0.003, x=side * (width_m - board) / 2)
    parts.box("back", plank, (width_m - 0.01, 0.010, height_m - 0.01), y=depth_m / 2 - 0.006)
    gap = (height_m - board - 0.07) / shelves
    for level in range(shelves + 1):
        z = 0.07 + level * gap
        parts.box(f"shelf{level}", plank, (width_m - 2 * board, depth_m - 0.006, board), 0.002, z=z)
        if level < shelves:
            parts += _row(
                name, rng, bindings, paper, glaze, width_m - 2 * board, depth_m, z + board, gap - board
            )
    return parts.join()


def _row(
    name: str,
    rng: random.Random,
    bindings: list[bpy.types.Material],
    paper: bpy.types.Material,
    glaze: bpy.types.Material,
    width: float,
    depth: float,
    z: float,
    room: float,
) -> list[bpy.types.Object]:
    """One shelf's books from left to right; a gap now and then holds a vase."""
    parts = Parts(name)
    x, end = -width / 2 + 0.006, width / 2 - 0.006
    vase_at = rng.uniform(0.25, 0.75) * width - width / 2 if rng.random() < 0.6 else None
    while True:
        thick = rng.uniform(0.016, 0.044)
        tall = room * rng.uniform(0.62, 0.90)
        if vase_at is not None and x + thick > vase_at:
            parts.add(_vase(name, rng, glaze, x + 0.065, z, min(room * 0.75, 0.2)))
            x, vase_at = x + 0.13, None
            continue
        if x + thick > end:
            return parts
        deep = rng.uniform(0.15, 0.21)
        cover = mesh.bevel_box(f"{name}_book", (thick, deep, tall), 0.003, 1)
        pages = mesh.move(mesh.box(f"{name}_pages", (thick * 0.76, deep - 0.006, 0.004)), z=tall - 0.003)
        mesh.set_material(cover, rng.choice(bindings))
        mesh.set_material(pages, paper)
        book = mesh.join(f"{name}_book", [cover, pages])
        if rng.random() < 0.10 and x + thick + 0.05 < end:
            book = mesh.drop_to_base(mesh.rotate(book, "Y", 11))
            x += 0.04
        parts.add(book, x=x + thick / 2, y=-depth / 2 + deep / 2 + rng.uniform(0.012, 0.03), z=z)
        x += thick + 0.0015


def _vase(
    name: str, rng: random.Random, glaze: bpy.types.Material, x: float, z: float, tall: float
) -> bpy.types.Object:
    belly = rng.uniform(0.038, 0.050)
    profile = [
        (0.0, 0.0),
        (0.026, 0.0),
        (belly, 0.38 * tall),
        (0.022, 0.78 * tall),
        (0.026, tall),
        (0.020, tall),
        (0.016, 0.80 * tall),
        (0.0, 0.78 * tall),
    ]
    vase = mesh.subdivide(mesh.lathe(f"{name}_vase", profile, 20, close_bottom=False), 1)
    return placed(vase, glaze, x=x, y=-0.03, z=z)
