"""Broad-leaved trees, hedges and bushes: limbs, a dark inner mass, and leaf sprays over it.

Owns crowns near enough to show leaves, and the cheap crowns of a skyline. Repeats are made by the recipe
with `mesh.duplicate(..., linked=True)`. Scenery only.
"""

from __future__ import annotations

import math
import random
from collections.abc import Sequence

import bpy
import numpy as np
from mathutils import Vector, noise

from l4d_blender.scene.catalogue import kind

from ..scene.colour import rgb
from . import mesh
from .materials import outdoors

#: A crown is a set of balls: (centre, radius in metres).
Balls = Sequence[tuple[Vector, float]]


def _sprays(
    name: str, rng: random.Random, balls: Balls, *, count: int, size_m: tuple[float, float]
) -> bpy.types.Object:
    """Leaf sprays near the surface of the balls: folded quads that hang a little."""
    draw = np.random.default_rng(rng.getrandbits(64))
    share = np.array([radius**2 for _, radius in balls])
    which = draw.choice(len(balls), count, p=share / share.sum())
    centres = np.array([tuple(centre) for centre, _ in balls])[which]
    radii = np.array([radius for _, radius in balls])[which]
    out = draw.normal(0.0, 1.0, (count, 3))
    out[:, 2] = out[:, 2] * 0.8 + 0.12
    out /= np.linalg.norm(out, axis=1)[:, None]
    place = centres + out * (radii * draw.uniform(0.78, 1.18, count))[:, None]
    axis = out + draw.normal(0.0, 0.55, (count, 3)) - np.array([0.0, 0.0, 0.45])
    axis /= np.linalg.norm(axis, axis=1)[:, None]
    across = np.cross(axis, out + draw.normal(0.0, 0.4, (count, 3)))
    across /= np.linalg.norm(across, axis=1)[:, None]
    fold = np.cross(across, axis)
    size = draw.uniform(*size_m, count)[:, None]
    base, tip = place - 0.5 * size * axis, place + 0.6 * size * axis
    left, right = place - 0.36 * size * across, place + 0.36 * size * across
    ridge = place + 0.14 * size * fold
    verts = np.stack([base, left, tip, right, ridge], axis=1).reshape(-1, 3)
    k = 5 * np.arange(count)[:, None]
    faces = np.concatenate(
        [
            k + np.array([[0, 4, 1]]),
            k + np.array([[1, 4, 2]]),
            k + np.array([[0, 3, 4]]),
            k + np.array([[3, 2, 4]]),
        ]
    )
    return mesh.from_pydata(name, verts.tolist(), faces.tolist(), smooth=False)


def _mass(
    name: str, balls: Balls, shrink: float, ragged: float, shift: Vector, rings: int = 10
) -> bpy.types.Object:
    """The balls as one lumpy solid body that stops light and sight."""
    parts = []
    for centre, radius in balls:
        ball = mesh.ellipsoid(name, (radius * shrink,) * 3, rings * 2, rings)
        for vertex in ball.data.vertices:
            p = vertex.co + centre
            lump = noise.noise(p * (1.1 / max(0.25, radius)) + shift) + 0.5 * noise.noise(p * 3.1 + shift)
            vertex.co *= 1.0 + ragged * lump
            vertex.co += centre
        parts.append(ball)
    return mesh.join(name, parts)


