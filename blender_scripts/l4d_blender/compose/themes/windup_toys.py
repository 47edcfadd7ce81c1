"""Wind-up robots on a table: they walk, turn and stop, and hands hold, turn or lift some of them."""

from __future__ import annotations

import random
from dataclasses import dataclass, field
from math import cos, hypot, radians, sin
from typing import TYPE_CHECKING

from mathutils import Vector

from ...motion.rolling import Roller, Round
from ...motion.windup_robots import STEP_FRAMES, WindUpRobot
from .. import looks
from ..areas import Area, Flat, retried
from ..errors import NoRoom
from ..hands.arms import Reach, reaches
from ..looks import Look
from . import theme

if TYPE_CHECKING:
    from ...scene.scene import Instance
    from ..stage import Stage

Frames = tuple[int, int]
PAINTS = ("red", "orange", "yellow", "green", "teal", "blue", "purple", "white")


@dataclass
class Part:
    """What one robot does by itself: verb, frames, and metres a step or degrees in all."""

    acts: list[tuple[str, Frames, float]] = field(default_factory=list)

    def is_busy(self, frames: Frames) -> bool:
        """Whether it acts during any of these frames."""
        return any(first <= frames[1] and frames[0] <= last for _, (first, last), _ in self.acts)

    @property
    def walked_m(self) -> float:
        """The length of its way."""
        return sum(_steps(frames) * amount for verb, frames, amount in self.acts if verb == "walk")


@dataclass(frozen=True)
class Help:
    """What a hand does with one robot: let_go, turn or lift, from a frame on."""

    verb: str
    robot: int
    start: int


@theme(
    "tabletop", needs=("table",), categories=("robot",), verbs=("walk", "turn", "hold", "lift", "put_down")
)
def windup_toys(stage: Stage) -> None:
    """Robots act by turns: what one does first, another does later."""
    rng, table = stage.rng("windup toys"), stage.area("table")
    cast = retried(table, 12, lambda: _draw_cast(stage, rng, table))
    robots = [_build(stage, table, robot) for robot in cast]
    for mover, robot in zip(robots, cast):
        _act(mover, robot.part)
    for mover, robot in zip(robots, cast):
        if robot.help and robot.arm:
            _help(stage, rng, robot.arm, robot.help, mover.instance)
    moving = sum(bool(robot.part.acts) for robot in cast)
    stage.tell(f"{len(cast)} wind-up robots on a table, of which {moving} walk or turn by themselves.")


# ---- who does what ---------------------------------------------------------------------------------


def _parts(rng: random.Random, count: int) -> list[Part]:
    """One verb is done early by one and late by another; a third may do the other verb at any time."""
    parts = [Part() for _ in range(count)]
    order = rng.sample(range(count), count)
    verb, other = rng.sample(("walk", "turn"), 2)
    early, late = _window(rng, 0), _window(rng, 1)
    parts[order[0]].acts.append(_draw(rng, verb, early))
    parts[order[1]].acts.append(_draw(rng, verb, late))
    if rng.random() < 0.5:
        parts[order[0]].acts.append(_draw(rng, other, _window(rng, 1)))
    if rng.random() < 0.7 or len(parts[order[0]].acts) < 2:
        parts[order[2]].acts.append(_draw(rng, other, _window(rng, rng.randint(0, 1))))
    return parts


def _window(rng: random.Random, half: int) -> Frames:
    first = rng.randint(2, 8) if half == 0 else rng.randint(52, 57)
    return first, first + rng.randint(34, 39)


def _draw(rng: random.Random, verb: str, frames: Frames) -> tuple[str, Frames, float]:
    amount = rng.uniform(0.022, 0.031) if verb == "walk" else rng.choice((-1, 1)) * rng.uniform(80, 170)
    return verb, frames, amount


def _helps(rng: random.Random, parts: list[Part]) -> list[Help]:
    """One or two hands, each with a robot that has nothing else to do at that time."""
    found: list[Help] = []
    wanted = rng.choice((1, 1, 2))
    for verb in rng.sample(("let_go", "turn", "lift", "lift"), 4):
        choices = []
        if len(found) == wanted:
            break
        for k, part in enumerate(parts):
            if any(help_.robot == k for help_ in found):
                continue
            if verb == "let_go":
                if part.acts and part.acts[0][1][0] > 40:
                    choices.append(Help(verb, k, part.acts[0][1][0]))
                continue
            for start in (rng.randint(1, 5), rng.randint(30, 36)):
                if not part.is_busy((start, 96)):
                    choices.append(Help(verb, k, start))
        if choices:
            found.append(rng.choice(choices))
    return found


# ---- where they are --------------------------------------------------------------------------------


@dataclass
class Robot:
    """A robot before it is built: what it looks like, does and suffers, and where it begins."""

    name: str
    look: Look
    part: Part
    help: Help | None = None
    arm: Reach | None = None
    at: Flat = (0.0, 0.0)
    heading_deg: float = 0.0

    @property
    def radius_m(self) -> float:
        """In plan."""
        return 0.066 * (1.2 if self.look.words.get("size") == "large" else 1.0)


