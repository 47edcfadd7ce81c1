"""Cats on a floor or a lawn: some bat balls, one walks somewhere, the others sit, sleep, crouch or watch."""

from __future__ import annotations

import itertools
import random
from math import ceil
from typing import TYPE_CHECKING

from ...motion.ball_games import Ball
from ...motion.cats import Cat, Tap
from ...scene import catalogue
from ...scene.timeline import FPS, LAST_FRAME
from .. import looks
from ..animals import bodies, playthings, ways
from ..animals.members import Part, Plan, Planner, Toy, planned
from ..animals.ways import Way, ahead
from ..areas import Area, Flat
from ..errors import NoRoom
from ..looks import Look
from . import theme

if TYPE_CHECKING:
    from ..stage import Stage

CAT = ways.Body(ahead_m=0.33, behind_m=0.40, half_width_m=0.13, turn_m=0.30)
REACH_M = 0.19  # from a poised cat's middle to the near side of a ball
RISE, LOWER, POISE = 14, 14, 9  # frames
LEAD_M = 0.16  # how far the act of walking goes straight ahead by itself
TAP_FRAMES = 11

_TOLD = {
    "bat": "bat a toy",
    "walk": "walk",
    "sleep": "sleep",
    "sit": "sit",
    "crouch": "crouch",
    "watch": "watch",
}
"""What the story says of acts."""


@theme(
    "room",
    needs=("floor",),
    categories=("cat", "toy"),
    verbs=("walk", "sit", "sit_down", "stand_up", "stand", "sleep", "crouch", "bat", "watch", "roll"),
)
def cats_indoors(stage: Stage) -> None:
    """Cats and their toys on a floor."""
    rng = stage.rng("cats")
    toys = playthings.wool_and_mice(rng)
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
    toys = playthings.balls(rng, (0.125, 0.145))
    _play(stage, stage.area("lawn"), rng.choice((3, 4, 4, 5)), toys)


# ---- cast ----------------------------------------------------------------------------------------------


def _cast(rng: random.Random, count: int) -> list[Look]:
    options = {"coat": looks.words_of("cat", "coat"), "collar": ("red", "blue", "green", "orange")}
    return looks.crossed(rng, "cat", count, options)


# ---- plan ----------------------------------------------------------------------------------------------


def _play(stage: Stage, area: Area, count: int, toys: list[Toy]) -> None:
    rng = stage.rng("cats' day")
    cats = _cast(rng, count)
    indoors = area.name == "floor"

    wanted, tries = (rng.random() < 0.75, rng.random() < 0.65), itertools.count()

    def make(middle: Flat) -> Plan:
        wish = wanted if next(tries) < 220 else (rng.random() < 0.5, False)
        return _Planner(rng, area, middle, 1.05 if indoors else 1.5, CAT, toys).plan(count, *wish)

    plan = planned(stage, area, rng, "cats at play", 1.5 if indoors else 2.2, make)
    rng.shuffle(cats)
    _act(stage, area, cats, plan)


