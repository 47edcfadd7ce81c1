"""The arm behind an acting hand: shoulder, elbow and the bones of arm and fingers, frame by frame.

Given where a hand is at all frames it finds an elbow that spares the wrist and the table. Knows no actions.
"""

from __future__ import annotations

import numpy as np

from ..assets.anatomy import vec
from ..assets.hand import BONES, DIGITS, FOREARM_M, UPPER_ARM_M
from ..scene.scene import RecipeError
from ..scene.timeline import FRAME_COUNT
from .grips import Pose, digit_frames
from .ik import between, smooth, turn_about, two_bone, unit

ROWS = np.arange(FRAME_COUNT)
DOWN = vec(0, 0, -1)
MAX_LEAN_M = 0.14


class Arm:
    """Solves one arm for the places (world matrices per frame) of its hand."""

    def __init__(
        self, name: str, side: str, scale: float, shoulder: np.ndarray, table_m: float, places: np.ndarray
    ) -> None:
        self.name, self.side, self.scale, self.table_m = name, side, scale, table_m
        self.shoulder, self._place = shoulder, places
        self.shoulders = self._leaning()
        self.elbows = self._elbows()

    def _leaning(self) -> np.ndarray:
        """Shoulder positions: the body leans in when an arm alone is too short."""
        length = (UPPER_ARM_M + FOREARM_M) * self.scale
        way = self._place[:, :3, 3] - self.shoulder
        gap = np.linalg.norm(way, axis=1)
        lean = np.maximum(gap - 0.94 * length, 0.0)
        worst = int(np.argmax(lean))
        if lean[worst] > MAX_LEAN_M:
            raise RecipeError(
                f"{self.name} is {100 * (lean[worst] - MAX_LEAN_M):.1f} cm too far from its "
                f"shoulder at frame {worst}",
                "move the shoulder nearer or the target closer",
            )
        lean = np.maximum(smooth(lean, 5.0), gap - 0.985 * length)
        return self.shoulder + way / gap[:, None] * lean[:, None]

    def _elbows(self) -> np.ndarray:
        """Elbow positions: outwards and low, above the table, sparing the wrist; smooth over time."""
        angles, sampled = np.linspace(-1.9, 1.9, 39), np.arange(0, FRAME_COUNT, 4)
        cost = np.zeros((len(sampled), len(angles)))
        for row, f in enumerate(sampled):
            wrist, hand = self._place[f][:3, 3], self._place[f][:3, :3]
            for n, angle in enumerate(angles):
                elbow = self._elbow(f, angle)
                bend = np.arccos(np.clip(unit(wrist - elbow) @ (hand @ vec(0, -1, 0)), -1, 1))
                low = max(0.0, self.table_m + 0.050 * self.scale - elbow[2])
                cost[row, n] = bend**2 + 0.12 * angle**2 + (30.0 * low) ** 2
        best = np.interp(ROWS, sampled, angles[np.argmin(smooth(cost, 0.8), axis=1)])
        return np.array([self._elbow(f, float(angle)) for f, angle in enumerate(smooth(best, 4.0))])

    def _elbow(self, f: int, angle: float) -> np.ndarray:
        """The elbow at a frame for a swivel angle: 0 is out and down."""
        wrist, shoulder = self._place[f][:3, 3], self.shoulders[f]
        ahead = unit(wrist - shoulder)
        out = -thumbward(self.side, unit((wrist - shoulder) * vec(1, 1, 0)))
        pole = unit(0.75 * out + 0.65 * DOWN)
        pole = unit(pole - (pole @ ahead) * ahead)
        swivel = turn_about(ahead, angle * (1.0 if self.side == "r" else -1.0))
        return two_bone(shoulder, wrist, UPPER_ARM_M * self.scale, FOREARM_M * self.scale, swivel @ pole)[0]

    def bones(
        self, world: np.ndarray, pose: Pose, elbow: np.ndarray, shoulder: np.ndarray
    ) -> dict[str, np.ndarray]:
        """Deformation of every bone in the rig's space, which moves with the hand."""
        mirror = np.diag([-1.0, 1.0, 1.0]) if self.side == "l" else np.eye(3)
        heads = {bone.name: mirror @ bone.head * self.scale for bone in BONES}
        bones = {"hand": np.eye(4)}
        for n, digit in enumerate(DIGITS):
            joints, turned = digit_frames(digit, pose[n])
            base = np.eye(3)
            for k in range(3):
                at, rotation = mirror @ joints[k] * self.scale, mirror @ turned[k] @ mirror
                bones[f"{digit}_half_{k + 1}"] = deform(
                    heads[f"{digit}_{k + 1}"], at, between(base, rotation, 0.5)
                )
                bones[f"{digit}_{k + 1}"] = deform(heads[f"{digit}_{k + 1}"], at, rotation)
                base = rotation
        back = np.linalg.inv(world)
        at, shoulder = (back @ np.append(elbow, 1.0))[:3], (back @ np.append(shoulder, 1.0))[:3]
        fore = _aimed(np.eye(3), -at)
        upper = _aimed(fore, at - shoulder)
        bones["forearm"] = deform(heads["forearm"], at, fore)
        bones["wrist"] = deform(heads["wrist"], np.zeros(3), between(np.eye(3), fore, 0.5))
        bones["elbow"] = deform(heads["elbow"], at, between(fore, upper, 0.5))
        bones["upper_arm"] = deform(heads["elbow"], at, upper)
        return bones


def thumbward(side: str, fingers: np.ndarray) -> np.ndarray:
    """Horizontal direction to the thumb's side of a hand whose palm is down."""
    left = vec(-fingers[1], fingers[0], 0)
    return left if side == "r" else -left


def _aimed(rotation: np.ndarray, way: np.ndarray) -> np.ndarray:
    """A rotation turned the short way so that its -Y looks along `way`."""
    now, goal = rotation @ vec(0, -1, 0), unit(way)
    axis = np.cross(now, goal)
    sine = float(np.linalg.norm(axis))
    return rotation if sine < 1e-9 else turn_about(axis, float(np.arctan2(sine, now @ goal))) @ rotation


def matrix_of(rotation: np.ndarray, at: np.ndarray) -> np.ndarray:
    """A 4x4 matrix from a rotation and a place."""
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = rotation, at
    return matrix


def deform(head: np.ndarray, at: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    """Deformation of a bone that rests at `head` and is now at a place, rotated."""
    return matrix_of(rotation, at - rotation @ head)
