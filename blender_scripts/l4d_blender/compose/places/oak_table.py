"""An oak table in a living room."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..settings.tabletops import OAK, WALNUT, Tabletop, wood
from . import place

if TYPE_CHECKING:
    from ..stage import Stage


@place("tabletop", "table")
def oak_table(stage: Stage) -> None:
    """A bare table by a window, with what a family leaves on it."""
    rng = stage.rng("oak table")
    top = Tabletop(stage, "oak table", (rng.uniform(1.05, 1.25), rng.uniform(0.64, 0.70)))
    timber = wood(rng, OAK, OAK, WALNUT)
    stage.scene.put("dining_table", "table", rng=rng, size_m=top.size_m, **timber)
    top.seats("b", "B", "br", "bl", "lr", **timber)
    top.landmarks(
        rng.choice((3, 4)), "lamp", "book", "plant", "candle", "tray", "tin", "vase", "coaster", "notepad"
    )
    top.clutter(rng.randint(1, 3), "magazine", "glasses", "phone", "pear", "lemon", "rubber")
    back = top.room(("boards", "boards", "carpet"), ("plaster", "wallpaper", "panelled"), back_m=(0.9, 1.3))
    top.furnish(
        back,
        ("cabinet", 1.3, {"fronts": rng.choice(("doors", "drawers"))}),
        ("armchair", 0.8, {"colour": rng.choice(("green", "red", "blue", "beige"))}),
        ("floor_lamp", 0.4, {}),
    )
    top.light()
    top.cameras()
    stage.tell(f"An oak table in a living room {top.mood.words}.")
