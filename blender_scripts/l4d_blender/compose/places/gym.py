"""A gym: mats, benches, racks and wall bars round a free floor."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...assets import gym_equipment
from ..settings import rooms
from . import place

if TYPE_CHECKING:
    from ..stage import Stage


@place("room", "floor", "chairs")
def gym(stage: Stage) -> None:
    """Equipment along the walls, a bench at the rim of the floor, often a mat in its middle."""
    rng = stage.rng("gym")
    room = rooms.Room(
        stage,
        "gym",
        floor_m=((2.9, 3.3), (2.4, 2.7)),
        back_m=(0.5, 0.8),
        moods=("sun", "overcast", "noon", "evening"),
    )
    cloths = rng.sample(rooms.CLOTHS, 4)
    _window(room)
    _bench(room, cloths[0])
    if rng.random() < 0.7:
        room.stand(
            "gym_equipment.wall_bars",
            "wall_bars",
            ("back", "left", "right"),
            size_m=(1.78, 0.2, 2.3),
            origin="back",
            out_m=0.0,
        )
    room.stand("gym_equipment.kettlebell_rack", "rack", ("back", "left", "right"), size_m=(1.35, 0.54, 1.0))
    if rng.random() < 0.5:
        room.stand(
            "gym_equipment.treadmill", "treadmill", ("back", "left", "right"), size_m=(0.86, 1.82, 1.35)
        )
    if rng.random() < 0.5:
        room.stand("gym_equipment.rolled_mats", "mats", ("back", "left", "right"), size_m=(0.44, 0.44, 0.65))
    if rng.random() < 0.6:
        room.stand(
            "gym_equipment.step", "step", ("left", "right", "back"), size_m=(0.74, 0.4, 0.2), colour=cloths[1]
        )
    if rng.random() < 0.5:
        room.stand(
            "cabinet",
            "lockers",
            ("back", "left", "right"),
            size_m=(1.45, 0.48, 1.85),
            width_m=1.4,
            depth_m=0.44,
            height_m=1.8,
            legs_m=0.05,
            colour=cloths[2],
            category="lockers",
        )
    if rng.random() < 0.6:
        at = rng.uniform(-0.4, 0.4), rng.uniform(-0.3, 0.2)
        stage.landmark(
            "gym_equipment.floor_mat",
            "mat",
            at,
            rng.choice((0.0, 90.0, rng.uniform(-8, 8))),
            colour=cloths[3],
        )
    if rng.random() < 0.6:
        room.plant()
    room.door(
        "door", ("back", "left", "right"), style="flush", colour=rng.choice(("blue", "grey", "red", "green"))
    )
    room.clock(z=2.2)
    room.finish(
        **rooms.shell_looks(
            rng, ("rubber", "boards", "boards", "concrete"), ("brick", "two_tone", "two_tone", "plaster")
        )
    )
    stage.tell(f"A gym {room.mood.words}.")


def _bench(room: rooms.Room, colour: str) -> None:
    """One along the rim, with places for two who turn to the middle."""
    bench = room.rim_bench("gym_equipment.bench", "bench", length_m=1.25, depth_m=0.52, colour=colour)
    for along in (-0.32, 0.32):
        room.seat(bench, height_m=gym_equipment.BENCH_TOP_M, ahead_m=0.04, along_m=along)
    if len(room.stage.chairs) < 2:
        room.reject("bench")


def _window(room: rooms.Room) -> None:
    """High up, with many panes."""
    rng = room.rng
    room.window(
        "window",
        ("left", "right", "back"),
        width_m=rng.uniform(1.5, 2.3),
        height_m=rng.uniform(1.0, 1.3),
        sill_m=rng.uniform(1.2, 1.4),
        hanging="bare",
        frame=(0.05, 0.06, 0.06),
    )
