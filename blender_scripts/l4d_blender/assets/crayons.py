"""Wax crayons, strewn about or in their open box.

Owns crayons and box; knows nothing of paper. They lie on z = 0.
"""

from __future__ import annotations

import random
from math import pi

import bpy
from mathutils import Matrix

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.colour import Colour

RADIUS_M = 0.0045
COLOURS: tuple[Colour, ...] = (
    (0.52, 0.04, 0.03),
    (0.04, 0.12, 0.42),
    (0.06, 0.30, 0.08),
    (0.75, 0.50, 0.03),
    (0.62, 0.20, 0.02),
    (0.26, 0.06, 0.30),
    (0.14, 0.07, 0.03),
)


@kind("crayons", (0.117, 0.115, 0.009))
def loose_crayons(
    name: str, rng: random.Random, *, count: int = 5, spread_m: tuple[float, float] = (0.09, 0.06)
) -> bpy.types.Object:
    """Crayons that lie side by side, each turned a little differently."""
    parts = Parts(name)
    for k in range(count):
        stick = _crayon(f"{name}_{k}", COLOURS[k % len(COLOURS)], rng, rng.uniform(0.055, 0.088))
        y = spread_m[1] * (k / max(count - 1, 1) - 0.5) * 1.6
        turn = Matrix.Rotation(rng.uniform(-0.35, 0.35), 4, "Z")
        at = Matrix.Translation((rng.uniform(-0.5, 0.5) * spread_m[0] * 0.5, y, RADIUS_M))
        parts.add(stick, within=at @ turn @ Matrix.Rotation(pi / 2, 4, "Y"))
    return parts.join()


@kind("box", (0.1, 0.103, 0.013), "container")
def crayon_box(name: str, rng: random.Random, *, card: Colour = (0.7, 0.47, 0.04)) -> bpy.types.Object:
    """A flat cardboard box 10 cm wide whose crayons stick out at -Y."""
    paper = products.paper(f"{name}_card", card, rng)
    dark = products.paper(f"{name}_band", (0.05, 0.22, 0.10), rng)
    parts = Parts(name)
    parts.box("box", paper, (0.100, 0.070, 0.013), 0.0008, segments=1, y=0.018)
    parts.box("print", dark, (0.1004, 0.026, 0.0134), 0.0008, segments=1, y=0.020, z=-0.0002)
    for k in range(9):
        stick = _crayon(f"{name}_{k}", COLOURS[(2 * k) % len(COLOURS)], rng, 0.062)
        at = Matrix.Translation((-0.044 + 0.011 * k, -0.014 + rng.uniform(-0.005, 0.005), 0.0065))
        parts.add(stick, within=at @ Matrix.Rotation(pi / 2, 4, "X"))
    return parts.join()


def _crayon(name: str, wax: Colour, rng: random.Random, length_m: float) -> bpy.types.Object:
    """A crayon along Z round the origin, its tip at +Z, in a paper sleeve."""
    r, half = RADIUS_M, 0.5 * length_m
    body = mesh.lathe(
        name,
        [
            (r * 0.9, -half),
            (r, -half + 0.001),
            (r, half - 0.014),
            (r * 0.86, half - 0.0135),
            (r * 0.80, half - 0.010),
            (r * 0.34, half - 0.001),
            (0.0, half),
        ],
        16,
    )
    skin = products.satin_plastic(f"{name}_wax", wax, rng, roughness=0.5)
    sleeve = products.paper(f"{name}_sleeve", products.scaled(wax, 1.35), rng)
    return mesh.paint(body, [skin, sleeve], lambda at, _: int(-half + 0.002 < at.z < half - 0.0138))