@kind("tree", (5.43, 5.4, 6.08))
def tree(name: str, rng: random.Random, *, height_m: float = 6.0, sprays: int = 2500) -> bpy.types.Object:
    """A free-standing tree; its crown begins at about a third of its height."""
    trunk_top = 0.42 * height_m
    lean = Vector((rng.uniform(-0.05, 0.05), rng.uniform(-0.05, 0.05), 0.0)) * height_m
    girth = 0.032 * height_m
    fork = Vector((0, 0, trunk_top)) + 0.5 * lean
    trunk = mesh.tube(
        f"{name}_trunk",
        [
            Vector((0, 0, -0.15)),
            Vector((0, 0, 0.12)),
            fork * 0.5 + 0.1 * lean,
            fork,
            fork * 1.25 + 0.1 * lean,
        ],
        [1.7 * girth, 1.2 * girth, 0.9 * girth, 0.8 * girth, 0.4 * girth],
        segments=12,
    )
    limbs = [trunk]
    balls: list[tuple[Vector, float]] = [(fork + Vector((0, 0, 0.33 * height_m)), 0.20 * height_m)]
    count = 10
    for k in range(count):
        turn = 2 * math.pi * (k + rng.uniform(-0.25, 0.25)) / count
        reach = height_m * (rng.uniform(0.22, 0.32) if k % 2 else rng.uniform(0.10, 0.22))
        rise = height_m * (rng.uniform(0.03, 0.16) if k % 2 else rng.uniform(0.20, 0.42))
        tip = fork + Vector((reach * math.cos(turn), reach * math.sin(turn), rise))
        start = fork * rng.uniform(0.8, 1.0)
        bow = start.lerp(tip, 0.5) - Vector((0, 0, 0.03 * height_m))
        limbs.append(
            mesh.tube(f"{name}_limb", [start, bow, tip], [0.45 * girth, 0.3 * girth, 0.1 * girth], segments=7)
        )
        balls.append((tip, height_m * rng.uniform(0.105, 0.165)))
    wood = mesh.set_material(mesh.join(f"{name}_wood", limbs), outdoors.bark(f"{name}_bark"))
    shift = Vector([rng.uniform(-9, 9) for _ in range(3)])
    mass = _mass(f"{name}_mass", balls, 0.80, 0.30, shift, rings=7)
    mesh.set_material(mass, outdoors.foliage_mass(f"{name}_mass", (0.038, 0.064, 0.015)))
    crown = _sprays(f"{name}_leaves", rng, balls, count=sprays, size_m=(0.022 * height_m, 0.042 * height_m))
    mesh.set_material(crown, outdoors.leaves(f"{name}_leaves"))
    return mesh.join(name, [wood, mass, crown])


@kind("bush", (1.05, 1.21, 1.13))
def bush(
    name: str,
    rng: random.Random,
    *,
    size_xyz: tuple[float, float, float] = (1.2, 1.0, 0.9),
    sprays: int = 900,
    leaf_m: tuple[float, float] = (0.06, 0.12),
    tone: tuple[float, float, float] = (0.07, 0.12, 0.028),
) -> bpy.types.Object:
    """A bush or a piece of hedge of about the given size."""
    sx, sy, sz = size_xyz
    radius = 0.42 * min(sy, sz)
    balls = []
    for k in range(max(3, round(3.2 * sx / sy))):
        x = sx * (rng.random() - 0.5) if k else 0.0
        y = 0.35 * sy * (rng.random() - 0.5)
        z = radius * rng.uniform(0.7, 1.0) + (sz - 2 * radius) * rng.random()
        balls.append((Vector((x * 0.8, y, z)), radius * rng.uniform(0.8, 1.15)))
    shift = Vector([rng.uniform(-9, 9) for _ in range(3)])
    mass = _mass(f"{name}_mass", balls, 0.84, 0.22, shift, rings=8)
    mesh.set_material(mass, outdoors.foliage_mass(f"{name}_mass", rgb(0.35 * c for c in tone)))
    crown = _sprays(f"{name}_leaves", rng, balls, count=sprays, size_m=leaf_m)
    mesh.set_material(crown, outdoors.leaves(f"{name}_leaves", tone))
    return mesh.join(name, [mass, crown])


@kind("wood", (19.1, 7.52, 6.3), "backdrop")
def far_wood(
    name: str,
    rng: random.Random,
    *,
    length_m: float = 14.0,
    depth_m: float = 5.0,
    height_m: float = 6.0,
    crowns: int = 16,
) -> bpy.types.Object:
    """A strip of woodland for the skyline: crowns as lumpy bodies, no leaves."""
    balls = []
    for k in range(crowns):
        tall = height_m * rng.uniform(0.6, 1.0)
        radius = tall * rng.uniform(0.30, 0.40)
        x = length_m * ((k + rng.uniform(-0.4, 0.4)) / (crowns - 1) - 0.5)
        y = depth_m * (rng.random() - 0.5)
        balls.append((Vector((x, y, tall - radius)), radius))
        balls.append(
            (
                Vector((x + rng.uniform(-1, 1) * radius, y - 0.3 * radius, 0.45 * (tall - radius))),
                radius * 0.95,
            )
        )
    mass = _mass(name, balls, 1.0, 0.30, Vector([rng.uniform(-9, 9) for _ in range(3)]), rings=7)
    mesh.set_material(mass, outdoors.foliage_mass(f"{name}_mass", (0.080, 0.115, 0.032), half_at_m=260.0))
    return mass
