"""How a dog holds itself: postures that can be blended, and the limbs that follow from them.

A `Pose` says where pelvis, spine, head, tail and paws are; `solve` turns it into one motion per bone. Paws
are kept in the world, so that a planted paw stays where it is whatever the body does. Knows no time and no
verbs.

Body frame: -Y forward, +X left, +Z up; positive pitch lowers the nose, positive yaw turns left; radians.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from mathutils import Matrix, Quaternion, Vector

from .. import keys
from ..assets import dog as anatomy

SPINE = ("loin", "ribs", "chest")
PAWS = ("fore.L", "fore.R", "hind.L", "hind.R")
#: (top, middle, ankle, ball) joints and the bones between them.
_CHAIN = {
    "fore": (("shoulder", "elbow", "wrist", "forepaw"), ("upperarm", "forearm", "forepaw", "foretoe")),
    "hind": (("hip", "knee", "hock", "hindpaw"), ("thigh", "shin", "hindpaw", "hindtoe")),
}
NOSE_TIP = Vector((0.0, -0.566, 0.573))


def _zeros(*shape: int) -> Callable[[], np.ndarray]:
    return lambda: np.zeros(shape)


@dataclass
class Pose:
    """`root` x, y, heading; paws: world x, y, z of the ball of the foot, toe pitch, yaw, heel."""

    root: np.ndarray = field(default_factory=_zeros(3))
    pelvis: np.ndarray = field(default_factory=lambda: np.array(anatomy.JOINTS["pelvis"]))
    pelvis_turn: np.ndarray = field(default_factory=_zeros(3))
    spine: np.ndarray = field(default_factory=_zeros(3, 2))
    neck: np.ndarray = field(default_factory=_zeros(2))
    head: np.ndarray = field(default_factory=_zeros(3))
    jaw: np.ndarray = field(default_factory=_zeros(1))
    tail: np.ndarray = field(default_factory=_zeros(anatomy.TAIL_BONES, 2))
    paws: np.ndarray = field(default_factory=_zeros(4, 6))

    def copy(self) -> Pose:
        """A pose of its own with the same numbers."""
        return Pose(**{key: value.copy() for key, value in vars(self).items()})

    def blended(self, other: Pose, t: float) -> Pose:
        """The pose at `t` (0..1) between this one and another."""
        return Pose(**{key: (1 - t) * value + t * getattr(other, key) for key, value in vars(self).items()})

    def world(self) -> Matrix:
        """World matrix of the body frame."""
        x, y, heading = self.root
        return Matrix.Translation((x, y, 0.0)) @ Matrix.Rotation(heading, 4, "Z")


# --- postures ---------------------------------------------------------------------------------------------


def _placed_paws(pose: Pose, fore: Sequence[float], hind: Sequence[float]) -> Pose:
    """Puts the paws at (x, y, toe pitch, yaw, heel) of the body frame, mirrored on the right."""
    world = pose.world()
    for i, paw in enumerate(PAWS):
        x, y, pitch, yaw, heel = fore if paw.startswith("fore") else hind
        s = 1.0 if paw.endswith("L") else -1.0
        point = world @ Vector((s * x, y, 0.0))
        pose.paws[i] = (point.x, point.y, 0.0, pitch, pose.root[2] + s * yaw, heel)
    return pose


def _tail(*pitches: float) -> np.ndarray:
    tail = np.zeros((anatomy.TAIL_BONES, 2))
    tail[:, 0] = pitches
    return tail


def standing(root: Sequence[float]) -> Pose:
    """On four legs, tail in a loose curve upwards."""
    pose = Pose(root=np.array(root, float))
    pose.tail = _tail(-0.25, -0.20, -0.12, -0.08, -0.05, -0.05)
    return _placed_paws(pose, (0.076, -0.196, 0, 0.04, 0), (0.078, 0.268, 0, 0.06, 0))


def sitting(root: Sequence[float]) -> Pose:
    """On the haunches, forelegs straight, tail on the ground."""
    pose = Pose(root=np.array(root, float))
    pose.pelvis = np.array([0.0, 0.200, 0.158])
    pose.pelvis_turn[0] = -0.88
    pose.spine[:, 0] = (0.08, 0.12, 0.12)
    pose.neck[0] = 0.10
    pose.tail = _tail(0.42, 0.20, 0.10, 0.06, 0.0, 0.0)
    return _placed_paws(pose, (0.072, -0.205, 0, 0.06, 0), (0.112, 0.068, 0, 0.28, -1.02))


def lying(root: Sequence[float]) -> Pose:
    """On the belly, forelegs stretched ahead, head up."""
    pose = Pose(root=np.array(root, float))
    pose.pelvis = np.array([0.0, 0.255, 0.212])
    pose.pelvis_turn[0] = -0.03
    pose.spine[:, 0] = (0.0, 0.02, -0.06)
    pose.neck[0] = 0.05
    pose.tail = _tail(0.30, 0.10, 0.0, 0.0, 0.0, 0.0)
    return _placed_paws(pose, (0.092, -0.425, 0, 0.04, -1.32), (0.130, 0.110, 0, 0.25, -1.28))


def sniffing(root: Sequence[float]) -> Pose:
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


def solve(pose: Pose) -> dict[str, Matrix]:
    """Per bone its motion from rest, in the rig's space."""
    moved = trunk(pose)
    to_local = pose.world().inverted()
    for i, paw in enumerate(PAWS):
        _leg(moved, pose, i, paw, to_local)
    return moved


