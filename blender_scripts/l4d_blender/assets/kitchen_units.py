"""Fitted kitchen furniture: base units with a worktop, sink and tap, cupboards, an island, a hob, a fridge.

Backs on the plane y = 0, fronts towards -Y (the island: centred, cooks stand on its +Y side).
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, pi, sin

import bpy
from mathutils import Matrix

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior, kitchen
from l4d_blender.assets.materials.base import principled
from l4d_blender.assets.parts import Parts, placed
from l4d_blender.scene.catalogue import colours, kind

TOP_M = 0.90
DEPTH_M = 0.62
ISLAND_DEPTH_M = 0.70
HOB_TOP_M = TOP_M + 0.034  # where pots stand, on the grates
_SLAB_M = 0.035
_PLINTH_M = 0.10


@dataclass(frozen=True)
class Finish:
    """Colours of fronts and worktop."""

    front: tuple[float, float, float] = (0.13, 0.20, 0.17)
    stone: tuple[float, float, float] = (0.42, 0.40, 0.37)


@kind("worktop", (2.6, 0.634, 0.9), "surface", front="-y")
def base_run(
    name: str,
    rng: random.Random,
    *,
    width_m: float = 2.6,
    finish: Finish = Finish(),
    sink_x: float | None = None,
) -> bpy.types.Object:
    """Cupboards and drawers under a stone worktop; the worktop is left out for a sink round `sink_x`."""
    paint = kitchen.painted_front(f"{name}_paint", finish.front, rng)
    stone = kitchen.worktop(f"{name}_stone", finish.stone, rng)
    brass = principled(f"{name}_pulls", (0.42, 0.30, 0.13), roughness=0.3, metallic=1.0, variation=0.15)
    parts = _carcass(name, width_m, DEPTH_M - 0.04, paint)
    for part in parts:
        mesh.move(part, y=-(DEPTH_M - 0.04) / 2)
    parts += _fronts(name, rng, width_m, -(DEPTH_M - 0.04), paint, brass)
    slabs = [(-width_m / 2, width_m / 2, -DEPTH_M, 0.0)]
    if sink_x is not None:
        left, right = sink_x - 0.27, sink_x + 0.27
        slabs = [
            (-width_m / 2, left, -DEPTH_M, 0.0),
            (right, width_m / 2, -DEPTH_M, 0.0),
            (left, right, -DEPTH_M, -DEPTH_M + 0.10),
            (left, right, -0.12, 0.0),
        ]
    for low, high, near, far in slabs:
        slab = mesh.bevel_box(f"{name}_slab", (high - low, far - near, _SLAB_M), 0.004)
        parts.append(placed(slab, stone, x=(low + high) / 2, y=(near + far) / 2, z=TOP_M - _SLAB_M))
    return mesh.join(name, parts)


@kind("sink", (0.561, 0.563, 0.497), "container", front="-y")
def sink(name: str, rng: random.Random) -> bpy.types.Object:
    """A white ceramic basin with a bridge tap; origin at the worktop's height, back on y = 0."""
    white = interior.ceramic(f"{name}_ceramic", (0.74, 0.72, 0.67), rng)
    chrome = principled(f"{name}_chrome", (0.62, 0.62, 0.63), roughness=0.12, metallic=1.0)
    parts = Parts(name)
    for size, x, y in (
        ((0.56, 0.025, 0.22), 0.0, -0.115),
        ((0.56, 0.030, 0.24), 0.0, -DEPTH_M - 0.005),
        ((0.025, 0.50, 0.22), -0.268, -0.365),
        ((0.025, 0.50, 0.22), 0.268, -0.365),
        ((0.54, 0.50, 0.02), 0.0, -0.365),
    ):
        parts.box("wall", white, size, 0.008, x=x, y=y, z=-0.215)
    arc = [(0, -0.09, 0), (0, -0.09, 0.18)] + [
        (0, -0.09 - 0.09 * (1 - cos(a)), 0.18 + 0.09 * sin(a)) for a in (pi * k / 10 for k in range(1, 11))
    ]
    parts.tube("spout", chrome, [*arc, (0, -0.27, 0.14)], 0.012, 14)
    for side in (-1, 1):
        parts.tube("valve", chrome, [(side * 0.09, -0.09, 0), (side * 0.09, -0.09, 0.07)], 0.013, 12)
        parts.tube("lever", chrome, [(side * 0.09, -0.09, 0.07), (side * 0.145, -0.105, 0.085)], 0.007, 10)
    parts.tube("bridge", chrome, [(-0.09, -0.09, 0.04), (0.09, -0.09, 0.04)], 0.010, 12)
    return parts.join()


