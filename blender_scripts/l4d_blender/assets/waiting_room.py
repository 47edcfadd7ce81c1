"""A waiting room: chequered linoleum, a wall painted in two tones, a door with a frosted pane, posters.

Owns what is fixed to the building. Knows nothing of furniture. Back wall at +Y, floor at z = 0, open to -Y.
"""

from __future__ import annotations

import random
from math import pi

import bpy
from mathutils import Matrix

from l4d_blender.assets import mesh
from l4d_blender.assets.lettering import lettering
from l4d_blender.assets.materials import products
from l4d_blender.assets.materials.base import Nodes
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.colour import Colour

WALL_HEIGHT_M = 2.7
DADO_M = 1.12


@kind("room", (6.46, 5.61, 2.72), "backdrop")
def waiting_room(
    name: str,
    rng: random.Random,
    *,
    half_width_m: float = 3.1,
    back_m: float = 2.05,
    front_m: float = -3.4,
    upper: Colour = (0.66, 0.6, 0.44),
    lower: Colour = (0.17, 0.27, 0.24),
    tiles: tuple[Colour, Colour] = ((0.5, 0.47, 0.38), (0.16, 0.22, 0.2)),
) -> list[bpy.types.Object]:
    """[floor, upper walls, lower walls, rails]."""
    length, middle = back_m - front_m, 0.5 * (back_m + front_m)
    floor = mesh.move(mesh.box(f"{name}_floor", (2 * half_width_m, length, 0.02)), y=middle, z=-0.02)
    mesh.set_material(floor, linoleum(f"{name}_linoleum", tiles, rng))
    zones: dict[str, list[bpy.types.Object]] = {"upper": [], "lower": [], "rail": []}
    for size_x, size_y, x, y in (
        (2 * half_width_m, 0.1, 0.0, back_m + 0.05),
        (0.1, length, -half_width_m - 0.05, middle),
        (0.1, length, half_width_m + 0.05, middle),
    ):
        wall = mesh.box(f"{name}_wall", (size_x, size_y, WALL_HEIGHT_M - DADO_M))
        zones["upper"].append(mesh.move(wall, x, y, DADO_M))
        zones["lower"].append(mesh.move(mesh.box(f"{name}_dado", (size_x, size_y, DADO_M)), x, y, 0.0))
        for z, tall, out in ((DADO_M - 0.02, 0.05, 0.03), (0.0, 0.10, 0.025)):
            rail = mesh.bevel_box(f"{name}_rail", (size_x + 2 * out, size_y + 2 * out, tall), 0.008)
            zones["rail"].append(mesh.move(rail, x, y, z))
    paints = {
        "upper": products.plaster(f"{name}_upper", upper, rng),
        "lower": products.lacquer(f"{name}_lower", lower, rng),
        "rail": products.wood(f"{name}_rail", (0.34, 0.20, 0.10), (0.18, 0.095, 0.045), rng, grain_axis="X"),
    }
    return [floor, *(mesh.set_material(mesh.join(f"{name}_{key}", zones[key]), paints[key]) for key in zones)]


