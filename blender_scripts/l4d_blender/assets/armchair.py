"""A reading chair: the sofa's family with one seat, a tall back and slim arms."""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import cushion, mesh
from l4d_blender.assets.materials import interior
from l4d_blender.assets.parts import CORNERS, Parts
from l4d_blender.scene.catalogue import colours, kind


@kind("armchair", (0.712, 0.76, 0.908), "seat", front="-y", colour=colours("colour"))
def armchair(
    name: str, rng: random.Random, *, colour: tuple[float, float, float] = (0.18, 0.27, 0.30)
) -> bpy.types.Object:
    """Front to -Y, on four splayed legs."""
    cloth = interior.cloth(f"{name}_cloth", colour, rng)
    legs = interior.wood(f"{name}_legs", (0.42, 0.25, 0.12), rng, grain_axis="Z")
    width, depth, foot = 0.74, 0.76, 0.17
    frame = cushion.block(
        f"{name}_frame", rng, size_m=(width - 0.06, depth - 0.10, 0.13), bevel_m=0.03, puff_m=0.0
    )
    seat = cushion.block(
        f"{name}_seat", rng, size_m=(width - 0.24, depth - 0.20, 0.14), bevel_m=0.05, puff_m=0.02
    )
    back = cushion.block(f"{name}_back", rng, size_m=(width - 0.14, 0.16, 0.66), bevel_m=0.07, puff_m=0.03)
    parts = Parts(name)
    parts.add(frame, z=foot)
    parts.add(seat, y=-0.05, z=foot + 0.12)
    parts.add(back, y=depth / 2 - 0.17, z=foot + 0.06, turn=("X", -12))
    for side in (-1, 1):
        arm = cushion.block(f"{name}_arm", rng, size_m=(0.11, depth - 0.10, 0.34), bevel_m=0.05, puff_m=0.015)
        parts.add(arm, x=side * (width - 0.14) / 2, y=-0.02, z=foot + 0.05)
    for part in parts:
        mesh.set_material(part, cloth)
    for x, y in CORNERS:
        leg = mesh.cylinder(f"{name}_foot", 0.014, foot + 0.01, 16, top_radius=0.024)
        leg = mesh.rotate(mesh.rotate(leg, "Y", -6 * x), "X", 6 * y)
        parts.add(leg, legs, x=x * (width / 2 - 0.07), y=y * (depth / 2 - 0.12))
    return mesh.drop_to_base(parts.join())
