"""Copies of a few models spread over the land: trees, bushes, woods on the skyline."""

from __future__ import annotations

import random
from collections.abc import Iterable, Iterator, Sequence
from math import cos, degrees, radians, sin
from typing import cast

import bpy

from ..assets import mesh
from .placing import Point, Spot, Support, place
from .scene import Scene

ANY_WAY = (0.0, degrees(6.3))
NEARLY = (degrees(-0.3), degrees(0.3))


def scatter(
    scene: Scene,
    name: str,
    models: Sequence[bpy.types.Object],
    spots: Iterable[Point | Spot],
    rng: random.Random,
    *,
    on: Support = 0.0,
    sunk_m: float = 0.05,
    scale: tuple[float, float] = (1.0, 1.0),
    turn_deg: tuple[float, float] = ANY_WAY,
    loose_m: float = 0.0,
    turn_first: bool = False,
) -> None:
    """Puts a copy (`name`_0, ...) of the models in turn at every spot; removes the models.

    Draws per copy, in this order: how far off along x and y (if `loose_m`), scale (if it has a range), turn
    (added to the spot's own heading); turn before scale if `turn_first`.
    """
    for k, spot in enumerate(spots):
        at, heading_deg = cast("Spot", spot) if isinstance(spot[0], Sequence) else (cast("Point", spot), 0.0)
        x, y = at
        if loose_m:
            x, y = x + rng.uniform(-loose_m, loose_m), y + rng.uniform(-loose_m, loose_m)
        if turn_first:
            heading_deg += rng.uniform(*turn_deg)
        size = rng.uniform(*scale) if scale[0] < scale[1] else scale[0]
        if not turn_first:
            heading_deg += rng.uniform(*turn_deg)
        copy = mesh.duplicate(models[k % len(models)], f"{name}_{k}", linked=True)
        place(copy, (x, y, -sunk_m), heading_deg, on=on, scale=size)
    for model in models:
        bpy.data.objects.remove(model)


def skyline(
    rng: random.Random, count: int, azimuth_deg: tuple[float, float], distance_m: tuple[float, float]
) -> Iterator[Spot]:
    """Spots evenly spread from an azimuth to another, at drawn distances, each facing the middle."""
    first, last = azimuth_deg
    for k in range(count):
        azimuth = radians(first + (last - first) * k / (count - 1))
        distance = rng.uniform(*distance_m)
        yield (distance * cos(azimuth), distance * sin(azimuth)), degrees(azimuth) + 90.0
