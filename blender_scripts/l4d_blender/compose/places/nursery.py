"""A child's room: a bed or a tent, toys on shelves, a chest, stools round a rug."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...assets import couch
from ..settings import rooms
from . import place

if TYPE_CHECKING:
    from ..stage import Stage

WALLS = ((0.52, 0.62, 0.66), (0.66, 0.58, 0.42), (0.60, 0.48, 0.48), (0.50, 0.60, 0.46), (0.64, 0.62, 0.56))
LEFT_LYING = ("picture_book", "magazine.pile", "cushion", "coffee_table.book_stack")


@place("room", "floor", "chairs")
def nursery(stage: Stage) -> None:
    """Things for children along the walls, two stools to sit on, books left lying at the edge."""
    rng = stage.rng("nursery")
    room = rooms.Room(stage, "nursery", back_m=(0.5, 0.75))
    cloths = rng.sample(rooms.CLOTHS, 5)
    room.window(
        "window",
        ("back", "left", "right"),
        width_m=rng.uniform(1.0, 1.5),
        height_m=rng.uniform(1.0, 1.3),
        sill_m=rng.uniform(0.8, 1.0),
        curtain=cloths[0],
    )
    room.bed("bed", colour=cloths[1])
    room.stand(
        "cabinet.open_shelf",
        "shelf",
        ("back", "left", "right"),
        size_m=(1.1, 0.39, 1.3),
        width_m=1.1,
        height_m=rng.uniform(0.9, 1.2),
        boards=rng.choice((3, 4)),
        content="toys",
        timber=rng.choice(rooms.TIMBERS),
    )
    room.stand(
        "cabinet.chest",
        "chest",
        ("back", "left", "right"),
        size_m=(0.92, 0.47, 0.5),
        colour=cloths[2],
        bands=False,
    )
    if rng.random() < 0.6:
        room.rim(
            "tent",
            "tent",
            size_m=(1.15, 1.5),
            out_m=(0.3, 0.6),
            sides=("left", "right", "back"),
            colour=cloths[3],
        )
    first = len(stage.chairs)
    for k, cloth in enumerate(cloths[3:5]):
        stool = room.rim(
            "couch.pouffe",
            f"stool_{k + 1}",
            seat=True,
            size_m=(0.54, 0.42),
            sides=("left", "right", "back"),
            out_m=(-0.12, 0.06),
            colour=cloth,
            attributes={"colour": cloth},
        )
        if stool is not None:
            room.seat(stool, height_m=couch.POUFFE_SEAT_M, ahead_m=0.04)
    if len(stage.chairs) - first < 2:
        room.reject("stools")
    room.rug(plain=True)
    room.lamp()
    room.door("door", ("back", "left", "right"), style="panels")
    room.pictures(rng.randint(2, 5))
    room.litter(LEFT_LYING, rng.randint(1, 4))
    looks = rooms.shell_looks(
        rng, ("boards", "boards", "carpet"), ("plaster", "wallpaper", "two_tone", "panelled")
    )
    room.finish(**{**looks, "wall_colour": rng.choice(WALLS)})
    stage.tell(f"A child's room {room.mood.words}.")
