"""How a lakeside looks: water, lily leaves and petals, reeds, painted planks.

Knows surfaces; refuses to know shapes.
"""

from __future__ import annotations

import bpy

from ...scene.colour import Colour
from .base import Nodes, principled


def lake_water(name: str) -> bpy.types.Material:
    """Deep water under a light breeze: dark, glossy, opaque; small ripples over longer ones."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    place = n.world_position()
    murk = n.noise(0.5, 2.0, vector=place)
    n.set("Base Color", n.ramp(murk, [(0.3, (0.012, 0.034, 0.034)), (0.7, (0.030, 0.058, 0.046))]))
    n.set("Roughness", 0.06)
    n.set("Specular IOR Level", 0.6)
    long = n.noise(1.0, 2.0, roughness=0.5, vector=n.mapping(place, scale=(1.6, 3.4, 1.0)))
    short = n.noise(1.0, 2.0, roughness=0.55, vector=n.mapping(place, scale=(9.0, 17.0, 1.0)))
    for socket in (long, short):
        socket.node.noise_dimensions = "2D"
    n.bump(n.math("ADD", long, n.math("MULTIPLY", short, 0.22)), 0.55, 0.055)
    return material


def lily_leaf(name: str) -> bpy.types.Material:
    """Waxy leaf, darker towards the rim."""
    return principled(
        name, (0.075, 0.155, 0.035), roughness=0.32, variation=0.45, variation_scale=14.0, specular=0.4
    )


def petals(name: str) -> bpy.types.Material:
    """White petals with a breath of yellow."""
    return principled(name, (0.80, 0.78, 0.66), roughness=0.5, variation=0.12, variation_scale=60.0)


def reed(name: str, tone: Colour = (0.20, 0.235, 0.060)) -> bpy.types.Material:
    """Reed blades, each (mesh island) between green and straw, paler towards the tip."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    each = n.node("ShaderNodeNewGeometry").outputs["Random Per Island"]
    blade = n.ramp(
        each,
        [
            (0.0, tuple(0.45 * c for c in tone)),
            (0.5, tone),
            (0.85, (0.38, 0.33, 0.12)),
            (1.0, (0.5, 0.42, 0.2)),
        ],
    )
    height = n.separate(n.object_coords())[2]
    foot = n.map_range(height, 0.35, -0.25, 0.0, 0.75)
    n.set("Base Color", n.mix(foot, blade, (0.055, 0.050, 0.022)))
    n.set("Roughness", 0.65)
    return material


def cattail(name: str) -> bpy.types.Material:
    """The velvet of a bulrush head."""
    return principled(name, (0.125, 0.058, 0.026), roughness=0.95, variation=0.4, variation_scale=90.0)


def boat_paint(name: str, colour: Colour) -> bpy.types.Material:
    """Paint on planks, worn along the grain."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    streaks = n.noise(1.0, 4.0, roughness=0.7, vector=n.mapping(n.object_coords(), scale=(18.0, 1.4, 18.0)))
    paint = n.ramp(streaks, [(0.35, tuple(0.6 * c for c in colour)), (0.62, colour)])
    n.set("Base Color", n.mix(n.map_range(streaks, 0.62, 0.72), paint, (0.26, 0.20, 0.14)))
    n.set("Roughness", 0.5)
    return material


def enamel(name: str, colour: Colour) -> bpy.types.Material:
    """Thick glaze on a dish, with faint crazing."""
    return principled(name, colour, roughness=0.18, variation=0.10, variation_scale=25.0, coat=0.3)