@kind("cupboard", (0.85, 0.398, 0.75), "hangs", front="-y")
def wall_cupboard(
    name: str, rng: random.Random, *, width_m: float = 0.8, finish: Finish = Finish()
) -> bpy.types.Object:
    """A cupboard on the wall with two panelled doors; origin at the middle of its bottom's back edge."""
    paint = kitchen.painted_front(f"{name}_paint", finish.front, rng)
    brass = principled(f"{name}_pulls", (0.42, 0.30, 0.13), roughness=0.3, metallic=1.0)
    height, depth = 0.70, 0.34
    parts = Parts(name)
    parts.box("box", paint, (width_m, depth - 0.02, height), 0.003, y=-depth / 2)
    parts.box("crown", paint, (width_m + 0.05, depth + 0.03, 0.05), 0.015, y=-depth / 2, z=height)
    for side in (-1, 1):
        parts += _door(
            name, side * width_m / 4, -depth + 0.01, 0.01, width_m / 2 - 0.008, height - 0.02, paint
        )
        parts.ellipsoid("knob", brass, (0.013, 0.013, 0.013), 14, 10, (side * 0.04, -depth - 0.03, 0.10))
    return parts.join()


@kind("shelf", (0.8, 0.22, 0.171), "hangs", "surface", front="-y")
def shelf(name: str, rng: random.Random, *, width_m: float = 0.8) -> bpy.types.Object:
    """An oak board on two iron brackets; origin at the middle of its top's back edge."""
    wood = interior.wood(f"{name}_oak", (0.40, 0.25, 0.12), rng, grain_axis="X")
    iron = kitchen.cast_iron(f"{name}_iron")
    parts = Parts(name)
    parts.box("board", wood, (width_m, 0.22, 0.032), 0.004, y=-0.11, z=-0.032)
    for x in (-0.36 * width_m, 0.36 * width_m):
        parts.tube(
            "brace",
            iron,
            [(x, -0.008, -0.17), (x, -0.02, -0.10), (x, -0.10, -0.04), (x, -0.19, -0.036)],
            0.008,
            10,
        )
    return parts.join()


@kind("island", (2.35, 0.7, 0.9), "surface")
def island(
    name: str, rng: random.Random, *, width_m: float = 2.35, finish: Finish = Finish()
) -> bpy.types.Object:
    """A free-standing block with a stone top, panelled towards -Y; origin under its centre."""
    paint = kitchen.painted_front(f"{name}_paint", finish.front, rng)
    stone = kitchen.worktop(f"{name}_stone", finish.stone, rng)
    brass = principled(f"{name}_pulls", (0.42, 0.30, 0.13), roughness=0.3, metallic=1.0)
    depth = ISLAND_DEPTH_M - 0.12
    parts = _carcass(name, width_m - 0.10, depth, paint)
    parts += _fronts(name, rng, width_m - 0.10, -depth / 2, paint, brass)
    slab = mesh.bevel_box(f"{name}_slab", (width_m, ISLAND_DEPTH_M, _SLAB_M), 0.005)
    parts.append(placed(slab, stone, z=TOP_M - _SLAB_M))
    return mesh.join(name, parts)


@kind("hob", (0.8, 0.46, 0.034), "surface", front="+y")
def hob(
    name: str,
    rng: random.Random,
    *,
    burners: Sequence[tuple[float, float]] = ((-0.2, 0.0), (0.2, 0.0)),
    size_m: tuple[float, float] = (0.8, 0.46),
) -> bpy.types.Object:
    """A gas hob to lie on a worktop: steel tray, a burner and a cast grate per place, knobs along +Y."""
    steel = kitchen.steel(f"{name}_steel", rng, roughness=0.34)
    iron = kitchen.cast_iron(f"{name}_iron")
    flame = principled(f"{name}_cap", (0.05, 0.05, 0.055), roughness=0.4)
    grate_z = HOB_TOP_M - TOP_M
    parts = Parts(name)
    parts.box("tray", steel, (*size_m, 0.008), 0.003)
    for x, y in burners:
        parts.cylinder("ring", steel, 0.046, 0.012, 32, 0.003, x=x, y=y, z=0.006)
        parts.cylinder("cap", flame, 0.034, 0.006, 32, 0.002, x=x, y=y, z=0.017)
        for k in range(4):
            a = pi / 4 + k * pi / 2
            turned = Matrix.Translation(
                (x + 0.082 * cos(a), y + 0.082 * sin(a), grate_z - 0.009)
            ) @ Matrix.Rotation(a, 4, "Z")
            parts.box("bar", iron, (0.115, 0.009, 0.009), 0.002, within=turned)
        for size, dx, dy in (
            ((0.222, 0.009, 0.009), 0, 0.1065),
            ((0.222, 0.009, 0.009), 0, -0.1065),
            ((0.009, 0.222, 0.009), 0.1065, 0),
            ((0.009, 0.222, 0.009), -0.1065, 0),
        ):
            parts.box("rail", iron, size, 0.002, x=x + dx, y=y + dy, z=grate_z - 0.012)
        for dx in (-0.1065, 0.1065):
            for dy in (-0.1065, 0.1065):
                parts.cylinder("foot", iron, 0.006, grate_z - 0.006, 10, x=x + dx, y=y + dy, z=0.004)
    for k in range(len(burners)):
        x = size_m[0] * ((k + 0.5) / len(burners) - 0.5) * 0.6
        parts.cylinder("knob", iron, 0.017, 0.022, 24, 0.004, x=x, y=size_m[1] / 2 - 0.028, z=0.006)
    return parts.join()


