"""Surfaces of a kitchen: glazed tiles, stone worktops, painted fronts, steel, enamel and what boils in pots.

Owns colours, patterns, roughness and bump in object coordinates (metres). Refuses to know shapes.
"""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets.materials.base import Nodes, principled
from l4d_blender.assets.materials.products import scaled
from l4d_blender.scene.colour import Colour


def _start(name: str, colour: Colour) -> tuple[bpy.types.Material, Nodes]:
    material = bpy.data.materials.new(name)
    material.diffuse_color = (*tuple(colour)[:3], 1.0)
    return material, Nodes(material)


def wall_tiles(
    name: str, colour: Colour, rng: random.Random, *, size_m: tuple[float, float] = (0.20, 0.10)
) -> bpy.types.Material:
    """Glazed tiles in running bond on a wall in the XZ plane, each of its own tone."""
    material, n = _start(name, colour)
    x, y, z = n.separate(n.object_coords())
    tiles, grout = n.brick(
        1.0,
        (scaled(colour, 0.80), scaled(colour, 1.08)),
        (0.36, 0.34, 0.31),
        vector=n.combine(n.math("ADD", x, y), z, 0.0),
        width=size_m[0],
        height=size_m[1],
        mortar_size=0.0035,
    )
    glaze = n.noise(14, 3, vector=n.vector_math("ADD", n.object_coords(), (rng.uniform(-9, 9), 0.0, 0.0)))
    n.set("Base Color", n.hue(tiles, value=n.map_range(glaze, 0.3, 0.7, 0.9, 1.06)))
    n.set("Roughness", n.mix(grout, n.map_range(glaze, 0.3, 0.7, 0.14, 0.26), 0.85))
    n.bump(n.math("SUBTRACT", n.math("MULTIPLY", glaze, 0.25), grout), 0.6, 0.003)
    return material


def floor_tiles(name: str, colour: Colour, rng: random.Random, *, size_m: float = 0.30) -> bpy.types.Material:
    """Square clay tiles in the XY plane: every one burnt a little differently."""
    material, n = _start(name, colour)
    tiles, grout = n.brick(
        1.0,
        (scaled(colour, 0.72), scaled(colour, 1.15)),
        (0.20, 0.17, 0.14),
        width=size_m,
        height=size_m,
        mortar_size=0.005,
        offset=0.0,
    )
    flames = n.noise(5, 4, vector=n.vector_math("ADD", n.object_coords(), (rng.uniform(-9, 9), 0.0, 0.0)))
    n.set("Base Color", n.hue(tiles, value=n.map_range(flames, 0.3, 0.7, 0.75, 1.15)))
    n.set("Roughness", n.map_range(flames, 0.3, 0.7, 0.34, 0.55))
    n.bump(n.math("SUBTRACT", n.math("MULTIPLY", flames, 0.3), grout), 0.5, 0.003)
    return material


