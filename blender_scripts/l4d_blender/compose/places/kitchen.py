"""A kitchen seen over its island: cooks stand behind it and face the cameras."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ...assets import kitchen_units
from ..areas import Area
from ..settings import rooms
from . import place

if TYPE_CHECKING:
    from ..stage import Stage

FRONTS = (
    (0.13, 0.20, 0.17),
    (0.58, 0.56, 0.50),
    (0.10, 0.15, 0.24),
    (0.36, 0.21, 0.11),
    (0.44, 0.30, 0.16),
    (0.30, 0.31, 0.31),
    (0.40, 0.12, 0.08),
)
STONES = ((0.42, 0.40, 0.37), (0.10, 0.10, 0.105), (0.60, 0.57, 0.52), (0.36, 0.22, 0.11))
CLUTTER = (
    "kitchen_clutter.jar",
    "kitchen_clutter.bottle",
    "kitchen_clutter.plate_stack",
    "kitchen_clutter.loaf",
    "biscuit_tin",
)


@place("room", "counter", "hob")
def kitchen(stage: Stage) -> None:
    """An island before a run of units with a sink, a fridge, cupboards or shelves, a window."""
    rng = stage.rng("kitchen")
    width_m = rng.uniform(1.8, 2.4)
    size_m = width_m, kitchen_units.ISLAND_DEPTH_M
    room = rooms.behind_counter(stage, "kitchen", size_m, kitchen_units.TOP_M, (1.05, 1.3))
    finish = kitchen_units.Finish(rng.choice(FRONTS), rng.choice(STONES))
    stage.landmark("kitchen_units.island", "island", (0.0, 0.0), width_m=width_m, finish=finish)
    _units(room, finish)
    _wall(room)
    room.pendants(rng.randint(1, 3), (0.0, -0.05), spread_m=0.3 * width_m)
    _on_counter(stage, stage.area("counter"))
    room.finish(
        **rooms.shell_looks(
            rng, ("tiles", "tiles", "boards", "chequered"), ("tiled", "tiled", "plaster", "panelled")
        )
    )
    stage.tell(f"A kitchen {room.mood.words}.")


def _units(room: rooms.Room, finish: kitchen_units.Finish) -> None:
    """A fridge at one end of a run of units along the back wall."""
    rng = room.rng
    end = rng.choice((-1, 1))
    fridge = room.stand(
        "kitchen_units.fridge",
        "fridge",
        "back",
        size_m=(0.7, 0.7, 1.76),
        near=end * rng.uniform(1.5, 2.2),
        origin="back",
        out_m=0.02,
        colour=rng.choice(("white", "beige", "grey", "red", "teal", "yellow", "black")),
    )
    if fridge is None:
        return
    length = rng.uniform(2.0, 2.6)
    at = fridge.at[0] - end * (length / 2 + 0.37)
    sink_x = rng.uniform(-0.3, 0.3) * length
    room.stage.landmark(
        "kitchen_units.base_run",
        "worktop",
        (at, room.back_m - 0.02),
        width_m=length,
        finish=finish,
        sink_x=sink_x,
    )
    room.beside(rooms.Box((at - length / 2, at + length / 2), (room.back_m - 0.64, room.back_m), (0.0, 1.0)))
    room.stage.landmark(
        "kitchen_units.sink",
        "sink",
        (at + sink_x, room.back_m - 0.02 - kitchen_units.DEPTH_M / 2),
        on=kitchen_units.TOP_M,
    )
    for k in range(rng.randint(2, 5)):
        x = at + length * ((k + 0.5) / 5 - 0.5) + rng.uniform(-0.1, 0.1)
        if abs(x - at - sink_x) > 0.45:
            spot = x, room.back_m - rng.uniform(0.18, 0.4)
            room.stage.dress(
                rng.choice(CLUTTER), f"ware_{k + 1}", spot, rng.uniform(-180, 180), on=kitchen_units.TOP_M
            )


def _wall(room: rooms.Room) -> None:
    """A window, then cupboards or shelves where there is room, a clock or a picture."""
    rng = room.rng
    room.window(
        "window",
        ("back", "back", "left", "right"),
        width_m=rng.uniform(0.9, 1.4),
        height_m=rng.uniform(0.8, 1.1),
        sill_m=rng.uniform(1.1, 1.2),
        hanging=rng.choice(("bare", "blind")),
        curtain=rng.choice(rooms.CLOTHS),
    )
    kind, z = rng.choice((("kitchen_units.wall_cupboard", 1.45), ("kitchen_units.shelf", 1.55)))
    looks: dict[str, Any] = (
        {"finish": kitchen_units.Finish(rng.choice(FRONTS))} if kind.endswith("cupboard") else {}
    )
    for k in range(rng.randint(1, 3)):
        found = room.hang(
            kind,
            f"{kind.rpartition('_')[2].rpartition('.')[2]}_{k + 1}",
            "back",
            z,
            size_m=(0.88, 0.4, 0.78),
            **looks,
        )
        if found is None and k == 0:
            break
    room.clock(z=1.9)
    if rng.random() < 0.6:
        room.door("door", ("left", "right"), style=rng.choice(("panels", "glazed")))
    if rng.random() < 0.6:
        room.plant()


def _on_counter(stage: Stage, counter: Area) -> None:
    """A few things at the ends of the island, which leave its middle free."""
    rng = stage.rng("kitchen/on counter")
    side = rng.choice((-1, 1))
    x = side * (abs(counter.corners[0][0]) - 0.17)
    if not any(prop.name == "plant" for prop in stage.landmarks):
        stage.landmark(
            rng.choice(("kitchen_clutter.herb_pot", "plant_pot")),
            "plant",
            (x, rng.uniform(-0.2, -0.05)),
            on=counter.on,
            area=counter,
            radius_m=0.13,
        )
    if rng.random() < 0.7:
        kind = rng.choice(("kitchen_clutter.loaf", "flower_vase", "candle"))
        at = -x, rng.uniform(-0.15, 0.1)
        stage.dress(kind, "thing", at, on=counter.on, area=counter, radius_m=0.16)
