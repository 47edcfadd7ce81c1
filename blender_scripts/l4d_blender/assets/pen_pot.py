"""A pot with pens, pencils, scissors and a ruler in it.

Owns the pot and its bundle. Knows nothing of the desk; it stands on z = 0.
"""

from __future__ import annotations

import random
from math import cos, pi, sin

import bpy
from mathutils import Matrix, Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.assets.pen import upright_pen
from l4d_blender.scene.catalogue import colours, kind
from l4d_blender.scene.colour import Colour

RADIUS_M = 0.036
HEIGHT_M = 0.098
PENCIL_COLOURS: tuple[Colour, ...] = (
    (0.62, 0.38, 0.02),
    (0.45, 0.03, 0.02),
    (0.03, 0.20, 0.10),
    (0.05, 0.06, 0.07),
)


@kind("pen_pot", (0.096, 0.094, 0.196), "container", colour=colours("clay"))
def pen_pot(name: str, rng: random.Random, *, clay: Colour = (0.3, 0.33, 0.33)) -> bpy.types.Object:
    """A stoneware pot 10 cm tall with writing things that reach to about 19 cm."""
    r, h = RADIUS_M, HEIGHT_M
    pot = mesh.lathe(
        f"{name}_pot",
        [
            (r - 0.003, 0.0),
            (r, 0.003),
            (r + 0.001, 0.5 * h),
            (r, h - 0.003),
            (r - 0.0015, h),
            (r - 0.0035, h - 0.003),
            (r - 0.004, 0.012),
            (0.0, 0.010),
        ],
        40,
    )
    parts = [mesh.set_material(pot, products.stoneware(f"{name}_clay", rng, colour=clay))]
    for k in range(7):
        stick = (
            upright_pen(f"{name}_pen{k}", rng, barrel=rng.choice(PENCIL_COLOURS))
            if k < 2
            else _pencil(f"{name}_pencil{k}", rng, rng.choice(PENCIL_COLOURS), rng.uniform(0.135, 0.178))
        )
        parts.append(mesh.transform(stick, _lean(2 * pi * k / 7 + rng.uniform(-0.2, 0.2), rng)))
    ruler = mesh.bevel_box(f"{name}_ruler", (0.028, 0.002, 0.185), 0.0006, segments=1)
    mesh.set_material(
        ruler, products.wood(f"{name}_ruler", (0.56, 0.36, 0.16), (0.36, 0.20, 0.08), rng, grain_axis="Z")
    )
    parts.append(
        mesh.transform(ruler, Matrix.Translation((0.004, 0.014, 0.012)) @ Matrix.Rotation(-0.09, 4, "X"))
    )
    return mesh.join(name, parts)


def _lean(azimuth: float, rng: random.Random) -> Matrix:
    """A place for a stick in the pot: foot on one side of the floor, resting against the other side's rim."""
    foot = Vector((-0.014 * cos(azimuth), -0.014 * sin(azimuth), 0.012))
    rim = Vector((0.026 * cos(azimuth), 0.026 * sin(azimuth), HEIGHT_M))
    turn = (rim - foot).to_track_quat("Z", "Y").to_matrix().to_4x4()
    return Matrix.Translation(foot) @ turn @ Matrix.Rotation(rng.uniform(0.0, 2 * pi), 4, "Z")


def _pencil(name: str, rng: random.Random, paint: Colour, length: float) -> bpy.types.Object:
    """A hexagonal pencil standing on its blunt end, sharpened at the top."""
    body = mesh.lathe(f"{name}_body", [(0.0037, 0.0), (0.0037, length - 0.018)], 6)
    cone = mesh.lathe(
        f"{name}_cone", [(0.0037, length - 0.018), (0.0011, length - 0.005)], 12, close_bottom=False
    )
    lead = mesh.lathe(f"{name}_lead", [(0.0011, length - 0.005), (0.0, length)], 8, close_bottom=False)
    mesh.shade_smooth(body, 20.0)
    mesh.set_material(body, products.lacquer(f"{name}_paint", paint, rng))
    mesh.set_material(
        cone, products.wood(f"{name}_wood", (0.62, 0.40, 0.22), (0.45, 0.27, 0.13), rng, grain_axis="Z")
    )
    mesh.set_material(lead, products.satin_plastic(f"{name}_graphite", products.scaled(paint, 0.4), rng))
    return mesh.join(name, [body, cone, lead])