def worktop(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """Polished stone: grains of three sizes in light and dark."""
    material, n = _start(name, colour)
    at = n.vector_math("ADD", n.object_coords(), tuple(rng.uniform(-9, 9) for _ in range(3)))
    coarse, fine, clouds = n.voronoi(85, vector=at), n.noise(240, 3, vector=at), n.noise(4, 3, vector=at)
    base = n.mix(n.map_range(clouds, 0.3, 0.7), scaled(colour, 0.8), scaled(colour, 1.15))
    base = n.mix(n.map_range(fine, 0.55, 0.65), base, scaled(colour, 1.7))
    n.set("Base Color", n.mix(n.map_range(coarse, 0.34, 0.22), base, scaled(colour, 0.35)))
    n.set("Roughness", n.map_range(fine, 0.3, 0.7, 0.18, 0.34))
    return material


def painted_front(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """Eggshell paint on wood: brush marks along Z, rubbed paler where hands go."""
    material, n = _start(name, colour)
    at = n.vector_math("ADD", n.object_coords(), tuple(rng.uniform(-9, 9) for _ in range(3)))
    brush = n.noise(60, 3, vector=n.mapping(at, scale=(1.0, 1.0, 0.06)))
    worn = n.noise(3.2, 3, vector=at)
    tone = n.mix(n.map_range(worn, 0.35, 0.7), scaled(colour, 0.88), scaled(colour, 1.1))
    n.set("Base Color", n.hue(tone, value=n.map_range(brush, 0.3, 0.7, 0.93, 1.05)))
    n.set("Roughness", n.map_range(worn, 0.3, 0.7, 0.38, 0.5))
    n.bump(brush, 0.3, 0.0012)
    return material


def steel(name: str, rng: random.Random, *, roughness: float = 0.28) -> bpy.types.Material:
    """Spun stainless steel: fine rings round Z, water marks, finger marks."""
    material, n = _start(name, (0.56, 0.56, 0.57))
    at = n.vector_math("ADD", n.object_coords(), tuple(rng.uniform(-9, 9) for _ in range(3)))
    rings = n.noise(260, 2, vector=n.mapping(at, scale=(0.05, 0.05, 1.0)))
    marks = n.noise(18, 3, vector=at)
    n.set("Base Color", n.mix(n.map_range(marks, 0.3, 0.7), (0.46, 0.46, 0.47), (0.64, 0.64, 0.65)))
    n.set("Metallic", 1.0)
    n.set("Roughness", n.map_range(marks, 0.3, 0.7, roughness - 0.06, roughness + 0.10))
    n.bump(rings, 0.25, 0.0004)
    return material


def enamel(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """Vitreous enamel: deep gloss, cloudy tone, a dark rim colour must be painted apart."""
    material, n = _start(name, colour)
    at = n.vector_math("ADD", n.object_coords(), tuple(rng.uniform(-9, 9) for _ in range(3)))
    clouds, peel = n.noise(9, 3, vector=at), n.noise(120, 2, vector=at)
    n.set("Base Color", n.mix(n.map_range(clouds, 0.3, 0.7), scaled(colour, 0.75), scaled(colour, 1.15)))
    n.set("Roughness", n.map_range(clouds, 0.3, 0.7, 0.10, 0.2))
    n.set("Coat Weight", 0.3)
    n.bump(peel, 0.2, 0.0005)
    return material


def soup(name: str, colour: Colour, bits: Colour, rng: random.Random) -> bpy.types.Material:
    """The top of a thick soup: eyes of fat and pieces that float."""
    material, n = _start(name, colour)
    at = n.vector_math("ADD", n.object_coords(), (rng.uniform(-9, 9), rng.uniform(-9, 9), 0.0))
    pieces, eyes = n.voronoi(46, vector=at), n.noise(55, 3, vector=at, distortion=0.8)
    tone = n.mix(n.map_range(eyes, 0.35, 0.65), scaled(colour, 0.75), scaled(colour, 1.2))
    n.set("Base Color", n.mix(n.map_range(pieces, 0.26, 0.20), tone, bits))
    n.set("Roughness", 0.22)
    n.bump(n.math("SUBTRACT", eyes, n.map_range(pieces, 0.20, 0.36)), 0.6, 0.004)
    return material


def poured(name: str, colour: Colour) -> bpy.types.Material:
    """What falls from a jug: opaque, glossy, streaked along Z."""
    material, n = _start(name, colour)
    streaks = n.noise(40, 2, vector=n.mapping(n.object_coords(), scale=(3.0, 3.0, 0.2)))
    n.set("Base Color", n.mix(n.map_range(streaks, 0.3, 0.7), scaled(colour, 0.8), scaled(colour, 1.15)))
    n.set("Roughness", 0.18)
    return material


def cast_iron(name: str) -> bpy.types.Material:
    """Black grates and burner caps."""
    return principled(name, (0.022, 0.022, 0.024), roughness=0.55, variation=0.4, bump=(160, 0.0008))
