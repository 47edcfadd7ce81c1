"""A pond in a park: water birds swim before a grassy bank with a bench and reeds."""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot
from typing import TYPE_CHECKING

from ...assets import ground
from ..settings import outdoors
from ..settings.outdoors import Mark
from . import place

if TYPE_CHECKING:
    from ..settings.outdoors import Day
    from ..stage import Stage

WATER_M = -0.22


@dataclass(frozen=True)
class Pond(ground.Terrain):
    """Level ground with an oval pond before it, whose near shores cameras don't see."""

    middle: tuple[float, float] = (0.0, -4.6)
    radii_m: tuple[float, float] = (9.0, 4.6)

    def inland(self, x: float, y: float) -> float:
        """Metres from the shoreline, negative over water."""
        u, v = (x - self.middle[0]) / self.radii_m[0], (y - self.middle[1]) / self.radii_m[1]
        return (hypot(u, v) - 1.0) * self.radii_m[1] + 0.16 * self._noise(x, y, 0.7)

    def height(self, x: float, y: float) -> float:
        """Metres above the bank."""
        off = self.inland(x, y)
        if off < 0.0:
            return WATER_M - 0.01 - 0.3 * min(-off, 3.0)
        rise = min(1.0, off / 0.55)
        rise = rise * (2.0 - rise)
        return WATER_M * (1.0 - rise) + rise * super().height(x, y)

    def wear(self, x: float, y: float) -> float:
        """Mud along the water."""
        mud = min(1.0, max(0.0, (0.38 - self.inland(x, y) + 0.15 * self._noise(x, y, 1.3)) / 0.3))
        return max(mud, super().wear(x, y))


@place("outdoor", "water")
def park_pond(stage: Stage) -> None:
    """Cameras look over the water at the bank."""
    rng = stage.rng("park pond")
    now = outdoors.day(stage)
    path_y = rng.uniform(4.2, 5.2)
    terrain = Pond(
        seed=rng.randrange(1 << 30),
        paths=[ground.Path([(-40.0, path_y + 2.0), (0.0, path_y), (40.0, path_y + 3.0)], 0.9)],
        level_radius_m=9.0,
        hills_from_m=30.0,
        hill_height_m=rng.uniform(4.0, 8.0),
        middle=(rng.uniform(-0.8, 0.8), -4.7),
        radii_m=(rng.uniform(7.5, 10.0), 4.6),
    )
    stage.add_area(outdoors.yard("water", (4.4, 2.4), centre=(0.0, -1.9), cut_m=0.7, on=WATER_M))
    bank = stage.add_area(outdoors.yard("lawn", (5.2, 2.5), centre=(0.0, 1.85), cut_m=0.5))
    _land(stage, now, terrain)
    _marks(stage, now, terrain, bank)
    outdoors.cameras(
        stage, (0.0, -0.7, 0.3), radius_m=5.2, fov_deg=56.0, heights_m=(1.6, 2.5), arc_deg=(92.0, 116.0)
    )
    stage.tell(f"A pond in a park on {now.words}.")


def _land(stage: Stage, now: Day, terrain: Pond) -> None:
    rng = stage.rng("pond land")

    def dry(x: float, y: float) -> float:
        return 1.0 if terrain.inland(x, y) > 0.2 else 0.0

    def uncut(x: float, y: float) -> float:
        return 1.0 if 0.12 < terrain.inland(x, y) < 0.35 else 0.0

    outdoors.land(
        stage,
        now.season,
        terrain,
        tufts=2000,
        turf_m=9.0,
        keep=dry,
        long_keep=uncut,
        long_tufts=260,
        sectors=168,
    )
    stage.scene.make("lake.water", "pond", rng, shore=_Level(WATER_M), size_m=44.0)
    stage.scene.make(
        "ground.stones",
        "stones",
        rng,
        terrain=terrain,
        count=500,
        radius_m=7.5,
        size_m=(0.02, 0.10),
        keep=lambda x, y: 1.0 if -0.25 < terrain.inland(x, y) < 0.15 else 0.0,
    )
    pads = [(s * rng.uniform(2.9, 4.2), rng.uniform(-3.0, -0.9)) for s in (-1, -1, 1, 1)]
    stage.scene.make("lake.lily_pads", "lily_pads", rng, spots=pads, water_m=WATER_M)
    trees = [(s * rng.uniform(5.2, 8.5), rng.uniform(2.5, 7.0)) for s in (-1, 1, -1, 1)]
    trees += [(rng.uniform(-18, 18), rng.uniform(8.5, 17.0)) for _ in range(8)]
    outdoors.plant(stage, now.season, "tree_far", trees, on=terrain, height_m=rng.uniform(5.5, 7.5))
    bushes = [(rng.uniform(-9, 9), path_bush) for path_bush in [rng.uniform(6.2, 8.0) for _ in range(9)]]
    outdoors.plant(
        stage, now.season, "bush", bushes, kind="tree.bush", on=terrain, scale=(0.8, 1.6), sprays=500
    )
    outdoors.woods(stage, now.season, terrain)


@dataclass(frozen=True)
class _Level:
    """What a sheet of water asks of a shore."""

    water_m: float


def _marks(stage: Stage, now: Day, terrain: Pond, bank: outdoors.Area) -> None:
    """Reeds in the water, and what parks put beside it."""
    rng = stage.rng("pond marks")
    side = rng.choice((-1, 1))
    at = side * rng.uniform(2.75, 3.1), rng.uniform(-1.0, -0.5)
    clumps = [(at[0] + rng.uniform(-0.35, 0.35), at[1] + rng.uniform(-0.4, 0.4), 0.3, 40) for _ in range(4)]
    stand = stage.scene.make("reeds", "reeds", rng, clumps=clumps, foot_m=WATER_M - 0.3, height_m=(0.7, 1.3))
    outdoors.named(stage, "reeds", "reeds", stand, at)
    other = (-side * rng.uniform(3.3, 3.7), rng.uniform(-1.1, -0.5))
    if rng.random() < 0.6:
        colour = rng.choice(("red", "green", "blue", "white", "teal", "brown"))
        boat = stage.scene.put(
            "rowing_boat", "boat", other, -side * rng.uniform(140, 200), on=WATER_M, rng=rng, colour=colour
        )
        stage.register(
            "rowing_boat",
            "boat",
            boat,
            at=other,
            heading_deg=0.0,
            area=None,
            look=outdoors.Look("rowing_boat", {}, {"colour": colour}),
            landmark=True,
        )
    else:
        stage.landmark(
            "dock.mooring_post", "post", (other[0], -0.5), on=WATER_M, category="post", bed_m=-1.0, top_m=0.6
        )
    bench = Mark("street_bench", "bench", 0.85, low=False, away_m=-0.05)
    found = outdoors.put_round(stage, bank, [bench], back_deg=(60.0, 120.0))
    outdoors.seats(stage, found["bench"])
    more = rng.sample(
        (
            Mark("park_lamp", "lamp_post", 0.25, "any", low=False).of(glow=0.0),
            Mark("street_furniture.litter_bin", "bin", 0.3, "any", low=False),
            Mark("street_furniture.sign_post", "sign", 0.35, 10.0, low=False).of(text="POND", height_m=2.2),
            Mark("street_furniture.planter", "planter", 0.5, "any", low=False),
        ),
        2,
    )
    outdoors.put_round(stage, bank, more, back_deg=(5.0, 175.0), clear=[(found["bench"].at, 1.0)])
