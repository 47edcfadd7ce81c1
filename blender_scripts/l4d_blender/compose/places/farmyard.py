"""A trodden yard before a barn, with what farms leave standing about."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...assets import ground
from ..settings import outdoors
from ..settings.outdoors import Mark
from . import place

if TYPE_CHECKING:
    from ..stage import Stage

_MARKS = (
    Mark("haystack", "haystack", 0.95, "any", low=False),
    Mark("well", "well", 0.85, 0.0, low=False),
    Mark("farm_tools.wheelbarrow", "wheelbarrow", 0.8, "any", low=False),
    Mark("farm_tools.milk_churn", "churn", 0.25, "any"),
    Mark("bird_feeder.water_dish", "dish", 0.2, "any"),
    Mark("haystack.hay_bale", "bale", 0.6, "any", low=False),
    Mark("wooden_chair", "chair", 0.32, 25.0, low=False),
)


@place("outdoor", "lawn")
def farmyard(stage: Stage) -> None:
    """Bare soil in the middle, a barn behind, paddock rails, fields and woods."""
    rng = stage.rng("farmyard")
    now = outdoors.day(stage)
    barn_x, barn_y = rng.uniform(-2.6, 2.6), rng.uniform(6.4, 7.2)
    terrain = ground.Terrain(
        seed=rng.randrange(1 << 30),
        yard=[((0.0, 0.3), rng.uniform(2.6, 3.8)), ((barn_x, barn_y - 3.4), 1.9)],
        paths=[
            ground.Path(
                [(barn_x, barn_y - 2.0), (0.0, 0.0), (rng.choice((-1, 1)) * 9.0, -9.0)], 1.2, ruts=True
            )
        ],
        level_radius_m=8.0,
        hills_from_m=24.0,
        hill_height_m=rng.uniform(5.0, 10.0),
    )
    lawn = stage.add_area(outdoors.yard("lawn", (5.2, 4.1)))

    def rough(x: float, y: float) -> float:
        return 1.0 if y > 3.4 or abs(x) > 4.4 else 0.0

    outdoors.land(stage, now.season, terrain, tufts=1500, long_keep=rough)
    stage.scene.make(
        "ground.straw_litter",
        "straw",
        rng,
        terrain=terrain,
        spots=[((rng.uniform(-2, 2), rng.uniform(-1, 2)), 1.3, 90) for _ in range(4)],
    )
    stage.scene.make("ground.stones", "stones", rng, terrain=terrain, count=70, radius_m=5.5)
    stage.landmark("barn", "barn", (barn_x, barn_y), rng.uniform(-14, 14))
    _paddock(stage, barn_x, barn_y, terrain)
    inside = [rng.choice([mark for mark in _MARKS if mark.radius_m < 0.7])]
    marks = rng.sample([mark for mark in _MARKS if mark not in inside], 3)
    outdoors.put_in(stage, lawn, inside)
    outdoors.put_round(stage, lawn, marks, clear=[((barn_x, barn_y), 4.0)])
    side = -1.0 if barn_x > 0 else 1.0
    spots = [(side * rng.uniform(5.5, 7.0), rng.uniform(7.0, 9.0)), (-side * 8.5, 10.5), (side * 9.5, 3.8)]
    spots += [(rng.uniform(-16, 16), rng.uniform(13, 19)) for _ in range(7)]
    outdoors.plant(stage, now.season, "tree", spots, on=terrain, height_m=rng.uniform(5.5, 7.5))
    outdoors.woods(stage, now.season, terrain)
    outdoors.cameras(stage, (0.0, -0.15, 0.55), radius_m=5.4, fov_deg=54.0)
    stage.tell(f"A farmyard on {now.words}.")


def _paddock(stage: Stage, barn_x: float, barn_y: float, terrain: ground.Terrain) -> None:
    """Rails from the barn to one side with a gate in them."""
    rng = stage.rng("paddock")
    side = -1.0 if barn_x > 0 else 1.0
    y = rng.uniform(3.6, 4.4)
    gate = side * rng.uniform(0.6, 2.2) if abs(barn_x) > 1.4 else side * 4.0
    wall = barn_x + side * 3.3
    first, last = (min(wall, gate), max(wall, gate))
    lines = {"fence": [(side * 7.4, -1.5), (side * 6.2, y - 0.4), (gate + side * 2.3, y)]}
    if last - first > 1.0:
        lines["rails"] = [(gate - side * 0.1, y), (wall, barn_y - 1.0)]
    for name, line in lines.items():
        made = stage.scene.make("fence", name, rng, line=line, height=terrain.height)
        if name == "fence":
            outdoors.named(stage, "fence", "fence", made, line[-1])
    stage.landmark("fence.gate", "gate", (gate, y), 0.0 if side > 0 else 180.0, width_m=2.15)
