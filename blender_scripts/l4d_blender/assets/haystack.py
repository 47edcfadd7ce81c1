"""A haystack: a combed dome of straw round a pole, with loose stalks over it and a skirt of litter."""

from __future__ import annotations

import math
import random

import bpy
import numpy as np
from mathutils import Matrix, Vector, noise

from l4d_blender.scene.catalogue import kind

from . import mesh
from .materials import outdoors


def _radius(share: float, radius_m: float) -> float:
    """Radius at a share of the height: a bulge low down, a blunt cone above."""
    return radius_m * (1.0 - share**2.1) ** 0.75 * (0.93 + 0.10 * math.sin(math.pi * min(1.0, share * 2.4)))


@kind("haystack", (1.76, 1.78, 1.85))
def haystack(
    name: str, rng: random.Random, *, radius_m: float = 0.78, height_m: float = 1.55, stalks: int = 3000
) -> bpy.types.Object:
    """A stack of about the given size, origin at the centre of its base; the pole sticks out 0.25 m."""
    shift = Vector([rng.uniform(-9, 9) for _ in range(3)])
    profile = [(_radius(k / 22, radius_m), height_m * k / 22 - (0.05 if k == 0 else 0.0)) for k in range(23)]
    mass = mesh.lathe(f"{name}_mass", profile, segments=56, close_bottom=True)

    def lump(p: Vector, _: Vector) -> Vector:
        flat = Vector((p.x, p.y, 0.0))
        big = 0.10 * noise.noise(p * 1.7 + shift) + 0.035 * noise.noise(p * 6.0 + shift)
        return flat * (big / max(0.25, flat.length))

    mesh.displace(mass, lump)
    mesh.set_material(mass, outdoors.packed_straw(f"{name}_mass"))
    hair = mesh.set_material(_stalks(f"{name}_stalks", mass, rng, stalks), outdoors.straw(f"{name}_stalks"))
    lean = Vector((rng.uniform(-0.05, 0.05), rng.uniform(-0.05, 0.05), 0.0))
    pole = mesh.tube(
        f"{name}_pole",
        [Vector((0, 0, 0.8 * height_m)), Vector((0, 0, height_m + 0.25)) + lean],
        [0.032, 0.024],
        segments=9,
    )
    mesh.set_material(pole, outdoors.weathered_wood(f"{name}_pole"))
    return mesh.join(name, [mass, hair, pole])


def _stalks(name: str, mass: bpy.types.Object, rng: random.Random, count: int) -> bpy.types.Object:
    """Flat stalks that lie on the stack's faces, mostly downwards, their ends standing off."""
    draw = np.random.default_rng(rng.getrandbits(64))
    polygons = [p for p in mass.data.polygons if p.center.z > 0.0]
    areas = np.array([p.area for p in polygons])
    chosen = draw.choice(len(polygons), count, p=areas / areas.sum())
    verts: list[Vector] = []
    faces: list[tuple[int, ...]] = []
    for index in chosen:
        polygon = polygons[index]
        normal = polygon.normal
        corners = [mass.data.vertices[i].co for i in polygon.vertices]
        weights = draw.dirichlet(np.ones(len(corners)))
        root = sum((float(w) * c for w, c in zip(weights, corners, strict=True)), Vector())
        down = Vector((0, 0, -1)) + Vector(draw.normal(0.0, 0.45, 3))
        down = (down - down.project(normal)).normalized()
        side = down.cross(normal)
        length, half = draw.uniform(0.07, 0.22), draw.uniform(0.0025, 0.005)
        start, end = root + 0.004 * normal, root + length * down + draw.uniform(0.008, 0.055) * normal
        if end.z < 0.004:
            end.z = 0.004 + 0.01 * draw.uniform()
        middle = start.lerp(end, 0.55) + 0.012 * normal
        k = len(verts)
        verts += [start - half * side, start + half * side, middle - half * side, middle + half * side, end]
        faces += [(k, k + 1, k + 3, k + 2), (k + 2, k + 3, k + 4)]
    return mesh.from_pydata(name, verts, faces, smooth=False)


@kind("bale", (1.13, 0.748, 0.459), "seat", "surface", "stacks")
def hay_bale(
    name: str, rng: random.Random, *, size_xyz: tuple[float, float, float] = (0.9, 0.45, 0.38)
) -> bpy.types.Object:
    """A tied rectangular bale."""
    body = mesh.subdivide(mesh.bevel_box(f"{name}_body", size_xyz, 0.05, 2), 2)
    shift = Vector([rng.uniform(-9, 9) for _ in range(3)])
    mesh.displace(
        body, lambda p, _: 0.020 * noise.noise(p * 9.0 + shift) + 0.012 * noise.noise(p * 25.0 + shift)
    )
    mesh.set_material(body, outdoors.packed_straw(f"{name}_body", (0.46, 0.33, 0.12)))
    hair = mesh.set_material(_stalks(f"{name}_stalks", body, rng, 260), outdoors.straw(f"{name}_stalks"))
    twine = []
    sx, sy, sz = size_xyz
    for x in (-0.25 * sx, 0.25 * sx):
        corners = [(-sy / 2, 0.02), (sy / 2, 0.02), (sy / 2, sz), (-sy / 2, sz)]
        loop = mesh.tube(
            f"{name}_twine", [Vector((x, y, z)) for y, z in corners], 0.006, segments=6, closed=True
        )
        mesh.set_material(loop, outdoors.rope(f"{name}_twine"))
        twine.append(loop)
    bale = mesh.join(name, [body, hair, *twine])
    return mesh.transform(bale, Matrix.Translation((0, 0, 0.01)))
