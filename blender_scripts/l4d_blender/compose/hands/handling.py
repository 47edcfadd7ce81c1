"""What hands at a table do with small things, planned in the plane and then played: push, roll, lift, turn.

A `Deed` is one act of one arm with one thing: it finds its room, and is played when the thing is built.
Themes decide who does what when; motion code records what happens.
"""

from __future__ import annotations

import random
from dataclasses import dataclass, field
from typing import Any

from mathutils import Vector

from ...motion.coasting import CoastingHand
from ...motion.rolling import Round
from ...scene.scene import Instance
from ..areas import Area, Flat, heading_to
from ..errors import NoRoom
from ..looks import Look
from ..stage import Stage
from .arms import Reach

Frames = tuple[int, int]


@dataclass
class Item:
    """A thing before it is built: what it looks like, the room it needs, where it begins."""

    name: str
    look: Look
    radius_m: float
    at: Flat = (0.0, 0.0)
    placed: bool = False
    heading_deg: float | None = None
    thing: Instance | None = None

    def place(self, table: Area, at: Flat) -> None:
        """Takes room."""
        self.at, self.placed = at, True
        table.take(at, self.radius_m, owner=self.name)

    def build(self, stage: Stage, rng: random.Random, table: Area, **words: Any) -> Instance:
        """Puts it where it was planned."""
        heading = rng.uniform(-180.0, 180.0) if self.heading_deg is None else self.heading_deg
        prop = stage.member(self.look, self.name, self.at, heading, area=table, radius_m=0.0, **words)
        self.thing = prop.instance
        return prop.instance


