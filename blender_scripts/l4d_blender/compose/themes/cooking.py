"""Cooks at a counter with pots: one stirs and tastes, one pours, others wait."""

from __future__ import annotations

import random
from math import hypot
from typing import TYPE_CHECKING

from ...motion import travellers
from ...motion.people import Person
from ...scene.timeline import LAST_FRAME
from ..areas import Area, Flat
from ..errors import Rejected
from ..people import cookery, folk
from ..people.bodies import add_person
from . import theme

if TYPE_CHECKING:
    from ..stage import Stage

_VERBS = tuple(["stir", "taste", "pour_into", "hold", "put_down", "circle", "stand", "phone"])
_BACK_M, _APART_M = 0.21, 0.74


@theme("room", needs=("counter", "hob"), categories=("cook", "pot"), verbs=_VERBS)
def cooking(stage: Stage) -> None:
    """Three cooks in a row, a pot before each."""
    rng, counter = stage.rng("cooking"), stage.area("counter")
    (ax, ay), (bx, by) = counter.corners[:2]
    if abs(ay - by) > 0.05 or ax < bx:
        raise Rejected("cooks stand only behind counters that face the cameras")
    top_m, y = counter.point(0.0, 0.0)[2], ay + _BACK_M
    xs, deeds, spots = _row(rng, counter, bx, ax, y)
    stage.film(stage.closer([(xs[0], y), (xs[2], y), *spots], height_m=1.12, margin_m=0.3, least_rise=0.25))
    figures = folk.cast(rng, "cook", 3)
    soup = rng.randrange(len(cookery.SOUPS))
    pots = []
    for n, (look, at, deed) in enumerate(zip(cookery.draw_pots(rng, 3), spots, deeds), 1):
        pots.append(
            cookery.put_pot(
                stage, look, f"pot_{n}", at, top_m, rng.uniform(-40, 40) + 180.0, soup, deed == "pour"
            )
        )
    block = [prop for prop in stage.landmarks if counter.margin(prop.at) > 0.1 and prop.height_m > 0.7]
    cooks = [add_person(stage, figure, figure.name, (x, y), 0.0) for figure, x in zip(figures, xs)]
    for k, (cook, deed, x) in enumerate(zip(cooks, deeds, xs)):
        if deed == "stir":
            cookery.stir(rng, stage, cook, x, pots[k], None, top_m)
        elif deed == "pour":
            cookery.pour(rng, stage, cook, x, pots[k], top_m)
        else:
            _wait(rng, cook)
        cook.finish()
        for prop in block:  # hands rest on it
            stage.may_touch(cook.instance, prop)
    stage.tell("Three cooks at work: one stirs, one pours, one waits.")


def _row(
    rng: random.Random, counter: Area, low: float, high: float, y: float
) -> tuple[list[float], list[str], list[Flat]]:
    """Where three cooks stand side by side, what each does, and a free spot for a pot before who works."""
    slack = high - low - 0.16 - 2 * _APART_M
    if slack < 0.0:
        raise Rejected("the counter is too short for three cooks")
    for _ in range(80):
        left = low + 0.08 + rng.uniform(0.0, slack)
        xs, deeds = [left, left + _APART_M, left + 2 * _APART_M], rng.sample(("stir", "pour", "wait"), 3)
        spots: list[Flat] = []
        for x, deed in zip(xs, deeds):
            at = x + rng.uniform(-0.14, 0.06), y - cookery.AHEAD_M + rng.uniform(-0.03, 0.04)
            if deed == "wait":
                at = x + rng.uniform(-0.3, 0.3), rng.uniform(counter.corners[2][1] + 0.17, y - 0.34)
            apart = all(hypot(at[0] - b[0], at[1] - b[1]) > 0.40 for b in spots)
            if not apart or not counter.is_free(at, 0.13):
                break
            spots.append(at)
        if len(spots) == 3:
            return xs, deeds, spots
    raise Rejected("a pot finds no room on the counter")


def _wait(rng: random.Random, cook: Person) -> None:
    """Stands by; telephones for a while."""
    first = rng.randint(44, 60)
    cook.stand((0, first - 28))
    travellers.phone(cook, (first, min(first + rng.randint(26, 40), LAST_FRAME)), side=rng.choice("lr"))
