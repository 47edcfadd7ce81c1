"""How dogs look: fur whose colour the mesh brings (attribute "coat"), eyes, tongue, woven collars.

Expects "rest_position" on the skinned mesh; knows no shapes.
"""

from __future__ import annotations

import bpy

from ...scene.colour import Colour, rgb
from .base import Nodes, principled

COLLARS: dict[str, Colour] = {
    "red": (0.48, 0.020, 0.018),
    "blue": (0.020, 0.090, 0.42),
    "green": (0.030, 0.24, 0.060),
    "orange": (0.70, 0.20, 0.02),
    "yellow": (0.72, 0.46, 0.03),
    "purple": (0.20, 0.05, 0.32),
}


def fur(name: str) -> bpy.types.Material:
    """Hair that lies back along the body: streaks and tufts over the painted colour."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    rest = n.rest_coords()
    hairs = n.noise(150.0, 3.0, vector=n.mapping(rest, scale=(1.0, 0.18, 0.5)))
    tufts = n.noise(30.0, 3.0, vector=n.mapping(rest, scale=(1.0, 0.45, 0.9)))
    ticking = n.math("ADD", n.math("MULTIPLY", hairs, 0.5), n.math("MULTIPLY", tufts, 0.5))
    paint = n.attribute("coat", "Color")
    shade = n.hue(paint, value=n.map_range(ticking, 0.34, 0.66, 0.62, 1.30))
    n.set("Base Color", shade)
    n.set("Roughness", 0.75)
    n.set("Specular IOR Level", 0.25)
    n.set("Sheen Weight", 0.25)
    n.set("Sheen Roughness", 0.4)
    n.set("Sheen Tint", shade)
    n.bump(n.math("ADD", n.math("MULTIPLY", hairs, 0.5), tufts), 0.9, 0.007)
    return material


def eye(name: str, iris: Colour) -> bpy.types.Material:
    """A dark, wet eye."""
    return principled(name, rgb(0.5 * c for c in iris), roughness=0.06, specular=0.9)


def tongue(name: str) -> bpy.types.Material:
    """Wet pink."""
    return principled(name, (0.48, 0.13, 0.13), roughness=0.3)


def collar(name: str, colour: str) -> bpy.types.Material:
    """Woven nylon."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    base = COLLARS[colour]
    weave = n.wave(90.0, axis="DIAGONAL", vector=n.rest_coords())
    n.set("Base Color", n.ramp(weave, [(0.2, tuple(0.6 * c for c in base)), (0.8, base)]))
    n.set("Roughness", 0.55)
    return material
