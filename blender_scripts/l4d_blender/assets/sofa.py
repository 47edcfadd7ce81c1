"""A two-seat sofa: plinth, arms, seat and back cushions, wooden feet."""

from __future__ import annotations

import random

import bpy

from l4d_blender.assets import cushion, mesh
from l4d_blender.assets.materials import interior
from l4d_blender.assets.parts import CORNERS, Parts
from l4d_blender.scene.catalogue import colours, kind

SEAT_HEIGHT_M = 0.43


@kind("sofa", (1.75, 0.863, 0.846), "seat", front="-y", colour=colours("colour"))
def sofa(
    name: str,
    rng: random.Random,
    *,
    colour: tuple[float, float, float] = (0.10, 0.19, 0.21),
    width_m: float = 1.75,
    depth_m: float = 0.86,
    seats: int = 2,
) -> bpy.types.Object:
    """Seats at `SEAT_HEIGHT_M`; the back stands at +Y."""
    cloth = interior.cloth(f"{name}_cloth", colour, rng)
    legs = interior.wood(f"{name}_legs", (0.20, 0.10, 0.05), rng, grain_axis="Z")
    arm, back, foot = 0.17, 0.20, 0.10
    parts = Parts(name)
    parts.add(
        cushion.block(
            f"{name}_plinth", rng, size_m=(width_m - 0.04, depth_m - 0.06, 0.20), bevel_m=0.03, puff_m=0.0
        ),
        y=0.02,
        z=foot,
    )
    for side in (-1, 1):
        parts.add(
            cushion.block(f"{name}_arm", rng, size_m=(arm, depth_m, 0.50), bevel_m=0.06, puff_m=0.02),
            x=side * (width_m - arm) / 2,
            z=foot,
        )
    seat_width = (width_m - 2 * arm) / seats
    for i in range(seats):
        x = -(width_m - 2 * arm) / 2 + seat_width * (i + 0.5)
        seat = cushion.block(
            f"{name}_seat",
            rng,
            size_m=(seat_width - 0.008, depth_m - back - 0.02, 0.15),
            bevel_m=0.045,
            puff_m=0.012,
        )
        parts.add(seat, x=x, y=-back / 2 - 0.01, z=SEAT_HEIGHT_M - 0.158)
        rest = cushion.block(
            f"{name}_rest", rng, size_m=(seat_width - 0.01, 0.17, 0.42), bevel_m=0.06, puff_m=0.02
        )
        parts.add(rest, x=x, y=depth_m / 2 - back - 0.03, z=SEAT_HEIGHT_M - 0.02, turn=("X", -10))
    parts.add(
        cushion.block(f"{name}_back", rng, size_m=(width_m - 0.06, 0.16, 0.66), bevel_m=0.05, puff_m=0.01),
        y=depth_m / 2 - 0.08,
        z=foot,
    )
    for part in parts:
        mesh.set_material(part, cloth)
    for x, y in CORNERS:
        leg = mesh.cylinder(f"{name}_foot", 0.018, foot + 0.02, 16, top_radius=0.028)
        parts.add(leg, legs, x=x * (width_m / 2 - 0.10), y=y * (depth_m / 2 - 0.10))
    return parts.join()
