"""What stands on pavements: bollards, sign posts, litter bins, lamp posts, planters; and kerbs.

Everything stands on z = 0 and faces -Y. Metres.
"""

from __future__ import annotations

import random
from math import cos, pi, sin

import bpy

from l4d_blender.scene.catalogue import colours, kind

from ..scene.colour import Colour
from . import mesh, tree
from .lettering import lettering
from .materials import street
from .materials.base import emission, principled
from .parts import Parts


@kind("bollard", (0.17, 0.17, 0.92))
def bollard(name: str, rng: random.Random, *, height_m: float = 0.92) -> bpy.types.Object:
    """A steel post with a domed cap and a white band."""
    steel = street.street_metal(f"{name}_steel", (0.05, 0.055, 0.06))
    band = principled(f"{name}_band", (0.62, 0.61, 0.58), roughness=0.5, variation=0.2)
    parts = Parts(name)
    parts.cylinder("post", steel, 0.055, height_m, 24, 0.03)
    parts.cylinder("ring", band, 0.0565, 0.07, 24, z=height_m - 0.22)
    parts.cylinder("foot", steel, 0.085, 0.03, 24, 0.01)
    return parts.join()


@kind("sign", (0.585, 0.16, 2.75), front="-y", colour=colours("face"))
def sign_post(
    name: str,
    rng: random.Random,
    *,
    text: str = "STOP",
    face: Colour = (0.02, 0.1, 0.36),
    height_m: float = 2.75,
    timetable: bool = False,
) -> bpy.types.Object:
    """A pole with a flag towards +X that bears a word or two; a timetable case below if wanted."""
    steel = street.steel(f"{name}_pole")
    plate_paint = principled(f"{name}_plate", face, roughness=0.4, variation=0.15, variation_scale=9.0)
    white = principled(f"{name}_white", (0.80, 0.80, 0.78), roughness=0.5)
    parts = Parts(name)
    parts.cylinder("pole", steel, 0.034, height_m, 18, 0.01)
    wide = max(0.46, 0.115 * len(text))
    aside = 0.5 * wide + 0.045
    parts.box("plate", plate_paint, (wide, 0.028, 0.44), 0.012, x=aside, z=height_m - 0.50)
    for turn, y in ((0.0, -0.0155), (180.0, 0.0155)):
        word = mesh.rotate(lettering(f"{name}_word", text, 0.125, bold_m=0.002), "X", 90.0)
        mesh.move(mesh.rotate(word, "Z", turn), aside, y, height_m - 0.28)
        parts.add(word, white)
    for z in (height_m - 0.12, height_m - 0.44):
        parts.box("clamp", steel, (0.08, 0.05, 0.03), 0.006, 1, x=0.03, z=z)
    if timetable:
        parts.box("case", steel, (0.34, 0.05, 0.52), 0.012, y=-0.055, z=1.16)
        sheet = principled(
            f"{name}_sheet", (0.62, 0.62, 0.58), roughness=0.4, variation=0.5, variation_scale=38.0
        )
        parts.box("paper", sheet, (0.29, 0.006, 0.46), 0.001, 1, y=-0.081, z=1.19)
    parts.cylinder("foot", steel, 0.08, 0.025, 20, 0.008)
    return parts.join()


@kind("bin", (0.44, 0.44, 0.985), "container", colour=colours("colour"))
def litter_bin(name: str, rng: random.Random, *, colour: Colour = (0.045, 0.085, 0.06)) -> bpy.types.Object:
    """A round slatted bin with a hood."""
    metal = street.street_metal(f"{name}_metal", colour)
    dark = street.street_metal(f"{name}_dark", (0.012, 0.012, 0.013))
    parts = Parts(name)
    parts.cylinder("liner", dark, 0.185, 0.70, 28)
    for k in range(22):
        a = 2 * pi * k / 22
        slat = mesh.move(mesh.bevel_box(f"{name}_slat", (0.012, 0.040, 0.66), 0.004, 1), 0.20, 0.0, 0.04)
        parts.add(slat, metal, turn=("Z", a * 180 / pi))
    for z in (0.05, 0.36, 0.68):
        parts.torus("hoop", metal, 0.205, 0.012, 32, 8, z=z)
    parts.lathe(
        "hood", metal, [(0.22, 0.86), (0.215, 0.90), (0.15, 0.965), (0.0, 0.985)], 32, close_bottom=True
    )
    for k in range(3):
        a = 2 * pi * k / 3 + 0.5
        parts.cylinder("post", metal, 0.012, 0.22, 8, x=0.19 * cos(a), y=0.19 * sin(a), z=0.67)
    return parts.join()


@kind("lamp_post", (0.24, 1.48, 5.24))
def lamp_post(name: str, rng: random.Random, *, height_m: float = 5.2, glow: float = 6.0) -> bpy.types.Object:
    """A tapered mast with a flat lantern on an arm towards -Y."""
    metal = street.street_metal(f"{name}_metal", (0.07, 0.075, 0.08))
    shine = emission(f"{name}_lens", (1.0, 0.80, 0.52), glow)
    shine.cycles.emission_sampling = "NONE"
    parts = Parts(name)
    parts.tube(
        "mast",
        metal,
        [
            (0, 0, 0),
            (0, 0, 0.8),
            (0, 0, 0.82),
            (0, 0, height_m - 0.3),
            (0, -0.25, height_m),
            (0, -0.9, height_m),
        ],
        [0.085, 0.080, 0.058, 0.045, 0.042, 0.035],
        segments=14,
    )
    parts.box("lantern", metal, (0.24, 0.60, 0.09), 0.03, y=-1.1, z=height_m - 0.05)
    parts.box("lens", shine, (0.18, 0.46, 0.02), 0.008, 1, y=-1.1, z=height_m - 0.064)
    return parts.join()


@kind("planter", (0.879, 0.891, 1.08))
def planter(name: str, rng: random.Random) -> bpy.types.Object:
    """A concrete tub with a clipped bush."""
    tub = mesh.lathe(
        f"{name}_tub", [(0.30, 0.0), (0.40, 0.50), (0.42, 0.52), (0.36, 0.52), (0.34, 0.44), (0.0, 0.44)], 32
    )
    green = tree.bush(f"{name}_bush", rng, size_xyz=(0.8, 0.75, 0.75), sprays=420, leaf_m=(0.04, 0.08))
    mesh.move(green, z=0.40)
    return mesh.join(name, [mesh.set_material(tub, street.stone(f"{name}_concrete")), green])


@kind("kerb", (4.49, 0.16, 0.231), "backdrop")
def kerb(
    name: str, rng: random.Random, *, length_m: float = 4.0, height_m: float = 0.13, width_m: float = 0.16
) -> bpy.types.Object:
    """Kerb stones along X round the origin, 0.9 m each; the top is at z = 0, the road at -height."""
    granite = street.stone(f"{name}_granite")
    parts, x = [], -0.5 * length_m
    while x < 0.5 * length_m:
        size = (0.9 - rng.uniform(0.006, 0.014), width_m, height_m + 0.1)
        block = mesh.bevel_box(f"{name}_stone", size, 0.018, 2)
        mesh.move(block, x + 0.45, 0.0, -height_m - 0.1 + rng.uniform(0.0, 0.003))
        parts.append(block)
        x += 0.9
    return mesh.set_material(mesh.join(name, parts), granite)
