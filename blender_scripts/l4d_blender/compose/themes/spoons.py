"""Bowls of soup and spoons: one stirs and is laid down, another rides in its bowl, one is lifted."""

from __future__ import annotations

import random
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

from ...scene import catalogue
from ...scene.cameras import Camera
from .. import looks
from ..areas import Area, retried
from ..errors import NoRoom
from ..hands.arms import reaches, willing
from ..hands.graspables import apart
from ..hands.handling import Item
from ..hands.penwork import Oblong
from ..hands.spoonwork import BOWL, BOWL_M, SHAPE, Lift, PushWithSpoon, Stir, lean_in, lie_free, spoon_item
from ..looks import Look
from ..sight import Bulk, hidden
from . import theme

if TYPE_CHECKING:
    from ..stage import Stage

GLAZES = ("red", "yellow", "green", "teal", "blue", "purple", "white")
GRIPS = ("red", "yellow", "green", "blue", "black", "white")
NEAR_M = 0.36
Deed = Stir | PushWithSpoon | Lift
STORIES = (("stir", "push"), ("stir", "lift"), ("push", "stir"), ("lift", "stir"), ("push", "lift"))


@theme(
    "tabletop",
    needs=("table", "clear"),
    categories=("spoon", "bowl"),
    verbs=("stir", "circle", "carry", "put_down", "hold", "push", "slide", "ride", "lift"),
)
def spoons(stage: Stage) -> None:
    """Two hands act, one after the other or at once."""
    rng, table = stage.rng("spoons"), stage.area("table")
    bowls, others, deeds, leaning, rig = retried(table, 200, lambda: _plan(stage, rng, table))
    stage.film(rig)
    for bowl in bowls:
        bowl.build(stage, rng, table)
    for deed in deeds:
        deed.build(rng, stage, table)
    for item in others:
        if item.name in leaning:
            lean_in(rng, stage, table, item, leaning[item.name], rng.uniform(-180.0, 180.0))
        else:
            lie_free(stage, table, item)
    for deed in deeds:
        deed.play(rng, stage, table)
    stage.tell(f"{len(bowls)} bowls of soup and {len(others) + len(deeds)} spoons, two of which are used.")


def _plan(
    stage: Stage, rng: random.Random, table: Area
) -> tuple[list[Item], list[Oblong], list[Deed], dict[str, Item], list[Camera]]:
    """What hands use finds room first; the last are spoons that lie, or lean in a bowl, all the time."""
    bowls = []
    for k, look in enumerate(looks.crossed(rng, "soup_bowl", 3, {"colour": apart(rng, GLAZES, 2)})):
        glaze = catalogue.COLOURS[look.words["colour"]]
        shaped = Look("soup_bowl", {"look": replace(BOWL, glaze=glaze)}, look.attributes)
        bowls.append(Item(f"bowl_{k + 1}", shaped, BOWL_M))
    options = {"grip": apart(rng, GRIPS), "end": ("plain", "ring")}
    spoons = []
    for k, look in enumerate(looks.crossed(rng, "spoon", rng.choice((3, 3, 4)), options)):
        shape = replace(SHAPE, grip=catalogue.COLOURS[look.words["grip"]], ring=look.words["end"] == "ring")
        spoons.append(spoon_item(f"spoon_{k + 1}", Look("spoon", {"look": shape}, look.attributes)))
    free, vessels = rng.sample(spoons, len(spoons)), rng.sample(bowls, len(bowls))
    arms, deeds = reaches(stage, rng, table), []
    for k, verb in enumerate(rng.choice(STORIES)):
        start = rng.randint(1, 8) if k == 0 else rng.choice((rng.randint(4, 14), rng.randint(22, 26)))
        if verb == "lift":
            deed: Deed = Lift(free.pop(), start)
        else:
            deed = (Stir if verb == "stir" else PushWithSpoon)(free.pop(), vessels.pop(), start)
        willing(arms, partial(deed.plan, rng, table))
        deeds.append(deed)
    leaning = {}
    middle = deeds[0].spoon.at
    for bowl in vessels:
        bowl.place(table, table.spot(rng, BOWL_M, near=middle, within_m=(0.1, NEAR_M)))
    for item in free:
        if vessels and rng.random() < 0.4:
            leaning[item.name] = vessels.pop()
            item.at = leaning[item.name].at
        else:
            item.lie_near(rng, table, middle, 0.0, 180.0)
    return bowls, free, deeds, leaning, _seen(stage, spoons, bowls, deeds, leaning)


def _seen(
    stage: Stage, spoons: list[Oblong], bowls: list[Item], deeds: list[Deed], leaning: dict[str, Item]
) -> list[Camera]:
    """Cameras near enough; refuses a plan in which things hide each other."""
    ends = [deed.end for deed in deeds if isinstance(deed, PushWithSpoon)]
    points = [item.at for item in (*spoons, *bowls)] + ends
    rig = stage.closer(points, height_m=0.03, margin_m=0.11)
    bulks = [Bulk(bowl.at, BOWL.rim_m[0], BOWL.rim_m[1]) for bowl in bowls]
    marks = [Bulk(prop.at, 0.7 * prop.radius_m, prop.height_m) for prop in stage.landmarks]
    high = {deed.spoon.name for deed in deeds if not isinstance(deed, Lift)} | set(leaning)
    for item in spoons:
        bulks.append(Bulk(item.at, 0.027, 0.034, BOWL.rim_m[1] + 0.002 if item.name in high else 0.0))
    if hidden(rig, [bulks], marks):
        raise NoRoom("something would hardly be seen")
    return rig
