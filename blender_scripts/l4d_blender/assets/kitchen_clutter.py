"""Things that stand about in kitchens: a board with vegetables, bottles, jars, plates, herbs, a loaf."""

from __future__ import annotations

import random
from math import cos, pi, sin

import bpy
from mathutils import Matrix, Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior, kitchen
from l4d_blender.assets.materials.base import principled
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import colours, kind
from l4d_blender.scene.colour import Colour


@kind("board", (0.38, 0.26, 0.09), "surface")
def chopping_board(name: str, rng: random.Random) -> bpy.types.Object:
    """A thick board with tomatoes, carrot slices, half an onion and a knife; front = -Y."""
    wood = interior.wood(f"{name}_wood", (0.50, 0.32, 0.16), rng, grain_axis="X")
    parts = Parts(name)
    parts.box("slab", wood, (0.38, 0.26, 0.028), 0.008)
    top = 0.028
    red = _skin(f"{name}_tomato", (0.55, 0.045, 0.02))
    green = _skin(f"{name}_stalk", (0.08, 0.20, 0.04))
    for x, y, r in ((0.10, 0.05, 0.036), (0.15, -0.02, 0.033), (0.075, -0.035, 0.030)):
        parts.ellipsoid("tomato", red, (r, r, 0.82 * r), 24, 16, (x, y, top + 0.80 * r))
        parts.ellipsoid("star", green, (0.011, 0.011, 0.004), 10, 6, (x, y, top + 1.60 * r))
    orange = _skin(f"{name}_carrot", (0.72, 0.24, 0.03))
    for k in range(9):
        coin = mesh.cylinder(f"{name}_coin", rng.uniform(0.012, 0.017), 0.006, 20, 0.001)
        place = Matrix.Translation(
            (-0.10 + rng.uniform(-0.05, 0.05), 0.03 + rng.uniform(-0.05, 0.05), top + 0.0062 * (k % 2))
        )
        parts.add(coin, orange, within=place)
    parts.tube(
        "whole",
        orange,
        [(-0.16, -0.075, top + 0.017), (-0.06, -0.082, top + 0.016), (0.03, -0.078, top + 0.008)],
        [0.017, 0.014, 0.005],
        14,
    )
    steel = principled(f"{name}_blade", (0.6, 0.6, 0.62), roughness=0.2, metallic=1.0)
    black = principled(f"{name}_haft", (0.02, 0.018, 0.017), roughness=0.4)
    parts.box("blade", steel, (0.17, 0.034, 0.0025), 0.001, 1, x=0.03, y=-0.112, z=top)
    parts.box("haft", black, (0.105, 0.024, 0.016), 0.006, x=-0.105, y=-0.112, z=top)
    return parts.join()


@kind("stand", (0.254, 0.254, 0.02), "surface")
def pot_stand(
    name: str, rng: random.Random, *, height_m: float = 0.02, radius_m: float = 0.125
) -> bpy.types.Object:
    """A round slab of oak with an iron band, for hot pots."""
    oak = interior.wood(f"{name}_oak", (0.40, 0.24, 0.11), rng, grain_axis="Y")
    band = kitchen.cast_iron(f"{name}_band")
    parts = Parts(name)
    parts.cylinder("disc", oak, radius_m, height_m, 48, 0.004)
    parts.lathe("ring", band, [(radius_m + 0.002, z * height_m) for z in (0.3, 0.7)], 48, close_bottom=False)
    return parts.join()


