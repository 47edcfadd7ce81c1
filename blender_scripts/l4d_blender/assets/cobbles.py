"""A paved square: rows of granite setts with sandy joints, level where people act. Scenery."""

from __future__ import annotations

import random

import bpy

from l4d_blender.scene.catalogue import kind

from . import mesh
from .materials.base import Nodes


@kind("paving", (120.0, 120.0, 0.0), "backdrop")
def cobbles(name: str, rng: random.Random, *, radius_m: float = 60.0) -> bpy.types.Object:
    """A flat disc whose top is z = 0."""
    plane = mesh.grid(name, 2 * radius_m, 2 * radius_m, 8, 8)
    return mesh.set_material(plane, _setts(f"{name}_setts"))


def _setts(name: str) -> bpy.types.Material:
    """Stones of several greys, worn bright in the middle, damp in places."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    wobble = n.noise(6.0, 2.0, output="Color")
    coords = n.vector_math("ADD", n.object_coords(), n.vector_math("SCALE", wobble))
    coords.node.inputs[1].links[0].from_node.inputs["Scale"].default_value = 0.022
    brick, joint = n.brick(
        1.0,
        ((0.17, 0.155, 0.14), (0.34, 0.305, 0.265)),
        (0.12, 0.095, 0.07),
        vector=coords,
        width=0.17,
        height=0.115,
        mortar_size=0.010,
    )
    broad = n.noise(0.5, 3.0)
    grain = n.noise(45.0, 3.0, roughness=0.7)
    stone = n.mix(n.map_range(grain, 0.35, 0.75, 0.0, 0.5), brick, (0.44, 0.40, 0.35))
    n.set("Base Color", n.mix(n.map_range(broad, 0.52, 0.70, 0.0, 0.55), stone, (0.10, 0.09, 0.08)))
    n.set("Roughness", n.map_range(broad, 0.52, 0.70, 0.85, 0.45))
    n.bump(n.math("SUBTRACT", n.math("MULTIPLY", grain, 0.35), joint), 0.8, 0.012)
    material.diffuse_color = (0.25, 0.22, 0.19, 1.0)
    return material
