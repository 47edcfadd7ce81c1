"""Where animals stand and which ways they go: smooth, no tighter than they turn, clear of everything.

A body is a strip from tail to nose. What it takes it keeps for the whole clip. Knows plans, no poses.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from math import atan2, cos, hypot, pi, radians, remainder, sin

from ..areas import Area, Flat, heading_to
from ..errors import NoRoom

_SAMPLES = 24


@dataclass(frozen=True)
class Body:
    """How far a body reaches from its middle, seen from above, and the tightest bend it can walk."""

    ahead_m: float
    behind_m: float
    half_width_m: float
    turn_m: float = 0.3

    def strip(self, at: Flat, heading_deg: float) -> tuple[Flat, Flat]:
        """From tail to nose, shorter by the half width at both ends."""
        inset = self.half_width_m
        return (
            ahead(at, heading_deg, -max(self.behind_m - inset, 0.0)),
            ahead(at, heading_deg, max(self.ahead_m - inset, 0.0)),
        )


@dataclass(frozen=True)
class Way:
    """A smooth way over an area; `points` lie a few centimetres apart."""

    points: tuple[Flat, ...]
    heading_deg: float
    end_heading_deg: float
    length_m: float

    @property
    def start(self) -> Flat:
        """Where it begins."""
        return self.points[0]

    @property
    def end(self) -> Flat:
        """Where it ends."""
        return self.points[-1]

    def beyond(self, lead_m: float) -> list[Flat]:
        """Its points from `lead_m` metres after the start on, for acts that begin the way themselves."""
        gone, kept = 0.0, []
        for a, b in zip(self.points, self.points[1:]):
            gone += hypot(b[0] - a[0], b[1] - a[1])
            if gone >= lead_m:
                kept.append(b)
        return kept[:-2:3] + kept[-2:]


def ahead(at: Flat, heading_deg: float, forward_m: float, left_m: float = 0.0) -> Flat:
    """A point given from a body's point of view."""
    h = radians(heading_deg)
    return (at[0] + forward_m * sin(h) + left_m * cos(h), at[1] - forward_m * cos(h) + left_m * sin(h))


def fits(area: Area, body: Body, at: Flat, heading_deg: float, ignoring: Sequence[str] = ()) -> bool:
    """Whether a body has room there."""
    tail, nose = body.strip(at, heading_deg)
    return area.is_free(tail, body.half_width_m, nose, ignoring=ignoring)


def take(area: Area, body: Body, at: Flat, heading_deg: float, owner: str) -> None:
    """Notes that a body is there."""
    tail, nose = body.strip(at, heading_deg)
    area.take(tail, body.half_width_m, nose, owner=owner)


def take_way(area: Area, body: Body, way: Way, owner: str) -> None:
    """Notes that a body goes along a way, its start and its end included."""
    for k in range(0, len(way.points) - 1, 2):
        end = way.points[min(k + 2, len(way.points) - 1)]
        area.take(way.points[k], body.half_width_m, end, owner=owner)
    take(area, body, way.start, way.heading_deg, owner)
    take(area, body, way.end, way.end_heading_deg, owner)


def spot(
    area: Area,
    body: Body,
    rng: random.Random,
    *,
    near: Flat,
    within_m: tuple[float, float],
    facing: Flat | None = None,
    astray_deg: float = 180.0,
    tries: int = 60,
) -> tuple[Flat, float]:
    """A free point near another, with a heading: any, or towards `facing` give or take `astray_deg`."""
    for _ in range(tries):
        angle, distance = rng.uniform(-pi, pi), rng.uniform(*within_m)
        at = near[0] + distance * cos(angle), near[1] + distance * sin(angle)
        towards = 0.0 if facing is None else heading_to(at, facing)
        heading = wrapped(towards + rng.uniform(-astray_deg, astray_deg))
        if fits(area, body, at, heading):
            return at, heading
    raise NoRoom(f"no room for a body near the middle of {area.name}")


def find_way(
    area: Area,
    body: Body,
    rng: random.Random,
    start: tuple[Flat, float],
    end: tuple[Flat, float],
    *,
    ignoring: Sequence[str] = (),
    clear_of: Sequence[tuple[Flat, float]] = (),
    tries: int = 10,
) -> Way | None:
    """A smooth way between two points with headings, or None; `clear_of` are discs that it must not enter."""
    (start_at, start_deg), (end_at, end_deg) = start, end
    apart = hypot(end_at[0] - start_at[0], end_at[1] - start_at[1])
    if not fits(area, body, *start, ignoring) or not fits(area, body, *end, ignoring):
        return None
    for _ in range(tries):
        out = ahead(start_at, start_deg, apart * rng.uniform(0.30, 0.60))
        home = ahead(end_at, end_deg, -apart * rng.uniform(0.30, 0.60))
        points = _bezier(start_at, out, home, end_at)
        if _turns(points) * body.turn_m > 1.0:
            continue
        if any(
            hypot(p[0] - at[0], p[1] - at[1]) < radius + body.half_width_m
            for at, radius in clear_of
            for p in points
        ):
            continue
        if all(
            area.is_free(a, body.half_width_m, b, ignoring=ignoring)
            for a, b in zip(points[::3], points[3::3])
        ):
            length = sum(hypot(b[0] - a[0], b[1] - a[1]) for a, b in zip(points, points[1:]))
            return Way(tuple(points), start_deg, end_deg, length)
    return None


def stroll(
    area: Area,
    body: Body,
    rng: random.Random,
    start: tuple[Flat, float],
    length_m: tuple[float, float],
    *,
    ignoring: Sequence[str] = (),
    clear_of: Sequence[tuple[Flat, float]] = (),
    tries: int = 40,
) -> Way | None:
    """A way to somewhere ahead, or None."""
    (at, heading_deg) = start
    for _ in range(tries):
        aside, distance = rng.uniform(-60.0, 60.0), rng.uniform(*length_m)
        goal = ahead(at, heading_deg + aside, distance)
        end_deg = wrapped(heading_deg + 1.6 * aside + rng.uniform(-25.0, 25.0))
        if not fits(area, body, goal, end_deg, ignoring):
            continue
        way = find_way(area, body, rng, start, (goal, end_deg), ignoring=ignoring, clear_of=clear_of, tries=3)
        if way is not None:
            return way
    return None


def wrapped(heading_deg: float) -> float:
    """The same heading between -180 and 180."""
    return remainder(heading_deg, 360.0)


def _bezier(a: Flat, b: Flat, c: Flat, d: Flat) -> list[Flat]:
    points = []
    for k in range(_SAMPLES + 1):
        t = k / _SAMPLES
        weights = (1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t**3
        points.append(
            (
                sum(w * p[0] for w, p in zip(weights, (a, b, c, d))),
                sum(w * p[1] for w, p in zip(weights, (a, b, c, d))),
            )
        )
    return points


def _turns(points: Sequence[Flat]) -> float:
    """The sharpest bend, in radians per metre."""
    sharpest = 0.0
    steps = [(b[0] - a[0], b[1] - a[1]) for a, b in zip(points, points[1:])]
    for (ax, ay), (bx, by) in zip(steps, steps[1:]):
        length = 0.5 * (hypot(ax, ay) + hypot(bx, by))
        if length < 1e-9:
            return float("inf")
        turn = remainder(atan2(by, bx) - atan2(ay, ax), 2 * pi)
        sharpest = max(sharpest, abs(turn) / length)
    return sharpest
