"""A workbench in a workshop."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..settings.tabletops import GREY, OAK, PINE, Tabletop, wood
from . import place

if TYPE_CHECKING:
    from ..stage import Stage


@place("tabletop", "table")
def workbench(stage: Stage) -> None:
    """A worn bench with tools, tins and boxes, under a lamp."""
    rng = stage.rng("workbench")
    top = Tabletop(stage, "workbench", (rng.uniform(1.15, 1.3), rng.uniform(0.62, 0.68)), 0.74)
    stage.scene.put("dining_table", "bench", rng=rng, size_m=top.size_m, **wood(rng, GREY, PINE, OAK))
    top.seats("b", "B", "br", "bl", chair=rng.choice(("wooden_chair", None)))
    top.landmarks(
        rng.choice((3, 4)), "box", "lamp", "tin", "oil_can", "jar", "notepad", "pen_pot", "tray", "book"
    )
    top.clutter(rng.randint(3, 5), "parts", "screwdriver", "spool", "ruler", "rubber", "glasses")
    back = top.room(
        ("concrete", "boards", "tiles"), ("brick", "boards", "brick", "plaster"), back_m=(0.9, 1.2)
    )
    top.furnish(
        back,
        ("cabinet", 1.4, {"fronts": "drawers", "width_m": 1.4, "height_m": 0.9}),
        ("farm_tools.ladder", 0.5, {}),
        ("bucket", 0.4, {"look": rng.choice(("galvanised", "red", "blue"))}),
        ("toy_chest", 0.8, {"colour": rng.choice(("brown", "grey", "green"))}),
    )
    top.light()
    top.cameras()
    stage.tell(f"A workbench {top.mood.words}.")
