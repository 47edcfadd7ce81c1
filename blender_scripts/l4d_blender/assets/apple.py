"""Apples: round at the equator so that they roll, hollow at stem and calyx, perhaps a leaf, perhaps a bite.

Owns the shape and says where the rolling axis is. Knows nothing of bowls or hands. The stem points up (+Z),
the apple stands on z = 0; the leaf is towards +Y, the bite towards -Y.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from math import cos, exp, pi, sin

import bpy
from mathutils import Matrix, Vector, noise

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products, tableware
from l4d_blender.assets.materials.base import principled
from l4d_blender.scene import keys
from l4d_blender.scene.catalogue import Choice, kind
from l4d_blender.scene.colour import Colour

RED = ((0.46, 0.24, 0.045), (0.36, 0.016, 0.014))
GREEN = ((0.22, 0.33, 0.035), (0.30, 0.30, 0.05))
YELLOW = ((0.55, 0.40, 0.06), (0.52, 0.20, 0.03))

# Half a section as (radius, height) in radii of the equator, from the calyx to the stem's hollow.
_SECTION = (
    (0.0, 0.13),
    (0.10, 0.10),
    (0.20, 0.03),
    (0.32, 0.0),
    (0.46, 0.03),
    (0.66, 0.16),
    (0.84, 0.40),
    (0.95, 0.68),
    (1.0, 0.98),
    (0.985, 1.24),
    (0.90, 1.50),
    (0.75, 1.67),
    (0.55, 1.745),
    (0.36, 1.71),
    (0.22, 1.60),
    (0.10, 1.46),
    (0.0, 1.40),
)
_EQUATOR = 0.98
_SEGMENTS, _RINGS = 56, 44


@dataclass(frozen=True)
class Look:
    """Radius at the equator in metres, ground colour and blush, leaf and bite."""

    radius_m: float = 0.039
    skin: tuple[Colour, Colour] = RED
    leaf: bool = True
    bitten: bool = False

    @property
    def middle(self) -> Vector:
        """The centre of the equator: it stays a radius above what the apple rolls on."""
        return Vector((0.0, 0.0, _EQUATOR * self.radius_m))


@kind(
    "apple",
    (0.078, 0.08, 0.083),
    "graspable",
    "rolls",
    colour=Choice("look.skin", {"red": RED, "green": GREEN, "yellow": YELLOW}),
    size=Choice("look.radius_m", {"large": 0.039, "small": 0.0335}),
    state=Choice("look.bitten", {"whole": False, "bitten": True}),
)
def apple(name: str, rng: random.Random, *, look: Look = Look()) -> bpy.types.Object:
    """One apple, about 7 to 8 cm across."""
    r = look.radius_m
    profile = _resampled()
    body = mesh.lathe(f"{name}_body", [(a * r, z * r) for a, z in profile], _SEGMENTS, close_bottom=False)
    lobes, shift = rng.uniform(0, 6), rng.uniform(-9, 9)

    def knobbly(p: Vector, _: Vector) -> Vector:
        """Five lobes at the calyx and a slant at the shoulder; nothing on the band that rolls."""
        off = (p.z - look.middle.z) / r
        free = 1.0 - exp(-((off / 0.45) ** 2))
        angle = Vector((p.x, p.y)).angle_signed(Vector((1.0, 0.0)), 0.0) if p.xy.length > 1e-6 else 0.0
        lobe = 0.030 * cos(5 * angle + lobes) * max(0.0, -off) + 0.028 * noise.noise(
            p / r * 1.1 + Vector((shift, 0, 0))
        )
        return Vector((p.x, p.y, 0.35 * p.z)) * lobe * free

    mesh.displace(body, knobbly)
    skin = tableware.apple_skin(f"{name}_skin", *look.skin, rng)
    flesh = _flesh(f"{name}_flesh", rng)
    bites = _bites(r) if look.bitten else []
    _carve(body, bites)
    mesh.paint(
        body, [skin, flesh], lambda centre, _: int(any((centre - c).length < 1.012 * s for c, s in bites))
    )
    mesh.shade_smooth(body, 48.0 if bites else None)
    stem = mesh.tube(
        f"{name}_stem",
        [(0, 0, 1.40 * r), (0.02 * r, 0.01 * r, 1.70 * r), (0.08 * r, 0.05 * r, 2.0 * r)],
        [0.0013, 0.0011, 0.0018],
        10,
    )
    parts = [
        body,
        mesh.set_material(stem, products.wood(f"{name}_wood", (0.16, 0.09, 0.03), (0.07, 0.04, 0.015), rng)),
    ]
    if look.leaf:
        green = products.leaf(f"{name}_leaf", (0.07, 0.20, 0.03), rng)
        pose = Matrix.Translation((0.03 * r, 0.0, 1.78 * r)) @ Matrix.Rotation(0.6, 4, "Z")
        parts.append(mesh.set_material(mesh.transform(_leaf(f"{name}_blade", 1.25 * r), pose), green))
    return mesh.join(name, parts)


def _resampled() -> list[tuple[float, float]]:
    path = keys.Path([(a, 0.0, z) for a, z in _SECTION])
    points = [path.point(path.length * k / _RINGS) for k in range(_RINGS + 1)]
    return [(0.0 if k in (0, _RINGS) else max(p.x, 0.001), p.z) for k, p in enumerate(points)]


def _bites(r: float) -> list[tuple[Vector, float]]:
    """Balls that teeth have taken away, at the shoulder."""
    return [
        (Vector((x * r, -1.02 * r, z * r)), s * r)
        for x, z, s in (
            (-0.34, 1.52, 0.40),
            (0.0, 1.62, 0.44),
            (0.34, 1.52, 0.40),
            (-0.15, 1.22, 0.40),
            (0.19, 1.2, 0.40),
        )
    ]


def _carve(body: bpy.types.Object, bites: list[tuple[Vector, float]]) -> None:
    """Moves what lies inside a ball onto its far side, along the way to the core."""
    if not bites:
        return
    mesh.subdivide(body, 1)
    core = sum((c for c, _ in bites), Vector()) / len(bites) * 0.12
    for vertex in body.data.vertices:
        p = vertex.co.copy()
        way = (Vector((core.x, core.y, p.z * 0.75 + 0.25 * core.z)) - p).normalized()
        for centre, size in bites:
            off = p - centre
            inside = size * size - off.length_squared
            if inside > 0.0:
                along = off.dot(way)
                p = p + way * (-along + (along * along + inside) ** 0.5)
        vertex.co = p
    body.data.update()


def _flesh(name: str, rng: random.Random) -> bpy.types.Material:
    """Wet flesh with the marks of teeth, browning a little."""
    brown = rng.uniform(0.85, 1.0)
    return principled(
        name,
        (0.74 * brown, 0.66 * brown, 0.40 * brown),
        roughness=0.38,
        variation=0.16,
        variation_scale=90.0,
        bump=(260.0, 0.0012),
    )


def _leaf(name: str, length: float) -> bpy.types.Object:
    """A blade along +Y, folded along its rib and bent."""
    verts, faces = [], []
    rows = 9
    for j in range(rows + 1):
        t = j / rows
        half = 0.24 * length * max(sin(pi * t**0.8), 0.04)
        z = 0.22 * length * sin(0.9 * pi * t) - 0.10 * length * t * t
        verts += [(s * half, length * t, z + 0.35 * half * abs(s)) for s in (-1.0, -0.5, 0.0, 0.5, 1.0)]
    for j in range(rows):
        for i in range(4):
            a = 5 * j + i
            faces.append((a, a + 1, a + 6, a + 5))
    return mesh.solidify(mesh.from_pydata(name, verts, faces), 0.0005)
