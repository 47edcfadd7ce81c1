"""A woven market basket with a bow handle, a cloth lining and perhaps fruit in it.

The handle's bow runs along X; the origin is the middle of the underside. Owns the shape and where a hand
takes it (`GRIP_Z_M`).
"""

from __future__ import annotations

import random
from math import cos, pi, sin

import bpy
from mathutils import Vector, noise

from l4d_blender.scene.catalogue import kind, words

from ..scene.colour import Colour
from . import mesh
from .materials import interior, products
from .materials.base import Nodes
from .materials.products import scaled

HEIGHT_M = 0.20
RIM_RADII_M = (0.200, 0.155)
GRIP_Z_M = 0.405
GRIP_HALF_M = 0.050  # how far from the middle of the handle there is room for a second hand

WICKER: dict[str, Colour] = {
    "light": (0.50, 0.32, 0.14),
    "dark": (0.17, 0.085, 0.035),
    "grey": (0.30, 0.27, 0.22),
}
CLOTHS: dict[str, Colour] = {
    "red": (0.50, 0.035, 0.035),
    "green": (0.07, 0.28, 0.10),
    "blue": (0.05, 0.14, 0.42),
    "white": (0.72, 0.70, 0.64),
    "yellow": (0.72, 0.46, 0.05),
}
FRUIT: dict[str, Colour] = {
    "apples": (0.46, 0.045, 0.025),
    "lemons": (0.76, 0.52, 0.04),
    "pears": (0.36, 0.40, 0.05),
}

_STAKES, _ROWS, _WEAVER_M = 26, 13, 0.0078


@kind(
    "basket",
    (0.458, 0.349, 0.423),
    "graspable",
    "container",
    wicker=words("wicker", *WICKER),
    cloth=words("cloth", *CLOTHS),
    content=words("content", "empty", *FRUIT),
)
def basket(
    name: str, rng: random.Random, *, wicker: str = "light", cloth: str = "red", content: str = "empty"
) -> bpy.types.Object:
    """A basket; baskets built from equal random states are twins."""
    willow = _willow(f"{name}_willow", WICKER[wicker], rng)
    parts = [*_weave(name), _rim(name, HEIGHT_M, 0.013), _rim(name, 0.006, 0.012), *_handle(name)]
    base = mesh.cylinder(f"{name}_base", 1.0, 0.012, 40)
    mesh.displace(
        base, lambda p, _: Vector((p.x * (_radii(0.0)[0] - 1.0), p.y * (_radii(0.0)[1] - 1.0), 0.004))
    )
    wicker_body = mesh.set_material(mesh.join(f"{name}_wicker", [*parts, base]), willow)
    lining = mesh.set_material(
        _lining(name, rng), interior.cloth(f"{name}_cloth", CLOTHS[cloth], rng, slub_per_m=160.0)
    )
    return mesh.join(name, [wicker_body, lining, *_fill(name, rng, content)])


def _radii(z: float) -> tuple[float, float]:
    """Half axes of the oval wall at a height."""
    t = z / HEIGHT_M
    flare = 0.74 + 0.26 * t**0.7
    return RIM_RADII_M[0] * flare, RIM_RADII_M[1] * flare


def _weave(name: str) -> list[bpy.types.Object]:
    """Weavers that go in front of one stake and behind the next, row by row."""
    parts = []
    for row in range(_ROWS):
        z = 0.014 + (HEIGHT_M - 0.022) * (row + 0.5) / _ROWS
        rx, ry = _radii(z)
        line = []
        count = 3 * _STAKES
        for k in range(count):
            a = 2 * pi * k / count
            out = 0.0042 * cos(0.5 * _STAKES * a + pi * (row % 2))
            line.append(((rx + out) * cos(a), (ry + out) * sin(a), z))
        parts.append(mesh.tube(f"{name}_weaver", line, [(0.0052, _WEAVER_M)] * count, 5, closed=True))
    for k in range(_STAKES):
        a = 2 * pi * (k + 0.5) / _STAKES
        stake = [(_radii(z)[0] * cos(a), _radii(z)[1] * sin(a), z) for z in (0.006, 0.08, 0.14, HEIGHT_M)]
        parts.append(mesh.tube(f"{name}_stake", stake, 0.0042, 5))
    return parts


