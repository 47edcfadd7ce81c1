"""A table in a cafe."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..settings.tabletops import BIRCH, OAK, WALNUT, Tabletop, wood
from . import place

if TYPE_CHECKING:
    from ..stage import Stage


@place("tabletop", "table")
def cafe_table(stage: Stage) -> None:
    """A small table on one foot; others with their chairs behind it."""
    rng = stage.rng("cafe table")
    top = Tabletop(stage, "cafe table", (rng.uniform(0.98, 1.08), rng.uniform(0.64, 0.68)))
    looks: dict[str, Any] = {
        "top": rng.choice(("wood", "marble", "lacquer")),
        "shape": rng.choice(("square", "round_ended")),
    }
    looks |= {
        "colour": rng.choice(("white", "green", "red", "black", "teal")),
        **wood(rng, OAK, WALNUT, BIRCH),
    }
    stage.scene.put("cafe_table", "table", rng=rng, size_m=top.size_m, **looks)
    chairs = wood(rng, OAK, WALNUT)
    top.seats("lr", "b", "br", "bl", **chairs)
    top.landmarks(
        rng.choice((3, 3, 4)),
        "vase",
        "candle",
        "plate",
        "tray",
        "coaster",
        "napkin",
        "notepad",
        "tin",
        "saucer",
    )
    top.clutter(rng.randint(1, 2), "phone", "glasses", "biscuits")
    back = top.room(
        ("chequered", "tiles", "boards"), ("brick", "two_tone", "panelled", "tiled"), back_m=(1.5, 1.9)
    )
    for k in range(rng.randint(1, 3)):
        at = (-1.5 + 1.5 * k + rng.uniform(-0.15, 0.15), back - rng.uniform(0.55, 0.7))
        stage.dress("cafe_table", f"table_{k + 1}", at, on=0.0, size_m=(0.7, 0.6), **looks)
        for side in (-1, 1):
            turn = side * 90.0 + rng.uniform(-25, 25)
            stage.dress(
                "wooden_chair",
                f"far_chair_{k + 1}_{side + 1}",
                (at[0] + 0.5 * side, at[1]),
                -turn,
                on=-top.height_m,
                **chairs,
            )
    top.light()
    top.cameras()
    stage.tell(f"A table in a cafe {top.mood.words}.")
