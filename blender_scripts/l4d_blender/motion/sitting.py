"""People who sit all the time, rest their hands on something, and hold small things that tilt with the hand.

Knows seats and surfaces as points; refuses to know what is done while sitting (deskwork.py, reading.py).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees, radians
from typing import Any

import numpy as np

from ..assets.anatomy import vec
from .fingertips import Rigid, move_rigid
from .ik import turn_z
from .people import Person
from .plan_person import SIGN, Frames

SEAT_SINK_M = 0.085
UP = vec(0.0, 0.0, 1.0)


class Sitter(Person):
    """A Person that may be seated from the start and holds things rigidly."""

    def __init__(self, *args: Any, **more: Any) -> None:
        super().__init__(*args, **more)
        self._rigid: list[Rigid] = []

    def be_seated(self, seat: Sequence[float], *, lean_deg: float = degrees(0.10)) -> None:
        """Sits from the first frame to the last on a seat (a point on its surface, behind the feet)."""
        drop = self.body.anatomy.joints["root"][2] - (float(seat[2]) - self.ground_m + SEAT_SINK_M * self._k)
        self._crouch[:] = drop
        self._bend[:] = radians(lean_deg)
        self._slide[:] = np.array(seat[:2]) - self._xy[0]

    def rest_hands(self, points: dict[str, Sequence[float]], frames: Frames) -> None:
        """Lays the palms on a surface, fingers ahead, and leaves them there until something else happens."""
        ahead = self._facing(frames[0])
        for side, point in points.items():
            medial = self._medial(side, frames[0])
            turned = self.puppet.hand_rotation(side, ahead + 0.35 * medial - 0.06 * UP, -UP + 0.25 * medial)
            wrist = np.array(point) + 0.004 * UP - self.puppet.palm_offset(side, turned)
            self._wish(side, frames, wrist, turned, "world")
            self._close(side, frames[0], 0.20)

    def finish(self) -> None:
        """Turns the plan into keys and moves what hands hold rigidly."""
        super().finish()
        for thing in self._rigid:
            move_rigid(thing, self.played)

    def _facing(self, frame: int) -> np.ndarray:
        return turn_z(float(self._heading[frame])) @ vec(0.0, -1.0, 0.0)

    def _medial(self, side: str, frame: int) -> np.ndarray:
        return turn_z(float(self._heading[frame])) @ vec(-SIGN[side], 0.0, 0.0)
