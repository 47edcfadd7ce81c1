"""A terminal's kerbside front: a hall of glass without panes, lit from inside, with desks and boards.

The facade stands on y = 0 and faces -Y; the hall lies behind it. Panes are left out: mullions, frosted bands
and the lit hall say glass. Scenery only. Metres.
"""

from __future__ import annotations

import random

import bpy

from l4d_blender.scene.catalogue import kind

from . import mesh
from .lettering import lettering
from .materials import products, street
from .materials.base import Nodes, emission, principled
from .parts import Parts, placed

BAY_M = 1.6
GLASS_M = 3.9  # height of the glazing
FASCIA_M = 1.5
HALL_M = 8.5  # depth


@kind("terminal", (38.9, 8.84, 5.4), "backdrop")
def terminal(name: str, rng: random.Random, *, length_m: float = 38.4) -> list[bpy.types.Object]:
    """Facade, hall and fascia, centred on x = 0."""
    return [
        _frame(f"{name}_frame", length_m),
        _fascia(f"{name}_fascia", length_m),
        _hall(f"{name}_hall", rng, length_m),
        *_desks(f"{name}_desks", rng, length_m),
    ]


def _frame(name: str, length_m: float) -> bpy.types.Object:
    steel = street.street_metal(f"{name}_steel", (0.16, 0.17, 0.18))
    frost = principled(f"{name}_frost", (0.55, 0.60, 0.62), roughness=0.6)
    parts = Parts(name)
    count = round(length_m / BAY_M)
    for k in range(count + 1):
        parts.box("post", steel, (0.07, 0.16, GLASS_M), 0.012, 1, x=-0.5 * length_m + k * BAY_M)
    for z, tall in ((0.0, 0.16), (2.45, 0.09), (GLASS_M - 0.1, 0.12)):
        parts.box("rail", steel, (length_m, 0.12, tall), 0.01, 1, z=z)
    for k in range(count):
        x = -0.5 * length_m + (k + 0.5) * BAY_M
        for z, tall in ((1.05, 0.028), (1.12, 0.028), (1.19, 0.028)):
            parts.box("band", frost, (BAY_M - 0.10, 0.004, tall), x=x, z=z)
    return parts.join()


def _fascia(name: str, length_m: float) -> bpy.types.Object:
    """Panels over the glazing, with the word that travellers look for."""
    panel = principled(
        f"{name}_panel", (0.30, 0.33, 0.36), roughness=0.45, metallic=0.3, variation=0.15, variation_scale=1.2
    )
    shine = emission(f"{name}_word", (1.0, 0.90, 0.66), 3.0)
    shine.cycles.emission_sampling = "NONE"
    parts = Parts(name)
    for k in range(round(length_m / (2 * BAY_M))):
        x = -0.5 * length_m + (2 * k + 1) * BAY_M
        parts.box("sheet", panel, (2 * BAY_M - 0.02, 0.35, FASCIA_M), 0.02, 2, x=x, y=-0.05, z=GLASS_M)
    for x in (-7.5, 0.6, 8.6):
        word = mesh.rotate(lettering(f"{name}_word", "DEPARTURES", 0.42, bold_m=0.012), "X", 90.0)
        parts.add(word, shine, x=x, y=-0.24, z=GLASS_M + 0.62)
    return parts.join()


def _hall(name: str, rng: random.Random, length_m: float) -> bpy.types.Object:
    floor = street.paving(
        f"{name}_floor", ((0.30, 0.29, 0.275), (0.25, 0.245, 0.235)), slab_m=(1.2, 1.2), stain=0.2
    )
    wall = products.wood(f"{name}_wall", (0.42, 0.25, 0.12), (0.22, 0.115, 0.05), rng, grain_axis="Z")
    white = principled(
        f"{name}_white", (0.62, 0.61, 0.58), roughness=0.7, variation=0.12, variation_scale=1.0
    )
    strip = emission(f"{name}_strip", (1.0, 0.93, 0.80), 5.0)
    strip.cycles.emission_sampling = "NONE"
    parts = Parts(name)
    parts.box("floor", floor, (length_m, HALL_M, 0.02), y=0.5 * HALL_M)
    parts.box("wall", wall, (length_m, 0.2, 4.0), y=HALL_M)
    parts.box("ceiling", white, (length_m, HALL_M, 0.1), y=0.5 * HALL_M, z=GLASS_M)
    for side in (-0.5, 0.5):
        parts.box("end", white, (0.2, HALL_M, 4.0), x=side * length_m, y=0.5 * HALL_M)
    for k in range(9):
        parts.cylinder("column", white, 0.24, GLASS_M, 24, x=-19.0 + 4.8 * k, y=2.7)
    for y in (1.4, 4.1, 6.6):
        parts.box("lamp", strip, (length_m - 1.0, 0.16, 0.03), y=y, z=GLASS_M - 0.04)
    return parts.join()


def _desks(name: str, rng: random.Random, length_m: float) -> list[bpy.types.Object]:
    """Check-in desks with glowing numbers and, over them, the boards of flights."""
    front = products.lacquer(f"{name}_front", (0.03, 0.11, 0.30), rng)
    top = products.satin_plastic(f"{name}_top", (0.55, 0.53, 0.50), rng)
    board = _flight_board(f"{name}_board")
    parts, boards = [], []
    count = int(length_m / 3.2)
    for k in range(count):
        x = -0.5 * length_m + 3.2 * (k + 0.5)
        desk = mesh.bevel_box(f"{name}_desk", (1.7, 0.6, 1.08), 0.03, 2)
        parts.append(placed(desk, front, x=x, y=5.6))
        slab = mesh.bevel_box(f"{name}_slab", (1.85, 0.74, 0.05), 0.012, 1)
        parts.append(placed(slab, top, x=x, y=5.6, z=1.08))
        screen = mesh.move(mesh.bevel_box(f"{name}_screen", (1.5, 0.08, 0.46), 0.02, 1), x, 5.9, 2.25)
        boards.append(mesh.set_material(screen, board))
    return [mesh.join(name, parts), mesh.join(f"{name}_boards", boards)]


def _flight_board(name: str) -> bpy.types.Material:
    """Rows of bright dashes on black, too far to read."""
    material = bpy.data.materials.new(name)
    material.cycles.emission_sampling = "NONE"
    n = Nodes(material)
    x, _, z = n.separate(n.world_position())
    rows = n.math("GREATER_THAN", n.math("FRACT", n.math("MULTIPLY", z, 11.0)), 0.45)
    dashes = n.noise(14.0, 1.0, vector=n.combine(x, n.math("FLOOR", n.math("MULTIPLY", z, 11.0)), 0.0))
    lit = n.math("MULTIPLY", rows, n.math("GREATER_THAN", dashes, 0.5))
    n.set("Base Color", (0.01, 0.01, 0.012))
    n.set("Emission Color", (1.0, 0.75, 0.25))
    n.set("Emission Strength", n.math("MULTIPLY", lit, 1.6))
    return material
