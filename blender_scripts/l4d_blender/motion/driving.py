"""Cars that drive: speed and steering over time become poses, rolling wheels and a nodding body.

The rear axle goes where the car points and the front wheels steer (a bicycle model, integrated frame by
frame), so wheels roll without slipping; the body pitches and leans on its springs. Radians, metres, seconds.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import cos, radians, sin, tan

import numpy as np
from mathutils import Matrix, Vector

from ..assets.car import WHEEL_RADIUS_M, WHEELBASE_M, Car
from ..scene import keys
from ..scene.scene import Instance
from ..scene.timeline import FPS, FRAME_COUNT, MIN_EVENT_FRAMES
from .ik import ease

Knots = Sequence[tuple[float, float]]

PITCH_PER_ACCELERATION = 0.011  # radians per m/s2 in steady braking
LEAN_PER_ACCELERATION = 0.012
SPRING_HZ, DAMPING = 1.35, 0.38
_SUBSTEPS = 8
_AXLE_HEIGHT_M = 0.30
_STANDING_M_PER_S = 0.05


class Driver:
    """Drives one car from frame 0 on; heading 0 faces -Y and grows counter-clockwise."""

    def __init__(self, instance: Instance, car: Car, at: Sequence[float], heading_deg: float) -> None:
        self.instance, self.car = instance, car
        self._at, self._heading = np.array(at[:2], float), radians(heading_deg)

    def drive(self, speeds: Knots, steering: Knots = ((0, 0.0),), *, verb: str | None = None) -> None:
        """Follows speeds (m/s) and steering angles (left is positive) given at frames, eased in between.

        Records `drive` while the car moves, `brake` while it slows down to a stop, and `verb` (what the drive
        as a whole is) if it has a name of its own.
        """
        poses, nod, lean = self._integrate(speeds, steering)
        self._key(poses, nod, lean, [_at(steering, f) for f in range(FRAME_COUNT)])
        moving = [f for f in range(FRAME_COUNT) if _at(speeds, f) > _STANDING_M_PER_S]
        span = (moving[0], moving[-1])
        for what in ("drive", verb):
            if what:
                self.instance.scene.event(self.instance, what, span)
        for (first, fast), (last, slow) in pairwise(speeds):
            if slow == 0.0 < fast and last - first + 1 >= MIN_EVENT_FRAMES:
                self.instance.scene.event(self.instance, "brake", (int(first), min(int(last), span[1])))

    def wait_for(self, other: Instance, frames: tuple[int, int]) -> None:
        """Stands and lets somebody go first."""
        self.instance.scene.event(self.instance, "wait_for", frames, other)

    def _integrate(self, speeds: Knots, steering: Knots) -> tuple[list[Matrix], list[float], list[float]]:
        """Poses without springs, and the angles of pitch and lean, per frame."""
        heading, dt = self._heading, 1.0 / (FPS * _SUBSTEPS)
        rear = self._at - 0.5 * WHEELBASE_M * _ahead(heading)
        spring, damper = (2 * np.pi * SPRING_HZ) ** 2, 2 * DAMPING * 2 * np.pi * SPRING_HZ
        angles, rates = np.zeros(2), np.zeros(2)
        poses, nod, lean = [], [], []
        for f in range(FRAME_COUNT):
            centre = rear + 0.5 * WHEELBASE_M * _ahead(heading)
            poses.append(Matrix.Translation((*centre, 0.0)) @ Matrix.Rotation(heading, 4, "Z"))
            nod.append(float(angles[0]))
            lean.append(float(angles[1]))
            for k in range(_SUBSTEPS):
                t = f + k / _SUBSTEPS
                speed, steer = _at(speeds, t), _at(steering, t)
                acceleration = (_at(speeds, t + 0.5) - _at(speeds, t - 0.5)) * FPS
                turning = speed * tan(steer) / WHEELBASE_M
                wanted = np.array(
                    [-PITCH_PER_ACCELERATION * acceleration, LEAN_PER_ACCELERATION * speed * turning]
                )
                rates += dt * (spring * (wanted - angles) - damper * rates)
                angles += dt * rates
                rear = rear + dt * speed * _ahead(heading + 0.5 * dt * turning)
                heading += dt * turning
        return poses, nod, lean

    def _key(self, poses: list[Matrix], nod: list[float], lean: list[float], steering: list[float]) -> None:
        lift = Matrix.Translation((0.0, 0.0, _AXLE_HEIGHT_M))
        bodies = [
            pose @ lift @ Matrix.Rotation(n, 4, "X") @ Matrix.Rotation(tilt, 4, "Y") @ lift.inverted()
            for pose, n, tilt in zip(poses, nod, lean)
        ]
        keys.key_matrices(self.car.body, bodies)
        for wheel, hub in zip(self.car.wheels, self.car.hubs):
            steered = steering if hub.y < 0.0 else [0.0] * FRAME_COUNT
            rolled, before, matrices = 0.0, None, []
            for pose, angle in zip(poses, steered):
                frame = pose @ Matrix.Translation(hub) @ Matrix.Rotation(angle, 4, "Z")
                at = frame.translation.copy()
                ahead = frame.to_3x3() @ Vector((0.0, -1.0, 0.0))
                rolled += (at - before).dot(ahead) / WHEEL_RADIUS_M if before is not None else 0.0
                before = at
                matrices.append(frame @ Matrix.Rotation(rolled, 4, "X"))
            keys.key_matrices(wheel, matrices)


def _ahead(heading: float) -> np.ndarray:
    return np.array([sin(heading), -cos(heading)])


def _at(knots: Knots, frame: float) -> float:
    """The eased value between the two knots round a frame; held beyond the ends."""
    if frame <= knots[0][0]:
        return float(knots[0][1])
    for (f0, v0), (f1, v1) in pairwise(knots):
        if frame < f1:
            return float(v0 + (v1 - v0) * ease((frame - f0) / (f1 - f0)))
    return float(knots[-1][1])
