"""Sideboards, chests of drawers and wardrobes: a carcass on legs or a plinth, with doors or drawers."""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior, products
from l4d_blender.catalogue import Range, colours, kind, words

Colour = tuple[float, float, float]


@kind(
    "cabinet",
    (1.23, 0.471, 0.8),
    "surface",
    front="-y",
    colour=colours("paint"),
    fronts=words("fronts", "doors", "drawers"),
    width_m=Range("width_m", 0.4, 2.2),
    height_m=Range("height_m", 0.4, 2.2),
)
def cabinet(
    name: str,
    rng: random.Random,
    *,
    width_m: float = 1.2,
    depth_m: float = 0.42,
    height_m: float = 0.8,
    paint: Colour | None = None,
    timber: Colour = (0.30, 0.17, 0.08),
    fronts: str = "doors",
    legs_m: float = 0.12,
) -> bpy.types.Object:
    """Its back is at +Y and its middle at the origin; painted fronts, or all of wood without `paint`."""
    wood = interior.wood(f"{name}_wood", timber, rng, grain_axis="X")
    front = products.lacquer(f"{name}_paint", paint, rng) if paint else wood
    metal = products.metal(f"{name}_knobs", (0.40, 0.33, 0.20), rng)
    body = mesh.bevel_box(f"{name}_body", (width_m, depth_m, height_m - legs_m - 0.025), 0.004, 1)
    top = mesh.bevel_box(f"{name}_top", (width_m + 0.03, depth_m + 0.02, 0.025), 0.006, 1)
    parts = [
        mesh.set_material(mesh.move(body, z=legs_m), front),
        mesh.set_material(mesh.move(top, z=height_m - 0.025), wood),
    ]
    for x in (-1, 1):
        for y in (-1, 1):
            leg = mesh.cylinder(f"{name}_leg", 0.016, legs_m + 0.01, 10, top_radius=0.024)
            mesh.move(leg, x=x * (width_m / 2 - 0.07), y=y * (depth_m / 2 - 0.06))
            parts.append(mesh.set_material(leg, wood))
    columns = max(1, round(width_m / 0.5))
    rows = 1 if fronts == "doors" else max(2, round((height_m - legs_m) / 0.22))
    wide, tall = width_m / columns, (height_m - legs_m - 0.03) / rows
    for i in range(columns):
        for j in range(rows):
            x, z = (i + 0.5) * wide - width_m / 2, legs_m + j * tall
            panel = mesh.bevel_box(f"{name}_front", (wide - 0.014, 0.018, tall - 0.014), 0.004, 1)
            parts.append(mesh.set_material(mesh.move(panel, x, -depth_m / 2 - 0.008, z + 0.007), front))
            knob_x = x if fronts == "drawers" else x + (0.5 - i % 2) * 2 * (wide / 2 - 0.06)
            knob = mesh.ellipsoid(
                f"{name}_knob",
                (0.014, 0.014, 0.014),
                10,
                6,
                (knob_x, -depth_m / 2 - 0.028, z + (0.5 if fronts == "drawers" else 0.6) * tall),
            )
            parts.append(mesh.set_material(knob, metal))
    return mesh.join(name, parts)
