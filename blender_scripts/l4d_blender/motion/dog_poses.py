"""How a dog holds itself: postures that can be blended, and the bones that follow from them.

A `DogPose` says where pelvis, spine, head, tail and paws are; `solve` turns it into one motion per bone.
Knows no time and no verbs; angles as in quadrupeds.py.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from mathutils import Matrix, Vector

from ..assets import dog as anatomy
from .limbs import about, carried, two_bones, untwisted
from .quadrupeds import PAWS, Pose, mirrored, move_chain, move_head, move_pelvis, zeros

SPINE = ("loin", "ribs", "chest")
#: (top, middle, ankle, ball) joints and the bones between them.
_CHAIN = {
    "fore": (("shoulder", "elbow", "wrist", "forepaw"), ("upperarm", "forearm", "forepaw", "foretoe")),
    "hind": (("hip", "knee", "hock", "hindpaw"), ("thigh", "shin", "hindpaw", "hindtoe")),
}
NOSE_TIP = Vector((0.0, -0.566, 0.573))


@dataclass
class DogPose(Pose):
    """Everything that can be blended; rows of spine and tail are pitch and yaw."""

    pelvis: np.ndarray = field(default_factory=lambda: np.array(anatomy.JOINTS["pelvis"]))
    spine: np.ndarray = field(default_factory=zeros(3, 2))
    jaw: np.ndarray = field(default_factory=zeros(1))
    tail: np.ndarray = field(default_factory=zeros(anatomy.TAIL_BONES, 2))


# --- postures ---------------------------------------------------------------------------------------------


def _tail(*pitches: float) -> np.ndarray:
    tail = np.zeros((anatomy.TAIL_BONES, 2))
    tail[:, 0] = pitches
    return tail


def standing(root: Sequence[float]) -> DogPose:
    """On four legs, tail in a loose curve upwards."""
    pose = DogPose(root=np.array(root, float))
    pose.tail = _tail(-0.25, -0.20, -0.12, -0.08, -0.05, -0.05)
    return pose.put_paws(mirrored((0.076, -0.196, 0, 0, 0.04, 0), (0.078, 0.268, 0, 0, 0.06, 0)))


def sitting(root: Sequence[float]) -> DogPose:
    """On the haunches, forelegs straight, tail on the ground."""
    pose = DogPose(root=np.array(root, float))
    pose.pelvis = np.array([0.0, 0.200, 0.158])
    pose.pelvis_turn[0] = -0.88
    pose.spine[:, 0] = (0.08, 0.12, 0.12)
    pose.neck[0] = 0.10
    pose.tail = _tail(0.42, 0.20, 0.10, 0.06, 0.0, 0.0)
    return pose.put_paws(mirrored((0.072, -0.205, 0, 0, 0.06, 0), (0.112, 0.068, 0, 0, 0.28, -1.02)))


def lying(root: Sequence[float]) -> DogPose:
    """On the belly, forelegs stretched ahead, head up."""
    pose = DogPose(root=np.array(root, float))
    pose.pelvis = np.array([0.0, 0.255, 0.212])
    pose.pelvis_turn[0] = -0.03
    pose.spine[:, 0] = (0.0, 0.02, -0.06)
    pose.neck[0] = 0.05
    pose.tail = _tail(0.30, 0.10, 0.0, 0.0, 0.0, 0.0)
    return pose.put_paws(mirrored((0.092, -0.425, 0, 0, 0.04, -1.32), (0.130, 0.110, 0, 0, 0.25, -1.28)))


def sniffing(root: Sequence[float]) -> DogPose:
    """Standing with bent elbows, the nose near the ground."""
    pose = standing(root)
    pose.pelvis = np.array([0.0, 0.245, 0.440])
    pose.pelvis_turn[0] = 0.10
    pose.spine[:, 0] = (0.04, 0.06, 0.06)
    pose.neck[0] = 1.02
    pose.head[0] = 1.08
    return pose


POSTURES = {"stand": standing, "sit": sitting, "lie": lying, "sniff": sniffing}


# --- from pose to bones -----------------------------------------------------------------------------------


def solve(pose: DogPose) -> dict[str, Matrix]:
    """Motions of all bones from rest, in the rig's space."""
    moved = trunk(pose)
    to_local = pose.world().inverted()
    for i, paw in enumerate(PAWS):
        _leg(moved, pose, i, paw, to_local)
    return moved


def trunk(pose: DogPose) -> dict[str, Matrix]:
    """Motions of pelvis, spine, neck, head, jaw and tail."""
    joint = anatomy.joint
    moved = {"pelvis": move_pelvis(pose, joint)}
    spine = {bone: _bend(pitch, yaw) for bone, (pitch, yaw) in zip(SPINE, pose.spine, strict=True)}
    move_chain(moved, "pelvis", spine, joint)
    move_head(moved, pose, joint)
    moved["jaw"] = moved["head"] @ about(joint("jaw"), Matrix.Rotation(float(pose.jaw[0]), 4, "X"))
    tail = {f"tail{i}": _bend(-pitch, yaw) for i, (pitch, yaw) in enumerate(pose.tail)}
    move_chain(moved, "pelvis", tail, joint)
    return moved


def _bend(pitch: float, yaw: float) -> Matrix:
    return Matrix.Rotation(yaw, 4, "Z") @ Matrix.Rotation(pitch, 4, "X")


def _leg(moved: dict[str, Matrix], pose: DogPose, i: int, paw: str, to_local: Matrix) -> None:
    kind, side = paw.split(".")
    side = "." + side
    out = 1.0 if side == ".L" else -1.0
    names, bones = _CHAIN[kind]
    rest = [anatomy.joint(name + side) for name in names]
    x, y, z, pitch, yaw, heel = pose.paws[i]
    turn = Matrix.Rotation(yaw - pose.root[2], 3, "Z")
    toes = turn @ Matrix.Rotation(pitch, 3, "X")
    # Toes that point down carry the ball of the foot up.
    ball = to_local @ Vector((x, y, z)) + Vector((0.0, 0.0, rest[3].z + 0.045 * math.sin(max(pitch, 0.0))))
    shank = turn @ Matrix.Rotation(pitch + heel, 3, "X")
    ankle = ball + shank @ (rest[2] - rest[3])
    if kind == "fore":
        carrier = moved["chest"]
        reach = (carrier.inverted() @ ball).y - rest[3].y
        shrug = Matrix.Rotation(max(-0.40, min(0.40, 1.3 * reach)), 4, "X")
        moved["scapula" + side] = carrier @ about(anatomy.joint("scapula" + side), shrug)
        top = moved["scapula" + side] @ rest[0]
        pole = carrier.to_3x3() @ Vector((0.22 * out, 1.0, 0.0))
    else:
        carrier = moved["pelvis"]
        top = carrier @ rest[0]
        pole = carrier.to_3x3() @ Vector((0.20 * out, -1.0, 0.0)) + Vector((0.18 * out, -0.4, 0.35))
    lengths = (rest[1] - rest[0]).length, (rest[2] - rest[1]).length
    middle, reached = two_bones(top, ankle, *lengths, pole)
    rest_pole = Vector((0.0, 1.0 if kind == "fore" else -1.0, 0.0))
    for bone, motion in zip(bones, untwisted(rest[:3], (top, middle, reached), rest_pole, pole)):
        moved[bone + side] = motion
    moved[bones[2] + side] = carried(reached, shank.to_quaternion(), rest[2])
    moved[bones[3] + side] = carried(ball + (reached - ankle), toes.to_quaternion(), rest[3])
