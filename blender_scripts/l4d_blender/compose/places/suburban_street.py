"""A street of family houses with front gardens, two lanes and a pavement on both sides."""

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

KERB_M = 0.11
HALF_M = 3.2  # of the road
FAR_M, NEAR_M = 5.6, -6.0  # where the pavements end


@place("outdoor", "road")
def suburban_street(stage: Stage) -> None:
    """Cameras look from a green on this side; the houses are opposite."""
    rng = stage.rng("suburban street")
    now = outdoors.day(stage)
    terrain = ground.Terrain(
        seed=rng.randrange(1 << 30), level_radius_m=60.0, hills_from_m=40.0, hill_height_m=6.0
    )
    _surfaces(stage, now, terrain)
    stage.add_area(Area.rectangle("road", (0.0, 0.0), (20.0, 2 * HALF_M - 0.3)))
    stage.add_area(
        Area.rectangle("lawn", (0.0, (NEAR_M - HALF_M) / 2), (8.4, -NEAR_M - HALF_M - 0.3), on=KERB_M)
    )
    _houses(stage, now)
    _furniture(stage)
    outdoors.woods(stage, now.season, terrain, count=11, distance_m=(34.0, 50.0))
    outdoors.road_cameras(stage)
    stage.tell(f"A street of houses on {now.words}.")


def _surfaces(stage: Stage, now: Day, terrain: ground.Terrain) -> None:
    rng = stage.rng("surfaces")
    scene = stage.scene

    def grass(x: float, y: float) -> float:
        return 1.0 if y < NEAR_M - 0.15 or y > FAR_M + 0.1 else 0.0

    outdoors.land(
        stage, now.season, _Sunk(terrain), tufts=2600, turf_m=15.0, length_m=(0.04, 0.09), keep=grass
    )
    outdoors.sheet(
        "road",
        street.asphalt("asphalt", wetness=rng.choice((0.0, 0.0, 0.2, 0.5)), tone=rng.uniform(0.05, 0.11)),
        (-60.0, -HALF_M),
        (60.0, HALF_M),
        cells=(60, 4),
    )
    tones = rng.choice(
        (
            ((0.36, 0.33, 0.29), (0.29, 0.265, 0.235)),
            ((0.30, 0.30, 0.30), (0.22, 0.22, 0.23)),
            ((0.33, 0.19, 0.14), (0.26, 0.15, 0.11)),
        )
    )
    size = rng.choice(((0.75, 0.5), (0.5, 0.5), (0.24, 0.12), (0.9, 0.6)))
    slabs = street.paving("slabs", tones, slab_m=size)
    for name, low, high in (("near", NEAR_M, -HALF_M), ("far", HALF_M, FAR_M)):
        outdoors.sheet(f"pavement_{name}", slabs, (-60.0, low), (60.0, high), KERB_M)
    edge = street.stone("edging", (0.33, 0.32, 0.30))
    for name, y in (("near", NEAR_M), ("far", FAR_M)):
        stones = mesh.move(mesh.bevel_box(f"edging_{name}", (120.0, 0.07, 0.4), 0.01), 0.0, y, KERB_M - 0.385)
        mesh.set_material(stones, edge)
    for name, y in (("near", -HALF_M - 0.05), ("far", HALF_M + 0.05)):
        scene.put(
            "street_furniture.kerb", f"kerb_{name}", (0.0, y), on=KERB_M + 0.004, rng=rng, length_m=72.0
        )
    paint = street.road_paint("road_paint")
    step = rng.choice((5.0, 6.0))
    dashes = [
        mesh.move(mesh.grid("dash", 2.0, 0.12, 4, 1), -30 + step * k, 0.0, 0.004)
        for k in range(int(60 / step))
    ]
    mesh.set_material(mesh.join("lane_marks", dashes), paint)


class _Sunk:
    """A terrain that lies a little below the pavements, and deeper under the road."""

    def __init__(self, terrain: ground.Terrain) -> None:
        self.terrain = terrain

    def height(self, x: float, y: float) -> float:
        """Metres above the road."""
        if (NEAR_M - HALF_M) / 2 < y < (HALF_M + FAR_M) / 2:
            return -0.3
        return KERB_M - 0.035 + self.terrain.height(x, y)

    def wear(self, x: float, y: float) -> float:
        """As on the terrain itself."""
        return self.terrain.wear(x, y)


