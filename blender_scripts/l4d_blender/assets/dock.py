"""A wooden dock of cross planks on piles, a mooring post, a coil of rope. The deck's top is z = 0."""

from __future__ import annotations

import math
import random

import bpy
from mathutils import Matrix, Vector, noise

from l4d_blender.scene.catalogue import kind

from . import mesh
from .materials import outdoors
from .parts import Parts

PLANK_M = 0.036


@kind("dock", (4.0, 1.57, 1.32), "surface", "backdrop")
def dock(
    name: str,
    rng: random.Random,
    *,
    x_range: tuple[float, float] = (-3.0, 1.0),
    half_width_m: float = 0.66,
    bed_m: float = -1.2,
) -> bpy.types.Object:
    """Planks along Y over the range of x, two bearers, and piles that end a little above the deck."""
    planks, x = [], x_range[0]
    while x < x_range[1]:
        width = rng.uniform(0.115, 0.145)
        length = 2.0 * half_width_m + rng.uniform(-0.05, 0.05)
        plank = mesh.bevel_box(f"{name}_plank", (width, length, PLANK_M), 0.006, 2)
        place = Vector((x + width / 2, rng.uniform(-0.025, 0.025), -PLANK_M - rng.uniform(0.0, 0.002)))
        mesh.transform(plank, Matrix.Translation(place) @ Matrix.Rotation(rng.uniform(-0.008, 0.008), 4, "Z"))
        planks.append(plank)
        x += width + rng.uniform(0.006, 0.013)
    deck = mesh.join(f"{name}_deck", planks)
    mesh.set_material(deck, outdoors.weathered_wood(f"{name}_deck", (0.235, 0.190, 0.145), grain_axis="Y"))
    frame = Parts(f"{name}_beams")
    length = x_range[1] - x_range[0]
    for side in (-1.0, 1.0):
        bearer = mesh.bevel_box(f"{name}_bearer", (length - 0.1, 0.09, 0.15), 0.008, 1)
        frame.add(bearer, x=sum(x_range) / 2, y=side * (half_width_m - 0.16), z=-PLANK_M - 0.152)
    beams = frame.join()
    mesh.set_material(beams, outdoors.weathered_wood(f"{name}_beams", (0.15, 0.12, 0.09), grain_axis="X"))
    piles = []
    count = max(2, round(length / 1.35) + 1)
    for k in range(count):
        at = x_range[0] + 0.12 + (length - 0.24) * k / (count - 1)
        for side in (-1.0, 1.0):
            y = side * (half_width_m + 0.055)
            piles.append(_pile(f"{name}_pile", rng, at, y, bed_m, rng.uniform(0.05, 0.12), 0.055))
    posts = mesh.join(f"{name}_piles", piles)
    mesh.set_material(posts, outdoors.weathered_wood(f"{name}_piles", (0.17, 0.135, 0.10)))
    return mesh.join(name, [deck, beams, posts])


@kind("mooring_post", (0.21, 0.202, 1.82))
def mooring_post(
    name: str, rng: random.Random, *, bed_m: float = -1.2, top_m: float = 0.62
) -> bpy.types.Object:
    """A stout pile with turns of rope round its neck, at the origin."""
    pile = _pile(f"{name}_pile", rng, 0.0, 0.0, bed_m, top_m, 0.085)
    mesh.set_material(pile, outdoors.weathered_wood(f"{name}_wood", (0.19, 0.15, 0.11)))
    turns = Parts(f"{name}_rope")
    for k in range(3):
        ring = mesh.torus(f"{name}_turn", 0.090, 0.011, 28, 8)
        tilt = Matrix.Rotation(rng.uniform(-0.12, 0.12), 4, "X")
        turns.add(ring, within=Matrix.Translation((0, 0, top_m - 0.22 + 0.021 * k)) @ tilt)
    rope = mesh.set_material(turns.join(), outdoors.rope(f"{name}_hemp"))
    return mesh.join(name, [pile, rope])


@kind("rope", (0.515, 0.257, 0.055))
def rope_coil(name: str, rng: random.Random, *, radius_m: float = 0.13) -> bpy.types.Object:
    """A coil of rope that lies on the deck, its end trailing off."""
    points = []
    for k in range(110):
        angle = 2.0 * math.pi * k / 22
        layer = k // 44
        wide = radius_m - 0.022 * ((k / 22) % 2) - 0.010 * layer + rng.uniform(-0.002, 0.002)
        points.append(Vector((wide * math.cos(angle), wide * math.sin(angle), 0.010 + 0.018 * layer)))
    end = points[-1]
    points += [end + Vector((0.05 * k, 0.02 * math.sin(k), -min(0.036, 0.012 * k))) for k in range(1, 7)]
    coil = mesh.tube(name, points, 0.0095, segments=8)
    return mesh.set_material(coil, outdoors.rope(f"{name}_hemp"))


def _pile(
    name: str, rng: random.Random, x: float, y: float, bed_m: float, top_m: float, radius_m: float
) -> bpy.types.Object:
    stations = [bed_m, -0.5, -0.2, 0.0, top_m - 0.015, top_m]
    widths = [1.1, 1.06, 1.0, 1.0, 0.97, 0.80]
    lean = Vector((rng.uniform(-0.015, 0.015), rng.uniform(-0.015, 0.015), 0.0))
    points = [Vector((x, y, z)) + lean * z for z in stations]
    pile = mesh.tube(name, points, [radius_m * w for w in widths], segments=14)
    shift = Vector([rng.uniform(-9, 9) for _ in range(3)])
    return mesh.displace(pile, lambda p, n: 0.006 * noise.noise(p * 7.0 + shift))
