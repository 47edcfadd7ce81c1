"""Dogs on a lawn: they run after balls and nudge them on, walk, sit, lie down, get up and wag their tails."""

from __future__ import annotations

import itertools
from math import ceil
from typing import TYPE_CHECKING

from mathutils import Vector

from ...motion.ball_games import Ball
from ...motion.dogs import Dog, nudge_reach
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

DOG = ways.Body(ahead_m=0.58, behind_m=0.62, half_width_m=0.20, turn_m=0.55)
LEAD_M = 0.26  # how far a run goes straight ahead by itself
RISE, LOWER, LIE = 14, 14, 18  # frames
NUDGE_BEFORE, NUDGE_AFTER = 10, 12  # frames round the strike

_TOLD = {"run": "run", "nudge": "nudge a ball", "walk": "walk", "lie": "lie", "sit": "sit", "watch": "watch"}
"""What the story says of acts."""


@theme(
    "outdoor",
    needs=("lawn",),
    categories=("dog", "ball"),
    verbs=(
        "run",
        "walk",
        "chase",
        "nudge",
        "roll",
        "sit",
        "sit_down",
        "stand",
        "stand_up",
        "lie",
        "lie_down",
        "watch",
    ),
)
def dogs_outdoors(stage: Stage) -> None:
    """Dogs and balls on a lawn."""
    rng, area = stage.rng("dogs"), stage.area("lawn")
    count = rng.choice((3, 3, 4))
    toys = playthings.balls(rng, (0.155, 0.185))
    options = {"coat": looks.words_of("dog", "coat"), "collar": ("red", "blue", "green", "orange", "yellow")}
    dogs = looks.crossed(rng, "dog", count, options)

    wanted, tries = (rng.random() < 0.6, rng.random() < 0.85), itertools.count()

    def make(middle: Flat) -> Plan:
        wish = wanted if next(tries) < 220 else (rng.random() < 0.5, False)
        return _Planner(rng, area, middle, 1.9, DOG, toys).plan(count, *wish)

    plan = planned(stage, area, rng, "dogs at play", 2.8, make, height_m=0.25)
    rng.shuffle(dogs)
    _act(stage, area, dogs, plan)


