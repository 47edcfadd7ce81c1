"""A thick writing pen without its cap: round barrel, ring, grip section, nib.

Owns the pen's shape. Knows nothing of paper or fingers. It lies along X with its nib to -X, touching z = 0;
it is round, so that it rolls about the line at height `RADIUS_M`.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from math import pi

import bpy
from mathutils import Matrix

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.scene.catalogue import Choice, colours, kind
from l4d_blender.scene.colour import Colour

LENGTH_M = 0.146
RADIUS_M = 0.0080
TIP_X_M = -0.5 * LENGTH_M


@dataclass(frozen=True)
class Look:
    """Colours of barrel and bands, metal of ring and nib, and how many bands run round the barrel."""

    barrel: Colour = (0.035, 0.06, 0.16)
    band: Colour = (0.70, 0.68, 0.62)
    metal: Colour = (0.62, 0.62, 0.64)
    bands: int = 0


@kind(
    "pen",
    (0.146, 0.016, 0.016),
    "graspable",
    "rolls",
    "writes",
    colour=colours("look.barrel"),
    pattern=Choice("look.bands", {"plain": 0, "banded": 3}),
)
def marker_pen(name: str, rng: random.Random, *, look: Look = Look()) -> bpy.types.Object:
    """A pen 15 cm long and 16 mm thick."""
    r, length = RADIUS_M, LENGTH_M
    body = mesh.lathe(
        f"{name}_body",
        [
            (0.0012, 0.0),
            (0.0016, 0.0035),
            (0.0030, 0.0055),
            (0.0040, 0.0120),
            (0.0048, 0.0125),
            (0.0060, 0.0200),
            (0.0066, 0.0380),
            (0.0069, 0.0385),
            (0.0078, 0.0395),
            (0.0078, 0.0440),
            (r, 0.0450),
            (r, 0.0620),
            (r, 0.0680),
            (r, 0.0740),
            (r, 0.0800),
            (r, 0.0860),
            (r, 0.1180),
            (r, 0.1240),
            (r, 0.1300),
            (r, 0.1360),
            (r - 0.0006, 0.1400),
            (r - 0.0030, 0.1440),
            (0.0030, length - 0.0004),
            (0.0, length),
        ],
        32,
    )
    mesh.shade_smooth(body, 32.0)
    barrel = products.satin_plastic(f"{name}_barrel", look.barrel, rng, roughness=0.22)
    grip = products.rubber(f"{name}_grip", (0.018, 0.018, 0.020), rng)
    steel = products.metal(f"{name}_metal", look.metal, rng, roughness=0.22)
    band = products.satin_plastic(f"{name}_band", look.band, rng, roughness=0.25)
    felt = products.book_cloth(f"{name}_felt", (0.012, 0.014, 0.03), rng)
    stripes = ((0.062, 0.068), (0.074, 0.080), (0.118, 0.124))[: look.bands]

    def choose(at, _normal) -> int:
        if at.z < 0.0045:
            return 4
        if at.z < 0.0125 or 0.0386 < at.z < 0.0448:
            return 2
        if at.z < 0.0386:
            return 1
        return 3 if any(low < at.z < high for low, high in stripes) else 0

    mesh.paint(body, [barrel, grip, steel, band, felt], choose)
    wear = mesh.bevel_box(f"{name}_print", (0.0032, 0.0002, 0.020), 0.0001, segments=1)
    mesh.set_material(mesh.move(wear, y=-r, z=0.090), band)
    pen = mesh.join(name, [body, wear])
    lie = Matrix.Translation((-0.5 * length, 0.0, r)) @ Matrix.Rotation(0.5 * pi, 4, "Y")
    return mesh.transform(pen, lie)
