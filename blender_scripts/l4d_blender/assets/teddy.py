"""A sitting teddy bear: plush body, paw pads, glass eyes, a stitched mouth and a ribbon round the neck.

Front = -Y; the origin lies under the seat. Owns the shape and where it is held (`SIDES_M`).
"""

from __future__ import annotations

import random

import bpy
from mathutils import Matrix, Vector, noise

from l4d_blender.scene.catalogue import kind, words

from ..scene.colour import Colour, rgb
from . import mesh
from .materials import interior
from .materials.base import Nodes, principled

HEIGHT_M = 0.34
#: Where hands hold a bear of scale 1: under its arms.
SIDES_M = ((-0.086, 0.000, 0.172), (0.086, 0.000, 0.172))

PLUSH: dict[str, Colour] = {
    "brown": (0.17, 0.075, 0.028),
    "cream": (0.60, 0.48, 0.33),
    "grey": (0.24, 0.24, 0.25),
    "honey": (0.44, 0.23, 0.065),
}
RIBBONS: dict[str, Colour] = {
    "red": (0.50, 0.022, 0.030),
    "blue": (0.035, 0.12, 0.42),
    "green": (0.05, 0.26, 0.08),
    "yellow": (0.70, 0.42, 0.03),
}


@kind(
    "teddy",
    (0.281, 0.274, 0.344),
    "graspable",
    front="-y",
    colour=words("plush", *PLUSH),
    ribbon=words("ribbon", *RIBBONS),
)
def teddy(
    name: str, rng: random.Random, *, plush: str = "brown", ribbon: str = "red", scale: float = 1.0
) -> bpy.types.Object:
    """A bear; bears built from equal random states are twins."""
    fur = _plush(f"{name}_fur", PLUSH[plush], rng)
    pad = interior.felt(f"{name}_pad", rgb(min(1.0, 0.12 + 1.5 * c) for c in PLUSH[plush]), rng)
    black = principled(f"{name}_black", (0.012, 0.010, 0.010), roughness=0.25)
    shift = Vector([rng.uniform(-9, 9) for _ in range(3)])
    parts = [
        _ball(name, (0.083, 0.074, 0.098), (0.0, 0.004, 0.098), fur, shift),
        _ball(name, (0.077, 0.070, 0.070), (0.0, -0.004, 0.252), fur, shift),
        _ball(name, (0.040, 0.034, 0.032), (0.0, -0.066, 0.236), pad, shift),
        _ball(name, (0.016, 0.012, 0.011), (0.0, -0.098, 0.247), black, shift, lumps=0.0),
    ]
    for s in (-1, 1):
        parts += [
            _ball(name, (0.031, 0.015, 0.031), (s * 0.058, 0.004, 0.310), fur, shift),
            _ball(name, (0.019, 0.010, 0.019), (s * 0.058, -0.008, 0.309), pad, shift),
            _ball(name, (0.0105, 0.0085, 0.0105), (s * 0.029, -0.066, 0.268), black, shift, lumps=0.0),
            _limb(name, (s * 0.066, -0.008, 0.172), (s * 0.108, -0.075, 0.095), 0.036, 0.033, fur, shift),
            _ball(name, (0.020, 0.012, 0.020), (s * 0.111, -0.098, 0.086), pad, shift),
            _limb(name, (s * 0.048, -0.020, 0.046), (s * 0.083, -0.145, 0.045), 0.048, 0.043, fur, shift),
            _ball(name, (0.031, 0.010, 0.035), (s * 0.087, -0.186, 0.048), pad, shift),
        ]
    line = [(-0.020, -0.093, 0.222), (-0.008, -0.100, 0.218), (0.0, -0.101, 0.226), (0.0, -0.101, 0.238)]
    for smile in (line, [(-x, y, z) for x, y, z in line[:3]]):
        parts.append(mesh.set_material(mesh.tube(f"{name}_stitch", smile, 0.0022, 6), black))
    parts += _bow(name, RIBBONS[ribbon], rng)
    bear = mesh.transform(mesh.join(name, parts), Matrix.Scale(scale, 4))
    return mesh.drop_to_base(bear)


