"""A wooden casement with a bright, opaque view and a pair of curtains on a rod."""

from __future__ import annotations

import math
import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior
from l4d_blender.assets.materials.base import principled
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import colours, kind


@kind("window", (1.83, 0.205, 2.04), "hangs", front="-y", curtain=colours("curtain"))
def window(
    name: str,
    rng: random.Random,
    *,
    width_m: float = 1.15,
    height_m: float = 1.35,
    sill_m: float = 0.5,
    curtain: tuple[float, float, float] = (0.62, 0.5, 0.3),
    glow: float = 1.25,
) -> list[bpy.types.Object]:
    """[casement, curtains]: the wall is the plane y = 0, the room at -Y; z = 0 is the floor."""
    paint = principled(f"{name}_paint", (0.74, 0.71, 0.65), roughness=0.45, variation=0.1, bump=(60, 0.0006))
    view = mesh.from_pydata(
        f"{name}_view",
        [(-width_m / 2, 0, 0), (width_m / 2, 0, 0), (width_m / 2, 0, height_m), (-width_m / 2, 0, height_m)],
        [(0, 1, 2, 3)],
        smooth=False,
    )
    mesh.set_material(view, interior.daylight_view(f"{name}_daylight", glow, rng))
    bars = Parts(name)

    def bar(size: tuple[float, float, float], x: float, z: float, y: float = 0.0) -> None:
        bars.box("bar", paint, size, 0.006, x=x, y=y, z=z)

    rail = 0.065
    for side in (-1, 1):
        bar((rail, 0.09, height_m + 2 * rail), side * (width_m + rail) / 2, -rail, -0.03)
        bar((0.045, 0.05, height_m), side * (width_m / 2 - 0.022), 0.0, -0.02)
    bar((width_m + 2 * rail, 0.09, rail), 0.0, height_m, -0.03)
    bar((0.06, 0.05, height_m), 0.0, 0.0, -0.02)
    for z in (0.0, height_m - 0.045):
        bar((width_m, 0.05, 0.045), 0.0, z, -0.02)
    bar((width_m, 0.035, 0.028), 0.0, 0.68 * height_m, -0.015)
    bar((width_m + 0.26, 0.20, 0.035), 0.0, -0.06, -0.09)
    casement = mesh.move(mesh.join(name, [view, *bars]), y=-0.012, z=sill_m)

    fabric = interior.cloth(f"{name}_fabric", curtain, rng, slub_per_m=70)
    metal = principled(f"{name}_rod", (0.10, 0.08, 0.07), roughness=0.35, metallic=0.8)
    top = sill_m + height_m + 0.17
    panels = [_curtain(f"{name}_curtain", rng, side, width_m, top, fabric) for side in (-1, 1)]
    reach = width_m / 2 + 0.34
    rod = mesh.tube(f"{name}_rod", [(-reach, -0.13, top + 0.015), (reach, -0.13, top + 0.015)], 0.012, 12)
    return [casement, mesh.join(f"{name}_curtains", [*panels, mesh.set_material(rod, metal)])]


def _curtain(
    name: str, rng: random.Random, side: int, width_m: float, top: float, fabric: bpy.types.Material
) -> bpy.types.Object:
    """A hanging panel whose folds grow deeper towards the floor."""
    columns, rows = 56, 14
    inner, outer = width_m / 2 - 0.10, width_m / 2 + 0.28
    folds, phase = 5.5, rng.uniform(0, 6)
    verts = []
    for j in range(rows + 1):
        drop = j / rows
        depth = 0.022 + 0.026 * drop
        for i in range(columns + 1):
            u = i / columns
            x = inner + (outer - inner) * u + 0.012 * math.sin(9 * u + 3 * drop + phase)
            wave = math.sin(2 * math.pi * folds * u + phase + 0.5 * math.sin(2.2 * drop + phase))
            verts.append((side * x, -0.13 + depth * wave, top * (1 - drop) + 0.012))
    faces = [
        (
            j * (columns + 1) + i,
            (j + 1) * (columns + 1) + i,
            (j + 1) * (columns + 1) + i + 1,
            j * (columns + 1) + i + 1,
        )
        for j in range(rows)
        for i in range(columns)
    ]
    if side < 0:
        faces = [face[::-1] for face in faces]
    return mesh.set_material(mesh.solidify(mesh.from_pydata(name, verts, faces), 0.006, offset=0.0), fabric)
