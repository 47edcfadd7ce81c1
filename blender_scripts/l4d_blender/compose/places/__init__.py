"""Where composed scenes happen: each place furnishes a stage and says what it offers to themes.

A place is a function `(stage) -> None` in a module of this package. It builds what surrounds the scene,
lights it, adds areas and landmarks (three or more, of which no two have the same noun unless a property tells
them apart), dresses it, and places the cameras. It draws all of that from `stage.rng`, so that no two are
alike.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..stage import Stage

OFFERS = frozenset(
    {
        "table",  # an area "table" of at least 0.5 m by 0.4 m with at least one seat in stage.seats
        "paper",  # its table is one that somebody writes at
        "clear",  # its table's middle is clear for wide things: landmarks are at its ends
        "floor",  # an area "floor" indoors, at least 2.5 m by 2 m, for people and animals
        "lawn",  # an area "lawn" or yard outdoors, at least 5 m by 4 m
        "water",  # an area "water" to swim on, its bank as an area "lawn"
        "road",  # an area "road", two lanes, 18 m or more along X; the near pavement as an area "lawn"
        "counter",  # an area "counter" 0.8 to 1.0 m high; people stand at the edge of its first two corners
        "hob",  # its counter is one that people cook at
        "chairs",  # two or more chairs in stage.chairs, with free floor before them
    }
)


@dataclass(frozen=True)
class Place:
    """An entry: what a place is called, where it belongs, what themes find there."""

    name: str
    scale: str
    offers: frozenset[str]
    furnish: Callable[[Stage], None]


_PLACES: dict[str, Place] = {}


def place(scale: str, *offers: str) -> Callable[[Callable[[Stage], None]], Callable[[Stage], None]]:
    """Enters a place under the name of its function."""
    unknown = set(offers) - OFFERS
    if unknown:
        raise ValueError(f"no offer {', '.join(sorted(unknown))}")

    def enter(furnish: Callable[[Stage], None]) -> Callable[[Stage], None]:
        _PLACES[furnish.__name__] = Place(furnish.__name__, scale, frozenset(offers), furnish)
        return furnish

    return enter


def shipped_places() -> list[Place]:
    """Those of this package: tests and tools may have entered others."""
    return [entry for entry in places().values() if entry.furnish.__module__.startswith(__name__)]


def places() -> dict[str, Place]:
    """All places, by name."""
    for module in pkgutil.iter_modules(__path__):
        importlib.import_module(f"{__name__}.{module.name}")
    return dict(sorted(_PLACES.items()))
