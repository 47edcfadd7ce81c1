"""A table in a cottage garden."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..settings.tabletops import GREY, OAK, PAINTED, PINE, Tabletop, wood
from . import place

if TYPE_CHECKING:
    from ..stage import Stage

_LIGHTS = (
    # sky, its strength, sun's strength, elevation, colour, words
    ("forest", 0.7, 3.2, (38, 62), (1.0, 0.95, 0.86), "at noon"),
    ("sunrise", 0.6, 2.6, (16, 28), (1.0, 0.80, 0.58), "in the morning"),
    ("sunset", 0.7, 2.2, (12, 22), (1.0, 0.68, 0.42), "before sunset"),
    ("courtyard", 1.0, 0.0, (45, 50), (1.0, 1.0, 1.0), "under a grey sky"),
)


@place("tabletop", "table")
def garden_table(stage: Stage) -> None:
    """A weathered table on a lawn, with flowers, bushes and a fence behind it."""
    rng = stage.rng("garden table")
    top = Tabletop(stage, "garden table", (rng.uniform(1.0, 1.2), rng.uniform(0.64, 0.70)))
    timber = wood(rng, GREY, PINE, OAK, PAINTED)
    stage.scene.put("dining_table", "table", rng=rng, size_m=top.size_m, **timber)
    top.seats("b", "B", "br", "bl", "lr", **timber)
    top.landmarks(
        rng.choice((3, 4)), "vase", "tray", "jug", "bowl", "candle", "plate", "book", "plant", "napkin"
    )
    top.clutter(rng.randint(1, 2), "glasses", "grapes", "pear", "lemon", "magazine", "biscuits")
    stage.scene.make("garden", "garden", stage.rng("garden"), floor_m=-top.height_m)
    world, strength, sun, elevation, colour, words = rng.choice(_LIGHTS)
    stage.scene.hdri(world, strength, rotation_deg=rng.uniform(0, 360))
    if sun:
        stage.scene.sun(
            elevation_deg=rng.uniform(*elevation),
            azimuth_deg=rng.choice((rng.uniform(-150, -30), rng.uniform(20, 160))),
            strength=sun,
            colour=colour,
        )
    top.cameras()
    stage.tell(f"A table in a garden {words}.")
