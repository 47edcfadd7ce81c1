"""Blocks that hands and other blocks push about: bumped along a table, shoved off a deck and down a chute.

Each function animates what it moves and records what it shows. Knows contact and friction; knows no scene.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Sequence
from math import asin, cos, hypot, sin, sqrt

import numpy as np
from mathutils import Matrix, Vector

from ..assets import toy_ramp
from ..scene import keys
from ..scene.scene import Instance
from ..scene.timeline import FRAME_COUNT, MIN_EVENT_FRAMES
from .hands import Frames, Hand, Point

# Half the way over which a block tips over an edge, and how soon a pushing hand stops (metres, frames).
_TIP_M = 0.012
_FOLLOW_FRAMES = 3.0
_STEP_M = 0.001


class PushingHand(Hand):
    """A hand that doesn't hold what it only pushes with its fingertips."""

    _grip = ""

    def approach(
        self,
        thing: Instance,
        frames: Frames,
        *,
        grip: str = "push",
        heading_deg: float | None = None,
        point: Point | None = None,
    ) -> None:
        """As `Hand.approach`; remembers whether the fingers close round the thing at all."""
        self._grip = grip
        super().approach(thing, frames, grip=grip, heading_deg=heading_deg, point=point)

    def _note_hold(self, thing: Instance, until: int) -> None:
        if self._grip != "push":
            super()._note_hold(thing, until)

    def push(self, way_m: Sequence[float], frames: Frames, bumped: Instance | None = None) -> None:
        """Pushes a block along a vector (x, y in metres); it shoves `bumped` along from where they meet."""
        block = self._require("push")
        start = block.matrix(frames[0]).translation
        self.slide([(start.x + way_m[0], start.y + way_m[1], start.z)], frames, verb="push")
        if bumped is not None:
            bump(block, bumped, Vector((way_m[0], way_m[1], 0.0)), frames)

    def push_down(self, slide: RampSlide, push: Frames, rest_at: int) -> None:
        """Pushes a block over the edge of a ramp's deck; it slides down by itself and rests at a frame."""
        block = self._require("push")
        first, last = push
        gone = slide.progress(first, last, rest_at)
        reach = gone[last]
        speed = gone[last] - gone[last - 1]
        along = []
        for f in range(FRAME_COUNT):
            follow = reach + speed * _FOLLOW_FRAMES * (1.0 - np.exp(-max(f - last, 0) / _FOLLOW_FRAMES))
            along.append(min(gone[f], follow))
        start = block.matrix(first)
        level = slide.block_matrix(0.0)
        self._carry(
            block,
            [
                Matrix.Translation(slide.block_matrix(s, flat=True).translation - level.translation) @ start
                for s in along
            ],
            first,
        )
        turn = level.inverted() @ start
        keys.key_matrices(
            block.objects[0],
            [
                block.matrix(f) if f < first else slide.block_matrix(gone[f]) @ turn
                for f in range(FRAME_COUNT)
            ],
        )
        self.scene.event(self.instance, "push", push, block)
        self.scene.event(block, "slide", (first, rest_at))


def bump(pusher: Instance, bumped: Instance, way: Vector, frames: Frames) -> None:
    """Lets a block that moves along `way` take another one along from the frame at which they meet."""
    ahead = way.normalized()

    def extent(block: Instance, frame: int, side: float) -> float:
        obj, matrix = block.objects[0], block.matrix(frame)
        return side * max(side * (matrix @ v.co).dot(ahead) for v in obj.data.vertices)

    rear = extent(bumped, 0, -1.0)
    overlap = [extent(pusher, f, 1.0) - rear for f in range(FRAME_COUNT)]
    first = next(f for f in range(FRAME_COUNT) if overlap[f] > 0.0)
    start = bumped.matrix(0)
    coast = 0.002
    track = []
    for f in range(FRAME_COUNT):
        extra = coast * keys.ease_between(f, frames[1] - 3, frames[1] + 5)
        track.append(Matrix.Translation(ahead * (max(overlap[f], 0.0) + extra)) @ start)
    for obj in bumped.objects:
        keys.key_matrices(obj, track)
    last = max(frames[1], first + MIN_EVENT_FRAMES - 1)
    pusher.scene.event(pusher, "push", (first, last), bumped)
    pusher.scene.event(bumped, "slide", (first, last))


