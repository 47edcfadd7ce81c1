"""A city bus as it stands in the distance: body, window band, destination sign, wheels. Scenery only.

It faces -Y, 11 m long, on z = 0. Metres.
"""

from __future__ import annotations

import random

import bpy

from l4d_blender.scene.catalogue import colours, kind

from . import mesh
from .lettering import lettering
from .materials import street
from .materials.base import emission, principled
from .parts import Parts

SIZE_M = (2.5, 11.0, 3.0)


@kind("bus", (2.56, 11.1, 3.0), "drives", front="-y", colour=colours("colour"))
def bus(
    name: str,
    rng: random.Random,
    *,
    colour: tuple[float, float, float] = (0.55, 0.53, 0.48),
    line: str = "17 CITY",
) -> bpy.types.Object:
    """Low-floor bus in one colour with a darker skirt."""
    paint = street.car_paint(f"{name}_paint", colour, rng)
    skirt = street.car_paint(f"{name}_skirt", (0.03, 0.09, 0.22), rng)
    glass = street.window_pane(f"{name}_glass", lit=(1.0, 0.85, 0.6), strength=0.5)
    tyre, dark = street.tyre(f"{name}_tyre"), street.street_metal(f"{name}_dark", (0.015, 0.015, 0.016))
    wide, long_, tall = SIZE_M
    parts = Parts(name)
    parts.box("body", paint, (wide, long_, tall - 0.30), 0.16, 4, z=0.30)
    parts.box("skirt", skirt, (wide + 0.02, long_ - 0.2, 0.42), 0.05, 2, z=0.26)
    for k in range(7):
        parts.box("pane", glass, (wide + 0.03, 1.32, 1.05), 0.05, 2, y=-4.35 + 1.42 * k, z=1.42)
    parts.box("screen", glass, (wide - 0.22, 0.3, 1.40), 0.10, 3, y=-0.5 * long_ + 0.12, z=1.0)
    parts.box("blind", dark, (1.7, 0.1, 0.30), 0.02, 1, y=-0.5 * long_ - 0.0, z=2.52)
    shine = emission(f"{name}_line", (1.0, 0.55, 0.10), 2.5)
    shine.cycles.emission_sampling = "NONE"
    word = mesh.rotate(lettering(f"{name}_line", line, 0.2, bold_m=0.006), "X", 90.0)
    parts.add(word, shine, y=-0.5 * long_ - 0.056, z=2.67)
    lamp = principled(f"{name}_lamp", (0.75, 0.75, 0.70), roughness=0.2)
    for x in (-0.9, 0.9):
        parts.box("eye", lamp, (0.34, 0.08, 0.16), 0.04, 2, x=x, y=-0.5 * long_, z=0.72)
        for y in (-2.9, 2.9):
            wheel = mesh.rotate(
                mesh.move(mesh.cylinder(f"{name}_wheel", 0.47, 0.30, 28, 0.05), z=-0.15), "Y", 90
            )
            parts.add(wheel, tyre, x=x * 1.24, y=y, z=0.47)
            hub = mesh.rotate(
                mesh.move(mesh.cylinder(f"{name}_hub", 0.22, 0.33, 16, 0.03), z=-0.165), "Y", 90
            )
            parts.add(hub, street.steel(f"{name}_hub"), x=x * 1.24, y=y, z=0.47)
    return parts.join()
