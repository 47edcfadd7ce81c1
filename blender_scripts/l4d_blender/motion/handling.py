"""People whose hands follow the things they use, along paths that the things' work dictates.

A thing moves along a planned path; the hand that grips it is led there, so that fist and handle can't part.
Knows grips and paths; refuses to know what the things are for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import radians
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from ..assets.anatomy import vec
from ..scene import keys
from ..scene.scene import Instance, RecipeError
from ..scene.timeline import FRAME_COUNT, LAST_FRAME
from .acting import grip_points
from .ik import ease, turn_z, unit
from .people import Person
from .plan_person import ROWS, SIGN, Frames

MAX_GAP_M = 0.02


@dataclass(frozen=True)
class Grip:
    """How a fist holds a thing, in the thing's space: where, which way the thumb and the knuckles point."""

    point: tuple[float, float, float]
    thumb: tuple[float, float, float]
    knuckles: tuple[float, float, float]


@dataclass
class Guided:
    """A hand that follows a path from `first` to `last`."""

    side: str
    fist: np.ndarray
    first: int
    last: int
    what: str


class Handler(Person):
    """A person who handles things. A thing's path is a 4x4 matrix per canonical frame."""

    def __init__(self, *args: Any, **options: Any) -> None:
        super().__init__(*args, **options)
        self._guided: list[Guided] = []

    def lean_in(self, frames: Frames, depth: float, twist: float = 0.0) -> None:
        """Bends towards the work (0.3 is a nod of the trunk) and stays so."""
        self._stoop(*frames, depth, twist)

    def grip(
        self,
        thing: Instance,
        path: np.ndarray,
        how: Grip,
        frames: Frames,
        *,
        side: str,
        approach: int = 12,
        let_go: int = 12,
        arc_m: float = 0.04,
        elbow_out: float = 0.55,
        moves: Frames | None = None,
        puts_down: Frames | None = None,
    ) -> None:
        """Holds `thing` from frame `first` to `last` while it follows `path`; from 0 on it is in the hand.

        `moves` is when it slides over what it stands on, `puts_down` when it is set down.
        """
        first, last = frames
        points = path[:, :3, :3] @ np.array(how.point) + path[:, :3, 3]
        turned = np.stack(
            [self._fist(side, r @ np.array(how.thumb), r @ np.array(how.knuckles)) for r in path[:, :3, :3]]
        )
        wrists = points - np.stack([self.puppet.grip_offset(side, r) for r in turned])
        pole = vec(SIGN[side] * elbow_out, 0.75, -0.55)
        start = (-2, -1) if first == 0 else (first - approach, first)
        self._wish(side, start, wrists, turned, "world", pole=pole, arc=0.0 if first == 0 else arc_m)
        if first == 0:
            self._curl[side][:] = 0.86
        else:
            self._close(side, first - approach, 0.12)
            self._close(side, first - 3, 0.86, within=5)
        if last < LAST_FRAME:
            self._close(side, last, 0.15, within=6)
            self._lower(side, (last + 3, last + 3 + let_go))
        self._guided.append(Guided(side, points, first, last, thing.name))
        self.scene.event(self.instance, "hold", frames, thing)
        if moves is not None:
            self.scene.event(self.instance, "move", moves, thing)
            self.scene.event(thing, "slide", moves)
        if puts_down is not None:
            self.scene.event(self.instance, "put_down", puts_down, thing)

    def rest_hand(self, side: str, point: Sequence[float], frames: Frames) -> None:
        """Lays a hand flat on something during a frame interval (it arrives with the first frame)."""
        first, last = frames
        forward = turn_z(float(self._heading[first])) @ vec(-0.25 * SIGN[side], -1.0, -0.12)
        turned = self.puppet.hand_rotation(side, forward, vec(0, 0, -1))
        wrist = np.array(point, float) - self.puppet.palm_offset(side, turned)
        start = (-2, -1) if first == 0 else (first - 12, first)
        self._wish(side, start, wrist, turned, "world", arc=0.03)
        self._close(side, max(first - 6, 0), 0.16)
        if last < LAST_FRAME:
            self._lower(side, (last, last + 12))

    def finish(self) -> None:
        """Turns the plan into keys and refuses fists that leave what they hold."""
        super().finish()
        for guided in self._guided:
            for f in range(guided.first, guided.last + 1):
                (fist,) = grip_points(self, self.played, f, (guided.side,))
                gap = float(np.linalg.norm(fist - guided.fist[f]))
                if gap > MAX_GAP_M:
                    raise RecipeError(
                        f"{self.instance.name}'s {guided.side} hand is {100 * gap:.1f} cm off {guided.what} "
                        f"at frame {f}",
                        "stand closer, lean in, or shorten the path",
                    )

    def _fist(self, side: str, thumb: np.ndarray, knuckles: np.ndarray) -> np.ndarray:
        t = unit(thumb)
        a = unit(knuckles - (knuckles @ t) * t)
        return self.puppet.hand_rotation(side, a, np.cross(t, a) * -SIGN[side])


# ---- paths of things -----------------------------------------------------------------------------


def still(at: Sequence[float], heading_deg: float = 0.0) -> np.ndarray:
    """A thing that stands upright at a place, at all frames."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn_z(radians(heading_deg)), at
    return np.tile(matrix, (FRAME_COUNT, 1, 1))


def shift(path: np.ndarray, by: Sequence[float], frames: Frames) -> np.ndarray:
    """The same path, slid by a vector during an interval."""
    moved = path.copy()
    u = ease((ROWS - frames[0]) / (frames[1] - frames[0]))
    moved[:, :3, 3] += u[:, None] * np.array(by, float)
    return moved


def key_path(obj: bpy.types.Object, path: np.ndarray) -> None:
    """Keys an object along a path."""
    keys.key_matrices(obj, [Matrix(m) for m in path])
