"""A self-healing cutting mat with a printed grid and the scars of many blades.

Owns the mat; knows nothing of what is done on it. It lies on z = 0, long side along Y.
"""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.assets.materials.base import Nodes
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.colour import Colour

THICKNESS_M = 0.003


@kind("mat", (0.45, 0.6, 0.003), "surface")
def cutting_mat(
    name: str,
    rng: random.Random,
    *,
    size_m: tuple[float, float] = (0.45, 0.6),
    colour: Colour = (0.035, 0.12, 0.085),
) -> bpy.types.Object:
    """A mat of (width, depth) ruled every centimetre, every fifth line brighter."""
    mat = mesh.bevel_box(name, (*size_m, THICKNESS_M), 0.001, segments=2)
    material = products.rubber(f"{name}_rubber", colour, rng)
    n = Nodes(material)
    x, y, _ = n.separate(n.object_coords())

    def lines(pitch: float, width: float):
        near = [
            n.math(
                "ABSOLUTE",
                n.math("SUBTRACT", n.math("FRACT", n.math("ADD", n.math("DIVIDE", c, pitch), 50.5)), 0.5),
            )
            for c in (x, y)
        ]
        return n.math("LESS_THAN", n.math("MINIMUM", *near), 0.5 * width / pitch)

    fine, bold = lines(0.01, 0.0004), lines(0.05, 0.0008)
    inside = n.math(
        "MULTIPLY",
        n.math("LESS_THAN", n.math("ABSOLUTE", x), 0.5 * size_m[0] - 0.018),
        n.math("LESS_THAN", n.math("ABSOLUTE", y), 0.5 * size_m[1] - 0.018),
    )
    ink = n.math(
        "MULTIPLY", n.math("MAXIMUM", n.math("MULTIPLY", fine, 0.35), n.math("MULTIPLY", bold, 0.8)), inside
    )
    scars = n.noise(240.0, 3.0, vector=n.mapping(n.object_coords(), rotation=(0, 0, 0.6), scale=(0.05, 1, 1)))
    worn = n.map_range(scars, 0.66, 0.70, 0.0, 0.5)
    dust = n.noise(9.0, 4.0)
    tone = n.ramp(dust, [(0.3, products.scaled(colour, 0.8)), (0.7, products.scaled(colour, 1.25))])
    tone = n.mix(worn, tone, products.scaled(colour, 2.2))
    n.set("Base Color", n.mix(ink, tone, (0.50, 0.52, 0.36)))
    return mesh.set_material(mat, material)
