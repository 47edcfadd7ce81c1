"""How a water bird holds itself: a pose, and the bones that follow from it.

Legs and neck are two-bone reaches, wings a spread and a flap. Knows no time and no verbs; shapes and joints
come from assets/waterbird.py.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from mathutils import Matrix, Vector

from ..assets import waterbird as shape

SIDES = shape.SIDES


@dataclass
class Pose:
    """A bird in its own frame: metres and radians, front -Y, feet where ankles are."""

    ankles: dict[str, Vector]
    head: Vector
    foot_yaw: dict[str, float] = field(default_factory=lambda: dict.fromkeys(SIDES, 0.0))
    foot_pitch: dict[str, float] = field(default_factory=lambda: dict.fromkeys(SIDES, 0.0))
    drop_m: float = 0.0
    pitch: float = 0.0
    roll: float = 0.0
    head_pitch: float = 0.0
    head_yaw: float = 0.0
    spread: float = 0.0
    flap: float = 0.0
    bend: float = 0.0


def _two_bones(
    start: Vector, end: Vector, first: float, second: float, pole: Vector
) -> tuple[Vector, Vector]:
    """Where the middle joint and the end come to lie; the middle bends towards `pole`."""
    way = end - start
    reach = min(max(way.length, 1.02 * abs(first - second)), 0.998 * (first + second))
    way.normalize()
    along = (first**2 - second**2 + reach**2) / (2.0 * reach)
    off = math.sqrt(max(0.0, first**2 - along**2))
    bend = (pole - pole.project(way)).normalized()
    return start + along * way + off * bend, start + reach * way


def _segment(rest_start: Vector, rest_end: Vector, start: Vector, end: Vector) -> Matrix:
    """The motion that carries a bone from its rest place to another."""
    turn = (rest_end - rest_start).rotation_difference(end - start).to_matrix().to_4x4()
    return Matrix.Translation(start) @ turn @ Matrix.Translation(-rest_start)


def solve(species: shape.Species, pose: Pose) -> dict[str, Matrix]:
    """Per bone the motion from rest to pose, in the rig's space."""
    body = body_motion(species, pose)
    moved = {"body": body}
    for part, motion in shape.wing_motion(species, pose.spread, pose.flap, pose.bend).items():
        moved[part] = body @ motion
    rest_low, rest_mid, rest_top = (species.joint(j) for j in ("neck_low", "neck_mid", "neck_top"))
    low = body @ rest_low
    first, second = (rest_mid - rest_low).length, (rest_top - rest_mid).length
    mid, top = _two_bones(low, pose.head, first, second, Vector((0.0, -1.0, -0.2)))
    moved["neck_low"] = _segment(rest_low, rest_mid, low, mid)
    moved["neck_high"] = _segment(rest_mid, rest_top, mid, top)
    gaze = Matrix.Rotation(pose.head_yaw, 4, "Z") @ Matrix.Rotation(pose.head_pitch, 4, "X")
    moved["head"] = Matrix.Translation(top) @ gaze @ Matrix.Translation(-rest_top)
    for side in SIDES:
        rest_hip, rest_hock, rest_ankle = (species.joint(j, side) for j in ("hip", "hock", "ankle"))
        hip = body @ rest_hip
        upper, lower = (rest_hock - rest_hip).length, (rest_ankle - rest_hock).length
        hock, ankle = _two_bones(hip, pose.ankles[side], upper, lower, Vector((0.0, 1.0, 0.2)))
        moved[f"thigh_{side}"] = _segment(rest_hip, rest_hock, hip, hock)
        moved[f"shank_{side}"] = _segment(rest_hock, rest_ankle, hock, ankle)
        set_down = Matrix.Rotation(pose.foot_yaw[side], 4, "Z") @ Matrix.Rotation(
            pose.foot_pitch[side], 4, "X"
        )
        moved[f"foot_{side}"] = Matrix.Translation(ankle) @ set_down @ Matrix.Translation(-rest_ankle)
    return moved


def body_motion(species: shape.Species, pose: Pose) -> Matrix:
    """How far the trunk has gone from rest."""
    pivot = species.joint("pivot")
    return (
        Matrix.Translation(pivot - Vector((0.0, 0.0, pose.drop_m)))
        @ Matrix.Rotation(pose.roll, 4, "Y")
        @ Matrix.Rotation(pose.pitch, 4, "X")
        @ Matrix.Translation(-pivot)
    )
