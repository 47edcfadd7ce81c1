"""A wireless computer mouse: shell, two buttons, wheel, rubber sides.

Owns the shape and where a palm rests on it. Buttons and wheel point to -Y; it glides on z = 0.
"""

from __future__ import annotations

import math
import random

import bpy
from mathutils import Matrix, Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.scene.catalogue import Choice, kind
from l4d_blender.scene.colour import Colour, rgb

LENGTH_M = 0.116
HALF_WIDTH_M = 0.0325
CROWN_M = 0.0385
CROWN_AT = 0.22  # of the half length, behind the middle
BUTTONS_END_AT = -0.10
SEAM_HALF_M = 0.0007

BLACK: Colour = (0.018, 0.018, 0.020)
WHITE: Colour = (0.66, 0.65, 0.62)
GREY: Colour = (0.16, 0.165, 0.175)
SHELLS = {"black": BLACK, "white": WHITE, "grey": GREY}


def half_width(t: float) -> float:
    """Half width in metres at t = -1 (front) .. 1 (back): rounded ends, a waist for thumb and ring finger."""
    outline = (1.0 - abs(t) ** 3.4) ** (1 / 2.3)
    waist = 1.0 - 0.075 * math.exp(-(((t + 0.12) / 0.34) ** 2))
    return HALF_WIDTH_M * outline * waist


def crown_height(t: float) -> float:
    """Height of the ridge line in metres at t = -1 (front) .. 1 (back)."""
    arch = 1.0 - 0.42 * ((t - CROWN_AT) / (1.0 + CROWN_AT)) ** 2
    if t > CROWN_AT:
        arch = 1.0 - 0.62 * ((t - CROWN_AT) / (1.0 - CROWN_AT)) ** 2.2
    end = (1.0 - abs(t) ** 7) ** 0.5
    return CROWN_M * arch * end


def surface_point(t: float, s: float) -> Vector:
    """Point of the shell at t along the length and s = -1 (right side) .. 1 (left side) across."""
    dome = (1.0 - abs(s) ** 3.0) ** (1 / 2.2)
    return Vector((half_width(t) * s, 0.5 * LENGTH_M * t, crown_height(t) * dome))


@kind("mouse", (0.063, 0.116, 0.038), "graspable", "pushable", front="-y", colour=Choice("shell", SHELLS))
def computer_mouse(name: str, rng: random.Random, *, shell: Colour = BLACK) -> bpy.types.Object:
    """A mouse 11.6 cm long; the seams and the rubber sides are faces of their own, so they stay crisp."""
    body = _shell(f"{name}_shell")
    for material in (
        products.satin_plastic(f"{name}_plastic", shell, rng),
        products.rubber(f"{name}_rubber", rgb(0.4 * c + 0.012 for c in shell), rng),
        products.satin_plastic(f"{name}_gap", (0.003, 0.003, 0.003), rng, roughness=0.9),
    ):
        body.data.materials.append(material)
    for polygon in body.data.polygons:
        polygon.material_index = _part_of_shell(polygon.center)

    slot_t = -0.60
    ridge = surface_point(slot_t, 0.0)
    wheel = _wheel(f"{name}_wheel")
    mesh.set_material(wheel, products.rubber(f"{name}_wheel_rubber", (0.05, 0.05, 0.052), rng))
    mesh.transform(wheel, Matrix.Translation(ridge + Vector((0.0, 0.0, -0.0065))))
    ring = mesh.torus(f"{name}_wheel_ring", 0.0078, 0.0009, segments=28, sides=6)
    mesh.set_material(ring, products.metal(f"{name}_wheel_metal", (0.62, 0.63, 0.65), rng))
    slope = surface_point(slot_t + 0.08, 0.0) - surface_point(slot_t - 0.08, 0.0)
    tilt = Matrix.Rotation(math.atan2(slope.z, slope.y), 4, "X")
    mesh.transform(ring, Matrix.Translation(ridge) @ tilt @ Matrix.Diagonal((0.72, 1.45, 1.0, 1.0)))
    return mesh.join(name, [body, wheel, ring])


def _shell(name: str, rows: int = 44, half_columns: int = 15) -> bpy.types.Object:
    """The closed shell as a grid, with one thin row and one thin column where the seams run."""
    lengthwise = [-math.cos(math.pi * row / rows) for row in range(1, rows)]
    seam_t = 2.0 * SEAM_HALF_M / LENGTH_M
    lengthwise += [BUTTONS_END_AT - seam_t, BUTTONS_END_AT + seam_t]
    lengthwise.sort()
    seam_s = SEAM_HALF_M / HALF_WIDTH_M
    right_half = [seam_s] + [
        seam_s + (1 - seam_s) * math.sin(0.5 * math.pi * (k + 1) / half_columns) for k in range(half_columns)
    ]
    across = [-s for s in reversed(right_half)] + right_half

    verts = [surface_point(t, s) for t in lengthwise for s in across]
    width = len(across)
    faces: list[tuple[int, ...]] = [
        (row * width + col, row * width + col + 1, (row + 1) * width + col + 1, (row + 1) * width + col)
        for row in range(len(lengthwise) - 1)
        for col in range(width - 1)
    ]
    last = (len(lengthwise) - 1) * width
    faces.append(tuple(range(width - 1, -1, -1)))
    faces.append(tuple(range(last, last + width)))
    under = [row * width for row in range(len(lengthwise))]
    under += [row * width + width - 1 for row in reversed(range(len(lengthwise)))]
    faces.append(tuple(under))
    return mesh.from_pydata(name, verts, faces)


def _part_of_shell(centre: Vector) -> int:
    """0 plastic, 1 rubber side, 2 gap between the buttons and behind them."""
    t = 2.0 * centre.y / LENGTH_M
    on_ridge_seam = abs(centre.x) < SEAM_HALF_M * 0.5 and t < BUTTONS_END_AT
    on_cross_seam = abs(t - BUTTONS_END_AT) < SEAM_HALF_M / LENGTH_M and centre.z > 0.5 * crown_height(t)
    if on_ridge_seam or on_cross_seam:
        return 2
    is_side = centre.z < 0.62 * crown_height(max(-0.95, min(0.95, t))) and -0.62 < t < 0.72
    return 1 if is_side and centre.z > 0.004 else 0


def _wheel(name: str) -> bpy.types.Object:
    """A ribbed scroll wheel about the X axis."""
    radius, half = 0.0105, 0.0032
    teeth, verts = 26, []
    for side in (-half, -0.6 * half, 0.6 * half, half):
        inset = 0.0012 if abs(side) == half else 0.0
        for k in range(2 * teeth):
            r = radius - inset - (0.0006 if k % 2 else 0.0)
            a = math.pi * k / teeth
            verts.append(Vector((side, r * math.cos(a), r * math.sin(a))))
    ring = 2 * teeth
    faces: list[tuple[int, ...]] = [
        (
            band * ring + k,
            band * ring + (k + 1) % ring,
            (band + 1) * ring + (k + 1) % ring,
            (band + 1) * ring + k,
        )
        for band in range(3)
        for k in range(ring)
    ]
    faces += [tuple(range(ring)), tuple(range(4 * ring - 1, 3 * ring - 1, -1))]
    return mesh.from_pydata(name, verts, faces, smooth=False)
