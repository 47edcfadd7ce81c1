"""A playground in a meadow: swing, slide and sand round a free space, parents' bench, trees."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...assets import ground, mesh
from ...assets.materials import playground as materials
from ...scene.colour import rgb
from ..settings import outdoors
from ..settings.outdoors import Mark
from . import place

if TYPE_CHECKING:
    from ..settings.outdoors import Day
    from ..stage import Stage

_COLOURS = ("red", "orange", "yellow", "green", "blue", "light_blue", "purple")
_BENCH = Mark("street_bench", "bench", 0.85, low=False, away_m=-0.05)


@place("outdoor", "lawn", "chairs")
def playground(stage: Stage) -> None:
    """Rubber granulate or trodden grass in the middle, a low fence behind."""
    rng = stage.rng("playground")
    now = outdoors.day(stage)
    rubber = rng.random() < 0.5
    terrain = ground.Terrain(
        seed=rng.randrange(1 << 30),
        yard=[] if rubber else [((rng.uniform(-0.8, 0.8), 0.2), rng.uniform(1.2, 2.4))],
        level_radius_m=9.0,
        hills_from_m=26.0,
        hill_height_m=rng.uniform(5.0, 9.0),
    )
    lawn = stage.add_area(outdoors.yard("lawn", (5.3, 4.1)))

    def green(x: float, y: float) -> float:
        return 0.0 if rubber and abs(x) < 4.4 and -3.4 < y < 3.9 else 1.0

    def uncut(x: float, y: float) -> float:
        return 1.0 if y > 6.2 else 0.0

    outdoors.land(stage, now.season, terrain, tufts=2400, keep=green, long_keep=uncut)
    if rubber:
        _granulate(stage)
    marks = outdoors.put_round(stage, lawn, [_BENCH], back_deg=(25.0, 155.0))
    outdoors.seats(stage, marks["bench"])
    bench = marks["bench"].at
    side = -1.0 if bench[0] > 0 else 1.0
    legs, beam = rng.sample(_COLOURS, 2)
    tall = rng.choice(
        (
            Mark("swing", "swing", 1.35, 0.0, low=False, away_m=1.5).of(legs=legs, beam=beam),
            Mark("slide", "slide", 1.1, 0.0, low=False, away_m=1.5),
        )
    )
    back = (95.0, 150.0) if side < 0 else (30.0, 85.0)
    found = outdoors.put_round(stage, lawn, [tall], back_deg=back, clear=[(bench, 0.9)])
    outdoors.put_in(
        stage,
        lawn,
        [
            rng.choice(
                (
                    Mark("sandbox", "sandbox", 0.75, "any"),
                    Mark("street_furniture.bollard", "post", 0.15, "any", category="post"),
                )
            )
        ],
    )
    more = rng.sample(
        (
            Mark("goal", "goal", 0.8, 0.0, low=False),
            Mark("street_furniture.litter_bin", "bin", 0.3, "any", low=False).of(
                colour=rng.choice(("green", "red", "blue", "yellow"))
            ),
            Mark("park_lamp", "lamp_post", 0.25, "any", low=False).of(glow=0.0),
            Mark("street_furniture.sign_post", "sign", 0.35, 10.0, low=False).of(text="PLAY", height_m=2.2),
        ),
        2,
    )
    clear = [(bench, 1.0), *((prop.at, 1.5) for prop in found.values())]
    outdoors.put_round(stage, lawn, more, clear=clear, back_deg=(6.0, 174.0))
    _round_about(stage, now, terrain)
    outdoors.cameras(stage, (0.0, -0.15, 0.55), radius_m=5.4, fov_deg=54.0)
    stage.tell(f"A playground on {now.words}.")


def _granulate(stage: Stage) -> None:
    """A soft floor with a rim of planks."""
    rng = stage.rng("granulate")
    colour, speck = rng.sample(("red", "green", "light_blue", "orange", "blue"), 2)
    floor = mesh.bevel_box("soft_floor", (8.8, 7.3, 0.5), 0.05, 2)
    mesh.move(floor, 0.0, 0.25, -0.488)
    tone = rgb(0.55 * c + 0.03 for c in materials.PAINTS[colour])
    mesh.set_material(floor, materials.rubber_granulate("granulate", tone, materials.PAINTS[speck]))


def _round_about(stage: Stage, now: Day, terrain: ground.Terrain) -> None:
    """The fence, bushes and trees behind it, a far goal, houses beyond the meadow."""
    rng = stage.rng("round about")
    scene = stage.scene
    colours = rng.choice(
        (["white"], ["red", "yellow", "blue"], ["green", "light_green"], ["light_blue", "white"])
    )
    y, gap = rng.uniform(5.4, 6.0), rng.uniform(-3.0, 3.0)
    pickets = [
        scene.make("picket_fence", f"fence_{k}", rng, line=line, colours=colours, height=terrain.height)
        for k, line in enumerate(
            ([(-8.0, -0.5), (-7.0, y), (gap - 0.7, y)], [(gap + 0.7, y), (7.0, y), (8.0, -0.5)])
        )
    ]
    outdoors.named(stage, "picket_fence", "fence", pickets, (gap, y))
    trees = [(s * rng.uniform(5.5, 9.0), rng.uniform(6.6, 10.0)) for s in (-1, 1, 1, -1)]
    trees += [(rng.uniform(-20, 20), rng.uniform(11.0, 20.0)) for _ in range(6)]
    outdoors.plant(stage, now.season, "far_tree", trees, on=terrain, height_m=rng.uniform(5.5, 7.5))
    bushes = [(rng.uniform(-9, 9), rng.uniform(6.6, 8.0)) for _ in range(7)]
    outdoors.plant(
        stage, now.season, "bush", bushes, kind="tree.bush", on=terrain, scale=(0.8, 1.5), sprays=500
    )
    if rng.random() < 0.6:
        models = outdoors.houses(stage, rng, 2)
        spots = [
            ((x + rng.uniform(-2, 2), rng.uniform(22.0, 26.0)), rng.uniform(-10, 10))
            for x in (-18, -5, 8, 20)
        ]
        outdoors.scatter(scene, "far_house", models, spots, rng, on=terrain, sunk_m=0.0, turn_deg=(0.0, 0.0))
    outdoors.woods(stage, now.season, terrain, distance_m=(32.0, 48.0))
