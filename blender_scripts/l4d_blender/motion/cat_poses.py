"""How a cat holds itself: postures that can be blended, and the bones that follow from them.

A `CatPose` says where pelvis, spine, head, tail, ears and paws are; `solve` turns it into a motion per
bone. Knows no time and no verbs; angles as in quadrupeds.py.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from mathutils import Matrix, Vector

from ..assets import cat_anatomy as anatomy
from .limbs import about, carried, two_bones, untwisted
from .quadrupeds import PAWS, Pose, mirrored, move_chain, move_head, move_pelvis, zeros

SPINE = ("lumbar", "loin", "back", "withers", "chest")
PAW_TIP_RADIUS_M = 0.0155


@dataclass
class CatPose(Pose):
    """Everything that can be blended; `spine` rows are rotation vectors, tail rows pitch and yaw."""

    pelvis: np.ndarray = field(default_factory=lambda: np.array(anatomy.JOINTS["pelvis"]))
    spine: np.ndarray = field(default_factory=zeros(5, 3))
    tail: np.ndarray = field(default_factory=zeros(anatomy.TAIL_BONES, 2))
    ears: np.ndarray = field(default_factory=zeros(2))
    lids: np.ndarray = field(default_factory=zeros(1))
    breath: np.ndarray = field(default_factory=zeros(1))


def _tail(pitches: Sequence[float], yaws: Sequence[float]) -> np.ndarray:
    return np.stack([np.asarray(pitches, float), np.asarray(yaws, float)], axis=1)


def _ramp(first: float, last: float) -> np.ndarray:
    return np.linspace(first, last, anatomy.TAIL_BONES)


def standing(root: np.ndarray, floor: float) -> CatPose:
    """Alert on four legs, tail low with its tip up."""
    pose = CatPose(root=np.array(root, float), floor=np.array([floor]))
    pose.neck[0] = 0.25
    pose.head[0] = 0.06
    pose.tail = _tail([-0.55, -0.25, -0.05, 0.1, 0.2, 0.25, 0.25, 0.25, 0.2], _ramp(0.0, 0.1))
    return pose.put_paws(mirrored((0.036, -0.128, 0, 0, 0.05, 0), (0.041, 0.150, 0, 0, 0.08, 0)))


def sitting(root: np.ndarray, floor: float, tail_side: float = 1.0) -> CatPose:
    """Upright on the haunches, hind feet flat beside the straight front legs, tail laid round one flank."""
    pose = CatPose(root=np.array(root, float), floor=np.array([floor]))
    pose.pelvis = np.array([0.0, 0.110, 0.078])
    pose.pelvis_turn[0] = -0.92
    pose.spine[:, 0] = (0.12, 0.14, 0.10, 0.02, -0.05)
    pose.neck[0] = 0.10
    pose.head[0] = 0.05
    pose.tail = _tail(
        [0.62, 0.30, 0.16, 0.06, 0.0, 0.0, 0.0, 0.0, 0.0],
        tail_side * np.array([0.35, 0.40, 0.42, 0.42, 0.40, 0.36, 0.30, 0.26, 0.2]),
    )
    return pose.put_paws(mirrored((0.030, -0.098, 0, 0, 0.08, 0), (0.068, 0.020, 0, 0, 0.30, -1.0)))


def crouching(root: np.ndarray, floor: float) -> CatPose:
    """Low in front, haunches bunched, head forward: a cat about to play."""
    pose = CatPose(root=np.array(root, float), floor=np.array([floor]))
    pose.pelvis = np.array([0.0, 0.120, 0.135])
    pose.pelvis_turn[0] = 0.10
    pose.spine[:, 0] = (-0.12, 0.02, 0.06, 0.02, -0.04)
    pose.neck[0] = 0.55
    pose.head[0] = 0.30
    pose.tail = _tail([-0.95, 0.35, 0.28, 0.16, 0.06, 0.02, 0.06, 0.1, 0.1], _ramp(0.15, 0.25))
    return pose.put_paws(mirrored((0.042, -0.150, 0, 0, 0.05, 0), (0.062, 0.075, 0, 0, 0.15, -0.75)))


def poised(root: np.ndarray, floor: float) -> CatPose:
    """Half sitting on bunched haunches, chest low enough for a paw to reach ahead: how a cat bats things."""
    pose = CatPose(root=np.array(root, float), floor=np.array([floor]))
    pose.pelvis = np.array([0.0, 0.120, 0.098])
    pose.pelvis_turn[0] = -0.52
    pose.spine[:, 0] = (0.02, 0.10, 0.12, 0.06, 0.0)
    pose.neck[0] = 0.12
    pose.head[0] = 0.45
    pose.tail = _tail([0.10, 0.25, 0.16, 0.06, 0.02, 0.02, 0.06, 0.1, 0.1], _ramp(0.2, 0.3))
    return pose.put_paws(mirrored((0.040, -0.158, 0, 0, 0.05, 0), (0.066, 0.045, 0, 0, 0.25, -0.95)))


def curled(root: np.ndarray, floor: float) -> CatPose:
    """Asleep in a ring on the left side of its spine: nose to tail, paws inside, eyes shut."""
    pose = CatPose(root=np.array(root, float), floor=np.array([floor]))
    roll, turn = -0.95, 0.53
    pose.pelvis = np.array([-0.055, 0.105, 0.080])
    pose.pelvis_turn = np.array([0.0, roll, -0.75])
    pose.spine[:, 0], pose.spine[:, 2] = -turn * math.sin(roll), turn * math.cos(roll)
    pose.neck[:] = (0.15, 0.0)
    pose.head = np.array([0.25, 3.0, -0.25])
    bend = np.array([0.10, 0.34, 0.36, 0.36, 0.36, 0.36, 0.36, 0.3, 0.3])
    pose.tail = _tail(bend * math.sin(roll), -bend * math.cos(roll))
    pose.tail[0, 0] -= 0.25
    pose.ears[:] = 0.25
    pose.lids[0] = 1.0
    return pose.put_paws(
        {
            "fore.L": (0.075, -0.050, 0.02, 0.2, 0.9, 0),
            "fore.R": (0.050, -0.020, 0.015, 0.2, 1.2, 0),
            "hind.L": (0.070, 0.030, 0.02, 0, 0.4, -0.9),
            "hind.R": (0.045, 0.010, 0.015, 0, 0.5, -0.9),
        }
    )


POSTURES = {"stand": standing, "crouch": crouching, "poise": poised, "sleep": curled}


def body(pose: CatPose) -> dict[str, Matrix]:
    """Motions of trunk, neck, head, tail, ears and lids from rest, in the rig's space."""
    joint = anatomy.joint
    moved = {"pelvis": move_pelvis(pose, joint)}
    move_chain(moved, "pelvis", {bone: _rotation(bend) for bone, bend in zip(SPINE, pose.spine)}, joint)
    move_head(moved, pose, joint)
    tail = {f"tail{i}": _rotation((pitch, 0.0, yaw)) for i, (pitch, yaw) in enumerate(pose.tail)}
    move_chain(moved, "pelvis", tail, joint)
    for k, side in enumerate((".L", ".R")):
        ear = _rotation((0.5 * pose.ears[k], 0.0, (1 if k == 0 else -1) * 0.5 * pose.ears[k]))
        moved["ear" + side] = moved["head"] @ about(joint("ear" + side), ear)
        lid = _rotation((-0.62 + 1.80 * float(pose.lids[0]), 0.0, 0.0))
        moved["lid" + side] = moved["head"] @ about(joint("eye" + side), lid)
    return moved


