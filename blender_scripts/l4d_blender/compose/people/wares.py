"""What people carry: how each noun is gripped and cast, and where it is while it is in a hand.

Owns handles and looks; knows nothing of people or places.
"""

from __future__ import annotations

import random
from collections.abc import Callable
from dataclasses import dataclass, replace

from ...assets import bags, basket, bucket, dumbbell, suitcase, teddy
from .. import looks
from ..looks import Look

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Ware:
    """A noun that hands take: `grips` in its own space (two: both hands), the direction of its handle."""

    noun: str
    grips: Callable[[Look], tuple[Point, ...]]
    bar: Point | None
    clear_m: float
    radius_m: float
    height_m: float
    draw: Callable[[random.Random, int], list[Look]]
    carry: str = "side"
    wide: float = 0.9  # what is seen of its width, as a share

    @property
    def two_hands(self) -> bool:
        """Whether both hands are needed."""
        return self.carry != "side"

    def reach_m(self, look: Look, scale: float) -> float:
        """How far ahead of somebody with this scale it lies well, in metres: low things want to be near."""
        if not self.two_hands:
            return 0.36 * scale
        height = self.grips(look)[0][2] / scale
        return scale * min(max(0.22 + 1.0 * (height - 0.14), 0.22), 0.38)

    def grip_of(self, look: Look) -> tuple[Point, ...] | Point:
        """As `Person.lift` wants it."""
        grips = self.grips(look)
        return grips if len(grips) == 2 else grips[0]

    def hold_of(self, look: Look) -> tuple[Point, ...] | Point:
        """As `Person.hold` wants it: the left hand's comes first."""
        if self.two_hands:
            return tuple(sorted(self.grips(look), key=lambda point: -point[0]))
        return self.grip_of(look)


# ---- looks -------------------------------------------------------------------------------------------


def _buckets(rng: random.Random, count: int) -> list[Look]:
    options = {
        "look": ("galvanised", "red", "blue", "green", "yellow", "white", "orange"),
        "content": ("empty", "water", "grain"),
    }
    return looks.crossed(rng, "bucket", count, options)


def _baskets(rng: random.Random, count: int) -> list[Look]:
    options = {
        "wicker": ("light", "dark"),
        "cloth": tuple(basket.CLOTHS),
        "content": ("empty", *basket.FRUIT),
    }
    return looks.crossed(rng, "basket", count, options)


def _bags(rng: random.Random, count: int) -> list[Look]:
    words = {"kind": ("duffel", "backpack"), "colour": ("brown", "green", "red", "yellow", "grey")}
    members = looks.crossed(rng, "bags.duffel", count, words)
    return [Look(f"bags.{m.words['kind']}", {"colour": m.words["colour"]}, m.attributes) for m in members]


def _suitcases(rng: random.Random, count: int) -> list[Look]:
    options = {
        "colour": ("teal", "red", "navy", "yellow", "grey", "pink", "orange"),
        "shell": ("ribbed", "soft"),
        "size": ("cabin", "large"),
    }
    return looks.crossed(rng, "suitcase", count, options)


def balls(radius_m: float) -> Ware:
    """Balls of a size; two hands carry one."""

    def draw(rng: random.Random, count: int) -> list[Look]:
        options = {
            "colour": ("red", "orange", "green", "blue", "purple"),
            "pattern": ("striped", "dotted", "banded"),
        }
        members = looks.crossed(rng, "ball", count, options)
        return [Look("ball", {**m.words, "radius_m": radius_m}, m.attributes) for m in members]

    grips = ((-radius_m, 0.0, radius_m), (radius_m, 0.0, radius_m))
    return Ware("ball", lambda _: grips, None, 0.09, radius_m, 2 * radius_m, draw, "chest", 1.1)


def _teddies(rng: random.Random, count: int) -> list[Look]:
    return looks.crossed(
        rng, "teddy", count, {"colour": ("brown", "cream", "grey"), "ribbon": tuple(teddy.RIBBONS)}
    )


DUMBBELL_COLOURS = {"black": (0.030, 0.031, 0.034), "red": (0.45, 0.03, 0.03), "blue": (0.03, 0.12, 0.42)}


def _dumbbells(rng: random.Random, count: int) -> list[Look]:
    words = {"shape": ("hex", "round"), "colour": ("black", "red", "blue")}
    made = {"hex": dumbbell.hexagonal, "round": dumbbell.round_plates}
    found = []
    for member in looks.crossed(rng, "dumbbell", count, words):
        colour = DUMBBELL_COLOURS[member.words["colour"]]
        look = replace(made[member.words["shape"]](colour, (0.55, 0.55, 0.56)), radius_m=0.112, head_m=0.12)
        found.append(Look("dumbbell", {"look": look}, member.attributes))
    return found


def _bag_grips(look: Look) -> tuple[Point, ...]:
    return (tuple(bags.DUFFEL_GRIP if look.kind.endswith("duffel") else bags.BACKPACK_GRIP),)


def _dumbbell_grips(look: Look) -> tuple[Point, ...]:
    return (look.words["look"].grip,)


looks.PROPERTIES[("bucket", "look")] = {
    "galvanised": {"colour": "grey", "material": "metal"},
    **{paint: {"colour": paint, "material": "painted"} for paint in ("red", "blue", "green", "yellow")},
    **{paint: {"colour": paint, "material": "painted"} for paint in ("white", "orange")},
}

WARES = {
    ware.noun: ware
    for ware in (
        Ware(
            "bucket",
            lambda _: ((0.0, 0.0, bucket.GRIP_Z_M),),
            (1.0, 0.0, 0.0),
            bucket.RIM_RADIUS_M,
            0.19,
            bucket.HEIGHT_M,
            _buckets,
        ),
        Ware(
            "basket",
            lambda _: ((0.0, 0.0, basket.GRIP_Z_M),),
            (1.0, 0.0, 0.0),
            basket.RIM_RADII_M[1],
            0.23,
            0.40,
            _baskets,
        ),
        Ware("bag", _bag_grips, (1.0, 0.0, 0.0), 0.13, 0.26, 0.40, _bags),
        Ware("teddy", lambda _: teddy.SIDES_M, None, 0.10, 0.16, teddy.HEIGHT_M, _teddies, "chest"),
        balls(0.14),
        Ware(
            "suitcase",
            lambda _: ((0.0, 0.0, suitcase.HANDLE_OUT_M),),
            (1.0, 0.0, 0.0),
            0.2,
            0.30,
            0.85,
            _suitcases,
        ),
        Ware("dumbbell", _dumbbell_grips, (0.0, 1.0, 0.0), 0.1, 0.20, 0.22, _dumbbells),
    )
}
"""By noun."""
