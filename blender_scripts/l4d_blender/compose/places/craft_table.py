"""A craft table in a children's room."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..settings.tabletops import BIRCH, PAINTED, PINE, Tabletop, wood
from . import place

if TYPE_CHECKING:
    from ..stage import Stage


@place("tabletop", "table")
def craft_table(stage: Stage) -> None:
    """A pale table with crayons, paper and picture books on a bright mat."""
    rng = stage.rng("craft table")
    top = Tabletop(stage, "craft table", (rng.uniform(1.0, 1.15), rng.uniform(0.62, 0.68)))
    stage.scene.put("dining_table", "table", rng=rng, size_m=top.size_m, **wood(rng, BIRCH, PINE, PAINTED))
    top.seats("b", "B", "br", "bl", "lr", **wood(rng, BIRCH, PINE, PAINTED))
    top.landmarks(
        rng.choice((3, 4)),
        "crayons",
        "picture_book",
        "pen_pot",
        "paper",
        "tin",
        "bowl",
        "notepad",
        "mat",
        "tray",
    )
    top.clutter(rng.randint(2, 3), "loose_crayons", "rubber", "ruler", "notes", "spool")
    back = top.room(("boards", "carpet"), ("plaster", "wallpaper", "plaster", "panelled"), back_m=(1.0, 1.4))
    stage.scene.put(
        "play_mat", "play_mat", (rng.uniform(-0.2, 0.2), 0.0), rng.uniform(-8, 8), on=-top.height_m + 0.001
    )
    top.furnish(
        back,
        ("toy_chest", 0.85, {"colour": rng.choice(("red", "blue", "yellow", "teal", "white"))}),
        ("teddy", 0.35, {"colour": rng.choice(("brown", "cream", "grey", "honey"))}),
        ("rocking_chair", 0.5, {"colour": rng.choice(("red", "green", "blue"))}),
        ("ball", 0.35, {"colour": rng.choice(("red", "green", "yellow"))}),
        ("cabinet", 0.9, {"width_m": 0.9, "paint": rng.choice(((0.6, 0.6, 0.55), (0.2, 0.35, 0.4)))}),
    )
    top.light()
    top.cameras()
    stage.tell(f"A children's table {top.mood.words}.")
