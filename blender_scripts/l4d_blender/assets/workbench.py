"""A carpenter's bench with a vice, and a board of tools for the wall behind it."""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.catalogue import Range, colours, kind

Colour = tuple[float, float, float]

TOP_M = 0.88
DEPTH_M = 0.72


@kind("workbench", (2.0, 0.86, 0.88), "surface", width_m=Range("width_m", 1.4, 2.6), colour=colours("paint"))
def workbench(
    name: str,
    rng: random.Random,
    *,
    width_m: float = 2.0,
    paint: Colour | None = None,
    light: Colour = (0.46, 0.31, 0.16),
) -> bpy.types.Object:
    """Its top is at `TOP_M`; drawers and a vice look to -Y; the origin is under its middle."""
    dark = products.scaled(light, 0.5)
    wood = products.wood(f"{name}_top", light, dark, rng, grain_axis="X")
    frame = products.lacquer(f"{name}_frame", paint, rng) if paint else wood
    iron = products.metal(f"{name}_iron", (0.16, 0.17, 0.18), rng, roughness=0.45)
    parts: list[bpy.types.Object] = []

    def block(
        size: tuple[float, float, float], at: tuple[float, float, float], material: bpy.types.Material
    ) -> None:
        obj = mesh.bevel_box(f"{name}_part", size, 0.006, 1)
        parts.append(mesh.set_material(mesh.move(obj, *at), material))

    half = width_m / 2
    block((width_m, DEPTH_M, 0.07), (0.0, 0.0, TOP_M - 0.07), wood)
    for x in (-1, 1):
        for y in (-1, 1):
            block((0.09, 0.09, TOP_M - 0.07), (x * (half - 0.10), y * 0.26, 0.0), frame)
        block((0.06, 0.46, 0.08), (x * (half - 0.10), 0.0, 0.14), frame)
    block((width_m - 0.24, 0.52, 0.03), (0.0, 0.0, 0.22), frame)
    count = max(2, round((width_m - 0.5) / 0.5))
    wide = (width_m - 0.34) / count
    for k in range(count):
        x = (k + 0.5 - count / 2) * wide
        block((wide - 0.02, 0.5, 0.15), (x, -0.05, TOP_M - 0.225), frame)
        block((0.10, 0.025, 0.018), (x, -0.315, TOP_M - 0.155), iron)
        if rng.random() < 0.7:
            box = rng.uniform(0.25, 0.42), rng.uniform(0.28, 0.4), rng.uniform(0.12, 0.3)
            card = products.paper(
                f"{name}_card_{k}", rng.choice(((0.36, 0.24, 0.13), (0.22, 0.24, 0.25))), rng
            )
            block((min(box[0], wide - 0.06), box[1], box[2]), (x, 0.0, 0.25), card)
    side = rng.choice((-1, 1))
    x = side * (half - 0.30)
    block((0.24, 0.05, 0.16), (x, -DEPTH_M / 2 - 0.03, TOP_M - 0.17), iron)
    screw = mesh.rotate(mesh.cylinder(f"{name}_screw", 0.016, 0.12, 12), "X", 90.0)
    parts.append(mesh.set_material(mesh.move(screw, x=x, y=-DEPTH_M / 2 - 0.02, z=TOP_M - 0.10), iron))
    return mesh.join(name, parts)


@kind("tool_board", (1.4, 0.048, 0.8), "hangs", front="-y")
def tool_board(name: str, rng: random.Random, *, width_m: float = 1.4) -> bpy.types.Object:
    """Saws, hammers, chisels and spanners on a painted board; the wall is y = 0, the lower edge at z = 0."""
    board = mesh.box(f"{name}_board", (width_m, 0.018, 0.8))
    paint = products.lacquer(
        f"{name}_paint", rng.choice(((0.50, 0.44, 0.34), (0.20, 0.28, 0.30), (0.42, 0.28, 0.15))), rng
    )
    wood = products.wood(f"{name}_grip", (0.42, 0.22, 0.08), (0.24, 0.11, 0.04), rng, grain_axis="Z")
    steel = products.metal(f"{name}_steel", (0.42, 0.43, 0.45), rng, roughness=0.35)
    parts = [mesh.set_material(mesh.move(board, y=-0.01), paint)]
    for row, low in enumerate((0.42, 0.06)):
        x = -width_m / 2 + 0.06
        while x < width_m / 2 - 0.12:
            long, grip = rng.uniform(0.18, 0.30), rng.uniform(0.09, 0.13)
            tool = rng.choice(
                ("hammer", "chisel", "spanner", "saw") if row == 0 else ("chisel", "spanner", "hammer")
            )
            wide = {"hammer": 0.11, "chisel": 0.025, "spanner": 0.035, "saw": 0.13}[tool]
            middle = x + wide / 2
            pieces = [((0.026, 0.026, grip), middle, low, wood)]
            if tool == "hammer":
                pieces = [
                    ((0.024, 0.022, long), middle, low, wood),
                    ((0.11, 0.028, 0.032), middle, low + long, steel),
                ]
            elif tool == "saw":
                pieces = [
                    ((0.09, 0.022, 0.10), middle, low + 0.22, wood),
                    ((wide, 0.004, 0.22), middle, low, steel),
                ]
            elif tool == "spanner":
                pieces = [
                    ((0.018, 0.008, long), middle, low, steel),
                    ((0.042, 0.010, 0.04), middle, low + long, steel),
                ]
            else:
                pieces.append(((0.02, 0.006, 0.12), middle, low + grip, steel))
            for size, at, z, material in pieces:
                piece = mesh.bevel_box(f"{name}_tool", size, 0.004, 1)
                parts.append(mesh.set_material(mesh.move(piece, x=at, y=-0.035, z=z), material))
            x += wide + rng.uniform(0.03, 0.07)
    return mesh.join(name, parts)
