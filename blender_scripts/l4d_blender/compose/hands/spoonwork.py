"""What hands do with spoons and bowls: stir and lay the spoon down, push a bowl with its spoon, lift a spoon.

A deed finds room in the plane and is played when its things are built. Themes decide who does what when.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from math import atan2, cos, degrees, radians, sin

from mathutils import Vector

from ...assets import soup_bowl, spoon
from ...motion.diners import Diner
from ...motion.servers import Stirring, spoon_between
from ...scene.placing import pose
from ...scene.timeline import LAST_FRAME
from ..areas import Area, Flat, heading_to
from ..errors import NoRoom
from ..looks import Look
from ..stage import Stage
from .arms import Reach
from .handling import Item
from .penwork import Oblong

BOWL_M = 0.092
_SPOON = 0.088, 0.030  # half the length of a spoon's middle line, and the radius round it
BOWL = soup_bowl.Look(rim_m=(0.086, 0.084), foot_m=0.042, level=0.68)
SHAPE = spoon.Look(0.195, (0.043, 0.056), (0.0110, 0.0200), 0.0028)
_DEEP_M = 0.005  # of the tip of a spoon that stirs above the floor of the bowl
_PALM_M = 0.055


def spoon_item(name: str, look: Look) -> Oblong:
    """A spoon before it is built."""
    return Oblong(name, look, _SPOON[1], half_m=_SPOON[0], turned_deg=90.0)


def put_spoon(stage: Stage, item: Item, matrix) -> None:
    """Builds a spoon in a pose."""
    body = stage.scene.make("spoon", item.name, stage.rng(f"member/{item.name}"), **item.look.words)
    body.matrix_basis = matrix
    item.thing = stage.register(
        "spoon", item.name, body, at=item.at, heading_deg=0.0, area=None, look=item.look, radius_m=0.0
    ).instance


def lie_free(stage: Stage, table: Area, item: Oblong) -> None:
    """Builds a spoon that lies where it was planned."""
    put_spoon(stage, item, pose((*item.at, table.point(*item.at)[2]), item.heading_deg or 0.0))


@dataclass
class Stir:
    """Goes round in a bowl with a spoon, takes it out and lays it down beside."""

    spoon: Oblong
    bowl: Item
    start: int
    arm: Reach | None = None
    lean: Flat = (0.0, 0.0)
    laid: Flat = (0.0, 0.0)

    def plan(self, rng: random.Random, table: Area, arm: Reach) -> None:
        """Finds room for the bowl and for the spoon beside it."""
        for _ in range(120):
            at = arm.spot(rng, table, BOWL_M, tries=20)
            turn = atan2(arm.shoulder[1] - at[1], arm.shoulder[0] - at[0])
            turn += (1.0 if arm.side == "r" else -1.0) * radians(rng.uniform(0.0, 30.0))
            self.lean = cos(turn), sin(turn)
            aside = rng.choice((-1.0, 1.0)) * rng.uniform(0.16, 0.24)
            self.laid = at[0] - aside * self.lean[1], at[1] + aside * self.lean[0]
            grips = [self._along(spot, 0.10) for spot in (at, self.laid)]
            if (
                self._lies_free(table)
                and all(arm.reaches(table, grip) for grip in grips)
                and arm.is_clear(table, *grips)
            ):
                break
        else:
            raise NoRoom(f"{arm.name} has no room to stir")
        self.spoon.place(table, self.laid)
        self.bowl.place(table, at)
        self.spoon.at, self.arm = at, arm
        arm.take(table, *grips)
        _keep_rest(table, arm)

    def _lies_free(self, table: Area) -> bool:
        """Whether the spoon has room beside the bowl."""
        self.spoon.at = self.laid
        self.spoon.heading_deg = degrees(atan2(-self.lean[0], self.lean[1]))
        return self.spoon.is_free(table)

    def _along(self, spot: Flat, far_m: float) -> Flat:
        return spot[0] + far_m * self.lean[0], spot[1] + far_m * self.lean[1]

    def _way(self, table: Area) -> Stirring:
        height = table.point(*self.bowl.at)[2] + soup_bowl.FLOOR_M + _DEEP_M
        inner, deep = BOWL.inner_m
        lean = Vector((*self.lean, 0.0))
        return Stirring(
            Vector((*self.bowl.at, height)), (inner, deep - _DEEP_M), lean, SHAPE.tip, circle_m=0.024
        )

    def build(self, rng: random.Random, stage: Stage, table: Area) -> None:
        """The spoon leans in its bowl."""
        put_spoon(stage, self.spoon, self._way(table).at(0.0))

    def play(self, rng: random.Random, stage: Stage, table: Area) -> None:
        """Builds the hand and lets it stir."""
        arm, held, into = self.arm, self.spoon.thing, self.bowl.thing
        assert arm is not None and held is not None and into is not None
        hand, way, t = arm.hand(stage, Diner), self._way(table), self.start
        grip = held.matrix(0) @ SHAPE.tip.lerp(SHAPE.end, 0.88)
        hand.hold_from_start(held, grip="pen", point=grip, heading_deg=arm.heading_deg(self.bowl.at))
        last = t + rng.randint(26, 34)
        hand.stir(into, way, (t, last), rounds=1.5)
        up = held.matrix(last).copy()
        up.translation += Vector((*(0.02 * x for x in self.lean), 0.11))
        hand.bring(up, (last, last + 14))
        down = last + 14 + rng.randint(16, 20)
        assert self.spoon.heading_deg is not None
        hand.lay_down(
            pose((*self.laid, table.point(*self.laid)[2]), self.spoon.heading_deg), (last + 14, down)
        )
        _leave(hand, down)


@dataclass
class PushWithSpoon:
    """Pushes a bowl; the spoon that leans in it rides along."""

    spoon: Oblong
    bowl: Item
    start: int
    arm: Reach | None = None
    end: Flat = (0.0, 0.0)

    def plan(self, rng: random.Random, table: Area, arm: Reach) -> None:
        """Finds room for the bowl and its way."""
        at, self.end = arm.push(rng, table, BOWL_M + 0.02, (0.08, 0.15))
        self.bowl.at, self.bowl.placed, self.arm = at, True, arm
        self.spoon.at, self.spoon.placed = at, True
        table.take(at, BOWL_M + 0.02, self.end, owner=self.bowl.name)
        arm.take(table, at, self.end)
        _keep_rest(table, arm)

    def build(self, rng: random.Random, stage: Stage, table: Area) -> None:
        """The spoon leans across its bowl, to a side of the way."""
        lean_in(rng, stage, table, self.spoon, self.bowl, heading_to(self.bowl.at, self.end))

    def play(self, rng: random.Random, stage: Stage, table: Area) -> None:
        """Builds the hand and lets it push."""
        arm, held, dish = self.arm, self.spoon.thing, self.bowl.thing
        assert arm is not None and held is not None and dish is not None
        hand, t = arm.hand(stage, Diner), self.start
        edge = dish.matrix(0).translation + Vector((0.0, 0.0, 0.030))
        heading = heading_to(self.bowl.at, self.end)
        hand.approach(dish, (t, t + 16), grip="push", point=edge, heading_deg=heading)
        last = t + 16 + rng.randint(22, 30)
        hand.push_dish([(*self.end, edge.z)], (t + 16, last), load=(held,))
        _leave(hand, last)


@dataclass
class Lift:
    """Takes a spoon off the table, holds it up and lays it down again."""

    spoon: Oblong
    start: int
    arm: Reach | None = None

    def plan(self, rng: random.Random, table: Area, arm: Reach) -> None:
        """Finds room for the spoon, its handle towards the arm."""
        for _ in range(200):
            at = arm.spot(rng, table, _SPOON[1], tries=20)
            self.spoon.at, self.spoon.heading_deg = at, arm.heading_deg(at) + rng.uniform(-30.0, 30.0)
            if self.spoon.is_free(table):
                self.spoon.place(table, at)
                arm.take(table, at)
                _keep_rest(table, arm)
                self.arm = arm
                return
        raise NoRoom(f"{arm.name} reaches no spoon")

    def build(self, rng: random.Random, stage: Stage, table: Area) -> None:
        """The spoon lies where it was planned."""
        lie_free(stage, table, self.spoon)

    def play(self, rng: random.Random, stage: Stage, table: Area) -> None:
        """Builds the hand and lets it lift."""
        arm, held, t = self.arm, self.spoon.thing, self.start
        assert arm is not None and held is not None
        hand, lying = arm.hand(stage, Diner), held.matrix(0).copy()
        grip = lying @ SHAPE.tip.lerp(SHAPE.end, 0.78) + Vector((0.0, 0.0, 0.004))
        hand.approach(held, (t, t + 17), grip="pick", point=grip, heading_deg=arm.heading_deg(self.spoon.at))
        top = t + 17 + rng.randint(14, 18)
        hand.lift((t + 17, top), height_m=rng.uniform(0.08, 0.11))
        down = top + rng.randint(17, 24)
        hand.lay_down(lying, (top, down))
        _leave(hand, down)


def lean_in(
    rng: random.Random, stage: Stage, table: Area, item: Oblong, bowl: Item, away_from_deg: float
) -> None:
    """Builds a spoon that leans across a bowl, its handle to a side of a heading."""
    turn = radians(away_from_deg - 90.0 + rng.choice((-90.0, 90.0)) + rng.uniform(-30.0, 30.0))
    lean = Vector((cos(turn), sin(turn), 0.0))
    foot = Vector((*bowl.at, table.point(*bowl.at)[2] + soup_bowl.FLOOR_M + 0.003))
    inner, height = BOWL.inner_m
    low, high = foot - 0.044 * lean, foot + (inner - 0.006) * lean + Vector((0.0, 0.0, height + 0.002))
    put_spoon(stage, item, spoon_between(low, high, SHAPE.tip))
    assert item.thing is not None and bowl.thing is not None
    stage.may_touch(item.thing, bowl.thing)


def _keep_rest(table: Area, arm: Reach) -> None:
    """Nothing may stand where the palm begins and ends, from the start or later."""
    (x, y), (dx, dy) = arm.rest, arm.forward
    ahead = x + 0.06 * dx, y + 0.06 * dy
    if not table.is_clear(arm.rest, ahead, _PALM_M, ignoring=(arm.name,)):
        raise NoRoom(f"{arm.name} has nowhere to rest")
    table.take(arm.rest, _PALM_M, ahead, owner=f"{arm.name} at rest")


def _leave(hand: Diner, done: int) -> None:
    """Lets go and goes back, if there is time for it."""
    if done + 9 <= LAST_FRAME:
        hand.release((done, done + 9))
        if done + 24 <= LAST_FRAME:
            hand.withdraw((done + 9, min(done + 30, LAST_FRAME)))
