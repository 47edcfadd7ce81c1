"""What a colour is."""

from __future__ import annotations

from collections.abc import Iterable

Colour = tuple[float, float, float]
"""Linear RGB."""


def rgb(values: Iterable[float]) -> Colour:
    """Three computed numbers as a colour."""
    red, green, blue = values
    return red, green, blue
