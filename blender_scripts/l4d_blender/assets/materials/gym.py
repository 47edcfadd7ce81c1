"""Surfaces of a gym: speckled rubber, brick, vinyl, powder coat, knurled steel, cast plates.

Owns colours, patterns, roughness and bump in object coordinates (metres). Refuses to know shapes.
"""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets.materials.base import Nodes
from l4d_blender.assets.materials.products import scaled
from l4d_blender.scene.colour import Colour


def _start(name: str, colour: Colour) -> tuple[bpy.types.Material, Nodes]:
    material = bpy.data.materials.new(name)
    material.diffuse_color = (*tuple(colour)[:3], 1.0)
    return material, Nodes(material)


def rubber_floor(name: str, rng: random.Random, *, tile_m: float = 0.98) -> bpy.types.Material:
    """Recycled rubber tiles in the XY plane: black granules with blue and grey flecks, scuffed."""
    material, n = _start(name, (0.045, 0.046, 0.05))
    at = n.vector_math("ADD", n.object_coords(), tuple(rng.uniform(-9, 9) for _ in range(3)))
    tiles, seam = n.brick(
        1.0,
        ((0.036, 0.037, 0.040), (0.056, 0.057, 0.062)),
        (0.010, 0.010, 0.010),
        width=tile_m,
        height=tile_m,
        mortar_size=0.004,
        offset=0.0,
    )
    flecks = n.voronoi(130, vector=at)
    which = n.voronoi(130, vector=at, output="Color")
    tint = n.ramp(
        n.separate(which)[0],
        [(0.0, (0.10, 0.16, 0.28)), (0.5, (0.30, 0.31, 0.32)), (1.0, (0.20, 0.22, 0.24))],
        interpolation="CONSTANT",
    )
    chosen = n.math(
        "MULTIPLY", n.math("GREATER_THAN", n.separate(which)[1], 0.72), n.math("LESS_THAN", flecks, 0.30)
    )
    scuffs = n.noise(2.6, 5, vector=at)
    base = n.hue(n.mix(chosen, tiles, tint), value=n.map_range(scuffs, 0.3, 0.75, 0.8, 1.5))
    n.set("Base Color", base)
    n.set("Roughness", n.map_range(scuffs, 0.3, 0.7, 0.55, 0.8))
    n.bump(n.math("SUBTRACT", n.noise(230, 2, vector=at), n.math("MULTIPLY", seam, 2.0)), 0.4, 0.002)
    return material


def brickwork(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """An old brick wall in the XZ plane: each brick burnt differently, sandy joints, limewash remains."""
    material, n = _start(name, colour)
    x, y, z = n.separate(n.object_coords())
    wobble = n.math("MULTIPLY", n.math("SUBTRACT", n.noise(22, 2), 0.5), 0.006)
    at = n.combine(n.math("ADD", n.math("ADD", x, y), wobble), n.math("ADD", z, wobble), 0.0)
    bricks, joint = n.brick(
        1.0,
        (scaled(colour, 0.55), scaled(colour, 1.3)),
        (0.34, 0.31, 0.27),
        vector=at,
        width=0.225,
        height=0.075,
        mortar_size=0.006,
    )
    grit, wash = (
        n.noise(90, 4),
        n.noise(1.3, 5, vector=n.vector_math("ADD", n.object_coords(), (rng.uniform(-9, 9), 0, 0))),
    )
    tone = n.hue(bricks, value=n.map_range(grit, 0.25, 0.75, 0.75, 1.2))
    n.set("Base Color", n.mix(n.map_range(wash, 0.58, 0.72, 0.0, 0.55), tone, (0.50, 0.47, 0.43)))
    n.set("Roughness", 0.9)
    n.bump(n.math("SUBTRACT", n.math("MULTIPLY", grit, 0.5), joint), 0.8, 0.006)
    return material


def vinyl(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """Padded imitation leather: fine grain, creases, sweat-polished patches."""
    material, n = _start(name, colour)
    at = n.vector_math("ADD", n.object_coords(), tuple(rng.uniform(-9, 9) for _ in range(3)))
    grain, patches = n.voronoi(420, vector=at), n.noise(6, 3, vector=at)
    n.set("Base Color", n.mix(n.map_range(patches, 0.3, 0.7), scaled(colour, 0.8), scaled(colour, 1.2)))
    n.set("Roughness", n.map_range(patches, 0.3, 0.7, 0.32, 0.5))
    n.bump(n.math("ADD", grain, n.noise(18, 3, vector=at)), 0.25, 0.0015)
    return material


def powder_coat(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """Painted steel tube: orange peel, chips that show dark primer."""
    material, n = _start(name, colour)
    at = n.vector_math("ADD", n.object_coords(), tuple(rng.uniform(-9, 9) for _ in range(3)))
    peel, chips = n.noise(320, 2, vector=at), n.noise(34, 4, vector=at)
    n.set(
        "Base Color",
        n.mix(
            n.map_range(chips, 0.70, 0.74),
            n.hue(colour, value=n.map_range(chips, 0.3, 0.7, 0.9, 1.08)),
            (0.05, 0.05, 0.05),
        ),
    )
    n.set("Roughness", 0.38)
    n.bump(peel, 0.2, 0.0005)
    return material


def cast(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """Rubber-coated or painted iron of weights: grainy, worn paler at the edges by bumps and scuffs."""
    material, n = _start(name, colour)
    at = n.vector_math("ADD", n.object_coords(), tuple(rng.uniform(-9, 9) for _ in range(3)))
    grain, scuffs = n.noise(260, 3, vector=at), n.noise(17, 4, vector=at)
    tone = n.mix(
        n.map_range(scuffs, 0.60, 0.72, 0.0, 0.5), colour, tuple(min(1.0, 1.5 * c + 0.06) for c in colour)
    )
    n.set("Base Color", n.hue(tone, value=n.map_range(grain, 0.3, 0.7, 0.85, 1.12)))
    n.set("Roughness", n.map_range(scuffs, 0.3, 0.7, 0.42, 0.62))
    n.bump(grain, 0.3, 0.0009)
    return material


def knurled_steel(name: str, rng: random.Random) -> bpy.types.Material:
    """A chromed bar with a diamond pattern round its axis (Y)."""
    material, n = _start(name, (0.5, 0.5, 0.52))
    at = n.vector_math("ADD", n.object_coords(), tuple(rng.uniform(-9, 9) for _ in range(3)))
    diamonds = n.voronoi(520, vector=at)
    n.set(
        "Base Color",
        n.mix(n.map_range(n.noise(30, 3, vector=at), 0.3, 0.7), (0.42, 0.42, 0.43), (0.64, 0.64, 0.65)),
    )
    n.set("Metallic", 1.0)
    n.set("Roughness", 0.3)
    n.bump(diamonds, 0.4, 0.0008)
    return material


def belt(name: str, rng: random.Random) -> bpy.types.Material:
    """A treadmill's running belt: black weave with pale worn lines along Y."""
    material, n = _start(name, (0.03, 0.03, 0.032))
    at = n.vector_math("ADD", n.object_coords(), (rng.uniform(-9, 9), 0.0, 0.0))
    worn = n.noise(9, 3, vector=n.mapping(at, scale=(1.0, 0.08, 1.0)))
    n.set("Base Color", n.mix(n.map_range(worn, 0.45, 0.7), (0.022, 0.022, 0.024), (0.075, 0.075, 0.078)))
    n.set("Roughness", 0.6)
    n.bump(n.noise(300, 2, vector=at), 0.4, 0.0008)
    return material