def _rim(name: str, z: float, thick: float) -> bpy.types.Object:
    """A border of two canes wound round each other."""
    rx, ry = _radii(z)
    line = [(rx * cos(2 * pi * k / 60), ry * sin(2 * pi * k / 60), z) for k in range(60)]
    radii = [thick * (0.86 + 0.14 * cos(20 * 2 * pi * k / 60)) for k in range(60)]
    return mesh.tube(f"{name}_border", line, radii, 7, closed=True)


def _handle(name: str) -> list[bpy.types.Object]:
    """A bow from side to side, wrapped like a rope."""
    strands = []
    for turn in (0.0, 2 * pi / 3, 4 * pi / 3):
        line = []
        for k in range(49):
            t = k / 48
            a = pi * t
            x, z = RIM_RADII_M[0] * 0.97 * cos(a), 0.13 + (GRIP_Z_M - 0.13) * sin(a) ** 0.62
            wind = 26.0 * t + turn
            line.append((x + 0.006 * cos(wind) * cos(a), 0.006 * sin(wind), z + 0.006 * cos(wind) * sin(a)))
        strands.append(mesh.tube(f"{name}_strand", line, 0.0068, 6))
    return strands


def _lining(name: str, rng: random.Random) -> bpy.types.Object:
    """Cloth that covers the inside and hangs over the rim in folds."""
    shift = Vector([rng.uniform(-9, 9) for _ in range(3)])
    profile = [
        (0.62, -0.170),
        (0.86, -0.10),
        (0.93, -0.02),
        (0.97, 0.014),
        (1.04, 0.016),
        (1.10, -0.008),
        (1.11, -0.060),
    ]
    count, verts = 72, []
    for level, (share, drop) in enumerate(profile):
        for k in range(count):
            a = 2 * pi * k / count
            fold = noise.noise(Vector((3.0 * cos(a), 3.0 * sin(a), 0.0)) + shift)
            ripple = 0.030 * sin(11 * a + 4 * fold) * max(0, level - 3) / 3
            hang = drop + (0.018 * fold if level == len(profile) - 1 else 0.0)
            r = share + ripple
            verts.append((RIM_RADII_M[0] * r * cos(a), RIM_RADII_M[1] * r * sin(a), HEIGHT_M + hang))
    faces: list[tuple[int, ...]] = [
        (i * count + k, i * count + (k + 1) % count, (i + 1) * count + (k + 1) % count, (i + 1) * count + k)
        for i in range(len(profile) - 1)
        for k in range(count)
    ]
    faces.append(tuple(reversed(range(count))))
    cloth = mesh.from_pydata(f"{name}_lining", verts, faces)
    mesh.solidify(cloth, 0.003, offset=0.0)
    return mesh.shade_smooth(cloth)


def _fill(name: str, rng: random.Random, content: str) -> list[bpy.types.Object]:
    if content == "empty":
        return []
    skin = products.glaze(f"{name}_{content}", FRUIT[content], rng, speckle=0.25)
    parts = []
    for _ in range(22):
        r, a = 0.13 * rng.random() ** 0.5, rng.uniform(0, 2 * pi)
        height = HEIGHT_M - 0.045 + 0.050 * (1.0 - r / 0.13) + rng.uniform(-0.006, 0.010)
        size = rng.uniform(0.034, 0.040)
        fruit = mesh.ellipsoid(f"{name}_fruit", (size, size, 0.92 * size), 16, 11)
        mesh.move(fruit, 1.20 * r * cos(a), 0.86 * r * sin(a), height)
        parts.append(mesh.set_material(fruit, skin))
    return parts


def _willow(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """Peeled or boiled willow: every rod has its own tone."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    each = n.node("ShaderNodeNewGeometry").outputs["Random Per Island"]
    place = n.vector_math("ADD", n.object_coords(), tuple(rng.uniform(-9.0, 9.0) for _ in range(3)))
    streak = n.noise(40.0, 3.0, vector=place)
    tone = n.ramp(each, [(0.0, scaled(colour, 0.62)), (0.5, colour), (1.0, scaled(colour, 1.30))])
    n.set("Base Color", n.mix(n.map_range(streak, 0.40, 0.70, 0.0, 0.45), tone, scaled(colour, 0.55)))
    n.set("Roughness", 0.6)
    n.bump(streak, 0.4, 0.001)
    material.diffuse_color = (*colour, 1.0)
    return material
