"""People at a counter with laptops: some open theirs and type, one drinks from a mug, one telephones."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING

from ...motion import travellers
from ...motion.people import Person
from ...scene.timeline import LAST_FRAME
from ..areas import Area, Flat
from ..errors import Rejected
from ..people import deskwork, folk
from ..people.bodies import add_person
from . import theme

if TYPE_CHECKING:
    from ..stage import Stage

_NOUNS = ("person", "woman", "man")
_VERBS = ("open", "swing_open", "type_on", "drink_from", "hold", "phone", "stand")
_BACK_M, _APART_M, _END_M = 0.24, 0.74, 0.12
STORIES = (
    ("open", "type", "phone"),
    ("open", "drink", "phone"),
    ("open", "type drink", "phone"),
    ("open", "open", "drink"),
    ("type drink", "open", "phone"),
)


@theme("room", needs=("counter",), categories=(*_NOUNS, "laptop"), verbs=_VERBS)
def laptops(stage: Stage) -> None:
    """Three people in a row, a laptop before each."""
    rng, counter = stage.rng("laptops"), stage.area("counter")
    (ax, ay), (bx, by) = counter.corners[:2]
    if abs(ay - by) > 0.05 or ax < bx:
        raise Rejected("people stand only behind counters that face the cameras")
    top_m, y = counter.point(0.0, 0.0)[2], ay + _BACK_M
    deeds = rng.sample(rng.choice(STORIES), 3)
    xs, spots = _row(rng, counter, bx, ax, y, deeds)
    stage.film(stage.closer([(xs[0], y), (xs[2], y), *spots], height_m=1.12, margin_m=0.3, least_rise=0.3))
    figures = folk.cast(rng, stage.pick("laptops/noun", _NOUNS, stage.spec.categories), 3)
    computers = [
        deskwork.put_laptop(
            stage,
            look,
            f"laptop_{n}",
            at,
            180.0 + rng.uniform(-5.0, 5.0),
            top_m,
            is_open=deed not in ("open", "phone") or (deed == "phone" and rng.random() < 0.5),
            page=n,
        )
        for n, (look, at, deed) in enumerate(zip(deskwork.draw_laptops(rng, 3), spots, deeds), 1)
    ]
    for figure, x, deed, computer in zip(figures, xs, deeds, computers):
        person = add_person(stage, figure, figure.name, (x, y), 0.0)
        _work(rng, stage, person, deed, computer, top_m)
        person.finish()
    for computer in computers:
        computer.finish()
    stage.tell("Three people stand at laptops: they open them, type, drink or telephone.")


def _work(
    rng: random.Random, stage: Stage, person: Person, deed: str, computer: deskwork.Computer, top_m: float
) -> None:
    """What one of them does."""
    if deed == "open":
        deskwork.open_and_type(rng, person, computer, top_m)
    elif deed == "phone":
        first = rng.randint(34, 60)
        person.stand((0, first - 18))
        travellers.phone(person, (first, min(first + rng.randint(26, 40), LAST_FRAME)), side=rng.choice("lr"))
    elif deed == "drink":
        deskwork.drink(rng, stage, person, "mug", top_m, rng.randint(2, 30))
    else:
        done = deskwork.type_a_while(rng, person, computer, top_m)
        if "drink" in deed and done < LAST_FRAME - 42:
            deskwork.drink(rng, stage, person, "mug", top_m, done)


def _row(
    rng: random.Random, counter: Area, low: float, high: float, y: float, deeds: list[str]
) -> tuple[list[float], list[Flat]]:
    """Where three people stand side by side, and a free spot for the laptop before each."""
    slack = high - low - 2 * _END_M - 2 * _APART_M
    if slack < 0.0:
        raise Rejected("the counter is too short for three people")
    for _ in range(200):
        left = low + _END_M + rng.uniform(0.0, slack)
        xs = [left, left + _APART_M, left + 2 * _APART_M]
        spots = [(x + rng.uniform(-0.02, 0.02), y - deskwork.AHEAD_M + rng.uniform(-0.02, 0.01)) for x in xs]
        mugs = [deskwork.mug_at((x, y)) for x, deed in zip(xs, deeds) if "drink" in deed]
        laid = all(counter.is_clear(at, at, deskwork.LAPTOP_M) for at in spots)
        if laid and all(counter.is_free(at, deskwork.MUG_M) for at in mugs):
            return xs, spots
    raise Rejected("a laptop finds no room on the counter")
