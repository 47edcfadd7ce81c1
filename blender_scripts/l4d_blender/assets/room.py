"""The shell of a living room, open towards -Y and above: floorboards, papered walls, panelling, skirting."""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior
from l4d_blender.assets.materials.base import principled
from l4d_blender.scene.catalogue import kind

WALL_HEIGHT_M = 2.5


@kind("room", (6.2, 4.7, 2.5), "backdrop")
def room(
    name: str,
    rng: random.Random,
    *,
    half_width_m: float = 3.1,
    back_m: float = 1.5,
    front_m: float = -3.2,
    wall: tuple[float, float, float] = (0.44, 0.47, 0.38),
    figure: tuple[float, float, float] = (0.58, 0.60, 0.50),
    boards: tuple[float, float, float] = (0.36, 0.215, 0.115),
) -> list[bpy.types.Object]:
    """[floor, walls, panelling]; walls at x = +-half_width_m and y = back_m, floor to y = front_m."""
    floor = mesh.from_pydata(
        f"{name}_floor",
        [
            (-half_width_m, front_m, 0),
            (half_width_m, front_m, 0),
            (half_width_m, back_m, 0),
            (-half_width_m, back_m, 0),
        ],
        [(0, 1, 2, 3)],
        smooth=False,
    )
    mesh.set_material(floor, interior.floorboards(f"{name}_boards", boards, rng))
    length = back_m - front_m
    paper = interior.wallpaper(f"{name}_paper", wall, figure, rng)
    paint = interior.plaster(f"{name}_plaster", wall, rng)
    walls = [
        _wall(f"{name}_wall_back", 2 * half_width_m, 0.0, (0.0, back_m), paper),
        _wall(f"{name}_wall_left", length, 90.0, (-half_width_m, (back_m + front_m) / 2), paint),
        _wall(f"{name}_wall_right", length, -90.0, (half_width_m, (back_m + front_m) / 2), paint),
    ]
    white = principled(f"{name}_white", (0.70, 0.67, 0.61), roughness=0.5, variation=0.08, bump=(70, 0.0008))
    trim = []
    for span, angle, (x, y) in (
        (2 * half_width_m, 0.0, (0.0, back_m)),
        (length, 90.0, (-half_width_m, (back_m + front_m) / 2)),
        (length, -90.0, (half_width_m, (back_m + front_m) / 2)),
    ):
        for size, z in (
            ((span, 0.022, 0.12), 0.0),
            ((span, 0.010, 0.40), 0.12),
            ((span, 0.030, 0.035), 0.52),
        ):
            rail = mesh.move(mesh.bevel_box(f"{name}_trim", size, 0.006), y=-size[1] / 2, z=z)
            trim.append(mesh.move(mesh.rotate(rail, "Z", angle), x=x, y=y))
        panels = max(1, round(span / 0.62))
        for i in range(panels):
            across = -span / 2 + (i + 0.5) * span / panels
            raised = mesh.move(
                mesh.bevel_box(f"{name}_panel", (span / panels - 0.12, 0.020, 0.28), 0.008),
                x=across,
                y=-0.010,
                z=0.18,
            )
            trim.append(mesh.move(mesh.rotate(raised, "Z", angle), x=x, y=y))
    panelling = mesh.set_material(mesh.join(f"{name}_panelling", trim), white)
    return [floor, *walls, panelling]


def _wall(
    name: str, width: float, angle_deg: float, at: tuple[float, float], material: bpy.types.Material
) -> bpy.types.Object:
    sheet = mesh.from_pydata(
        name,
        [
            (-width / 2, 0, 0),
            (width / 2, 0, 0),
            (width / 2, 0, WALL_HEIGHT_M),
            (-width / 2, 0, WALL_HEIGHT_M),
        ],
        [(0, 1, 2, 3)],
        smooth=False,
    )
    sheet = mesh.move(mesh.rotate(sheet, "Z", angle_deg), x=at[0], y=at[1])
    return mesh.set_material(sheet, material)
