"""A workshop seen over its bench: whoever works stands behind it and faces the cameras."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...assets import workbench
from .. import rooms
from . import place

if TYPE_CHECKING:
    from ..stage import Stage


@place("room", "counter")
def workshop(stage: Stage) -> None:
    """A carpenter's bench before a wall with tools, shelves, a window."""
    rng = stage.rng("workshop")
    width_m = rng.uniform(1.7, 2.2)
    room = rooms.behind_counter(stage, "workshop", (width_m, workbench.DEPTH_M), workbench.TOP_M, (1.1, 1.4))
    stage.landmark(
        "workbench",
        "workbench",
        (0.0, 0.0),
        width_m=width_m,
        light=rng.choice(rooms.TIMBERS),
        **({"colour": rng.choice(("green", "blue", "grey", "red"))} if rng.random() < 0.4 else {}),
    )
    board_m = rng.uniform(1.2, 1.8)
    room.hang(
        "workbench.tool_board",
        "tool_board",
        "back",
        1.25,
        size_m=(board_m, 0.06, 0.8),
        near=rng.uniform(-0.8, 0.8),
        landmark=True,
        width_m=board_m,
    )
    room.window(
        "window",
        ("left", "right", "back"),
        width_m=rng.uniform(1.0, 1.6),
        height_m=rng.uniform(0.9, 1.2),
        sill_m=rng.uniform(1.1, 1.25),
        hanging="bare",
        columns=3,
        rows=3,
    )
    room.stand(
        "cabinet.open_shelf",
        "shelf",
        ("back", "left", "right"),
        size_m=(1.25, 0.4, 2.0),
        width_m=1.2,
        height_m=rng.uniform(1.4, 1.8),
        content=rng.choice(("boxes", "jars")),
        timber=rng.choice(rooms.TIMBERS),
    )
    cabinet = room.stand(
        "cabinet",
        "cabinet",
        ("back", "left", "right"),
        size_m=(1.2, 0.48, 0.9),
        width_m=1.15,
        height_m=0.85,
        fronts="drawers",
        legs_m=0.05,
        colour=rng.choice(("green", "navy", "grey", "red", "brown")),
    )
    if cabinet is not None:
        room.decorate(
            cabinet, ("wooden_box", "kitchen_clutter.jar", "biscuit_tin", "workshop_clutter.oil_can")
        )
    room.stand(
        "street_furniture.litter_bin",
        "bin",
        ("back", "left", "right"),
        size_m=(0.46, 0.46, 1.0),
        colour=rng.choice(("green", "grey", "blue", "red")),
    )
    room.door(
        "door",
        ("left", "right", "back"),
        style=rng.choice(("panels", "flush")),
        colour=rng.choice(("brown", "green", "grey", "blue")),
    )
    room.pendants(rng.choice((1, 2, 2)), spread_m=0.9)
    if rng.random() < 0.5:
        room.clock()
    room.finish(
        **rooms.shell_looks(
            rng, ("concrete", "boards", "concrete"), ("brick", "boards", "plaster", "two_tone")
        )
    )
    stage.tell(f"A workshop {room.mood.words}.")
