"""A draw well: a ring of rough stones, two posts with a windlass, and a little gable roof of shingles."""

from __future__ import annotations

import math
import random

import bpy
from mathutils import Matrix, Vector, noise

from l4d_blender.scene.catalogue import kind

from . import mesh
from .materials import outdoors
from .parts import placed

RING_RADIUS_M = 0.60
RING_HEIGHT_M = 0.74


def _stone(name: str, size: Vector, shift: Vector) -> bpy.types.Object:
    """A block with its corners worn off and its faces uneven."""
    block = mesh.bevel_box(name, size, 0.032, 2)
    mesh.move(block, z=-size.z / 2)
    mesh.displace(block, lambda p, n: 0.012 * noise.noise(p * 9.0 + shift))
    mesh.shade_smooth(block)
    return block


def _ring(name: str, rng: random.Random) -> list[bpy.types.Object]:
    """Courses of stones, joints staggered, coping of flatter slabs on top."""
    inner = 0.40
    core_profile = [
        (RING_RADIUS_M - 0.045, -0.08),
        (RING_RADIUS_M - 0.045, RING_HEIGHT_M - 0.09),
        (inner + 0.03, RING_HEIGHT_M - 0.09),
        (inner + 0.03, 0.05),
        (0.0, 0.05),
    ]
    core = mesh.lathe(f"{name}_core", core_profile, segments=36, close_bottom=False)
    mesh.set_material(core, outdoors.mortar(f"{name}_mortar"))
    stone_look = outdoors.field_stone(f"{name}_stone")
    stones, courses, depth = [], 4, RING_RADIUS_M - inner
    course_m = (RING_HEIGHT_M - 0.09) / courses
    for course in range(courses + 1):
        coping = course == courses
        count = 11 if coping else 13
        height = 0.10 if coping else course_m
        z = RING_HEIGHT_M - 0.05 if coping else course_m * (course + 0.5)
        for k in range(count):
            angle = 2 * math.pi * (k + 0.5 * (course % 2) + rng.uniform(-0.08, 0.08)) / count
            width = 2 * math.pi * RING_RADIUS_M / count * rng.uniform(0.86, 0.97)
            size = Vector(
                (
                    width,
                    depth + (0.07 if coping else rng.uniform(-0.01, 0.02)),
                    height * rng.uniform(0.88, 0.98),
                )
            )
            stone = _stone(f"{name}_stone", size, Vector([rng.uniform(-9, 9) for _ in range(3)]))
            middle = inner + depth / 2 + rng.uniform(-0.008, 0.012)
            # The block's length is tangential, its depth radial.
            place = (
                Matrix.Rotation(angle, 4, "Z")
                @ Matrix.Translation((middle, 0, z))
                @ Matrix.Rotation(math.pi / 2, 4, "Z")
            )
            mesh.transform(stone, place @ Matrix.Rotation(rng.uniform(-0.02, 0.02), 4, "X"))
            mesh.set_material(stone, stone_look)
            stones.append(stone)
    return [core, *stones]


def _roof(
    name: str, rng: random.Random, *, eaves_z: float, ridge_z: float, half_x: float, half_y: float
) -> list[bpy.types.Object]:
    """Rows of shingles on two slopes that fall towards -Y and +Y."""
    parts = []
    shingles = outdoors.weathered_wood(f"{name}_shingles", (0.165, 0.125, 0.095), grain_axis="Y")
    slope = math.atan2(ridge_z - eaves_z, half_y)
    length = math.hypot(ridge_z - eaves_z, half_y)
    rows, columns = 5, 9
    for side in (-1.0, 1.0):
        for row in range(rows):
            for column in range(columns):
                width = 2 * half_x / columns
                plank = mesh.bevel_box(
                    f"{name}_shingle",
                    (width * rng.uniform(0.88, 0.97), length / rows * 1.45, 0.014),
                    0.004,
                    1,
                )
                down = length * (row + 0.62) / rows + rng.uniform(-0.012, 0.012)
                x = -half_x + width * (column + 0.5 + (0.22 if row % 2 else -0.22) * 0.5)
                pose = (
                    Matrix.Translation((x, 0.0, ridge_z))
                    @ Matrix.Rotation(0.0 if side < 0 else math.pi, 4, "Z")
                    @ Matrix.Rotation(slope, 4, "X")
                    @ Matrix.Translation((0, -down, 0.012))
                    @ Matrix.Rotation(-0.05 + rng.uniform(-0.02, 0.02), 4, "X")
                )
                mesh.transform(plank, pose)
                mesh.set_material(plank, shingles)
                parts.append(plank)
    cap = mesh.bevel_box(f"{name}_cap", (2 * half_x + 0.04, 0.10, 0.03), 0.008, 2)
    mesh.move(cap, z=ridge_z + 0.015)
    mesh.set_material(cap, outdoors.weathered_wood(f"{name}_cap", grain_axis="X"))
    return [*parts, cap]


