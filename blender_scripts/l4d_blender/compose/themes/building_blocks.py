"""Building blocks on a table: hands push them, one block shoves another, some are lifted or stacked."""

from __future__ import annotations

import random
from functools import partial
from math import hypot
from typing import TYPE_CHECKING

from .. import looks
from ..areas import Area, retried
from ..errors import NoRoom
from ..hands.arms import reaches, willing
from ..hands.closeup import move_in, piece
from ..hands.handling import Deed, Item, rest_of
from . import theme

if TYPE_CHECKING:
    from ..stage import Stage

PAINTS = ("red", "orange", "yellow", "green", "teal", "blue", "purple", "white")
PIECE_M = (0.56, 0.44)
SIZE_M = {"small": 0.046, "large": 0.060}
STORIES = (
    ("push", "push"),
    ("push", "push"),
    ("push", "stack"),
    ("stack", "push"),
    ("push", "lift"),
    ("lift", "push"),
    ("stack", "lift"),
    ("lift", "stack"),
    ("turn", "push"),
)


@theme(
    "tabletop",
    needs=("table",),
    categories=("block",),
    verbs=("push", "slide", "lift", "put_down", "stack", "hold", "turn"),
)
def building_blocks(stage: Stage) -> None:
    """What one hand does with one block, another does later with another."""
    rng, whole = stage.rng("building blocks"), stage.area("table")
    table, items, deeds = retried(whole, 16, lambda: _plan(stage, rng, piece(rng, whole, PIECE_M)))
    move_in(stage, whole, table)
    for item in items:
        item.build(stage, rng, table)
    for deed in deeds:
        deed.play(stage, rng)
    stage.tell(f"{len(items)} blocks on a table; {len(deeds)} of them are pushed, turned, lifted or stacked.")


def _plan(stage: Stage, rng: random.Random, table: Area) -> tuple[Area, list[Item], list[Deed]]:
    """Who is handled how; those that hands take find room first."""
    options = {"colour": rng.sample(PAINTS, 3)}
    key = rng.choice(("figure", "size"))
    options[key] = rng.sample(looks.words_of("toy_block", key), 2)
    if key == "figure":
        options["size"] = ["large"]
    group = looks.crossed(rng, "toy_block", rng.choice((4, 5, 5)), options)
    items = [Item(f"block_{k + 1}", look, 0.72 * SIZE_M[look.words["size"]]) for k, look in enumerate(group)]
    order, arms = rng.sample(items, len(items)), reaches(stage, rng, table)
    deeds = []
    for k, verb in enumerate(rng.choice(STORIES)):
        item = order.pop()
        start = rng.randint(1, 6) if k == 0 else rng.randint(36, 42)
        size = SIZE_M[item.look.words["size"]]
        onto = order.pop() if verb == "stack" and order else None
        deed = Deed(verb, item, start, onto=onto, grip_m=0.6 * size)
        willing(arms, partial(deed.plan, rng, table))
        deeds.append(deed)
    for deed in deeds:
        if deed.verb == "push" and order and rng.random() < 0.6:
            _put_in_way(rng, table, deed, order.pop())
    rest_of(rng, table, order)
    return table, items, deeds


def _put_in_way(rng: random.Random, table: Area, deed: Deed, bumped: Item) -> None:
    """A block that the pushed one meets and shoves along."""
    x, y = deed.way_m
    way = hypot(x, y)
    ahead = x / way, y / way
    sizes = SIZE_M[deed.item.look.words["size"]], SIZE_M[bumped.look.words["size"]]
    gap = 0.5 * sum(sizes) + rng.uniform(0.25, 0.45) * way
    bumped.at = deed.item.at[0] + gap * ahead[0], deed.item.at[1] + gap * ahead[1]
    beyond = way - gap + 0.5 * sum(sizes) + 0.006
    end = bumped.at[0] + beyond * ahead[0], bumped.at[1] + beyond * ahead[1]
    assert deed.arm is not None
    if not table.is_free(bumped.at, bumped.radius_m, end, ignoring=(deed.item.name, deed.arm.name)):
        raise NoRoom(f"no way for {bumped.name} to be shoved")
    table.take(bumped.at, bumped.radius_m, end, owner=bumped.name)
    bumped.placed, deed.onto = True, bumped
    turn = deed.heading_deg
    deed.item.heading_deg, bumped.heading_deg = turn + rng.uniform(-6, 6), turn + rng.uniform(-12, 12)
