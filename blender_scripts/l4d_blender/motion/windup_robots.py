"""Wind-up robots: they shuffle forward or turn on the spot, foot by foot, while a key in the back runs down.

Actions are planned in rising frame order and record what they show; `finish` turns the plan into keys. Knows
gaits; shapes are in assets/toy_robot.py.
"""

from __future__ import annotations

from collections.abc import Callable
from math import pi, radians, sin

from mathutils import Matrix, Vector

from ..assets.toy_robot import KEY_AT, Robot
from ..scene import keys
from ..scene.scene import Instance, RecipeError
from ..scene.timeline import FPS, FRAME_COUNT
from .hands import Frames

STEP_FRAMES = 8
_LIFT_M = 0.004
_ROLL_RAD = 0.075
_KEY_HZ = 1.1


class WindUpRobot:
    """Moves the parts of one robot; `start` is where it stands at frame 0."""

    def __init__(self, instance: Instance, robot: Robot, start: Matrix) -> None:
        self.instance, self.robot = instance, robot
        self._body = [start.copy() for _ in range(FRAME_COUNT)]
        self._feet = [[start.copy() for _ in range(FRAME_COUNT)] for _ in range(2)]
        self._rolls = [0.0] * FRAME_COUNT
        self._winding = [0.0] * FRAME_COUNT
        self._busy_until = 0
        self._pose()

    def walk(self, frames: Frames, *, step_m: float = 0.021, turn_deg: float = 0.0) -> None:
        """Shuffles forward, `step_m` per step of `STEP_FRAMES` frames, bending its way by an angle in all."""
        steps = self._steps(frames)

        def leg(progress: float) -> Matrix:
            heading = radians(turn_deg) * progress / steps
            back = Matrix.Rotation(0.5 * heading, 3, "Z") @ Vector((0.0, -step_m * progress, 0.0))
            return Matrix.Translation(back) @ Matrix.Rotation(heading, 4, "Z")

        self._shuffle(frames, steps, leg)
        self.instance.scene.event(self.instance, "walk", frames)

    def turn(self, frames: Frames, angle_deg: float) -> None:
        """Turns on the spot by an angle, counter-clockwise from above."""
        steps = self._steps(frames)
        self._shuffle(
            frames, steps, lambda progress: Matrix.Rotation(radians(angle_deg) * progress / steps, 4, "Z")
        )
        self.instance.scene.event(self.instance, "turn", frames)

    def where(self, frame: int) -> Matrix:
        """The spot between its feet at a frame, upright."""
        return self._body[frame].copy()

    def finish(self) -> None:
        """Keys all parts; call it once, after the last action."""
        self._pose()

    def _steps(self, frames: Frames) -> int:
        first, last = frames
        steps = (last - first) // STEP_FRAMES - 1
        if steps < 1 or first < self._busy_until:
            raise RecipeError(
                f"{self.instance.name} can't step during {first}..{last}",
                f"at least {2 * STEP_FRAMES} frames, after frame {self._busy_until}",
            )
        self._busy_until = last
        return steps

    def _shuffle(self, frames: Frames, steps: int, leg: Callable[[float], Matrix]) -> None:
        """Feet take turns: each swings from half a step behind to half a step ahead of the other."""
        first, last = frames
        start = self._body[first]
        span = (last - first) / (steps + 1)
        plants = [[0.0], [0.0]]
        for k in range(steps + 1):
            swing, stance = k % 2, 1 - k % 2
            plants[swing].append(float(steps) if k >= steps - 1 else k + 1.0)
            plants[stance].append(plants[stance][-1])
        for f in range(first, FRAME_COUNT):
            step = min(int((f - first) / span), steps)
            u = min((f - first - step * span) / span, 1.0)
            moved = keys.ease(u)
            gone = []
            for foot in range(2):
                before, after = plants[foot][step], plants[foot][step + 1]
                progress = before + (after - before) * moved
                gone.append(progress)
                rise = _LIFT_M * sin(pi * moved) if after != before else 0.0
                self._feet[foot][f] = Matrix.Translation((0.0, 0.0, rise)) @ start @ leg(progress)
            side = -1.0 if step % 2 == 0 else 1.0
            self._rolls[f] = side * _ROLL_RAD * sin(pi * u) if f <= last else 0.0
            self._body[f] = start @ leg(0.5 * (gone[0] + gone[1]))
            ramp = min(1.0, (f - first) / 5.0, max(last - f, 0) / 5.0)
            self._winding[f] = ramp * 2 * pi * _KEY_HZ / FPS

    def _pose(self) -> None:
        body = [m @ Matrix.Rotation(roll, 4, "Y") for m, roll in zip(self._body, self._rolls)]
        keys.key_matrices(self.robot.body, body)
        keys.key_matrices(self.robot.left, self._feet[0])
        keys.key_matrices(self.robot.right, self._feet[1])
        angle, turned = 0.0, []
        for f in range(FRAME_COUNT):
            angle += self._winding[f]
            at = Matrix.Translation(KEY_AT * self.robot.scale)
            turned.append(body[f] @ at @ Matrix.Rotation(angle, 4, "Y"))
        keys.key_matrices(self.robot.key, turned)
