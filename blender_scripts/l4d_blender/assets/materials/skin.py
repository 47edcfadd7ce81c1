"""What people are covered with: skin, nails, hair, eyes, cloth and leather.

All textures read `rest_position` (see mesh.store_rest_position), so they stick to bodies that bend.
Skin multiplies in the vertex colour `tint`, hair reads the vertex vector `strand` (turns, metres down).
"""

from __future__ import annotations

import bpy

from ...scene.colour import Colour
from .base import Nodes

PATTERNS = ("plain", "stripes", "checks", "dots", "denim")


def skin(name: str, colour: Colour) -> bpy.types.Material:
    """Skin: blotches of warmer and paler colour, fine pores, a soft sheen."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    coords = n.rest_coords()
    warm = (min(colour[0] * 1.04, 1.0), colour[1] * 0.86, colour[2] * 0.80)
    pale = tuple(min(c * 1.06, 1.0) for c in colour)
    blotches = n.ramp(n.noise(28.0, 3.0, vector=coords), [(0.32, warm), (0.68, pale)])
    tinted = n.mix(1.0, blotches, n.attribute("tint", "Color"), blend="MULTIPLY")
    n.set("Base Color", tinted)
    n.set("Roughness", n.map_range(n.noise(60.0, 2.0, vector=coords), 0.3, 0.7, 0.42, 0.58))
    n.set("Specular IOR Level", 0.4)
    n.set("Sheen Weight", 0.08)
    n.bump(n.noise(700.0, 2.0, vector=coords), 0.25, 0.0004)
    material.diffuse_color = (*colour[:3], 1.0)
    return material


def hair(name: str, colour: Colour) -> bpy.types.Material:
    """Hair: locks and strands that run along the second strand coordinate."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    strand = n.attribute("strand", "Vector")
    locks = n.noise(1.0, 3.0, vector=n.mapping(strand, scale=(26.0, 5.0, 5.0)))
    fine = n.noise(1.0, 2.0, vector=n.mapping(strand, scale=(120.0, 9.0, 9.0)))
    dark = tuple(c * 0.45 for c in colour)
    light = tuple(min(c * 1.7 + 0.015, 1.0) for c in colour)
    n.set("Base Color", n.ramp(n.mix(0.45, locks, fine), [(0.3, dark), (0.5, colour), (0.72, light)]))
    n.set("Roughness", 0.42)
    n.set("Specular IOR Level", 0.45)
    n.bump(n.mix(0.5, locks, fine), 0.9, 0.006)
    material.diffuse_color = (*colour[:3], 1.0)
    return material


def cloth(
    name: str,
    colour: Colour,
    *,
    pattern: str = "plain",
    second: Colour = (0.9, 0.88, 0.82),
    repeat_m: float = 0.05,
    level: str = "z",
) -> bpy.types.Material:
    """Woven cloth: thread bump, wear and shade.

    Patterns repeat every `repeat_m`; stripes follow each other along the rest axis `level` (z on bodies, y on
    an arm that lies).
    """
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    coords = n.rest_coords()
    base = _pattern(n, coords, colour, second, pattern, repeat_m, level)
    shade = n.ramp(n.noise(9.0, 4.0, vector=coords), [(0.28, 0.78), (0.72, 1.0)])
    base = n.mix(1.0, base, shade, blend="MULTIPLY")
    thread = n.mix(
        0.5,
        n.noise(1.0, 1.0, vector=n.mapping(coords, scale=(900.0, 900.0, 120.0))),
        n.noise(1.0, 1.0, vector=n.mapping(coords, scale=(150.0, 150.0, 900.0))),
    )
    if pattern == "denim":
        base = n.mix(n.map_range(thread, 0.45, 0.62), base, tuple(0.55 * c + 0.22 for c in colour))
    base = n.mix(0.35, base, n.ramp(thread, [(0.3, 0.55), (0.7, 1.0)]), blend="MULTIPLY")
    n.set("Base Color", base)
    n.set("Roughness", 0.88)
    n.set("Specular IOR Level", 0.18)
    n.set("Sheen Weight", 0.18)
    wrinkle = n.noise(22.0, 3.0, vector=n.mapping(coords, scale=(1.0, 1.0, 1.6)), distortion=0.6)
    n.bump(n.mix(0.16, wrinkle, thread), 0.75, 0.009)
    material.diffuse_color = (*colour[:3], 1.0)
    return material


def _pattern(n: Nodes, coords, colour: Colour, second: Colour, pattern: str, repeat_m: float, level: str):
    x, y, z = n.separate(coords)
    if level == "y":
        z = y
    if pattern == "stripes":
        return n.mix(_band(n, z, repeat_m, 0.42), colour, second)
    if pattern == "checks":
        level, upright = _band(n, z, repeat_m, 0.5), _band(n, x, repeat_m, 0.5)
        half = tuple(0.5 * (a + b) for a, b in zip(colour, second))
        return n.mix(level, n.mix(upright, colour, half), n.mix(upright, half, second))
    if pattern == "dots":
        cells = n.voronoi(1.0 / repeat_m, randomness=0.25, vector=coords)
        return n.mix(n.map_range(cells, 0.30, 0.34), second, colour)
    return n.mix(0.0, colour, second)


def _band(n: Nodes, coordinate, repeat_m: float, share: float):
    phase = n.math("FRACT", n.math("MULTIPLY", n.math("ADD", coordinate, 10.0), 1.0 / repeat_m))
    return n.math("LESS_THAN", phase, share)


def leather(name: str, colour: Colour) -> bpy.types.Material:
    """Leather or rubber of shoes: creased, scuffed, half glossy."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    coords = n.rest_coords()
    scuffs = n.noise(45.0, 5.0, vector=coords)
    dark, light = tuple(c * 0.6 for c in colour), tuple(min(c * 1.35 + 0.02, 1.0) for c in colour)
    n.set("Base Color", n.ramp(scuffs, [(0.3, dark), (0.55, colour), (0.75, light)]))
    n.set("Roughness", n.map_range(scuffs, 0.35, 0.7, 0.35, 0.65))
    n.bump(n.voronoi(260.0, vector=coords), 0.25, 0.0008)
    material.diffuse_color = (*colour[:3], 1.0)
    return material


def gloss(name: str, colour: Colour, roughness: float = 0.15) -> bpy.types.Material:
    """Small smooth things: the white, the iris and the pupil of an eye, buttons, nails."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    n.set("Base Color", colour)
    n.set("Roughness", roughness)
    material.diffuse_color = (*colour[:3], 1.0)
    return material
