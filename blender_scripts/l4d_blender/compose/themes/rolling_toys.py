"""Balls and toy cars on a table: hands send some of them rolling, others roll by themselves or lie there."""

from __future__ import annotations

import random
from dataclasses import dataclass
from functools import partial
from math import cos, radians, sin
from typing import TYPE_CHECKING

from mathutils import Vector

from ...motion.rolling import Round, roll
from .. import looks
from ..areas import Area, Flat, retried
from ..errors import NoRoom
from ..hands.arms import reaches, willing
from ..hands.closeup import move_in, piece
from ..hands.handling import Deed, Item, rest_of
from ..looks import Look
from . import theme

if TYPE_CHECKING:
    from ..stage import Stage

PIECE_M = (0.66, 0.50)
PAINTS = ("red", "orange", "yellow", "green", "blue", "purple", "white")
BALL_M, CAR_M = 0.034, 0.066
STORIES = (("ball", "ball"), ("ball", "car"), ("car", "ball"), ("car", "car"), ("ball", "lifted car"))


@dataclass(frozen=True)
class Alone:
    """A ball that rolls by itself to a point."""

    item: Item
    end: Flat
    frames: tuple[int, int]


@theme(
    "tabletop",
    needs=("table",),
    categories=("ball", "car"),
    verbs=("push", "roll", "lift", "put_down", "hold"),
)
def rolling_toys(stage: Stage) -> None:
    """Two hands send toys rolling, one after the other; perhaps a ball rolls by itself."""
    rng, whole = stage.rng("rolling toys"), stage.area("table")
    table, items, deeds, alone = retried(whole, 16, lambda: _plan(stage, rng, piece(rng, whole, PIECE_M)))
    move_in(stage, whole, table)
    for item in items:
        item.build(stage, rng, table)
    for each in alone:
        thing = each.item.thing
        assert thing is not None
        first, last = each.frames
        ball = Round(thing, BALL_M, Vector((0.0, 0.0, BALL_M)))
        ground = table.point(*each.end)
        roll(ball, [ground], each.frames, free=first + (last - first) // 4)
    for deed in deeds:
        deed.play(stage, rng)
    balls = sum(item.look.kind == "ball" for item in items)
    stage.tell(f"{balls} balls and {len(items) - balls} toy cars; hands send some of them rolling.")


def _cast(rng: random.Random) -> tuple[list[Item], list[Item]]:
    paints = rng.sample(PAINTS, 3)
    options = {"colour": paints, "pattern": rng.sample(looks.words_of("ball", "pattern"), 2)}
    options["mark"] = [rng.choice([word for word in ("white", "black", "light_blue") if word not in paints])]
    group = looks.crossed(rng, "ball", rng.choice((3, 4, 4)), options)
    balls = []
    for k, look in enumerate(group):
        shown = {key: word for key, word in look.attributes.items() if key != "mark"}
        small = Look("ball", {**look.words, "radius_m": BALL_M}, shown)
        balls.append(Item(f"ball_{k + 1}", small, BALL_M + 0.004))
    group = looks.crossed(rng, "toy_car", 3, {"colour": rng.sample(PAINTS, 2)})
    cars = [Item(f"car_{k + 1}", look, CAR_M) for k, look in enumerate(group)]
    return balls, cars


def _plan(stage: Stage, rng: random.Random, table: Area) -> tuple[Area, list[Item], list[Deed], list[Alone]]:
    """What hands send first, then what rolls by itself, then the rest."""
    balls, cars = _cast(rng)
    queues = {"ball": rng.sample(balls, len(balls)), "car": rng.sample(cars, len(cars))}
    arms, deeds = reaches(stage, rng, table), []
    for k, what in enumerate(rng.choice(STORIES)):
        item = queues[what.split()[-1]].pop()
        start = rng.randint(1, 8) if k == 0 else rng.randint(34, 44)
        if what == "lifted car":
            deed = Deed("lift", item, start)
        elif what == "ball":
            deed = Deed("send", item, start, lengths_m=(0.16, 0.30), axle_m=BALL_M, grip_m=BALL_M)
        else:
            deed = Deed("send", item, start, lengths_m=(0.16, 0.30), grip_m=0.034, thing_verb="roll")
        willing(arms, partial(deed.plan, rng, table))
        if deed.verb == "send" and what != "ball":
            item.heading_deg = deed.heading_deg
        deeds.append(deed)
    alone = []
    if queues["ball"] and rng.random() < 0.6:
        alone.append(_rolls(rng, table, queues["ball"].pop()))
    rest_of(rng, table, [*queues["ball"], *queues["car"]])
    return table, [*balls, *cars], deeds, alone


def _rolls(rng: random.Random, table: Area, item: Item) -> Alone:
    first = rng.choice((rng.randint(2, 10), rng.randint(44, 54)))
    for _ in range(80):
        at, far = table.spot(rng, item.radius_m), rng.uniform(0.13, 0.28)
        turn = radians(rng.uniform(-180, 180))
        end = at[0] + far * sin(turn), at[1] - far * cos(turn)
        if table.is_free(at, item.radius_m, end):
            item.at, item.placed = at, True
            table.take(at, item.radius_m, end, owner=item.name)
            return Alone(item, end, (first, first + rng.randint(26, 38)))
    raise NoRoom(f"no way for {item.name} to roll")
