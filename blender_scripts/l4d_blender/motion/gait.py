"""Footsteps: where feet are at every canonical frame while a body walks or turns on level ground.

A planted foot pivots on its heel or on its ball and never slides. Knows feet and paths; refuses to know legs,
arms or events. World metres, radians, frames.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..assets.anatomy import SIDES, Anatomy, vec
from ..scene.timeline import FPS, FRAME_COUNT
from .ik import ease, smooth, turn_x, turn_z

MAX_STEPS_PER_S = 2.5
SIGN = dict(SIDES)


@dataclass
class Sole:
    """The rest foot: ankle, ball and heel relative to the point on the ground under the ankle."""

    ankle: np.ndarray
    ball: np.ndarray
    heel: np.ndarray

    @staticmethod
    def of(anatomy: Anatomy, side: str) -> Sole:
        """The sole of one foot of an anatomy."""
        j, k = anatomy.joints, anatomy.scale
        ground = j[f"foot_{side}"] * np.array([1.0, 1.0, 0.0])
        ball = (j[f"toe_{side}"] - ground) * np.array([1.0, 1.0, 0.0])
        return Sole(j[f"foot_{side}"] - ground, ball, vec(0, 0.055 * k, 0))

    def lifted(self, spot: np.ndarray, yaw: float, pitch: float) -> np.ndarray:
        """Ankle of a foot that stands at `spot` and rolls over its ball (pitch > 0) or its heel (< 0)."""
        pivot = self.ball if pitch > 0.0 else self.heel
        return spot + turn_z(yaw) @ (pivot + turn_x(pitch) @ (self.ankle - pivot))


@dataclass
class Step:
    """One foot goes from where it stands to `spot` between two (fractional) frames."""

    side: str
    start: float
    end: float
    spot: np.ndarray
    yaw: float
    vigour: float = 1.0


class FootTrack:
    """Ankles, yaw, pitch and toe bend of both feet at all frames, edited by steps in rising time."""

    def __init__(self, anatomy: Anatomy, spots: dict[str, np.ndarray], yaw: float) -> None:
        self.soles = {side: Sole.of(anatomy, side) for side, _ in SIDES}
        self.height = anatomy.scale
        self.ankle = {
            s: np.tile(spots[s] + turn_z(yaw) @ self.soles[s].ankle, (FRAME_COUNT, 1)) for s, _ in SIDES
        }
        self.spot = {s: np.tile(spots[s], (FRAME_COUNT, 1)) for s, _ in SIDES}
        self.yaw = {s: np.full(FRAME_COUNT, yaw) for s, _ in SIDES}
        self.pitch = {s: np.zeros(FRAME_COUNT) for s, _ in SIDES}
        self.toe = {s: np.zeros(FRAME_COUNT) for s, _ in SIDES}
        self.planted = {s: np.ones(FRAME_COUNT, bool) for s, _ in SIDES}
        self.last_end = {s: -1e3 for s, _ in SIDES}

    def apply(self, step: Step) -> None:
        """Writes one step: roll off, swing, land, stand."""
        side, sole, v = step.side, self.soles[step.side], step.vigour
        frames = np.arange(FRAME_COUNT)
        length = step.end - step.start
        rise, fall = 0.80 * v, -0.30 * v
        start_row = int(np.clip(np.floor(step.start), 0, FRAME_COUNT - 1))
        from_spot, from_yaw = self.spot[side][start_row].copy(), float(self.yaw[side][start_row])
        turn = (step.yaw - from_yaw + np.pi) % (2 * np.pi) - np.pi
        yaw_to = from_yaw + turn
        roll_start = max(step.start - 0.85 * length, self.last_end[side] + 0.3 * length)
        rolling = (frames >= roll_start) & (frames < step.start)
        for f in frames[rolling]:
            t = (f - roll_start) / max(step.start - roll_start, 1e-6)
            self._stand(f, side, from_spot, from_yaw, rise * ease(t) ** 1.0, toe=True)
        off = sole.lifted(from_spot, from_yaw, rise)
        on = sole.lifted(step.spot, yaw_to, fall)
        for f in frames[(frames >= step.start) & (frames <= step.end)]:
            t = (f - step.start) / length
            u = ease(0.10 + 0.90 * t) if t > 0 else 0.0
            u = (1 - (1 - t) ** 3) * 0.35 * t + u * (1 - 0.35 * t)
            ankle = off + (on - off) * u
            ankle[2] += 0.050 * self.height * (0.35 + 0.65 * v) * np.sin(np.pi * t) ** 1.3
            self.ankle[side][f] = ankle
            self.spot[side][f] = from_spot + (step.spot - from_spot) * u
            self.yaw[side][f] = from_yaw + turn * ease(t)
            self.pitch[side][f] = rise * (1 - ease(1.25 * t)) + fall * ease(1.6 * t - 0.6)
            self.toe[side][f] = 0.8 * rise * (1.0 - ease(3.0 * t))
            self.planted[side][f] = False
        settle = 0.30 * length
        for f in frames[frames > step.end]:
            t = min((f - step.end) / settle, 1.0)
            self._stand(f, side, step.spot, yaw_to, fall * (1.0 - ease(t)), toe=False)
        self.last_end[side] = step.end

    def _stand(self, f: int, side: str, spot: np.ndarray, yaw: float, pitch: float, toe: bool) -> None:
        self.ankle[side][f] = self.soles[side].lifted(spot, yaw, pitch)
        self.spot[side][f] = spot
        self.yaw[side][f], self.pitch[side][f] = yaw, pitch
        self.toe[side][f] = pitch if toe else 0.0
        self.planted[side][f] = True


def stance_spot(anatomy: Anatomy, side: str, xy: np.ndarray, heading: float) -> np.ndarray:
    """Ground point under the ankle of a foot of a body that stands at xy."""
    rest = anatomy.joints[f"foot_{side}"] * np.array([1.0, 1.0, 0.0])
    return np.array([xy[0], xy[1], 0.0]) + turn_z(heading) @ rest


def walk_steps(
    anatomy: Anatomy,
    path,
    start_heading: float,
    end_heading: float | None,
    frames: tuple[int, int],
    lead: str,
) -> tuple[list[Step], np.ndarray, np.ndarray]:
    """Steps along a keys.Path, plus path distance and heading of the body per frame of all the clip."""
    first, last = frames
    seconds = (last - first) / FPS
    count = max(1, round(path.length / (0.585 * anatomy.scale)))
    if (count + 1) / seconds > MAX_STEPS_PER_S:
        count = max(1, int(MAX_STEPS_PER_S * seconds) - 1)
    stride = path.length / count
    if stride > 0.92 * anatomy.scale:
        raise ValueError(
            f"walking {path.length:.2f} m in frames {first}..{last} needs steps of {stride:.2f} m: "
            "give it more frames or a shorter way"
        )
    headings = _headings(path, start_heading, end_heading, stride)
    slot = (last - first) / (count + 1)
    steps, sides = [], (lead, "r" if lead == "l" else "l")
    progress = {side: np.zeros(FRAME_COUNT) for side in sides}
    rows = np.arange(FRAME_COUNT)
    for n in range(1, count + 2):
        s, side = min(n, count) * stride, sides[(n - 1) % 2]
        begin, end = first + (n - 1) * slot + 0.06 * slot, first + n * slot - 0.06 * slot
        heading = float(np.interp(s, *headings))
        xy = np.array(path.point(s))[:2]
        vigour = min(stride / (0.585 * anatomy.scale), 1.1) * (0.55 if n in (1, count + 1) else 1.0)
        steps.append(Step(side, begin, end, stance_spot(anatomy, side, xy, heading), heading, vigour))
        before = progress[side][min(int(begin), FRAME_COUNT - 1)]
        u = ease((rows - begin) / (end - begin))
        progress[side] = np.where(rows > begin, before + (s - before) * u, progress[side])
    middle = smooth(0.5 * (progress["l"] + progress["r"]), 0.42 * slot)
    return steps, middle, np.interp(middle, *headings)


def _headings(path, start: float, end: float | None, stride: float) -> tuple[np.ndarray, np.ndarray]:
    """Distance samples and the heading that the body has there: the path's tangent, eased at both ends."""
    s = np.linspace(0.0, path.length, 80)
    tangent = np.array([path.tangent(float(x)) for x in s])
    heading = np.unwrap(np.arctan2(tangent[:, 0], -tangent[:, 1]))
    heading += 2 * np.pi * np.round((start - heading[0]) / (2 * np.pi))
    into = ease(s / min(1.6 * stride, 0.7 * path.length))
    heading = start + (heading - start) * into
    if end is not None:
        target = heading[-1] + (end - heading[-1] + np.pi) % (2 * np.pi) - np.pi
        out = ease(
            (s - path.length + min(1.6 * stride, 0.7 * path.length)) / min(1.6 * stride, 0.7 * path.length)
        )
        heading = heading + (target - heading) * out
    return s, heading


def turn_steps(
    anatomy: Anatomy, xy: np.ndarray, start: float, end: float, frames: tuple[int, int]
) -> list[Step]:
    """Small steps on the spot that turn a body from one heading to another."""
    first, last = frames
    way = end - start
    pairs = max(1, int(np.ceil(abs(way) / 0.9)))
    slot = (last - first) / (2 * pairs)
    inner = "l" if way > 0 else "r"
    steps = []
    for n in range(2 * pairs):
        side = inner if n % 2 == 0 else ("r" if inner == "l" else "l")
        heading = start + way * (n // 2 + 1) / pairs
        begin = first + n * slot
        steps.append(
            Step(
                side,
                begin + 0.05 * slot,
                begin + 0.95 * slot,
                stance_spot(anatomy, side, xy, heading),
                heading,
                0.35,
            )
        )
    return steps