@kind("well", (1.66, 1.32, 2.22), "container")
def well(name: str, rng: random.Random) -> bpy.types.Object:
    """2.1 m high with its roof, 1.2 m wide; posts stand at +-X, the crank is at +X."""
    timber = outdoors.weathered_wood(f"{name}_timber", (0.19, 0.14, 0.10))
    beam = outdoors.weathered_wood(f"{name}_beam", (0.21, 0.155, 0.11), grain_axis="X")
    iron = outdoors.wrought_iron(f"{name}_iron")
    parts = _ring(name, rng)
    for side in (-1.0, 1.0):
        post = placed(mesh.bevel_box(f"{name}_post", (0.095, 0.095, 1.72), 0.012, 2), timber, x=side * 0.53)
        parts.append(post)
        for slope in (-1.0, 1.0):
            rafter = mesh.bevel_box(f"{name}_rafter", (0.06, 0.70, 0.06), 0.008, 2)
            pose = Matrix.Translation((side * 0.53, slope * 0.28, 1.845)) @ Matrix.Rotation(
                -slope * 0.62, 4, "X"
            )
            mesh.transform(rafter, pose)
            mesh.set_material(rafter, timber)
            parts.append(rafter)
    for y, z in ((0.0, 2.04), (-0.5, 1.70), (0.5, 1.70)):
        purlin = mesh.bevel_box(f"{name}_purlin", (1.42, 0.055, 0.055), 0.008, 2)
        mesh.move(purlin, y=y, z=z - 0.03)
        mesh.set_material(purlin, beam)
        parts.append(purlin)
    drum = mesh.cylinder(f"{name}_drum", 0.085, 0.86, 18, 0.01)
    mesh.transform(drum, Matrix.Translation((-0.43, 0, 1.18)) @ Matrix.Rotation(math.pi / 2, 4, "Y"))
    mesh.set_material(drum, beam)
    coils = []
    for k in range(9):
        coil = mesh.torus(f"{name}_coil", 0.096, 0.011, 20, 6)
        mesh.transform(
            coil,
            Matrix.Translation((-0.10 + 0.023 * k, 0, 1.18)) @ Matrix.Rotation(math.pi / 2 + 0.05, 4, "Y"),
        )
        coils.append(coil)
    hanging = mesh.tube(
        f"{name}_rope",
        [Vector((0.09, -0.096, 1.18)), Vector((0.085, -0.09, 0.6)), Vector((0.08, -0.08, 0.12))],
        0.011,
        8,
    )
    for part in (*coils, hanging):
        mesh.set_material(part, outdoors.rope(f"{name}_rope"))
    crank_points = [
        (0.40, 0, 1.18),
        (0.70, 0, 1.18),
        (0.715, 0.0, 1.165),
        (0.715, -0.02, 0.94),
        (0.73, -0.02, 0.92),
        (0.90, -0.02, 0.92),
    ]
    crank = mesh.set_material(mesh.tube(f"{name}_crank", [Vector(p) for p in crank_points], 0.016, 8), iron)
    parts += [drum, *coils, hanging, crank]
    parts += _roof(name, rng, eaves_z=1.68, ridge_z=2.10, half_x=0.74, half_y=0.60)
    return mesh.join(name, parts)
