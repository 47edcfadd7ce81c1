"""Stuffed things: pillows that bulge in the middle and pinch at the corners, and upholstered blocks."""

from __future__ import annotations

import random

import bpy
from mathutils import Vector, noise

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior
from l4d_blender.scene.catalogue import kind


@kind("cushion", (0.42, 0.16, 0.42), "graspable")
def cushion(
    name: str,
    rng: random.Random,
    *,
    size_m: tuple[float, float] = (0.42, 0.42),
    thickness_m: float = 0.15,
    material: bpy.types.Material | None = None,
) -> bpy.types.Object:
    """A scatter cushion that stands on one edge, its large faces towards -Y and +Y."""
    width, height = size_m
    cells = 14
    verts, faces = [], []
    phase = Vector((rng.uniform(0, 50), rng.uniform(0, 50), 0))
    for side in (-1, 1):
        for j in range(cells + 1):
            for i in range(cells + 1):
                u, v = 2 * i / cells - 1, 2 * j / cells - 1
                bulge = ((1 - u**4) * (1 - v**4)) ** 0.55
                pinch_u, pinch_v = 1 - 0.07 * (1 - v * v), 1 - 0.07 * (1 - u * u)
                crease = 0.010 * noise.noise(Vector((3 * u, 3 * v, side)) + phase) * bulge
                verts.append(
                    (
                        u * width / 2 * pinch_u,
                        side * (bulge * thickness_m / 2 + crease),
                        height / 2 + v * height / 2 * pinch_v,
                    )
                )
    row = cells + 1

    def at(side: int, i: int, j: int) -> int:
        return side * row * row + j * row + i

    for j in range(cells):
        for i in range(cells):
            faces.append((at(0, i, j), at(0, i + 1, j), at(0, i + 1, j + 1), at(0, i, j + 1)))
            faces.append((at(1, i, j), at(1, i, j + 1), at(1, i + 1, j + 1), at(1, i + 1, j)))
    rim = (
        [(i, 0) for i in range(cells)]
        + [(cells, j) for j in range(cells)]
        + [(i, cells) for i in range(cells, 0, -1)]
        + [(0, j) for j in range(cells, 0, -1)]
    )
    for (i, j), (k, m) in zip(rim, rim[1:] + rim[:1]):
        faces.append((at(0, k, m), at(0, i, j), at(1, i, j), at(1, k, m)))
    material = material or interior.cloth(f"{name}_cloth", (0.58, 0.36, 0.08), rng)
    return mesh.set_material(mesh.from_pydata(name, verts, faces), material)


@kind("cushion", (0.551, 0.552, 0.176), "seat")
def block(
    name: str,
    rng: random.Random,
    *,
    size_m: tuple[float, float, float] = (0.55, 0.55, 0.16),
    bevel_m: float = 0.05,
    puff_m: float = 0.015,
) -> bpy.types.Object:
    """An upholstered block on z = 0: rounded edges, a slightly domed top, soft unevenness."""
    obj = mesh.subdivide(mesh.bevel_box(name, size_m, bevel_m, 3), 2)
    phase = Vector((rng.uniform(0, 50), rng.uniform(0, 50), rng.uniform(0, 50)))
    half_x, half_y, top = size_m[0] / 2, size_m[1] / 2, size_m[2]

    def swell(at: Vector, normal: Vector) -> Vector:
        u, v = at.x / half_x, at.y / half_y
        dome = max(0.0, 1 - u**4) * max(0.0, 1 - v**4) * (at.z / top)
        uneven = 0.004 * noise.noise(5 * at + phase)
        return Vector((0, 0, puff_m * dome)) + normal * uneven

    return mesh.shade_smooth(mesh.displace(obj, swell))
