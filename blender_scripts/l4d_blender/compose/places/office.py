"""An office with a long bench that people stand at, seen from its front."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...assets import high_table
from ..looks import Look
from ..settings import rooms
from ..settings.tabletops import BIRCH, GREY, OAK, PINE, WALNUT, wood
from . import place

if TYPE_CHECKING:
    from ..stage import Stage

TOP_M = 0.97


@place("room", "counter")
def office(stage: Stage) -> None:
    """The bench is free but for a plant; shelves, cabinets and a window are behind its users."""
    rng = stage.rng("office")
    width_m, depth_m = rng.uniform(2.0, 2.5), rng.uniform(0.62, 0.70)
    room = rooms.behind_counter(stage, "office", (width_m, depth_m), TOP_M, (1.05, 1.3))
    scale = TOP_M / high_table.HEIGHT_M
    bench = stage.scene.make(
        "high_table",
        "bench",
        stage.rng("landmark/bench"),
        size_m=(width_m / scale, depth_m / scale),
        **wood(rng, OAK, WALNUT, BIRCH, PINE, GREY),
    )
    stage.scene.place(bench, (0.0, 0.0), scale=scale)
    stage.register(
        "high_table", "table", bench, at=(0.0, 0.0), heading_deg=0.0, area=None, look=_PLAIN, landmark=True
    )
    _wall(room)
    counter, side = stage.area("counter"), rng.choice((-1, 1))
    if rng.random() < 0.6:
        at = side * (width_m / 2 - 0.14), rng.uniform(-0.5, -0.3) * depth_m + 0.12
        stage.landmark("plant_pot", "plant", at, on=TOP_M, area=counter, radius_m=0.12)
    else:
        room.plant()
    room.finish(
        **rooms.shell_looks(
            rng, ("carpet", "carpet", "boards", "concrete"), ("plaster", "plaster", "two_tone", "brick")
        )
    )
    stage.tell(f"An office {room.mood.words}.")


_PLAIN = Look("high_table", {}, {})


def _wall(room: rooms.Room) -> None:
    """What offices have along their walls."""
    rng = room.rng
    room.window(
        "window",
        ("back", "left", "right"),
        width_m=rng.uniform(1.2, 1.9),
        height_m=rng.uniform(1.1, 1.4),
        sill_m=rng.uniform(0.85, 1.0),
        hanging=rng.choice(("bare", "blind", "blind")),
        curtain=rng.choice(rooms.CLOTHS),
    )
    tall_m = rng.uniform(1.2, 1.9)
    room.stand(
        "bookcase",
        "bookcase",
        ("back", "left", "right"),
        size_m=(0.85, 0.31, tall_m),
        height_m=tall_m,
        shelves=round(tall_m / 0.34),
    )
    room.stand(
        "cabinet",
        "cabinet",
        ("back", "left", "right"),
        size_m=(0.95, 0.45, 1.2),
        fronts=rng.choice(("drawers", "doors")),
        width_m=0.95,
    )
    room.clock(z=1.9)
    if rng.random() < 0.6:
        room.door("door", ("left", "right", "back"), style=rng.choice(("flush", "glazed")))
    room.pictures(rng.randint(0, 3), walls=("back", "left", "right"))
