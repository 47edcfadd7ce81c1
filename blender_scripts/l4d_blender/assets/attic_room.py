"""An attic at dusk: board floor, knee wall, sloping roof boards on rafters, a brick chimney, a small window.

Owns what is fixed to the building and the trunk and boxes under its eaves. Floor at z = 0; the knee wall is
at -X, the gable with the window at +Y; open towards +X and -Y.
"""

from __future__ import annotations

import random
from math import hypot

import bpy
from mathutils import Matrix

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior, products
from l4d_blender.assets.materials.base import Nodes, emission, principled
from l4d_blender.assets.parts import Parts, placed
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.colour import Colour

KNEE_M = 0.95
BOARD: Colour = (0.27, 0.165, 0.09)


@kind("room", (4.4, 4.2, 2.6), "backdrop")
def attic_room(
    name: str, rng: random.Random, *, knee_x_m: float = -1.75, gable_y_m: float = 1.45, dusk: float = 1.6
) -> list[bpy.types.Object]:
    """[floor, eaves, gable, chimney, lumber]."""
    floor = mesh.from_pydata(
        f"{name}_floor",
        [(-2.2, -2.2, 0), (2.2, -2.2, 0), (2.2, 2.0, 0), (-2.2, 2.0, 0)],
        [(0, 1, 2, 3)],
        smooth=False,
    )
    mesh.set_material(floor, interior.floorboards(f"{name}_floor", (0.25, 0.15, 0.085), rng))
    return [
        floor,
        _eaves(name, rng, knee_x_m, gable_y_m),
        _gable(name, rng, gable_y_m, dusk),
        _chimney(name, rng, (knee_x_m + 0.32, gable_y_m - 0.28)),
        _lumber(name, rng, knee_x_m),
    ]


def _eaves(name: str, rng: random.Random, x: float, back: float) -> bpy.types.Object:
    """The knee wall and the roof that rises from it, both boarded, with rafters."""
    boards = interior.floorboards(f"{name}_boards", BOARD, rng)
    beam = products.wood(f"{name}_beam", (0.24, 0.14, 0.07), (0.12, 0.065, 0.03), rng, grain_axis="X")
    run, rise, length = 1.5, 1.5, back + 2.2
    middle = 0.5 * (back - 2.2)
    wall = mesh.grid(f"{name}_knee", length, KNEE_M, 1, 1)
    mesh.transform(
        wall,
        Matrix.Translation((x, middle, 0.5 * KNEE_M))
        @ Matrix.Rotation(1.5708, 4, "Z")
        @ Matrix.Rotation(1.5708, 4, "X"),
    )
    roof = mesh.from_pydata(
        f"{name}_roof",
        [
            (x, -2.2, KNEE_M),
            (x, back, KNEE_M),
            (x + run, back, KNEE_M + rise),
            (x + run, -2.2, KNEE_M + rise),
        ],
        [(0, 1, 2, 3)],
        smooth=False,
    )
    parts = [mesh.set_material(wall, boards), mesh.set_material(roof, boards)]
    for k in range(5):
        y = back - 0.25 - 0.72 * k
        rafter = mesh.bevel_box(f"{name}_rafter", (hypot(run, rise), 0.075, 0.11), 0.006)
        mesh.transform(
            rafter,
            Matrix.Translation((x, y, KNEE_M - 0.02))
            @ Matrix.Rotation(-0.7854, 4, "Y")
            @ Matrix.Translation((0.5 * hypot(run, rise), 0.0, -0.10)),
        )
        post = mesh.bevel_box(f"{name}_post", (0.07, 0.075, KNEE_M), 0.006)
        parts += [mesh.set_material(rafter, beam), mesh.set_material(mesh.move(post, x=x + 0.035, y=y), beam)]
    return mesh.join(f"{name}_eaves", parts)


