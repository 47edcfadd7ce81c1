"""A living room: a sofa and armchairs round a rug, books, a lamp, a window."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...assets import couch
from ...scene import catalogue
from ..settings import rooms
from . import place

if TYPE_CHECKING:
    from ..stage import Stage


@place("room", "floor", "chairs")
def living_room(stage: Stage) -> None:
    """Sofa at the back wall or a side, an armchair turned to the middle, everything else along the walls."""
    rng = stage.rng("living room")
    room = rooms.Room(stage, "living", back_m=(0.4, 0.6))
    cloths = rng.sample(rooms.CLOTHS, 3)
    width_m = rng.uniform(1.6, 2.2)
    sofa = room.stand(
        "couch",
        "sofa",
        "back",
        size_m=(width_m, 0.89, 0.83),
        width_m=width_m,
        seats=2 if width_m < 1.95 else 3,
        colour=cloths[0],
        cushion=catalogue.COLOURS[cloths[1]] if rng.random() < 0.7 else None,
        arms=rng.choice(("wide", "slim", "low")),
        out_m=0.06,
        near=rng.uniform(-0.7, 0.7),
        must=True,
    )
    assert sofa is not None
    for along_m in (-0.25 * width_m + 0.08, 0.25 * width_m - 0.08):
        room.seat(sofa, height_m=couch.SEAT_M, ahead_m=couch.SEAT_AHEAD_M, along_m=along_m)
    chair = room.rim(
        "couch.easy_chair",
        "armchair",
        seat=True,
        size_m=(0.86, 0.85),
        hidden=0.1,
        colour=cloths[1],
        arms=rng.choice(("wide", "slim", "low")),
    )
    if chair is not None:
        room.seat(chair, height_m=couch.SEAT_M, ahead_m=couch.SEAT_AHEAD_M)
    if len(stage.chairs) < 2:
        room.reject("chairs")
    room.window(
        "window",
        ("left", "right", "back"),
        width_m=rng.uniform(1.0, 1.5),
        height_m=rng.uniform(1.1, 1.4),
        sill_m=rng.uniform(0.65, 0.95),
        curtain=cloths[2],
    )
    tall_m = rng.uniform(1.5, 2.0)
    room.stand(
        "bookcase",
        "bookcase",
        ("back", "left", "right"),
        size_m=(0.85, 0.31, tall_m),
        height_m=tall_m,
        shelves=round(tall_m / 0.34),
    )
    room.lamp()
    if rng.random() < 0.6:
        room.door("door", ("left", "right", "back"), style=rng.choice(("panels", "flush", "glazed")))
    board = None
    if rng.random() < 0.8:
        width_m = rng.uniform(1.0, 1.6)
        board = room.stand(
            "cabinet",
            "cabinet",
            ("left", "right", "back"),
            size_m=(width_m + 0.03, 0.46, 0.8),
            width_m=width_m,
            height_m=rng.uniform(0.6, 0.85),
            fronts=rng.choice(("doors", "drawers")),
            timber=rng.choice(rooms.TIMBERS),
        )
    if board is not None:
        room.decorate(
            board, ("flower_vase", "candle", "coffee_table.book_stack", "biscuit_tin", "wooden_box")
        )
    if rng.random() < 0.85:
        room.plant()
    room.rug()
    room.pictures(rng.randint(1, 4))
    if rng.random() < 0.5:
        room.stand(
            "cabinet.chest",
            "chest",
            ("left", "right", "back"),
            size_m=(0.92, 0.47, 0.5),
            **rooms.words_if(rng.random() < 0.5, colour=cloths[2]),
            bands=rng.random() < 0.5,
        )
    room.finish(
        **rooms.shell_looks(
            rng, ("boards", "boards", "carpet", "tiles"), ("plaster", "wallpaper", "wallpaper", "panelled")
        )
    )
    stage.tell(f"A living room {room.mood.words}.")