class _Planner(Planner):
    """Draws who plays, who walks and who rests, and plans them in this order."""

    def plan(self, count: int, early: bool, again: bool) -> Plan:
        """Draws who does what when; `early` plays from the start on, `again` with the same toy."""
        rng = self.rng
        balls = [toy for toy in self.toys if playthings.rolls(toy)]
        rng.shuffle(balls)
        if early:
            self._play_first(balls[0])
        if early and again:
            self._walk_to_play(balls[0])
        elif len(balls) > 1 and rng.random() < 0.7:
            self._walk_to_play(balls[1])
        elif not early:
            self._walk_to_play(balls[0])
        self.lay_rest(0.05)
        left = count - len(self.parts)
        walkers = min(left, rng.choice((0, 1, 1, 2)) if len(self.parts) > 1 else rng.choice((1, 2)))
        for _ in range(walkers):
            self._walk(late=rng.random() < 0.5)
        for _ in range(left - walkers):
            self._rest()
        return Plan(self.parts, self.toys)

    # Who plays.

    def _play_first(self, toy: Toy) -> None:
        """Sits ready before a toy, bats it away, then sits down."""
        at, heading = self.spot(0.6)
        self._ball_before(toy, at, heading)
        first = self.rng.randint(0, 8)
        part = _part(at, heading, "poise")
        end = self._bat(part, toy, first, self.rng.randint(22, 30))
        part.acts.append(("settle", (end + 2, end + 2 + LOWER)))
        part.acts.append(("sit", (end + 2 + LOWER, LAST_FRAME)))
        self.parts.append(part)

    def _walk_to_play(self, toy: Toy) -> None:
        """Comes to a toy, perhaps one that another has batted, and bats it."""
        rng = self.rng
        fresh = toy.at is None
        if fresh:
            at, heading = self.spot(0.8)
            self._ball_before(toy, at, heading)
        ignoring = (self.name(toy), self.owner)
        if not fresh:
            at, heading = self._spot_at(toy, ignoring)
        way = self.way_to(at, heading, (0.6, 1.15), toy)
        arrive = max(toy.still_from - 4, rng.randint(44, 58)) if not fresh else rng.randint(40, 60)
        leave = arrive - self._frames_for(way)
        if leave < 0 or arrive > 62:
            raise NoRoom("time for a walk to the ball")
        part = _part(way.start, way.heading_deg, "stand")
        self._wait(part, leave)
        part.acts.append(("walk", (leave, arrive), way))
        part.acts.append(("poise", (arrive, arrive + POISE)))
        self.go(way)
        self._bat(part, toy, arrive + POISE - 5, None)
        self.parts.append(part)

    def _spot_at(self, toy: Toy, ignoring: tuple[str, ...]) -> tuple[Flat, float]:
        for _ in range(16):
            heading = self.rng.uniform(-180.0, 180.0)
            at = ahead(toy.final, heading, -(REACH_M + toy.radius_m), self._paw_aside())
            if ways.fits(self.area, CAT, at, heading, ignoring):
                return at, heading
        raise NoRoom("a cat at the ball")

    def _bat(self, part: Part, toy: Toy, first: int, roll_frames: int | None) -> int:
        """A tap across and a stroke that sends it off; returns when the paw is back."""
        rng, (at, heading) = self.rng, part.now()
        start = toy.final
        side = 1.0 if _left_of(at, heading, start) > 0 else -1.0
        across = ahead(start, heading, rng.uniform(0.0, 0.02), -side * rng.uniform(0.06, 0.08))
        far = (0.22, 0.38) if roll_frames is None else (0.45, 0.8)
        goal = self.roll(toy, across, heading + side * rng.uniform(5.0, 45.0), 25.0, far)
        tap = first + 6
        last = LAST_FRAME if roll_frames is None else tap + TAP_FRAMES + roll_frames
        near, other = ("fore.L", "fore.R") if side > 0 else ("fore.R", "fore.L")
        taps = [Tap(tap, near, across, tap + TAP_FRAMES), Tap(tap + TAP_FRAMES, other, goal, last)]
        end = min(tap + TAP_FRAMES + 9, LAST_FRAME)
        part.acts.append(("bat", (first, end), toy, taps))
        toy.rolls_to, toy.still_from = goal, last
        return end

    def _ball_before(self, toy: Toy, at: Flat, heading: float) -> None:
        toy.at = ahead(at, heading, REACH_M + toy.radius_m, self._paw_aside())
        if not self.area.is_free(toy.at, toy.radius_m + 0.02):
            raise NoRoom("a ball before a cat")
        self.stay(at, heading)
        self.area.take(toy.at, toy.radius_m + 0.02, owner=self.name(toy))

    def _paw_aside(self) -> float:
        return self.rng.choice((-1, 1)) * self.rng.uniform(0.022, 0.034)

    # Who walks and who rests.

    def _walk(self, late: bool) -> None:
        rng = self.rng
        way = self.stroll((0.6, 1.2))
        frames = self._frames_for(way)
        latest = LAST_FRAME - frames - 6
        leave = rng.randint(min(30, latest), latest) if late else rng.randint(0, min(24, latest))
        sits_first = leave >= 13 + RISE and rng.random() < 0.6
        part = _part(way.start, way.heading_deg, "sit" if sits_first else "stand")
        self._wait(part, leave)
        arrive = leave + frames
        part.acts.append(("walk", (leave, arrive), way))
        self._after(part, arrive)
        self.go(way)
        self.parts.append(part)

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
        if left >= LOWER + 1 and self.rng.random() < 0.6:
            part.acts.append(("settle", (arrive, arrive + LOWER)))
            part.acts.append(("sit", (arrive + LOWER, LAST_FRAME)))
        elif left >= 24 and self.rng.random() < 0.5:
            part.acts.append(("duck", (arrive + 2, arrive + 12)))
            part.acts.append(("crouch", (arrive + 12, LAST_FRAME)))
        else:
            part.acts.append(("stand", (arrive, LAST_FRAME)))

    def _rest(self) -> None:
        rng = self.rng
        what = rng.choice(("sleep", "sit", "sit", "crouch", "rise"))
        rolling = [toy for toy in self.toys if toy.rolls_to is not None]
        watched = rng.choice(rolling) if rng.random() < 0.7 else None
        facing = watched.at if watched else self.middle
        astray = 180.0 if what == "sleep" else 40.0
        at, heading = self.spot(self.spread_m, facing=facing, astray_deg=astray)
        part = _part(at, heading, "sit" if what == "rise" else what)
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
        self.stay(at, heading)
        self.parts.append(part)

    def _frames_for(self, way: Way) -> int:
        strides = round(1.04 * way.length_m / 0.36 + 0.2) + 0.4
        return max(ceil(strides / 2.45 * FPS), round(way.length_m / self.rng.uniform(0.52, 0.72) * FPS))


