"""A high table to stand at: an oak board on a black sledge frame with a foot rail.

Owns the furniture; knows nothing of what stands on it. Long side along X, feet on z = 0.
"""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets.materials import products
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.colour import Colour

HEIGHT_M = 1.04
TOP_M = 0.034


@kind("table", (1.6, 0.62, 1.04), "surface")
def high_table(
    name: str,
    rng: random.Random,
    *,
    size_m: tuple[float, float] = (1.6, 0.62),
    light: Colour = (0.5, 0.36, 0.2),
    dark: Colour = (0.32, 0.2, 0.1),
    steel: Colour = (0.035, 0.036, 0.04),
) -> bpy.types.Object:
    """A table of (width, depth) whose top is at `HEIGHT_M`."""
    width, depth = size_m
    oak = products.wood(f"{name}_oak", light, dark, rng, grain_axis="X", stave_m=0.085, stave_length_m=0.8)
    parts = Parts(name)
    parts.box("board", oak, (width, depth, TOP_M), 0.006, z=HEIGHT_M - TOP_M)
    frame = products.lacquer(f"{name}_frame", steel, rng)
    bars = Parts(name)
    for x in (-0.5 * width + 0.12, 0.5 * width - 0.12):
        for y in (-0.5 * depth + 0.05, 0.5 * depth - 0.05):
            bars.box("post", frame, (0.045, 0.045, HEIGHT_M - TOP_M), 0.005, x=x, y=y)
        for z in (0.0, HEIGHT_M - TOP_M - 0.045):
            bars.box("sledge", frame, (0.045, depth - 0.10, 0.045), 0.005, x=x, z=z)
    for y, z in ((0.0, HEIGHT_M - TOP_M - 0.05), (0.5 * depth - 0.05, 0.24)):
        bars.box("rail", frame, (width - 0.24, 0.035, 0.035), 0.005, y=y, z=z)
    parts += bars
    return parts.join()
