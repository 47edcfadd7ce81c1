"""A sandbox: planks round a bed of trodden sand, with a pail, a spade and moulds in it.

Owns the wooden edge and the sand's surface (`Sand.height`). Front = none; the origin lies on the ground in
the middle.
"""

from __future__ import annotations

import random
from dataclasses import dataclass, field

import bpy
from mathutils import Matrix, Vector, noise

from l4d_blender.scene.catalogue import kind, words

from . import mesh
from .materials import outdoors, playground, products
from .parts import Parts

EDGE_M = 0.145
_PLANK_M, _CAP_M = 0.045, 0.125


@dataclass(frozen=True)
class Sand:
    """Height of the sand's surface over the sandbox' own x and y, level round the `flat` places."""

    seed: Vector = field(default_factory=Vector)
    flat: tuple[tuple[float, float, float], ...] = ()
    level_m: float = 0.075

    def height(self, x: float, y: float) -> float:
        """Metres above the ground."""
        here = Vector((x, y, 0.0)) + self.seed
        relief = 0.030 * noise.noise(here * 3.1) + 0.012 * noise.noise(here * 9.0)
        for fx, fy, radius in self.flat:
            away = min(1.0, (Vector((x - fx, y - fy)).length / radius) ** 2)
            relief *= away
        return self.level_m + relief


def sand_of(rng: random.Random, flat: tuple[tuple[float, float, float], ...] = ()) -> Sand:
    """A sand surface that is level within a radius of some places (x, y, radius)."""
    return Sand(Vector([rng.uniform(-50.0, 50.0) for _ in range(3)]), flat)


@kind("sandbox", (1.14, 1.05, 0.171), "container", "surface")
def sandbox(
    name: str, rng: random.Random, *, sand: Sand = Sand(), size_m: tuple[float, float] = (1.02, 0.92)
) -> bpy.types.Object:
    """Edge and sand as one object."""
    sx, sy = size_m
    parts = Parts(name)
    parts.add(
        mesh.grid("sand", sx - _PLANK_M, sy - _PLANK_M, 44, 44, sand.height), playground.sand(f"{name}_sand")
    )
    for axis, length, offset in (("X", sx + _CAP_M, sy), ("Y", sy - _CAP_M, sx)):
        wood = outdoors.weathered_wood(f"{name}_wood_{axis.lower()}", (0.40, 0.27, 0.15), grain_axis=axis)
        for s in (-1, 1):
            plank = mesh.bevel_box(f"{name}_plank", (length - 0.06, _PLANK_M, EDGE_M), 0.008)
            cap = mesh.bevel_box(f"{name}_cap", (length - 0.004, _CAP_M, 0.026), 0.008)
            mesh.move(cap, z=EDGE_M)
            for piece in (plank, cap):
                mesh.move(piece, y=s * offset / 2, z=-0.02)
                if axis == "Y":
                    mesh.rotate(piece, "Z", 90.0)
                parts.add(piece, wood)
    return parts.join()


@kind("pail", (0.178, 0.183, 0.142), "graspable", "container", colour=words("colour", *playground.PAINTS))
def pail(name: str, rng: random.Random, *, colour: str = "yellow") -> bpy.types.Object:
    """A child's pail with a handle folded down."""
    body = mesh.lathe(
        f"{name}_body",
        [
            (0.056, 0.0),
            (0.06, 0.004),
            (0.076, 0.13),
            (0.084, 0.134),
            (0.084, 0.142),
            (0.072, 0.142),
            (0.055, 0.012),
            (0.0, 0.01),
        ],
        36,
    )
    bow = [(0.084, 0.0, 0.128), (0.070, -0.060, 0.09), (0.0, -0.094, 0.07), (-0.070, -0.060, 0.09)]
    handle = mesh.tube(f"{name}_handle", [*bow, (-0.084, 0.0, 0.128)], 0.005, 8)
    mesh.set_material(handle, products.satin_plastic(f"{name}_white", playground.PAINTS["white"], rng))
    mesh.set_material(body, products.satin_plastic(f"{name}_plastic", playground.PAINTS[colour], rng))
    return mesh.join(name, [body, handle])


@kind("spade", (0.095, 0.35, 0.028), "graspable", colour=words("colour", *playground.PAINTS))
def spade(name: str, rng: random.Random, *, colour: str = "blue") -> bpy.types.Object:
    """A toy spade lying on its back along Y, blade towards -Y."""
    blade = mesh.bevel_box(f"{name}_blade", (0.095, 0.13, 0.010), 0.004)
    mesh.displace(blade, lambda p, _: Vector((0.0, 0.0, 2.4 * p.x * p.x)))
    stem = mesh.tube(f"{name}_stem", [(0, 0.055, 0.012), (0, 0.16, 0.020), (0, 0.27, 0.022)], 0.009, 10)
    grip = mesh.tube(f"{name}_grip", [(-0.042, 0.275, 0.022), (0.042, 0.275, 0.022)], 0.010, 10)
    made = mesh.join(name, [blade, stem, grip])
    return mesh.set_material(made, products.satin_plastic(f"{name}_plastic", playground.PAINTS[colour], rng))


@kind("cake", (0.145, 0.149, 0.1))
def sand_cake(name: str, rng: random.Random) -> bpy.types.Object:
    """What a pail leaves behind when it is turned over: a crumbling cone of sand."""
    cake = mesh.cylinder(name, 0.074, 0.095, 30, bevel_m=0.006, top_radius=0.055)
    shift = Vector([rng.uniform(-9, 9) for _ in range(3)])
    mesh.displace(cake, lambda p, normal: 0.006 * noise.noise(26.0 * p + shift))
    mesh.transform(cake, Matrix.Translation((0.0, 0.0, -0.008)))
    return mesh.set_material(cake, playground.sand(f"{name}_sand", (0.46, 0.34, 0.20)))
