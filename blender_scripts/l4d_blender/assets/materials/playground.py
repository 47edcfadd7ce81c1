"""Surfaces of playgrounds: poured rubber granulate, sand, balls with painted marks.

Each function makes a new material. Knows surfaces; refuses to know shapes, except that balls bring an
attribute "mark".
"""

from __future__ import annotations

import random

import bpy

from ...scene.colour import Colour
from .base import Nodes
from .products import scaled

#: Paints of outdoor toys, linear RGB.
PAINTS: dict[str, Colour] = {
    "red": (0.56, 0.030, 0.022),
    "orange": (0.72, 0.20, 0.018),
    "yellow": (0.78, 0.46, 0.03),
    "green": (0.06, 0.30, 0.06),
    "light_green": (0.24, 0.47, 0.05),
    "blue": (0.025, 0.12, 0.46),
    "light_blue": (0.16, 0.42, 0.66),
    "purple": (0.20, 0.05, 0.30),
    "white": (0.76, 0.74, 0.68),
    "black": (0.025, 0.025, 0.028),
}


def rubber_granulate(name: str, colour: Colour, speck: Colour) -> bpy.types.Material:
    """A fall-safe floor of bonded rubber grains, bleached where the sun and many feet have been."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    grains = n.voronoi(110.0)
    grains.node.voronoi_dimensions = "2D"
    lot, tone, _ = n.separate(grains.node.outputs["Color"])
    base = n.ramp(tone, [(0.0, scaled(colour, 0.62)), (0.55, colour), (1.0, scaled(colour, 1.35))])
    base = n.mix(n.map_range(lot, 0.84, 0.88), base, speck)
    base = n.mix(n.map_range(lot, 0.08, 0.05), base, scaled(colour, 0.22))
    broad = n.noise(0.9, 3.0, roughness=0.6)
    broad.node.noise_dimensions = "2D"
    base = n.mix(n.map_range(broad, 0.50, 0.72, 0.0, 0.34), base, (0.52, 0.43, 0.33))
    base = n.mix(n.map_range(broad, 0.46, 0.30, 0.0, 0.40), base, scaled(colour, 0.45))
    n.set("Base Color", base)
    n.set("Roughness", 0.92)
    n.set("Specular IOR Level", 0.2)
    n.bump(grains, 0.5, 0.003)
    material.diffuse_color = (*colour, 1.0)
    return material


def sand(name: str, colour: Colour = (0.58, 0.44, 0.27)) -> bpy.types.Material:
    """Dry play sand with damp hollows and coarse grains."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    damp = n.noise(2.6, 4.0, roughness=0.6)
    grain = n.noise(160.0, 2.0, roughness=0.8)
    base = n.ramp(damp, [(0.30, scaled(colour, 0.52)), (0.5, colour), (0.75, scaled(colour, 1.22))])
    n.set("Base Color", n.mix(n.map_range(grain, 0.30, 0.70, 0.0, 0.45), base, scaled(colour, 0.62)))
    n.set("Roughness", 0.97)
    n.set("Specular IOR Level", 0.12)
    n.bump(n.noise(26.0, 4.0, roughness=0.7), 0.9, 0.012)
    material.diffuse_color = (*colour, 1.0)
    return material


def ball_skin(name: str, colour: Colour, mark: Colour, rng: random.Random) -> bpy.types.Material:
    """Inflated vinyl: painted where the attribute "mark" is positive, scuffed and dusty."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    place = n.vector_math("ADD", n.object_coords(), tuple(rng.uniform(-9.0, 9.0) for _ in range(3)))
    dirt = n.noise(9.0, 4.0, roughness=0.65, vector=place)
    painted = n.mix(n.map_range(n.attribute("mark"), -0.02, 0.02), colour, mark)
    n.set("Base Color", n.mix(n.map_range(dirt, 0.54, 0.78, 0.0, 0.50), painted, (0.30, 0.23, 0.16)))
    n.set("Roughness", n.map_range(dirt, 0.35, 0.7, 0.30, 0.62))
    n.bump(n.noise(300.0, 2.0, vector=place), 0.25, 0.0006)
    material.diffuse_color = (*colour, 1.0)
    return material
