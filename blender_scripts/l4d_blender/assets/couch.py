"""Upholstered seats for one to three: a couch, an easy chair, a bench with a cushion, a pouffe.

Owns shapes with few faces, for rooms in which they stand in the background. They face -Y; people sit on them
at `SEAT_M`, `SEAT_AHEAD_M` before the middle.
"""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior, products
from l4d_blender.assets.parts import CORNERS, Parts
from l4d_blender.scene.catalogue import Range, colours, kind, words
from l4d_blender.scene.colour import Colour

SEAT_M = 0.43
SEAT_AHEAD_M = 0.14
BENCH_SEAT_M = 0.46
POUFFE_SEAT_M = 0.42
TIMBERS: tuple[Colour, ...] = ((0.20, 0.10, 0.05), (0.42, 0.25, 0.12), (0.05, 0.045, 0.04))


@kind(
    "sofa",
    (1.8, 0.865, 0.8),
    "seat",
    front="-y",
    colour=colours("cloth"),
    arms=words("arms", "wide", "slim", "low"),
    width_m=Range("width_m", 1.4, 2.4),
)
def couch(
    name: str,
    rng: random.Random,
    *,
    cloth: Colour = (0.10, 0.19, 0.21),
    cushion: Colour | None = None,
    width_m: float = 1.8,
    seats: int = 2,
    arms: str = "wide",
) -> bpy.types.Object:
    """A sofa; `cushion` is the colour of one or two loose cushions in its corners."""
    return _upholstered(name, rng, cloth, cushion, width_m, 0.88, seats, arms, 0.80)


@kind(
    "armchair",
    (0.8, 0.805, 0.82),
    "seat",
    front="-y",
    colour=colours("cloth"),
    arms=words("arms", "wide", "slim", "low"),
)
def easy_chair(
    name: str,
    rng: random.Random,
    *,
    cloth: Colour = (0.10, 0.19, 0.21),
    cushion: Colour | None = None,
    arms: str = "slim",
) -> bpy.types.Object:
    """An armchair of the couch's family."""
    return _upholstered(name, rng, cloth, cushion, 0.8, 0.82, 1, arms, 0.82)


def _upholstered(
    name: str,
    rng: random.Random,
    cloth: Colour,
    cushion: Colour | None,
    width: float,
    depth: float,
    seats: int,
    arms: str,
    height: float,
) -> bpy.types.Object:
    fabric = interior.cloth(f"{name}_cloth", cloth, rng)
    timber = interior.wood(f"{name}_legs", rng.choice(TIMBERS), rng, grain_axis="Z")
    arm, arm_top = {"wide": (0.19, 0.60), "slim": (0.10, 0.58), "low": (0.16, 0.50)}[arms]
    foot, parts = 0.12, Parts(name)

    def block(
        size: tuple[float, float, float],
        at: tuple[float, float, float],
        bevel: float,
        tilt: float = 0.0,
        material: bpy.types.Material = fabric,
    ) -> None:
        obj = mesh.bevel_box(f"{name}_block", size, bevel, 4)
        obj = mesh.rotate(mesh.shade_smooth(obj, 60.0), "X", tilt)
        parts.add(mesh.move(obj, *at), material)

    inner = width - 2 * arm
    block((width - 0.02, depth - 0.06, 0.20), (0.0, 0.02, foot), 0.03)
    block((width - 0.03, 0.17, height - foot - 0.06), (0.0, depth / 2 - 0.09, foot), 0.06)
    for side in (-1, 1):
        block((arm, depth - 0.02, arm_top - foot), (side * (width - arm) / 2, 0.0, foot), 0.045)
    seat = inner / seats
    for k in range(seats):
        x = (k + 0.5) * seat - inner / 2
        block((seat - 0.008, depth - 0.22, 0.15), (x, -0.10, SEAT_M - 0.145), 0.05)
        block((seat - 0.012, 0.17, height - SEAT_M + 0.01), (x, depth / 2 - 0.24, SEAT_M - 0.01), 0.06, -9.0)
    if cushion is not None:
        loose = interior.cloth(f"{name}_cushion", cushion, rng)
        for side in rng.choice(((-1,), (1,), (-1, 1))) if seats > 1 else (rng.choice((-1, 1)),):
            x = side * (inner / 2 - 0.22) if seats > 1 else 0.0
            block((0.38, 0.13, 0.36), (x, depth / 2 - 0.39, SEAT_M - 0.005), 0.06, -20.0, loose)
    for x, y in CORNERS:
        leg = mesh.cylinder(f"{name}_foot", 0.017, foot + 0.02, 10, top_radius=0.026)
        parts.add(leg, timber, x=x * (width / 2 - 0.10), y=y * (depth / 2 - 0.11))
    return parts.join()


@kind(
    "bench", (1.3, 0.40, 0.46), "seat", "surface", colour=colours("cloth"), width_m=Range("width_m", 0.8, 2.0)
)
def hall_bench(
    name: str, rng: random.Random, *, cloth: Colour = (0.30, 0.20, 0.10), width_m: float = 1.3
) -> bpy.types.Object:
    """A wooden bench with a flat cushion, for a hall or the end of a bed."""
    wood = products.wood(f"{name}_wood", (0.36, 0.21, 0.10), (0.20, 0.10, 0.045), rng, grain_axis="X")
    fabric = interior.cloth(f"{name}_cloth", cloth, rng)
    parts = Parts(name)
    parts.box("top", wood, (width_m, 0.40, 0.04), 0.006, 2, z=0.36)
    parts.box("pad", fabric, (width_m - 0.03, 0.38, 0.06), 0.022, 3, z=0.40)
    parts.box("rail", wood, (width_m - 0.16, 0.05, 0.05), 0.004, 1, z=0.14)
    for x in (-1, 1):
        for y in (-1, 1):
            parts.box("leg", wood, (0.05, 0.05, 0.37), 0.004, 1, x=x * (width_m / 2 - 0.07), y=y * 0.15)
        parts.box("stretcher", wood, (0.04, 0.30, 0.05), 0.004, 1, x=x * (width_m / 2 - 0.07), z=0.14)
    return parts.join()


@kind("stool", (0.52, 0.52, 0.42), "seat", colour=colours("cloth"))
def pouffe(name: str, rng: random.Random, *, cloth: Colour = (0.45, 0.20, 0.08)) -> bpy.types.Object:
    """A round upholstered stool with a seam and a button."""
    fabric = interior.cloth(f"{name}_cloth", cloth, rng)
    profile = [(0.22, 0.0), (0.255, 0.04), (0.26, 0.20), (0.25, 0.215), (0.26, 0.23), (0.25, 0.37)]
    profile += [(0.21, 0.41), (0.10, 0.42), (0.0, 0.412)]
    body = mesh.shade_smooth(mesh.lathe(f"{name}_body", profile, 32), 40.0)
    button = mesh.ellipsoid(f"{name}_button", (0.018, 0.018, 0.008), 12, 8, (0.0, 0.0, 0.412))
    return mesh.join(name, [mesh.set_material(part, fabric) for part in (body, button)])
