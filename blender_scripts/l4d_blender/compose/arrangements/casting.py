"""People of arrangements: who they are, and what each of them is doing when the pictures are taken.

Owns poses: standing, gestures, crouching, sitting on a chair of the place, holding something.
"""

from __future__ import annotations

import random
from collections.abc import Callable

from ...motion import lifters, sitting, travellers
from ...motion.people import Person
from ..areas import Area, Flat
from ..people import folk, wares
from ..people.bodies import add_person
from ..people.rehearsal import ahead
from ..stage import Chair, Stage

MOMENTS = (24, 36, 48)
"""Canonical frames of pictures, one a layout: every gesture is under way then."""

_NOUNS = ("woman", "woman", "man", "man", "child", "child", "cook", "athlete", "person", "pedestrian")
_ROOM_M = 0.34
_FEET_M = 0.41  # from the point on a seat to the feet of somebody who sits on it
_HELD = ("bucket", "basket", "bag", "teddy", "ball")

_GESTURES: tuple[Callable[[Person], None], ...] = (
    lambda person: person.wave((2, 70)),
    lambda person: person.crouch_down((2, 80)),
    lambda person: lifters.stretch(person, (8, 80)),
    lambda person: travellers.phone(person, (0, 80)),
    lambda person: person.bend_down((4, 60)),
)


def people(stage: Stage, rng: random.Random, area: Area, count: int) -> list[Flat]:
    """Puts people of one noun on an area, each in a pose of its own; returns where they are."""
    noun = rng.choice(_NOUNS)
    chairs = rng.sample(stage.chairs, len(stage.chairs))
    found = []
    for figure in folk.cast(rng, noun, max(3, count))[:count]:
        name = f"{noun}_{len(stage.scene.instances)}"
        chair = chairs.pop() if chairs and rng.random() < 0.3 else None
        if chair is not None and chair.seat[2] > 0.3:
            found.append(_seated(stage, figure, name, chair))
        else:
            found.append(_standing(stage, rng, area, figure, name))
    return found


def _seated(stage: Stage, figure: folk.Figure, name: str, chair: Chair) -> Flat:
    feet = ahead(chair.seat[:2], chair.heading_deg, _FEET_M * figure.scale)
    person = add_person(stage, figure, name, feet, chair.heading_deg)
    sitting.sit_all_along(person, chair.seat)
    person.finish()
    return feet


def _standing(stage: Stage, rng: random.Random, area: Area, figure: folk.Figure, name: str) -> Flat:
    at = area.spot(rng, _ROOM_M)
    area.take(at, _ROOM_M, owner=name)
    heading_deg = rng.uniform(-180, 180)
    ground_m = area.point(*at)[2]
    drawn = rng.random()
    if drawn < 0.25:
        _holding(stage, rng, figure, name, (*at, ground_m), heading_deg)
        return at
    person = add_person(stage, figure, name, at, heading_deg, ground_m)
    if drawn < 0.65:
        rng.choice(_GESTURES)(person)
    person.finish()
    return at


def _holding(
    stage: Stage,
    rng: random.Random,
    figure: folk.Figure,
    name: str,
    at: tuple[float, float, float],
    heading_deg: float,
) -> None:
    """Somebody with a thing in the hand or before the chest."""
    ware = wares.WARES[rng.choice(_HELD)]
    look = rng.choice(ware.draw(rng, 3))
    turned_deg = 0.0 if ware.bar is None else heading_deg - 90.0  # a handle points ahead
    held = f"{ware.noun}_held_{len(stage.scene.instances)}"
    thing = stage.scene.put(
        look.kind, held, at[:2], turned_deg, rng=stage.rng(f"held/{held}"), on=at[2], **look.words
    )
    prop = stage.register(
        look.kind, held, thing, at=at[:2], heading_deg=turned_deg, area=None, look=look, category=ware.noun
    )
    person = add_person(stage, figure, name, at[:2], heading_deg, at[2])
    grip = ware.hold_of(look)
    person.hold(
        prop.instance, grip, side=rng.choice("lr"), bar=ware.bar, carry=ware.carry, clear_m=ware.clear_m
    )
    person.finish()
