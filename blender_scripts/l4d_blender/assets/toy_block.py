"""A wooden building block: painted sides with a figure in a ring on each, edges worn to the bare wood.

Owns the block's shape and paint. Knows nothing of what is built with it. It stands on z = 0.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, pi, sin

import bpy
from mathutils import Matrix, Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.lettering import lettering
from l4d_blender.assets.materials import products
from l4d_blender.assets.materials.base import Nodes
from l4d_blender.scene.catalogue import Choice, colours, kind, words
from l4d_blender.scene.colour import Colour

WOOD: Colour = (0.55, 0.36, 0.19)
CREAM: Colour = (0.76, 0.70, 0.56)
FIGURES = ("star", "moon", "heart", "letter")
_PRINT_M = 0.0003


@dataclass(frozen=True)
class Look:
    """Paint, the figure on the sides (one of FIGURES), edge length in metres and how worn it is (0..1)."""

    paint: Colour = (0.50, 0.035, 0.03)
    figure: str = "star"
    size_m: float = 0.046
    wear: float = 0.25


@kind(
    "block",
    (0.047, 0.047, 0.047),
    "graspable",
    "pushable",
    "stacks",
    colour=colours("look.paint"),
    figure=words("look.figure", *FIGURES),
    size=Choice("look.size_m", {"small": 0.046, "large": 0.060}),
    finish=Choice("look.wear", {"glossy": 0.12, "worn": 0.42}),
)
def toy_block(name: str, rng: random.Random, *, look: Look = Look()) -> bpy.types.Object:
    """A cube of solid wood with rounded edges."""
    size = look.size_m
    cube = mesh.bevel_box(f"{name}_cube", (size, size, size), 0.07 * size, segments=4)
    mesh.set_material(cube, _worn_paint(f"{name}_paint", look, rng))
    panel = products.lacquer(f"{name}_panel", CREAM, rng)
    ink = products.lacquer(f"{name}_ink", products.scaled(look.paint, 0.75), rng)
    parts = [cube]
    for side in _sides(size):
        disc = _fan(f"{name}_disc", _circle(), 0.37 * size)
        figure = _figure(f"{name}_figure", look.figure, size)
        mesh.move(disc, z=_PRINT_M)
        mesh.move(figure, z=2 * _PRINT_M)
        parts += [
            mesh.transform(mesh.set_material(disc, panel), side),
            mesh.transform(mesh.set_material(figure, ink), side),
        ]
    return mesh.join(name, parts)


def _sides(size: float) -> list[Matrix]:
    """Where the middle of each of the five visible sides is, and how it is turned."""
    middle = Matrix.Translation((0.0, 0.0, 0.5 * size))
    out = Matrix.Translation((0.0, 0.0, 0.5 * size))
    upright = [Matrix.Rotation(k * pi / 2, 4, "Z") @ Matrix.Rotation(pi / 2, 4, "X") for k in range(4)]
    return [middle @ turn @ out for turn in (Matrix.Identity(4), *upright)]


def _figure(name: str, figure: str, size: float) -> bpy.types.Object:
    if figure == "letter":
        return lettering(name, "B", 0.40 * size, bold_m=0.0004)
    outline = {"star": _star, "moon": _moon, "heart": _heart}[figure]()
    if figure == "moon":
        points = [Vector((0.29 * size * x, 0.29 * size * y, 0.0)) for x, y in outline]
        half = len(points) // 2
        outer, inner = points[:half], points[half:][::-1]
        faces = [(k, k + 1, half + k + 1, half + k) for k in range(half - 1)]
        return mesh.from_pydata(name, [*outer, *inner], faces, smooth=False)
    return _fan(name, outline, 0.29 * size)


def _fan(name: str, outline: Sequence[tuple[float, float]], radius: float) -> bpy.types.Object:
    """A flat outline round the origin, as a sheet without sides: what is printed adds no edges to feel."""
    points = [Vector((radius * x, radius * y, 0.0)) for x, y in outline]
    fan = [(k, (k + 1) % len(points), len(points)) for k in range(len(points))]
    return mesh.from_pydata(name, [*points, Vector()], fan, smooth=False)


def _circle() -> list[tuple[float, float]]:
    return [(cos(2 * pi * k / 36), sin(2 * pi * k / 36)) for k in range(36)]


def _star() -> list[tuple[float, float]]:
    corners = ((1.0 if k % 2 == 0 else 0.45, pi / 2 + k * pi / 5) for k in range(10))
    return [(r * cos(a), r * sin(a)) for r, a in corners]


def _heart() -> list[tuple[float, float]]:
    """The usual parametric heart, counter-clockwise."""
    turns = [2 * pi * k / 28 for k in range(28)]
    return [
        (sin(a) ** 3, (13 * cos(a) - 5 * cos(2 * a) - 2 * cos(3 * a) - cos(4 * a)) / 16 + 0.1)
        for a in reversed(turns)
    ]


def _moon() -> list[tuple[float, float]]:
    """A crescent that opens to +X: the outer arc downwards, then the inner arc back up."""
    outer = [(cos(a), sin(a)) for a in (pi * (0.30 + 1.40 * k / 16) for k in range(17))]
    x, y = outer[0]
    inner = [(x - 0.62 * (1.0 + x) * sin(pi * k / 16), y * cos(pi * k / 16)) for k in range(17)]
    return [*outer, *reversed(inner)]


def _worn_paint(name: str, look: Look, rng: random.Random) -> bpy.types.Material:
    """Paint that has gone where the block hits things: along its edges, more so on its corners."""
    material = products.lacquer(name, look.paint, rng)
    n = Nodes(material)
    at = n.vector_math("ADD", n.object_coords(), (0.0, 0.0, -0.5 * look.size_m))
    x, y, z = (n.math("DIVIDE", n.math("ABSOLUTE", c), 0.5 * look.size_m) for c in n.separate(at))
    least = n.math("MINIMUM", x, y)
    most = n.math("MAXIMUM", x, y)
    edge = n.math("MAXIMUM", least, n.math("MINIMUM", most, z))
    place = n.vector_math("ADD", n.object_coords(), tuple(rng.uniform(-5, 5) for _ in range(3)))
    chips, scratches = n.noise(130.0, 4.0, vector=place), n.noise(45.0, 3.0, vector=place)
    bare = n.math("ADD", edge, n.math("MULTIPLY", n.math("SUBTRACT", chips, 0.5), 0.30 + 0.7 * look.wear))
    limit = 0.99 - 0.30 * look.wear
    mask = n.map_range(bare, limit, limit + 0.05)
    grain = n.noise(60.0, 4.0, vector=n.mapping(place, scale=(0.12, 1.0, 1.0)), distortion=0.5)
    wood = n.ramp(grain, [(0.35, products.scaled(WOOD, 0.62)), (0.65, WOOD)])
    tone = n.ramp(
        scratches, [(0.3, products.scaled(look.paint, 0.82)), (0.7, products.scaled(look.paint, 1.15))]
    )
    n.set("Base Color", n.mix(mask, tone, wood))
    n.set("Roughness", n.map_range(mask, 0.0, 1.0, 0.34, 0.75))
    n.bump(n.math("SUBTRACT", 1.0, mask), 0.4, 0.0004)
    return material
