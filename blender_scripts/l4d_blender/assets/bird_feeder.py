"""What birds are fed from: a glazed dish with water, a shallow tray with seeds."""

from __future__ import annotations

import random

import bpy
from mathutils import Matrix

from l4d_blender.scene.catalogue import colours, kind

from ..scene.colour import Colour
from . import mesh
from .materials import lakeside, outdoors

DISH_RADIUS_M = 0.135
WATER_Z_M = 0.040
TRAY_M = (0.36, 0.26)
SEED_Z_M = 0.024


@kind("dish", (0.27, 0.27, 0.055), "container", colour=colours("glaze"))
def water_dish(name: str, rng: random.Random, *, glaze: Colour = (0.16, 0.27, 0.42)) -> bpy.types.Object:
    """A wide bowl filled nearly to the rim."""
    r = DISH_RADIUS_M
    profile = [
        (0.62 * r, 0.0),
        (0.66 * r, 0.004),
        (0.92 * r, 0.034),
        (r, 0.052),
        (0.975 * r, 0.055),
        (0.95 * r, 0.052),
        (0.86 * r, 0.030),
        (0.0, 0.022),
    ]
    bowl = mesh.set_material(mesh.lathe(f"{name}_bowl", profile, 56), lakeside.enamel(f"{name}_glaze", glaze))
    water = mesh.lathe(f"{name}_water", [(0.90 * r, WATER_Z_M), (0.0, WATER_Z_M)], 56, close_bottom=False)
    mesh.set_material(water, outdoors.still_water(f"{name}_water"))
    return mesh.join(name, [bowl, water])


@kind("tray", (0.53, 0.518, 0.038), "container")
def seed_tray(name: str, rng: random.Random) -> bpy.types.Object:
    """A wooden tray with a heap of seeds; some have been spilt round it."""
    x, y = TRAY_M
    boards = [mesh.bevel_box(f"{name}_floor", (x, y, 0.010), 0.002, 1)]
    for side in (-1, 1):
        long = mesh.bevel_box(f"{name}_side", (x, 0.014, 0.038), 0.003, 2)
        short = mesh.bevel_box(f"{name}_end", (0.014, y, 0.038), 0.003, 2)
        boards += [mesh.move(long, y=side * (y / 2 - 0.007)), mesh.move(short, x=side * (x / 2 - 0.007))]
    tray = mesh.join(f"{name}_boards", boards)
    mesh.set_material(tray, outdoors.weathered_wood(f"{name}_wood", (0.34, 0.21, 0.10), grain_axis="X"))
    heap = mesh.grid(
        f"{name}_heap",
        x - 0.03,
        y - 0.03,
        24,
        18,
        lambda u, v: 0.014 + 0.014 * max(0.0, 1.0 - (u / 0.17) ** 2 - (v / 0.12) ** 2),
    )
    mesh.set_material(heap, outdoors.grain(f"{name}_seeds"))
    kernels = []
    for _ in range(70):
        u, v = rng.gauss(0.0, 0.36 * x), rng.gauss(0.0, 0.36 * y)
        kernel = mesh.ellipsoid(f"{name}_kernel", (0.0035, 0.0062, 0.0030), 7, 5)
        inside = abs(u) < x / 2 and abs(v) < y / 2
        place = Matrix.Translation((u, v, 0.028 if inside else 0.003))
        mesh.transform(kernel, place @ Matrix.Rotation(rng.uniform(0, 6.3), 4, "Z"))
        kernels.append(kernel)
    spilt = mesh.join(f"{name}_spilt", kernels)
    mesh.set_material(spilt, outdoors.straw(f"{name}_kernels", (0.50, 0.34, 0.13)))
    return mesh.join(name, [tray, heap, spilt])
