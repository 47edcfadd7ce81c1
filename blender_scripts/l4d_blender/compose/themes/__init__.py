"""What happens in composed scenes: each theme casts groups on a furnished stage and lets them act.

A theme is a function `(stage) -> None` in a module of this package. It casts one or two groups of three to
five of a category with twins and crossing looks (`looks.crossed`), puts them where room is, and plans the
acts of two to four performers with drawn roles, order and times, so that the same act falls on one twin and
not on the other, or on another member later. Motion code records the events. It tells the story in a sentence
or two.
"""

from __future__ import annotations

import importlib
import pkgutil
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..stage import Stage


@dataclass(frozen=True)
class Theme:
    """An entry: what a theme needs of a place, whom it may cast and what may happen."""

    name: str
    scales: frozenset[str]
    needs: frozenset[str]
    categories: frozenset[str]
    verbs: frozenset[str]
    play: Callable[[Stage], None]


_THEMES: dict[str, Theme] = {}


def theme(
    *scales: str, needs: tuple[str, ...], categories: tuple[str, ...], verbs: tuple[str, ...]
) -> Callable[[Callable[[Stage], None]], Callable[[Stage], None]]:
    """Enters a theme under the name of its function; `needs` are what a place has to offer."""

    def enter(play: Callable[[Stage], None]) -> Callable[[Stage], None]:
        _THEMES[play.__name__] = Theme(
            play.__name__, frozenset(scales), frozenset(needs), frozenset(categories), frozenset(verbs), play
        )
        return play

    return enter


def themes() -> dict[str, Theme]:
    """All themes, by name."""
    for module in pkgutil.iter_modules(__path__):
        importlib.import_module(f"{__name__}.{module.name}")
    return dict(sorted(_THEMES.items()))
