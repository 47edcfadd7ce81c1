"""Planning on the ground before anything is built: tries until a plan fits, and undoes what did not."""

from __future__ import annotations

import random
from collections.abc import Callable
from math import hypot
from typing import TypeVar

from .areas import Area, Flat
from .errors import NoRoom, Rejected
from .stage import Prop

T = TypeVar("T")


def fitting(area: Area, what: str, tries: int, plan: Callable[[], T]) -> T:
    """The first of `tries` plans that raises no `NoRoom`; the room that the others took is free again."""
    reasons: dict[str, int] = {}
    before = list(area.taken)
    for _ in range(tries):
        try:
            return plan()
        except NoRoom as error:
            reasons[str(error)] = reasons.get(str(error), 0) + 1
            area.taken = list(before)
    most = max(reasons, key=lambda reason: reasons[reason])
    raise Rejected(f"{what} found no room on {area.name} in {tries} tries, mostly: {most}")


def middles_near(
    area: Area, rng: random.Random, landmarks: list[Prop], clear_m: float, near_m: float
) -> list[Flat]:
    """Points with free room round them: of a few draws those that are near most landmarks."""
    found: list[tuple[int, Flat]] = []
    for _ in range(16):
        try:
            at = area.spot(rng, clear_m, tries=40)
        except NoRoom:
            break
        count = sum(hypot(at[0] - mark.at[0], at[1] - mark.at[1]) < near_m for mark in landmarks)
        found.append((count, at))
    found.sort(key=lambda row: -row[0])
    return [at for _, at in found[:6]] or [area.centre]