def linoleum(name: str, tiles: tuple[Colour, Colour], rng: random.Random) -> bpy.types.Material:
    """Polished tiles of 40 cm in two marbled colours, scuffed where people walk."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    at = n.vector_math("ADD", n.object_coords(), (rng.uniform(-9, 9), rng.uniform(-9, 9), 0.0))
    checks = n.node("ShaderNodeTexChecker")
    n.feed(checks.inputs["Vector"], n.vector_math("ADD", n.object_coords(), (0.0, 0.0, 0.2)))
    n.feed(checks.inputs["Scale"], 2.5)
    veins = n.noise(16.0, 5.0, vector=at, distortion=1.6)
    scuffs = n.noise(2.2, 4.0, vector=at)
    pair = [
        n.ramp(veins, [(0.35, products.scaled(c, 0.72)), (0.55, c), (0.72, products.scaled(c, 1.3))])
        for c in tiles
    ]
    tone = n.mix(checks.outputs["Fac"], pair[0], pair[1])
    _, joint = n.brick(
        1.0, ((1, 1, 1), (1, 1, 1)), (0, 0, 0), width=0.4, height=0.4, mortar_size=0.0018, offset=0.0
    )
    tone = n.mix(n.math("MULTIPLY", joint, 0.7), tone, (0.05, 0.05, 0.045))
    n.set("Base Color", n.mix(n.map_range(scuffs, 0.45, 0.75, 0.0, 0.30), tone, (0.14, 0.13, 0.11)))
    n.set("Roughness", n.map_range(scuffs, 0.35, 0.7, 0.22, 0.50))
    n.bump(n.noise(60.0, 2.0, vector=at), 0.15, 0.001)
    return material


@kind("door", (1.1, 0.114, 2.16), "hangs", front="-y")
def door(name: str, rng: random.Random, *, leaf: Colour = (0.3, 0.165, 0.075)) -> bpy.types.Object:
    """A door in its frame: the wall is y = 0, the room at -Y; frosted pane with lettering, brass handle."""
    wood = products.wood(f"{name}_leaf", leaf, products.scaled(leaf, 0.5), rng, grain_axis="Z")
    frame = products.lacquer(f"{name}_frame", (0.62, 0.58, 0.48), rng)
    brass = products.metal(f"{name}_brass", (0.62, 0.46, 0.20), rng, roughness=0.25)
    pane = products.glow(f"{name}_pane", (0.74, 0.80, 0.78), 0.55)
    parts = Parts(name)

    def block(
        size: tuple[float, float, float], at: tuple[float, float, float], material: bpy.types.Material
    ) -> None:
        parts.add(mesh.move(mesh.bevel_box(f"{name}_part", size, 0.006), *at), material)

    for side in (-1, 1):
        block((0.10, 0.07, 2.12), (0.50 * side, -0.02, 0.0), frame)
        block((0.13, 0.05, 2.02), (0.385 * side, -0.012, 0.01), wood)
    block((1.10, 0.07, 0.10), (0.0, -0.02, 2.06), frame)
    for z, tall in ((0.01, 0.25), (0.98, 0.14), (1.89, 0.14)):
        block((0.66, 0.05, tall), (0.0, -0.012, z), wood)
    block((0.66, 0.03, 0.74), (0.0, -0.004, 0.25), wood)
    block((0.52, 0.02, 0.60), (0.0, -0.020, 0.32), wood)
    block((0.66, 0.012, 0.79), (0.0, -0.008, 1.11), pane)
    block((0.05, 0.012, 0.20), (0.385, -0.042, 0.95), brass)
    parts.tube(
        "lever", brass, [(0.385, -0.04, 1.06), (0.385, -0.085, 1.06), (0.28, -0.09, 1.06)], 0.009, segments=10
    )
    word = mesh.rotate(lettering(f"{name}_word", "ROOM 2", 0.085, bold_m=0.001), "X", 90.0)
    ink = products.satin_plastic(f"{name}_ink", (0.05, 0.06, 0.06), rng)
    parts.add(word, ink, y=-0.0155, z=1.55)
    return parts.join()


@kind("poster", (0.5, 0.007, 0.7), "hangs", front="-y")
def poster(
    name: str,
    rng: random.Random,
    *,
    title: str = "FEEL WELL",
    paper: Colour = (0.52, 0.56, 0.50),
    figure: Colour = (0.10, 0.34, 0.26),
    size_m: tuple[float, float] = (0.5, 0.7),
) -> bpy.types.Object:
    """A poster with a big figure, a title and lines of print; the wall is y = 0, its lower edge z = 0."""
    width, height = size_m
    parts = Parts(name)
    parts.box("sheet", products.paper(f"{name}_paper", paper, rng), (width, 0.004, height), y=-0.004)
    tone = products.paper(f"{name}_figure", figure, rng)
    disc = mesh.cylinder(f"{name}_disc", 0.30 * width, 0.001, 40)
    mesh.move(mesh.rotate(disc, "X", 90.0), 0.0, -0.0062, 0.62 * height)
    parts.add(disc, tone)
    white = products.paper(f"{name}_white", products.scaled(paper, 1.5), rng)
    for angle in (0.0, 0.5 * pi):
        bar = mesh.box(f"{name}_bar", (0.34 * width, 0.001, 0.085 * width))
        mesh.transform(bar, Matrix.Rotation(angle, 4, "Y") @ Matrix.Translation((0, 0, -0.0425 * width)))
        parts.add(bar, white, y=-0.0078 - 0.0003 * angle, z=0.62 * height)
    ink = products.paper(f"{name}_ink", (0.07, 0.08, 0.09), rng)
    word = mesh.rotate(lettering(f"{name}_word", title, 0.075, bold_m=0.001), "X", 90.0)
    parts.add(word, ink, y=-0.0068, z=0.28 * height)
    for k in range(4):
        wide = width * rng.uniform(0.5, 0.76)
        parts.box("line", ink, (wide, 0.001, 0.010), y=-0.0055, z=(0.19 - 0.038 * k) * height)
    return parts.join()


@kind("clock", (0.358, 0.028, 0.358), "hangs", front="-y")
def clock(name: str, rng: random.Random) -> bpy.types.Object:
    """A station clock 34 cm across; the wall is y = 0, its middle at the origin."""
    face = mesh.rotate(mesh.cylinder(f"{name}_face", 0.16, 0.012, 48), "X", 90.0)
    black = products.satin_plastic(f"{name}_black", (0.02, 0.02, 0.022), rng)
    parts = Parts(name)
    parts.torus("rim", black, 0.165, 0.014, 48, 12, y=-0.014, turn=("X", 90.0))
    parts.add(face, products.satin_plastic(f"{name}_white", (0.74, 0.73, 0.69), rng))
    marks = [(2 * pi * k / 12, 0.118, 0.024, 0.007) for k in range(12)]
    marks += [(-1.05, -0.01, 0.095, 0.012), (2.2, -0.015, 0.135, 0.008)]
    for turn, inner, long, wide in marks:
        bar = mesh.box(f"{name}_mark", (wide, 0.002, long))
        parts.add(
            bar, black, within=Matrix.Rotation(turn, 4, "Y") @ Matrix.Translation((0.0, -0.0145, inner))
        )
    return parts.join()
