"""A dining table that is nearly bare, for two or three people."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..settings.tabletops import BIRCH, OAK, PAINTED, PINE, WALNUT, Tabletop, wood
from . import place

if TYPE_CHECKING:
    from ..stage import Stage


@place("tabletop", "table", "clear")
def supper_table(stage: Stage) -> None:
    """A table in a dining room; what is on it keeps to its ends."""
    rng = stage.rng("supper table")
    top = Tabletop(stage, "supper table", (rng.uniform(1.2, 1.4), rng.uniform(0.66, 0.72)), widest_m=1.1)
    timber = wood(rng, OAK, WALNUT, PINE, BIRCH, PAINTED)
    stage.scene.put("dining_table", "table", rng=rng, size_m=top.size_m, **timber)
    top.seats("b", "B", "B", **timber)
    top.landmarks(3, "plant", "candle", "coaster", "tin", "jar", "saucer", "herbs", "vase", "jug", aside=True)
    top.clutter(rng.randint(0, 2), "pear", "lemon", "biscuits")
    back = top.room(
        ("boards", "tiles", "chequered"), ("plaster", "wallpaper", "panelled", "tiled"), back_m=(0.9, 1.3)
    )
    top.furnish(
        back,
        ("cabinet", 1.3, {"fronts": rng.choice(("doors", "drawers"))}),
        ("houseplant", 0.9, {}),
        ("floor_lamp", 0.4, {}),
    )
    top.light()
    top.cameras()
    stage.tell(f"A table in a dining room {top.mood.words}.")
