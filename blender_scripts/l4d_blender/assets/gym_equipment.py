"""What stands in a gym: flat bench, step, treadmill, wall bars, racks, punching bag, balls, mats.

All stand on z = 0, fronts towards -Y (wall bars: the wall is y = 0, the room at -Y).
"""

from __future__ import annotations

import random
from math import cos, pi, radians, sin

import bpy
from mathutils import Matrix

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import gym, interior
from l4d_blender.assets.materials.base import principled
from l4d_blender.assets.materials.products import glow, satin_plastic
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import colours, kind
from l4d_blender.scene.colour import Colour

BENCH_TOP_M = 0.44
STEP_TOP_M = 0.20
BALL_COLOURS = ((0.05, 0.20, 0.34), (0.40, 0.07, 0.04), (0.10, 0.11, 0.11), (0.50, 0.34, 0.06))
MAT_COLOURS = ((0.10, 0.20, 0.34), (0.34, 0.10, 0.22), (0.12, 0.28, 0.14))


@kind("bench", (1.23, 0.51, 0.44), "seat", "surface", colour=colours("colour"))
def bench(name: str, rng: random.Random, *, colour: Colour = (0.34, 0.045, 0.035)) -> bpy.types.Object:
    """A flat weight bench along X, 1.2 m long."""
    pad = mesh.move(mesh.bevel_box(f"{name}_pad", (1.22, 0.31, 0.075), 0.026, 4), z=BENCH_TOP_M - 0.075)
    seam = mesh.move(mesh.bevel_box(f"{name}_seam", (1.232, 0.322, 0.008), 0.003), z=BENCH_TOP_M - 0.062)
    coat = gym.powder_coat(f"{name}_frame", (0.055, 0.057, 0.062), rng)
    rubber = principled(f"{name}_feet", (0.015, 0.015, 0.015), roughness=0.85)
    parts = Parts(name)
    parts.add(pad, gym.vinyl(f"{name}_vinyl", colour, rng))
    parts.add(seam, principled(f"{name}_piping", (0.5, 0.5, 0.48), roughness=0.5))
    for size, x, y, z in (
        ((1.08, 0.07, 0.05), 0.0, 0.0, BENCH_TOP_M - 0.127),
        ((0.06, 0.06, 0.27), -0.42, 0.0, 0.05),
        ((0.06, 0.06, 0.27), 0.42, 0.0, 0.05),
        ((0.07, 0.50, 0.05), -0.42, 0.0, 0.02),
        ((0.07, 0.40, 0.05), 0.42, 0.0, 0.02),
        ((0.80, 0.05, 0.05), 0.0, 0.0, 0.10),
    ):
        parts.box("tube", coat, size, 0.006, x=x, y=y, z=z)
    for x, y in ((-0.42, 0.235), (-0.42, -0.235), (0.42, 0.185), (0.42, -0.185)):
        parts.box("foot", rubber, (0.078, 0.04, 0.075), 0.008, x=x, y=y)
    return parts.join()


@kind("step", (0.72, 0.38, 0.2), "surface", colour=colours("colour"))
def step(name: str, rng: random.Random, *, colour: Colour = (0.10, 0.34, 0.36)) -> bpy.types.Object:
    """An aerobics step on two risers, 70 by 38 cm."""
    plastic = satin_plastic(f"{name}_riser", colour, rng)
    grey = satin_plastic(f"{name}_body", (0.10, 0.10, 0.11), rng)
    top = principled(f"{name}_top", (0.045, 0.045, 0.05), roughness=0.8, variation=0.3, bump=(190, 0.003))
    parts = Parts(name)
    parts.box("deck", grey, (0.72, 0.38, 0.085), 0.03, 4, z=STEP_TOP_M - 0.088)
    parts.box("mat", top, (0.65, 0.31, 0.012), 0.004, z=STEP_TOP_M - 0.012)
    for x in (-0.24, 0.24):
        for z in (0.0, 0.058):
            parts.box("riser", plastic, (0.20 + 0.015 * (z == 0), 0.36, 0.058), 0.012, 3, x=x, z=z)
    return parts.join()


