"""Animals and toys of a plan on the ground: who is where, which way, and what is seen of it. Builds nothing.

A theme's planner adds what its animals do. An act is (what, frames, more...); "walk" and "run" carry a way.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import hypot
from typing import TYPE_CHECKING, TypeVar

from ..areas import Area, Flat
from ..errors import NoRoom
from ..looks import Look
from ..planning import fitting, middles_near
from ..sight import Bulk, hidden
from . import ways
from .ways import Body, Way

if TYPE_CHECKING:
    from ..stage import Stage

Frames = tuple[int, int]
TRAVELS = ("walk", "run", "swim")


@dataclass
class Toy:
    """A toy of the plan; its place is where it lies at first."""

    look: Look
    radius_m: float
    height_m: float
    at: Flat | None = None
    rolls_to: Flat | None = None
    still_from: int = 0

    @property
    def final(self) -> Flat:
        """Where it lies in the end."""
        assert self.at is not None
        return self.rolls_to or self.at

    def bulk(self, frame: int, floor_m: float) -> Bulk:
        """What there is to see of it at a frame."""
        assert self.at is not None
        at = self.final if frame >= self.still_from else self.at
        return Bulk(at, self.radius_m, self.height_m, floor_m)


@dataclass
class Part:
    """What one animal does: where it begins, its acts in the order of time, and how much there is to see."""

    at: Flat
    heading_deg: float
    posture: str
    half_width_m: float
    height_m: float
    acts: list[tuple] = field(default_factory=list)

    def ways(self) -> list[Way]:
        """Those that it goes."""
        return [act[2] for act in self.acts if act[0] in TRAVELS]

    def now(self) -> tuple[Flat, float]:
        """Where it is after the acts so far, and its heading."""
        gone = self.ways()
        return (gone[-1].end, gone[-1].end_heading_deg) if gone else (self.at, self.heading_deg)

    def bulk(self, frame: int, floor_m: float) -> Bulk:
        """What there is to see of it at a frame."""
        at = self.at
        for what, (first, last), *about in self.acts:
            if what in TRAVELS and frame >= first:
                points = about[0].points
                at = points[round(min((frame - first) / (last - first), 1.0) * (len(points) - 1))]
            elif what == "fly" and frame >= first:
                points = about[0]
                at = points[round(min((frame - first) / (last - first), 1.0) * (len(points) - 1))][:2]
        return Bulk(at, self.half_width_m, self.height_m, floor_m)


@dataclass
class Plan:
    """Everything that happens."""

    parts: list[Part]
    toys: list[Toy]

    def moments(self, floor_m: float) -> list[list[Bulk]]:
        """All of them at some times."""
        things: list[Part | Toy] = [*self.parts, *self.toys]
        return [[thing.bulk(frame, floor_m) for thing in things] for frame in range(0, 97, 24)]

    def points(self) -> list[Flat]:
        """Where something is at some time."""
        found = [at for toy in self.toys for at in (toy.at, toy.final) if at is not None]
        for part in self.parts:
            found += [part.at, *(point for way in part.ways() for point in way.points[::6])]
            found += [point[:2] for act in part.acts if act[0] == "fly" for point in act[2]]
        return found

    def story(self, noun: str, words: Mapping[str, str]) -> str:
        """How many do what, for the acts that have words."""
        counts: dict[str, int] = {}
        for part in self.parts:
            for what in dict.fromkeys(act[0] for act in part.acts):
                counts[what] = counts.get(what, 0) + 1
        parts = [f"{counts[what]} {verb}" for what, verb in words.items() if what in counts]
        return f"Of {len(self.parts)} {noun} {', '.join(parts)}."


class Planner:
    """One try: whoever is planned first takes room first."""

    def __init__(
        self,
        rng: random.Random,
        area: Area,
        middle: Flat,
        spread_m: float,
        body: Body,
        toys: Sequence[Toy] = (),
    ) -> None:
        self.rng, self.area, self.middle, self.spread_m, self.body = rng, area, middle, spread_m, body
        self.toys = [replace(toy) for toy in toys]
        self.parts: list[Part] = []

    @property
    def owner(self) -> str:
        """Who takes room now: the next part."""
        return f"member {len(self.parts)}"

    def name(self, toy: Toy) -> str:
        """Who takes room for a toy."""
        return f"toy {next(k for k, other in enumerate(self.toys) if other is toy)}"

    def spot(self, within_m: float, *, facing: Flat | None = None, astray_deg: float = 110.0):
        """A free place near the middle, looking roughly there or towards `facing`."""
        return ways.spot(
            self.area,
            self.body,
            self.rng,
            near=self.middle,
            within_m=(0.0, within_m),
            facing=self.middle if facing is None else facing,
            astray_deg=astray_deg,
        )

    def inside(self, at: Flat) -> bool:
        """Whether a point is where things happen."""
        return hypot(at[0] - self.middle[0], at[1] - self.middle[1]) < self.spread_m + 0.2

    def stay(self, at: Flat, heading_deg: float) -> None:
        """Takes room for the next part, which keeps its place."""
        ways.take(self.area, self.body, at, heading_deg, self.owner)

    def go(self, way: Way) -> None:
        """Takes room for the next part along a way."""
        ways.take_way(self.area, self.body, way, self.owner)

    def stroll(self, length_m: tuple[float, float], start: tuple[Flat, float] | None = None) -> Way:
        """A way from somewhere to somewhere, inside."""
        for _ in range(8):
            here = self.spot(self.spread_m) if start is None else start
            way = ways.stroll(
                self.area, self.body, self.rng, here, length_m, ignoring=(self.owner,), tries=10
            )
            if way is not None and self.inside(way.end):
                return way
        raise NoRoom("a walk")

    def way_to(self, at: Flat, heading_deg: float, length_m: tuple[float, float], toy: Toy) -> Way:
        """A way that ends at a place with a toy before it; the toy itself is not in the way."""
        rng, ignoring = self.rng, (self.name(toy), self.owner)
        for _ in range(24):
            aside, far = rng.uniform(-70.0, 70.0), rng.uniform(*length_m)
            start = ways.ahead(at, heading_deg + aside, -far)
            facing = ways.wrapped(heading_deg + 1.5 * aside + rng.uniform(-20.0, 20.0))
            if not self.inside(start) or not ways.fits(self.area, self.body, start, facing):
                continue
            way = ways.find_way(
                self.area,
                self.body,
                rng,
                (start, facing),
                (at, heading_deg),
                ignoring=ignoring,
                clear_of=[(toy.final, toy.radius_m)],
                tries=4,
            )
            if way is not None:
                return way
        raise NoRoom("a way to the ball")

    def roll(
        self, toy: Toy, start: Flat, heading_deg: float, astray_deg: float, far_m: tuple[float, float]
    ) -> Flat:
        """Where a toy comes to rest that is sent off from `start`; takes room on its way."""
        ignoring = (self.name(toy), self.owner)
        for _ in range(12):
            aside = self.rng.uniform(-astray_deg, astray_deg)
            goal = ways.ahead(start, heading_deg + aside, self.rng.uniform(*far_m))
            if self.inside(goal) and self.area.is_free(start, toy.radius_m + 0.03, goal, ignoring=ignoring):
                self.area.take(start, toy.radius_m + 0.03, goal, owner=self.name(toy))
                return goal
        raise NoRoom("a way for the ball")

    def lay_rest(self, room_m: float) -> None:
        """Lays the toys that have no place yet."""
        for toy in self.toys:
            if toy.at is None:
                room = toy.radius_m + room_m
                toy.at = self.area.spot(self.rng, room, near=self.middle, within_m=(0.1, self.spread_m))
                self.area.take(toy.at, room, owner=self.name(toy))


AnyPlan = TypeVar("AnyPlan", bound=Plan)


def planned(
    stage: Stage,
    area: Area,
    rng: random.Random,
    what: str,
    near_m: float,
    make: Callable[[Flat], AnyPlan],
    *,
    height_m: float = 0.15,
    margin_m: float = 0.4,
    least_rise: float = 0.5,
) -> AnyPlan:
    """The first plan that fits and of which cameras will see everything; the cameras come nearer for it.

    `make` plans round a middle; several are tried, those near landmarks first.
    """
    floor_m = area.point(*area.centre)[2]
    marks = [
        Bulk(mark.at, 0.4 * min(mark.kind.size_m[:2]), mark.height_m, floor_m) for mark in stage.landmarks
    ]
    middles = middles_near(area, rng, stage.landmarks, 0.5, near_m)

    def plan() -> AnyPlan:
        made = make(rng.choice(middles))
        rig = stage.closer(
            made.points(), height_m=floor_m + height_m, margin_m=margin_m, least_rise=least_rise
        )
        if hidden(rig, made.moments(floor_m), marks):
            raise NoRoom("a view of all")
        stage.film(rig)
        return made

    return fitting(area, what, 300, plan)
