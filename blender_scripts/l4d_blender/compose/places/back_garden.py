"""The garden behind a house: a lawn with a border, a fence, a shed's clutter and something to sit on."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...assets import flower_vase, ground
from ..settings import outdoors
from ..settings.outdoors import Mark
from . import place

if TYPE_CHECKING:
    from ..settings.outdoors import Day
    from ..stage import Stage

_MARKS = (
    Mark("farm_tools.wheelbarrow", "wheelbarrow", 0.75, "any", low=False),
    Mark("sandbox", "sandbox", 0.75, "any"),
    Mark("wooden_chair", "chair", 0.35, 0.0, low=False),
    Mark("street_furniture.planter", "planter", 0.5, "any", low=False),
    Mark("goal", "goal", 0.8, 0.0, low=False),
    Mark("slide", "slide", 1.2, 0.0, low=False),
)
_INSIDE = (
    Mark("bird_feeder.water_dish", "dish", 0.2, "any"),
    Mark("plant_pot", "plant", 0.2, "any").of(pot_radius_m=0.14, pot_height_m=0.22, spread_m=0.26, leaves=60),
    Mark("wooden_chair", "chair", 0.35, "any"),
)


@place("outdoor", "lawn")
def back_garden(stage: Stage) -> None:
    """The house is behind or to one side; pickets and a hedge close the garden."""
    rng = stage.rng("back garden")
    now = outdoors.day(stage)
    terrain = ground.Terrain(
        seed=rng.randrange(1 << 30),
        yard=[((rng.uniform(-1.5, 1.5), rng.uniform(-1.0, 1.0)), rng.uniform(0.3, 0.8))],
        level_radius_m=14.0,
        hills_from_m=30.0,
        hill_height_m=5.0,
    )
    lawn = stage.add_area(outdoors.yard("lawn", (5.2, 4.1)))
    side = rng.choice((-1, 1))
    house_at = side * rng.uniform(1.5, 3.5), rng.uniform(8.2, 9.0)

    def rough(x: float, y: float) -> float:
        return 1.0 if abs(abs(x) - 5.3) < 0.2 or 4.0 < y < 4.4 else 0.0

    outdoors.land(stage, now.season, terrain, tufts=2600, turf_m=8.0, long_keep=rough, long_tufts=160)
    house = outdoors.houses(stage, rng, 1, size_m=((8.0, 10.0), (6.5, 7.5)))[0]
    stage.scene.place(house, house_at, rng.uniform(-5, 5))
    outdoors.named(stage, "house", "house", house, house_at)
    _edges(stage, now, terrain, side, house_at[0])
    inside = rng.choice(_INSIDE)
    outdoors.put_in(stage, lawn, [inside])
    bush = outdoors.tree(stage, now.season, "tree", rng, height_m=rng.uniform(3.6, 4.4), sprays=1200)
    at = -side * rng.uniform(2.9, 3.6), rng.uniform(2.2, 3.0)
    stage.scene.place(bush, at, rng.uniform(-180, 180))
    outdoors.named(stage, "tree", "tree", bush, at)
    marks = rng.sample([mark for mark in _MARKS if mark.name != inside.name], 2)
    outdoors.put_round(stage, lawn, marks, clear=[(at, 0.6)], back_deg=(8.0, 172.0))
    outdoors.woods(stage, now.season, terrain, distance_m=(30.0, 44.0))
    outdoors.cameras(stage, (0.0, -0.15, 0.55), radius_m=5.4, fov_deg=54.0)
    stage.tell(f"A garden behind a house on {now.words}.")


def _edges(stage: Stage, now: Day, terrain: ground.Terrain, side: float, house_x: float) -> None:
    """Pickets down both sides, a hedge at the back, a flower border, trees and a house next door."""
    rng = stage.rng("edges")
    scene = stage.scene
    back = rng.uniform(5.6, 6.2)
    colour = rng.choice(("white", "white", "green", "blue"))
    pickets = scene.make(
        "picket_fence",
        "fence",
        rng,
        line=[(-side * 5.4, -1.6), (-side * 5.4, back), (house_x - side * 5.7, back)],
        colours=[colour],
        height=terrain.height,
    )
    stage.register(
        "picket_fence",
        "fence",
        pickets,
        at=(-side * 5.4, back),
        heading_deg=0.0,
        area=None,
        look=outdoors.Look("picket_fence", {}, {"colour": colour}),
        landmark=True,
    )
    outdoors.plant(
        stage,
        now.season,
        "hedge",
        outdoors.row((side * 5.6, 0.0), (side * 5.6, 5.0), 1.4),
        kind="tree.bush",
        on=terrain,
        any_way=False,
        scale=(0.9, 1.1),
        size_xyz=(1.8, 0.9, rng.uniform(1.0, 1.4)),
        sprays=500,
    )
    bushes = [
        (x + rng.uniform(-0.4, 0.4), back - 0.6 + rng.uniform(-0.2, 0.2)) for x in (-4.4, -3.0, 3.2, 4.6)
    ]
    bushes = [spot for spot in bushes if (spot[0] - house_x) * side < -3.0 or rng.random() < 0.3]
    outdoors.plant(
        stage, now.season, "border", bushes, kind="tree.bush", on=terrain, scale=(0.6, 1.1), sprays=500
    )
    kinds = ((flower_vase.ROSE, flower_vase.DAISY), (flower_vase.DAISY,))
    heads = [flower_vase.flower_vase(f"flowers_model_{k}", rng, kinds=kinds[k], heads=13) for k in range(2)]
    spots = [(rng.uniform(-4.6, 4.6), rng.uniform(3.7, 4.5)) for _ in range(12)]
    # The jugs that they grow from are below the lawn.
    outdoors.scatter(scene, "flowers", heads, spots, rng, on=terrain, sunk_m=0.17, scale=(1.6, 2.3))
    trees = [(rng.uniform(-16, 16), rng.uniform(12.5, 20.0)) for _ in range(6)]
    trees += [(-side * rng.uniform(7.0, 9.0), rng.uniform(3.0, 7.5))]
    outdoors.plant(stage, now.season, "far_tree", trees, on=terrain, height_m=rng.uniform(5.5, 7.0))
    next_door = outdoors.houses(stage, rng, 1)[0]
    scene.place(
        next_door,
        (-side * rng.uniform(11.0, 14.0), rng.uniform(11.0, 15.0)),
        rng.uniform(-15, 15),
        on=terrain,
    )
