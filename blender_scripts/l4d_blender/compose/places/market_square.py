"""A cobbled square before a row of shops, with a stall, benches and lamps."""

from __future__ import annotations

from typing import TYPE_CHECKING

import bpy

from ...assets import mesh, shopfront
from ...scene.colour import rgb
from ..settings import outdoors
from ..settings.outdoors import Mark
from . import place

if TYPE_CHECKING:
    from ..settings.outdoors import Day
    from ..stage import Stage

_BENCH = Mark("street_bench", "bench", 0.85, low=False, away_m=-0.05)
_BACK = (
    Mark("park_lamp", "lamp_post", 0.25, "any", low=False).of(glow=0.0),
    Mark("street_furniture.sign_post", "sign", 0.35, 15.0, low=False).of(text="MARKET", height_m=2.5),
    Mark("street_furniture.litter_bin", "bin", 0.3, "any", low=False),
    Mark("well", "well", 0.85, 0.0, low=False),
)
_INSIDE = (
    Mark("plant_pot", "plant", 0.2, "any").of(pot_radius_m=0.14, pot_height_m=0.22, spread_m=0.26, leaves=60),
    Mark("street_furniture.bollard", "bollard", 0.15, "any"),
    Mark("wooden_chair", "chair", 0.32, "any"),
)
_CLOTHS = ("red", "green", "navy", "orange", "teal", "purple")
_WALLS = ((0.58, 0.47, 0.30), (0.62, 0.56, 0.50), (0.45, 0.50, 0.52), (0.60, 0.42, 0.30), "brick", "brick")
_TRADES = ("BOOKS", "FLOWERS", "CAFE", "TEA", "SHOES", "TOYS", "FISH", "HATS", "WINE")


@place("outdoor", "lawn", "chairs")
def market_square(stage: Stage) -> None:
    """Setts all over, houses on three sides."""
    rng = stage.rng("market square")
    now = outdoors.day(stage)
    setts = stage.scene.make("cobbles", "setts", rng)
    outdoors.retint(
        setts, hue=rng.uniform(-0.02, 0.02), saturation=rng.uniform(0.4, 1.3), value=rng.uniform(0.75, 1.15)
    )
    lawn = stage.add_area(outdoors.yard("lawn", (5.4, 4.2)))
    marks = outdoors.put_round(stage, lawn, [_BENCH], back_deg=(20.0, 160.0))
    bench = marks["bench"].at
    outdoors.seats(stage, marks["bench"])
    cloth, skirt = (outdoors.paint(word) for word in rng.sample(_CLOTHS, 2))
    stall = Mark("market_stall", "stall", 1.25, low=False, away_m=1.0).of(
        stripes=(cloth, outdoors.paint("white")), skirt=skirt
    )
    found = outdoors.put_round(stage, lawn, [stall], back_deg=(35.0, 145.0), clear=[(bench, 0.9)])
    outdoors.put_in(stage, lawn, [rng.choice(_INSIDE)])
    clear = [(bench, 1.0), *((prop.at, 1.3) for prop in found.values())]
    outdoors.put_round(stage, lawn, rng.sample(_BACK, 2), clear=clear)
    _shops(stage, now)
    outdoors.cameras(stage, (0.0, -0.15, 0.55), radius_m=5.4, fov_deg=54.0)
    stage.tell(f"A market square on {now.words}.")


def _shops(stage: Stage, now: Day) -> None:
    """Houses along the far side and down both flanks, more stalls, planters and trees before them."""
    rng = stage.rng("shops")
    scene = stage.scene
    back_y = rng.uniform(8.0, 9.5)
    trades = rng.sample(_TRADES, 3)
    models = []
    for k, trade in enumerate(trades):
        look = shopfront.ShopLook(
            trade,
            rng.choice(_WALLS),
            rgb(
                0.6 * c
                for c in outdoors.paint(rng.choice(("green", "navy", "brown", "red", "teal", "black")))
            ),
            rng.choice((None, outdoors.paint(rng.choice(_CLOTHS)))),
            tuple(
                outdoors.paint(word)
                for word in rng.sample(list(("red", "yellow", "green", "beige", "blue")), 4)
            ),
            width_m=rng.uniform(5.2, 6.4),
            storeys=rng.choice((2, 2, 3)),
        )
        models.append((scene.make("shopfront", f"shop_model_{k}", rng, look=look), look.width_m))
    spots, x, k = [], -17.0 + rng.uniform(-2, 2), 0
    while x < 17.0:
        width = models[k % 3][1]
        spots.append((k % 3, (x + width / 2, back_y), 0.0))
        x, k = x + width, k + 1
    for side in (-1.0, 1.0):
        for j in range(3):
            spots.append(((k + j) % 3, (side * 14.0, back_y - 4.5 - 6.0 * j), -side * 90.0))
        k += 1
    for j, (which, at, heading) in enumerate(spots):
        scene.place(mesh.duplicate(models[which][0], f"shop_{j}", linked=True), at, heading)
    for model, _ in models:
        bpy.data.objects.remove(model)
    for j, x in enumerate((-9.0, -5.0, 4.5, 9.5)):
        at = x + rng.uniform(-1, 1), back_y - rng.uniform(0.6, 1.2)
        kind = rng.choice(
            ("street_furniture.planter", "street_furniture.planter", "street_furniture.litter_bin")
        )
        scene.put(kind, f"clutter_{j}", at, rng=rng)
    trees = [(s * rng.uniform(6.5, 9.5), rng.uniform(5.2, back_y - 2.0)) for s in (-1, 1)]
    outdoors.plant(stage, now.season, "tree", trees, models=1, height_m=rng.uniform(4.8, 5.8))
    far = rng.choice((-1, 1)) * rng.uniform(6.0, 8.5)
    scene.put("market_stall", "far_stall", (far, back_y - 2.6), rng.uniform(-20, 20), rng=rng, crates=2)
