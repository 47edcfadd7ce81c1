"""A window for an opening in a wall: its bars throw shadows, its view doesn't, so that sunlight comes in.

Owns frame, view by time of day, curtains and blinds. Knows nothing of the wall: that is the plane y = 0, the
room at -Y, and the opening is `width_m` by `height_m` from `sill_m` up.
"""

from __future__ import annotations

import random
from math import pi, sin

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior
from l4d_blender.assets.materials.base import Nodes, emission, principled
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import colours, kind, words
from l4d_blender.scene.colour import Colour

SKIES: dict[str, tuple[Colour, Colour, Colour, Colour]] = {
    "day": ((0.14, 0.20, 0.07), (0.34, 0.46, 0.18), (0.72, 0.86, 1.0), (0.42, 0.64, 0.95)),
    "overcast": ((0.14, 0.17, 0.12), (0.30, 0.34, 0.28), (0.72, 0.76, 0.80), (0.60, 0.66, 0.72)),
    "dusk": ((0.015, 0.018, 0.03), (0.05, 0.05, 0.08), (0.55, 0.27, 0.16), (0.08, 0.12, 0.28)),
    "night": ((0.003, 0.004, 0.008), (0.006, 0.009, 0.018), (0.016, 0.025, 0.055), (0.008, 0.014, 0.035)),
}
"""What is outside, from below up: bushes, crowns, sky low, sky high."""


@kind(
    "window",
    (1.5, 0.25, 1.34),
    "hangs",
    front="-y",
    curtain=colours("curtain"),
    sky=words("sky", *SKIES),
    hanging=words("hanging", "bare", "curtains", "blind"),
)
def lit_window(
    name: str,
    rng: random.Random,
    *,
    width_m: float = 1.3,
    height_m: float = 1.2,
    sill_m: float = 0.9,
    columns: int = 2,
    rows: int = 2,
    sky: str = "day",
    glow: float = 1.0,
    hanging: str = "bare",
    curtain: Colour = (0.62, 0.5, 0.3),
    frame: Colour = (0.72, 0.70, 0.65),
) -> list[bpy.types.Object]:
    """[frame, view] and, unless it is bare, [curtains]."""
    paint = principled(f"{name}_paint", frame, roughness=0.42, variation=0.08)
    half, parts = width_m / 2, Parts(f"{name}_frame")

    def bar(size: tuple[float, float, float], x: float, y: float, z: float) -> None:
        parts.box("bar", paint, size, 0.004, 1, x=x, y=y, z=z)

    for side in (-1, 1):
        bar((0.06, 0.07, height_m), side * (half - 0.03), 0.03, sill_m)
        bar((0.07, 0.03, height_m + 0.14), side * (half + 0.035), -0.012, sill_m - 0.07)
    for z in (sill_m, sill_m + height_m - 0.06):
        bar((width_m, 0.07, 0.06), 0.0, 0.03, z)
    bar((width_m + 0.14, 0.03, 0.07), 0.0, -0.012, sill_m + height_m)
    bar((width_m + 0.20, 0.24, 0.035), 0.0, -0.03, sill_m - 0.035)
    for k in range(1, columns):
        bar((0.045, 0.05, height_m), width_m * (k / columns - 0.5), 0.03, sill_m)
    for k in range(1, rows):
        bar((width_m, 0.04, 0.03), 0.0, 0.03, sill_m + height_m * k / rows)
    casement = parts.join()
    made = [casement, _view(f"{name}_view", rng, half, sill_m, height_m, SKIES[sky], glow)]
    if hanging == "curtains":
        made.append(_curtains(f"{name}_curtains", rng, width_m, sill_m, height_m, curtain))
    elif hanging == "blind":
        made.append(_blind(f"{name}_blind", rng, width_m, sill_m, height_m, curtain))
    return made


