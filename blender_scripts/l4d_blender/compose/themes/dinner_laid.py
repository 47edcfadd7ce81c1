"""Bowls and apples on a table: hands push bowls, lift or turn apples, and an apple rocks by itself."""

from __future__ import annotations

import random
from functools import partial
from math import cos, radians, sin
from typing import TYPE_CHECKING

from mathutils import Vector

from ...assets import apple, soup_bowl
from ...motion.rolling import Round, rock
from .. import looks
from ..areas import Area, retried
from ..hands.arms import reaches, willing
from ..hands.closeup import move_in, piece
from ..hands.handling import Deed, Item, rest_of
from ..looks import Look
from . import theme

if TYPE_CHECKING:
    from ..stage import Stage

PIECE_M = (0.68, 0.50)
GLAZES = ("red", "orange", "yellow", "green", "teal", "blue", "purple", "white")
BOWL = soup_bowl.Look(rim_m=(0.070, 0.052), foot_m=0.036)
BOWL_M, APPLE_M = 0.072, 0.043
STORIES = (
    ("push bowl", "push bowl"),
    ("push bowl", "lift apple"),
    ("lift apple", "push bowl"),
    ("turn apple", "push bowl"),
    ("push bowl", "turn apple"),
    ("lift apple", "lift apple"),
    ("turn apple", "lift apple"),
)


@theme(
    "tabletop",
    needs=("table",),
    categories=("apple", "bowl"),
    verbs=("push", "slide", "lift", "put_down", "hold", "turn", "rock"),
)
def dinner_laid(stage: Stage) -> None:
    """Two hands act, one after the other; perhaps an apple rocks."""
    rng, whole = stage.rng("dinner laid"), stage.area("table")
    table, items, deeds, rests = retried(whole, 16, lambda: _plan(stage, rng, piece(rng, whole, PIECE_M)))
    move_in(stage, whole, table)
    for item in items:
        item.build(stage, rng, table)
    if rests and rng.random() < 0.6:
        _rock(rng, rng.choice(rests))
    for deed in deeds:
        deed.play(stage, rng)
    apples = sum(item.look.kind == "apple" for item in items)
    stage.tell(f"{apples} apples and {len(items) - apples} bowls of soup; hands move some of them.")


def _plan(stage: Stage, rng: random.Random, table: Area) -> tuple[Area, list[Item], list[Deed], list[Item]]:
    """What hands move first, then the rest; the last are the apples that no hand moves."""
    options = {"colour": ["red", "green", "yellow"], "state": ["whole", "bitten"], "size": ["large"]}
    apples = [
        Item(f"apple_{k + 1}", look, APPLE_M)
        for k, look in enumerate(looks.crossed(rng, "apple", rng.choice((3, 4, 4)), options))
    ]
    bowls = []
    for k, look in enumerate(looks.crossed(rng, "soup_bowl", 3, {"colour": rng.sample(GLAZES, 2)})):
        small = Look("soup_bowl", {"look": BOWL, **look.words}, look.attributes)
        bowls.append(Item(f"bowl_{k + 1}", small, BOWL_M))
    queues = {"apple": rng.sample(apples, len(apples)), "bowl": rng.sample(bowls, len(bowls))}
    arms, deeds = reaches(stage, rng, table), []
    for k, what in enumerate(rng.choice(STORIES)):
        verb, noun = what.split()
        start = rng.randint(1, 8) if k == 0 else rng.randint(36, 42)
        deed = Deed(verb, queues[noun].pop(), start, lengths_m=(0.07, 0.15), grip_m=0.034)
        willing(arms, partial(deed.plan, rng, table))
        deeds.append(deed)
    rest_of(rng, table, [*queues["bowl"], *queues["apple"]])
    return table, [*apples, *bowls], deeds, queues["apple"]


def _rock(rng: random.Random, item: Item) -> None:
    """Somebody has just touched it: it rocks to and fro and settles."""
    assert item.thing is not None
    first, turn = rng.choice((rng.randint(2, 12), rng.randint(40, 52))), radians(rng.uniform(0.0, 360.0))
    fruit = Round(item.thing, apple.Look().radius_m, apple.Look().middle)
    axis = Vector((cos(turn), sin(turn), 0.0))
    rock(fruit, axis, (first, first + rng.randint(30, 40)), swing_deg=rng.uniform(20.0, 28.0))
