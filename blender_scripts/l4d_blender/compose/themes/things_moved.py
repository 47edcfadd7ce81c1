"""Things on a table that hands lift, carry, slide, turn, touch and point at."""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

from ..areas import retried
from ..errors import Rejected
from ..hands import handwork
from ..hands.graspables import GRASPABLES, Graspable
from . import theme

if TYPE_CHECKING:
    from ..stage import Stage

LIFTED = (
    "cup",
    "coffee_table.mug",
    "apple",
    "ball",
    "toy_block",
    "toy_car",
    "computer_mouse",
    "biscuit_tin",
    "sugar_bowl",
    "kitchen_clutter.jar",
    "kitchen_clutter.bottle",
    "spoon",
    "marker_pen",
    "yarn_ball",
)
SLID = (
    "book",
    "notebook.shut_notebook",
    "computer_mouse",
    "toy_car",
    "biscuit_tin",
    "cup",
    "teapot",
    "sugar_bowl",
    "toy_block",
)
ROLLED = ("apple", "ball", "yarn_ball", "marker_pen")


def _nouns(*kinds: str) -> tuple[str, ...]:
    return tuple(sorted({GRASPABLES[kind].noun for kind in kinds}))


def _verbs(acts: Mapping[str, float]) -> tuple[str, ...]:
    return tuple(sorted({verb for act in acts for verb in handwork.VERBS[act]}))


_MOVED = {"transfer": 5.0, "lift": 3.0, "point": 1.0, "turn": 0.7, "move": 0.7}
_SLID = {"push": 3.0, "pull": 2.0, "move": 2.0, "turn": 2.0, "touch": 1.2, "point": 0.8}
_ROLLED = {"roll": 6.0, "lift": 1.5, "transfer": 1.0, "point": 1.0, "touch": 0.5}


@theme("tabletop", needs=("table",), categories=_nouns(*LIFTED), verbs=_verbs(_MOVED))
def things_moved(stage: Stage) -> None:
    """Hands lift things, carry them to trays, plates, books or other spots, and set them down."""
    _play(stage, "things moved", LIFTED, (), _MOVED, ("transfer", "transfer", None))


@theme("tabletop", needs=("table",), categories=_nouns(*SLID), verbs=_verbs(_SLID))
def things_slid(stage: Stage) -> None:
    """Hands push, pull, move and turn things on the table top."""
    _play(stage, "things slid", SLID, (), _SLID, ("push", "pull", "move", "turn", None))


@theme("tabletop", needs=("table",), categories=_nouns(*ROLLED, *LIFTED), verbs=_verbs(_ROLLED))
def things_rolled(stage: Stage) -> None:
    """Hands send round things rolling, which run on by themselves and come to rest."""
    _play(stage, "things rolled", ROLLED, LIFTED, _ROLLED, ("roll",))


def _play(
    stage: Stage,
    key: str,
    first: Sequence[str],
    second: Sequence[str],
    acts: Mapping[str, float],
    musts: Sequence[str | None],
) -> None:
    rng, table = stage.rng(key), stage.area("table")
    acts = {
        act: weight * (6.0 if set(handwork.VERBS[act]) & set(stage.spec.verbs) else 1.0)
        for act, weight in acts.items()
    }
    must = rng.choice(musts)
    plan = retried(
        table, 200, lambda: handwork.draw(stage, rng, table, _groups(stage, rng, first, second), acts, must)
    )
    handwork.perform(stage, rng, table, plan)
    kinds = list(dict.fromkeys(item.of.kind for item in plan.items))
    cast = " and ".join(
        f"{len([i for i in plan.items if i.of.kind == kind])} {GRASPABLES[kind].noun}s" for kind in kinds
    )
    hands = len({task.arm.name for task in plan.tasks})
    stage.tell(f"On the table are {cast.replace('_', ' ')}; {hands} hands move some of them.")


def _groups(
    stage: Stage, rng: random.Random, first: Sequence[str], second: Sequence[str]
) -> list[tuple[Graspable, int]]:
    """One or two kinds that no landmark is one of; those that are demanded first."""
    there = {prop.instance.category for prop in stage.landmarks}
    wanted = set(stage.spec.categories)
    free = [kind for kind in first if GRASPABLES[kind].noun not in there]
    if not free:
        raise Rejected("all nouns are taken by landmarks")
    demanded = [kind for kind in free if GRASPABLES[kind].noun in wanted]
    kinds = [rng.choice(demanded or free)]
    others = [
        kind
        for kind in (second or first)
        if GRASPABLES[kind].noun not in {*there, GRASPABLES[kinds[0]].noun}
        and GRASPABLES[kind].radius_m + GRASPABLES[kinds[0]].radius_m < 0.17
    ]
    left = [kind for kind in others if GRASPABLES[kind].noun in wanted]
    if left or (others and rng.random() < 0.5):
        kinds.append(rng.choice(left or others))
    sizes = (3, 3) if len(kinds) == 2 else (rng.choice((3, 4, 4, 5)),)
    return [
        (GRASPABLES[kind], min(size, 3) if GRASPABLES[kind].radius_m > 0.12 else size)
        for kind, size in zip(kinds, sizes)
    ]