class _Planner(Planner):
    """Draws who plays, who goes somewhere and who rests, and plans them in this order."""

    def plan(self, count: int, early: bool, again: bool) -> Plan:
        """Draws who does what when; `early` nudges from the start on, `again` another does so later."""
        rng = self.rng
        balls = list(self.toys)
        rng.shuffle(balls)
        if early:
            self._nudge(balls[0], rng.randint(11, 18))
        else:
            self._run_to_nudge(balls[0], rng.randint(34, 46), None)
        if again:
            self._run_to_nudge(balls[0] if early else balls[1], None, balls[0] if early else None)
        self.lay_rest(0.06)
        left = count - len(self.parts)
        going = min(left, rng.choice((0, 1, 1)))
        for _ in range(going):
            self._go_somewhere()
        for _ in range(left - going):
            self._rest()
        return Plan(self.parts, self.toys)

    def _nudge(self, toy: Toy, strike: int) -> None:
        """Starts with a ball before it and sends it off."""
        at, heading = self.spot(0.9)
        self._ball_before(toy, at, heading)
        part = _part(at, heading, "stand")
        self._strike(part, toy, strike, heading)
        self._after(part, strike + NUDGE_AFTER)
        self.parts.append(part)

    def _run_to_nudge(self, toy: Toy, arrive: int | None, chased: Toy | None) -> None:
        """Runs to a ball (after one that rolls) and sends it off if there is time."""
        rng = self.rng
        if toy.at is None:
            at, heading = self.spot(1.0)
            self._ball_before(toy, at, heading)
        else:
            at, heading = self._spot_at(toy)
        way = self.way_to(at, heading, (1.3, 2.2), toy)
        frames = self._frames_for(way, "run")
        if arrive is None:
            earliest = max(toy.still_from - 4, frames + 14)
            arrive = rng.randint(earliest, earliest + 8) if toy.still_from else rng.randint(frames, 66)
        leave = arrive - frames
        if leave < 0 or arrive > 84:
            raise NoRoom("time for a run to the ball")
        part = _part(
            way.start, way.heading_deg, rng.choice(("stand", "sit")) if leave >= 13 + RISE else "stand"
        )
        self._wait(part, leave)
        part.acts.append(("run", (leave, arrive), way, chased if self._rolls_on(chased, leave) else None))
        self.go(way)
        if arrive + NUDGE_BEFORE <= 78 and rng.random() < 0.8:
            strike = arrive + NUDGE_BEFORE - 2
            self._strike(part, toy, strike, heading)
            self._after(part, strike + NUDGE_AFTER)
        else:
            self._after(part, arrive)
        self.parts.append(part)

    @staticmethod
    def _rolls_on(toy: Toy | None, leave: int) -> bool:
        return toy is not None and toy.still_from >= leave + 8

    def _strike(self, part: Part, toy: Toy, strike: int, heading: float) -> None:
        start, last = toy.final, min(strike + self.rng.randint(30, 42), LAST_FRAME)
        far = (0.7, 1.6) if last - strike > 26 else (0.35, 0.7)
        goal = self.roll(toy, start, heading, 12.0, far)
        toy.rolls_to, toy.still_from = goal, last
        end = min(strike + NUDGE_AFTER, LAST_FRAME)
        part.acts.append(("nudge", (strike - NUDGE_BEFORE, end), toy, strike, goal, last))

    def _ball_before(self, toy: Toy, at: Flat, heading: float) -> None:
        toy.at = ahead(at, heading, nudge_reach(toy.radius_m)[1])
        if not self.area.is_free(toy.at, toy.radius_m + 0.02):
            raise NoRoom("a ball before a dog")
        self.stay(at, heading)
        self.area.take(toy.at, toy.radius_m + 0.02, owner=self.name(toy))

    def _spot_at(self, toy: Toy) -> tuple[Flat, float]:
        for _ in range(16):
            heading = self.rng.uniform(-180.0, 180.0)
            at = ahead(toy.final, heading, -nudge_reach(toy.radius_m)[1])
            if ways.fits(self.area, DOG, at, heading, (self.name(toy), self.owner)):
                return at, heading
        raise NoRoom("a dog at the ball")

    def _go_somewhere(self) -> None:
        rng = self.rng
        what = rng.choice(("walk", "walk", "run"))
        way = self.stroll((0.8, 1.5) if what == "walk" else (1.2, 2.0))
        frames = self._frames_for(way, what)
        latest = LAST_FRAME - frames - 4
        if latest < 0:
            raise NoRoom("time for a walk")
        leave = rng.randint(0, latest)
        part = _part(
            way.start, way.heading_deg, rng.choice(("stand", "sit", "lie")) if leave >= 13 + RISE else "stand"
        )
        self._wait(part, leave)
        part.acts.append((what, (leave, leave + frames), way, None))
        self._after(part, leave + frames)
        self.go(way)
        self.parts.append(part)

    def _rest(self) -> None:
        rng = self.rng
        rolling = [toy for toy in self.toys if toy.rolls_to is not None]
        watched = rng.choice(rolling) if rng.random() < 0.6 and rolling else None
        at, heading = self.spot(self.spread_m, facing=watched.at if watched else None, astray_deg=40.0)
        posture = rng.choice(("sit", "lie", "stand"))
        part = _part(at, heading, posture)
        first = rng.randint(14, 64)
        if posture != "stand" and rng.random() < 0.55:
            part.acts.append((posture, (0, first)))
            part.acts.append(("rise", (first, first + RISE)))
            part.acts.append(("stand", (first + RISE, LAST_FRAME)))
        elif posture != "lie" and rng.random() < 0.7:
            part.acts.append((posture, (0, first)))
            what, frames, then = rng.choice((("lower", LIE, "lie"),) if posture == "sit" else _DOWN)
            part.acts.append((what, (first, first + frames)))
            part.acts.append((then, (first + frames, LAST_FRAME)))
        else:
            part.acts.append((posture, (0, LAST_FRAME)))
        if watched is not None:
            part.acts.append(("watch", (rng.randint(0, 10), rng.randint(50, LAST_FRAME)), watched))
        elif rng.random() < 0.5:
            part.acts.append(("wag", (rng.randint(0, 30), rng.randint(60, LAST_FRAME))))
        self.stay(at, heading)
        self.parts.append(part)

    def _wait(self, part: Part, leave: int) -> None:
        """What a dog does until it goes."""
        if part.posture == "stand":
            part.acts.append(("stand", (0, leave)))
            return
        part.acts.append((part.posture, (0, leave - RISE)))
        part.acts.append(("rise", (leave - RISE, leave)))

    def _after(self, part: Part, arrive: int) -> None:
        """What a dog does when it has come, or has played."""
        left = LAST_FRAME - arrive
        what, frames, then = self.rng.choice(_DOWN)
        if left >= frames + 1 and self.rng.random() < 0.6:
            part.acts.append((what, (arrive, arrive + frames)))
            part.acts.append((then, (arrive + frames, LAST_FRAME)))
        else:
            part.acts.append(("stand", (arrive, LAST_FRAME)))
            if self.rng.random() < 0.5 and left > 20:
                part.acts.append(("wag", (arrive, LAST_FRAME)))

    def _frames_for(self, way: Way, what: str) -> int:
        stride, hertz = (0.80, 2.7) if what == "run" else (0.62, 2.4)
        beats = round(1.04 * way.length_m / stride + 0.2) + 0.6
        pace = self.rng.uniform(1.2, 1.7) if what == "run" else self.rng.uniform(0.65, 0.95)
        return max(ceil(beats / hertz * FPS), round(way.length_m / pace * FPS), 14)


