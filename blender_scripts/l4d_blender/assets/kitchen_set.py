"""A whole fitted kitchen: where its walls, units, fridge and clutter stand.

The back wall is y = BACK_Y, the island's middle near the origin; what stands on the island's middle is the
recipe's business.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from math import radians

import bpy
from mathutils import Matrix

from l4d_blender.assets import bookcase, kitchen_room, kitchen_tools
from l4d_blender.assets import kitchen_clutter as clutter
from l4d_blender.assets import kitchen_units as units

HALF_WIDTH, BACK_Y, FRONT_Y = 2.6, 1.95, -3.3
ISLAND = (0.06, -0.07)
ISLAND_WIDTH_M = 2.35
CREAM = (0.62, 0.60, 0.50)


@dataclass(frozen=True)
class Kitchen:
    """What relations may name, and the rest."""

    fridge: bpy.types.Object
    sink: bpy.types.Object
    window: bpy.types.Object
    scenery: list[bpy.types.Object]


def put(obj: bpy.types.Object, x: float, y: float, z: float = 0.0, turn_deg: float = 0.0) -> bpy.types.Object:
    """Stands an asset somewhere, turned about the vertical."""
    obj.matrix_basis = Matrix.Translation((x, y, z)) @ Matrix.Rotation(radians(turn_deg), 4, "Z")
    return obj


def build(
    rng: random.Random,
    *,
    finish: units.Finish,
    wall: tuple[float, float, float],
    tile: tuple[float, float, float],
) -> Kitchen:
    """Fits and fills the kitchen."""
    shell = kitchen_room.build(
        "kitchen", rng, half_width_m=HALF_WIDTH, back_m=BACK_Y, front_m=FRONT_Y, wall=wall, tile=tile
    )
    fitted = [
        put(units.base_run("worktop", rng, width_m=4.1, finish=finish, sink_x=-0.33), 0.50, BACK_Y),
        put(
            units.base_run("side_worktop", rng, width_m=2.6, finish=finish),
            HALF_WIDTH,
            0.0,
            0.0,
            -90,
        ),
        put(units.island("island", rng, width_m=ISLAND_WIDTH_M, finish=finish), *ISLAND),
        put(units.wall_cupboard("cupboard_0", rng, width_m=0.80, finish=finish), 2.15, BACK_Y, 1.50),
        put(units.wall_cupboard("cupboard_1", rng, width_m=0.90, finish=finish), HALF_WIDTH, 1.05, 1.50, -90),
        put(units.wall_cupboard("cupboard_2", rng, width_m=0.90, finish=finish), HALF_WIDTH, 0.10, 1.50, -90),
        put(units.shelf("shelf_0", rng, width_m=0.78), -1.06, BACK_Y, 1.70),
        put(units.shelf("shelf_1", rng, width_m=0.72), 1.32, BACK_Y, 1.72),
        put(kitchen_tools.hanging_rail("rail_0", rng, width_m=0.78), -1.06, BACK_Y - 0.01, 1.42),
        put(kitchen_tools.hanging_rail("rail_1", rng, width_m=0.66), 1.32, BACK_Y - 0.01, 1.44),
        put(bookcase.build("dresser", rng), -HALF_WIDTH + 0.02, 0.35, 0.0, 90),
    ]
    return Kitchen(
        fridge=put(units.fridge("fridge", rng, colour=CREAM), -1.94, BACK_Y - 0.02),
        sink=put(units.sink("sink", rng), 0.17, BACK_Y, units.TOP_M),
        window=put(kitchen_room.window("window", rng, glow=0.8), 0.15, BACK_Y),
        scenery=[*shell, *fitted, *_clutter(rng)],
    )


def _clutter(rng: random.Random) -> list[bpy.types.Object]:
    """Jars, bottles, plates, herbs on worktops, sill and shelves, and at the island's ends."""
    top, back = units.TOP_M, BACK_Y - 0.20
    glass = ((0.10, 0.13, 0.03), (0.30, 0.17, 0.03), (0.09, 0.05, 0.02))
    food = (
        (0.58, 0.44, 0.24),
        (0.50, 0.20, 0.07),
        (0.62, 0.56, 0.42),
        (0.20, 0.11, 0.06),
        (0.55, 0.36, 0.06),
    )
    made = [
        put(clutter.kettle("kettle", rng, colour=(0.12, 0.24, 0.34)), 1.12, back - 0.06, top, 200),
        put(kitchen_tools.crock("crock", rng, colour=(0.45, 0.38, 0.28)), -0.72, back, top),
        put(clutter.loaf("loaf", rng), -1.18, back - 0.08, top, 20),
        put(clutter.herb_pot("basil", rng), -0.28, BACK_Y - 0.12, 1.16),
        put(clutter.herb_pot("parsley", rng), 0.55, BACK_Y - 0.12, 1.16),
        put(clutter.plate_stack("plates", rng, colour=(0.66, 0.64, 0.58)), 1.55, back, top),
        put(
            clutter.plate_stack("bowls", rng, colour=(0.26, 0.36, 0.44), count=4, radius_m=0.085),
            1.14,
            BACK_Y - 0.11,
            1.72,
        ),
        put(
            clutter.plate_stack("saucers", rng, colour=(0.62, 0.50, 0.30), count=5, radius_m=0.08),
            -1.30,
            BACK_Y - 0.11,
            1.70,
        ),
        put(clutter.herb_pot("thyme", rng), 1.98, back, top),
        put(clutter.herb_pot("mint", rng), -0.98, -0.26, top),
    ]
    for k, (x, z) in enumerate(((-1.06, 1.70), (-0.90, 1.70), (-0.76, 1.70), (1.36, 1.72), (1.50, 1.72))):
        made.append(
            put(
                clutter.jar(f"jar_{k}", rng, content=food[k], height_m=rng.uniform(0.13, 0.18)),
                x,
                BACK_Y - 0.11,
                z,
            )
        )
    for k, (x, y) in enumerate(((0.92, back + 0.06), (0.84, back + 0.02), (0.76, back + 0.07))):
        made.append(
            put(
                clutter.bottle(f"bottle_{k}", rng, colour=glass[k], height_m=rng.uniform(0.24, 0.31)),
                x,
                y,
                top,
            )
        )
    for k, (x, y) in enumerate(((1.03, -0.28), (1.12, -0.24))):
        made.append(put(clutter.bottle(f"oil_{k}", rng, colour=glass[k], height_m=0.25), x, y, top))
    towel = clutter.tea_towel("towel", rng, colours=((0.62, 0.58, 0.50), (0.35, 0.08, 0.06)))
    made.append(put(towel, -0.75, ISLAND[1] - units.ISLAND_DEPTH_M / 2 - 0.02, units.TOP_M - 0.06))
    return made