@kind("fridge", (0.66, 0.695, 1.75), front="-y", colour=colours("colour"))
def fridge(
    name: str, rng: random.Random, *, colour: tuple[float, float, float] = (0.62, 0.60, 0.50)
) -> bpy.types.Object:
    """A rounded fridge-freezer, 1.75 m high, with notes on its door; back on y = 0."""
    paint = kitchen.painted_front(f"{name}_paint", colour, rng)
    chrome = principled(f"{name}_chrome", (0.62, 0.62, 0.63), roughness=0.15, metallic=1.0)
    dark = principled(f"{name}_gap", (0.03, 0.03, 0.03), roughness=0.8)
    width, depth = 0.66, 0.64
    parts = Parts(name)
    parts.box("body", paint, (width, depth - 0.07, 1.75), 0.04, 5, y=-(depth - 0.07) / 2)
    parts.box("seal", dark, (width - 0.05, 0.02, 1.64), y=-depth + 0.065, z=0.06)
    for low, high in ((0.07, 1.18), (1.195, 1.72)):
        parts.box("door", paint, (width, 0.065, high - low), 0.028, 5, y=-depth + 0.03, z=low)
    for low, high in ((0.72, 1.10), (1.26, 1.50)):
        x, y = -width / 2 + 0.07, -depth - 0.045
        line = [(x, y + 0.04, low), (x, y, low + 0.03), (x, y, high - 0.03), (x, y + 0.04, high)]
        parts.tube("handle", chrome, line, 0.010, 12)
    for k in range(6):
        note = principled(
            f"{name}_note_{k}",
            rng.choice([(0.72, 0.68, 0.55), (0.62, 0.30, 0.22), (0.25, 0.42, 0.52), (0.70, 0.56, 0.18)]),
            roughness=0.8,
            variation=0.4,
            variation_scale=40,
        )
        sheet = mesh.box(f"{name}_note", (rng.uniform(0.06, 0.11), 0.002, rng.uniform(0.07, 0.13)))
        place = Matrix.Translation(
            (
                rng.uniform(-0.12, 0.24),
                -depth - 0.0055,
                rng.uniform(1.24, 1.52) if k < 4 else rng.uniform(0.85, 1.0),
            )
        )
        parts.add(sheet, note, within=place @ Matrix.Rotation(rng.uniform(-0.12, 0.12), 4, "Y"))
    return parts.join()


def _carcass(name: str, width: float, depth: float, paint: bpy.types.Material) -> list[bpy.types.Object]:
    body = mesh.move(mesh.box(f"{name}_carcass", (width, depth, TOP_M - _SLAB_M - _PLINTH_M)), z=_PLINTH_M)
    plinth = mesh.box(f"{name}_plinth", (width - 0.02, depth - 0.10, _PLINTH_M))
    dark = principled(f"{name}_plinth", (0.03, 0.028, 0.026), roughness=0.7, variation=0.3)
    return [mesh.set_material(body, paint), mesh.set_material(plinth, dark)]


def _fronts(
    name: str,
    rng: random.Random,
    width: float,
    y: float,
    paint: bpy.types.Material,
    brass: bpy.types.Material,
) -> list[bpy.types.Object]:
    """Doors, and stacks of drawers between them."""
    count = max(2, round(width / 0.52))
    parts = Parts(name)
    for k in range(count):
        x, wide = width * ((k + 0.5) / count - 0.5), width / count - 0.012
        if k % 3 == 1:
            for low, high in ((0.115, 0.385), (0.397, 0.637), (0.649, 0.850)):
                parts += _door(name, x, y, low, wide, high - low, paint)
                parts.tube(
                    "pull",
                    brass,
                    [
                        (x - 0.06, y - 0.02, high - 0.05),
                        (x - 0.05, y - 0.045, high - 0.05),
                        (x + 0.05, y - 0.045, high - 0.05),
                        (x + 0.06, y - 0.02, high - 0.05),
                    ],
                    0.006,
                    8,
                )
        else:
            parts += _door(name, x, y, 0.115, wide, 0.735, paint)
            side = rng.choice((-1, 1)) * (wide / 2 - 0.05)
            parts.ellipsoid("knob", brass, (0.014, 0.014, 0.014), 14, 10, (x + side, y - 0.04, 0.76))
    return parts


def _door(
    name: str, x: float, y: float, z: float, width: float, height: float, paint: bpy.types.Material
) -> list[bpy.types.Object]:
    """A framed panel whose face is 22 mm before the plane y."""
    rail = min(0.07, 0.28 * height)
    pieces = [((width, 0.016, height), 0.0, 0.0, -0.006)]
    for side in (-1, 1):
        pieces.append(((rail, 0.012, height), side * (width - rail) / 2, 0.0, -0.018))
    pieces += [((width - 2 * rail, 0.012, rail), 0.0, z_rail, -0.018) for z_rail in (0.0, height - rail)]
    return [
        placed(mesh.bevel_box(f"{name}_door", size, 0.0025, 1), paint, x=x + dx, y=y + dy, z=z + dz)
        for size, dx, dz, dy in pieces
    ]