def solve(pose: CatPose) -> dict[str, Matrix]:
    """Motions of all bones from rest, in the rig's space."""
    moved = body(pose)
    to_local = pose.world().inverted()
    for i, paw in enumerate(PAWS):
        kind, side = paw.split(".")
        x, y, z, pitch, yaw, heel = pose.paws[i]
        pad = to_local @ Vector((x, y, z + toe_lift(pitch)))
        turn = Matrix.Rotation(yaw - pose.root[2], 3, "Z")
        if kind == "fore":
            _foreleg(moved, "." + side, pad, turn @ Matrix.Rotation(pitch, 3, "X"))
        else:
            _hindleg(moved, "." + side, pad, turn, pitch, heel)
    swell = 0.0022 * float(pose.breath[0])
    for bone, share in (("back", 0.8), ("withers", 1.0), ("loin", 0.6)):
        moved[bone] = Matrix.Translation((0, 0, swell * share)) @ moved[bone]
    return moved


def _foreleg(moved: dict[str, Matrix], side: str, pad: Vector, turn: Matrix) -> None:
    rest = [anatomy.joint(name + side) for name in ("shoulder", "elbow", "wrist", "forepaw")]
    wrist = pad + turn @ (rest[2] - rest[3])
    carrier = moved["withers"]
    reach = (carrier.inverted() @ pad).y - rest[3].y
    shrug = max(-0.5, min(0.45, 2.6 * reach))
    scapula = carrier @ about(anatomy.joint("scapula" + side), _rotation((shrug, 0.0, 0.0)))
    moved["scapula" + side] = scapula
    back = carrier.to_3x3() @ Vector((0.18 if side == ".L" else -0.18, 1.0, 0.0))
    wrist = _limb(moved, side, ("upperarm", "forearm"), rest, scapula @ rest[0], wrist, back, 1.0)
    moved["forepaw" + side] = carried(wrist, turn.to_quaternion(), rest[2])


