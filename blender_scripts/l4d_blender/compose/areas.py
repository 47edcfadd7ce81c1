"""Free room on tables, floors and lawns: where something fits, and which ways are clear.

What takes room is a disc, or a disc that was drawn along a line (the way of something that moves); it takes
it for the whole clip. Knows nothing of what the things are.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import atan2, cos, degrees, hypot, pi, radians, sin
from typing import TypeVar

from ..scene.placing import Point, Support
from .errors import NoRoom

Flat = tuple[float, float]
Plan = TypeVar("Plan")


@dataclass(frozen=True)
class Taken:
    """A disc drawn from `start` to `end` (the same point for what keeps its place)."""

    start: Flat
    end: Flat
    radius_m: float
    owner: str


@dataclass
class Area:
    """A convex piece of something that things stand on; `corners` counter-clockwise, world metres."""

    name: str
    corners: Sequence[Flat]
    on: Support = 0.0
    taken: list[Taken] = field(default_factory=list)

    @classmethod
    def rectangle(
        cls,
        name: str,
        centre: Point,
        size_m: tuple[float, float],
        heading_deg: float = 0.0,
        on: Support = 0.0,
    ) -> Area:
        """A rectangle round a point."""
        c, s = cos(radians(heading_deg)), sin(radians(heading_deg))
        half_x, half_y = size_m[0] / 2, size_m[1] / 2
        corners = [
            (centre[0] + c * x - s * y, centre[1] + s * x + c * y)
            for x, y in ((-half_x, -half_y), (half_x, -half_y), (half_x, half_y), (-half_x, half_y))
        ]
        return cls(name, corners, on)

    @property
    def centre(self) -> Flat:
        """The mean of the corners."""
        return (
            sum(x for x, _ in self.corners) / len(self.corners),
            sum(y for _, y in self.corners) / len(self.corners),
        )

    def point(self, x: float, y: float) -> tuple[float, float, float]:
        """A point on the surface."""
        height = self.on.height(x, y) if hasattr(self.on, "height") else self.on
        return x, y, float(height)

    def margin(self, at: Flat) -> float:
        """Metres from a point to the nearest edge; negative outside."""
        distances = []
        for (ax, ay), (bx, by) in zip(self.corners, [*self.corners[1:], self.corners[0]]):
            length = hypot(bx - ax, by - ay)
            distances.append(((bx - ax) * (at[1] - ay) - (by - ay) * (at[0] - ax)) / length)
        return min(distances)

    def is_free(
        self, start: Flat, radius_m: float, end: Flat | None = None, *, ignoring: Sequence[str] = ()
    ) -> bool:
        """Whether a disc fits there, or along a line, clear of the edge and of everything not ignored."""
        end = start if end is None else end
        if min(self.margin(start), self.margin(end)) < radius_m:
            return False
        return self.is_clear(start, end, radius_m, ignoring=ignoring)

    def is_clear(self, start: Flat, end: Flat, radius_m: float, *, ignoring: Sequence[str] = ()) -> bool:
        """Whether nothing takes room on a way, which may begin or end beyond the edge (an arm's does)."""
        return all(
            other.owner in ignoring
            or _distance(start, end, other.start, other.end) >= radius_m + other.radius_m
            for other in self.taken
        )

    def take(self, start: Flat, radius_m: float, end: Flat | None = None, *, owner: str) -> None:
        """Notes that a disc is there, or moves along a line."""
        end = end or start
        self.taken.append(Taken((start[0], start[1]), (end[0], end[1]), radius_m, owner))

    def free(self, owner: str) -> None:
        """Forgets what somebody took."""
        self.taken = [taken for taken in self.taken if taken.owner != owner]

    def spot(
        self,
        rng: random.Random,
        radius_m: float,
        *,
        near: Flat | None = None,
        within_m: tuple[float, float] = (0.0, float("inf")),
        tries: int = 400,
    ) -> Flat:
        """A random free point for a disc; `within_m` bounds its distance from `near`. It is not taken yet."""
        xs, ys = [x for x, _ in self.corners], [y for _, y in self.corners]
        for _ in range(tries):
            if near is not None and within_m[1] < float("inf"):
                angle, distance = rng.uniform(-pi, pi), rng.uniform(*within_m)
                at = near[0] + distance * cos(angle), near[1] + distance * sin(angle)
            else:
                at = rng.uniform(min(xs), max(xs)), rng.uniform(min(ys), max(ys))
                if near is not None and hypot(at[0] - near[0], at[1] - near[1]) < within_m[0]:
                    continue
            if self.is_free(at, radius_m):
                return at
        raise NoRoom(f"no room of {100 * radius_m:.0f} cm radius on {self.name}")


def retried(area: Area, tries: int, draw: Callable[[], Plan]) -> Plan:
    """The first of some draws that finds room; what one took that failed is free again."""
    before = list(area.taken)
    for _ in range(tries - 1):
        try:
            return draw()
        except NoRoom:
            area.taken = list(before)
    return draw()


def heading_to(start: Point, end: Point) -> float:
    """The heading in degrees of something at `start` that faces `end` (0 faces -Y)."""
    return degrees(atan2(end[0] - start[0], -(end[1] - start[1])))


def _distance(a: Flat, b: Flat, c: Flat, d: Flat) -> float:
    """Between two segments in the plane."""
    if _cross(a, b, c, d):
        return 0.0
    return min(_to_segment(a, c, d), _to_segment(b, c, d), _to_segment(c, a, b), _to_segment(d, a, b))


def _to_segment(p: Flat, a: Flat, b: Flat) -> float:
    dx, dy = b[0] - a[0], b[1] - a[1]
    length = dx * dx + dy * dy
    t = 0.0 if length == 0.0 else max(0.0, min(1.0, ((p[0] - a[0]) * dx + (p[1] - a[1]) * dy) / length))
    return hypot(p[0] - a[0] - t * dx, p[1] - a[1] - t * dy)


def _cross(a: Flat, b: Flat, c: Flat, d: Flat) -> bool:
    def side(p: Flat, q: Flat, r: Flat) -> float:
        return (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])

    return side(a, b, c) * side(a, b, d) < 0 and side(c, d, a) * side(c, d, b) < 0