def _draw_cast(stage: Stage, rng: random.Random, table: Area) -> list[Robot]:
    """Finds room for all: first those that hands take, then those that walk, then the rest."""
    options = {"colour": rng.sample(PAINTS, 3)}
    key = rng.choice(("size", "size", "chest"))
    options[key] = looks.words_of("toy_robot", key)
    group = looks.crossed(rng, "toy_robot", rng.choice((3, 4, 4, 5)), options)
    parts = _parts(rng, len(group))
    cast = [Robot(f"robot_{k + 1}", look, part) for k, (look, part) in enumerate(zip(group, parts))]
    for help_, arm in zip(_helps(rng, parts), reaches(stage, rng, table)):
        cast[help_.robot].help, cast[help_.robot].arm = help_, arm
    facing = stage.seats[0].heading_deg - 180.0
    for robot in sorted(cast, key=lambda r: (r.help is None, -r.part.walked_m)):
        robot.at, robot.heading_deg, end = _start(rng, table, robot, facing)
        table.take(robot.at, robot.radius_m, end, owner=robot.name)
        if robot.arm is not None:
            robot.arm.take(table, end if _is_early(robot.part) else robot.at)
    return cast


def _is_early(part: Part) -> bool:
    """Whether it has acted before a hand comes."""
    return bool(part.acts) and part.acts[0][1][0] < 40


def _start(rng: random.Random, table: Area, robot: Robot, facing: float) -> tuple[Flat, float, Flat]:
    """A spot, a heading and where the way ends; a hand reaches the end, or the spot if it lets go there."""
    radius, way, arm = robot.radius_m, robot.part.walked_m, robot.arm
    for _ in range(200):
        heading = facing + rng.triangular(-110, 110, 0)
        at = table.spot(rng, radius)
        end = (at[0] + way * sin(radians(heading)), at[1] - way * cos(radians(heading)))
        if way and not table.is_free(at, radius, end):
            continue
        if arm is not None:
            early = _is_early(robot.part)
            taken = end if early else at
            if not (arm.reaches(table, taken) and arm.is_clear(table, taken)):
                continue
            dx, dy = taken[0] - arm.shoulder[0], taken[1] - arm.shoulder[1]
            along = (end[0] - at[0]) * dx + (end[1] - at[1]) * dy
            if way and not early and along < 0.2 * way * hypot(dx, dy):
                continue
        return at, heading, end
    raise NoRoom("no room for a robot and its way")


def _build(stage: Stage, table: Area, robot: Robot) -> WindUpRobot:
    """Puts a robot where it begins; its room was taken before."""
    thing = stage.scene.put(
        "toy_robot",
        robot.name,
        robot.at,
        robot.heading_deg,
        rng=stage.rng(f"member/{robot.name}"),
        on=table.on,
        **robot.look.words,
    )
    prop = stage.register(
        "toy_robot",
        robot.name,
        thing,
        at=robot.at,
        heading_deg=robot.heading_deg,
        area=None,
        look=robot.look,
        radius_m=robot.radius_m,
    )
    return WindUpRobot(prop.instance, thing, thing.body.matrix_basis.copy())


# ---- what happens ----------------------------------------------------------------------------------


def _steps(frames: Frames) -> int:
    return (frames[1] - frames[0]) // STEP_FRAMES - 1


def _act(mover: WindUpRobot, part: Part) -> None:
    for verb, frames, amount in part.acts:
        if verb == "walk":
            mover.walk(frames, step_m=amount)
        else:
            mover.turn(frames, amount)
    mover.finish()


def _help(stage: Stage, rng: random.Random, arm: Reach, help_: Help, thing: Instance) -> None:
    """Holds a robot until it goes, turns one on the spot, or lifts one and puts it down."""
    hand, t = arm.hand(stage, Roller), help_.start
    if help_.verb == "let_go":
        first = t - 34 if rng.random() < 0.6 else 0
        reach = (2, min(first + 18, 24)) if first else (-24, 0)
        hand.approach(thing, reach, grip="top")
        hand.release((t - 9, t - 1))
        hand.withdraw((t, t + 24))
        return
    hand.approach(thing, (t, t + 16), grip="top")
    at = thing.matrix(t + 16).translation
    if help_.verb == "turn":
        angle = rng.choice((-1, 1)) * rng.uniform(32.0, 50.0)
        hand.twist(Round(thing, 0.0, Vector()), angle, (t + 16, t + 36))
        end = t + 36
    else:
        top = t + 16 + rng.randint(14, 18)
        end = top + rng.randint(14, 18)
        hand.lift((t + 16, top), height_m=rng.uniform(0.05, 0.09))
        hand.put_down((at.x, at.y, at.z), (top, end))
    hand.release((end, end + 8))
    if end + 8 + 14 <= 96:
        hand.withdraw((end + 8, min(end + 30, 96)))