def _view(
    name: str,
    rng: random.Random,
    half: float,
    sill: float,
    height: float,
    sky: tuple[Colour, Colour, Colour, Colour],
    glow: float,
) -> bpy.types.Object:
    """Bushes, trees and sky out of focus; light passes through it."""
    corners = [(-half, 0.1, sill), (half, 0.1, sill), (half, 0.1, sill + height), (-half, 0.1, sill + height)]
    view = mesh.from_pydata(name, corners, [(0, 1, 2, 3)], smooth=False)
    material = emission(name, (1.0, 1.0, 1.0), glow)
    material.cycles.emission_sampling = "NONE"  # an area light does the lighting, without noise
    n = Nodes(material)
    x, _, z = n.separate(n.object_coords())
    crowns = n.noise(rng.uniform(1.6, 3.2), 3, vector=n.combine(x, rng.uniform(0, 9), z))
    level = n.math("ADD", z, n.math("MULTIPLY", n.math("SUBTRACT", crowns, 0.5), 0.9))
    horizon = rng.uniform(1.15, 1.6)
    stops = [(0.0, sky[0]), (0.40, sky[1]), (0.50, sky[1]), (0.58, sky[2]), (1.0, sky[3])]
    n.set("Emission Color", n.ramp(n.map_range(level, horizon - 1.0, horizon + 1.0), stops))
    view.visible_shadow = False
    return mesh.set_material(view, material)


def _curtains(
    name: str, rng: random.Random, width: float, sill: float, height: float, colour: Colour
) -> bpy.types.Object:
    """A pair of pleated panels on a rod, drawn aside."""
    cloth = interior.cloth(f"{name}_cloth", colour, rng, slub_per_m=70)
    metal = principled(f"{name}_rod", (0.10, 0.08, 0.07), roughness=0.35, metallic=0.8)
    top, low = sill + height + 0.16, max(0.02, sill - rng.choice((0.25, sill)))
    parts = Parts(name)
    for side in (-1, 1):
        inner, outer = width / 2 - rng.uniform(0.05, 0.15), width / 2 + 0.22
        columns, folds, phase = 28, 4.5, rng.uniform(0, 6)
        verts, faces = [], []
        for j, z in enumerate((top, 0.5 * (top + low), low)):
            for i in range(columns + 1):
                u = i / columns
                wave = (0.018 + 0.010 * j) * sin(2 * pi * folds * u + phase + 0.2 * j)
                verts.append((side * (inner + (outer - inner) * u), -0.20 + wave, z))
        row = columns + 1
        for j in range(2):
            for i in range(columns):
                face = (j * row + i, (j + 1) * row + i, (j + 1) * row + i + 1, j * row + i + 1)
                faces.append(face if side > 0 else face[::-1])
        panel = mesh.from_pydata(f"{name}_panel", verts, faces)
        parts.add(mesh.solidify(panel, 0.006, offset=0.0), cloth)
    reach = width / 2 + 0.27
    parts.tube("rod", metal, [(-reach, -0.20, top + 0.01), (reach, -0.20, top + 0.01)], 0.012, 10)
    return parts.join()


def _blind(
    name: str, rng: random.Random, width: float, sill: float, height: float, colour: Colour
) -> bpy.types.Object:
    """A roller blind, let down a part of the way."""
    cloth = interior.cloth(f"{name}_cloth", colour, rng, slub_per_m=120)
    drop = height * rng.uniform(0.15, 0.4)
    top = sill + height + 0.05
    roll = mesh.rotate(mesh.cylinder(f"{name}_roll", 0.03, width + 0.06, 20), "Y", 90.0)
    sheet = mesh.box(f"{name}_sheet", (width + 0.04, 0.003, drop + 0.05))
    rod = mesh.bevel_box(f"{name}_rod", (width + 0.04, 0.012, 0.022), 0.004, 1)
    parts = [
        mesh.move(roll, x=-(width + 0.06) / 2, y=-0.07, z=top),
        mesh.move(sheet, y=-0.09, z=top - drop - 0.05),
        mesh.move(rod, y=-0.09, z=top - drop - 0.06),
    ]
    return mesh.join(name, [mesh.set_material(part, cloth) for part in parts])
