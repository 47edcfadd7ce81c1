"""A desk for somebody who writes, with little else on it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...assets import desk
from ..settings.tabletops import BIRCH, GREY, OAK, PINE, WALNUT, Tabletop, wood
from . import place

if TYPE_CHECKING:
    from ..stage import Stage


@place("tabletop", "table", "clear", "paper")
def writing_desk(stage: Stage) -> None:
    """A desk against no wall; what is on it keeps to its ends. Its user faces the room."""
    rng = stage.rng("writing desk")
    size_m = rng.uniform(1.2, 1.4), rng.uniform(0.66, 0.74)
    top = Tabletop(stage, "writing desk", size_m, desk.HEIGHT_M, widest_m=1.1)
    stage.scene.put(
        "desk",
        "desk",
        on=-desk.HEIGHT_M,
        heading_deg=180.0,
        rng=rng,
        size_m=top.size_m,
        **wood(rng, OAK, WALNUT, BIRCH, PINE, GREY),
    )
    chair = rng.choice(("office_chair", "wooden_chair"))
    looks = (
        {"colour": rng.choice(("navy", "black", "green", "red"))} if chair == "office_chair" else wood(rng)
    )
    top.seats("b", chair=chair, **looks)
    top.landmarks(3, "lamp", "plant", "pen_pot", "candle", "coaster", "tin", "jar", "saucer", aside=True)
    top.clutter(rng.randint(0, 2), "glasses", "notes", "rubber")
    back = top.room(
        ("boards", "carpet", "tiles"), ("plaster", "wallpaper", "two_tone", "boards"), back_m=(1.0, 1.4)
    )
    top.furnish(
        back,
        ("cabinet", 1.1, {"fronts": "drawers", "width_m": 1.1}),
        ("houseplant", 0.9, {}),
        ("cabinet", 0.9, {"fronts": "doors", "width_m": 0.9, "height_m": 1.4}),
    )
    top.light()
    top.cameras()
    stage.tell(f"A desk {top.mood.words}.")
