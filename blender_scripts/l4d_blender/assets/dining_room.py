"""A dining room at dusk: dark walls, red curtains, a low bookcase as sideboard, a chair nobody sits on.

Owns what stands round a dinner table. Knows nothing of the table; the window wall is at +Y, floor at z = 0.
"""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import bookcase, flower_vase, kitchen_clutter, study_room, wooden_chair
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.placing import place

WALL_Y_M = 1.75
_SIDEBOARD_M = 0.86


@kind("room", (5.33, 4.31, 2.52), "backdrop")
def dining_room(name: str, rng: random.Random) -> list[bpy.types.Object]:
    """Walls and furniture; an area light from the window is the recipe's."""
    walls = study_room.study_room(
        name,
        rng,
        wall_y_m=WALL_Y_M,
        window_x_m=(0.55, 1.75),
        sill_m=0.80,
        wall=(0.33, 0.25, 0.20),
        curtain=(0.26, 0.07, 0.06),
    )
    side = bookcase.bookcase(f"{name}_side", rng, width_m=1.5, height_m=_SIDEBOARD_M, depth_m=0.36, shelves=2)
    flowers = flower_vase.flower_vase(f"{name}_flowers", rng, kinds=(flower_vase.ROSE,))
    plates = kitchen_clutter.plate_stack(f"{name}_plates", rng, colour=(0.55, 0.52, 0.45))
    chair = wooden_chair.wooden_chair(f"{name}_chair", rng)
    place(side, (-0.55, WALL_Y_M - 0.21))
    place(flowers, (-0.25, WALL_Y_M - 0.23), on=_SIDEBOARD_M)
    place(plates, (-0.85, WALL_Y_M - 0.23), on=_SIDEBOARD_M)
    place(chair, (0.10, 0.86), 12.0)
    return [walls, side, flowers, plates, chair]
