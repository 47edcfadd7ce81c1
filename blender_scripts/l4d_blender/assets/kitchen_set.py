"""A whole fitted kitchen: where its walls, units, fridge and clutter stand.

The back wall is y = BACK_Y, the island's middle near the origin; what stands on the island's middle is the
recipe's business.
"""

from __future__ import annotations

import random
from dataclasses import dataclass

import bpy

from l4d_blender.assets import bookcase, kitchen_room, kitchen_tools
from l4d_blender.assets import kitchen_clutter as clutter
from l4d_blender.assets import kitchen_units as units
from l4d_blender.scene.placing import place

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


def build(
    rng: random.Random,
    *,
    finish: units.Finish,
    wall: tuple[float, float, float],
    tile: tuple[float, float, float],
) -> Kitchen:
    """Fits and fills the kitchen."""
    shell = kitchen_room.kitchen_room(
        "kitchen", rng, half_width_m=HALF_WIDTH, back_m=BACK_Y, front_m=FRONT_Y, wall=wall, tile=tile
    )
    fitted = [
        place(units.base_run("worktop", rng, width_m=4.1, finish=finish, sink_x=-0.33), (0.50, BACK_Y)),
        place(units.base_run("side_worktop", rng, width_m=2.6, finish=finish), (HALF_WIDTH, 0.0), -90),
        place(units.island("island", rng, width_m=ISLAND_WIDTH_M, finish=finish), ISLAND),
        place(units.wall_cupboard("cupboard_0", rng, width_m=0.80, finish=finish), (2.15, BACK_Y), on=1.50),
        place(
            units.wall_cupboard("cupboard_1", rng, width_m=0.90, finish=finish),
            (HALF_WIDTH, 1.05),
            -90,
            on=1.50,
        ),
        place(
            units.wall_cupboard("cupboard_2", rng, width_m=0.90, finish=finish),
            (HALF_WIDTH, 0.10),
            -90,
            on=1.50,
        ),
        place(units.shelf("shelf_0", rng, width_m=0.78), (-1.06, BACK_Y), on=1.70),
        place(units.shelf("shelf_1", rng, width_m=0.72), (1.32, BACK_Y), on=1.72),
        place(kitchen_tools.hanging_rail("rail_0", rng, width_m=0.78), (-1.06, BACK_Y - 0.01), on=1.42),
        place(kitchen_tools.hanging_rail("rail_1", rng, width_m=0.66), (1.32, BACK_Y - 0.01), on=1.44),
        place(bookcase.bookcase("dresser", rng), (-HALF_WIDTH + 0.02, 0.35), 90),
    ]
    return Kitchen(
        fridge=place(units.fridge("fridge", rng, colour=CREAM), (-1.94, BACK_Y - 0.02)),
        sink=place(units.sink("sink", rng), (0.17, BACK_Y), on=units.TOP_M),
        window=place(kitchen_room.window("window", rng, glow=0.8), (0.15, BACK_Y)),
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
        place(clutter.kettle("kettle", rng, colour=(0.12, 0.24, 0.34)), (1.12, back - 0.06), 200, on=top),
        place(kitchen_tools.crock("crock", rng, colour=(0.45, 0.38, 0.28)), (-0.72, back), on=top),
        place(clutter.loaf("loaf", rng), (-1.18, back - 0.08), 20, on=top),
        place(clutter.herb_pot("basil", rng), (-0.28, BACK_Y - 0.12), on=1.16),
        place(clutter.herb_pot("parsley", rng), (0.55, BACK_Y - 0.12), on=1.16),
        place(clutter.plate_stack("plates", rng, colour=(0.66, 0.64, 0.58)), (1.55, back), on=top),
        place(
            clutter.plate_stack("bowls", rng, colour=(0.26, 0.36, 0.44), count=4, radius_m=0.085),
            (1.14, BACK_Y - 0.11),
            on=1.72,
        ),
        place(
            clutter.plate_stack("saucers", rng, colour=(0.62, 0.50, 0.30), count=5, radius_m=0.08),
            (-1.30, BACK_Y - 0.11),
            on=1.70,
        ),
        place(clutter.herb_pot("thyme", rng), (1.98, back), on=top),
        place(clutter.herb_pot("mint", rng), (-0.98, -0.26), on=top),
    ]
    for k, (x, z) in enumerate(((-1.06, 1.70), (-0.90, 1.70), (-0.76, 1.70), (1.36, 1.72), (1.50, 1.72))):
        made.append(
            place(
                clutter.jar(f"jar_{k}", rng, content=food[k], height_m=rng.uniform(0.13, 0.18)),
                (x, BACK_Y - 0.11),
                on=z,
            )
        )
    for k, (x, y) in enumerate(((0.92, back + 0.06), (0.84, back + 0.02), (0.76, back + 0.07))):
        made.append(
            place(
                clutter.bottle(f"bottle_{k}", rng, colour=glass[k], height_m=rng.uniform(0.24, 0.31)),
                (x, y),
                on=top,
            )
        )
    for k, (x, y) in enumerate(((1.03, -0.28), (1.12, -0.24))):
        made.append(place(clutter.bottle(f"oil_{k}", rng, colour=glass[k], height_m=0.25), (x, y), on=top))
    towel = clutter.tea_towel("towel", rng, colours=((0.62, 0.58, 0.50), (0.35, 0.08, 0.06)))
    made.append(place(towel, (-0.75, ISLAND[1] - units.ISLAND_DEPTH_M / 2 - 0.02), on=units.TOP_M - 0.06))
    return made
