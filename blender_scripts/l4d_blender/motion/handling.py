"""People whose hands follow the things they use, along paths that the things' work dictates.

A thing moves along a planned path; the hand that grips it is led there, so that fist and handle can't part.
Knows grips and paths; refuses to know what the things are for.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from math import radians

import bpy
import numpy as np
from mathutils import Matrix

from ..assets.anatomy import vec
from ..scene import keys
from ..scene.scene import Instance, RecipeError
from ..scene.timeline import FRAME_COUNT, LAST_FRAME
from .acting import Played, grip_points
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


def grip(
    person: Person,
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

    `path` has a 4x4 matrix per canonical frame; `finish` refuses a fist that is off it. During `moves`
    the thing slides over what it stands on, during `puts_down` it is set down.
    """
    first, last = frames
    points = path[:, :3, :3] @ np.array(how.point) + path[:, :3, 3]
    turned = np.stack(
        [_fist(person, side, r @ np.array(how.thumb), r @ np.array(how.knuckles)) for r in path[:, :3, :3]]
    )
    wrists = points - np.stack([person.puppet.grip_offset(side, r) for r in turned])
    pole = vec(SIGN[side] * elbow_out, 0.75, -0.55)
    start = (-2, -1) if first == 0 else (first - approach, first)
    person.wish(side, start, wrists, turned, "world", pole=pole, arc=0.0 if first == 0 else arc_m)
    if first == 0:
        person.curl[side][:] = 0.86
    else:
        person.close_hand(side, first - approach, 0.12)
        person.close_hand(side, first - 3, 0.86, within=5)
    if last < LAST_FRAME:
        person.close_hand(side, last, 0.15, within=6)
        person.lower_arm(side, (last + 3, last + 3 + let_go))
    person.late.append(partial(_check_fist, person, side, points, frames, thing.name))
    person.scene.event(person.instance, "hold", frames, thing)
    if moves is not None:
        person.scene.event(person.instance, "move", moves, thing)
        person.scene.event(thing, "slide", moves)
    if puts_down is not None:
        person.scene.event(person.instance, "put_down", puts_down, thing)


def rest_hand(person: Person, side: str, point: Sequence[float], frames: Frames) -> None:
    """Lays a hand flat on something during a frame interval (it arrives with the first frame)."""
    first, last = frames
    forward = turn_z(float(person.heading[first])) @ vec(-0.25 * SIGN[side], -1.0, -0.12)
    turned = person.puppet.hand_rotation(side, forward, vec(0, 0, -1))
    wrist = np.array(point, float) - person.puppet.palm_offset(side, turned)
    start = (-2, -1) if first == 0 else (first - 12, first)
    person.wish(side, start, wrist, turned, "world", arc=0.03)
    person.close_hand(side, max(first - 6, 0), 0.16)
    if last < LAST_FRAME:
        person.lower_arm(side, (last, last + 12))


def _check_fist(
    person: Person, side: str, points: np.ndarray, frames: Frames, what: str, played: Played
) -> None:
    """Refuses a fist that leaves its path (n, 3): it would part from what it holds."""
    for f in range(frames[0], frames[1] + 1):
        (fist,) = grip_points(person, played, f, (side,))
        gap = float(np.linalg.norm(fist - points[f]))
        if gap > MAX_GAP_M:
            raise RecipeError(
                f"{person.instance.name}'s {side} hand is {100 * gap:.1f} cm off {what} at frame {f}",
                "stand closer, lean in, or shorten the path",
            )


def _fist(person: Person, side: str, thumb: np.ndarray, knuckles: np.ndarray) -> np.ndarray:
    t = unit(thumb)
    a = unit(knuckles - (knuckles @ t) * t)
    return person.puppet.hand_rotation(side, a, np.cross(t, a) * -SIGN[side])


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
