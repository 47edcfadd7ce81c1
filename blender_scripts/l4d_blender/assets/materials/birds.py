"""How water birds look: feathers whose colour the mesh brings, horn, webbed skin, eyes.

Expects the attributes "plumage" (colour) and "rest_position" (metres) on the mesh; knows no shapes.
"""

from __future__ import annotations

import bpy

from ...scene.colour import Colour, rgb
from .base import Nodes, principled


def _painted(name: str, roughness: float) -> tuple[bpy.types.Material, Nodes]:
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    n.set("Roughness", roughness)
    return material, n


def plumage_surface(name: str, mottle: float) -> bpy.types.Material:
    """Feathers over the painted colour: faint scales, or (mottle 1) dark centres with pale edges."""
    material, n = _painted(name, 0.62)
    coords = n.mapping(n.rest_coords(), scale=(1.0, 0.55, 1.0))
    cells = n.voronoi(70.0 if mottle else 95.0, vector=coords)
    tone = n.separate(cells.node.outputs["Color"])[0]
    paint = n.attribute("plumage", "Color")
    if mottle > 0.0:
        edge = n.map_range(cells, 0.30, 0.55, 0.0, 1.0)
        dark = n.mix(mottle, paint, n.mix(1.0, paint, (0.26, 0.22, 0.20), blend="MULTIPLY"))
        light = n.mix(1.0, paint, (1.45, 1.40, 1.30), blend="MULTIPLY")
        colour = n.mix(edge, n.mix(n.map_range(tone, 0.2, 0.8, 0.25, 1.0), paint, dark), light)
    else:
        shade = n.map_range(cells, 0.25, 0.60, 1.0, 0.86)
        colour = n.hue(paint, value=n.math("MULTIPLY", shade, n.map_range(tone, 0.0, 1.0, 0.94, 1.05)))
    n.set("Base Color", colour)
    n.set("Sheen Weight", 0.12)
    n.set("Specular IOR Level", 0.3)
    return material


def beak(name: str) -> bpy.types.Material:
    """Smooth horn in the painted colour."""
    material, n = _painted(name, 0.35)
    n.set("Base Color", n.attribute("plumage", "Color"))
    return material


def scales(name: str) -> bpy.types.Material:
    """Fine-scaled, slightly wet skin of legs and webs."""
    material, n = _painted(name, 0.42)
    cells = n.voronoi(420.0, vector=n.rest_coords())
    n.set("Base Color", n.hue(n.attribute("plumage", "Color"), value=n.map_range(cells, 0.2, 0.7, 1.0, 0.7)))
    return material


def eye(name: str, iris: Colour) -> bpy.types.Material:
    """A wet bead; the iris is too small to be drawn."""
    dark = rgb(0.5 * c for c in iris)
    return principled(name, dark, roughness=0.08, specular=0.8)
