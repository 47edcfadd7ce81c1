"""A classroom, seen from the back: a blackboard, pupils' desks moved to the sides, a globe."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...assets import wooden_chair
from ..settings import rooms
from . import place

if TYPE_CHECKING:
    from ..stage import Stage


@place("room", "floor", "chairs")
def classroom(stage: Stage) -> None:
    """The floor before the board is free; chairs stand at its rim, desks and shelves along the walls."""
    rng = stage.rng("classroom")
    room = rooms.Room(stage, "classroom", back_m=(0.3, 0.5), moods=("sun", "morning", "overcast", "noon"))
    width_m = rng.uniform(1.8, 2.4)
    room.hang(
        "school.blackboard",
        "blackboard",
        "back",
        0.95,
        size_m=(width_m + 0.1, 0.1, 1.2),
        near=rng.uniform(-0.5, 0.5),
        landmark=True,
        width_m=width_m,
        slate=rng.choice(((0.03, 0.07, 0.05), (0.03, 0.035, 0.04), (0.04, 0.06, 0.08))),
    )
    room.window(
        "window",
        ("left", "right"),
        width_m=rng.uniform(1.6, 2.2),
        height_m=rng.uniform(1.2, 1.5),
        sill_m=rng.uniform(0.85, 1.0),
        hanging=rng.choice(("bare", "blind")),
        curtain=rng.choice(rooms.CLOTHS),
    )
    room.door(
        "door",
        ("back", "left", "right"),
        style=rng.choice(("flush", "glazed")),
        colour=rng.choice(("blue", "green", "grey", "brown", "white")),
    )
    frame = rng.choice(("navy", "red", "green", "grey"))
    room.stand("school.pupil_desk", "desk", ("left", "right"), size_m=(0.72, 0.52, 0.75), colour=frame)
    for k in range(2):
        chair = room.rim(
            "wooden_chair",
            "chair" if k == 0 else "second_chair",
            size_m=(0.5, 0.93),
            out_m=(-0.1, 0.1),
            hidden=0.1,
            seat=True,
        )
        if chair is not None:
            room.seat(chair, height_m=wooden_chair.SEAT_M, ahead_m=0.05)
    if len(stage.chairs) < 2:
        room.reject("chairs")
    room.stand("school.globe", "globe", ("back", "left", "right"), size_m=(0.5, 0.5, 1.12))
    tall_m = rng.uniform(1.2, 1.9)
    shelf = rng.choice(("bookcase", "cabinet.open_shelf"))
    if shelf == "bookcase":
        room.stand(
            shelf,
            "bookcase",
            ("left", "right", "back"),
            size_m=(0.85, 0.31, tall_m),
            height_m=tall_m,
            shelves=round(tall_m / 0.34),
        )
    else:
        room.stand(
            shelf,
            "shelf",
            ("left", "right", "back"),
            size_m=(1.0, 0.4, 1.8),
            height_m=min(1.6, tall_m),
            content="boxes",
        )
    room.clock(z=2.25)
    if rng.random() < 0.6:
        room.plant()
    if rng.random() < 0.3:
        room.rug(plain=True)
    room.pictures(rng.randint(1, 4), walls=("left", "right"))
    room.finish(
        **rooms.shell_looks(
            rng, ("boards", "chequered", "carpet", "tiles"), ("two_tone", "two_tone", "plaster", "panelled")
        )
    )
    stage.tell(f"A classroom {room.mood.words}.")
