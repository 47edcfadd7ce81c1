"""Storage: cabinets and wardrobes with doors or drawers, open shelves with what is kept on them, chests."""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior, products
from l4d_blender.assets.parts import CORNERS, Parts
from l4d_blender.scene.catalogue import Range, colours, kind, words
from l4d_blender.scene.colour import Colour


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
    parts = Parts(name)
    parts.box("body", front, (width_m, depth_m, height_m - legs_m - 0.025), 0.004, 1, z=legs_m)
    parts.box("top", wood, (width_m + 0.03, depth_m + 0.02, 0.025), 0.006, 1, z=height_m - 0.025)
    for x, y in CORNERS:
        leg = mesh.cylinder(f"{name}_leg", 0.016, legs_m + 0.01, 10, top_radius=0.024)
        parts.add(leg, wood, x=x * (width_m / 2 - 0.07), y=y * (depth_m / 2 - 0.06))
    columns = max(1, round(width_m / 0.5))
    rows = 1 if fronts == "doors" else max(2, round((height_m - legs_m) / 0.22))
    wide, tall = width_m / columns, (height_m - legs_m - 0.03) / rows
    for i in range(columns):
        for j in range(rows):
            x, z = (i + 0.5) * wide - width_m / 2, legs_m + j * tall
            panel = mesh.bevel_box(f"{name}_front", (wide - 0.014, 0.018, tall - 0.014), 0.004, 1)
            parts.add(panel, front, x=x, y=-depth_m / 2 - 0.008, z=z + 0.007)
            knob_x = x if fronts == "drawers" else x + (0.5 - i % 2) * 2 * (wide / 2 - 0.06)
            parts.ellipsoid(
                "knob",
                metal,
                (0.014, 0.014, 0.014),
                10,
                6,
                (knob_x, -depth_m / 2 - 0.028, z + (0.5 if fronts == "drawers" else 0.6) * tall),
            )
    return parts.join()


@kind(
    "shelf",
    (1.0, 0.38, 1.79),
    "surface",
    front="-y",
    width_m=Range("width_m", 0.5, 2.0),
    height_m=Range("height_m", 0.6, 2.1),
    content=words("content", "empty", "boxes", "jars", "toys", "linen"),
)
def open_shelf(
    name: str,
    rng: random.Random,
    *,
    width_m: float = 1.0,
    depth_m: float = 0.38,
    height_m: float = 1.6,
    boards: int = 4,
    timber: Colour = (0.46, 0.32, 0.19),
    content: str = "boxes",
) -> bpy.types.Object:
    """Boards between two frames, with things of one sort on them; its back is at +Y."""
    wood = interior.wood(f"{name}_wood", timber, rng, grain_axis="X")
    parts = Parts(name)
    for x, y in CORNERS:
        post = mesh.bevel_box(f"{name}_post", (0.035, 0.035, height_m), 0.003, 1)
        parts.add(post, wood, x=x * (width_m / 2 - 0.018), y=y * (depth_m / 2 - 0.018))
    gap = (height_m - 0.14) / (boards - 1)
    for k in range(boards):
        z = 0.10 + k * gap
        parts.box("board", wood, (width_m - 0.01, depth_m - 0.01, 0.022), 0.003, 1, z=z)
        if content != "empty":
            top = gap - 0.05 if k < boards - 1 else 0.28
            parts += _kept(f"{name}_{k}", rng, content, width_m - 0.10, depth_m - 0.08, z + 0.022, top)
    return parts.join()


_TONES: dict[str, tuple[Colour, ...]] = {
    "boxes": ((0.36, 0.24, 0.13), (0.42, 0.30, 0.18), (0.25, 0.28, 0.30), (0.50, 0.46, 0.38)),
    "jars": (
        (0.45, 0.12, 0.04),
        (0.50, 0.36, 0.08),
        (0.12, 0.18, 0.05),
        (0.30, 0.16, 0.08),
        (0.6, 0.55, 0.45),
    ),
    "toys": (
        (0.48, 0.05, 0.04),
        (0.70, 0.43, 0.03),
        (0.04, 0.14, 0.40),
        (0.07, 0.28, 0.10),
        (0.55, 0.25, 0.3),
    ),
    "linen": ((0.62, 0.60, 0.55), (0.45, 0.52, 0.56), (0.56, 0.44, 0.36), (0.36, 0.42, 0.34)),
}