@kind("treadmill", (0.83, 1.79, 1.33), front="-y")
def treadmill(name: str, rng: random.Random) -> bpy.types.Object:
    """A running machine; whoever runs faces its console at -Y."""
    dark = satin_plastic(f"{name}_shell", (0.045, 0.047, 0.052), rng)
    silver = gym.powder_coat(f"{name}_silver", (0.34, 0.35, 0.36), rng)
    parts = Parts(name)
    parts.box("deck", dark, (0.76, 1.70, 0.13), 0.03, z=0.04)
    parts.box("belt", gym.belt(f"{name}_belt", rng), (0.50, 1.55, 0.012), 0.004, y=0.03, z=0.165)
    parts.box("hood", silver, (0.78, 0.36, 0.16), 0.06, 4, y=-0.76, z=0.09)
    for side in (-1, 1):
        parts.box("rail", silver, (0.10, 1.40, 0.02), 0.008, x=side * 0.31, y=0.08, z=0.168)
        parts.tube(
            "post",
            silver,
            [
                (side * 0.37, -0.70, 0.14),
                (side * 0.37, -0.66, 0.60),
                (side * 0.36, -0.58, 1.02),
                (side * 0.35, -0.44, 1.08),
                (side * 0.35, -0.08, 1.04),
            ],
            [(0.045, 0.03), (0.04, 0.028), (0.032, 0.026), (0.024, 0.022), (0.020, 0.020)],
            14,
        )
    tilt = Matrix.Translation((0, -0.66, 1.05)) @ Matrix.Rotation(radians(24), 4, "X")
    parts.box("console", dark, (0.74, 0.10, 0.34), 0.03, 4, within=tilt)
    screen = mesh.move(mesh.bevel_box(f"{name}_screen", (0.40, 0.006, 0.20), 0.002), y=0.051, z=0.09)
    parts.add(screen, glow(f"{name}_screen", (0.10, 0.35, 0.55), 0.5), within=tilt)
    return parts.join()


@kind("wall_bars", (1.75, 0.161, 2.3), "hangs", front="-y")
def wall_bars(name: str, rng: random.Random, *, fields: int = 2) -> bpy.types.Object:
    """Swedish bars: beech uprights and rungs, 2.3 m high."""
    beech = interior.wood(f"{name}_beech", (0.48, 0.30, 0.15), rng, grain_axis="Z")
    rung_wood = interior.wood(f"{name}_rungs", (0.52, 0.33, 0.17), rng, grain_axis="X")
    width, height = 0.86, 2.30
    parts = Parts(name)
    for k in range(fields + 1):
        x = width * (k - fields / 2)
        parts.box("post", beech, (0.035, 0.13, height), 0.006, x=x, y=-0.075)
    for k in range(fields):
        x = width * (k + 0.5 - fields / 2)
        for i in range(15):
            z = 0.12 + 0.148 * i
            y = -0.10 if i < 14 else -0.15
            parts.tube(
                "rung", rung_wood, [(x - width / 2, y, z), (x + width / 2, y, z)], [(0.021, 0.016)] * 2, 12
            )
    return parts.join()


@kind("rack", (1.31, 0.52, 0.995), front="-y")
def kettlebell_rack(name: str, rng: random.Random) -> bpy.types.Object:
    """Two sloping shelves: kettlebells below, medicine balls above."""
    coat = gym.powder_coat(f"{name}_frame", (0.05, 0.052, 0.056), rng)
    iron = gym.cast(f"{name}_iron", (0.035, 0.035, 0.038), rng)
    parts = Parts(name)
    for x in (-0.62, 0.62):
        for size, y, z in (((0.06, 0.06, 0.92), 0.0, 0.0), ((0.07, 0.52, 0.05), 0.0, 0.0)):
            parts.box("tube", coat, size, 0.006, x=x, y=y - 0.25, z=z)
    for z in (0.28, 0.72):
        shelf = mesh.bevel_box(f"{name}_shelf", (1.30, 0.36, 0.03), 0.005)
        parts.add(shelf, coat, within=Matrix.Translation((0, -0.26, z)) @ Matrix.Rotation(radians(7), 4, "X"))
    for k in range(5):
        x = -0.50 + 0.25 * k
        r = 0.075 + 0.008 * k
        top = 0.31 + 1.75 * r
        loop = [
            (x + 0.055 * cos(a) * (1 + 0.15 * sin(a)), -0.26, top + 0.075 * sin(a))
            for a in (pi * i / 12 for i in range(13))
        ]
        parts.ellipsoid("bell", iron, (r, r, 0.95 * r), 24, 16, (x, -0.26, 0.31 + 0.93 * r))
        parts.tube("loop", iron, loop, 0.015, 12)
    for k, x in enumerate((-0.44, -0.15, 0.15, 0.44)):
        skin = gym.vinyl(f"{name}_ball_{k}", BALL_COLOURS[k], rng)
        parts.ellipsoid("ball", skin, (0.125, 0.125, 0.125), 28, 20, (x, -0.27, 0.87))
    return parts.join()