@kind("bottle", (0.069, 0.069, 0.286), "graspable", "container", colour=colours("colour"))
def bottle(
    name: str, rng: random.Random, *, colour: Colour = (0.10, 0.13, 0.03), height_m: float = 0.27
) -> bpy.types.Object:
    """An oil or vinegar bottle with a label and a cork."""
    k = height_m / 0.27
    glass = principled(
        f"{name}_glass", colour, roughness=0.08, specular=0.7, variation=0.25, variation_scale=12
    )
    label = principled(
        f"{name}_label",
        rng.choice([(0.66, 0.60, 0.44), (0.60, 0.56, 0.50), (0.55, 0.42, 0.16)]),
        roughness=0.7,
        variation=0.35,
        variation_scale=45,
    )
    cork = principled(f"{name}_cork", (0.30, 0.18, 0.09), roughness=0.9, variation=0.3, variation_scale=90)
    parts = Parts(name)
    parts.lathe(
        "body",
        glass,
        [
            (0.026 * k, 0),
            (0.033 * k, 0.006),
            (0.034 * k, 0.14 * k),
            (0.030 * k, 0.17 * k),
            (0.014 * k, 0.205 * k),
            (0.012 * k, 0.25 * k),
            (0.015 * k, 0.255 * k),
            (0.015 * k, height_m),
        ],
        28,
        close_top=True,
    )
    parts.lathe(
        "band",
        label,
        [(0.0345 * k, 0.045 * k), (0.0347 * k, 0.05 * k), (0.0347 * k, 0.12 * k), (0.0345 * k, 0.125 * k)],
        28,
        close_bottom=False,
    )
    parts.cylinder("cork", cork, 0.012 * k, 0.02 * k, 16, 0.002, z=height_m - 0.004)
    return parts.join()


@kind("jar", (0.122, 0.122, 0.18), "graspable", "container", "stacks", colour=colours("content"))
def jar(
    name: str, rng: random.Random, *, content: Colour = (0.50, 0.20, 0.07), height_m: float = 0.16
) -> bpy.types.Object:
    """A storage jar whose content shows, with a wooden lid."""
    r = 0.38 * height_m
    inside = principled(
        f"{name}_content",
        content,
        roughness=0.35,
        variation=0.5,
        variation_scale=110,
        bump=(160, 0.002),
        specular=0.6,
    )
    wood = interior.wood(f"{name}_lid", (0.42, 0.27, 0.13), rng)
    pale = principled(f"{name}_top", (0.55, 0.58, 0.56), roughness=0.12, variation=0.1)
    fill = rng.uniform(0.6, 0.85) * height_m
    parts = Parts(name)
    parts.cylinder("full", inside, r, fill, 36, 0.010)
    parts.cylinder("rest", pale, 0.995 * r, height_m - fill + 0.012, 36, 0.008, z=fill - 0.012)
    parts.cylinder("lid", wood, 0.82 * r, 0.022, 32, 0.004, z=height_m - 0.002)
    return parts.join()


@kind("plates", (0.242, 0.242, 0.082), "surface", colour=colours("colour"))
def plate_stack(
    name: str,
    rng: random.Random,
    *,
    colour: Colour = (0.66, 0.64, 0.58),
    count: int = 6,
    radius_m: float = 0.12,
) -> bpy.types.Object:
    """Plates, or with a small radius bowls, on top of each other."""
    glaze = interior.ceramic(f"{name}_glaze", colour, rng)
    parts = Parts(name)
    for k in range(count):
        r = radius_m * rng.uniform(0.985, 1.0)
        plate = mesh.lathe(
            f"{name}_plate",
            [
                (0.55 * r, 0.0),
                (0.60 * r, 0.004),
                (0.98 * r, 0.022),
                (r, 0.026),
                (0.97 * r, 0.027),
                (0.60 * r, 0.009),
                (0, 0.008),
            ],
            40,
        )
        parts.add(plate, glaze, x=rng.uniform(-0.003, 0.003), y=rng.uniform(-0.003, 0.003), z=0.011 * k)
    return parts.join()


@kind("kettle", (0.256, 0.204, 0.237), "graspable", "pours", colour=colours("colour"))
def kettle(name: str, rng: random.Random, *, colour: Colour = (0.12, 0.24, 0.34)) -> bpy.types.Object:
    """An enamelled kettle with a spout and a bail."""
    skin, iron = kitchen.enamel(f"{name}_enamel", colour, rng), kitchen.cast_iron(f"{name}_iron")
    parts = Parts(name)
    parts.lathe(
        "body",
        skin,
        [(0.085, 0), (0.098, 0.008), (0.102, 0.04), (0.090, 0.09), (0.060, 0.13), (0.030, 0.145), (0, 0.148)],
        40,
    )
    parts.ellipsoid("knob", iron, (0.013, 0.013, 0.015), 14, 10, (0, 0, 0.160))
    parts.tube(
        "spout", skin, [(0.075, 0, 0.07), (0.12, 0, 0.10), (0.145, 0, 0.145)], [0.022, 0.015, 0.011], 14
    )
    parts.tube(
        "bail",
        iron,
        [(0.088 * cos(a), 0, 0.105 + 0.125 * sin(a)) for a in (pi * k / 14 for k in range(15))],
        0.007,
        10,
    )
    return parts.join()


