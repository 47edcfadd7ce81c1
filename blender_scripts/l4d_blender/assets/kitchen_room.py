"""The shell of a kitchen, open towards -Y and above: clay floor, plaster, a tiled band, a wide window."""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior, kitchen
from l4d_blender.assets.materials.base import principled
from l4d_blender.scene.catalogue import kind

WALL_HEIGHT_M = 2.6
TILES_M = (0.90, 1.50)  # from the worktop up to the shelves


@kind("room", (5.2, 5.25, 2.6), "backdrop")
def kitchen_room(
    name: str,
    rng: random.Random,
    *,
    half_width_m: float = 2.6,
    back_m: float = 1.95,
    front_m: float = -3.3,
    wall: tuple[float, float, float] = (0.62, 0.52, 0.36),
    tile: tuple[float, float, float] = (0.68, 0.64, 0.55),
    clay: tuple[float, float, float] = (0.3, 0.13, 0.07),
) -> list[bpy.types.Object]:
    """Floor, three walls and tiles; walls at x = +-half_width_m and y = back_m, floor to y = front_m."""
    floor = _sheet(
        f"{name}_floor",
        (-half_width_m, front_m, 0),
        (half_width_m, front_m, 0),
        (half_width_m, back_m, 0),
        (-half_width_m, back_m, 0),
    )
    mesh.set_material(floor, kitchen.floor_tiles(f"{name}_clay", clay, rng))
    paint = interior.plaster(f"{name}_plaster", wall, rng)
    glazed = kitchen.wall_tiles(f"{name}_tiles", tile, rng)
    w, top = half_width_m, WALL_HEIGHT_M
    sheets = [floor]
    for k, (a, b) in enumerate(
        (((-w, back_m), (w, back_m)), ((-w, front_m), (-w, back_m)), ((w, back_m), (w, front_m)))
    ):
        sheets.append(mesh.set_material(_upright(f"{name}_wall_{k}", a, b, 0.0, top), paint))
    low, high = TILES_M
    for k, (a, b) in enumerate(
        (((-w, back_m - 0.008), (w, back_m - 0.008)), ((w - 0.008, back_m), (w - 0.008, front_m)))
    ):
        sheets.append(mesh.set_material(_upright(f"{name}_tiled_{k}", a, b, low, high), glazed))
    return sheets


@kind("window", (1.6, 0.225, 1.19), "hangs", front="-y")
def window(
    name: str,
    rng: random.Random,
    *,
    width_m: float = 1.3,
    height_m: float = 1.05,
    sill_m: float = 1.12,
    glow: float = 1.3,
) -> bpy.types.Object:
    """A white two-wing window with a deep sill; the wall is y = 0, the room at -Y, z = 0 the floor."""
    white = principled(f"{name}_paint", (0.74, 0.72, 0.67), roughness=0.4, variation=0.1, bump=(60, 0.0006))
    half = width_m / 2
    view = _sheet(f"{name}_view", (-half, 0, 0), (half, 0, 0), (half, 0, height_m), (-half, 0, height_m))
    mesh.set_material(view, interior.daylight_view(f"{name}_daylight", glow, rng))
    bars = [
        ((0.07, 0.10, height_m + 0.14), -half - 0.035, -0.07, -0.035),
        ((0.07, 0.10, height_m + 0.14), half + 0.035, -0.07, -0.035),
        ((width_m + 0.14, 0.10, 0.07), 0.0, height_m, -0.035),
        ((width_m + 0.30, 0.22, 0.04), 0.0, -0.05, -0.10),
        ((0.075, 0.05, height_m), 0.0, 0.0, -0.02),
        ((width_m, 0.035, 0.03), 0.0, 0.66 * height_m, -0.015),
    ]
    bars += [((0.045, 0.045, height_m), side * (half - 0.02), 0.0, -0.02) for side in (-1, 1)]
    bars += [((width_m, 0.045, 0.045), 0.0, z, -0.02) for z in (0.0, height_m - 0.045)]
    frame = [
        mesh.set_material(mesh.move(mesh.bevel_box(f"{name}_bar", size, 0.006), x=x, y=y, z=z), white)
        for size, x, z, y in bars
    ]
    return mesh.move(mesh.join(name, [view, *frame]), y=-0.012, z=sill_m)


def _sheet(name: str, *corners: tuple[float, float, float]) -> bpy.types.Object:
    return mesh.from_pydata(name, corners, [(0, 1, 2, 3)], smooth=False)


def _upright(
    name: str, a: tuple[float, float], b: tuple[float, float], low: float, high: float
) -> bpy.types.Object:
    return _sheet(name, (*a, low), (*b, low), (*b, high), (*a, high))
