"""A village green: mown grass, a bench or two, old trees, cottages behind a lane."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...assets import ground
from ..settings import outdoors
from ..settings.outdoors import Mark
from . import place

if TYPE_CHECKING:
    from ..settings.outdoors import Day
    from ..stage import Stage

_BENCH = Mark("street_bench", "bench", 0.85, low=False, away_m=-0.05)
_BACK = (
    Mark("well", "well", 0.85, 0.0, low=False),
    Mark("park_lamp", "lamp_post", 0.25, "any", low=False).of(glow=0.0),
    Mark("street_furniture.sign_post", "sign", 0.35, 20.0, low=False).of(text="GREEN", height_m=2.3),
    Mark("street_furniture.litter_bin", "bin", 0.3, "any", low=False),
    Mark("street_furniture.planter", "planter", 0.5, "any", low=False),
)
_INSIDE = (
    Mark("plant_pot", "plant", 0.2, "any").of(pot_radius_m=0.14, pot_height_m=0.22, spread_m=0.26, leaves=60),
    Mark("street_furniture.bollard", "bollard", 0.15, "any"),
    Mark("wooden_chair", "chair", 0.32, "any"),
)


@place("outdoor", "lawn", "chairs")
def village_green(stage: Stage) -> None:
    """Grass with a footpath behind it and a row of cottages."""
    rng = stage.rng("village green")
    now = outdoors.day(stage)
    lane_y = rng.uniform(6.0, 7.0)
    terrain = ground.Terrain(
        seed=rng.randrange(1 << 30),
        yard=[((rng.uniform(-1.5, 1.5), rng.uniform(-0.5, 1.5)), rng.uniform(0.3, 0.9))],
        paths=[ground.Path([(-40.0, lane_y + 1.0), (0.0, lane_y), (40.0, lane_y + 1.0)], 1.5, ruts=True)],
        level_radius_m=8.0,
        hills_from_m=30.0,
        hill_height_m=rng.uniform(5.0, 9.0),
    )
    lawn = stage.add_area(outdoors.yard("lawn", (5.4, 4.2)))

    def uncut(x: float, y: float) -> float:
        return 1.0 if lane_y - 1.9 < y < lane_y - 1.3 or y > lane_y + 1.2 else 0.0

    outdoors.land(stage, now.season, terrain, tufts=2600, long_keep=uncut)
    marks = outdoors.put_round(stage, lawn, [_BENCH], back_deg=(30.0, 150.0))
    outdoors.seats(stage, marks["bench"])
    inside = rng.choice(_INSIDE)
    outdoors.put_in(stage, lawn, [inside])
    big = outdoors.tree(stage, now.season, "tree", rng, height_m=rng.uniform(5.5, 6.5), sprays=1500)
    bench = marks["bench"].at
    at = (-1.0 if bench[0] > 0 else 1.0) * rng.uniform(2.2, 3.4), rng.uniform(2.7, 3.3)
    stage.scene.place(big, at, rng.uniform(-180, 180))
    outdoors.named(stage, "tree", "tree", big, at)
    others = rng.sample([mark for mark in _BACK if mark.name != inside.name], 2)
    outdoors.put_round(stage, lawn, others, clear=[(bench, 1.0), (at, 2.3)])
    _cottages(stage, now, terrain, lane_y)
    outdoors.woods(stage, now.season, terrain, distance_m=(34.0, 50.0))
    outdoors.cameras(stage, (0.0, -0.15, 0.55), radius_m=5.4, fov_deg=54.0)
    stage.tell(f"A village green on {now.words}.")


def _cottages(stage: Stage, now: Day, terrain: ground.Terrain, lane_y: float) -> None:
    """Three models, a dozen houses; pickets or a hedge before them, trees between."""
    rng = stage.rng("cottages")
    models = outdoors.houses(stage, rng, 3, size_m=((6.5, 9.0), (5.5, 6.5)), eaves_m=(2.6, 3.6))
    spots, x = [], -30.0 + rng.uniform(-4, 4)
    while x < 30.0:
        spots.append(((x, lane_y + rng.uniform(6.5, 8.5)), rng.uniform(-8, 8)))
        x += rng.uniform(10.5, 15.0)
    outdoors.house_row(stage, models, spots, on=terrain)
    y = lane_y + 1.8
    if rng.random() < 0.5:
        gap = rng.uniform(-3.0, 3.0)
        for k, (low, high) in enumerate(((-18.0, gap - 0.6), (gap + 0.6, 18.0))):
            stage.scene.make(
                "picket_fence", f"pickets_{k}", rng, line=[(low, y), (high, y)], height=terrain.height
            )
    else:
        outdoors.plant(
            stage,
            now.season,
            "hedge",
            outdoors.row((-20.0, y + 0.2), (20.0, y + 0.2), 1.6),
            kind="tree.bush",
            on=terrain,
            any_way=False,
            scale=(0.9, 1.15),
            size_xyz=(1.9, 0.9, rng.uniform(0.8, 1.2)),
            sprays=500,
        )
    trees = [(rng.uniform(-24, 24), lane_y + rng.uniform(3.0, 5.5)) for _ in range(6)]
    trees += [(s * rng.uniform(7.5, 11.0), rng.uniform(1.5, 4.5)) for s in (-1, 1)]
    outdoors.plant(stage, now.season, "far_tree", trees, on=terrain, height_m=rng.uniform(5.5, 7.0))
