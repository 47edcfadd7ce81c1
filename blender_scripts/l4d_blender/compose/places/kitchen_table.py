"""A kitchen table before the units of a kitchen."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...assets import kitchen_units
from ..settings.tabletops import BIRCH, OAK, PAINTED, PINE, Tabletop, wood
from . import place

if TYPE_CHECKING:
    from ..stage import Stage

_FRONTS = ((0.13, 0.20, 0.17), (0.58, 0.56, 0.50), (0.10, 0.15, 0.24), (0.36, 0.21, 0.11), (0.40, 0.12, 0.08))
_STONES = ((0.42, 0.40, 0.37), (0.10, 0.10, 0.105), (0.60, 0.57, 0.52))


@place("tabletop", "table")
def kitchen_table(stage: Stage) -> None:
    """A wooden table where bread is cut and vegetables wait."""
    rng = stage.rng("kitchen table")
    top = Tabletop(stage, "kitchen table", (rng.uniform(1.0, 1.25), rng.uniform(0.66, 0.72)))
    stage.scene.put(
        "dining_table", "table", rng=rng, size_m=top.size_m, **wood(rng, PINE, BIRCH, OAK, PAINTED)
    )
    top.seats("b", "B", "br", "bl", "lr", **wood(rng))
    top.landmarks(
        rng.choice((3, 4)),
        "board",
        "jug",
        "bowl",
        "tin",
        "plate",
        "trivet",
        "herbs",
        "candle",
        "napkin",
        "jar",
    )
    top.clutter(rng.randint(1, 3), "grapes", "pear", "lemon", "biscuits")
    back = top.room(("tiles", "chequered", "boards"), ("tiled", "plaster", "two_tone"), back_m=(1.3, 1.6))
    finish = kitchen_units.Finish(rng.choice(_FRONTS), rng.choice(_STONES))
    stage.scene.put(
        "kitchen_units.base_run",
        "units",
        (rng.uniform(-0.3, 0.3), back - 0.02),
        on=-top.height_m,
        width_m=2.6,
        finish=finish,
    )
    top.light()
    top.cameras()
    stage.tell(f"A kitchen table {top.mood.words}.")
