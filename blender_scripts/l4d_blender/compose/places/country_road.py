"""A country road between fields, with grass verges and a fence."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ...assets import ground, mesh
from ...assets.materials import street
from ..areas import Area
from ..settings import outdoors
from . import place

if TYPE_CHECKING:
    from ..settings.outdoors import Day
    from ..stage import Stage

HALF_M = 3.1


class _Fields(ground.Terrain):
    """Land that dips under the road and rises gently behind it."""

    def height(self, x: float, y: float) -> float:
        """Metres above the road."""
        if abs(y) < HALF_M - 0.35:
            return -0.25
        edge = min(1.0, max(0.0, (abs(y) - HALF_M + 0.35) / 0.5))
        swell = 0.045 * max(0.0, y - 7.0)
        return -0.25 * (1.0 - edge) - 0.01 + min(swell, 6.0) + edge * (super().height(x, y))


@place("outdoor", "road")
def country_road(stage: Stage) -> None:
    """The road runs along X; a verge on the near side, a fence, a gate and fields beyond."""
    rng = stage.rng("country road")
    now = outdoors.day(stage)
    terrain = _Fields(
        seed=rng.randrange(1 << 30),
        yard=[((rng.uniform(-3, 3), -4.6), 0.8)],
        level_radius_m=9.0,
        hills_from_m=36.0,
        hill_height_m=rng.uniform(4.0, 9.0),
    )
    stage.add_area(Area.rectangle("road", (0.0, 0.0), (20.0, 2 * HALF_M - 0.3)))
    stage.add_area(Area.rectangle("lawn", (0.0, -HALF_M - 1.55), (8.4, 2.6)))
    _surfaces(stage, now, terrain)
    _beyond(stage, now, terrain)
    _marks(stage, now, terrain)
    outdoors.woods(stage, now.season, terrain, count=13, distance_m=(36.0, 56.0))
    outdoors.road_cameras(stage)
    stage.tell(f"A country road on {now.words}.")


def _surfaces(stage: Stage, now: Day, terrain: ground.Terrain) -> None:
    rng = stage.rng("surfaces")

    def verge(x: float, y: float) -> float:
        return 1.0 if abs(y) > HALF_M + 0.1 else 0.0

    def uncut(x: float, y: float) -> float:
        return 1.0 if 4.6 < y < 5.6 or y < -6.6 else 0.0

    outdoors.land(
        stage,
        now.season,
        terrain,
        tufts=2400,
        turf_m=14.0,
        keep=verge,
        long_keep=uncut,
        long_tufts=600,
        length_m=(0.03, 0.08),
        sectors=168,
    )
    outdoors.sheet(
        "road",
        street.asphalt("asphalt", wetness=rng.choice((0.0, 0.0, 0.3)), tone=rng.uniform(0.05, 0.12)),
        (-75.0, -HALF_M),
        (75.0, HALF_M),
        cells=(60, 4),
    )
    paint = street.road_paint("road_paint")
    lines = []
    if rng.random() < 0.7:
        lines += [mesh.move(mesh.grid("dash", 2.0, 0.12, 4, 1), -36 + 6 * k, 0.0, 0.004) for k in range(13)]
    if not lines or rng.random() < 0.5:
        lines += [
            mesh.move(mesh.grid("edge", 140.0, 0.1, 60, 1), 0.0, s * (HALF_M - 0.2), 0.004) for s in (-1, 1)
        ]
    mesh.set_material(mesh.join("lane_marks", lines), paint)


def _beyond(stage: Stage, now: Day, terrain: ground.Terrain) -> None:
    """A fence with a gate, a field of stubble or meadow, a barn or a cottage, trees in it."""
    rng = stage.rng("beyond")
    scene = stage.scene
    y, gap = 6.0, rng.uniform(-5.0, 5.0)
    rails = [
        scene.make("fence", f"fence_{k}", rng, line=line, height=terrain.height)
        for k, line in enumerate(([(-26.0, y), (gap - 1.15, y)], [(gap + 1.15, y), (26.0, y)]))
    ]
    outdoors.named(stage, "fence", "fence", rails, (gap, y))
    stage.landmark("fence.gate", "gate", (gap - 1.05, y), on=terrain, width_m=2.1)
    far = rng.uniform(-12.0, 12.0), rng.uniform(17.0, 22.0)
    if rng.random() < 0.5:
        stage.landmark("barn", "barn", far, rng.uniform(-30, 30), on=terrain)
    else:
        house = outdoors.houses(stage, rng, 1)[0]
        scene.place(house, far, rng.uniform(-20, 20), on=terrain)
        outdoors.named(stage, "house", "house", house, far)
    stacks = scene.make("haystack", "stack_model", rng, stalks=900)
    spots = [(rng.uniform(-18, 18), rng.uniform(9.0, 16.0)) for _ in range(rng.choice((0, 3, 5)))]
    spots = [spot for spot in spots if abs(spot[0] - far[0]) > 5.0]
    outdoors.scatter(scene, "stack", [stacks], spots, rng, on=terrain, scale=(0.9, 1.2))
    trees = [(rng.uniform(-34, 34), rng.uniform(13.0, 30.0)) for _ in range(9)]
    trees = [spot for spot in trees if abs(spot[0] - far[0]) > 6.0]
    trees += [
        (s * rng.uniform(16.0, 30.0), rng.choice((-1, 1)) * rng.uniform(5.5, 8.0)) for s in (-1, 1, -1, 1)
    ]
    outdoors.plant(stage, now.season, "far_tree", trees, on=terrain, height_m=rng.uniform(5.5, 7.5))
    hedge = outdoors.row((-44.0, 24.0), (44.0, 26.0), 3.0)
    outdoors.plant(
        stage,
        now.season,
        "hedge",
        hedge,
        kind="tree.bush",
        on=terrain,
        scale=(0.8, 1.3),
        any_way=False,
        size_xyz=(3.0, 1.2, 1.3),
        sprays=600,
    )


def _marks(stage: Stage, now: Day, terrain: ground.Terrain) -> None:
    rng = stage.rng("marks")
    slots = [-8.0, -4.5, -1.0, 2.5, 6.0, 8.5]
    rng.shuffle(slots)
    x = iter(s + rng.uniform(-0.6, 0.6) for s in slots)
    text, face = rng.choice(
        (("FARM", (0.3, 0.15, 0.03)), ("BUS", (0.46, 0.02, 0.02)), ("MILL", (0.02, 0.1, 0.36)))
    )
    stage.landmark(
        "street_furniture.sign_post",
        "sign",
        (next(x), HALF_M + 0.6),
        rng.uniform(-12, 12),
        on=terrain,
        text=text,
        face=face,
    )
    tree = outdoors.tree(stage, now.season, "tree", rng, height_m=rng.uniform(4.6, 5.6), sprays=1300)
    at = next(x), HALF_M + 2.0
    stage.scene.place(tree, at, rng.uniform(-180, 180), on=terrain)
    outdoors.named(stage, "tree", "tree", tree, at)
    kind, name = rng.choice(
        (("street_bench", "bench"), ("haystack.hay_bale", "bale"), ("farm_tools.milk_churn", "churn"))
    )
    found = stage.landmark(kind, name, (next(x), HALF_M + 1.2), rng.uniform(-10, 10), on=terrain)
    if name == "bench":
        outdoors.seats(stage, found)
