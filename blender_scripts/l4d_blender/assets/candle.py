"""A burning candle in a turned holder.

Owns wax, flame and holder, and says where its light is. It stands on z = 0.
"""

from __future__ import annotations

import random

import bpy
from mathutils import Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products, tableware
from l4d_blender.scene.catalogue import Range, kind
from l4d_blender.scene.colour import Colour

_FOOT_M = 0.052


def flame_at(height_m: float) -> Vector:
    """The middle of the flame of a candle of this height, in its own axes (metres)."""
    return Vector((0.0, 0.0, _FOOT_M + height_m + 0.022))


@kind("candle", (0.088, 0.088, 0.217), "graspable", height_m=Range("height_m", 0.06, 0.2))
def candle(
    name: str,
    rng: random.Random,
    *,
    height_m: float = 0.12,
    wax: Colour = (0.74, 0.66, 0.5),
    brass: Colour = (0.58, 0.38, 0.14),
) -> bpy.types.Object:
    """A taper `height_m` tall above a brass holder."""
    holder = mesh.lathe(
        f"{name}_holder",
        [
            (0.042, 0.0),
            (0.044, 0.003),
            (0.040, 0.006),
            (0.018, 0.010),
            (0.010, 0.018),
            (0.014, 0.026),
            (0.009, 0.034),
            (0.016, 0.040),
            (0.020, 0.043),
            (0.018, 0.046),
            (0.0145, 0.048),
            (0.0155, 0.058),
            (0.0125, 0.058),
        ],
        40,
    )
    mesh.set_material(holder, products.metal(f"{name}_brass", brass, rng, roughness=0.28))
    top = _FOOT_M + height_m
    taper = mesh.lathe(
        f"{name}_taper",
        [
            (0.0112, _FOOT_M - 0.004),
            (0.0108, top - 0.010),
            (0.0112, top - 0.002),
            (0.0098, top),
            (0.006, top - 0.003),
            (0.0, top - 0.004),
        ],
        28,
    )
    mesh.set_material(taper, tableware.wax(f"{name}_wax", wax, rng, glow=2.0))
    drip = mesh.tube(
        f"{name}_drip",
        [(0.0105, 0.002, top - 0.002), (0.0115, 0.002, top - 0.02), (0.0112, 0.003, top - 0.045)],
        [0.0022, 0.0020, 0.0030],
        10,
    )
    mesh.set_material(drip, taper.data.materials[0])
    wick = mesh.tube(f"{name}_wick", [(0, 0, top - 0.004), (0.001, 0, top + 0.009)], 0.0010, 8)
    mesh.set_material(wick, products.paper(f"{name}_char", (0.02, 0.015, 0.012), rng))
    flame = mesh.lathe(
        f"{name}_flame",
        [
            (0.0, top + 0.006),
            (0.0040, top + 0.010),
            (0.0062, top + 0.017),
            (0.0058, top + 0.024),
            (0.0034, top + 0.034),
            (0.0, top + 0.045),
        ],
        20,
        close_bottom=False,
    )
    mesh.set_material(flame, products.glow(f"{name}_glow", (1.0, 0.62, 0.22), 14.0))
    return mesh.join(name, [holder, taper, drip, wick, flame])
