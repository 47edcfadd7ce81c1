"""A farm bucket: dented sheet metal with a rolled rim, swaged ribs, ears and a wire bail with a wooden
grip.

Owns the shape and where a hand takes it (`GRIP_Z_M`); looks come from materials/outdoors.py.
"""

from __future__ import annotations

import math
import random

import bpy
from mathutils import Matrix, Vector

from l4d_blender.scene.catalogue import Choice, kind, words

from . import mesh
from .materials import outdoors

HEIGHT_M = 0.31
RIM_RADIUS_M = 0.172
BASE_RADIUS_M = 0.122
PIVOT_Z_M = 0.288
BAIL_RADIUS_M = 0.186
#: Height of the grip's centre above the base while the bail stands upright.
GRIP_Z_M = PIVOT_Z_M + 1.02 * BAIL_RADIUS_M

_WALL_M = 0.004


def _radius(z: float) -> float:
    """Outer radius at height z: a cone with two pressed ribs."""
    cone = BASE_RADIUS_M + (RIM_RADIUS_M - BASE_RADIUS_M) * z / HEIGHT_M
    ribs = sum(0.0042 * math.exp(-(((z - rib) / 0.007) ** 2)) for rib in (0.105, 0.215))
    return cone + ribs


def _profile() -> list[tuple[float, float]]:
    """Half section from the middle of the underside round the rim to the middle of the inner floor."""
    under = [
        (0.0, 0.010),
        (BASE_RADIUS_M - 0.008, 0.010),
        (BASE_RADIUS_M - 0.004, 0.0),
        (BASE_RADIUS_M, 0.001),
    ]
    heights = [0.02, 0.06, 0.094, 0.1, 0.105, 0.11, 0.116, 0.16, 0.204, 0.21, 0.215, 0.22, 0.226, 0.26, 0.296]
    wall = [(_radius(z), z) for z in heights]
    bead = []
    for k in range(9):
        angle = math.radians(-100 + 250 * k / 8)
        bead.append((RIM_RADIUS_M + 0.0065 * math.cos(angle), HEIGHT_M - 0.004 + 0.0065 * math.sin(angle)))
    inside = [(_radius(z) - _WALL_M, z) for z in reversed(heights[1:])]
    floor = [(BASE_RADIUS_M - 0.008, 0.019), (0.0, 0.016)]
    return under + wall + bead + inside + floor


def _dent(body: bpy.types.Object, rng: random.Random, dents: int) -> None:
    """Pushes the sheet in and slightly out of round, inner and outer skin alike."""
    hollows = [
        (
            rng.uniform(0, 2 * math.pi),
            rng.uniform(0.05, 0.24),
            rng.uniform(0.03, 0.06),
            rng.uniform(0.004, 0.010),
        )
        for _ in range(dents)
    ]
    squeeze_angle, squeeze = rng.uniform(0, math.pi), rng.uniform(0.004, 0.012)
    for vertex in body.data.vertices:
        x, y, z = vertex.co
        radius = math.hypot(x, y)
        if radius < 0.7 * BASE_RADIUS_M:
            continue
        angle = math.atan2(y, x)
        change = squeeze * (z / HEIGHT_M) ** 2 * math.cos(2 * (angle - squeeze_angle))
        for at, height, width, depth in hollows:
            along = math.remainder(angle - at, 2 * math.pi) * radius
            change -= depth * math.exp(-(along**2 + (z - height) ** 2) / width**2)
        vertex.co.x, vertex.co.y = x * (1 + change / radius), y * (1 + change / radius)


def _bail(name: str, angle: float) -> list[bpy.types.Object]:
    """Wire from ear to ear with a turned grip; `angle` tips it from upright towards -Y (radians)."""
    points, radii = [Vector((-RIM_RADIUS_M - 0.002, 0, -0.012))], [0.0042]
    for k in range(21):
        a = math.pi - math.pi * k / 20
        points.append(Vector((BAIL_RADIUS_M * math.cos(a), 0.0, 0.005 + BAIL_RADIUS_M * math.sin(a) ** 0.8)))
        radii.append(0.0042)
    points.append(Vector((RIM_RADIUS_M + 0.002, 0, -0.012)))
    radii.append(0.0042)
    wire = mesh.tube(f"{name}_wire", points, radii, segments=8)
    mesh.set_material(wire, outdoors.bare_wire(f"{name}_wire"))
    top = GRIP_Z_M - PIVOT_Z_M
    grip_points = [Vector((x, 0, top)) for x in (-0.055, -0.05, -0.03, 0.0, 0.03, 0.05, 0.055)]
    grip = mesh.tube(
        f"{name}_grip", grip_points, [0.008, 0.0125, 0.014, 0.015, 0.014, 0.0125, 0.008], segments=12
    )
    mesh.set_material(grip, outdoors.turned_wood(f"{name}_grip"))
    tip = Matrix.Translation((0, 0, PIVOT_Z_M)) @ Matrix.Rotation(-angle, 4, "X")
    for part in (wire, grip):
        mesh.transform(part, tip)
    return [wire, grip]


@kind(
    "bucket",
    (0.38, 0.339, 0.493),
    "graspable",
    "container",
    look=words("look", "galvanised", *outdoors.PAINTS),
    content=Choice("filling", {"empty": None, "water": "water", "grain": "grain"}),
)
def bucket(
    name: str,
    rng: random.Random,
    *,
    look: str = "galvanised",
    bail_angle: float = 0.0,
    filling: str | None = None,
    dents: int = 4,
) -> bpy.types.Object:
    """A 0.31 m bucket; `look` is "galvanised" or a paint of `outdoors.PAINTS`.

    `bail_angle` in radians (0 upright, +-1.3 fallen onto the rim); `filling` None, "water" or "grain".
    """
    body = mesh.lathe(f"{name}_body", _profile(), segments=56, close_bottom=False)
    _dent(body, rng, dents)
    skin = outdoors.galvanised(name, rng) if look == "galvanised" else outdoors.painted_sheet(name, look, rng)
    mesh.set_material(body, skin)
    parts = [body]
    for side in (-1.0, 1.0):
        ear = mesh.bevel_box(f"{name}_ear", (0.008, 0.042, 0.05), 0.003)
        mesh.transform(ear, Matrix.Translation((side * (RIM_RADIUS_M - 0.001), 0, PIVOT_Z_M - 0.033)))
        rivet = mesh.ellipsoid(f"{name}_rivet", (0.005, 0.007, 0.007), 8, 6)
        mesh.transform(rivet, Matrix.Translation((side * (RIM_RADIUS_M + 0.003), 0, PIVOT_Z_M - 0.024)))
        for part in (ear, rivet):
            mesh.set_material(part, outdoors.bare_wire(f"{name}_ear"))
        parts += [ear, rivet]
    parts += _bail(name, bail_angle)
    if filling is not None:
        parts.append(_filling(name, rng, filling))
    return mesh.join(name, parts)


def _filling(name: str, rng: random.Random, filling: str) -> bpy.types.Object:
    level = 0.235
    radius = _radius(level) - _WALL_M - 0.001
    heap = 0.0 if filling == "water" else 0.035
    profile = [(radius * k / 8, level + heap * (1 - (k / 8) ** 2)) for k in range(9)]
    surface = mesh.lathe(f"{name}_{filling}", profile, segments=40, close_bottom=False)
    if filling == "grain":
        for vertex in surface.data.vertices:
            vertex.co.z += rng.uniform(-0.004, 0.004)
        mesh.set_material(surface, outdoors.grain(f"{name}_grain"))
    else:
        mesh.set_material(surface, outdoors.still_water(f"{name}_water"))
    return surface
