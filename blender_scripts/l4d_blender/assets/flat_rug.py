"""A thin rug without fringes: round or oblong, in bands, checks or one colour."""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.assets.materials.base import Nodes
from l4d_blender.scene.catalogue import colours, kind, words
from l4d_blender.scene.colour import Colour


@kind(
    "rug",
    (2.0, 1.4, 0.008),
    "surface",
    colour=colours("ground"),
    accent=colours("accent"),
    pattern=words("pattern", "plain", "banded", "bordered", "rings", "checked"),
    shape=words("shape", "oblong", "round"),
)
def flat_rug(
    name: str,
    rng: random.Random,
    *,
    size_m: tuple[float, float] = (2.0, 1.4),
    ground: Colour = (0.45, 0.40, 0.32),
    accent: Colour = (0.16, 0.22, 0.30),
    pattern: str = "banded",
    shape: str = "oblong",
) -> bpy.types.Object:
    """Lies on z = 0; a round one is as wide as its length."""
    if shape == "round":
        sheet = mesh.cylinder(name, size_m[0] / 2, 0.008, 64, 0.003)
        half = (size_m[0] / 2, size_m[0] / 2)
    else:
        sheet = mesh.bevel_box(name, (*size_m, 0.008), 0.003, 1)
        half = (size_m[0] / 2, size_m[1] / 2)
    return mesh.set_material(sheet, _pile(f"{name}_pile", rng, ground, accent, pattern, shape, half))


def _pile(
    name: str,
    rng: random.Random,
    ground: Colour,
    accent: Colour,
    pattern: str,
    shape: str,
    half: tuple[float, float],
) -> bpy.types.Material:
    """Tufts in two colours."""
    material = bpy.data.materials.new(name)
    material.diffuse_color = (*ground, 1.0)
    n = Nodes(material)
    x, y, _ = n.separate(n.object_coords())
    across = n.math("SQRT", n.math("ADD", n.math("POWER", x, 2.0), n.math("POWER", y, 2.0)))
    edge_x = n.math("SUBTRACT", half[0], n.math("ABSOLUTE", x))
    edge_y = n.math("SUBTRACT", half[1], n.math("ABSOLUTE", y))
    edge = n.math("SUBTRACT", half[0], across) if shape == "round" else n.math("MINIMUM", edge_x, edge_y)
    period = rng.uniform(0.18, 0.34)

    def waves(coordinate: bpy.types.NodeSocket) -> bpy.types.NodeSocket:
        place = n.math("FRACT", n.math("ADD", n.math("DIVIDE", coordinate, period), 20.0))
        return n.math("LESS_THAN", place, rng.uniform(0.3, 0.5))

    if pattern == "banded":
        ink = waves(x)
    elif pattern == "rings":
        ink = waves(across)
    elif pattern == "checked":
        ink = n.math("MULTIPLY", n.math("ADD", waves(x), waves(y)), 0.5)
    elif pattern == "bordered":
        inner, outer = n.math("GREATER_THAN", edge, 0.07), n.math("LESS_THAN", edge, 0.19)
        ink = n.math("MULTIPLY", inner, outer)
    else:
        ink = n.math("LESS_THAN", edge, 0.03)
    tufts = n.noise(150.0, 3.0)
    colour = n.mix(ink, ground, accent)
    n.set("Base Color", n.mix(n.map_range(tufts, 0.3, 0.7, 0.0, 0.45), colour, products.scaled(ground, 0.5)))
    n.set("Roughness", 0.95)
    n.set("Specular IOR Level", 0.15)
    n.bump(tufts, 0.8, 0.004)
    return material