def _kept(
    name: str, rng: random.Random, content: str, width: float, depth: float, z: float, room: float
) -> list[bpy.types.Object]:
    """One board's row of things, with gaps as people leave them."""
    paints = [products.paper(f"{name}_{k}", tone, rng) for k, tone in enumerate(_TONES[content])]
    made: list[bpy.types.Object] = []
    x = -width / 2
    while True:
        wide = {"boxes": (0.18, 0.34), "jars": (0.08, 0.12), "toys": (0.08, 0.22), "linen": (0.26, 0.34)}[
            content
        ]
        step = rng.uniform(*wide)
        if x + step > width / 2:
            return made
        tall = min(room, rng.uniform(0.4, 0.95) * room if content != "jars" else rng.uniform(0.10, 0.18))
        paint = rng.choice(paints)
        if rng.random() < 0.85 and tall > 0.03:
            if content == "jars" or (content == "toys" and rng.random() < 0.4):
                thing = mesh.cylinder(f"{name}_jar", 0.43 * step, tall, 14, 0.008)
                made.append(
                    mesh.set_material(mesh.move(thing, x + step / 2, rng.uniform(-0.04, 0.02), z), paint)
                )
            elif content == "linen":
                for layer in range(max(1, int(tall / 0.05))):
                    fold = mesh.bevel_box(f"{name}_fold", (step - 0.03, depth - 0.06, 0.045), 0.015, 2)
                    mesh.move(fold, x + step / 2 + rng.uniform(-0.006, 0.006), 0.0, z + 0.046 * layer)
                    made.append(mesh.set_material(fold, rng.choice(paints)))
            else:
                box = mesh.bevel_box(
                    f"{name}_box", (step - 0.02, depth * rng.uniform(0.7, 0.95), tall), 0.004, 1
                )
                mesh.rotate(box, "Z", rng.uniform(-3, 3))
                made.append(mesh.set_material(mesh.move(box, x + step / 2, 0.0, z), paint))
        x += step + rng.uniform(0.0, 0.05)


@kind("chest", (0.9, 0.46, 0.5), "container", "surface", front="-y", colour=colours("paint"))
def chest(
    name: str,
    rng: random.Random,
    *,
    size_m: tuple[float, float, float] = (0.9, 0.45, 0.5),
    paint: Colour | None = None,
    bands: bool = True,
) -> bpy.types.Object:
    """A blanket chest with a lid and, if wanted, iron bands; its back is at +Y."""
    width, depth, height = size_m
    wood = products.wood(f"{name}_wood", (0.32, 0.18, 0.08), (0.16, 0.08, 0.035), rng, grain_axis="X")
    front = products.lacquer(f"{name}_paint", paint, rng) if paint else wood
    iron = products.metal(f"{name}_iron", (0.12, 0.12, 0.12), rng, roughness=0.5)
    parts = Parts(name)
    parts.box("body", front, (width - 0.04, depth - 0.03, height - 0.10), 0.006, 1, z=0.04)
    parts.box("lid", front, (width, depth, 0.07), 0.025, 3, z=height - 0.07)
    parts.box("foot", wood, (width, depth - 0.01, 0.06), 0.006, 1)
    if bands:
        for x in (-0.3 * width, 0.3 * width):
            parts.box("band", iron, (0.045, depth + 0.01, height - 0.05), 0.01, 2, x=x, z=0.055)
        parts.box("lock", iron, (0.08, 0.02, 0.10), 0.004, 1, y=-depth / 2, z=height - 0.16)
    return parts.join()
