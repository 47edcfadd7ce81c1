"""People who stand at a counter with laptops: they open one, type on it, drink from a mug, telephone.

Owns where a laptop and a mug are from their user and how long each step takes; users face -Y.
"""

from __future__ import annotations

import random
from dataclasses import replace
from math import radians

from mathutils import Matrix

from ...assets import laptop
from ...motion import deskwork
from ...motion.deskwork import Computer
from ...motion.people import Person
from ...motion.sitting import rest_hands
from ...scene.timeline import LAST_FRAME
from .. import looks
from ..areas import Flat
from ..looks import Look
from ..stage import Stage

METALS = {
    "silver": laptop.COMPACT_SILVER,
    "black": laptop.LARGE_BLACK,
    "copper": laptop.COMPACT_COPPER,
    "white": laptop.LARGE_WHITE,
}
SIZES_M = {"compact": (0.316, 0.226), "large": (0.386, 0.268)}
AHEAD_M = 0.46  # from a user to the middle of the laptop
LAPTOP_M = 0.22
MUG_M = 0.07
_ASIDE_M = 0.29  # of a mug from the middle of the laptop
_HANDLE, _RIM = (0.070, 0.0, 0.048), (0.040, 0.092)  # of coffee_table.mug


def draw_laptops(rng: random.Random, count: int) -> list[Look]:
    """Small and large ones of two metals."""
    metals = rng.sample(list(METALS), 2)
    found = []
    for member in looks.crossed(rng, "laptop", count, {"colour": metals, "size": tuple(SIZES_M)}):
        model = replace(METALS[member.words["colour"]], size_m=SIZES_M[member.words["size"]])
        found.append(Look("laptop", {"model": model}, member.attributes))
    return found


def put_laptop(
    stage: Stage,
    look: Look,
    name: str,
    at: Flat,
    heading_deg: float,
    top_m: float,
    *,
    is_open: bool,
    page: int,
) -> Computer:
    """A laptop whose keys are towards +Y at a heading of 180."""
    made = stage.scene.make("laptop", name, stage.rng(f"member/{name}"), page=page, **look.words)
    where = Matrix.Translation((*at, top_m)) @ Matrix.Rotation(radians(heading_deg), 4, "Z")
    prop = stage.register(
        "laptop", name, made, at=at, heading_deg=heading_deg, area=None, look=look, radius_m=LAPTOP_M
    )
    return Computer(prop.instance, made, where, is_open)


def mug_at(user: Flat) -> Flat:
    """Where a user's mug stands: to the right of the laptop, a little nearer."""
    return user[0] - _ASIDE_M, user[1] - AHEAD_M + 0.06


def open_and_type(rng: random.Random, user: Person, own: Computer, top_m: float) -> int:
    """Opens the laptop and types; returns the frame at which that ends."""
    _rest(user, top_m)
    first = rng.choice((rng.randint(8, 14), rng.randint(30, 38)))
    opened = first + rng.randint(16, 19)
    deskwork.open_lid(user, own, (first, opened))
    start = opened + rng.randint(6, 9)
    last = LAST_FRAME if LAST_FRAME - start < 40 else rng.choice((LAST_FRAME, start + rng.randint(26, 36)))
    deskwork.type_on(user, own, (start, last), arrive=5)
    if last < LAST_FRAME - 14:
        _rest(user, top_m, (last + 1, last + 12))
    return last


def type_a_while(rng: random.Random, user: Person, own: Computer, top_m: float) -> int:
    """Types from the first frames on or later; returns the frame at which that ends."""
    if rng.random() < 0.5:
        first, last = 0, rng.randint(28, 44)
        deskwork.type_on(user, own, (first, last), arrive=2)
    else:
        _rest(user, top_m)
        first = rng.randint(22, 44)
        last = first + rng.randint(30, 44)
        deskwork.type_on(user, own, (first, min(last, LAST_FRAME)))
    if last < LAST_FRAME - 14:
        _rest(user, top_m, (last + 1, last + 12))
    return min(last, LAST_FRAME)


def drink(rng: random.Random, stage: Stage, user: Person, name: str, top_m: float, start: int) -> None:
    """Takes the mug beside the laptop and drinks, if there is time for it."""
    first = start + rng.randint(2, 8)
    at = mug_at(user.stands_at)
    mug = stage.landmark(
        "coffee_table.mug", name, at, 180.0, on=top_m, colour=rng.choice(("red", "blue", "white"))
    )
    deskwork.drink_from(user, mug.instance, _HANDLE, _RIM, (first, LAST_FRAME))


def _rest(user: Person, top_m: float, frames: tuple[int, int] = (-2, -1)) -> None:
    """Palms on the counter, to both sides of the laptop."""
    x, y = user.stands_at
    rest_hands(user, {"l": (x + 0.24, y - 0.30, top_m), "r": (x - 0.24, y - 0.30, top_m)}, frames)
