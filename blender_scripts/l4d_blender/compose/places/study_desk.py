"""A study desk, at which somebody works facing the room."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...assets import desk
from ..settings.tabletops import BIRCH, OAK, PAINTED, WALNUT, Tabletop, wood
from . import place

if TYPE_CHECKING:
    from ..stage import Stage


@place("tabletop", "table")
def study_desk(stage: Stage) -> None:
    """A desk with what one writes with, its owner with the back to a wall of shelves or a window."""
    rng = stage.rng("study desk")
    top = Tabletop(stage, "study desk", (rng.uniform(1.1, 1.3), rng.uniform(0.64, 0.70)), desk.HEIGHT_M)
    stage.scene.put(
        "desk",
        "desk",
        on=-desk.HEIGHT_M,
        heading_deg=180.0,
        rng=rng,
        size_m=top.size_m,
        **wood(rng, OAK, WALNUT, BIRCH, PAINTED),
    )
    top.seats(
        "b",
        "B",
        "br",
        "bl",
        chair="office_chair",
        colour=rng.choice(("navy", "black", "green", "red", "grey")),
    )
    top.landmarks(
        rng.choice((3, 4, 4)),
        "lamp",
        "book",
        "keyboard",
        "pen_pot",
        "mat",
        "notepad",
        "plant",
        "coaster",
        "box",
    )
    top.clutter(rng.randint(2, 4), "phone", "glasses", "notes", "ruler", "rubber", "headphones")
    back = top.room(("boards", "carpet"), ("plaster", "plaster", "wallpaper", "boards"), back_m=(1.0, 1.4))
    top.furnish(
        back,
        ("cabinet", 1.1, {"fronts": "drawers", "width_m": 1.1}),
        ("houseplant", 0.9, {}),
        ("cabinet", 0.9, {"fronts": "doors", "width_m": 0.9, "height_m": 1.4}),
    )
    top.light()
    top.cameras()
    stage.tell(f"A desk in a study {top.mood.words}.")
