"""From targets to bones: poses one anatomy at one frame.

A Stance says where pelvis, feet and hands shall be, in the body's own space (origin on the ground under it,
facing -Y); `Puppet.pose` answers with a matrix per bone. Limbs keep their lengths. Knows no time.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from ..assets.anatomy import FINGERS, SIDES, Anatomy, vec
from ..assets.garments import SKIRT_BONES, Skirt
from .ik import axes, between, turn_about, turn_x, turn_y, turn_z, twist_about, two_bone, unit

Bones = dict[str, tuple[np.ndarray, np.ndarray]]
SIGN = dict(SIDES)


@dataclass
class Foot:
    """Ankle position, heading and pitch (heel up is positive) of one foot."""

    ankle: np.ndarray
    yaw: float = 0.0
    pitch: float = 0.0
    toe: float = 0.0


@dataclass
class Reach:
    """Wrist position, hand rotation relative to rest (None: in line with the forearm) and fingers."""

    wrist: np.ndarray
    rotation: np.ndarray | None = None
    curl: float = 0.3
    index_curl: float | None = None
    pole: np.ndarray | None = None


@dataclass
class Stance:
    """Everything that a pose depends on at one frame."""

    pelvis: np.ndarray
    pelvis_yaw: float = 0.0
    pelvis_roll: float = 0.0
    bend: float = 0.0
    side_bend: float = 0.0
    twist: float = 0.0
    breath: float = 0.0
    gaze: tuple[float, float] = (0.0, 0.0)
    feet: dict[str, Foot] = field(default_factory=dict)
    hands: dict[str, Reach] = field(default_factory=dict)


class Puppet:
    """An anatomy ready to be posed."""

    def __init__(self, anatomy: Anatomy, skirt: Skirt | None) -> None:
        self.anatomy, self.skirt = anatomy, skirt
        j = self.joints = anatomy.joints
        self.leg = {
            s: (_gap(j, f"thigh_{s}", f"calf_{s}"), _gap(j, f"calf_{s}", f"foot_{s}")) for s, _ in SIDES
        }
        self.arm = {
            s: (_gap(j, f"upper_arm_{s}", f"forearm_{s}"), _gap(j, f"forearm_{s}", f"hand_{s}"))
            for s, _ in SIDES
        }
        self._rest_head = {bone.name: bone.head for bone in [*anatomy.bones, *(skirt.bones if skirt else [])]}
        self.hand_scale = 0.98 * anatomy.scale
        self._arm_rest = {
            s: axes(
                j[f"forearm_{s}"] - j[f"upper_arm_{s}"],
                np.cross(j[f"forearm_{s}"] - j[f"upper_arm_{s}"], vec(0, -1, 0)),
            )
            for s, _ in SIDES
        }
        self._thigh_rest = {s: axes(j[f"calf_{s}"] - j[f"thigh_{s}"], vec(1, 0, 0)) for s, _ in SIDES}
        self._calf_rest = {s: axes(j[f"foot_{s}"] - j[f"calf_{s}"], vec(1, 0, 0)) for s, _ in SIDES}

    # ---- questions about the body ----------------------------------------------------------------

    def hand_rotation(self, side: str, along: np.ndarray, palm: np.ndarray) -> np.ndarray:
        """Rotation from rest of a hand whose fingers point `along` and whose palm looks towards `palm`."""
        a0, m0, t0 = self.anatomy.hand_frame(side)
        a = unit(along)
        m = unit(palm - (palm @ a) * a)
        t = np.cross(a, m) * -SIGN[side]
        return np.stack([a, m, t], axis=1) @ np.stack([a0, m0, t0], axis=1).T

    def grip_offset(self, side: str, rotation: np.ndarray) -> np.ndarray:
        """From the wrist to the middle of a bar that the hand grips."""
        along, palm, _ = self.anatomy.hand_frame(side)
        return rotation @ (self.hand_scale * (0.094 * along + 0.024 * palm))

    def palm_offset(self, side: str, rotation: np.ndarray) -> np.ndarray:
        """From the wrist to the surface of the open palm under the knuckles."""
        along, palm, _ = self.anatomy.hand_frame(side)
        return rotation @ (self.hand_scale * (0.085 * along + 0.016 * palm))

    def torso(self, stance: Stance) -> Bones:
        """Placed joints and rotations of pelvis, spine and chest."""
        j = self.joints
        pelvis = turn_z(stance.pelvis_yaw) @ turn_x(0.38 * stance.bend) @ turn_y(stance.pelvis_roll)
        step = (
            turn_z(0.5 * (stance.twist - stance.pelvis_yaw))
            @ turn_x(0.31 * stance.bend)
            @ turn_y(0.5 * stance.side_bend - 0.5 * stance.pelvis_roll)
        )
        spine = pelvis @ step
        chest = spine @ step @ turn_x(-stance.breath)
        at_spine = stance.pelvis + pelvis @ (j["spine"] - j["root"])
        at_chest = at_spine + spine @ (j["chest"] - j["spine"])
        return {"pelvis": (stance.pelvis, pelvis), "spine": (at_spine, spine), "chest": (at_chest, chest)}

    def shoulder(self, stance: Stance, side: str) -> np.ndarray:
        """Where the shoulder joint is before the collarbone helps the arm to reach."""
        at, chest = self.torso(stance)["chest"]
        return at + chest @ (self.joints[f"upper_arm_{side}"] - self.joints["chest"])

    def hip(self, stance: Stance, side: str) -> np.ndarray:
        """Where the hip joint is."""
        at, pelvis = self.torso(stance)["pelvis"]
        return at + pelvis @ (self.joints[f"thigh_{side}"] - self.joints["root"])

    # ---- the pose --------------------------------------------------------------------------------

    def pose(self, stance: Stance) -> dict[str, np.ndarray]:
        """Deformation of every bone: a 4x4 matrix that moves the rest pose to the pose."""
        bones = self.torso(stance)
        self._pose_head(bones, stance)
        for side, _ in SIDES:
            self._pose_leg(bones, stance.feet[side], side)
            self._pose_arm(bones, stance.hands[side], side)
        if self.skirt:
            self._pose_skirt(bones)
        return {name: _matrix(self._rest_head[name], *placed) for name, placed in bones.items()}

    def _pose_head(self, bones: Bones, stance: Stance) -> None:
        j = self.joints
        at, chest = bones["chest"]
        yaw, pitch = stance.gaze
        facing = turn_z(yaw) @ turn_x(pitch)
        neck_at = at + chest @ (j["neck"] - j["chest"])
        neck = between(chest, facing, 0.42)
        bones["neck"] = (neck_at, neck)
        bones["head"] = (neck_at + neck @ (j["head"] - j["neck"]), facing)

    def _pose_leg(self, bones: Bones, foot: Foot, side: str) -> None:
        j = self.joints
        at, pelvis = bones["pelvis"]
        hip = at + pelvis @ (j[f"thigh_{side}"] - j["root"])
        sole = turn_z(foot.yaw)
        spread = 0.12 + 0.9 * max(0.0, 0.75 * sum(self.leg[side]) - float(np.linalg.norm(foot.ankle - hip)))
        pole = sole @ vec(SIGN[side] * spread, -1.0, 0.0) + 0.35 * (pelvis @ vec(0, -1, 0)) + vec(0, 0, 0.25)
        knee, ankle, hinge = two_bone(hip, foot.ankle, *self.leg[side], pole)
        thigh = axes(knee - hip, hinge) @ self._thigh_rest[side].T
        calf = axes(ankle - knee, hinge) @ self._calf_rest[side].T
        foot_r = sole @ turn_x(foot.pitch)
        ball = ankle + foot_r @ (j[f"toe_{side}"] - j[f"foot_{side}"])
        bones[f"thigh_{side}"] = (hip, thigh)
        bones[f"hip_{side}"] = (hip, between(pelvis, thigh, 0.5))
        bones[f"calf_{side}"] = (knee, calf)
        bones[f"knee_{side}"] = (knee, between(thigh, calf, 0.5))
        bones[f"foot_{side}"] = (ankle, foot_r)
        bones[f"toe_{side}"] = (ball, foot_r @ turn_x(-foot.toe))

    def _pose_arm(self, bones: Bones, reach: Reach, side: str) -> None:
        j, s = self.joints, SIGN[side]
        at, chest = bones["chest"]
        collar = at + chest @ (j[f"clavicle_{side}"] - j["chest"])
        arm_rest = j[f"upper_arm_{side}"] - j[f"clavicle_{side}"]
        way = chest.T @ (reach.wrist - collar - chest @ arm_rest) / sum(self.arm[side])
        lift = 0.42 * float(np.clip(way[2] + 0.45, 0.0, 1.4)) - 0.02
        ahead = 0.30 * float(np.clip(-way[1] - 0.25, 0.0, 1.0)) + 0.25 * float(np.clip(-s * way[0], 0.0, 0.6))
        clavicle = chest @ turn_y(-s * lift) @ turn_z(-s * ahead)
        shoulder = collar + clavicle @ arm_rest
        pole = reach.pole if reach.pole is not None else chest @ vec(s * 0.55, 0.75, -0.55)
        elbow, wrist, hinge = two_bone(shoulder, reach.wrist, *self.arm[side], pole)
        upper = axes(elbow - shoulder, hinge) @ self._arm_rest[side].T
        fore = axes(wrist - elbow, hinge) @ self._arm_rest[side].T
        hand = fore if reach.rotation is None else reach.rotation
        along, _, _ = self.anatomy.hand_frame(side)
        twist = twist_about(fore.T @ hand, along)
        upper = upper @ turn_about(along, 0.25 * twist)
        fore_near = fore @ turn_about(along, 0.25 * twist)
        bones[f"clavicle_{side}"] = (collar, clavicle)
        bones[f"upper_arm_{side}"] = (shoulder, upper)
        bones[f"shoulder_{side}"] = (shoulder, between(clavicle, upper, 0.5))
        bones[f"forearm_{side}"] = (elbow, fore_near)
        bones[f"elbow_{side}"] = (elbow, between(upper, fore_near, 0.5))
        bones[f"wrist_{side}"] = (elbow, fore @ turn_about(along, 0.8 * twist))
        bones[f"hand_{side}"] = (wrist, hand)
        self._pose_fingers(bones, reach, side)

    def _pose_fingers(self, bones: Bones, reach: Reach, side: str) -> None:
        at, hand = bones[f"hand_{side}"]
        along, palm, thumb = self.anatomy.hand_frame(side)
        hinge = np.cross(along, palm)
        for n, finger in enumerate(FINGERS):
            curl = reach.index_curl if finger == "index" and reach.index_curl is not None else reach.curl
            curl = curl * (1.0 + 0.07 * n) if curl < 0.6 else curl
            first = hand @ turn_about(hinge, 1.30 * curl)
            self._place_finger(bones, finger, side, at, hand, first, first @ turn_about(hinge, 1.75 * curl))
        close = turn_about(hinge, 0.55 * reach.curl) @ turn_about(
            along, self._thumb_sign(side) * 0.55 * reach.curl
        )
        first = hand @ close
        self._place_finger(
            bones,
            "thumb",
            side,
            at,
            hand,
            first,
            first @ turn_about(np.cross(along + 0.6 * thumb, palm - 0.6 * thumb), 0.75 * reach.curl),
        )

    def _thumb_sign(self, side: str) -> float:
        along, palm, thumb = self.anatomy.hand_frame(side)
        return 1.0 if np.cross(along, thumb) @ palm > 0.0 else -1.0

    def _place_finger(
        self,
        bones: Bones,
        finger: str,
        side: str,
        at: np.ndarray,
        hand: np.ndarray,
        first: np.ndarray,
        second: np.ndarray,
    ) -> None:
        j = self.joints
        base = at + hand @ (j[f"{finger}_1_{side}"] - j[f"hand_{side}"])
        bones[f"{finger}_1_{side}"] = (base, first)
        bones[f"{finger}_2_{side}"] = (
            base + first @ (j[f"{finger}_2_{side}"] - j[f"{finger}_1_{side}"]),
            second,
        )

    def _pose_skirt(self, bones: Bones) -> None:
        """Skirt bones hang down and swing out just as far as the legs push them."""
        assert self.skirt is not None
        at, pelvis = bones["pelvis"]
        k = self.anatomy.scale
        upright = between(pelvis, turn_z(float(np.arctan2(pelvis[1, 0], pelvis[0, 0]))), 0.75)
        samples = []
        for side, _ in SIDES:
            hip, knee, ankle = (bones[f"{n}_{side}"][0] for n in ("thigh", "calf", "foot"))
            samples += [(hip + t * (knee - hip), (0.092 - 0.030 * t) * k) for t in np.linspace(0.2, 1.08, 9)]
            samples += [
                (knee + t * (ankle - knee), (0.066 - 0.016 * t) * k) for t in np.linspace(0.1, 0.85, 6)
            ]
        points = (np.array([p for p, _ in samples]) - at) @ upright
        radii = np.array([r for _, r in samples]) + 0.016 * k
        rest = {bone.name: bone for bone in self.skirt.bones}
        turns = 2.0 * np.pi * np.arange(SKIRT_BONES) / SKIRT_BONES
        root = self.joints["root"]
        tops = [upright.T @ pelvis @ (rest[f"skirt_{n}_1"].head - root) for n in range(SKIRT_BONES)]
        first = np.array(
            [_push(points, radii, tops[n], t, rest[f"skirt_{n}_1"]) for n, t in enumerate(turns)]
        )
        first = _taut(first)
        hinges = [np.cross(vec(0, 0, -1), vec(np.sin(t), -np.cos(t), 0)) for t in turns]
        mids = [
            tops[n]
            + turn_about(hinges[n], first[n]) @ (rest[f"skirt_{n}_2"].head - rest[f"skirt_{n}_1"].head)
            for n in range(SKIRT_BONES)
        ]
        second = np.array(
            [_push(points, radii, mids[n], t, rest[f"skirt_{n}_2"]) for n, t in enumerate(turns)]
        )
        second = _taut(np.maximum(second, 0.30 * first))
        for n in range(SKIRT_BONES):
            bones[f"skirt_{n}_1"] = (at + upright @ tops[n], upright @ turn_about(hinges[n], first[n]))
            bones[f"skirt_{n}_2"] = (at + upright @ mids[n], upright @ turn_about(hinges[n], second[n]))


def _taut(angles: np.ndarray) -> np.ndarray:
    """Cloth between pushed ribs is pulled along with its neighbours."""
    beside = 0.5 * (np.roll(angles, 1) + np.roll(angles, -1))
    return np.maximum(angles, 0.68 * angles + 0.32 * beside)


def _push(points: np.ndarray, radii: np.ndarray, anchor: np.ndarray, turn: float, bone) -> float:
    """How far (radians) a skirt bone must swing out so that no ball of a leg pokes through beside it.

    Points are relative to the pelvis, upright. A rib feels every ball near its panel: cloth is taut.
    """
    flat = np.hypot(points[:, 0], points[:, 1])
    away = np.arctan2(points[:, 0], -points[:, 1]) - turn
    away = np.abs((away + np.pi) % (2.0 * np.pi) - np.pi)
    panel = 2.0 * np.pi / SKIRT_BONES
    facing = np.cos(np.maximum(away - 0.5 * panel, 0.0))
    ahead = flat * facing * 1.03 - np.hypot(anchor[0], anchor[1])
    below = anchor[2] - points[:, 2]
    rib = bone.tail - bone.head
    length = float(np.linalg.norm(rib))
    gap = np.hypot(ahead, below)
    near = (
        (away < 1.4 * panel + np.arcsin(np.clip(radii / np.maximum(flat, 1e-6), 0.0, 0.5)))
        & (gap < 1.3 * length + radii)
        & ((below > 0.0) | (ahead > 0.10))
    )
    if not near.any():
        return 0.0
    rest_angle = float(np.arctan2(np.hypot(rib[0], rib[1]), -rib[2]))
    tangent = np.arcsin(np.clip(radii[near] / np.maximum(gap[near], 1e-6), 0.0, 0.95))
    needed = np.arctan2(ahead[near], below[near]) + tangent - rest_angle
    weight = np.clip((gap[near] - 0.02) / (0.30 * length), 0.0, 1.0)
    return float(np.clip((needed * weight).max(), 0.0, 1.5))


def _matrix(rest_head: np.ndarray, head: np.ndarray, rotation: np.ndarray) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, :3] = rotation
    matrix[:3, 3] = head - rotation @ rest_head
    return matrix


def _gap(joints: dict[str, np.ndarray], a: str, b: str) -> float:
    return float(np.linalg.norm(joints[b] - joints[a]))
