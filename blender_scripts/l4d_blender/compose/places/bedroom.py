"""A bedroom: a made bed, a wardrobe, a seat at the window."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...assets import couch
from ..settings import rooms
from . import place

if TYPE_CHECKING:
    from ..stage import Stage


@place("room", "floor", "chairs")
def bedroom(stage: Stage) -> None:
    """The bed at a wall or in a corner, a bench or two seats at the rim, a rug in the middle."""
    rng = stage.rng("bedroom")
    room = rooms.Room(stage, "bedroom", back_m=(0.55, 0.8))
    cloths = rng.sample(rooms.CLOTHS, 5)
    room.bed("bed", width_m=rng.choice((0.98, 1.2, 1.45)), colour=cloths[0], timber=rng.choice(rooms.TIMBERS))
    if rng.random() < 0.5:
        bench = room.rim_bench("couch.hall_bench", "bench", length_m=1.32, depth_m=0.42, colour=cloths[1])
        for along in (-0.32, 0.32):
            room.seat(bench, height_m=couch.BENCH_SEAT_M, ahead_m=0.06, along_m=along)
    else:
        for kind, name, size, height_m, ahead_m, cloth in (
            ("couch.easy_chair", "armchair", (0.86, 0.85), couch.SEAT_M, couch.SEAT_AHEAD_M, cloths[1]),
            ("couch.pouffe", "stool", (0.54, 0.42), couch.POUFFE_SEAT_M, 0.04, cloths[2]),
        ):
            chair = room.rim(
                kind, name, size_m=size, hidden=0.1, out_m=(-0.05, 0.15), seat=True, colour=cloth
            )
            if chair is not None:
                room.seat(chair, height_m=height_m, ahead_m=ahead_m)
    if len(stage.chairs) < 2:
        room.reject("chairs")
    room.window(
        "window",
        ("left", "right", "back"),
        width_m=rng.uniform(1.0, 1.5),
        height_m=rng.uniform(1.1, 1.4),
        sill_m=rng.uniform(0.7, 0.95),
        curtain=cloths[3],
        hanging=rng.choice(("curtains", "curtains", "blind")),
    )
    room.stand(
        "cabinet",
        "wardrobe",
        ("back", "left", "right"),
        size_m=(1.25, 0.56, 2.0),
        width_m=1.2,
        depth_m=0.52,
        height_m=rng.uniform(1.8, 2.0),
        legs_m=0.08,
        timber=rng.choice(rooms.TIMBERS),
        category="wardrobe",
        **rooms.words_if(rng.random() < 0.3, colour=cloths[4]),
    )
    if rng.random() < 0.7:
        room.stand("cabinet.chest", "chest", ("back", "left", "right"), size_m=(0.92, 0.47, 0.5))
    room.lamp()
    room.rug()
    if rng.random() < 0.7:
        room.door("door", ("back", "left", "right"), style=rng.choice(("panels", "flush")))
    if rng.random() < 0.6:
        room.plant()
    room.pictures(rng.randint(1, 4))
    room.finish(
        **rooms.shell_looks(
            rng, ("boards", "carpet", "carpet"), ("plaster", "wallpaper", "wallpaper", "panelled")
        )
    )
    stage.tell(f"A bedroom {room.mood.words}.")