@kind("stand", (2.04, 0.95, 2.12), colour=colours("plate"))
def barbell_stand(
    name: str, rng: random.Random, *, plate: Colour = (0.030, 0.030, 0.033)
) -> bpy.types.Object:
    """A squat stand with a loaded barbell in its hooks."""
    coat = gym.powder_coat(f"{name}_frame", (0.40, 0.06, 0.04), rng)
    steel = gym.knurled_steel(f"{name}_bar", rng)
    rubber = gym.cast(f"{name}_plates", plate, rng)
    parts = Parts(name)
    for x in (-0.55, 0.55):
        for size, y, z in (
            ((0.07, 0.07, 2.1), 0.0, 0.0),
            ((0.08, 0.95, 0.06), -0.2, 0.0),
            ((0.06, 0.12, 0.08), -0.08, 1.32),
        ):
            parts.box("tube", coat, size, 0.006, x=x, y=y - 0.25, z=z)
    parts.box("top", coat, (1.17, 0.07, 0.07), 0.006, y=-0.25, z=2.05)
    parts.tube("barbell", steel, [(-1.02, -0.37, 1.42), (1.02, -0.37, 1.42)], 0.015, 14)
    for side in (-1, 1):
        for k, (r, thick) in enumerate(((0.215, 0.055), (0.18, 0.045), (0.05, 0.03))):
            disc = mesh.rotate(mesh.cylinder(f"{name}_plate", r, thick, 44, 0.008), "Y", 90)
            x = (0.70, 0.757, 0.804)[k]
            mesh.move(disc, x=x if side > 0 else -x - thick, y=-0.37, z=1.42)
            parts.add(disc, rubber if k < 2 else steel)
    return parts.join()


@kind("punching_bag", (0.345, 0.345, 1.98), "swings", colour=colours("colour"))
def punching_bag(
    name: str, rng: random.Random, *, colour: Colour = (0.10, 0.03, 0.025), hook_m: float = 2.7
) -> bpy.types.Object:
    """A heavy bag on chains from the ceiling."""
    skin = gym.vinyl(f"{name}_skin", colour, rng)
    steel = principled(f"{name}_chain", (0.30, 0.30, 0.31), roughness=0.35, metallic=1.0)
    parts = Parts(name)
    parts.cylinder("bag", skin, 0.17, 1.10, 40, 0.03, z=0.72)
    band = principled(f"{name}_band", (0.66, 0.64, 0.60), roughness=0.5, variation=0.2)
    for z in (0.95, 1.58):
        parts.lathe(
            "ring",
            band,
            [(0.1715, z), (0.1725, z + 0.01), (0.1725, z + 0.05), (0.1715, z + 0.06)],
            40,
            close_bottom=False,
        )
    for k in range(4):
        a = pi / 4 + k * pi / 2
        parts.tube("chain", steel, [(0.15 * cos(a), 0.15 * sin(a), 1.81), (0, 0, 2.20)], 0.006, 8)
    parts.tube("rope", steel, [(0, 0, 2.2), (0, 0, hook_m)], 0.012, 8)
    return parts.join()


@kind("ball", (0.651, 0.651, 0.651), "rolls", "seat", colour=colours("colour"))
def exercise_ball(
    name: str, rng: random.Random, *, colour: Colour = (0.30, 0.32, 0.34), radius_m: float = 0.325
) -> bpy.types.Object:
    """A ribbed gymnastics ball."""
    ball = mesh.ellipsoid(f"{name}_ball", (radius_m,) * 3, 48, 40, (0, 0, radius_m))
    mesh.displace(ball, lambda p, normal: 0.003 * max(0.0, sin(95.0 * (p.z - radius_m))) ** 2)
    return mesh.set_material(ball, satin_plastic(f"{name}_skin", colour, rng))


