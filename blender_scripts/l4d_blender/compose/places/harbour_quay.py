"""A stone quay with houses behind it; water birds swim before the wall."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

from ...assets import mesh, shopfront
from ...assets.materials import lakeside, street
from ...scene.colour import rgb
from ..settings import outdoors
from ..settings.outdoors import Mark
from . import place

if TYPE_CHECKING:
    from ..settings.outdoors import Day
    from ..stage import Stage

_TRADES = ("FISH", "ROPES", "CAFE", "INN", "BOATS", "SAILS")
_WALLS = (
    (0.58, 0.47, 0.30),
    (0.40, 0.48, 0.52),
    (0.60, 0.30, 0.24),
    (0.62, 0.58, 0.50),
    "brick",
    (0.42, 0.50, 0.40),
)
_BENCH = Mark("street_bench", "bench", 0.85, low=False, away_m=-0.05)


@place("outdoor", "water")
def harbour_quay(stage: Stage) -> None:
    """Cameras look from the water at the quay."""
    rng = stage.rng("harbour quay")
    now = outdoors.day(stage)
    water_m = -rng.uniform(0.28, 0.42)
    stage.add_area(outdoors.yard("water", (4.4, 2.3), centre=(0.0, -1.65), cut_m=0.6, on=water_m))
    quay = stage.add_area(outdoors.yard("lawn", (5.2, 2.5), centre=(0.0, 1.75), cut_m=0.5))
    _surfaces(stage, water_m)
    _marks(stage, quay, water_m)
    _town(stage, now, water_m)
    outdoors.cameras(
        stage, (0.0, -0.6, 0.25), radius_m=5.2, fov_deg=56.0, heights_m=(1.6, 2.5), arc_deg=(92.0, 116.0)
    )
    stage.tell(f"A harbour quay on {now.words}.")


def _surfaces(stage: Stage, water_m: float) -> None:
    """Paving, the wall under it, coping stones, water."""
    rng = stage.rng("quay surfaces")
    if rng.random() < 0.5:
        material = street.paving("slabs", ((0.33, 0.31, 0.28), (0.26, 0.245, 0.22)), slab_m=(0.9, 0.6))
        outdoors.sheet("quay_top", material, (-60.0, 0.0), (60.0, 30.0), cells=(24, 8))
    else:
        setts = stage.scene.make("cobbles", "setts_model", rng, radius_m=30.0)
        outdoors.sheet("quay_top", setts.data.materials[0], (-60.0, 0.0), (60.0, 30.0), cells=(24, 8))
        bpy.data.objects.remove(setts)
    tone = rng.uniform(0.8, 1.1)
    stone = street.brickwork(
        "quay_wall", (rgb(tone * c for c in (0.25, 0.23, 0.20)), rgb(tone * c for c in (0.17, 0.16, 0.14)))
    )
    wall = mesh.move(mesh.box("quay_wall", (120.0, 0.5, 2.0)), 0.0, 0.26, -2.02)
    mesh.set_material(wall, stone)
    stage.scene.put(
        "street_furniture.kerb", "coping", (0.0, 0.17), on=0.012, rng=rng, length_m=60.0, width_m=0.42
    )
    sheet = outdoors.sheet(
        "harbour", lakeside.lake_water("harbour_water"), (-60.0, -50.0), (60.0, 0.02), water_m, cells=(30, 20)
    )
    outdoors.retint(
        sheet, hue=rng.uniform(-0.04, 0.06), saturation=rng.uniform(0.6, 1.1), value=rng.uniform(0.9, 1.8)
    )


def _marks(stage: Stage, quay: outdoors.Area, water_m: float) -> None:
    rng = stage.rng("quay marks")
    colour = rng.choice(("red", "green", "blue", "white", "teal", "yellow"))
    side = rng.choice((-1, 1))
    at = side * rng.uniform(3.9, 4.4), rng.uniform(-0.95, -0.8)
    heading = side * 90.0 + rng.uniform(-5, 5)
    boat = stage.scene.put("rowing_boat", "boat", at, heading, on=water_m, rng=rng, colour=colour)
    stage.register(
        "rowing_boat",
        "boat",
        boat,
        at=at,
        heading_deg=heading,
        area=None,
        look=outdoors.Look("rowing_boat", {}, {"colour": colour}),
        landmark=True,
    )
    found = outdoors.put_round(stage, quay, [_BENCH], back_deg=(60.0, 120.0))
    bench = found["bench"].at
    outdoors.seats(stage, found["bench"])
    bollard = stage.landmark(
        "street_furniture.bollard",
        "bollard",
        (-side * rng.uniform(2.4, 2.9), 0.55),
        area=quay,
        radius_m=0.15,
        height_m=0.7,
    )
    more = rng.sample(
        (
            Mark("park_lamp", "lamp_post", 0.25, "any", low=False).of(glow=0.0),
            Mark("street_furniture.litter_bin", "bin", 0.3, "any", low=False),
            Mark("street_furniture.sign_post", "sign", 0.35, 10.0, low=False).of(text="QUAY", height_m=2.3),
            Mark("street_furniture.planter", "planter", 0.5, "any", low=False),
            Mark("market_stall", "stall", 1.25, low=False, away_m=1.1),
        ),
        2,
    )
    outdoors.put_round(stage, quay, more, back_deg=(8.0, 172.0), clear=[(bench, 1.0), (bollard.at, 0.4)])
    stage.dress("dock.rope_coil", "rope", (side * rng.uniform(2.7, 3.2), 0.75), rng.uniform(-180, 180))


def _town(stage: Stage, now: Day, water_m: float) -> None:
    """A row of tall houses along the quay, more boats, bollards and lamps."""
    rng = stage.rng("quay town")
    scene = stage.scene
    back = rng.uniform(7.0, 8.5)
    models = []
    for k, trade in enumerate(rng.sample(_TRADES, 3)):
        look = shopfront.ShopLook(
            trade,
            rng.choice(_WALLS),
            rgb(
                0.6 * c
                for c in outdoors.paint(rng.choice(("green", "navy", "brown", "red", "teal", "white")))
            ),
            rng.choice((None, None, outdoors.paint(rng.choice(("red", "navy", "green"))))),
            tuple(
                outdoors.paint(word) for word in rng.sample(("red", "yellow", "green", "beige", "blue"), 4)
            ),
            width_m=rng.uniform(4.6, 6.2),
            storeys=rng.choice((2, 3)),
        )
        models.append((scene.make("shopfront", f"house_model_{k}", rng, look=look), look.width_m))
    x, k = -26.0 + rng.uniform(-2, 2), 0
    while x < 26.0:
        model, width = models[k % 3]
        copy = mesh.duplicate(model, f"quay_house_{k}", linked=True)
        scene.place(copy, (x + width / 2, back + rng.uniform(0, 0.4)))
        x, k = x + width, k + 1
    for s in (-1.0, 1.0):
        for j in range(3):
            copy = mesh.duplicate(models[j][0], f"end_house_{s:.0f}_{j}", linked=True)
            scene.place(copy, (s * 32.0, 3.0 + 6.0 * j), -90.0 * s)
    for model, _ in models:
        bpy.data.objects.remove(model)
    for j, (x, y) in enumerate(((-9.0, 0.6), (7.5, 0.6), (12.0, 0.6), (-14.0, 0.6))):
        scene.put(
            "street_furniture.bollard", f"far_bollard_{j}", (x + rng.uniform(-1, 1), y), rng=rng, height_m=0.7
        )
    hull = scene.make("rowing_boat", "far_boat", rng, colour=rng.choice(("white", "brown", "navy")))
    scene.place(hull, (rng.choice((-1, 1)) * rng.uniform(9.0, 13.0), -0.95), 90.0, on=water_m)
    for j, x in enumerate((-6.5, 6.0)):
        at = x + rng.uniform(-1.0, 1.0), back - rng.uniform(0.5, 1.0)
        kind = rng.choice(
            ("street_furniture.planter", "farm_tools.milk_churn", "street_furniture.litter_bin")
        )
        scene.put(kind, f"clutter_{j}", at, rng=rng)
    trees = [(s * rng.uniform(9.0, 14.0), back - 2.2) for s in (-1, 1)]
    outdoors.plant(stage, now.season, "tree", trees, models=1, height_m=rng.uniform(4.8, 5.6))
