"""A living room: a sofa and armchairs round a rug, books, a lamp, a window."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...assets import floor_lamp, sofa
from .. import rooms
from ..areas import heading_to
from . import place

if TYPE_CHECKING:
    from ..stage import Stage

ARMCHAIR_SEAT_M = 0.44


@place("room", "floor", "chairs")
def living_room(stage: Stage) -> None:
    """Sofa at the back wall or a side, an armchair turned to the middle, everything else along the walls."""
    rng = stage.rng("living room")
    room = rooms.Room(stage, "living", back_m=(0.4, 0.6))
    cloths = rng.sample(rooms.CLOTHS, 3)
    width_m = rng.uniform(1.6, 2.1)
    couch = room.stand(
        "sofa",
        "sofa",
        "back",
        size_m=(width_m, 0.87, 0.85),
        width_m=width_m,
        colour=cloths[0],
        out_m=0.06,
        must=True,
    )
    for along_m in (-0.25 * width_m + 0.08, 0.25 * width_m - 0.08):
        room.seat(couch, height_m=sofa.SEAT_HEIGHT_M, ahead_m=0.13, along_m=along_m)
    _armchair(room, cloths[1])
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
    _lamp(room)
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
            board, ("flower_vase", "candle", "coffee_table.book_stack", "plant_pot", "fruit.fruit_bowl")
        )
    if rng.random() < 0.85:
        tall_m = rng.uniform(0.7, 1.2)
        room.stand(
            "houseplant", "plant", ("back", "left", "right"), size_m=(0.75, 0.75, 1.0), height_m=tall_m
        )
    _rug(room)
    _pictures(room)
    if rng.random() < 0.5:
        room.stand("toy_chest", "chest", ("left", "right"), size_m=(0.76, 0.52, 0.6), colour=cloths[2])
    room.finish(
        **rooms.shell_looks(
            rng, ("boards", "boards", "carpet", "tiles"), ("plaster", "wallpaper", "wallpaper", "panelled")
        )
    )
    stage.tell(f"A living room {room.mood.words}.")


def _armchair(room: rooms.Room, colour: str) -> None:
    """At a side of the floor, turned to its middle."""
    rng = room.rng
    side = rng.choice((-1, 1))
    x, y = side * (room.floor_width_m / 2 + 0.12), rng.uniform(0.0, room.floor_depth_m / 2 - 0.35)
    at, inner = (x, y), (rng.uniform(-0.3, 0.3), rng.uniform(-0.5, 0.1))
    box = rooms.Box((x - 0.42, x + 0.42), (y - 0.42, y + 0.42), (0.0, 0.92))
    if any(box.meets(other) for other in room.taken) or room.hides(box, 0.1):
        x = -x
        box = rooms.Box((x - 0.42, x + 0.42), (y - 0.42, y + 0.42), (0.0, 0.92))
        at = (x, y)
        if any(box.meets(other) for other in room.taken) or room.hides(box, 0.1):
            return
    room.beside(box)
    chair = room.stage.landmark(
        "armchair", "armchair", at, heading_to(at, inner), area=room.floor, radius_m=0.36, colour=colour
    )
    room.seat(chair, height_m=ARMCHAIR_SEAT_M, ahead_m=0.16)


def _lamp(room: rooms.Room) -> None:
    lamp = room.stand(
        "floor_lamp",
        "lamp",
        ("back", "left", "right"),
        size_m=(0.42, 0.42, 1.35),
        glow=1.4 if room.mood.lamps_w else 0.5,
    )
    if lamp is not None:
        room.bulbs.append((*lamp.at, floor_lamp.SHADE_HEIGHT_M + 0.02))


def _rug(room: rooms.Room) -> None:
    """Under everybody's feet, not quite in the middle."""
    rng = room.rng
    size = rng.uniform(1.7, 2.3), rng.uniform(1.2, 1.6)
    at = rng.uniform(-0.25, 0.25), rng.uniform(-0.2, 0.2)
    room.stage.landmark("rug", "rug", at, rng.uniform(-6, 6), size_m=size, palette=rng.choice("012"))


def _pictures(room: rooms.Room) -> None:
    rng = room.rng
    for k in range(rng.randint(1, 4)):
        size = rng.uniform(0.3, 0.6), rng.uniform(0.35, 0.6)
        z = rng.uniform(1.3, 1.5)
        room.hang(
            "picture_frame",
            f"picture_{k + 1}",
            ("back", "left", "right"),
            z,
            size_m=(size[0], 0.03, size[1]),
            landmark=False,
            palette=rng.randrange(3),
        )
