"""Cars on a road: they come, brake, wait for each other, pull out from the kerb, pass one that is parked."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import combinations, pairwise
from math import cos, degrees, radians, sin, tan
from typing import TYPE_CHECKING

from ...assets.car import WHEELBASE_M, CarLook
from ...motion.driving import Driver
from ...scene.keys import ease
from ...scene.timeline import FPS, FRAME_COUNT, LAST_FRAME
from .. import looks
from ..areas import Area, Flat
from ..errors import NoRoom, Rejected
from ..looks import Look
from ..planning import fitting
from ..sight import Bulk, hidden
from . import theme

if TYPE_CHECKING:
    from ..stage import Stage

HALF_LENGTH_M, HALF_WIDTH_M = 1.82, 0.86
MIRRORS_M = 1.0  # from the middle
GAP_M = 0.22  # at least, between two cars
Knots = list[tuple[float, float]]
STRAIGHT: Knots = [(0, 0.0)]
STAYS: Knots = [(0, 0.0)]


@dataclass
class Trip:
    """What one car does: where it begins, its speeds and steering, and events besides those of driving."""

    at: Flat
    heading_deg: float
    speeds: Knots = field(default_factory=lambda: list(STAYS))
    steering: Knots = field(default_factory=lambda: list(STRAIGHT))
    verb: str | None = None
    waits: tuple[int, tuple[int, int]] | None = None  # for which trip, when
    passes: tuple[int, tuple[int, int]] | None = None

    @property
    def moves(self) -> bool:
        """Whether it ever does."""
        return any(speed > 0.0 for _, speed in self.speeds)

    def turned(self) -> Trip:
        """The same on the other side of the road, the other way."""
        at = -self.at[0], -self.at[1]
        heading = self.heading_deg - 180.0
        return Trip(at, heading, self.speeds, self.steering, self.verb, self.waits, self.passes)

    def course(self) -> list[tuple[float, float, float]]:
        """x, y, heading (radians) per frame, as motion code will drive it, give or take a centimetre."""
        return _course(self.at, self.heading_deg, self.speeds, self.steering)


@theme(
    "outdoor", needs=("road",), categories=("car",), verbs=("drive", "brake", "pull_out", "wait_for", "pass")
)
def cars_on_road(stage: Stage) -> None:
    """Three or four cars."""
    rng, road = stage.rng("cars"), stage.area("road")
    count = rng.choice((3, 4, 4))
    story = rng.choice((_one_pulls_out, _two_pull_out, _one_passes))
    mirrored = rng.random() < 0.5
    shift = rng.uniform(-0.8, 0.8)

    def plan() -> list[Trip]:
        trips = story(rng, _kerb(road), count)
        trips = [trip.turned() if mirrored else trip for trip in trips]
        middle = road.centre
        for trip in trips:
            trip.at = trip.at[0] + middle[0] + shift, trip.at[1] + middle[1]
        courses = [trip.course() for trip in trips]
        _refuse(road, courses)
        rig = stage.closer(
            [(x, y) for course in courses for x, y, _ in course[::12]],
            height_m=0.6,
            margin_m=1.9,
            least_rise=0.30,
        )
        if hidden(rig, [[_bulk(course[f]) for course in courses] for f in range(0, FRAME_COUNT, 24)]):
            raise NoRoom("a view of all")
        stage.film(rig)
        return trips

    trips = fitting(road, "cars", 120, plan)
    _act(stage, trips, _cast(rng, len(trips)))
    told = {_one_pulls_out: "one pulls out", _two_pull_out: "two pull out", _one_passes: "one passes another"}
    stage.tell(f"{len(trips)} cars; {told[story]} and others come, wait or stand.")


def _cast(rng: random.Random, count: int) -> list[Look]:
    options = {
        "colour": ("red", "blue", "white", "silver", "green", "yellow", "black", "orange"),
        "roof": ("plain", "rack", "white", "black"),
    }
    for _ in range(20):
        cast = looks.crossed(rng, "car", count, options)
        if all(look.words["colour"] != look.words["roof"] for look in cast):
            return cast
    raise Rejected("no roof that differs from its car")


# ---- stories, on the near side and towards +X -----------------------------------------------------------


def _one_pulls_out(rng: random.Random, kerb_m: float, count: int) -> list[Trip]:
    """A parked car pulls out; one that comes from behind brakes and waits for it."""
    x, start = rng.uniform(-1.4, 0.6), rng.randint(14, 40)
    leaver = _pull_out(rng, (x, -kerb_m), start)
    stop = x - 2 * HALF_LENGTH_M - rng.uniform(1.0, 1.6)
    comer = _arrive(rng, stop, -rng.uniform(1.45, 1.6), 90.0, rng.randint(30, 46))
    comer.waits = (0, (_stops(comer) - 6, LAST_FRAME))
    return [leaver, comer, *_far_lane(rng, kerb_m, count - 2)]


def _two_pull_out(rng: random.Random, kerb_m: float, count: int) -> list[Trip]:
    """Two parked cars pull out, one after the other."""
    x = rng.uniform(0.6, 1.6)
    first, second = rng.randint(2, 14), rng.randint(36, 54)
    ahead = _pull_out(rng, (x, -kerb_m), first)
    behind = _pull_out(rng, (x - 2 * HALF_LENGTH_M - rng.uniform(1.0, 1.7), -kerb_m), second)
    behind.waits = (0, (max(first, second - 26), second - 2)) if rng.random() < 0.5 else None
    return [ahead, behind, *_far_lane(rng, kerb_m, count - 2)]


def _one_passes(rng: random.Random, kerb_m: float, count: int) -> list[Trip]:
    """A car passes one that is parked; another comes the other way, brakes and waits for it."""
    x, y = rng.uniform(-2.6, -1.8), -kerb_m + 2 * MIRRORS_M + rng.uniform(0.15, 0.3)
    parked = Trip((x, -kerb_m), 90.0)
    speed = rng.uniform(1.9, 2.4)
    first = rng.randint(0, 16)
    passer = Trip(
        (x - rng.uniform(4.2, 4.9), y), 90.0, [(0, 0.0), (first, 0.0), (first + 20, speed), (96, speed)]
    )
    if first < 8:
        passer.speeds = [(0, speed), (96, speed)]
    course = passer.course()
    beside = [f for f, (at, _, _) in enumerate(course) if abs(at - x) < 2 * HALF_LENGTH_M]
    if len(beside) < 20:
        raise NoRoom("time to pass")
    passer.passes = (0, (beside[0], beside[-1]))
    end = course[-1][0]
    stop = end + 2 * HALF_LENGTH_M + rng.uniform(0.8, 1.4)
    comer = _arrive(rng, stop, kerb_m - rng.uniform(0.1, 0.4), -90.0, rng.randint(28, 44))
    comer.waits = (1, (_stops(comer) - 6, rng.randint(84, LAST_FRAME)))
    trips = [parked, passer, comer]
    if count > 3:
        trips.append(Trip((x - 2 * HALF_LENGTH_M - rng.uniform(0.9, 1.5), -kerb_m), 90.0))
    return trips


def _far_lane(rng: random.Random, kerb_m: float, count: int) -> list[Trip]:
    """One or two that come the other way: one comes and stops, starts, or drives through."""
    y = rng.uniform(1.5, kerb_m)
    if count == 1:
        what = rng.choice(("come", "go", "through", "stay"))
        return [_other_way(rng, what, rng.uniform(0.0, 3.5) if what != "come" else rng.uniform(-3.0, 1.5), y)]
    front = rng.uniform(-3.6, -1.6)
    back = front + 2 * HALF_LENGTH_M + rng.uniform(1.0, 1.8)
    whats = rng.choice((("go", "stay"), ("stay", "come"), ("go", "come"), ("stay", "stay")))
    return [_other_way(rng, what, x, y) for what, x in zip(whats, (front, back))]


def _other_way(rng: random.Random, what: str, x: float, y: float) -> Trip:
    if what == "come":
        return _arrive(rng, x, y, -90.0, rng.randint(30, 70))
    if what == "go":
        start, speed = rng.randint(20, 56), rng.uniform(1.2, 1.9)
        return Trip((x, y), -90.0, [(0, 0.0), (start, 0.0), (start + 26, speed), (96, speed)])
    if what == "through":
        speed = rng.uniform(1.2, 1.8)
        return Trip((x, y), -90.0, [(0, speed), (96, speed)])
    return Trip((x, y), -90.0)


def _arrive(rng: random.Random, stop: float, y: float, heading_deg: float, brake: int) -> Trip:
    """Comes along and stops at x = `stop`; brakes for so many frames."""
    speed, last = rng.uniform(1.8, 2.4), brake + rng.randint(4, 18)
    first = last - brake
    speeds: Knots = [(0, speed), (first, speed), (last, 0.0)]
    way = speed * (first + 0.5 * brake) / FPS
    return Trip((stop - way if heading_deg > 0 else stop + way, y), heading_deg, speeds)


def _stops(trip: Trip) -> int:
    return int(trip.speeds[-1][0])


def _pull_out(rng: random.Random, at: Flat, start: int) -> Trip:
    """Stands at the kerb, then steers into the lane and straightens."""
    speed, turn = rng.uniform(1.7, 2.2), rng.uniform(0.34, 0.46)
    speeds: Knots = [(0, 0.0), (start, 0.0), (start + 26, speed), (LAST_FRAME, speed)]
    straight = start + rng.randint(24, 29)

    def steering(back: float) -> Knots:
        return [
            (0, 0.0),
            (max(start - 8, 0), 0.0),
            (start + 5, turn),
            (straight, turn),
            (straight + 14, -back),
            (straight + 20, -back),
            (straight + 30, 0.0),
        ]

    low, high = 0.0, 0.60
    for _ in range(12):
        middle = 0.5 * (low + high)
        end = _course(at, 90.0, speeds, steering(middle))[min(straight + 30, LAST_FRAME)][2]
        low, high = (middle, high) if degrees(end) > 90.0 else (low, middle)
    return Trip(at, 90.0, speeds, steering(low), "pull_out")


# ---- geometry -------------------------------------------------------------------------------------------


def _kerb(road: Area) -> float:
    """How far from the middle of the road a parked car is."""
    half = 0.5 * (max(y for _, y in road.corners) - min(y for _, y in road.corners))
    return half - HALF_WIDTH_M - 0.15


def _course(at: Flat, heading_deg: float, speeds: Knots, steering: Knots) -> list[tuple[float, float, float]]:
    heading, steps = radians(heading_deg), 2
    x, y = at[0] - 0.5 * WHEELBASE_M * sin(heading), at[1] + 0.5 * WHEELBASE_M * cos(heading)
    found = []
    for frame in range(FRAME_COUNT):
        ahead = 0.5 * WHEELBASE_M
        found.append((x + ahead * sin(heading), y - ahead * cos(heading), heading))
        for k in range(steps):
            t = frame + (k + 0.5) / steps
            way = _at(speeds, t) / (FPS * steps)
            turn = way * tan(_at(steering, t)) / WHEELBASE_M
            x += way * sin(heading + 0.5 * turn)
            y -= way * cos(heading + 0.5 * turn)
            heading += turn
    return found


def _at(knots: Knots, frame: float) -> float:
    if frame <= knots[0][0]:
        return knots[0][1]
    for (f0, v0), (f1, v1) in pairwise(knots):
        if frame < f1:
            return v0 + (v1 - v0) * ease((frame - f0) / (f1 - f0))
    return knots[-1][1]


def _corners(pose: tuple[float, float, float], margin_m: float, half_width_m: float) -> list[Flat]:
    x, y, heading = pose
    along, across = HALF_LENGTH_M + margin_m, half_width_m + margin_m
    ahead, left = (sin(heading), -cos(heading)), (cos(heading), sin(heading))
    return [
        (x + a * along * ahead[0] + b * across * left[0], y + a * along * ahead[1] + b * across * left[1])
        for a, b in ((1, 1), (1, -1), (-1, -1), (-1, 1))
    ]


def _refuse(road: Area, courses: Sequence[Sequence[tuple[float, float, float]]]) -> None:
    """Refuses cars that leave the road or come too near to each other."""
    for course in courses:
        for pose in course[::8]:
            if any(road.margin(corner) < 0.0 for corner in _corners(pose, 0.0, HALF_WIDTH_M)):
                raise NoRoom("room between the kerbs")
    for a, b in combinations(courses, 2):
        for frame in range(0, FRAME_COUNT, 4):
            if _meet(
                _corners(a[frame], GAP_M / 2, 0.5 * (MIRRORS_M + HALF_WIDTH_M)),
                _corners(b[frame], GAP_M / 2, 0.5 * (MIRRORS_M + HALF_WIDTH_M)),
            ):
                raise NoRoom("room between cars")


def _meet(a: list[Flat], b: list[Flat]) -> bool:
    """Whether two convex outlines overlap: no side of either separates them."""
    for outline in (a, b):
        for (px, py), (qx, qy) in zip(outline, [*outline[1:], outline[0]]):
            normal = qy - py, px - qx
            mine = [x * normal[0] + y * normal[1] for x, y in a]
            other = [x * normal[0] + y * normal[1] for x, y in b]
            if max(mine) < min(other) or max(other) < min(mine):
                return False
    return True


def _bulk(pose: tuple[float, float, float]) -> Bulk:
    return Bulk((pose[0], pose[1]), 0.8, 1.35)


# ---- acting --------------------------------------------------------------------------------------------


def _act(stage: Stage, trips: list[Trip], cast: list[Look]) -> None:
    scene, rng = stage.scene, stage.rng("number plates")
    order = list(range(len(trips)))
    stage.rng("who drives").shuffle(order)
    drivers: dict[int, Driver] = {}
    for k, index in enumerate(order):
        look, trip = cast[k], trips[index]
        plate = f"{rng.choice('ABDEGHKLMPRSTW')} {rng.randint(101, 989)}"
        paint = CarLook(look.words["colour"], look.words["roof"], plate)
        name = f"car_{k + 1}"
        car = scene.put("car", name, trip.at, trip.heading_deg, rng=stage.rng(name), look=paint)
        prop = stage.register(
            "car", name, car, at=trip.at, heading_deg=trip.heading_deg, area=None, look=look
        )
        drivers[index] = Driver(prop.instance, car, trip.at, trip.heading_deg)
    for index, trip in enumerate(trips):
        driver = drivers[index]
        if trip.moves:
            driver.drive(trip.speeds, trip.steering, verb=trip.verb)
        if trip.waits is not None:
            other, frames = trip.waits
            driver.wait_for(drivers[other].instance, frames)
        if trip.passes is not None:
            other, frames = trip.passes
            scene.event(driver.instance, "pass", frames, drivers[other].instance)