def _gable(name: str, rng: random.Random, y: float, dusk: float) -> bpy.types.Object:
    """A limewashed wall with a small window onto the evening sky."""
    lime = products.plaster(f"{name}_lime", (0.36, 0.33, 0.28), rng)
    frame = products.lacquer(f"{name}_frame", (0.30, 0.29, 0.25), rng)
    parts = Parts(f"{name}_gable")
    parts.box("gable", lime, (4.4, 0.08, 2.6), 0.004, y=y + 0.05)
    sky = mesh.box(f"{name}_sky", (0.62, 0.01, 0.62))
    parts.add(sky, emission(f"{name}_dusk", (0.34, 0.42, 0.62), dusk), x=0.25, y=y, z=0.98)
    for x, z, w, h in (
        (0.25, 0.95, 0.72, 0.05),
        (0.25, 1.58, 0.72, 0.05),
        (-0.08, 0.95, 0.05, 0.66),
        (0.58, 0.95, 0.05, 0.66),
        (0.25, 1.27, 0.64, 0.025),
        (0.25, 0.98, 0.025, 0.62),
    ):
        parts.box("bar", frame, (w, 0.05, h), 0.005, x=x, y=y - 0.01, z=z)
    return parts.join()


def _chimney(name: str, rng: random.Random, at: tuple[float, float]) -> bpy.types.Object:
    """A flue of old bricks."""
    material = principled(f"{name}_bricks", (0.30, 0.11, 0.07), roughness=0.9)
    n = Nodes(material)
    x, y, z = n.separate(n.object_coords())
    around = n.combine(n.math("ADD", x, y), z, 0.0)
    tone, joint = n.brick(
        1.0,
        ((0.30, 0.10, 0.06), (0.21, 0.085, 0.06)),
        (0.34, 0.31, 0.27),
        vector=around,
        width=0.23,
        height=0.075,
        mortar_size=0.008,
    )
    soot = n.noise(7.0, 4.0)
    n.set("Base Color", n.mix(n.map_range(soot, 0.45, 0.75, 0.0, 0.7), tone, (0.06, 0.05, 0.045)))
    n.bump(n.math("SUBTRACT", n.noise(60.0, 3.0), n.math("MULTIPLY", joint, 1.5)), 0.6, 0.006)
    flue = mesh.bevel_box(f"{name}_chimney", (0.56, 0.46, 2.4), 0.008)
    return placed(flue, material, x=at[0], y=at[1])


def _lumber(name: str, rng: random.Random, x: float) -> bpy.types.Object:
    """A trunk with iron bands, cardboard boxes and a rolled carpet along the knee wall."""
    oak = products.wood(f"{name}_trunk", (0.24, 0.13, 0.06), (0.12, 0.06, 0.03), rng, grain_axis="Y")
    iron = products.metal(f"{name}_iron", (0.12, 0.12, 0.12), rng, roughness=0.5)
    card = products.paper(f"{name}_card", (0.36, 0.24, 0.13), rng)
    cloth = products.woven_cloth(f"{name}_cloth", (0.26, 0.07, 0.06), rng)
    parts = Parts(f"{name}_lumber")
    parts.box("trunk", oak, (0.45, 0.85, 0.46), 0.02, x=x + 0.30, y=-0.15)
    for y in (-0.45, -0.15, 0.15):
        parts.box("band", iron, (0.456, 0.035, 0.466), 0.02, x=x + 0.30, y=y)
    for size, at, turn in (
        ((0.40, 0.45, 0.34), (x + 0.30, -0.98, 0.0), 7),
        ((0.32, 0.34, 0.26), (x + 0.30, -0.94, 0.34), -12),
        ((0.36, 0.40, 0.30), (x + 0.34, 0.62, 0.0), 14),
    ):
        box = mesh.bevel_box(f"{name}_box", size, 0.004)
        mesh.move(mesh.rotate(box, "Z", turn), *at)
        parts.add(box, card)
    roll = mesh.cylinder(f"{name}_roll", 0.075, 1.1, 24, bevel_m=0.01)
    mesh.move(mesh.rotate(roll, "X", 82.0), x=x + 0.62, y=-0.85, z=0.076)
    parts.add(roll, cloth)
    return parts.join()
