"""A child's ball: an inflated vinyl sphere with marks that show how it turns.

Owns the shape and where the marks are; how it moves is motion/ball_games.py's business.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from itertools import product

import bpy
from mathutils import Vector

from l4d_blender.scene.catalogue import Range, kind, words

from . import mesh
from .materials import playground

_SPOT_COSINE = math.cos(math.radians(19.0))
_GOLDEN = (1.0 + math.sqrt(5.0)) / 2.0


def _stripes(way: Vector) -> float:
    """Six segments like a beach ball's, and a cap on both poles."""
    if abs(way.z) > 0.93:
        return 8.0 * (abs(way.z) - 0.93)
    return math.cos(3.0 * math.atan2(way.y, way.x)) * math.hypot(way.x, way.y)


def _dots(way: Vector) -> float:
    """Twelve round spots, one on each corner of an icosahedron."""
    corners = [
        Vector(point).normalized()
        for a, b in product((-1.0, 1.0), (-_GOLDEN, _GOLDEN))
        for point in ((0.0, a, b), (a, b, 0.0), (b, 0.0, a))
    ]
    return 3.0 * (max(way.dot(corner) for corner in corners) - _SPOT_COSINE)


def _band(way: Vector) -> float:
    """One broad belt."""
    return 0.34 - abs(way.z)


PATTERNS: dict[str, Callable[[Vector], float]] = {"striped": _stripes, "dotted": _dots, "banded": _band}


@kind(
    "ball",
    (0.24, 0.24, 0.241),
    "rolls",
    "graspable",
    colour=words("colour", *playground.PAINTS),
    mark=words("mark", *playground.PAINTS),
    pattern=words("pattern", *PATTERNS),
    radius_m=Range("radius_m", 0.02, 0.2),
)
def ball(
    name: str,
    rng: random.Random,
    *,
    radius_m: float = 0.12,
    colour: str = "red",
    mark: str = "white",
    pattern: str = "striped",
) -> bpy.types.Object:
    """A ball that lies on z = 0; colours are names of materials.playground.PAINTS."""
    body = mesh.ellipsoid(name, (radius_m,) * 3, 72, 48, centre=(0.0, 0.0, radius_m))
    marks = body.data.attributes.new("mark", "FLOAT", "POINT")
    middle = Vector((0.0, 0.0, radius_m))
    marks.data.foreach_set(
        "value", [PATTERNS[pattern]((v.co - middle).normalized()) for v in body.data.vertices]
    )
    paints = playground.PAINTS
    mesh.set_material(body, playground.ball_skin(f"{name}_skin", paints[colour], paints[mark], rng))
    valve = mesh.cylinder(f"{name}_valve", 0.05 * radius_m, 0.012 * radius_m, 12)
    mesh.move(valve, z=1.994 * radius_m)
    mesh.set_material(valve, playground.ball_skin(f"{name}_valve", paints["black"], paints["black"], rng))
    return mesh.join(name, [body, valve])
