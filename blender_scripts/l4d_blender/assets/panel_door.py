"""A shut door in its frame, with panels or a glazed upper half."""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.assets.materials.base import principled
from l4d_blender.scene.catalogue import colours, kind, words
from l4d_blender.scene.colour import Colour


@kind(
    "door",
    (1.05, 0.109, 2.12),
    "hangs",
    front="-y",
    colour=colours("leaf"),
    style=words("style", "panels", "flush", "glazed"),
)
def panel_door(
    name: str,
    rng: random.Random,
    *,
    leaf: Colour = (0.62, 0.60, 0.54),
    frame: Colour = (0.66, 0.64, 0.59),
    style: str = "panels",
) -> bpy.types.Object:
    """The wall is the plane y = 0, the room at -Y; the handle is on a drawn side."""
    paint = products.lacquer(f"{name}_leaf", leaf, rng)
    white = products.lacquer(f"{name}_frame", frame, rng)
    brass = products.metal(f"{name}_brass", (0.56, 0.42, 0.20), rng, roughness=0.28)
    parts: list[bpy.types.Object] = []

    def block(
        size: tuple[float, float, float], at: tuple[float, float, float], material: bpy.types.Material
    ) -> None:
        part = mesh.bevel_box(f"{name}_part", size, 0.006, 2)
        parts.append(mesh.set_material(mesh.move(part, *at), material))

    for side in (-1, 1):
        block((0.09, 0.06, 2.06), (0.48 * side, -0.02, 0.0), white)
    block((1.05, 0.06, 0.09), (0.0, -0.02, 2.03), white)
    block((0.87, 0.04, 2.02), (0.0, -0.012, 0.005), paint)
    if style == "panels":
        for x in (-0.20, 0.20):
            for z, tall in ((0.14, 0.72), (1.02, 0.46), (1.60, 0.32)):
                block((0.30, 0.012, tall), (x, -0.034, z), paint)
    elif style == "glazed":
        frosted = principled(f"{name}_pane", (0.52, 0.58, 0.58), roughness=0.12, variation=0.1)
        block((0.60, 0.012, 0.92), (0.0, -0.032, 0.98), frosted)
        block((0.56, 0.012, 0.60), (0.0, -0.034, 0.20), paint)
    side = rng.choice((-1, 1))
    block((0.04, 0.012, 0.18), (0.37 * side, -0.036, 0.95), brass)
    x = 0.37 * side
    lever = mesh.tube(
        f"{name}_lever", [(x, -0.04, 1.06), (x, -0.085, 1.06), (x - 0.11 * side, -0.09, 1.06)], 0.009, 10
    )
    parts.append(mesh.set_material(lever, brass))
    return mesh.join(name, parts)
