"""Spinning tops on a table: some run down and topple, some are spun by a hand, some lie there."""

from __future__ import annotations

import random
from dataclasses import dataclass
from functools import partial
from math import atan2, degrees
from typing import TYPE_CHECKING

from mathutils import Vector

from ...assets import spinning_top
from ...motion.spinning_tops import TopHand, lie, run_down, spin_on
from .. import looks
from ..areas import Area, Flat, retried
from ..hands.arms import Reach, reaches, willing
from ..hands.closeup import move_in, piece
from ..looks import Look
from . import theme

if TYPE_CHECKING:
    from ..stage import Stage

PROFILES = {"broad": spinning_top.BROAD, "pear": spinning_top.PEAR}
COLOURS = tuple(spinning_top.SEGMENTS)
LIES_M, STANDS_M = 0.078, 0.052
PIECE_M = (0.64, 0.50)

# What happens to some of the tops, in the order of the cast; the others lie or spin on.
STORIES = (
    ("falls early", "falls late", "spun early"),
    ("falls early", "falls late", "spun late"),
    ("falls early", "spun late"),
    ("falls early", "spun late", "spins on"),
    ("spun early, falls", "falls late", "spins on"),
    ("spun early, falls", "falls early"),
    ("spun early", "spun late", "falls late"),
    ("spun early, falls", "spun late"),
)


@dataclass
class Top:
    """A top before it is built."""

    name: str
    look: Look
    act: str = "lies"
    arm: Reach | None = None
    at: Flat = (0.0, 0.0)

    @property
    def radius_m(self) -> float:
        """In plan: one that lies, or will, needs more room."""
        return STANDS_M if self.act == "spins on" else LIES_M


@theme("tabletop", needs=("table",), categories=("top",), verbs=("spin", "topple", "hold"))
def spinning_tops(stage: Stage) -> None:
    """Tops spin, topple and are spun, one after another."""
    rng, whole = stage.rng("spinning tops"), stage.area("table")
    table, cast = retried(whole, 60, lambda: _draw_cast(stage, rng, piece(rng, whole, PIECE_M)))
    move_in(stage, whole, table)
    for top in cast:
        _play(stage, rng, table, top)
    spun = sum(top.arm is not None for top in cast)
    stage.tell(f"{len(cast)} tops on a table; {spun} of them are spun by hand, others run down and topple.")


def _draw_cast(stage: Stage, rng: random.Random, table: Area) -> tuple[Area, list[Top]]:
    """Who does what, and where: those that hands take first."""
    options = {"colour": rng.sample(COLOURS, 3)}
    key = rng.choice(("shape", "material"))
    options[key] = looks.words_of("spinning_top", key)
    other = "material" if key == "shape" else "shape"
    options[other] = [rng.choice(looks.words_of("spinning_top", other))]
    cast = [
        Top(f"top_{k + 1}", look)
        for k, look in enumerate(looks.crossed(rng, "spinning_top", rng.choice((3, 4, 4, 5)), options))
    ]
    order = rng.sample(cast, len(cast))
    for top, act in zip(order, rng.choice(STORIES)):
        top.act = act
    for top in order:
        if top.act == "lies" and rng.random() < 0.35:
            top.act = "spins on"
    arms = reaches(stage, rng, table)
    for top in sorted(cast, key=lambda t: not t.act.startswith("spun")):
        if top.act.startswith("spun"):
            top.arm = willing(arms, partial(_reached, rng, table, top=top))
        else:
            top.at = table.spot(rng, top.radius_m)
        table.take(top.at, top.radius_m, owner=top.name)
    return table, cast


def _reached(rng: random.Random, table: Area, arm: Reach, top: Top) -> None:
    """A spot where an arm takes it."""
    top.at = arm.spot(rng, table, top.radius_m, tries=40)
    arm.take(table, top.at)


def _play(stage: Stage, rng: random.Random, table: Area, top: Top) -> None:
    """Builds a top and lets it do what it does."""
    prop = stage.member(top.look, top.name, top.at, area=table, radius_m=0.0)
    thing, profile = prop.instance, PROFILES[top.look.words["shape"]]
    at, towards = Vector(table.point(*top.at)), rng.uniform(-180.0, 180.0)
    if top.act == "lies":
        lie(thing, profile, at, towards)
    elif top.act == "spins on":
        spin_on(thing, profile, at, towards_deg=towards)
    elif top.arm is None:
        first = rng.randint(18, 30) if top.act.endswith("early") else rng.randint(54, 66)
        run_down(thing, profile, at, falls=(first, first + rng.randint(20, 28)), towards_deg=towards)
    else:
        _spin(stage, rng, thing, top, at)


def _spin(stage: Stage, rng: random.Random, thing, top: Top, at: Vector) -> None:
    """A hand stands a lying top up by its stem and twists it."""
    arm = top.arm
    assert arm is not None
    t = rng.randint(2, 7) if "early" in top.act else rng.randint(32, 42)
    to_arm = arm.shoulder[0] - at.x, arm.shoulder[1] - at.y
    towards = degrees(atan2(to_arm[1], to_arm[0])) + rng.uniform(-25.0, 25.0)
    upright = t + rng.randint(26, 28)
    let_go = upright + rng.randint(12, 14)
    falls = (let_go + rng.randint(16, 22),) if top.act.endswith("falls") else ()
    profile = PROFILES[top.look.words["shape"]]
    hand = arm.hand(stage, TopHand)
    hand.twirl(
        thing,
        profile,
        at=at,
        towards_deg=towards,
        approach=(t, t + 17),
        upright=upright,
        let_go=let_go,
        heading_deg=arm.heading_deg(top.at),
        way=-1.0 if arm.side == "l" else 1.0,
        falls=(falls[0], falls[0] + rng.randint(20, 24)) if falls else None,
    )
    if let_go + 7 + 12 <= 96:
        hand.withdraw((let_go + 7, min(let_go + 29, 96)))