@kind("mats", (0.41, 0.41, 0.64))
def rolled_mats(name: str, rng: random.Random) -> bpy.types.Object:
    """Rolled exercise mats that stand in a wire basket."""
    steel = principled(f"{name}_wire", (0.10, 0.10, 0.11), roughness=0.4, metallic=0.8)
    parts = Parts(name)
    for k, (x, y) in enumerate(((-0.10, 0.0), (0.07, 0.08), (0.06, -0.09))):
        points = [
            (x + r * cos(a), y + r * sin(a)) for r, a in ((0.016 + 0.0018 * i, 0.42 * i) for i in range(34))
        ]
        sheet = mesh.from_pydata(
            f"{name}_mat_{k}",
            [(px, py, z) for z in (0.02, 0.64) for px, py in points],
            [(i, i + 1, len(points) + i + 1, len(points) + i) for i in range(len(points) - 1)],
        )
        foam = principled(f"{name}_foam_{k}", MAT_COLOURS[k], roughness=0.8, variation=0.2, bump=(240, 0.001))
        parts.add(mesh.solidify(sheet, 0.006, offset=0.0), foam)
    for z in (0.03, 0.20, 0.36):
        parts.torus("ring", steel, 0.20, 0.005, 36, 8, z=z)
    for k in range(10):
        a = 2 * pi * k / 10
        parts.tube(
            "wire",
            steel,
            [(0.20 * cos(a), 0.20 * sin(a), 0.0), (0.20 * cos(a), 0.20 * sin(a), 0.37)],
            0.0035,
            6,
        )
    return parts.join()


@kind("mat", (1.5, 1.1, 0.012), "surface", colour=colours("colour"))
def floor_mat(
    name: str,
    rng: random.Random,
    *,
    colour: Colour = (0.07, 0.12, 0.17),
    size_m: tuple[float, float] = (1.5, 1.1),
) -> bpy.types.Object:
    """A flat foam mat with a welted edge, 12 mm thick."""
    foam = principled(
        f"{name}_foam", colour, roughness=0.75, variation=0.22, variation_scale=9, bump=(260, 0.0012)
    )
    pad = mesh.bevel_box(f"{name}_pad", (*size_m, 0.012), 0.004)
    return mesh.set_material(pad, foam)


@kind("bottle", (0.072, 0.072, 0.233), "graspable", "container", colour=colours("colour"))
def drink_bottle(name: str, rng: random.Random, *, colour: Colour = (0.10, 0.30, 0.50)) -> bpy.types.Object:
    """A sports bottle."""
    black = satin_plastic(f"{name}_cap", (0.03, 0.03, 0.03), rng)
    parts = Parts(name)
    parts.lathe(
        "body",
        satin_plastic(f"{name}_plastic", colour, rng),
        [
            (0.032, 0),
            (0.036, 0.006),
            (0.036, 0.07),
            (0.031, 0.10),
            (0.036, 0.13),
            (0.035, 0.18),
            (0.022, 0.20),
        ],
        28,
        close_top=True,
    )
    parts.cylinder("cap", black, 0.020, 0.035, 20, 0.004, z=0.198)
    return parts.join()


@kind("towel", (0.32, 0.085, 0.407), "graspable", colour=colours("colour"))
def folded_towel(name: str, rng: random.Random, *, colour: Colour = (0.62, 0.58, 0.50)) -> bpy.types.Object:
    """A towel thrown over a bar that runs along X at z = 0."""
    cloth = interior.cloth(f"{name}_cloth", colour, rng)
    rows, columns, width = 20, 10, 0.32
    verts = []
    for j in range(rows + 1):
        s = (j / rows - 0.5) * 0.86
        over = max(-1.0, min(1.0, s / 0.05))
        y, z = 0.030 * over, 0.022 * (1 - over**2) - max(0.0, abs(s) - 0.05)
        for i in range(columns + 1):
            x = width * (i / columns - 0.5) * (1 - 0.10 * abs(s))
            verts.append((x, y + 0.008 * sin(9 * i / columns + 2) * abs(over), z))
    w = columns + 1
    faces = [
        (j * w + i, j * w + i + 1, (j + 1) * w + i + 1, (j + 1) * w + i)
        for j in range(rows)
        for i in range(columns)
    ]
    return mesh.set_material(mesh.solidify(mesh.from_pydata(name, verts, faces), 0.010, offset=0.0), cloth)
