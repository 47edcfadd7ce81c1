"""Balls, balls of wool and toy mice on the ground: their looks, and how those of a plan are put there."""

from __future__ import annotations

import random
from typing import Any

from ...motion.ball_games import Ball
from ...scene import catalogue
from .. import looks
from ..areas import Area
from ..stage import Stage
from .members import Toy

_WOOL = ("red", "blue", "green", "yellow", "purple", "orange", "white", "grey")
_PAINT = ("red", "blue", "yellow", "purple", "orange", "green")


def wool_and_mice(rng: random.Random) -> list[Toy]:
    """Toys for cats: balls of wool and stuffed mice, or wool in two sizes; colours cross with that."""
    if rng.random() < 0.5:
        options = {"kind": ("yarn_ball", "mouse"), "colour": _WOOL}
        group = looks.crossed(rng, "yarn_ball", 4, options)
    else:
        group = looks.crossed(
            rng, "yarn_ball", rng.choice((3, 4)), {"size": ("small", "large"), "colour": _WOOL}
        )
    small, large = rng.uniform(0.088, 0.094), rng.uniform(0.118, 0.126)
    toys = []
    for look in group:
        if look.words.get("kind") == "mouse":
            toys.append(Toy(look, 0.09, 0.12))
        else:
            radius = large if look.words.get("size") == "large" else small
            toys.append(Toy(look, radius, 2 * radius))
    return toys


def balls(rng: random.Random, radius_m: tuple[float, float]) -> list[Toy]:
    """Balls of one size, colours and patterns cross."""
    options = {"colour": _PAINT, "pattern": looks.words_of("ball", "pattern")}
    radius = rng.uniform(*radius_m)
    return [
        Toy(look, radius, 2 * radius) for look in looks.crossed(rng, "ball", rng.choice((3, 3, 4)), options)
    ]


def rolls(toy: Toy) -> bool:
    """Whether it rolls when struck."""
    return toy.look.words.get("kind") != "mouse"


def put_ball(stage: Stage, area: Area, toy: Toy, k: int) -> Ball:
    """As `put`, for a toy that rolls."""
    ball = put(stage, area, toy, k)
    assert ball is not None
    return ball


def put(stage: Stage, area: Area, toy: Toy, k: int) -> Ball | None:
    """Makes a toy of the plan and registers it; what rolls comes back as a ball to play with."""
    assert toy.at is not None
    category = "ball" if toy.look.kind == "ball" else "toy"
    name, rng = f"{category}_{k + 1}", stage.rng(f"toy/{k}")
    words: dict[str, Any] = {key: word for key, word in toy.look.words.items() if key not in ("kind", "size")}
    heading = rng.uniform(-180.0, 180.0)
    if rolls(toy):
        kind, size = toy.look.kind, {"radius_m": toy.radius_m}
    else:
        kind, size = "toy_mouse", {"length_m": 0.25}
    thing = stage.scene.put(kind, name, toy.at, heading, rng=rng, on=area.on, **words, **size)
    front = catalogue.find(kind).front
    prop = stage.register(
        kind, name, thing, at=toy.at, heading_deg=heading, area=None, look=toy.look, front=front
    )
    if not rolls(toy):
        return None
    return Ball(prop.instance, toy.radius_m, toy.at, area.point(*toy.at)[2], turn=rng.uniform(0.0, 6.0))