_DOWN = (("settle", LOWER, "sit"), ("lower", LIE, "lie"))


def _part(at: Flat, heading_deg: float, posture: str) -> Part:
    return Part(at, heading_deg, posture, 0.20, 0.42 if posture == "lie" else 0.55)


# ---- acting --------------------------------------------------------------------------------------------


def _act(stage: Stage, area: Area, cast: list[Look], plan: Plan) -> None:
    balls = {id(toy): playthings.put_ball(stage, area, toy, k) for k, toy in enumerate(plan.toys)}
    dogs: list[Dog] = []
    for k, (look, part) in enumerate(zip(cast, plan.parts)):
        dog = bodies.dog(stage, k + 1, look, part)
        dogs.append(stage.perform(dog))
    for part in plan.parts:
        for what, _, *about in part.acts:
            if what == "nudge":
                toy, strike, goal, last = about
                balls[id(toy)].roll_to(goal, (strike, last))
    for dog, part in zip(dogs, plan.parts):
        _perform(dog, part, balls)
    for ball in balls.values():
        stage.perform(ball)
    stage.tell(plan.story("dogs", _TOLD))


def _perform(dog: Dog, part: Part, balls: dict[int, Ball]) -> None:
    """Plays the acts of a part in the order of time; states shorter than an event are not told."""
    for what, frames, *about in part.acts:
        if what == "run":
            chased = balls[id(about[1])] if about[1] is not None else None
            dog.run_along(about[0].beyond(LEAD_M), frames, after=chased.instance if chased else None)
        elif what == "walk":
            dog.walk_along(about[0].beyond(LEAD_M), frames)
        elif what == "nudge":
            toy, strike, *_ = about
            ball = balls[id(toy)]
            dog.nudge(ball.instance, frames, strike=strike, bow=nudge_reach(toy.radius_m)[0])
            _look_after(dog, ball, frames[1])
        elif what == "watch":
            ball = balls[id(about[0])]
            dog.watch(ball.centres, frames, event_object=ball.instance)
        elif what == "wag":
            dog.wag(frames)
        elif what == "rise":
            dog.stand_up(frames)
        elif what == "settle":
            dog.sit_down(frames)
        elif what == "lower":
            dog.lie_down(frames)
        elif frames[1] - frames[0] >= 12:  # sit, lie, stand
            dog.scene.event(dog.instance, what, frames)


def _look_after(dog: Dog, ball: Ball, first: int) -> None:
    if first < LAST_FRAME - 12:
        dog.watch([Vector(centre) for centre in ball.centres], (first, LAST_FRAME), ease_frames=10)