def _houses(stage: Stage, now: Day) -> None:
    rng = stage.rng("houses")
    scene = stage.scene
    models = outdoors.houses(stage, rng, 3)
    spots, x = [], -36.0 + rng.uniform(-4, 4)
    while x < 36.0:
        spots.append(((x + 5.0, rng.uniform(12.5, 14.5)), rng.uniform(-4, 4)))
        x += rng.uniform(11.0, 15.0)
    spots += [((s * 58.0, rng.uniform(-3, 3)), -90.0 * s) for s in (-1, 1)]
    outdoors.house_row(stage, models, spots, on=KERB_M)
    y = FAR_M + 0.35
    if rng.random() < 0.5:
        paints = [rng.choice(("white", "green", "blue", "white"))]
        for k, (low, high) in enumerate(((-26.0, -8.2), (-6.8, 2.2), (3.6, 13.0), (14.4, 26.0))):
            scene.make(
                "picket_fence",
                f"pickets_{k}",
                rng,
                line=[(low, y), (high, y)],
                colours=paints,
                height=lambda x, y: KERB_M,
            )
    else:
        gaps = sorted(rng.uniform(-20, 20) for _ in range(4))
        bushes = [
            spot
            for spot in outdoors.row((-28.0, y + 0.2), (28.0, y + 0.2), 1.5)
            if all(abs(spot[0][0] - g) > 1.1 for g in gaps)
        ]
        outdoors.plant(
            stage,
            now.season,
            "hedge",
            bushes,
            kind="tree.bush",
            on=KERB_M,
            any_way=False,
            scale=(0.9, 1.1),
            size_xyz=(1.8, 0.9, rng.uniform(0.8, 1.2)),
            sprays=500,
        )
    places = [(rng.uniform(-25, 25), rng.uniform(7.4, 9.5)) for _ in range(8)]
    outdoors.plant(
        stage, now.season, "garden_bush", places, kind="tree.bush", on=KERB_M, scale=(0.7, 1.5), sprays=500
    )
    places = [(s * rng.uniform(9.0, 32.0), rng.uniform(7.6, 9.5)) for s in (-1, 1, -1, 1)]
    places += [(rng.uniform(-30, 30), rng.uniform(20.0, 26.0)) for _ in range(6)]
    places += [(s * rng.uniform(22.0, 40.0), rng.uniform(-13.0, -8.0)) for s in (-1, 1, -1, 1)]
    outdoors.plant(
        stage, now.season, "tree", places, on=KERB_M, height_m=rng.uniform(5.5, 7.0), scale=(0.8, 1.25)
    )


def _furniture(stage: Stage) -> None:
    """Landmarks and clutter along both kerbs and fences."""
    rng = stage.rng("furniture")
    far = HALF_M + 0.45
    slots = [-6.5, -3.3, 0.0, 3.3, 6.5]
    rng.shuffle(slots)
    x = iter(s + rng.uniform(-0.7, 0.7) for s in slots)
    stage.landmark("street_furniture.lamp_post", "lamp_post", (next(x), far), 0.0, on=KERB_M, glow=0.0)
    bench = stage.landmark("street_bench", "bench", (next(x), FAR_M - 0.55), rng.uniform(-5, 5), on=KERB_M)
    outdoors.seats(stage, bench)
    text, face = rng.choice(
        (("BUS", (0.46, 0.02, 0.02)), ("PARK", (0.02, 0.1, 0.36)), ("SCHOOL", (0.5, 0.3, 0.02)))
    )
    stage.landmark(
        "street_furniture.sign_post",
        "sign",
        (next(x), far),
        rng.uniform(-12, 12),
        on=KERB_M,
        text=text,
        face=face,
    )
    stage.landmark(
        "street_furniture.litter_bin",
        "bin",
        (next(x), FAR_M - 0.5),
        on=KERB_M,
        colour=rng.choice(("green", "grey", "red", "blue", "yellow")),
    )
    stage.landmark(
        "street_furniture.planter",
        "planter",
        (rng.choice((-1, 1)) * rng.uniform(2.6, 4.2), NEAR_M - 0.5),
        on=KERB_M - 0.03,
    )
    if rng.random() < 0.6:
        tree = outdoors.tree(
            stage, outdoors.SEASONS[1], "tree", rng, height_m=rng.uniform(4.4, 5.2), sprays=1200
        )
        at = (rng.choice((-1, 1)) * rng.uniform(9.6, 10.6), FAR_M - 0.4)
        stage.scene.place(tree, at, rng.uniform(-180, 180), on=KERB_M)
        outdoors.named(stage, "tree", "tree", tree, at)
    for k in range(2):
        stage.dress(
            "street_furniture.lamp_post",
            f"far_lamp_{k}",
            ((-1, 1)[k] * rng.uniform(14, 20), far),
            on=KERB_M,
            glow=0.0,
        )
