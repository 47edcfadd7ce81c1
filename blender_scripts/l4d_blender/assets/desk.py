"""A wooden desk on a steel frame, with a drawer unit.

Owns the furniture; knows nothing of what stands on it. Long side along X, the sitter at -Y, feet on z = 0.
"""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.colour import Colour

HEIGHT_M = 0.74
TOP_M = 0.028


@kind("desk", (1.4, 0.8, 0.74), "surface")
def desk(
    name: str,
    rng: random.Random,
    *,
    size_m: tuple[float, float] = (1.4, 0.8),
    light: Colour = (0.4, 0.235, 0.115),
    dark: Colour = (0.21, 0.105, 0.045),
    steel: Colour = (0.045, 0.047, 0.05),
) -> bpy.types.Object:
    """A desk of (width, depth) whose top is at `HEIGHT_M`."""
    width, depth = size_m
    top = mesh.bevel_box(f"{name}_top", (width, depth, TOP_M), 0.005, segments=4)
    mesh.move(top, z=HEIGHT_M - TOP_M)
    oak = products.wood(f"{name}_oak", light, dark, rng, grain_axis="X", stave_m=0.062, stave_length_m=0.55)
    mesh.set_material(top, oak)

    frame = products.lacquer(f"{name}_frame", steel, rng)
    parts = Parts(name)
    parts.add(top)
    for x in (-0.5 * width + 0.06, 0.5 * width - 0.06):
        for y in (-0.5 * depth + 0.06, 0.5 * depth - 0.06):
            parts.box("leg", frame, (0.045, 0.045, HEIGHT_M - TOP_M), 0.004, x=x, y=y)
        parts.box("foot", frame, (0.045, depth - 0.12, 0.03), 0.004, x=x)
    rail = mesh.bevel_box(f"{name}_rail", (width - 0.12, 0.03, 0.06), 0.004)
    parts.add(rail, frame, y=0.5 * depth - 0.06, z=HEIGHT_M - TOP_M - 0.06)

    front = products.lacquer(f"{name}_drawers", (0.52, 0.51, 0.48), rng)
    pull = products.metal(f"{name}_pulls", (0.5, 0.5, 0.5), rng)
    x = -0.5 * width + 0.30
    for k in range(3):
        parts.box("drawer", front, (0.38, 0.5, 0.186), 0.004, x=x, z=0.10 + 0.192 * k)
        parts.box("pull", pull, (0.12, 0.018, 0.010), 0.003, x=x, y=-0.258, z=0.20 + 0.192 * k)
    return parts.join()
