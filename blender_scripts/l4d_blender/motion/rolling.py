"""Round things that roll, rock and are sent rolling by hands.

Owns rolling without slipping: the way along the table and the turn about the axle belong together. A thing
rolls on a circle of known radius round an axle of its own (an apple's stem axis, which lies level while it
rolls). Knows no shapes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import atan2, exp, pi, radians, sin

import numpy as np
from mathutils import Matrix, Vector

from ..scene import keys
from ..scene.scene import Instance
from ..scene.timeline import FPS, FRAME_COUNT
from .grips import POSES, Placed, Pose, Solid
from .hands import Frames, Point
from .ik import ease
from .servers import Server

UP = Vector((0.0, 0.0, 1.0))
CROWN_M = 0.024  # how far the palm stays above what fingertips hold


@dataclass(frozen=True)
class Round:
    """What rolls: the instance, its rolling radius and the middle of that circle in its own axes (metres)."""

    instance: Instance
    radius_m: float
    middle: Vector

    def lying(self, at: Point, axle_deg: float, turn_deg: float = 0.0) -> Matrix:
        """Where it lies with its axle (local +Z) level along a heading, over a point of what it lies on."""
        axle = Matrix.Rotation(radians(axle_deg), 4, "Z") @ Matrix.Rotation(0.5 * pi, 4, "Y")
        centre = Vector(at) + UP * self.radius_m
        return (
            Matrix.Translation(centre)
            @ axle
            @ Matrix.Rotation(radians(turn_deg), 4, "Z")
            @ Matrix.Translation(-self.middle)
        )


class Momentum:
    """How far something has come that is accelerated until `free` and then runs out until `rest` (frames)."""

    def __init__(self, start: float, free: float, rest: float) -> None:
        times = np.linspace(start, rest, 400)
        up = np.array([ease((t - start) / (free - start)) for t in times])
        down = np.clip((rest - times) / (rest - free), 0.0, 1.0) ** 1.25
        speed = np.minimum(up, down)
        way = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]))])
        self._times, self._way = times, way / way[-1]

    def share(self, frame: float) -> float:
        """0 before the start, 1 at rest."""
        return float(np.interp(frame, self._times, self._way))


def rolled(thing: Round, start: Matrix, way: keys.Path, momentum: Momentum) -> list[Matrix]:
    """Where something is at all frames that rolls along a path of its middle's ground points."""
    first = way.tangent(0.0)
    axle = UP.cross(first)
    home = start.to_quaternion().to_matrix().to_4x4()
    matrices = []
    for frame in range(FRAME_COUNT):
        s = way.length * momentum.share(frame)
        tangent = way.tangent(s)
        heading = atan2(tangent.y, tangent.x) - atan2(first.y, first.x)
        turned = Matrix.Rotation(heading, 4, "Z") @ Matrix.Rotation(s / thing.radius_m, 4, axle) @ home
        centre = way.point(s) + UP * thing.radius_m
        matrices.append(Matrix.Translation(centre) @ turned @ Matrix.Translation(-thing.middle))
    return matrices


def key_roll(thing: Round, moved: list[Matrix], first: int) -> None:
    """Keys a thing from a frame on; before that it keeps its keys."""
    obj = thing.instance.objects[0]
    before = [keys.object_matrix(obj, frame) for frame in range(FRAME_COUNT)]
    keys.key_matrices(obj, [before[f] if f < first else moved[f] for f in range(FRAME_COUNT)])


def roll(thing: Round, way: Sequence[Point], frames: Frames, *, free: int) -> None:
    """Lets something roll by itself along points of the ground, from where it lies to rest at the last."""
    first, last = frames
    start = thing.instance.matrix(first)
    here = start @ thing.middle
    path = keys.Path([(here.x, here.y, here.z - thing.radius_m), *[tuple(p) for p in way]])
    key_roll(thing, rolled(thing, start, path, Momentum(first, free, last)), first)
    thing.instance.scene.event(thing.instance, "roll", frames)


def rock(thing: Round, axis: Vector, frames: Frames, *, swing_deg: float, hertz: float = 1.25) -> None:
    """Rocks to and fro on its underside about a level axis and settles."""
    first, last = frames
    start = thing.instance.matrix(first)
    centre = start @ thing.middle
    side = Vector((axis.x, axis.y, 0.0)).normalized()
    moved = []
    for frame in range(FRAME_COUNT):
        t = max(frame - first, 0) / FPS
        fade = (
            float(ease(min(t / 0.25, 1.0))) * exp(-1.1 * t) * (1.0 - float(ease((frame - last + 10) / 10.0)))
        )
        angle = radians(swing_deg) * fade * sin(2 * pi * hertz * t)
        shift = side.cross(UP) * thing.radius_m * angle
        turn = Matrix.Translation(centre) @ Matrix.Rotation(angle, 4, side) @ Matrix.Translation(-centre)
        moved.append(Matrix.Translation(shift) @ turn @ start)
    key_roll(thing, moved, first)
    thing.instance.scene.event(thing.instance, "rock", frames)


class Roller(Server):
    """A hand that sends things rolling and twists them on the spot."""

    def _fit(
        self, solid: Solid, grip: str, heading: float, point: Point | None
    ) -> tuple[np.ndarray, np.ndarray, Pose, Pose, np.ndarray]:
        """Grip "crown": from above with the fingertips only, so that most of a fruit stays in sight."""
        if grip != "crown":
            return super()._fit(solid, grip, heading, point)
        _, place, opened, _, away = super()._fit(solid, "top", heading, point)
        place[2, 3] += CROWN_M
        hand = Placed(place, self.side, self.scale, self.table_m)
        pose = hand.close(solid, opened, POSES["wrapped"])
        before = place.copy()
        before[:3, 3] += 0.05 * away
        return before, place, opened, pose, away

    def send_rolling(self, thing: Round, way: Sequence[Point], frames: Frames, *, let_go: int) -> None:
        """Pushes what it touches until `let_go`; the thing rolls on by itself and rests at the last frame."""
        held = self._require("push")
        first, last = frames
        start = self._where(held, first)
        here = start @ thing.middle
        path = keys.Path([(here.x, here.y, here.z - thing.radius_m), *[tuple(p) for p in way]])
        momentum = Momentum(first, let_go, last)
        key_roll(thing, rolled(thing, start, path, momentum), first)
        origin = path.point(0.0)
        follow = [np.array(path.point(path.length * momentum.share(f)) - origin) for f in range(FRAME_COUNT)]
        touch, speed = self._place[first].copy(), follow[let_go] - follow[let_go - 1]
        for f in range(first, FRAME_COUNT):
            place = touch.copy()
            after = min(max(f - let_go, 0), 8)
            place[:3, 3] += follow[min(f, let_go)] + speed * (after - after**2 / 16.0)
            self._place[f] = place
        self._busy[first:] = 1.0
        self._holding = None
        self.scene.event(self.instance, "push", (first, let_go), held)
        self.scene.event(held, "roll", frames)

    def twist(self, thing: Round, angle_deg: float, frames: Frames) -> None:
        """Turns what it holds about the vertical, on the spot."""
        held = self._require("turn")
        first, last = frames
        start = self._where(held, first)
        centre = start @ thing.middle
        moved = []
        for f in range(FRAME_COUNT):
            angle = radians(angle_deg) * float(ease((f - first) / (last - first)))
            turn = Matrix.Translation(centre) @ Matrix.Rotation(angle, 4, "Z") @ Matrix.Translation(-centre)
            moved.append(turn @ start)
        self._carry(held, moved, first)
        self.scene.event(self.instance, "turn", frames, held)
        self.scene.event(held, "turn", frames)
