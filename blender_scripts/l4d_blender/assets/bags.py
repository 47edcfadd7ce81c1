"""Bags that people carry: a duffel with two grip handles, a backpack with straps and a top loop.

Owns shapes and where a hand takes hold. Knows nothing of people. Long side of the duffel along X, the
backpack's pocket at -Y; both stand on z = 0.
"""

from __future__ import annotations

import random
from math import cos, pi, sin

import bpy
from mathutils import Vector, noise

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import kind, words
from l4d_blender.scene.colour import Colour

COLOURS: dict[str, Colour] = {
    "brown": (0.20, 0.085, 0.035),
    "green": (0.055, 0.115, 0.060),
    "navy": (0.020, 0.035, 0.095),
    "grey": (0.15, 0.155, 0.165),
    "red": (0.42, 0.035, 0.030),
    "yellow": (0.62, 0.36, 0.035),
}
DUFFEL_LENGTH_M, DUFFEL_DEPTH_M, DUFFEL_HEIGHT_M = 0.48, 0.25, 0.25
DUFFEL_GRIP = Vector((0.0, 0.0, 0.352))
BACKPACK_GRIP = Vector((0.0, 0.055, 0.438))


@kind("bag", (0.48, 0.262, 0.358), "graspable", "container", colour=words("colour", *COLOURS))
def duffel(name: str, rng: random.Random, *, colour: str = "brown") -> bpy.types.Object:
    """A barrel bag that sags on its base, with webbing, end patches, a zip and handles brought together."""
    hide = products.leather(f"{name}_hide", COLOURS[colour], rng)
    trim = products.leather(f"{name}_trim", products.scaled(COLOURS[colour], 0.32), rng)
    brass = products.metal(f"{name}_brass", (0.60, 0.44, 0.18), rng, roughness=0.28)
    phase = Vector((rng.uniform(0, 50), rng.uniform(0, 50), 0.0))
    sections, steps, ring = [], 20, 32
    for n in range(steps + 1):
        u = 2 * n / steps - 1
        girth = (1.0 - abs(u) ** 7) ** 0.5 * (0.96 + 0.04 * cos(3.5 * u))
        girth = max(girth, 0.42)
        loop = []
        for k in range(ring):
            a = 2 * pi * k / ring
            y, z = (abs(f) ** 0.82 * (1 if f >= 0 else -1) for f in (cos(a), sin(a)))
            at = Vector((0.5 * DUFFEL_LENGTH_M * u, 0.5 * DUFFEL_DEPTH_M * girth * y, 0.0))
            at.z = 0.5 * DUFFEL_HEIGHT_M * (1.0 + girth * z)
            crease = 0.006 * noise.noise(at * 14 + phase) + 0.004 * sin(26 * u + 2 * sin(a)) * max(z, 0.0)
            at.z -= 0.014 * (1 - u * u) * max(z, 0.0)
            at.y *= 1.0 + 3.0 * crease
            at.z = max(at.z + crease, 0.002)
            loop.append(at)
        sections.append(loop)
    body = mesh.subdivide(mesh.loft(f"{name}_body", sections), 1)
    mesh.paint(body, [hide, trim], lambda centre, _: int(abs(centre.x) > 0.44 * DUFFEL_LENGTH_M))
    parts = Parts(name)
    parts.add(body)
    parts.tube(
        "zip",
        brass,
        [
            (0.5 * DUFFEL_LENGTH_M * u, 0.0, DUFFEL_HEIGHT_M - 0.009 + 0.012 * u * u)
            for u in (-0.8, -0.4, 0.0, 0.4, 0.8)
        ],
        [(0.014, 0.005)] * 5,
        segments=10,
    )
    for side in (-1.0, 1.0):
        for x in (-0.105, 0.105):
            band = [
                (x, side * 0.137 * cos(a) * 0.93, 0.125 + 0.131 * sin(a) * 0.97)
                for a in (-1.2, -0.8, -0.4, 0.0, 0.4, 0.8, 1.15)
            ]
            parts.tube("strap", trim, band, [(0.016, 0.0035)] * 7, segments=8, up=(0, side, 0))
        handle = []
        for k in range(13):
            a = pi * k / 12
            rise = sin(a) ** 0.75
            handle.append((-0.105 * cos(a), side * (0.062 * (1 - rise) + 0.011), 0.235 + 0.117 * rise))
        parts.tube("handle", trim, handle, 0.0085, segments=10)
    parts.box("tag", trim, (0.045, 0.004, 0.075), 0.0015, x=0.15, y=-0.128, z=0.12)
    for x in (-0.20, 0.20):
        parts.torus("ring", brass, 0.015, 0.0028, 18, 8, x=x, z=DUFFEL_HEIGHT_M + 0.004, turn=("Y", 90.0))
    return mesh.drop_to_base(parts.join())


