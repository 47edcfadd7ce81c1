"""A made bed: frame with headboard, mattress, blanket, pillow."""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior, products
from l4d_blender.scene.catalogue import Range, colours, kind
from l4d_blender.scene.colour import Colour

TOP_M = 0.46


@kind(
    "bed",
    (0.98, 2.05, 0.85),
    "surface",
    front="-y",
    colour=colours("blanket"),
    width_m=Range("width_m", 0.7, 1.8),
)
def bed(
    name: str,
    rng: random.Random,
    *,
    blanket: Colour = (0.12, 0.20, 0.32),
    timber: Colour = (0.36, 0.215, 0.115),
    width_m: float = 0.98,
    length_m: float = 2.05,
) -> bpy.types.Object:
    """The head is at +Y; the top of the blanket is at `TOP_M`."""
    wood = interior.wood(f"{name}_wood", timber, rng, grain_axis="X")
    linen = interior.cloth(f"{name}_linen", (0.62, 0.60, 0.56), rng, slub_per_m=160)
    cover = interior.cloth(f"{name}_blanket", blanket, rng)
    stripe = products.woven_cloth(f"{name}_fold", products.scaled(blanket, 1.6), rng)
    half_x, half_y = width_m / 2, length_m / 2
    parts: list[bpy.types.Object] = []

    def block(
        size: tuple[float, float, float],
        at: tuple[float, float, float],
        bevel: float,
        material: bpy.types.Material,
    ) -> None:
        obj = mesh.bevel_box(f"{name}_part", size, bevel, 3)
        parts.append(mesh.set_material(mesh.move(obj, *at), material))

    block((width_m, 0.05, 0.85), (0.0, half_y - 0.025, 0.0), 0.012, wood)
    block((width_m, 0.05, 0.42), (0.0, 0.025 - half_y, 0.0), 0.012, wood)
    for side in (-1, 1):
        block((0.03, length_m - 0.08, 0.16), (side * (half_x - 0.015), 0.0, 0.16), 0.006, wood)
    block((width_m - 0.06, length_m - 0.11, 0.18), (0.0, 0.0, 0.24), 0.05, linen)
    block((width_m - 0.02, 0.66 * length_m, 0.20), (0.0, -0.16 * length_m, TOP_M - 0.20), 0.05, cover)
    block((width_m - 0.01, 0.22, 0.08), (0.0, 0.14 * length_m, TOP_M - 0.07), 0.03, stripe)
    for k in range(1 if width_m < 1.3 else 2):
        x = 0.0 if width_m < 1.3 else (k - 0.5) * width_m / 2
        block((min(0.6, width_m - 0.2), 0.36, 0.13), (x, half_y - 0.28, 0.40), 0.055, linen)
    return mesh.join(name, parts)
