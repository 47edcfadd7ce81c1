"""Rows of fruit trees with a clearing: ladder, crates and a barrow from the harvest."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...assets import ground
from ..settings import outdoors
from ..settings.outdoors import Mark
from . import place

if TYPE_CHECKING:
    from ..stage import Prop, Stage

_MARKS = (
    Mark("farm_tools.wheelbarrow", "wheelbarrow", 0.75, "any", low=False),
    Mark("haystack.hay_bale", "bale", 0.55, "any", low=False),
    Mark("farm_tools.milk_churn", "churn", 0.25, "any", low=False),
    Mark("haystack", "haystack", 0.95, "any", low=False),
    Mark("wooden_chair", "chair", 0.35, 0.0, low=False),
    Mark("well", "well", 0.85, 0.0, low=False),
)
_INSIDE = tuple(mark for mark in _MARKS if mark.name in ("bale", "churn", "chair"))


@place("outdoor", "lawn")
def orchard(stage: Stage) -> None:
    """Grass under trees that stand in a grid, rails along one side, hills behind."""
    rng = stage.rng("orchard")
    now = outdoors.day(stage)
    step, turn = rng.uniform(4.2, 5.0), rng.uniform(-0.12, 0.12)
    terrain = ground.Terrain(
        seed=rng.randrange(1 << 30),
        yard=[((rng.uniform(-2, 2), rng.uniform(-1, 1)), rng.uniform(0.4, 1.0))],
        paths=[ground.Path([(-30.0, 4.4 - 30 * turn), (30.0, 4.4 + 30 * turn)], 0.8, ruts=True)],
        level_radius_m=8.0,
        hills_from_m=24.0,
        hill_height_m=rng.uniform(6.0, 11.0),
    )
    lawn = stage.add_area(outdoors.yard("lawn", (5.3, 4.1)))
    spots = []
    for j in range(6):
        for k in range(-4, 5):
            x, y = (k + 0.5 * (j % 2)) * step, 6.2 + 0.85 * step * j
            spots.append((x - turn * y, y + turn * x))
    spots += [
        (s * (5.4 + step * k), y + s * turn) for s in (-1, 1) for k, y in ((0, 2.6), (1, 3.0), (1, -0.8))
    ]

    def uncut(x: float, y: float) -> float:
        near = min((x - u) ** 2 + (y - v) ** 2 for u, v in spots) < 0.6
        return 1.0 if near or y > 5.0 else 0.0

    outdoors.land(
        stage, now.season, terrain, tufts=2200, length_m=(0.03, 0.08), long_keep=uncut, long_tufts=500
    )
    outdoors.plant(
        stage,
        now.season,
        "fruit_tree",
        spots,
        on=terrain,
        height_m=rng.uniform(3.8, 4.6),
        sprays=1300,
        scale=(0.88, 1.12),
        loose_m=0.15,
    )
    own = outdoors.tree(stage, now.season, "tree", rng, height_m=rng.uniform(3.9, 4.4), sprays=1300)
    at = rng.choice((-1, 1)) * rng.uniform(1.2, 2.6), rng.uniform(2.6, 3.0)
    stage.scene.place(own, at, rng.uniform(-180, 180))
    stage.may_touch(outdoors.named(stage, "tree", "tree", own, at), _ladder(stage, at))
    inside = rng.choice(_INSIDE)
    outdoors.put_in(stage, lawn, [inside])
    marks = rng.sample([mark for mark in _MARKS if mark.name != inside.name], 2)
    outdoors.put_round(stage, lawn, marks, clear=[(at, 1.9)], back_deg=(8.0, 172.0))
    side = -1.0 if at[0] > 0 else 1.0
    rails = stage.scene.make(
        "fence",
        "fence",
        rng,
        line=[(side * 7.0, -1.8), (side * 6.6, 4.6), (side * 2.2, 5.0)],
        height=terrain.height,
    )
    outdoors.named(stage, "fence", "fence", rails, (side * 6.6, 4.6))
    outdoors.woods(stage, now.season, terrain, distance_m=(34.0, 50.0))
    outdoors.cameras(stage, (0.0, -0.15, 0.55), radius_m=5.4, fov_deg=54.0)
    stage.tell(f"An orchard on {now.words}.")


def _ladder(stage: Stage, tree: tuple[float, float]) -> Prop:
    """Leans into the tree from the back."""
    rng = stage.rng("ladder")
    x = tree[0] + rng.uniform(-0.25, 0.25)
    thing = stage.scene.put("farm_tools.ladder", "ladder", (x, tree[1] + 0.95), 0.0, rng=rng, tilt_deg=16.0)
    return outdoors.named(stage, "farm_tools.ladder", "ladder", thing, (x, tree[1] + 0.8))
