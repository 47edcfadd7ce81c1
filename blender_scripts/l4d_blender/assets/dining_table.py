"""A table to eat at: a plank top on four legs, and the cloth that may lie on it.

Owns both. Knows nothing of what is served. The middle of the top is at the origin: z = 0 is where things
stand, the legs reach down to -`HEIGHT_M`; the cloth's upper side is at z = 0 too and the bare top below it.
"""

from __future__ import annotations

import random
from math import cos, hypot, sin

import bpy
from mathutils import noise

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products, tableware
from l4d_blender.assets.parts import CORNERS, Parts
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.colour import Colour

HEIGHT_M = 0.74
CLOTH_M = 0.0022


@kind("table", (1.5, 0.95, 0.74), "surface")
def dining_table(
    name: str,
    rng: random.Random,
    *,
    size_m: tuple[float, float] = (1.5, 0.95),
    light: Colour = (0.42, 0.26, 0.13),
    dark: Colour = (0.22, 0.115, 0.05),
    under_cloth: bool = False,
) -> bpy.types.Object:
    """A table of (length along X, depth along Y) with a thick top and turned-in legs."""
    length, depth = size_m
    top_z = -CLOTH_M - 0.0006 if under_cloth else 0.0
    wood = products.wood(f"{name}_wood", light, dark, rng, grain_axis="X", stave_m=0.155, stave_length_m=1.7)
    legs = products.wood(f"{name}_legs", light, dark, rng, grain_axis="Z")
    parts = Parts(name)
    parts.box("top", wood, (length, depth, 0.034), 0.006, 3, z=top_z - 0.034)
    for sx, sy in CORNERS:
        leg = mesh.cylinder(f"{name}_leg", 0.024, HEIGHT_M - 0.034, 20, top_radius=0.034)
        parts.add(leg, legs, x=sx * (0.5 * length - 0.09), y=sy * (0.5 * depth - 0.09), z=-HEIGHT_M)
    for sy in (-1, 1):
        rail = mesh.bevel_box(f"{name}_rail", (length - 0.2, 0.022, 0.09), 0.003, 2)
        parts.add(rail, legs, y=sy * (0.5 * depth - 0.09), z=top_z - 0.125)
    return parts.join()


@kind("tablecloth", (1.71, 1.1, 0.329), "surface")
def tablecloth(
    name: str,
    rng: random.Random,
    *,
    material: bpy.types.Material | None = None,
    table_m: tuple[float, float] = (1.5, 0.95),
    overhang_m: float = 0.24,
    cell_m: float = 0.024,
) -> bpy.types.Object:
    """A cloth over a table top: flat but for faint creases, hanging in folds at the edges."""
    half_x, half_y = 0.5 * table_m[0] + 0.006, 0.5 * table_m[1] + 0.006
    phase = rng.uniform(0.0, 6.0)
    wide, deep = 2 * (half_x + overhang_m), 2 * (half_y + overhang_m)
    sheet = mesh.grid(name, wide, deep, round(wide / cell_m), round(deep / cell_m))
    for vertex in sheet.data.vertices:
        vertex.co = _drape(vertex.co.x, vertex.co.y, half_x, half_y, phase)
    material = material or tableware.linen(f"{name}_linen", (0.62, 0.58, 0.48), rng)
    return mesh.set_material(mesh.solidify(sheet, CLOTH_M), material)


@kind("napkin", (0.301, 0.202, 0.003), "surface")
def runner(
    name: str,
    rng: random.Random,
    *,
    material: bpy.types.Material | None = None,
    size_m: tuple[float, float] = (0.30, 0.20),
) -> bpy.types.Object:
    """A flat strip of cloth or a napkin spread out; it lies on z = 0 with rippled edges."""
    shift = rng.uniform(-9.0, 9.0)
    sheet = mesh.grid(name, *size_m, round(size_m[0] / 0.015), round(size_m[1] / 0.015))
    for vertex in sheet.data.vertices:
        x, y = vertex.co.x, vertex.co.y
        vertex.co.x += 0.003 * noise.noise((x * 9, y * 9, shift))
        vertex.co.y += 0.003 * noise.noise((x * 9, y * 9, shift + 5))
        edge = max(abs(x) / (0.5 * size_m[0]), abs(y) / (0.5 * size_m[1]))
        vertex.co.z = 0.0016 + max(0.0, edge - 0.86) * 0.018 * max(0.0, noise.noise((x * 14, y * 14, shift)))
    material = material or tableware.linen(f"{name}_linen", (0.62, 0.58, 0.48), rng)
    return mesh.set_material(mesh.solidify(sheet, 0.0014), material)


def _drape(x: float, y: float, half_x: float, half_y: float, phase: float) -> tuple[float, float, float]:
    over_x, over_y = max(abs(x) - half_x, 0.0), max(abs(y) - half_y, 0.0)
    crease = 0.00025 * (noise.noise((x * 6, y * 6, phase)) - 0.3)
    if over_x == 0.0 and over_y == 0.0:
        return x, y, min(crease, 0.0)
    fall = hypot(over_x, over_y) if over_x and over_y else max(over_x, over_y)

    def swing(along: float) -> float:
        return fall * (0.13 + 0.11 * sin(21.0 * along + phase) + 0.05 * cos(9.0 * along))

    at_x = _sign(x) * (half_x + (swing(y) if over_x else 0.0)) if over_x else x
    at_y = _sign(y) * (half_y + (swing(x) if over_y else 0.0)) if over_y else y
    return at_x, at_y, -0.97 * fall


def _sign(value: float) -> float:
    return 1.0 if value >= 0.0 else -1.0
