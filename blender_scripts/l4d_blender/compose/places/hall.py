"""The hall of a house or a small office: a door, coats, a bench, a table to put things on."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...assets import chair_row, couch
from ..settings import rooms
from . import place

if TYPE_CHECKING:
    from ..stage import Stage


@place("room", "floor", "chairs")
def hall(stage: Stage) -> None:
    """Where people come and go and wait: a bench or a row of chairs faces the free floor."""
    rng = stage.rng("hall")
    room = rooms.Room(stage, "hall", back_m=(0.35, 0.6))
    cloths = rng.sample(rooms.CLOTHS, 3)
    if rng.random() < 0.5:
        bench = room.rim_bench(
            "couch.hall_bench",
            "bench",
            length_m=1.32,
            depth_m=0.42,
            sides=("back", "left", "right"),
            colour=cloths[0],
        )
        seats, height_m = [-0.32, 0.32], couch.BENCH_SEAT_M
    else:
        bench = room.rim_bench(
            "chair_row", "chairs", length_m=1.9, depth_m=0.54, sides=("back",), count=3, colour=cloths[0]
        )
        seats, height_m = [chair_row.seat_x(k, 3) for k in range(3)], chair_row.SEAT_M
    for along in seats:
        room.seat(bench, height_m=height_m, ahead_m=0.06, along_m=along)
    if len(stage.chairs) < 2:
        room.reject("bench")
    room.door(
        "door",
        ("back", "back", "left", "right"),
        style=rng.choice(("panels", "glazed")),
        colour=rng.choice(("white", "brown", "green", "blue", "red", "grey")),
    )
    room.stand(
        "coat_stand", "coat_stand", ("back", "left", "right"), size_m=(0.6, 0.6, 1.8), coats=rng.randint(1, 3)
    )
    cabinet = room.stand(
        "cabinet",
        "cabinet",
        ("left", "right", "back"),
        size_m=(1.03, 0.42, 0.85),
        width_m=1.0,
        depth_m=0.36,
        height_m=rng.uniform(0.75, 0.85),
        fronts=rng.choice(("drawers", "doors")),
        timber=rng.choice(rooms.TIMBERS),
    )
    if cabinet is not None:
        room.decorate(cabinet, ("flower_vase", "candle", "magazine.pile", "wooden_box"))
    room.window(
        "window",
        ("left", "right", "back"),
        width_m=rng.uniform(0.8, 1.2),
        height_m=rng.uniform(1.1, 1.4),
        sill_m=rng.uniform(0.8, 1.0),
        curtain=cloths[1],
    )
    room.plant()
    if rng.random() < 0.7:
        room.rug()
    if room.mood.lamps_w or rng.random() < 0.4:
        room.lamp()
    if rng.random() < 0.6:
        room.clock(z=1.9)
    room.pictures(rng.randint(1, 4))
    room.finish(
        **rooms.shell_looks(
            rng, ("chequered", "tiles", "boards"), ("panelled", "wallpaper", "plaster", "two_tone")
        )
    )
    stage.tell(f"A hall {room.mood.words}.")
