"""People who read: a magazine held open in both hands, whose leaves are turned over one by one.

Knows how hands hold an open spread and lead a leaf over; refuses to know seats and rooms.
"""

from __future__ import annotations

import numpy as np
from mathutils import Matrix, Vector

from ..assets.anatomy import SIDES
from ..assets.magazine import LEFT_RAD, PAGE_M, Magazine, leaf_edge
from ..scene import keys
from ..scene.scene import Instance
from ..scene.timeline import FRAME_COUNT, LAST_FRAME
from .fingertips import tip_offset
from .ik import ease
from .people import Person
from .plan_person import ROWS, SIGN, Frames

_HOLD_CURL = 0.16
_LEAF_CURL = 0.24


class Spread:
    """A magazine that is held open somewhere: its instance and the angles of its leaves at all frames."""

    def __init__(self, instance: Instance, made: Magazine, at: Matrix) -> None:
        self.instance, self.made, self.at = instance, made, at
        self.angles = [np.zeros(FRAME_COUNT) for _ in made.leaves]
        made.body.matrix_basis = at

    def place(self, point: Vector) -> np.ndarray:
        """World position of a point of the open magazine."""
        return np.array(self.at @ point)

    def way(self, x: float, y: float, z: float) -> np.ndarray:
        """World direction of a direction in the magazine's axes."""
        return np.array(self.at.to_3x3() @ Vector((x, y, z)))

    def finish(self) -> None:
        """Keys the leaves; each lies a hair above those that were turned before it."""
        for k, (leaf, angles) in enumerate(zip(self.made.leaves, self.angles)):
            stack = len(self.made.leaves) - 1 - k
            matrices = []
            for angle in angles:
                turned = float(angle) / LEFT_RAD
                lift = 0.0008 * (stack * (1.0 - turned) - (stack - len(self.angles) + 1) * turned)
                matrices.append(
                    self.at @ Matrix.Translation((0.0, 0.0, lift)) @ self.made.leaf_matrix(float(angle))
                )
            leaf.matrix_basis = matrices[0]
            keys.key_matrices(leaf, matrices)


def hold_open(person: Person, spread: Spread) -> None:
    """Both hands hold the outer lower corners from below, thumbs on the page."""
    for side, _ in SIDES:
        _hold_corner(person, spread, side, (-2, -1))
    person.look_at(tuple(spread.place(Vector((0.0, 0.02, 0.03)))), (0, LAST_FRAME))
    person.scene.event(person.instance, "hold", (0, LAST_FRAME), spread.instance)


def turn_page(person: Person, spread: Spread, leaf: int, frames: Frames) -> None:
    """The right hand takes the upper corner of a leaf, leads it over to the left and comes back."""
    first, last = frames
    take, leave = first + 3, last - 2
    spread.angles[leaf] = LEFT_RAD * ease((ROWS - take) / (leave - take))
    side = "r"
    rotation = person.puppet.hand_rotation(
        side, spread.way(-0.35, 0.80, -0.35), spread.way(-0.80, -0.25, -0.50)
    )
    tips = np.array(
        [
            spread.place(leaf_edge(min(float(a), 0.62 * LEFT_RAD), 0.055, 0.010)) + spread.way(0, 0, 0.007)
            for a in spread.angles[leaf]
        ]
    )
    wrists = tips - tip_offset(person.puppet, side, "middle", _LEAF_CURL, rotation)
    low_elbow = np.array([SIGN[side] * 0.7, 0.25, -0.9])
    person.wish(side, (first - 6, take), wrists, rotation, "world", pole=low_elbow)
    person.close_hand(side, first - 6, _LEAF_CURL, within=6)
    _hold_corner(person, spread, side, (leave - 5, last + 9))
    person.scene.event(person.instance, "turn_page", frames, spread.instance)


def _hold_corner(person: Person, spread: Spread, side: str, frames: Frames) -> None:
    s = -SIGN[side]  # the reader's left hand holds the half at -X
    up = spread.way(0.0, 0.0, 1.0)
    rotation = person.puppet.hand_rotation(
        side, spread.way(-0.62 * s, 0.75, 0.0), up + 0.25 * spread.way(-s, 0.0, 0.0)
    )
    rim = spread.place(leaf_edge(0.0 if s > 0 else LEFT_RAD, -0.28 * PAGE_M[1], 0.035))
    wrist = rim - 0.012 * up - person.puppet.palm_offset(side, rotation)
    person.wish(side, frames, wrist, rotation, "world")
    person.close_hand(side, max(frames[0], -9), _HOLD_CURL)
