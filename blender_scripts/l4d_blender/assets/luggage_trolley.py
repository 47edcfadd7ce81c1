"""An airport luggage trolley: three wheels, a wire deck, a front basket rail and a push bar.

It is pushed towards -Y (its front); the bar is at +Y. Metres.
"""

from __future__ import annotations

import random

import bpy

from l4d_blender.scene.catalogue import kind

from . import mesh
from .materials import products, street
from .parts import Parts


@kind("trolley", (0.612, 1.1, 1.02), "rolls", "container", front="-y")
def luggage_trolley(name: str, rng: random.Random) -> bpy.types.Object:
    """About 0.62 m wide, 1.05 m long and 1.02 m high."""
    steel = street.steel(f"{name}_steel")
    grip = products.rubber(f"{name}_grip", (0.03, 0.03, 0.032), rng)
    plate = products.lacquer(f"{name}_plate", (0.62, 0.36, 0.02), rng)
    tyre = street.tyre(f"{name}_tyre")
    parts = Parts(name)

    def bar(points: list[tuple[float, float, float]], radius: float, material: bpy.types.Material) -> None:
        parts.tube("bar", material, points, radius, segments=10)

    deck = 0.21
    for s in (-1.0, 1.0):
        bar(
            [
                (s * 0.16, -0.55, deck),
                (s * 0.29, 0.30, deck),
                (s * 0.29, 0.42, deck + 0.04),
                (s * 0.29, 0.45, deck + 0.18),
                (s * 0.28, 0.46, 0.98),
            ],
            0.016,
            steel,
        )
        bar([(s * 0.285, 0.44, 0.62), (s * 0.255, 0.10, 0.62), (s * 0.25, 0.02, 0.585)], 0.011, steel)
    bar(
        [(-0.16, -0.55, deck), (-0.13, -0.60, deck + 0.03), (0.13, -0.60, deck + 0.03), (0.16, -0.55, deck)],
        0.016,
        steel,
    )
    bar(
        [(-0.14, -0.58, deck), (-0.13, -0.60, deck + 0.15), (0.13, -0.60, deck + 0.15), (0.14, -0.58, deck)],
        0.011,
        steel,
    )
    for k in range(9):
        y = -0.50 + 0.105 * k
        half = 0.165 + 0.13 * k / 8
        bar([(-half, y, deck + 0.004), (half, y, deck + 0.004)], 0.006, steel)
    for x in (-0.08, 0.08):
        bar([(x, -0.58, deck - 0.008), (x * 1.8, 0.42, deck - 0.008)], 0.008, steel)
    for z in (0.36, 0.50, 0.64):
        bar([(-0.285, 0.452, z), (0.285, 0.452, z)], 0.008, steel)
    bar([(-0.28, 0.25, 0.595), (-0.25, 0.02, 0.585), (0.25, 0.02, 0.585), (0.28, 0.25, 0.595)], 0.008, steel)
    bar([(-0.30, 0.46, 1.00), (0.30, 0.46, 1.00)], 0.022, grip)
    parts.box("board", plate, (0.46, 0.012, 0.20), 0.005, 2, y=0.458, z=0.72)
    for x, y in ((0.0, -0.46), (-0.25, 0.34), (0.25, 0.34)):
        wheel = mesh.rotate(
            mesh.move(mesh.cylinder(f"{name}_wheel", 0.078, 0.034, 24, 0.01), z=-0.017), "Y", 90.0
        )
        parts.add(wheel, tyre, x=x, y=y, z=0.078)
        parts.box("fork", steel, (0.052, 0.05, 0.15), 0.01, 2, x=x, y=y, z=0.065)
    return parts.join()
