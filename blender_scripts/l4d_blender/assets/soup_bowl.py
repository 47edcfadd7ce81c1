"""Bowls and deep plates with soup or sauce in them, and a flat plate to stand on.

Owns the shapes and says where the inner floor is. They stand on z = 0.
"""

from __future__ import annotations

import random
from dataclasses import dataclass

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products, tableware
from l4d_blender.scene import keys
from l4d_blender.scene.catalogue import colours, kind
from l4d_blender.scene.colour import Colour

PLATE_M = 0.0065  # what stands on a plate stands this high


@dataclass(frozen=True)
class Look:
    """A vessel by its rim (radius, height in metres), foot radius and level (share of the height)."""

    rim_m: tuple[float, float] = (0.120, 0.105)
    foot_m: float = 0.058
    level: float = 0.70
    glaze: Colour = (0.24, 0.27, 0.25)
    band: Colour = (0.60, 0.56, 0.47)
    soup: Colour = (0.58, 0.22, 0.035)
    brim_m: float = 0.0  # width of a flat brim, as deep plates have

    @property
    def inner_m(self) -> tuple[float, float]:
        """Inner radius at the rim (inside the brim) and height over the inner floor."""
        return self.rim_m[0] - self.brim_m - 0.005, self.rim_m[1] - FLOOR_M


FLOOR_M = 0.010


@kind("bowl", (0.24, 0.24, 0.105), "container", "graspable", colour=colours("look.glaze"))
def soup_bowl(name: str, rng: random.Random, *, look: Look = Look()) -> bpy.types.Object:
    """A round vessel with something thick in it."""
    r, h = look.rim_m
    well = r - look.brim_m
    drop = 0.006 if look.brim_m else 0.0
    outer = [
        (look.foot_m, 0.0),
        (look.foot_m + 0.003, 0.004),
        (0.62 * well + 0.3 * look.foot_m, 0.22 * h),
        (0.93 * well, 0.60 * h),
    ]
    outer += [(well, h - drop), (r, h)] if look.brim_m else [(r, h)]
    inner = [(well - 0.005, h - drop + 0.002)] if look.brim_m else []
    inner += [
        (0.93 * well - 0.0055, 0.60 * h + 0.002),
        (0.55 * well, 0.24 * h + 0.004),
        (0.6 * look.foot_m, FLOOR_M),
        (0.0, FLOOR_M),
    ]
    up, down = (
        keys.Path([(a, 0.0, z) for a, z in part]) for part in (outer, [(r - 0.004, h + 0.0005), *inner])
    )
    wall = [up.point(up.length * k / 40) for k in range(41)] + [
        down.point(down.length * k / 40) for k in range(41)
    ]
    body = mesh.lathe(f"{name}_body", [(max(p.x, 0.0) if p.x > 1e-4 else 0.0, p.z) for p in wall], 64)
    skins = [
        products.glaze(f"{name}_glaze", look.glaze, rng, speckle=0.3),
        products.glaze(f"{name}_band", look.band, rng),
    ]
    mesh.paint(body, skins, lambda centre, _: int(centre.z > 0.90 * h))
    z = look.level * h
    wide = max(p.x for p in wall[41:] if p.z <= z) + 0.0015
    soup = mesh.lathe(f"{name}_soup", [(0.0, z), (0.5 * wide, z), (0.9 * wide, z), (wide, z + 0.0006)], 48)
    mesh.set_material(soup, tableware.soup(f"{name}_surface", look.soup, rng))
    return mesh.join(name, [body, soup])


@kind("plate", (0.2, 0.2, 0.019), "surface", "pushable", "graspable")
def plate(
    name: str,
    rng: random.Random,
    *,
    radius_m: float = 0.1,
    glaze: Colour = (0.62, 0.59, 0.52),
    rim: Colour = (0.2, 0.24, 0.22),
) -> bpy.types.Object:
    """A flat plate with a painted rim; its well is at `PLATE_M`."""
    r = radius_m
    body = mesh.lathe(
        name,
        [
            (0.55 * r, 0.0),
            (0.59 * r, 0.002),
            (0.72 * r, 0.006),
            (0.97 * r, 0.0155),
            (r, 0.0180),
            (0.985 * r, 0.0190),
            (0.93 * r, 0.0170),
            (0.71 * r, 0.0095),
            (0.58 * r, PLATE_M),
            (0.0, PLATE_M),
        ],
        64,
    )
    skins = [products.glaze(f"{name}_glaze", glaze, rng), products.glaze(f"{name}_rim", rim, rng)]
    return mesh.paint(
        body, skins, lambda centre, normal: int(centre.xy.length > 0.925 * r and normal.z > 0.0)
    )