class RampSlide:
    """The way of a block (edge length in metres) from the deck of a toy ramp down to the ground before it.

    `from_y`, `to_y` are where its middle starts and ends, in the ramp's own axes.
    """

    def __init__(self, ramp: Matrix, size_m: float, from_y: float, to_y: float) -> None:
        self.ramp = ramp
        self._poses = self._way(size_m, from_y, to_y)
        self._lengths = [0.0]
        for a, b in zip(self._poses, self._poses[1:]):
            self._lengths.append(self._lengths[-1] + hypot(b[0] - a[0], b[1] - a[1]))
        self.length = self._lengths[-1]
        self.foot_m = next(s for s, pose in zip(self._lengths, self._poses) if pose[1] < 0.4 * size_m)

    def block_matrix(self, s: float, flat: bool = False) -> Matrix:
        """World matrix of the block's base after `s` metres; `flat` keeps it on the level of the deck."""
        s = min(max(s, 0.0), self.length)
        i = min(max(bisect_right(self._lengths, s) - 1, 0), len(self._poses) - 2)
        span = self._lengths[i + 1] - self._lengths[i]
        t = (s - self._lengths[i]) / span if span > 0.0 else 0.0
        y, z, tilt = (a + (b - a) * t for a, b in zip(self._poses[i], self._poses[i + 1]))
        if flat:
            y, z, tilt = self._poses[0][0] - s, self._poses[0][1], 0.0
        return self.ramp @ Matrix.Translation((0.0, y, z)) @ Matrix.Rotation(tilt, 4, "X")

    def progress(self, first: int, pushed: int, rest: int) -> list[float]:
        """Metres gone per frame: pushed until `pushed`, then faster down the chute, then slowing to rest."""
        foot = pushed + 0.55 * (rest - pushed)
        frames = [first, first + 0.4 * (pushed - first), pushed, foot, rest - 0.2 * (rest - foot), rest]
        speed = np.interp(np.arange(FRAME_COUNT), frames, [0.0, 0.55, 0.6, 1.25, 0.18, 0.0])
        speed[: first + 1] = 0.0
        gone = np.cumsum(speed)
        return [float(s) for s in gone * self.length / gone[-1]]

    def _way(self, size: float, from_y: float, to_y: float) -> list[tuple[float, float, float]]:
        """Samples (y, z, tilt) of the base's middle: deck, tipping, chute, levelling out, ground."""
        edge, top, slope = toy_ramp.EDGE_Y_M, toy_ramp.HEIGHT_M, toy_ramp.SLOPE_RAD
        chute = hypot(top, edge - toy_ramp.FOOT_Y_M)
        poses = [(float(y), top, 0.0) for y in np.arange(from_y, edge + _TIP_M, -_STEP_M)]
        for s in np.arange(-_TIP_M, chute - 0.5 * size, _STEP_M):
            t = min(max((s + _TIP_M) / (2 * _TIP_M), 0.0), 1.0)
            tilt = slope * keys.ease(t)
            poses.append((edge - s * cos(tilt), top - s * sin(tilt), tilt))
        for q in np.arange(0.0, size, _STEP_M):
            p = -q * cos(slope) + sqrt((q * cos(slope)) ** 2 - q * q + size * size)
            front, back = toy_ramp.FOOT_Y_M - q, toy_ramp.FOOT_Y_M + p * cos(slope)
            poses.append((0.5 * (front + back), 0.5 * p * sin(slope), asin(min(p * sin(slope) / size, 1.0))))
        ahead = np.arange(toy_ramp.FOOT_Y_M - 0.5 * size - _STEP_M, to_y, -_STEP_M)
        return poses + [(float(y), 0.0, 0.0) for y in ahead]
