"""Things on a table, and a hand that moves one of them."""

from __future__ import annotations

from math import cos, radians, sin
from typing import TYPE_CHECKING

from ...motion.hands import Hand
from .. import looks
from ..stage import Rejected
from . import theme

if TYPE_CHECKING:
    from ..stage import Stage


@theme(
    "tabletop",
    needs=("table",),
    categories=("cup",),
    verbs=("lift", "put_down", "hold"),
)
def things_moved(stage: Stage) -> None:
    """A hand lifts one of the cups and sets it down."""
    rng, table = stage.rng("things moved"), stage.area("table")
    options = {key: looks.words_of("cup", key) for key in ("pattern", "content")}
    group = looks.crossed(rng, "cup", 4, options)
    cups = []
    for k, look in enumerate(group):
        at = table.spot(rng, 0.075)
        cups.append(stage.member(look, f"cup_{k + 1}", at, rng.uniform(-180, 180), area=table))
    seat = stage.seats[0]
    forward = (-sin(radians(seat.heading_deg + 180)), cos(radians(seat.heading_deg + 180)))
    rest = (seat.at[0] + 0.2, seat.at[1] + forward[1] * seat.rest_m)
    hand = Hand(
        stage.scene,
        "hand",
        stage.next_id(landmark=True),
        shoulder=(seat.at[0] + 0.18, seat.at[1] - 0.1, seat.shoulder_m),
        rest_at=(*rest, 0.0),
    )
    taken = rng.choice(cups)
    at = taken.instance.matrix(0).translation
    try:
        hand.approach(taken.instance, (6, 30), grip="side", point=(at.x, at.y, at.z + 0.06))
    except ValueError as error:
        raise Rejected(f"the hand does not reach {taken.name}: {error}") from error
    hand.lift((30, 50), height_m=0.09)
    hand.put_down((at.x, at.y, at.z), (52, 74))
    hand.release((74, 90))
    stage.perform(hand)
    stage.tell("A hand lifts one of four cups and sets it down.")
