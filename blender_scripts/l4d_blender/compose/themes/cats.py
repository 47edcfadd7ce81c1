"""Cats on a floor or a lawn: some bat balls, one walks somewhere, the others sit, sleep, crouch or watch."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass, field
from math import ceil, hypot
from typing import TYPE_CHECKING

from ... import catalogue
from ...motion.ball_games import Ball
from ...motion.cats import Cat, Tap
from ...timeline import FPS, LAST_FRAME
from .. import looks, ways
from ..areas import Area, Flat
from ..looks import Look
from ..planning import Unfit, fitting, middle_near
from ..sight import Bulk, hidden
from ..ways import Way, ahead
from . import theme

if TYPE_CHECKING:
    from ..stage import Stage

CAT = ways.Body(ahead_m=0.33, behind_m=0.40, half_width_m=0.13, turn_m=0.30)
REACH_M = 0.19  # from a poised cat's middle to the near side of a ball
RISE, LOWER, POISE = 14, 14, 9  # frames
LEAD_M = 0.16  # how far the act of walking goes straight ahead by itself
TAP_FRAMES = 11
Frames = tuple[int, int]


@dataclass
class Toy:
    """A toy of the plan; its place is where it lies at first."""

    look: Look
    radius_m: float
    at: Flat
    rolls_to: Flat | None = None
    still_from: int = 0

    def bulk(self, frame: int, floor_m: float) -> Bulk:
        """What there is to see of it at a frame."""
        at = self.final if frame >= self.still_from else self.at
        return Bulk(
            at, self.radius_m, 0.11 if self.look.words.get("kind") == "mouse" else 2 * self.radius_m, floor_m
        )

    @property
    def final(self) -> Flat:
        """Where it lies in the end."""
        return self.rolls_to or self.at


@dataclass
class Part:
    """What one cat does: where it begins and its acts in the order of time."""

    at: Flat
    heading_deg: float
    posture: str
    acts: list[tuple] = field(default_factory=list)
    reached: list[Flat] = field(default_factory=list)

    def bulk(self, frame: int, floor_m: float) -> Bulk:
        """What there is to see of it at a frame."""
        at = self.at
        for what, (first, last), *about in self.acts:
            if what == "walk" and frame >= first:
                points = about[0].points
                at = points[round(min((frame - first) / (last - first), 1.0) * (len(points) - 1))]
        return Bulk(at, 0.13, 0.15 if self.posture == "sleep" else 0.30, floor_m)


@dataclass
class Plan:
    """Everything that happens."""

    parts: list[Part]
    toys: list[Toy]

    def moments(self, floor_m: float) -> list[list[Bulk]]:
        """All of them at some times."""
        things = [*self.parts, *self.toys]
        return [[thing.bulk(frame, floor_m) for thing in things] for frame in range(0, 97, 24)]

    def points(self) -> list[Flat]:
        """Where something is at some time."""
        found = [toy.at for toy in self.toys] + [toy.final for toy in self.toys]
        for part in self.parts:
            found += [part.at, *part.reached]
        return found


@theme(
    "room",
    needs=("floor",),
    categories=("cat", "toy"),
    verbs=("walk", "sit", "sit_down", "stand_up", "stand", "sleep", "crouch", "bat", "watch", "roll"),
)
def cats_indoors(stage: Stage) -> None:
    """Cats and their toys on a floor."""
    rng = stage.rng("cats")
    toys = _wool_and_mice(rng)
    _play(stage, stage.area("floor"), rng.choice((3, 3, 4)), toys)


@theme(
    "outdoor",
    needs=("lawn",),
    categories=("cat", "ball"),
    verbs=("walk", "sit", "sit_down", "stand_up", "stand", "sleep", "crouch", "bat", "watch", "roll"),
)
def cats_outdoors(stage: Stage) -> None:
    """Cats and balls on a lawn."""
    rng = stage.rng("cats")
    toys = _balls(rng)
    _play(stage, stage.area("lawn"), rng.choice((3, 4, 4, 5)), toys)


# ---- cast ----------------------------------------------------------------------------------------------


def _wool_and_mice(rng: random.Random) -> list[Toy]:
    colours = ("red", "blue", "green", "yellow", "purple", "orange", "white", "grey")
    if rng.random() < 0.5:
        group = looks.crossed(rng, "yarn_ball", 4, {"kind": ("yarn_ball", "mouse"), "colour": colours})
    else:
        group = looks.crossed(
            rng, "yarn_ball", rng.choice((3, 4)), {"size": ("small", "large"), "colour": colours}
        )
    small, large = rng.uniform(0.088, 0.094), rng.uniform(0.118, 0.126)
    return [Toy(look, large if look.words.get("size") == "large" else small, (0.0, 0.0)) for look in group]


def _balls(rng: random.Random) -> list[Toy]:
    options = {
        "colour": ("red", "blue", "yellow", "purple", "orange", "green"),
        "pattern": looks.words_of("ball", "pattern"),
    }
    radius_m = rng.uniform(0.125, 0.145)
    group = looks.crossed(rng, "ball", rng.choice((3, 4)), options)
    return [Toy(look, radius_m, (0.0, 0.0)) for look in group]


def _cast(rng: random.Random, count: int) -> list[Look]:
    options = {"coat": looks.words_of("cat", "coat"), "collar": ("red", "blue", "green", "orange")}
    return looks.crossed(rng, "cat", count, options)


# ---- plan ----------------------------------------------------------------------------------------------


def _play(stage: Stage, area: Area, count: int, toys: list[Toy]) -> None:
    rng = stage.rng("cats' day")
    cats = _cast(rng, count)
    near = 1.5 if area.name == "floor" else 2.2
    middle = middle_near(area, rng, stage.landmarks, 0.5, near)
    spread = 1.05 if area.name == "floor" else 1.5

    floor_m = area.point(*area.centre)[2]
    marks = [
        Bulk(mark.at, 0.4 * min(mark.kind.size_m[:2]), mark.height_m, floor_m) for mark in stage.landmarks
    ]

    def plan() -> Plan:
        made = _Planner(rng, area, middle, spread, toys).plan(count)
        if hidden(stage.closer(made.points(), height_m=floor_m + 0.15), made.moments(floor_m), marks):
            raise Unfit("a view of all")
        return made

    made = fitting(area, "cats at play", 200, plan)
    order = list(range(count))
    rng.shuffle(order)
    _act(stage, area, [cats[k] for k in order], made)


class _Planner:
    """One try: takes room for who plays, who walks and who rests, in this order."""

    def __init__(
        self, rng: random.Random, area: Area, middle: Flat, spread_m: float, toys: Sequence[Toy]
    ) -> None:
        self._rng, self._area, self._middle, self._spread = rng, area, middle, spread_m
        self._toys = [Toy(toy.look, toy.radius_m, toy.at) for toy in toys]
        self._parts: list[Part] = []

    def plan(self, count: int) -> Plan:
        """Draws who does what when."""
        rng = self._rng
        balls = [toy for toy in self._toys if toy.look.words.get("kind") != "mouse"]
        rng.shuffle(balls)
        early = rng.random() < 0.75
        if early:
            self._play_first(balls[0])
        again = early and rng.random() < 0.6
        if again:
            self._walk_to_play(balls[0])
        elif len(balls) > 1 and rng.random() < 0.7:
            self._walk_to_play(balls[1])
        elif not early:
            self._walk_to_play(balls[0])
        for toy in self._toys:
            if toy.at == (0.0, 0.0):
                self._lay(toy)
        left = count - len(self._parts)
        walkers = min(left, rng.choice((0, 1, 1, 2)) if len(self._parts) > 1 else rng.choice((1, 2)))
        for _ in range(walkers):
            self._walk(late=rng.random() < 0.5)
        for _ in range(left - walkers):
            self._rest()
        return Plan(self._parts, self._toys)

    # Who plays.

    def _play_first(self, toy: Toy) -> None:
        """Sits ready before a toy, bats it away, then sits down."""
        at, heading = self._spot(0.6)
        self._ball_before(toy, at, heading)
        first = self._rng.randint(0, 8)
        part = Part(at, heading, "poise")
        end = self._bat(part, toy, first, self._rng.randint(22, 30))
        part.acts.append(("settle", (end + 2, end + 2 + LOWER)))
        part.acts.append(("sit", (end + 2 + LOWER, LAST_FRAME)))
        self._parts.append(part)

    def _walk_to_play(self, toy: Toy) -> None:
        """Comes to a toy, perhaps one that another has batted, and bats it."""
        rng = self._rng
        fresh = toy.at == (0.0, 0.0)
        if fresh:
            at, heading = self._spot(0.8)
            self._ball_before(toy, at, heading)
        ignoring = (self._name(toy), f"cat {len(self._parts)}")
        if not fresh:
            at, heading = self._spot_at(toy, ignoring)
        way = self._way_to(at, heading, ignoring, toy)
        arrive = max(toy.still_from - 4, rng.randint(44, 58)) if not fresh else rng.randint(40, 60)
        leave = arrive - self._frames_for(way)
        if leave < 0 or arrive > 62:
            raise Unfit("time for a walk to the ball")
        part = Part(way.start, way.heading_deg, "stand", reached=list(way.points[::6]))
        self._wait(part, leave)
        part.acts.append(("walk", (leave, arrive), way))
        part.acts.append(("poise", (arrive, arrive + POISE)))
        self._take(way)
        self._bat(part, toy, arrive + POISE - 5, None, ignoring)
        self._parts.append(part)

    def _spot_at(self, toy: Toy, ignoring: tuple[str, ...]) -> tuple[Flat, float]:
        for _ in range(16):
            heading = self._rng.uniform(-180.0, 180.0)
            at = ahead(toy.final, heading, -(REACH_M + toy.radius_m), self._paw_aside())
            if ways.fits(self._area, CAT, at, heading, ignoring):
                return at, heading
        raise Unfit("a cat at the ball")

    def _bat(
        self, part: Part, toy: Toy, first: int, roll_frames: int | None, ignoring: tuple[str, ...] = ()
    ) -> int:
        """A tap across and a stroke that sends it off; returns when the paw is back."""
        rng, at, heading = self._rng, part.at, part.heading_deg
        if part.reached:
            way = next(act[2] for act in part.acts if act[0] == "walk")
            at, heading = way.end, way.end_heading_deg
        start = toy.final
        side = 1.0 if _left_of(at, heading, start) > 0 else -1.0
        across = ahead(start, heading, rng.uniform(0.0, 0.02), -side * rng.uniform(0.06, 0.08))
        goal = self._goal(across, heading + side * rng.uniform(5.0, 45.0), toy, ignoring, roll_frames is None)
        tap = first + 6
        last = LAST_FRAME if roll_frames is None else tap + TAP_FRAMES + roll_frames
        near, other = ("fore.L", "fore.R") if side > 0 else ("fore.R", "fore.L")
        taps = [Tap(tap, near, across, tap + TAP_FRAMES), Tap(tap + TAP_FRAMES, other, goal, last)]
        end = min(tap + TAP_FRAMES + 9, LAST_FRAME)
        part.acts.append(("bat", (first, end), toy, taps))
        toy.rolls_to, toy.still_from = goal, last
        self._area.take(start, toy.radius_m + 0.03, goal, owner=self._name(toy))
        return end

    def _goal(self, start: Flat, heading: float, toy: Toy, ignoring: tuple[str, ...], brief: bool) -> Flat:
        """Where a stroke sends a toy."""
        rng = self._rng
        mine = (*ignoring, self._name(toy), f"cat {len(self._parts)}")
        for _ in range(12):
            far = rng.uniform(0.22, 0.38) if brief else rng.uniform(0.45, 0.8)
            goal = ahead(start, heading + rng.uniform(-25.0, 25.0), far)
            if self._area.is_free(start, toy.radius_m + 0.03, goal, ignoring=mine):
                return goal
        raise Unfit("a way for the ball")

    def _ball_before(self, toy: Toy, at: Flat, heading: float) -> None:
        toy.at = ahead(at, heading, REACH_M + toy.radius_m, self._paw_aside())
        if not self._area.is_free(toy.at, toy.radius_m + 0.02):
            raise Unfit("a ball before a cat")
        ways.take(self._area, CAT, at, heading, f"cat {len(self._parts)}")
        self._area.take(toy.at, toy.radius_m + 0.02, owner=self._name(toy))

    def _paw_aside(self) -> float:
        return self._rng.choice((-1, 1)) * self._rng.uniform(0.022, 0.034)

    # Who walks and who rests.

    def _walk(self, late: bool) -> None:
        rng = self._rng
        for _ in range(8):
            way = ways.stroll(self._area, CAT, rng, self._spot(self._spread), (0.6, 1.2), tries=10)
            if way is not None and self._inside(way.end):
                break
        else:
            raise Unfit("a walk")
        frames = self._frames_for(way)
        latest = LAST_FRAME - frames - 6
        leave = rng.randint(min(30, latest), latest) if late else rng.randint(0, min(24, latest))
        sits_first = leave >= 13 + RISE and rng.random() < 0.6
        part = Part(
            way.start, way.heading_deg, "sit" if sits_first else "stand", reached=list(way.points[::6])
        )
        self._wait(part, leave)
        arrive = leave + frames
        part.acts.append(("walk", (leave, arrive), way))
        self._after(part, arrive)
        self._take(way)
        self._parts.append(part)

    def _wait(self, part: Part, leave: int) -> None:
        """What a cat does until it walks."""
        if part.posture == "sit":
            part.acts.append(("sit", (0, leave - RISE)))
            part.acts.append(("rise", (leave - RISE, leave)))
        else:
            part.acts.append(("stand", (0, leave)))

    def _after(self, part: Part, arrive: int) -> None:
        """What a cat does when it has come."""
        left = LAST_FRAME - arrive
        if left >= LOWER + 1 and self._rng.random() < 0.6:
            part.acts.append(("settle", (arrive, arrive + LOWER)))
            part.acts.append(("sit", (arrive + LOWER, LAST_FRAME)))
        elif left >= 24 and self._rng.random() < 0.5:
            part.acts.append(("duck", (arrive + 2, arrive + 12)))
            part.acts.append(("crouch", (arrive + 12, LAST_FRAME)))
        else:
            part.acts.append(("stand", (arrive, LAST_FRAME)))

    def _rest(self) -> None:
        rng = self._rng
        what = rng.choice(("sleep", "sit", "sit", "crouch", "rise"))
        rolling = [toy for toy in self._toys if toy.rolls_to is not None]
        watched = rng.choice(rolling) if rng.random() < 0.7 else None
        facing = watched.at if watched else self._middle
        at, heading = ways.spot(
            self._area,
            CAT,
            rng,
            near=self._middle,
            within_m=(0.2, self._spread),
            facing=facing,
            astray_deg=180.0 if what == "sleep" else 40.0,
        )
        part = Part(at, heading, "sit" if what == "rise" else what)
        if what == "rise":
            when = rng.randint(16, 60)
            part.acts += [
                ("sit", (0, when)),
                ("rise", (when, when + RISE)),
                ("stand", (when + RISE, LAST_FRAME)),
            ]
        else:
            part.acts.append((what, (0, LAST_FRAME)))
        if what in ("sit", "crouch") and watched is not None:
            part.acts.append(("watch", (rng.randint(0, 10), rng.randint(60, LAST_FRAME)), watched))
        ways.take(self._area, CAT, at, heading, f"cat {len(self._parts)}")
        self._parts.append(part)

    # Room.

    def _spot(self, within_m: float) -> tuple[Flat, float]:
        return ways.spot(
            self._area,
            CAT,
            self._rng,
            near=self._middle,
            within_m=(0.0, within_m),
            facing=self._middle,
            astray_deg=110.0,
        )

    def _inside(self, at: Flat) -> bool:
        return hypot(at[0] - self._middle[0], at[1] - self._middle[1]) < self._spread + 0.2

    def _way_to(self, at: Flat, heading: float, ignoring: tuple[str, ...], toy: Toy) -> Way:
        rng = self._rng
        for _ in range(24):
            aside, far = rng.uniform(-70.0, 70.0), rng.uniform(0.6, 1.15)
            start = ahead(at, heading + aside, -far)
            facing = ways.wrapped(heading + 1.5 * aside + rng.uniform(-20.0, 20.0))
            if not self._inside(start) or not ways.fits(self._area, CAT, start, facing):
                continue
            way = ways.find_way(
                self._area,
                CAT,
                rng,
                (start, facing),
                (at, heading),
                ignoring=ignoring,
                clear_of=[(toy.final, toy.radius_m)],
                tries=4,
            )
            if way is not None:
                return way
        raise Unfit("a way to the ball")

    def _take(self, way: Way) -> None:
        ways.take_way(self._area, CAT, way, f"cat {len(self._parts)}")

    def _frames_for(self, way: Way) -> int:
        strides = round(1.04 * way.length_m / 0.36 + 0.2) + 0.4
        return max(ceil(strides / 2.45 * FPS), round(way.length_m / self._rng.uniform(0.52, 0.72) * FPS))

    def _lay(self, toy: Toy) -> None:
        room = toy.radius_m + (0.08 if toy.look.words.get("kind") == "mouse" else 0.04)
        for _ in range(40):
            toy.at = self._area.spot(self._rng, room, near=self._middle, within_m=(0.1, self._spread))
            if self._area.is_free(toy.at, room):
                self._area.take(toy.at, room, owner=self._name(toy))
                return
        raise Unfit("a toy")

    def _name(self, toy: Toy) -> str:
        return f"toy {next(k for k, other in enumerate(self._toys) if other is toy)}"


def _left_of(at: Flat, heading_deg: float, point: Flat) -> float:
    left = ahead((0.0, 0.0), heading_deg, 0.0, 1.0)
    return (point[0] - at[0]) * left[0] + (point[1] - at[1]) * left[1]


# ---- acting --------------------------------------------------------------------------------------------


def _act(stage: Stage, area: Area, cast: list[Look], plan: Plan) -> None:
    scene, rng = stage.scene, stage.rng("acting")

    def ground(x: float, y: float) -> float:
        return area.point(x, y)[2]

    balls = [_toy(stage, area, toy, k) for k, toy in enumerate(plan.toys)]
    cats: list[Cat] = []
    for k, (look, part) in enumerate(zip(cast, plan.parts)):
        arguments = catalogue.find("cat").arguments(**look.words)
        cat = Cat(
            scene,
            f"cat_{k + 1}",
            stage.next_id(),
            **arguments,
            at=part.at,
            heading_deg=part.heading_deg,
            ground=ground,
            posture=part.posture,
            tail_side=rng.choice((-1.0, 1.0)),
            attributes=look.attributes,
        )
        stage.register(
            "cat",
            cat.instance.name,
            cat.instance,
            at=part.at,
            heading_deg=part.heading_deg,
            area=None,
            look=look,
        )
        cats.append(stage.perform(cat))
    rolled = {id(toy): ball for toy, ball in zip(plan.toys, balls)}
    for wanted in ("bat", "watch"):
        for cat, part in zip(cats, plan.parts):
            if any(act[0] == "bat" for act in part.acts) == (wanted == "bat"):
                _perform(cat, part, rolled)
    for ball in balls:
        if ball is not None:
            stage.perform(ball)
    stage.film(stage.closer(plan.points(), height_m=area.point(*area.centre)[2] + 0.15))
    stage.tell(_story(plan))


def _toy(stage: Stage, area: Area, toy: Toy, k: int) -> Ball | None:
    category = "ball" if toy.look.kind == "ball" else "toy"
    name, rng = f"{category}_{k + 1}", stage.rng(f"toy/{k}")
    words = {key: word for key, word in toy.look.words.items() if key not in ("kind", "size")}
    heading = rng.uniform(-180.0, 180.0)
    if toy.look.words.get("kind") == "mouse":
        kind, sizes = "toy_mouse", {"length_m": 0.25}
    else:
        kind, sizes = toy.look.kind, {"radius_m": toy.radius_m}
    thing = stage.scene.put(kind, name, toy.at, heading, rng=rng, on=area.on, **words, **sizes)
    front = catalogue.find(kind).front
    prop = stage.register(
        kind, name, thing, at=toy.at, heading_deg=heading, area=None, look=toy.look, front=front
    )
    if kind == "toy_mouse":
        return None
    return Ball(prop.instance, toy.radius_m, toy.at, area.point(*toy.at)[2], turn=rng.uniform(0.0, 6.0))


def _perform(cat: Cat, part: Part, balls: dict[int, Ball | None]) -> None:
    """Plays the acts of a part in the order of time; states shorter than an event are not told."""
    event = cat.scene.event
    for what, frames, *about in part.acts:
        long = frames[1] - frames[0] >= 12
        if what == "walk":
            cat.walk_along(about[0].beyond(LEAD_M), frames)
        elif what == "bat":
            toy, taps = about
            cat.play_with(balls[id(toy)], taps, frames)
        elif what == "watch":
            ball = balls[id(about[0])]
            cat.watch(ball.centres, frames, event_object=ball.instance)
        elif what == "poise":
            cat.poise(frames)
        elif what == "duck":
            cat.crouch(frames)
        elif what == "rise":
            cat.stand_up(frames)
            event(cat.instance, "stand_up", frames)
        elif what == "settle":
            cat.sit_down(frames)
            event(cat.instance, "sit_down", frames)
        elif what == "sleep":
            cat.sleep(frames)
        elif long:  # sit, stand, crouch
            event(cat.instance, what, frames)


def _story(plan: Plan) -> str:
    counts: dict[str, int] = {}
    for part in plan.parts:
        for what in dict.fromkeys(act[0] for act in part.acts):
            counts[what] = counts.get(what, 0) + 1
    words = {
        "bat": "bat a toy",
        "walk": "walk",
        "sleep": "sleep",
        "sit": "sit",
        "crouch": "crouch",
        "watch": "watch",
    }
    parts = [f"{counts[what]} {verb}" for what, verb in words.items() if what in counts]
    return f"Of {len(plan.parts)} cats {', '.join(parts)}."