def _hindleg(
    moved: dict[str, Matrix], side: str, pad: Vector, turn: Matrix, pitch: float, heel: float
) -> None:
    rest = [anatomy.joint(name + side) for name in ("hip", "knee", "hock", "hindpaw")]
    shank = turn @ Matrix.Rotation(heel + pitch, 3, "X")
    hock = pad + shank @ (rest[2] - rest[3])
    pelvis = moved["pelvis"]
    outward = 0.16 if side == ".L" else -0.16
    forward = pelvis.to_3x3() @ Vector((outward, -1.0, 0.0)) + Vector((outward, -0.4, 0.3))
    reached = _limb(moved, side, ("thigh", "shin"), rest, pelvis @ rest[0], hock, forward, -1.0)
    moved["hindpaw" + side] = carried(reached, shank.to_quaternion(), rest[2])
    toes = turn @ Matrix.Rotation(pitch, 3, "X")
    moved["hindtoe" + side] = carried(pad + (reached - hock), toes.to_quaternion(), rest[3])


def _limb(
    moved: dict[str, Matrix],
    side: str,
    bones: tuple[str, str],
    rest: Sequence[Vector],
    top: Vector,
    end: Vector,
    pole: Vector,
    rest_pole_y: float,
) -> Vector:
    """Two bones from `top` to `end`; returns the end that they reach."""
    lengths = (rest[1] - rest[0]).length, (rest[2] - rest[1]).length
    middle, reached = two_bones(top, end, *lengths, pole)
    motions = untwisted(rest[:3], (top, middle, reached), Vector((0.0, rest_pole_y, 0.0)), pole)
    for bone, motion in zip(bones, motions):
        moved[bone + side] = motion
    return reached


def toe_lift(pitch: float) -> float:
    """How far the pad rises when the paw rolls over its toes."""
    return 0.030 * math.sin(pitch) if pitch > 0 else 0.0


def _rotation(vector: Sequence[float]) -> Matrix:
    angle = math.sqrt(sum(x * x for x in vector))
    return Matrix.Rotation(angle, 4, Vector(vector)) if angle > 1e-12 else Matrix.Identity(4)
