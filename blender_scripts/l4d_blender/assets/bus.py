"""A city bus as it stands in the distance: body, window band, destination sign, wheels. Scenery only.

It faces -Y, 11 m long, on z = 0. Metres.
"""

from __future__ import annotations

import random

import bpy

from l4d_blender.catalogue import colours, kind

from . import mesh
from .lettering import lettering
from .materials import street
from .materials.base import emission, principled

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
    body = mesh.move(mesh.bevel_box(f"{name}_body", (wide, long_, tall - 0.30), 0.16, 4), z=0.30)
    parts = [mesh.set_material(body, paint)]
    low = mesh.move(mesh.bevel_box(f"{name}_skirt", (wide + 0.02, long_ - 0.2, 0.42), 0.05, 2), z=0.26)
    parts.append(mesh.set_material(low, skirt))
    for k in range(7):
        pane = mesh.bevel_box(f"{name}_pane", (wide + 0.03, 1.32, 1.05), 0.05, 2)
        parts.append(mesh.set_material(mesh.move(pane, 0.0, -4.35 + 1.42 * k, 1.42), glass))
    screen = mesh.bevel_box(f"{name}_screen", (wide - 0.22, 0.3, 1.40), 0.10, 3)
    parts.append(mesh.set_material(mesh.move(screen, 0.0, -0.5 * long_ + 0.12, 1.0), glass))
    blind = mesh.move(
        mesh.bevel_box(f"{name}_blind", (1.7, 0.1, 0.30), 0.02, 1), 0.0, -0.5 * long_ - 0.0, 2.52
    )
    parts.append(mesh.set_material(blind, dark))
    shine = emission(f"{name}_line", (1.0, 0.55, 0.10), 2.5)
    shine.cycles.emission_sampling = "NONE"
    word = mesh.rotate(lettering(f"{name}_line", line, 0.2, bold_m=0.006), "X", 90.0)
    parts.append(mesh.set_material(mesh.move(word, 0.0, -0.5 * long_ - 0.056, 2.67), shine))
    lamp = principled(f"{name}_lamp", (0.75, 0.75, 0.70), roughness=0.2)
    for x in (-0.9, 0.9):
        eye = mesh.move(mesh.bevel_box(f"{name}_eye", (0.34, 0.08, 0.16), 0.04, 2), x, -0.5 * long_, 0.72)
        parts.append(mesh.set_material(eye, lamp))
        for y in (-2.9, 2.9):
            wheel = mesh.rotate(
                mesh.move(mesh.cylinder(f"{name}_wheel", 0.47, 0.30, 28, 0.05), z=-0.15), "Y", 90
            )
            parts.append(mesh.set_material(mesh.move(wheel, x * 1.24, y, 0.47), tyre))
            hub = mesh.rotate(
                mesh.move(mesh.cylinder(f"{name}_hub", 0.22, 0.33, 16, 0.03), z=-0.165), "Y", 90
            )
            parts.append(mesh.set_material(mesh.move(hub, x * 1.24, y, 0.47), street.steel(f"{name}_hub")))
    return mesh.join(name, parts)