def trunk(pose: Pose) -> dict[str, Matrix]:
    """Motions of pelvis, spine, neck, head, jaw and tail."""
    rest = anatomy.joint
    pitch, roll, yaw = pose.pelvis_turn
    turn = Matrix.Rotation(yaw, 4, "Z") @ Matrix.Rotation(pitch, 4, "X") @ Matrix.Rotation(roll, 4, "Y")
    moved = {"pelvis": Matrix.Translation(pose.pelvis) @ turn @ Matrix.Translation(-rest("pelvis"))}
    parent = "pelvis"
    for bone, (pitch, yaw) in zip(SPINE, pose.spine, strict=True):
        bend = Matrix.Rotation(yaw, 4, "Z") @ Matrix.Rotation(pitch, 4, "X")
        moved[bone] = moved[parent] @ _about(rest(bone), bend)
        parent = bone
    pitch, yaw, roll = pose.head
    gaze = Matrix.Rotation(yaw, 4, "Z") @ Matrix.Rotation(pitch, 4, "X") @ Matrix.Rotation(roll, 4, "Y")
    head = gaze.to_quaternion()
    arch = Quaternion((1, 0, 0), pose.neck[0]) @ Quaternion((0, 0, 1), pose.neck[1])
    neck = keys.slerp(moved["chest"].to_quaternion(), head, 0.45) @ arch
    moved["neck"] = _put(moved["chest"] @ rest("neck"), neck, rest("neck"))
    moved["head"] = _put(moved["neck"] @ rest("skull"), head, rest("skull"))
    moved["jaw"] = moved["head"] @ _about(rest("jaw"), Matrix.Rotation(float(pose.jaw[0]), 4, "X"))
    parent = "pelvis"
    for i, (pitch, yaw) in enumerate(pose.tail):
        bend = Matrix.Rotation(yaw, 4, "Z") @ Matrix.Rotation(-pitch, 4, "X")
        moved[f"tail{i}"] = moved[parent] @ _about(rest(f"tail{i}"), bend)
        parent = f"tail{i}"
    return moved


def _leg(moved: dict[str, Matrix], pose: Pose, i: int, paw: str, to_local: Matrix) -> None:
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
        moved["scapula" + side] = carrier @ _about(anatomy.joint("scapula" + side), shrug)
        top = moved["scapula" + side] @ rest[0]
        pole = carrier.to_3x3() @ Vector((0.22 * out, 1.0, 0.0))
    else:
        carrier = moved["pelvis"]
        top = carrier @ rest[0]
        pole = carrier.to_3x3() @ Vector((0.20 * out, -1.0, 0.0)) + Vector((0.18 * out, -0.4, 0.35))
    middle, reached = _bend(top, ankle, rest, pole)
    rest_pole = Vector((0.0, 1.0 if kind == "fore" else -1.0, 0.0))
    points = (top, middle, reached)
    for k in range(2):
        before = _frame(rest[k + 1] - rest[k], rest_pole)
        after = _frame(points[k + 1] - points[k], pole)
        moved[bones[k] + side] = _put(points[k], (after @ before.transposed()).to_quaternion(), rest[k])
    moved[bones[2] + side] = _put(reached, shank.to_quaternion(), rest[2])
    moved[bones[3] + side] = _put(ball + (reached - ankle), toes.to_quaternion(), rest[3])


def _bend(top: Vector, end: Vector, rest: Sequence[Vector], pole: Vector) -> tuple[Vector, Vector]:
    """Middle joint and reachable end of a two-bone limb that bends towards `pole`."""
    upper, lower = (rest[1] - rest[0]).length, (rest[2] - rest[1]).length
    span = end - top
    length = min(max(span.length, 1.02 * abs(upper - lower)), 0.999 * (upper + lower))
    axis = span.normalized()
    along = (upper * upper - lower * lower + length * length) / (2 * length)
    height = math.sqrt(max(upper * upper - along * along, 0.0))
    return top + axis * along + (pole - pole.project(axis)).normalized() * height, top + axis * length


def _about(point: Vector, rotation: Matrix) -> Matrix:
    return Matrix.Translation(point) @ rotation @ Matrix.Translation(-point)


def _put(at: Vector, turn: Quaternion, rest: Vector) -> Matrix:
    return Matrix.Translation(at) @ turn.to_matrix().to_4x4() @ Matrix.Translation(-rest)


def _frame(direction: Vector, pole: Vector) -> Matrix:
    z = direction.normalized()
    x = pole.cross(z).normalized()
    return Matrix((x, z.cross(x), z)).transposed()
