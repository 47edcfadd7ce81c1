"""A wooden toy car: rounded body, peg driver, four wheels on axles.

Owns the car; it doesn't drive by itself. It stands on z = 0, its bonnet to -Y.
"""

from __future__ import annotations

import random
from math import pi

import bpy
from mathutils import Matrix, Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import colours, kind
from l4d_blender.scene.colour import Colour

WHEEL_M = 0.013
_SIDE_VIEW = (
    (-0.052, 0.012),
    (-0.055, 0.022),
    (-0.050, 0.030),
    (-0.022, 0.034),
    (-0.012, 0.050),
    (0.018, 0.052),
    (0.030, 0.036),
    (0.050, 0.033),
    (0.053, 0.022),
    (0.050, 0.012),
)


@kind("car", (0.073, 0.108, 0.071), "graspable", "pushable", front="-y", colour=colours("paint"))
def toy_car(
    name: str, rng: random.Random, *, paint: Colour = (0.62, 0.36, 0.03), wheels: Colour = (0.22, 0.05, 0.04)
) -> bpy.types.Object:
    """A car 11 cm long with a driver's head."""
    half = 0.022
    sections = [
        [Vector((x, y * shrink, 0.012 + (z - 0.012) * shrink)) for y, z in _SIDE_VIEW]
        for x, shrink in ((-half, 0.93), (-half + 0.003, 1.0), (half - 0.003, 1.0), (half, 0.93))
    ]
    body = mesh.loft(f"{name}_body", sections)
    mesh.shade_smooth(body, 32.0)
    enamel = products.lacquer(f"{name}_paint", paint, rng)
    beech = products.wood(f"{name}_beech", (0.58, 0.40, 0.23), (0.42, 0.26, 0.13), rng, grain_axis="X")
    parts = Parts(name)
    parts.add(body, enamel)

    glass = products.lacquer(f"{name}_glass", (0.30, 0.42, 0.46), rng)
    parts.box("window", glass, (2 * half + 0.0016, 0.024, 0.010), 0.002, y=0.003, z=0.037)
    parts.ellipsoid("head", beech, (0.0105, 0.0105, 0.0115), 20, 14, centre=(0.0, 0.006, 0.060))

    tyre = products.lacquer(f"{name}_tyre", wheels, rng)
    for y in (-0.033, 0.033):
        for side in (-1.0, 1.0):
            at = Matrix.Translation((side * (half + 0.0015), y, WHEEL_M)) @ Matrix.Rotation(
                side * pi / 2, 4, "Y"
            )
            parts.cylinder("wheel", tyre, WHEEL_M, 0.010, 28, bevel_m=0.0025, within=at)
            parts.ellipsoid("hub", beech, (0.005, 0.005, 0.003), 16, 8, centre=(0.0, 0.0, 0.010), within=at)
    return parts.join()
