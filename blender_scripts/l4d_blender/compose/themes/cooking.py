"""Cooks at a counter with pots: one stirs and tastes, one pours, others wait."""

from __future__ import annotations

from typing import TYPE_CHECKING

from .. import cookery, folk
from ..actors import Actor, hire
from ..stage import Rejected
from . import theme

if TYPE_CHECKING:
    from ..stage import Stage

_VERBS = tuple("stir taste pour_into hold put_down circle stand wave".split())
_BACK_M, _APART_M = 0.15, 0.74


@theme("room", needs=("counter",), categories=("cook", "pot"), verbs=_VERBS)
def cooking(stage: Stage) -> None:
    """Three cooks in a row, a pot before each."""
    rng, counter = stage.rng("cooking"), stage.area("counter")
    (ax, ay), (bx, by) = counter.corners[:2]
    if abs(ay - by) > 0.05 or ax < bx:
        raise Rejected("cooks stand only behind counters that face the cameras")
    top_m, y = counter.point(0.0, 0.0)[2], ay + _BACK_M
    slack = (ax - bx) - 0.30 - 2 * _APART_M
    if slack < 0.0:
        raise Rejected("the counter is too short for three cooks")
    left = bx + 0.15 + rng.uniform(0.0, slack)
    xs = [left, left + _APART_M, left + 2 * _APART_M]
    figures = folk.cast(rng, "cook", 3)
    soup = rng.randrange(len(cookery.SOUPS))
    deeds = rng.sample(("stir", "pour", "wait"), 3)
    pots = []
    for n, (look, x, deed) in enumerate(zip(cookery.draw_pots(rng, 3), xs, deeds), 1):
        at = x + rng.uniform(-0.10, -0.02), y - cookery.AHEAD_M + rng.uniform(-0.03, 0.02)
        if not counter.is_free(at, 0.12):
            raise Rejected("a pot finds no room on the counter")
        pots.append(
            cookery.put_pot(
                stage, look, f"pot_{n}", at, top_m, rng.uniform(-40, 40) + 180.0, soup, deed == "pour"
            )
        )
    cooks = [hire(stage, figure, figure.name, (x, y), 0.0) for figure, x in zip(figures, xs)]
    for k, (cook, deed, x) in enumerate(zip(cooks, deeds, xs)):
        if deed == "stir":
            cookery.stir(rng, stage, cook, x, pots[k], None, top_m)
        elif deed == "pour":
            cookery.pour(rng, stage, cook, x, pots[k], top_m)
        else:
            _wait(rng, cook)
        cook.finish()
    stage.tell("Three cooks at work: one stirs, one pours, one waits.")


def _wait(rng, cook: Actor) -> None:
    """Stands by; waves for a while."""
    first = rng.randint(16, 50)
    cook.stand((0, first))
    cook.wave((first, first + rng.randint(34, 44)))
