"""A coffee machine on a cabinet, with a stack of paper cups.

Owns the furniture; knows nothing of who drinks. It faces -Y and stands on z = 0.
"""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import colours, kind
from l4d_blender.scene.colour import Colour


@kind("machine", (0.96, 0.512, 1.3), front="-y", colour=colours("enamel"))
def coffee_machine(
    name: str, rng: random.Random, *, enamel: Colour = (0.36, 0.035, 0.03)
) -> bpy.types.Object:
    """Cabinet 0.82 m tall with two doors, machine 0.48 m tall on it."""
    wood = products.wood(f"{name}_wood", (0.46, 0.31, 0.17), (0.28, 0.17, 0.085), rng, grain_axis="Z")
    dark = products.satin_plastic(f"{name}_dark", (0.022, 0.022, 0.024), rng)
    steel = products.metal(f"{name}_steel", (0.56, 0.56, 0.57), rng, roughness=0.25)
    paint = products.lacquer(f"{name}_enamel", enamel, rng)
    lamp = products.glow(f"{name}_display", (0.25, 0.75, 0.95), 1.4)
    paper = products.paper(f"{name}_cups", (0.72, 0.68, 0.60), rng)
    parts = Parts(name)

    def block(
        size: tuple[float, float, float],
        at: tuple[float, float, float],
        material: bpy.types.Material,
        b: float = 0.006,
    ) -> None:
        parts.add(mesh.move(mesh.bevel_box(f"{name}_part", size, b), *at), material)

    block((0.92, 0.46, 0.74), (0.0, 0.0, 0.06), wood)
    block((0.86, 0.40, 0.06), (0.0, 0.02, 0.0), dark)
    block((0.96, 0.50, 0.025), (0.0, 0.0, 0.80), dark)
    for side in (-1, 1):
        block((0.44, 0.018, 0.68), (0.225 * side, -0.235, 0.09), wood)
        block((0.014, 0.020, 0.14), (0.035 * side, -0.252, 0.46), steel, 0.004)
    x, z = -0.16, 0.825
    block((0.34, 0.38, 0.06), (x, 0.0, z), dark, 0.012)
    block((0.34, 0.20, 0.42), (x, 0.09, z + 0.05), paint, 0.025)
    block((0.34, 0.38, 0.15), (x, 0.0, z + 0.33), paint, 0.025)
    block((0.20, 0.008, 0.055), (x, -0.192, z + 0.385), lamp, 0.003)
    block((0.26, 0.16, 0.012), (x, -0.09, z + 0.058), steel, 0.003)
    for k in (-1, 1):
        parts.cylinder("spout", steel, 0.012, 0.05, 16, x=x + 0.03 * k, y=-0.10, z=z + 0.285)
    for k, (cx, cy, tall) in enumerate(((0.16, 0.02, 9), (0.26, -0.05, 5), (0.34, 0.08, 7))):
        for n in range(tall):
            rim = mesh.lathe(
                f"{name}_cup{k}", [(0.027, 0.0), (0.036, 0.082), (0.0385, 0.085), (0.036, 0.087)], 20
            )
            parts.add(rim, paper, x=cx, y=cy, z=z + 0.011 * n, turn=("Z", 9.0 * n))
    return parts.join()
