"""A long desk along a window sill, at whose ends people sit."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...assets import desk
from ..settings.tabletops import BIRCH, OAK, PINE, Tabletop, wood
from . import place

if TYPE_CHECKING:
    from ..stage import Stage


@place("tabletop", "table")
def sill_desk(stage: Stage) -> None:
    """A desk pushed against the wall below a window; plants on the sill."""
    rng = stage.rng("sill desk")
    top = Tabletop(stage, "sill desk", (rng.uniform(0.94, 1.02), rng.uniform(0.60, 0.66)), desk.HEIGHT_M)
    stage.scene.put(
        "desk", "desk", on=-desk.HEIGHT_M, rng=rng, size_m=top.size_m, **wood(rng, BIRCH, OAK, PINE)
    )
    top.seats("lr", **wood(rng, BIRCH, OAK))
    top.landmarks(
        rng.choice((3, 4)),
        "lamp",
        "plant",
        "notepad",
        "pen_pot",
        "book",
        "box",
        "mat",
        "coaster",
        "keyboard",
        "tin",
    )
    top.clutter(rng.randint(1, 3), "glasses", "notes", "phone", "ruler", "rubber")
    back = top.room(
        ("boards", "carpet", "tiles"), ("plaster", "boards", "wallpaper", "brick"), back_m=(0.03, 0.08)
    )
    top.light()
    top.cameras()
    stage.tell(f"A desk below a window {top.mood.words}.")
    assert back > top.size_m[1] / 2
