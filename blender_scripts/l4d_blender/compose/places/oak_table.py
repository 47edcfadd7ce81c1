"""A bare oak table by a window."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...assets import desk
from ..areas import Area
from ..stage import Seat
from . import place

if TYPE_CHECKING:
    from ..stage import Stage


@place("tabletop", "table")
def oak_table(stage: Stage) -> None:
    """The smallest place there can be: a table, three landmarks, light and cameras."""
    scene, rng = stage.scene, stage.rng("oak table")
    floor_m, size_m = -desk.HEIGHT_M, (rng.uniform(1.2, 1.5), rng.uniform(0.75, 0.9))
    wall_y = size_m[1] / 2 + rng.uniform(0.25, 0.4)
    scene.put("study_room", "room", on=floor_m, rng=rng, wall_y_m=wall_y, window_x_m=(-1.0, 0.4), sill_m=0.86)
    scene.put("desk", "desk", on=floor_m, rng=rng, size_m=size_m)
    table = stage.add_area(Area.rectangle("table", (0.0, 0.0), (0.84, 0.62)))
    for kind, name, radius_m in (("desk_lamp", "lamp", 0.1), ("book", "book", 0.13), ("plant_pot", "plant", 0.14)):
        at = table.spot(rng, radius_m)
        stage.landmark(kind, name, at, rng.uniform(-180, 180), area=table, radius_m=radius_m)
    stage.seats.append(Seat((0.0, -size_m[1] / 2 - 0.12), 180.0, 0.25, 0.2))
    scene.hdri("interior", 0.4, rotation_deg=rng.uniform(0, 360))
    scene.area_light("daylight", (-0.3, wall_y - 0.05, 0.7), (0.0, 0.0, 0.0), size_m=(1.2, 0.9), power_w=30)
    scene.cameras(
        (0.0, 0.0, 0.03), radius_m=0.95, heights_m=(0.45, 0.62), arc_deg=140, facing_deg=-90, fov_deg=50
    )
    stage.tell("A table by a window.")
