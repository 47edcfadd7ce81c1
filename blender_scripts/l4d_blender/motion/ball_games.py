"""Balls that children, cats and dogs play with: they roll without slipping, pushed or down a slope, to rest.

Owns a ball's way over all frames and how it turns; refuses to know who pushes it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from mathutils import Matrix, Quaternion, Vector

from ..scene import keys
from ..scene.scene import Instance
from ..scene.timeline import FRAME_COUNT

Frames = tuple[int, int]
Pace = Callable[[float], float]
_UP = Vector((0.0, 0.0, 1.0))


def slowing(power: float = 2.2) -> Pace:
    """Fast from the first frame on, then friction: way 0..1 over time 0..1."""
    return lambda t: 1.0 - (1.0 - t) ** power


def downhill(slope_share: float, slope_time: float) -> Pace:
    """Evenly faster over the first `slope_share` of the way and `slope_time` of the time, then to rest."""
    ahead, left = 1.0 - slope_share, 1.0 - slope_time
    power = 2.0 * slope_share / slope_time * left / ahead

    def pace(t: float) -> float:
        if t < slope_time:
            return slope_share * (t / slope_time) ** 2
        return slope_share + ahead * (1.0 - (1.0 - (t - slope_time) / left) ** power)

    return pace


class RollingBall:
    """A ball; ways are given in rising time as world centres of the ball."""

    def __init__(
        self, instance: Instance, radius_m: float, centre: Sequence[float], rest: Quaternion | None = None
    ) -> None:
        self.instance, self.radius_m = instance, radius_m
        self.centres = [Vector(centre) for _ in range(FRAME_COUNT)]
        self._turn = rest or Quaternion()
        self._rolls: list[Frames] = []

    def roll_along(self, points: Sequence[Sequence[float]], frames: Frames, pace: Pace) -> None:
        """Rolls from where it is through points and lies at the last one from the last frame on."""
        first, last = frames
        way = keys.Path([self.centres[first], *points])
        for frame in range(first, FRAME_COUNT):
            share = pace(min((frame - first) / (last - first), 1.0))
            self.centres[frame] = way.point(share * way.length)
        self._rolls.append(frames)

    def finish(self) -> None:
        """Keys place and turning, and records when it rolls."""
        turn, matrices = self._turn, []
        for frame, centre in enumerate(self.centres):
            step = centre - self.centres[max(frame - 1, 0)]
            axis = _UP.cross(step)
            if axis.length > 1e-9:
                turn = Quaternion(axis, step.length / self.radius_m) @ turn
            matrices.append(
                Matrix.Translation(centre)
                @ turn.to_matrix().to_4x4()
                @ Matrix.Translation((0.0, 0.0, -self.radius_m))
            )
        for obj in self.instance.objects:
            keys.key_matrices(obj, matrices)
        for frames in self._rolls:
            self.instance.scene.event(self.instance, "roll", frames)


class Ball:
    """A ball on a floor that rolls without slipping along straight pushes."""

    def __init__(
        self,
        instance: Instance,
        radius_m: float,
        at: Sequence[float],
        floor_m: float = 0.0,
        turn: float = 0.0,
    ) -> None:
        """`at` is (x, y); `turn` (radians, about a slanted axis) is how it happens to lie at first."""
        self.instance, self.radius_m, self._floor_m = instance, radius_m, floor_m
        self._turn = Quaternion((0.5, 0.3, 0.8), turn)
        self.moving: list[Frames] = []
        self.place(at)

    def place(self, at: Sequence[float]) -> None:
        """Lies at (x, y) until it is pushed."""
        centre = Vector((at[0], at[1], self._floor_m + self.radius_m))
        self.centres = [centre.copy() for _ in range(FRAME_COUNT)]

    def roll_to(self, to: Sequence[float], frames: Frames) -> None:
        """A push at the first frame, then friction: fast at first, at rest at the last frame."""
        first, last = frames
        start = self.centres[first].copy()
        end = Vector((to[0], to[1], start.z))
        for frame in range(first, FRAME_COUNT):
            u = min((frame - first) / (last - first), 1.0)
            self.centres[frame] = start.lerp(end, u * u * (6 - 8 * u + 3 * u * u))
        self.moving.append(frames)

    def finish(self) -> None:
        """Keys position and rolling, and records one `roll` per uninterrupted stretch of motion."""
        turn = self._turn
        matrices = []
        for frame, centre in enumerate(self.centres):
            step = centre - self.centres[max(frame - 1, 0)]
            if step.length > 1e-9:
                axis = Vector((0, 0, 1)).cross(step)
                turn = Quaternion(axis, step.length / self.radius_m) @ turn
            spun = turn.to_matrix().to_4x4()
            matrices.append(Matrix.Translation(centre) @ spun @ Matrix.Translation((0, 0, -self.radius_m)))
        keys.key_matrices(self.instance.objects[0], matrices)
        for first, last in _merged(self.moving):
            self.instance.scene.event(self.instance, "roll", (first, last))


def _merged(intervals: Iterable[Frames]) -> list[Frames]:
    merged: list[Frames] = []
    for first, last in sorted(intervals):
        if merged and first <= merged[-1][1] + 1:
            merged[-1] = (merged[-1][0], max(last, merged[-1][1]))
        else:
            merged.append((first, last))
    return merged
