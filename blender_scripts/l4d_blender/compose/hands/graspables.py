"""Small things that hands at a table move: how each is taken, how much room it needs, what it may look like.

Knows kinds of the catalogue and grips of hands; refuses to know who moves what.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from ...assets import spoon
from ...scene import catalogue
from ...scene.catalogue import COLOURS
from .. import looks
from ..looks import Look

NEAR: tuple[frozenset[str], ...] = tuple(
    frozenset(pair.split())
    for pair in (
        "red orange",
        "orange yellow",
        "orange brown",
        "red brown",
        "yellow beige",
        "beige white",
        "white grey",
        "grey black",
        "black navy",
        "navy blue",
        "navy purple",
        "blue teal",
        "blue purple",
        "teal green",
        "teal navy",
        "brown black",
        "brown purple",
        "grey beige",
        "grey teal",
        "light_blue blue",
        "light_blue white",
        "light_green green",
        "light_green yellow",
    )
)
"""Colours that pass for one another in poor light."""


@dataclass(frozen=True)
class Graspable:
    """A kind that hands move.

    `radius_m` is the disc that it needs in plan, `foot_m` that on which it stands. `grip` is for lifting,
    `slide` for moving it along (None: it isn't). `options` are the looks that may cross in a group, `fixed`
    arguments of all. `rolls_m` is the radius on which it rolls, about an axle along its `axle`: a ball has
    none, an apple lies on its side then ("z"), a pen always does ("x").
    """

    kind: str
    radius_m: float
    foot_m: float
    height_m: float
    grip: str | None
    slide: str | None
    options: Mapping[str, Sequence[str]]
    fixed: Mapping[str, Any] = field(default_factory=dict)
    rolls_m: float | None = None
    axle: str | None = None
    aim_m: float | None = None
    thin_m: float | None = None  # half as wide as it looks, if that is less than its size says

    @property
    def seen_m(self) -> float:
        """Half as wide as it looks on the average."""
        x, y, _ = catalogue.find(self.kind).size_m
        return self.thin_m or min(0.25 * (x + y), self.radius_m)

    @property
    def noun(self) -> str:
        """The category."""
        return catalogue.find(self.kind).category

    def group(self, rng: random.Random, count: int) -> list[Look]:
        """Looks of a group: twins, and properties that cross."""
        options = {
            key: apart(rng, words) if key in ("colour", "grip") else list(words)
            for key, words in self.options.items()
        }
        if len(options) == 1:
            count = 3
        return looks.crossed(rng, self.kind, count, options)


def apart(rng: random.Random, words: Sequence[str], count: int = 3) -> list[str]:
    """Some of the colours, none of which passes for another."""
    found: list[str] = []
    for word in rng.sample(list(words), len(words)):
        if len(found) < count and not any({word, other} in NEAR for other in found):
            found.append(word)
    return found


_ALL = tuple(COLOURS)
_PAINTS = ("red", "orange", "yellow", "green", "blue", "purple", "light_blue", "light_green", "black")
_PEN = {"colour": _ALL, "pattern": ("plain", "banded")}

GRASPABLES: dict[str, Graspable] = {
    g.kind: g
    for g in (
        Graspable(
            "cup",
            0.066,
            0.032,
            0.10,
            "side",
            "side",
            {
                "colour": _ALL,
                "pattern": ("plain", "rim_band", "stripes", "speckled"),
                "content": ("empty", "coffee"),
                "shape": ("tall", "wide"),
            },
            aim_m=0.055,
        ),
        Graspable("coffee_table.mug", 0.064, 0.034, 0.092, "side", "side", {"colour": _ALL}, aim_m=0.05),
        Graspable(
            "apple",
            0.044,
            0.02,
            0.083,
            "crown",
            "crown",
            {"colour": ("red", "green", "yellow"), "state": ("whole", "bitten")},
            rolls_m=0.039,
            axle="z",
        ),
        Graspable(
            "ball",
            0.04,
            0.012,
            0.076,
            "top",
            "top",
            {"colour": _PAINTS, "pattern": ("striped", "dotted", "banded")},
            {"radius_m": 0.038, "mark": "white"},
            rolls_m=0.038,
        ),
        Graspable(
            "yarn_ball",
            0.046,
            0.015,
            0.086,
            "top",
            "top",
            {"colour": _ALL},
            {"radius_m": 0.043},
            rolls_m=0.043,
        ),
        Graspable(
            "toy_block",
            0.036,
            0.022,
            0.047,
            "top",
            "top",
            {"colour": _ALL, "figure": ("star", "moon", "heart", "letter")},
        ),
        Graspable("toy_car", 0.066, 0.03, 0.071, "top", "push", {"colour": _ALL}),
        Graspable("book", 0.137, 0.06, 0.03, None, "flat", {"colour": _ALL}),
        Graspable(
            "notebook.shut_notebook",
            0.134,
            0.06,
            0.016,
            None,
            "flat",
            {"colour": _ALL, "pattern": ("plain", "dotted")},
        ),
        Graspable("computer_mouse", 0.066, 0.03, 0.038, "top", "mouse", {"colour": ("black", "white")}),
        Graspable(
            "marker_pen", 0.076, 0.02, 0.016, "pinch", "push", _PEN, rolls_m=0.008, axle="x", thin_m=0.031
        ),
        Graspable(
            "spoon",
            0.11,
            0.02,
            0.02,
            "pinch",
            "push",
            {"grip": ("red", "yellow", "green", "blue", "black", "white")},
            {"look": spoon.Look(0.205, (0.050, 0.072), (0.008, 0.019), 0.003)},
            thin_m=0.034,
        ),
        Graspable("biscuit_tin", 0.057, 0.05, 0.088, "top", "push", {"colour": _ALL}),
        Graspable("sugar_bowl", 0.053, 0.03, 0.073, "top", "top", {"colour": _ALL}),
        Graspable("kitchen_clutter.jar", 0.064, 0.05, 0.18, "side", "side", {"colour": _ALL}, aim_m=0.075),
        Graspable("kitchen_clutter.bottle", 0.038, 0.03, 0.286, "side", "side", {"colour": _ALL}, aim_m=0.09),
        Graspable(
            "teapot",
            0.137,
            0.05,
            0.15,
            None,
            "push",
            {"colour": _ALL, "shape": ("round", "tall"), "pattern": ("plain", "banded", "dipped")},
        ),
    )
}