@kind("bag", (0.293, 0.28, 0.448), "graspable", "container", colour=words("colour", *COLOURS))
def backpack(
    name: str, rng: random.Random, *, colour: str = "green", accent: Colour = (0.55, 0.28, 0.08)
) -> bpy.types.Object:
    """A daypack 42 cm tall: rounded body, front pocket, zips, padded straps at the back, a loop on top."""
    cloth = products.woven_cloth(f"{name}_cloth", COLOURS[colour], rng, threads_per_m=700.0, contrast=0.3)
    dark = products.woven_cloth(
        f"{name}_dark", products.scaled(COLOURS[colour], 0.4), rng, threads_per_m=700.0
    )
    bright = products.leather(f"{name}_accent", accent, rng)
    parts = Parts(name)
    parts.add(_padded(f"{name}_body", (0.29, 0.165, 0.405), 0.075, 0.010, rng), cloth)
    parts.add(_padded(f"{name}_pocket", (0.225, 0.075, 0.19), 0.032, 0.006, rng), cloth, y=-0.095, z=0.035)
    parts.add(_padded(f"{name}_base", (0.294, 0.170, 0.065), 0.028, 0.002, rng), bright, z=0.0)
    arch = (
        [(-0.125, -0.066, 0.20)]
        + [
            (-0.122 * cos(a), -0.060 - 0.012 * sin(a), 0.285 + 0.092 * sin(a))
            for a in (0.0, 0.5, 1.0, pi / 2, 2.14, 2.64, pi)
        ]
        + [(0.125, -0.066, 0.20)]
    )
    parts.tube("zip", dark, arch, 0.0045, segments=8)
    pull = [(-0.095, -0.135, 0.195), (0.0, -0.141, 0.203), (0.095, -0.135, 0.195)]
    parts.tube("pocket_zip", dark, pull, 0.004, segments=8)
    parts.box("patch", bright, (0.075, 0.004, 0.040), 0.0015, y=-0.134, z=0.10)
    for x in (-0.075, 0.075):
        strap = [
            (x * 0.7, 0.075, 0.385),
            (x, 0.115, 0.36),
            (x * 1.15, 0.125, 0.27),
            (x * 1.25, 0.110, 0.16),
            (x * 1.5, 0.085, 0.055),
        ]
        parts.tube("strap", dark, strap, [(0.024, 0.007)] * 5, segments=10, up=(0, 1, 0))
    loop = [(-0.045 * cos(a), 0.055, 0.388 + 0.052 * sin(a) ** 0.8) for a in (pi * k / 8 for k in range(9))]
    parts.tube("loop", bright, loop, 0.008, segments=10)
    return mesh.drop_to_base(parts.join())


def _padded(
    name: str, size: tuple[float, float, float], bevel_m: float, puff_m: float, rng: random.Random
) -> bpy.types.Object:
    """A soft box with rounded edges and shallow dents."""
    obj = mesh.subdivide(mesh.bevel_box(name, size, bevel_m, 3), 2)
    phase = Vector((rng.uniform(0, 50), rng.uniform(0, 50), rng.uniform(0, 50)))

    def dent(at: Vector, normal: Vector) -> Vector:
        keep = min(1.0, at.z / 0.03)
        return normal * (puff_m * keep * noise.noise(at * 11 + phase))

    return mesh.shade_smooth(mesh.displace(obj, dent))
