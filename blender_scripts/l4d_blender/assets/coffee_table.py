"""A low table on four open legs, and what lies about on it: mug, bowl of fruit, books, candle."""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior
from l4d_blender.assets.materials.base import principled
from l4d_blender.assets.parts import CORNERS, Parts
from l4d_blender.scene.catalogue import colours, kind

HEIGHT_M = 0.42


@kind("table", (0.95, 0.52, 0.422), "surface")
def coffee_table(
    name: str,
    rng: random.Random,
    *,
    size_m: tuple[float, float] = (0.95, 0.52),
    colour: tuple[float, float, float] = (0.36, 0.19, 0.085),
) -> bpy.types.Object:
    """Long side along X; the underside of the apron is 0.34 m up, so that things show underneath."""
    top_wood = interior.wood(f"{name}_top", colour, rng, grain_axis="X", gloss=0.3)
    leg_wood = interior.wood(f"{name}_legs", colour, rng, grain_axis="Z", gloss=0.35)
    width, depth = size_m
    parts = Parts(name)
    parts.box("board", top_wood, (width, depth, 0.032), 0.010, z=HEIGHT_M - 0.032)
    for side in (-1, 1):
        for size, x, y in (
            ((width - 0.16, 0.018, 0.045), 0, side * (depth / 2 - 0.055)),
            ((0.018, depth - 0.14, 0.045), side * (width / 2 - 0.055), 0),
        ):
            parts.box("apron", top_wood, size, 0.003, x=x, y=y, z=HEIGHT_M - 0.077)
    for x, y in CORNERS:
        leg = mesh.cylinder(f"{name}_leg", 0.013, HEIGHT_M - 0.03, 20, top_radius=0.024)
        leg = mesh.rotate(mesh.rotate(leg, "Y", -5 * x), "X", 5 * y)
        parts.add(leg, leg_wood, x=x * (width / 2 - 0.035), y=y * (depth / 2 - 0.035))
    return parts.join()


@kind("mug", (0.121, 0.082, 0.092), "graspable", "container", colour=colours("colour"))
def mug(
    name: str, rng: random.Random, *, colour: tuple[float, float, float] = (0.62, 0.24, 0.12)
) -> bpy.types.Object:
    """A mug of 9 cm with its handle at +X."""
    body = mesh.lathe(
        f"{name}_body",
        [
            (0.0, 0.0),
            (0.036, 0.0),
            (0.040, 0.006),
            (0.041, 0.088),
            (0.040, 0.092),
            (0.037, 0.088),
            (0.036, 0.070),
            (0.0, 0.070),
        ],
        32,
        close_bottom=False,
    )
    ring = mesh.move(
        mesh.rotate(mesh.torus(f"{name}_handle", 0.026, 0.0055, 24, 10), "X", 90), x=0.048, z=0.048
    )
    return mesh.set_material(mesh.join(name, [body, ring]), interior.ceramic(f"{name}_glaze", colour, rng))


@kind("bowl", (0.25, 0.25, 0.143), "container")
def fruit_bowl(name: str, rng: random.Random) -> bpy.types.Object:
    """A bowl 25 cm across with four fruits."""
    profile = [
        (0.0, 0.0),
        (0.05, 0.0),
        (0.055, 0.008),
        (0.105, 0.045),
        (0.125, 0.075),
        (0.120, 0.076),
        (0.098, 0.050),
        (0.045, 0.018),
        (0.0, 0.015),
    ]
    bowl = mesh.lathe(f"{name}_bowl", profile, 40, close_bottom=False)
    parts = Parts(name)
    parts.add(bowl, interior.ceramic(f"{name}_glaze", (0.16, 0.30, 0.34), rng))
    peels = [
        principled(
            f"{name}_{kind}", colour, roughness=0.4, variation=0.3, variation_scale=18, bump=(90, 0.001)
        )
        for kind, colour in (
            ("orange", (0.80, 0.30, 0.03)),
            ("lemon", (0.80, 0.62, 0.07)),
            ("apple", (0.34, 0.45, 0.08)),
        )
    ]
    for k, (x, y, z) in enumerate(
        ((-0.045, 0.01, 0.064), (0.042, 0.028, 0.066), (0.012, -0.048, 0.063), (0.0, 0.005, 0.108))
    ):
        radius = rng.uniform(0.036, 0.041)
        parts.ellipsoid("fruit", peels[k % 3], (radius, radius, radius * 0.93), 20, 12, centre=(x, y, z))
    return parts.join()


@kind("books", (0.266, 0.216, 0.077), "surface")
def book_stack(name: str, rng: random.Random, *, count: int = 3) -> bpy.types.Object:
    """Books that lie on each other, each a little turned."""
    paper = principled(f"{name}_paper", (0.78, 0.72, 0.60), roughness=0.9, variation=0.2, variation_scale=90)
    parts, height = Parts(name), 0.0
    for i in range(count):
        w, d, t = rng.uniform(0.19, 0.24), rng.uniform(0.14, 0.17), rng.uniform(0.018, 0.034)
        colour = rng.choice([(0.45, 0.09, 0.06), (0.07, 0.17, 0.30), (0.10, 0.26, 0.15), (0.62, 0.42, 0.12)])
        cover = principled(
            f"{name}_cover{i}", colour, roughness=0.55, variation=0.25, variation_scale=14, bump=(200, 0.0005)
        )
        boards = [
            mesh.move(mesh.bevel_box(f"{name}_board", (w, d, 0.003), 0.001), z=z) for z in (0.0, t - 0.003)
        ]
        spine = mesh.move(mesh.bevel_box(f"{name}_spine", (w, 0.004, t), 0.0015), y=d / 2 - 0.002)
        book = [mesh.set_material(part, cover) for part in (*boards, spine)]
        pages = mesh.move(mesh.box(f"{name}_pages", (w - 0.010, d - 0.010, t - 0.006)), z=0.003)
        book.append(mesh.set_material(pages, paper))
        parts.add(mesh.join(f"{name}_book{i}", book), z=height, turn=("Z", rng.uniform(-16, 16)))
        height += t + 0.0005
    return parts.join()
