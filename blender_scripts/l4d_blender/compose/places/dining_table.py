"""A dining table with a cloth."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...assets.materials import tableware
from ..settings.tabletops import OAK, WALNUT, Tabletop, wood
from . import place

if TYPE_CHECKING:
    from ..stage import Stage

_LINENS = (
    (0.62, 0.58, 0.48),
    (0.66, 0.65, 0.62),
    (0.30, 0.36, 0.40),
    (0.42, 0.20, 0.15),
    (0.36, 0.42, 0.32),
    (0.60, 0.47, 0.24),
)
_CHECKS = ((0.42, 0.06, 0.05), (0.06, 0.14, 0.36), (0.08, 0.26, 0.14), (0.55, 0.33, 0.04))


@place("tabletop", "table")
def dining_table(stage: Stage) -> None:
    """A table under a linen or chequered cloth, before anyone eats."""
    rng = stage.rng("dining table")
    top = Tabletop(stage, "dining table", (rng.uniform(1.05, 1.3), rng.uniform(0.66, 0.72)))
    timber = wood(rng, OAK, WALNUT)
    stage.scene.put("dining_table", "table", rng=rng, size_m=top.size_m, under_cloth=True, **timber)
    if rng.random() < 0.4:
        cloth = tableware.gingham("cloth", rng.choice(_CHECKS), rng, check_m=rng.uniform(0.02, 0.05))
    else:
        cloth = tableware.linen("cloth", rng.choice(_LINENS), rng)
    stage.scene.put(
        "dining_table.tablecloth",
        "cloth",
        rng=rng,
        table_m=top.size_m,
        overhang_m=rng.uniform(0.14, 0.2),
        material=cloth,
    )
    top.seats("b", "B", "br", "bl", "lr", **timber)
    top.landmarks(
        rng.choice((3, 4)), "candle", "plate", "jug", "vase", "bowl", "tray", "board", "trivet", "tin"
    )
    top.clutter(rng.randint(1, 2), "grapes", "biscuits", "pear")
    back = top.room(
        ("boards", "boards", "carpet", "chequered"), ("wallpaper", "panelled", "plaster"), back_m=(1.0, 1.4)
    )
    top.furnish(
        back,
        ("cabinet", 1.5, {"width_m": 1.5, "fronts": "doors"}),
        ("wooden_chair", 0.5, timber),
        ("houseplant", 0.9, {}),
    )
    top.light()
    top.cameras()
    stage.tell(f"A dining table {top.mood.words}.")
