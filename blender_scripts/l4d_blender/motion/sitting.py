"""People who sit all the time, wave, and rest their hands on their knees or on something.

Knows seats and surfaces as points; refuses to know what is done while sitting (deskwork.py, reading.py).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees, pi, radians

import numpy as np

from ..assets.anatomy import SIDES, vec
from ..scene.timeline import FPS, LAST_FRAME
from .ik import turn_z
from .people import Person
from .plan_person import ROWS, SIGN, Frames

SEAT_SINK_M = 0.085
UP = vec(0.0, 0.0, 1.0)


def be_seated(person: Person, seat: Sequence[float], *, lean_deg: float = degrees(0.10)) -> None:
    """Sits from the first frame to the last on a seat (a point on its surface, behind the feet)."""
    drop = person.body.anatomy.joints["root"][2] - (float(seat[2]) - person.ground_m + SEAT_SINK_M * person.k)
    person.crouch[:] = drop
    person.bend[:] = radians(lean_deg)
    person.slide[:] = np.array(seat[:2]) - person.xy[0]


def sit_all_along(person: Person, seat: Sequence[float]) -> None:
    """Sits from the first frame to the last, hands on the knees."""
    be_seated(person, seat)
    person.scene.event(person.instance, "sit", (0, LAST_FRAME))
    for side, _ in SIDES:
        hand_on_knee(person, side, (-2, -1))


def hand_on_knee(person: Person, side: str, frames: Frames) -> None:
    """Lays one hand on the thigh of a seated body."""
    s, k = SIGN[side], person.k
    hip_m = person.body.anatomy.joints["root"][2] - float(person.crouch[frames[1] if frames[1] > 0 else 0])
    wrist = vec(s * 0.115 * k, -0.06 * k, hip_m + 0.07 * k)
    turned = person.puppet.hand_rotation(side, vec(-0.25 * s, -0.95, -0.12), vec(0.1 * s, 0, -1))
    facing = turn_z(float(person.heading[0]))
    world = np.array([*person.xy[0], person.ground_m]) + facing @ wrist
    person.wish(side, frames, world, facing @ turned, "world")
    person.close_hand(side, max(frames[0], 0), 0.22)


def wave_sitting(person: Person, frames: Frames, *, side: str = "r", per_s: float = 1.5) -> None:
    """Raises a hand beside the head of a seated body, waves, and lays it on the knee again."""
    first, last = frames
    s, k = SIGN[side], person.k
    swing = np.sin(2 * pi * per_s * (ROWS - first) / FPS)
    facing = turn_z(float(person.heading[0]))
    slide = turn_z(-float(person.heading[0])) @ np.array([*person.slide[first], 0.0])
    drop = float(person.crouch[first])
    back = slide[1] + 0.12 * drop
    wrist = np.stack(
        [s * (0.32 + 0.085 * swing), -0.16 + back / k + 0.0 * swing, 1.56 - drop / k - 0.022 * swing**2],
        axis=1,
    )
    along = np.stack([s * (0.16 + 0.42 * swing), -0.08 + 0 * swing, 1.0 + 0 * swing], axis=1)
    turned = np.stack([facing @ person.puppet.hand_rotation(side, a, vec(0, -1, 0.1)) for a in along])
    world = np.array([*person.xy[0], person.ground_m]) + (k * wrist) @ facing.T
    person.wish(side, (first, first + 14), world, turned, "world", pole=vec(s * 0.8, 0.25, -0.9))
    person.close_hand(side, first, 0.06)
    if last < LAST_FRAME:
        hand_on_knee(person, side, (last - 12, last))
    person.scene.event(person.instance, "wave", frames)


def rest_hands(person: Person, points: dict[str, Sequence[float]], frames: Frames) -> None:
    """Lays the palms on a surface, fingers ahead, and leaves them there until something else happens."""
    ahead = way_ahead(person, frames[0])
    for side, point in points.items():
        medial = way_inwards(person, side, frames[0])
        turned = person.puppet.hand_rotation(side, ahead + 0.35 * medial - 0.06 * UP, -UP + 0.25 * medial)
        wrist = np.array(point) + 0.004 * UP - person.puppet.palm_offset(side, turned)
        person.wish(side, frames, wrist, turned, "world")
        person.close_hand(side, frames[0], 0.20)


def way_ahead(person: Person, frame: int) -> np.ndarray:
    """The direction in the world that the body faces."""
    return turn_z(float(person.heading[frame])) @ vec(0.0, -1.0, 0.0)


def way_inwards(person: Person, side: str, frame: int) -> np.ndarray:
    """The direction in the world from a side of the body to its middle."""
    return turn_z(float(person.heading[frame])) @ vec(-SIGN[side], 0.0, 0.0)