@dataclass
class Deed:
    """`verb` is push, roll, send, lift, stack or turn; `start` the frame at which the hand sets out.

    `onto` is what a thing is stacked on, or what a pushed thing bumps; `axle_m` the radius of what rolls.
    """

    verb: str
    item: Item
    start: int
    arm: Reach | None = None
    onto: Item | None = None
    end: Flat = (0.0, 0.0)
    lengths_m: tuple[float, float] = (0.09, 0.18)
    axle_m: float = 0.0
    grip_m: float = 0.0  # height above the table at which fingers push
    thing_verb: str = "slide"
    took: list[Flat] = field(default_factory=list)

    # ---- the plan --------------------------------------------------------------------------------

    def plan(self, rng: random.Random, table: Area, arm: Reach) -> None:
        """Finds room for the thing, for its way and for the arm."""
        self.arm = arm
        item = self.item
        if self.verb in ("push", "send"):
            followed = 0.45 if self.verb == "send" else 1.0
            item.at, self.end = arm.push(rng, table, item.radius_m, self.lengths_m, followed=followed)
            item.placed = True
            table.take(item.at, item.radius_m, self.end, owner=item.name)
            stop = self._along(followed)
            self.took = [item.at, stop]
        elif self.verb == "stack":
            assert self.onto is not None
            self._plan_stack(rng, table, arm, self.onto)
        else:
            item.place(table, arm.spot(rng, table, item.radius_m, tries=80))
            self.took = [item.at]
        arm.take(table, *self.took)

    def _plan_stack(self, rng: random.Random, table: Area, arm: Reach, onto: Item) -> None:
        for _ in range(80):
            below = onto.at if onto.placed else table.spot(rng, onto.radius_m)
            at = table.spot(rng, self.item.radius_m, near=below, within_m=(0.09, 0.22))
            apart = ((at[0] - below[0]) ** 2 + (at[1] - below[1]) ** 2) ** 0.5
            if (
                apart > self.item.radius_m + onto.radius_m + 0.03
                and arm.reaches(table, below)
                and arm.reaches(table, at)
                and arm.is_clear(table, at, below, ignoring=(onto.name,))
            ):
                self.item.place(table, at)
                if not onto.placed:
                    onto.place(table, below)
                self.took = [at, below]
                return
        raise NoRoom(f"no room to stack {self.item.name}")

    def _along(self, share: float) -> Flat:
        (x, y), (u, v) = self.item.at, self.end
        return x + share * (u - x), y + share * (v - y)

    @property
    def way_m(self) -> Flat:
        """From where it lies to where it comes to rest."""
        return self.end[0] - self.item.at[0], self.end[1] - self.item.at[1]

    @property
    def heading_deg(self) -> float:
        """Where fingers point that push it."""
        return heading_to(self.item.at, self.end)

    # ---- the act ---------------------------------------------------------------------------------

    def play(self, stage: Stage, rng: random.Random) -> CoastingHand:
        """Builds the hand and lets it act."""
        assert self.arm is not None and self.item.thing is not None
        hand, thing, t = self.arm.hand(stage, CoastingHand), self.item.thing, self.start
        here = thing.matrix(t).translation
        if self.verb in ("push", "send"):
            point = (here.x, here.y, here.z + self.grip_m)
            hand.approach(thing, (t, t + 16), grip="push", heading_deg=self.heading_deg, point=point)
            end = self._push(hand, thing, rng, t + 16)
        elif self.verb == "turn":
            hand.approach(thing, (t, t + 16), grip="top", heading_deg=self.arm.heading_deg(self.item.at))
            end = t + 16 + rng.randint(16, 22)
            angle = rng.choice((-1, 1)) * rng.uniform(32.0, 50.0)
            hand.twist(Round(thing, 0.0, Vector()), angle, (t + 16, end))
        else:
            hand.approach(thing, (t, t + 16), grip="top")
            end = self._lift(stage, hand, thing, rng, t + 16)
        if self.verb != "send":
            hand.release((end, end + 8))
            end += 8
        if end + 14 <= 96:
            hand.withdraw((end, min(end + 22, 96)))
        return hand

    def _push(self, hand: CoastingHand, thing: Instance, rng: random.Random, first: int) -> int:
        """Until it rests, or until the hand lets go of what goes on by itself; returns that frame."""
        if self.verb == "push":
            last = first + rng.randint(18, 26)
            bumped = self.onto.thing if self.onto else None
            hand.push(self.way_m, (first, last), bumped)
            return last
        let_go, rest = first + rng.randint(13, 15), min(first + rng.randint(32, 42), 96)
        if self.axle_m:
            ball = Round(thing, self.axle_m, Vector((0.0, 0.0, self.axle_m)))
            ground = thing.matrix(first).translation.z
            hand.send_rolling(ball, [(*self.end, ground)], (first, rest), let_go=let_go)
        else:
            hand.push_on(self.way_m, (first, rest), let_go=let_go, thing_verb=self.thing_verb)
        return let_go + 9

    def _lift(self, stage: Stage, hand: CoastingHand, thing: Instance, rng: random.Random, first: int) -> int:
        """Up, and down again where it was or on top of another; returns the frame at which it stands."""
        here = thing.matrix(first).translation
        top, down = first + rng.randint(14, 17), first + rng.randint(31, 36)
        if self.onto is None or self.onto.thing is None:
            hand.lift((first, top), height_m=rng.uniform(0.06, 0.10))
            hand.put_down((here.x, here.y, here.z), (top, down))
            return down
        below = self.onto.thing.matrix(first).translation
        height = max(v.co.z for v in self.onto.thing.objects[0].data.vertices)
        hand.lift((first, top), height_m=height + rng.uniform(0.03, 0.05))
        hand.put_down((below.x, below.y, below.z + height), (top, down))
        stage.scene.event(hand.instance, "stack", (first, down), thing)
        stage.may_touch(thing, self.onto.thing)
        return down


def rest_of(rng: random.Random, table: Area, items: list[Item]) -> None:
    """Room for those that no one has placed yet."""
    for item in items:
        if not item.placed:
            item.place(table, table.spot(rng, item.radius_m))