@kind("plant", (0.193, 0.18, 0.267), "graspable")
def herb_pot(name: str, rng: random.Random) -> bpy.types.Object:
    """Basil in a clay pot."""
    clay = principled(f"{name}_clay", (0.42, 0.17, 0.08), roughness=0.85, variation=0.25, bump=(120, 0.001))
    leaf = interior.leaf(f"{name}_leaf", (0.10, 0.26, 0.05), rng)
    parts = Parts(name)
    parts.lathe(
        "pot",
        clay,
        [(0.042, 0), (0.058, 0.09), (0.064, 0.09), (0.065, 0.11), (0.056, 0.11), (0.054, 0.095), (0, 0.095)],
        32,
    )
    for _ in range(46):
        turn, out, z = rng.uniform(0, 2 * pi), 0.085 * rng.random() ** 0.6, 0.12 + 0.14 * rng.random()
        size = rng.uniform(0.016, 0.027)
        place = (
            Matrix.Translation((out * cos(turn), out * sin(turn), z))
            @ Matrix.Rotation(turn, 4, "Z")
            @ Matrix.Rotation(rng.uniform(-0.3, 0.9), 4, "Y")
        )
        parts.ellipsoid("leaf", leaf, (size, 0.62 * size, 0.16 * size), 8, 5, within=place)
    parts.tube("stem", leaf, [(0, 0, 0.09), (0.01, 0.005, 0.2)], 0.006, 8)
    return parts.join()


@kind("loaf", (0.3, 0.15, 0.147), "graspable")
def loaf(name: str, rng: random.Random) -> bpy.types.Object:
    """A crusty oval loaf with three cuts."""
    crust = principled(
        f"{name}_crust",
        (0.36, 0.18, 0.06),
        roughness=0.75,
        variation=0.45,
        variation_scale=22,
        bump=(70, 0.004),
    )
    body = mesh.ellipsoid(f"{name}_body", (0.15, 0.075, 0.062), 36, 24, (0, 0, 0.05))

    def cut(p: Vector, normal: Vector) -> float:
        groove = max(0.0, 1.0 - abs((p.x - 0.4 * p.y + 0.09) % 0.06 - 0.03) / 0.012)
        return -0.007 * groove * max(0.0, normal.z) + (0.0 if p.z > 0.012 else 0.012 - p.z) * (-normal.z)

    return mesh.set_material(mesh.displace(body, cut), crust)


@kind("towel", (0.34, 0.03, 0.46), "hangs")
def tea_towel(
    name: str,
    rng: random.Random,
    *,
    colours: tuple[Colour, Colour] = ((0.62, 0.58, 0.50), (0.35, 0.08, 0.06)),
) -> bpy.types.Object:
    """A striped towel over a rail: hangs in the plane y = 0 down from z = 0."""
    cloth = interior.striped_cloth(f"{name}_cloth", colours, rng, period_m=0.06, axis=2)
    columns, rows, width, drop = 14, 12, 0.34, 0.46
    verts = [
        (
            width * (i / columns - 0.5) * (1 - 0.08 * j / rows),
            -0.012 - 0.012 * sin(2.5 * pi * i / columns + 0.4) * j / rows,
            -drop * j / rows,
        )
        for j in range(rows + 1)
        for i in range(columns + 1)
    ]
    w = columns + 1
    faces = [
        (j * w + i, (j + 1) * w + i, (j + 1) * w + i + 1, j * w + i + 1)
        for j in range(rows)
        for i in range(columns)
    ]
    return mesh.set_material(mesh.solidify(mesh.from_pydata(name, verts, faces), 0.006, offset=0.0), cloth)


def _skin(name: str, colour: Colour) -> bpy.types.Material:
    return principled(name, colour, roughness=0.25, variation=0.3, variation_scale=30)
