"""A laundry in a cellar or at the back of a house: washers, a drying rack, shelves of linen."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..settings import rooms
from . import place

if TYPE_CHECKING:
    from ..stage import Stage


@place("room", "floor")
def laundry(stage: Stage) -> None:
    """One or two washers along a wall, things to dry and iron at the rim, shelves."""
    rng = stage.rng("laundry")
    room = rooms.Room(stage, "laundry", floor_m=((2.8, 3.2), (2.3, 2.7)), back_m=(0.5, 0.75))
    room.stand(
        "laundry.washing_machine",
        "washer",
        ("back", "back", "left", "right"),
        size_m=(0.64, 0.7, 0.86),
        must=True,
        colour=rng.choice(("white", "grey", "beige")),
    )
    if rng.random() < 0.7:
        room.stand(
            "laundry.drying_rack",
            "drying_rack",
            ("left", "right", "back"),
            size_m=(1.28, 0.62, 1.0),
            pieces=rng.randint(3, 8),
        )
    if rng.random() < 0.6:
        room.stand(
            "laundry.ironing_board",
            "ironing_board",
            ("left", "right", "back"),
            size_m=(1.4, 0.45, 0.9),
            colour=rng.choice(rooms.CLOTHS),
        )
    room.stand(
        "cabinet.open_shelf",
        "shelf",
        ("back", "left", "right"),
        size_m=(1.15, 0.4, 1.95),
        width_m=1.1,
        height_m=rng.uniform(1.3, 1.7),
        content=rng.choice(("linen", "linen", "boxes", "jars")),
        timber=rng.choice(rooms.TIMBERS),
    )
    if rng.random() < 0.6:
        width_m = rng.uniform(0.8, 1.3)
        cabinet = room.stand(
            "cabinet",
            "cabinet",
            ("back", "left", "right"),
            size_m=(width_m + 0.03, 0.48, 0.9),
            width_m=width_m,
            height_m=0.88,
            legs_m=0.06,
            colour=rng.choice(("white", "blue", "green", "grey", "beige")),
        )
        if cabinet is not None:
            room.decorate(
                cabinet, ("kitchen_clutter.bottle", "kitchen_clutter.jar", "biscuit_tin", "wooden_box")
            )
    room.window(
        "window",
        ("back", "left", "right"),
        width_m=rng.uniform(0.8, 1.2),
        height_m=rng.uniform(0.6, 0.9),
        sill_m=rng.uniform(1.2, 1.4),
        hanging="bare",
    )
    room.door(
        "door",
        ("back", "left", "right"),
        style=rng.choice(("panels", "flush", "glazed")),
        colour=rng.choice(("white", "blue", "green", "brown")),
    )
    if rng.random() < 0.4:
        room.rug(plain=True)
    if rng.random() < 0.4:
        room.plant()
    if rng.random() < 0.5:
        room.clock()
    room.pendants(rng.choice((1, 2)), spread_m=1.2)
    room.finish(
        **rooms.shell_looks(
            rng,
            ("tiles", "tiles", "chequered", "concrete"),
            ("tiled", "tiled", "brick", "plaster", "two_tone"),
        )
    )
    stage.tell(f"A laundry {room.mood.words}.")
