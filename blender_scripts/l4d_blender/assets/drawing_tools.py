"""A wooden ruler and a rubber in its paper sleeve.

Owns both; each lies on z = 0 along X.
"""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.lettering import lettering
from l4d_blender.assets.materials import products
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import colours, kind
from l4d_blender.scene.colour import Colour


@kind("ruler", (0.21, 0.033, 0.004), "graspable", "pushable")
def ruler(name: str, rng: random.Random, *, length_m: float = 0.21) -> bpy.types.Object:
    """A ruler of beech with engraved centimetres and a steel edge."""
    beech = products.wood(f"{name}_beech", (0.60, 0.42, 0.22), (0.44, 0.28, 0.13), rng, grain_axis="X")
    ink = products.satin_plastic(f"{name}_ink", (0.03, 0.025, 0.02), rng, roughness=0.7)
    edge = mesh.bevel_box(f"{name}_edge", (length_m, 0.0014, 0.0040), 0.0003, segments=1)
    parts = Parts(name)
    parts.box("board", beech, (length_m, 0.032, 0.0036), 0.001, segments=2)
    parts.add(edge, products.metal(f"{name}_steel", (0.6, 0.6, 0.62), rng), y=0.0163)
    for k in range(int(length_m / 0.005) - 1):
        x = -0.5 * length_m + 0.005 * (k + 1)
        tall = 0.009 if k % 2 else 0.005
        parts.box("mark", ink, (0.0005, tall, 0.0002), x=x, y=0.0150 - 0.5 * tall, z=0.0036)
        if k % 2 and k > 1:
            parts.add(lettering(f"{name}_digits", str((k + 1) // 2), 0.0045), ink, x=x, y=-0.002, z=0.0038)
    return parts.join()


@kind("eraser", (0.052, 0.023, 0.014), "graspable", "pushable", colour=colours("sleeve"))
def rubber(name: str, rng: random.Random, *, sleeve: Colour = (0.05, 0.13, 0.36)) -> bpy.types.Object:
    """A white rubber, worn round at one end."""
    white = products.satin_plastic(f"{name}_white", (0.70, 0.69, 0.66), rng, roughness=0.85)
    card = products.paper(f"{name}_sleeve", sleeve, rng)
    stripe = products.paper(f"{name}_stripe", (0.72, 0.70, 0.64), rng)
    parts = Parts(name)
    parts.box("block", white, (0.052, 0.022, 0.0125), 0.004, segments=4)
    parts.box("wrap", card, (0.036, 0.0228, 0.0133), 0.0008, segments=1, x=0.006, z=-0.0004)
    parts.box("line", stripe, (0.009, 0.0230, 0.0136), 0.0008, segments=1, x=0.006, z=-0.0005)
    return mesh.drop_to_base(parts.join())