def _part(at: Flat, heading_deg: float, posture: str) -> Part:
    return Part(at, heading_deg, posture, 0.13, 0.15 if posture == "sleep" else 0.30)


def _left_of(at: Flat, heading_deg: float, point: Flat) -> float:
    left = ahead((0.0, 0.0), heading_deg, 0.0, 1.0)
    return (point[0] - at[0]) * left[0] + (point[1] - at[1]) * left[1]


# ---- acting --------------------------------------------------------------------------------------------


def _act(stage: Stage, area: Area, cast: list[Look], plan: Plan) -> None:
    scene, rng = stage.scene, stage.rng("acting")

    def ground(x: float, y: float) -> float:
        return area.point(x, y)[2]

    balls = [playthings.put(stage, area, toy, k) for k, toy in enumerate(plan.toys)]
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
        bodies.enter(stage, "cat", cat, look, part)
        cats.append(stage.perform(cat))
    rolled = {id(toy): ball for toy, ball in zip(plan.toys, balls)}
    for wanted in ("bat", "watch"):
        for cat, part in zip(cats, plan.parts):
            if any(act[0] == "bat" for act in part.acts) == (wanted == "bat"):
                _perform(cat, part, rolled)
    for ball in balls:
        if ball is not None:
            stage.perform(ball)
    stage.tell(plan.story("cats", _TOLD))


def _perform(cat: Cat, part: Part, balls: dict[int, Ball | None]) -> None:
    """Plays the acts of a part in the order of time; states shorter than an event are not told."""
    event = cat.scene.event
    for what, frames, *about in part.acts:
        long = frames[1] - frames[0] >= 12
        if what == "walk":
            cat.walk_along(about[0].beyond(LEAD_M), frames)
        elif what == "bat":
            toy, taps = about
            ball = balls[id(toy)]
            assert ball is not None
            cat.play_with(ball, taps, frames)
        elif what == "watch":
            ball = balls[id(about[0])]
            assert ball is not None
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
