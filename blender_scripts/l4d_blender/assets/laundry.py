"""What a laundry has: a washing machine, a drying rack with linen, an ironing board."""

from __future__ import annotations

import random
from math import cos, pi, sin

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior, products
from l4d_blender.assets.materials.base import principled
from l4d_blender.assets.parts import CORNERS, Parts
from l4d_blender.scene.catalogue import colours, kind
from l4d_blender.scene.colour import Colour

LINEN: tuple[Colour, ...] = (
    (0.62, 0.60, 0.56),
    (0.30, 0.42, 0.52),
    (0.52, 0.26, 0.22),
    (0.50, 0.46, 0.26),
    (0.24, 0.34, 0.26),
)


@kind("washer", (0.6, 0.64, 0.86), "container", "surface", front="-y", colour=colours("paint"))
def washing_machine(name: str, rng: random.Random, *, paint: Colour = (0.66, 0.66, 0.65)) -> bpy.types.Object:
    """A front loader; its back is at +Y and its middle at the origin."""
    white = products.lacquer(f"{name}_paint", paint, rng)
    grey = products.satin_plastic(f"{name}_grey", (0.24, 0.25, 0.26), rng)
    steel = products.metal(f"{name}_steel", (0.55, 0.56, 0.57), rng, roughness=0.25)
    glass = principled(f"{name}_glass", (0.03, 0.035, 0.04), roughness=0.08)
    parts = Parts(name)
    parts.box("body", white, (0.60, 0.60, 0.84), 0.015, 2, z=0.02)
    parts.torus("ring", steel, 0.17, 0.028, 32, 10, y=-0.30, z=0.42, turn=("X", 90.0))
    parts.ellipsoid("door", glass, (0.155, 0.05, 0.155), 28, 14, y=-0.29, z=0.42)
    parts.box("panel", grey, (0.56, 0.02, 0.10), 0.004, 1, y=-0.302, z=0.73)
    knob = mesh.rotate(mesh.cylinder(f"{name}_knob", 0.03, 0.03, 20, 0.005), "X", 90.0)
    parts.add(knob, steel, x=rng.choice((0.0, 0.16)), y=-0.305, z=0.78)
    parts.box("drawer", white, (0.16, 0.02, 0.08), 0.004, 1, x=-0.19, y=-0.308, z=0.74)
    for x, y in CORNERS:
        parts.cylinder("foot", grey, 0.02, 0.025, 10, x=0.25 * x, y=0.25 * y)
    return parts.join()


@kind("drying_rack", (1.22, 0.557, 0.975), front=None)
def drying_rack(name: str, rng: random.Random, *, pieces: int = 5) -> bpy.types.Object:
    """Rods on crossed legs, with cloths over some of them; long side along X."""
    steel = products.lacquer(f"{name}_steel", (0.56, 0.57, 0.58), rng)
    parts = Parts(name)
    for x in (-0.6, 0.6):
        for sign in (-1, 1):
            line = [(x, -0.27 * sign, 0.0), (x, 0.27 * sign, 0.96)]
            parts.tube("leg", steel, line, 0.010, 8)
        parts.tube("rail", steel, [(x, -0.27, 0.96), (x, 0.27, 0.96)], 0.010, 8)
    rods = [-0.25 + 0.1 * k for k in range(6)]
    for y in rods:
        parts.tube("rod", steel, [(-0.6, y, 0.96), (0.6, y, 0.96)], 0.006, 6)
    for k in range(pieces):
        wide, long = rng.uniform(0.25, 0.5), rng.uniform(0.25, 0.6)
        x, y = rng.uniform(-0.55 + wide / 2, 0.55 - wide / 2), rods[k % len(rods)]
        section = [
            (-0.012, 0.96 - long),
            (-0.010, 0.955),
            (0.0, 0.968),
            (0.010, 0.955),
            (0.012, 0.96 - 0.8 * long),
        ]
        verts = [(x + side * wide / 2, y + dy, z) for dy, z in section for side in (-1, 1)]
        faces = [(2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2) for i in range(len(section) - 1)]
        sheet = mesh.solidify(mesh.from_pydata(f"{name}_cloth_{k}", verts, faces), 0.004, offset=0.0)
        cloth = interior.cloth(f"{name}_cloth_{k}", rng.choice(LINEN), rng, slub_per_m=140)
        parts.add(sheet, cloth)
    return parts.join()


@kind("ironing_board", (1.36, 0.38, 0.9), "surface", front="-y", colour=colours("cover"))
def ironing_board(name: str, rng: random.Random, *, cover: Colour = (0.20, 0.34, 0.42)) -> bpy.types.Object:
    """A padded board on crossed tubes, its point at +X; long side along X."""
    cloth = interior.striped_cloth(
        f"{name}_cover", (cover, products.scaled(cover, 1.7)), rng, period_m=0.05, axis=1
    )
    steel = products.lacquer(f"{name}_steel", (0.50, 0.51, 0.52), rng)
    outline = [(-0.68, -0.17), (-0.68, 0.17), (0.25, 0.19)]
    outline += [(0.25 + 0.43 * sin(a), 0.19 * cos(a)) for a in (pi / 8, pi / 4, 3 * pi / 8, pi / 2)]
    outline += [(x, -y) for x, y in reversed(outline[2:-1])]
    sections = [[(x, y, z) for x, y in outline] for z in (0.86, 0.90)]
    parts = Parts(name)
    parts.add(mesh.loft("board", sections), cloth)
    for y in (-0.12, 0.12):
        for sign in (-1, 1):
            line = [(-0.45 * sign, y, 0.012), (0.38 * sign, 0.7 * y, 0.86)]
            parts.tube("leg", steel, line, 0.011, 8)
    for x in (-0.45, 0.45):
        parts.tube("foot", steel, [(x, -0.19, 0.012), (x, 0.19, 0.012)], 0.012, 8)
    return parts.join()