def _ball(
    name: str, radii: tuple, centre: tuple, material: bpy.types.Material, shift: Vector, lumps: float = 0.045
) -> bpy.types.Object:
    """A stuffed ball: slightly lumpy."""
    ball = mesh.ellipsoid(f"{name}_ball", radii, 32, 22, centre=centre)
    size = min(radii)
    mesh.displace(ball, lambda p, _: lumps * size * noise.noise(p * 22.0 + shift))
    return mesh.set_material(ball, material)


def _limb(
    name: str, root: tuple, tip: tuple, thick: float, end: float, material: bpy.types.Material, shift: Vector
) -> bpy.types.Object:
    """A stuffed sausage from a root to a rounded tip."""
    a, b = Vector(root), Vector(tip)
    way = (b - a).normalized()
    stations = [
        a,
        a.lerp(b, 0.35),
        a.lerp(b, 0.7),
        b,
        b + 0.45 * end * way,
        b + 0.80 * end * way,
        b + end * way,
    ]
    sizes = [0.85 * thick, thick, 0.5 * (thick + end), end, 0.88 * end, 0.55 * end, 0.08 * end]
    limb = mesh.tube(f"{name}_limb", stations, sizes, 24)
    mesh.displace(limb, lambda p, _: 0.0016 * noise.noise(p * 24.0 + shift))
    return mesh.set_material(limb, material)


def _bow(name: str, colour: Colour, rng: random.Random) -> list[bpy.types.Object]:
    """A ribbon round the neck, tied under the chin."""
    silk = interior.cloth(f"{name}_ribbon", colour, rng, slub_per_m=300.0)
    ring = mesh.torus(f"{name}_collar", 0.058, 0.010, 40, 10)
    mesh.transform(ring, Matrix.Translation((0.0, 0.0, 0.190)) @ Matrix.Diagonal((1.0, 0.95, 1.3, 1.0)))
    parts = [ring, mesh.ellipsoid(f"{name}_knot", (0.013, 0.011, 0.013), 16, 10, centre=(0.0, -0.067, 0.184))]
    for s in (-1, 1):
        loop = mesh.ellipsoid(f"{name}_loop", (0.030, 0.010, 0.019), 20, 12)
        mesh.displace(loop, lambda p, _: Vector((0.0, 0.0, 0.45 * p.z * (abs(p.x) / 0.030))))
        mesh.transform(
            loop, Matrix.Translation((s * 0.036, -0.070, 0.190)) @ Matrix.Rotation(s * -0.25, 4, "Y")
        )
        tail = [(s * 0.006, -0.072, 0.180), (s * 0.020, -0.082, 0.155), (s * 0.031, -0.086, 0.128)]
        parts += [loop, mesh.tube(f"{name}_tail", tail, [(0.009, 0.003), (0.012, 0.003), (0.014, 0.003)], 10)]
    return [mesh.set_material(part, silk) for part in parts]


def _plush(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """Deep pile: tufts, worn and lighter where it is touched, bright at grazing angles."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    place = n.vector_math("ADD", n.object_coords(), tuple(rng.uniform(-5.0, 5.0) for _ in range(3)))
    tufts = n.noise(130.0, 3.0, roughness=0.7, vector=place)
    worn = n.noise(14.0, 3.0, vector=place)
    dark, light = tuple(0.45 * c for c in colour), tuple(min(1.0, 1.35 * c + 0.012) for c in colour)
    base = n.ramp(tufts, [(0.28, dark), (0.52, colour), (0.76, light)])
    n.set("Base Color", n.mix(n.map_range(worn, 0.50, 0.75, 0.0, 0.35), base, light))
    n.set("Roughness", 0.95)
    n.set("Specular IOR Level", 0.1)
    n.set("Sheen Weight", 0.35)
    n.bump(tufts, 0.8, 0.004)
    material.diffuse_color = (*colour, 1.0)
    return material
