"""A painter's room under the roof or in a loft: an easel, canvases, a couch, shelves."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...assets import couch, wooden_chair
from ..settings import rooms
from . import place

if TYPE_CHECKING:
    from ..stage import Stage


@place("room", "floor", "chairs")
def studio(stage: Stage) -> None:
    """Brick or boards, big windows, an easel at the rim of the floor, somewhere to sit."""
    rng = stage.rng("studio")
    room = rooms.Room(stage, "studio", back_m=(0.45, 0.7))
    cloths = rng.sample(rooms.CLOTHS, 3)
    frame = (0.05, 0.05, 0.05) if rng.random() < 0.5 else (0.62, 0.58, 0.5)
    count = rng.choice((1, 2))
    for k, walls in enumerate((("back", "left", "right"), ("left", "right"))[:count]):
        room.window(
            f"window_{k + 1}" if count > 1 else "window",
            walls,
            width_m=rng.uniform(1.2, 1.8),
            height_m=rng.uniform(1.3, 1.6),
            sill_m=rng.uniform(0.6, 0.9),
            hanging="bare",
            landmark=count == 1,
            frame=frame,
        )
    sofa = room.stand(
        "couch",
        "sofa",
        ("back", "left", "right"),
        size_m=(1.6, 0.89, 0.83),
        width_m=1.6,
        colour=cloths[0],
        arms=rng.choice(("slim", "low")),
    )
    if sofa is not None:
        for along in (-0.35, 0.35):
            room.seat(sofa, height_m=couch.SEAT_M, ahead_m=couch.SEAT_AHEAD_M, along_m=along)
    room.rim("easel", "easel", size_m=(0.75, 1.66), out_m=(0.15, 0.5), hidden=0.12, palette=rng.randrange(3))
    for k in range(2 - len(stage.chairs) // 2):
        chair = room.rim(
            "wooden_chair",
            "chair" if k == 0 else "second_chair",
            seat=True,
            size_m=(0.5, 0.93),
            out_m=(-0.1, 0.1),
            hidden=0.1,
        )
        if chair is not None:
            room.seat(chair, height_m=wooden_chair.SEAT_M, ahead_m=0.05)
    if len(stage.chairs) < 2:
        room.reject("chairs")
    shelf = room.stand(
        "cabinet.open_shelf",
        "shelf",
        ("back", "left", "right"),
        size_m=(1.0, 0.4, 1.9),
        height_m=rng.uniform(1.2, 1.7),
        content=rng.choice(("jars", "boxes")),
        timber=rng.choice(rooms.TIMBERS),
    )
    cabinet = room.stand(
        "cabinet",
        "cabinet",
        ("left", "right", "back"),
        size_m=(1.15, 0.48, 0.8),
        width_m=1.1,
        fronts="drawers",
        **rooms.words_if(rng.random() < 0.5, colour=cloths[1]),
    )
    if cabinet is not None:
        room.decorate(cabinet, ("kitchen_clutter.jar", "flower_vase", "candle", "wooden_box"))
    if shelf is None or rng.random() < 0.8:
        room.plant()
    room.lamp()
    if rng.random() < 0.4:
        room.rug()
    room.pictures(rng.randint(2, 5))
    room.finish(
        **rooms.shell_looks(rng, ("boards", "boards", "concrete"), ("brick", "brick", "boards", "plaster"))
    )
    stage.tell(f"A painter's room {room.mood.words}.")
