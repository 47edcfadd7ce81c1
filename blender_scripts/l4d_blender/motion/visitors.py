"""People who come and go with bags: set one down, fetch another from a seat without dragging it off.

Records also what luggage shows by itself: while it is moved, it moves. Refuses to know rooms.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ..scene.scene import Instance
from ..scene.timeline import LAST_FRAME
from .people import Person
from .plan_person import Frames


def put_down(person: Person, thing: Instance, at: Sequence[float], frames: Frames) -> None:
    """Sets a held thing down; it has moved since it was taken."""
    held = next(held for held in person.held if held.instance is thing and held.last is None)
    person.put_down(thing, at, frames)
    assert held.last is not None
    person.scene.event(thing, "move", (held.first, held.last))


def fetch(
    person: Person,
    thing: Instance,
    grip: Sequence[float],
    frames: Frames,
    *,
    side: str = "r",
    bar: Sequence[float] | None = None,
    clear_m: float = 0.16,
) -> None:
    """Lifts a thing from a seat: first up in front of the body, then down to the side, where it stays."""
    first, last = frames
    upright = first + round(0.78 * (last - first))
    person.lift(thing, grip, (first, upright), side=side, bar=bar, carry="front", clear_m=clear_m)
    held = person.held[-1]
    person.carry(side, "side", (upright - 1, last), clear_m, [np.array(g) for g in held.grips])
    person.scene.event(thing, "move", (held.first, LAST_FRAME))
