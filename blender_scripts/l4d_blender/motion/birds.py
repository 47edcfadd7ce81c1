"""What hens, gulls and ducks have in common: a pose, the bones that follow from it, feet that stay planted.

A `Bird` plans a pose per canonical frame; its calls follow one another in time and cover the whole clip. Legs
and neck are two-bone reaches. Feet are planned on level ground at the bird's own height.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

import bpy
from mathutils import Matrix, Vector

from ..scene import keys
from ..scene.scene import Scene
from ..scene.timeline import LAST_FRAME
from .limbs import segment, two_bones

SIDES = ("left", "right")
_STRETCHED = 0.998  # share of its length to which a leg or a neck stretches

Row = tuple[float, ...]
Joint = Callable[..., Vector]
Landings = dict[str, list[tuple[float, Vector, float]]]
"""Per foot the (step count at landing, spot, yaw) of each touch-down, first where it stands."""


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


def body_motion(joint: Joint, pose: Pose) -> Matrix:
    """How far the trunk has gone from rest."""
    pivot = joint("pivot")
    return (
        Matrix.Translation(pivot - Vector((0.0, 0.0, pose.drop_m)))
        @ Matrix.Rotation(pose.roll, 4, "Y")
        @ Matrix.Rotation(pose.pitch, 4, "X")
        @ Matrix.Translation(-pivot)
    )


def solve(joint: Joint, pose: Pose, neck_pole: Vector) -> dict[str, Matrix]:
    """Motions of body, neck, head and legs from rest, in the rig's space; the neck bends towards its pole."""
    body = body_motion(joint, pose)
    moved = {"body": body}
    low, mid, top = (joint(name) for name in ("neck_low", "neck_mid", "neck_top"))
    lengths = (mid - low).length, (top - mid).length
    now_low = body @ low
    now_mid, now_top = two_bones(now_low, pose.head, *lengths, neck_pole, _STRETCHED)
    moved["neck_low"] = segment(low, mid, now_low, now_mid)
    moved["neck_high"] = segment(mid, top, now_mid, now_top)
    gaze = Matrix.Rotation(pose.head_yaw, 4, "Z") @ Matrix.Rotation(pose.head_pitch, 4, "X")
    moved["head"] = Matrix.Translation(now_top) @ gaze @ Matrix.Translation(-top)
    for side in SIDES:
        hip, hock, ankle = (joint(name, side) for name in ("hip", "hock", "ankle"))
        lengths = (hock - hip).length, (ankle - hock).length
        now_hip, back = body @ hip, Vector((0.0, 1.0, 0.2))
        now_hock, now_ankle = two_bones(now_hip, pose.ankles[side], *lengths, back, _STRETCHED)
        moved[f"thigh_{side}"] = segment(hip, hock, now_hip, now_hock)
        moved[f"shank_{side}"] = segment(hock, ankle, now_hock, now_ankle)
        set_down = Matrix.Rotation(pose.foot_yaw[side], 4, "Z") @ Matrix.Rotation(
            pose.foot_pitch[side], 4, "X"
        )
        moved[f"foot_{side}"] = Matrix.Translation(now_ankle) @ set_down @ Matrix.Translation(-ankle)
    return moved


class Bird:
    """Plays one bird through the clip: each call continues where the last one ended; `finish` keys it."""

    STEP_LIFT = (0.026, 0.6)  # of a swinging foot: metres, curl in radians
    TRACK = 0.75  # how far from the middle line feet are set down, as a share of how they stand
    STANCE_DROP_M = 0.003
    GLANCE: tuple[tuple[int, int], int, tuple[int, int]]  # frames: before the first, a turn, a rest
    GLANCE_RAD: tuple[float, float, float]  # most yaw, least and most pitch
    BREATH: tuple[float, float]  # metres and frames

    def __init__(
        self,
        scene: Scene,
        name: str,
        id: int,
        category: str,
        body: bpy.types.Object,
        attributes: Mapping[str, str],
        joint: Joint,
        at: Sequence[float],
        heading_deg: float,
    ) -> None:
        self.instance = scene.instance(
            name, id, category, body, attributes=attributes, front="-y", frame_object=body.parent
        )
        self._joint, self._rig, self._rng = joint, body.parent, scene.rng(f"{name}/acts")
        self._position, self._heading = Vector(at).to_3d(), math.radians(heading_deg)
        self._roots: dict[int, Matrix] = {}
        self._poses: dict[int, Pose] = {}
        self._plant_feet()

    def stand(self, first: int, last: int) -> None:
        """Stands and looks about in the quick turns of a bird."""
        self._idle(first, last)
        self.instance.scene.event(self.instance, "stand", (first, last))

    def finish(self) -> None:
        """Keys the rig and its bones; the calls so far must have covered the whole clip."""
        missing = [frame for frame in range(LAST_FRAME + 1) if frame not in self._poses]
        if missing:
            raise ValueError(f"{self.instance.name} has nothing to do at frame {missing[0]}")
        rest = {bone.name: bone.matrix_local.copy() for bone in self._rig.data.bones}
        poses = {
            frame: {bone: moved @ rest[bone] for bone, moved in self._solve(pose).items()}
            for frame, pose in self._poses.items()
        }
        keys.key_matrices(self._rig, self._roots)
        keys.key_bones(self._rig, poses, space="armature")

    def _solve(self, pose: Pose) -> dict[str, Matrix]:
        """Motions of all bones from rest, in the rig's space."""
        raise NotImplementedError

    def _root(self) -> Matrix:
        return Matrix.Translation(self._position) @ Matrix.Rotation(self._heading, 4, "Z")

    def _put(self, frame: int, pose: Pose) -> None:
        self._roots[frame], self._poses[frame] = self._root(), pose

    def _plant_feet(self) -> None:
        root = self._root()
        self._feet = {side: (root @ self._joint("ankle", side), self._heading) for side in SIDES}

    def _standing(self) -> Pose:
        inside = self._root().inverted()
        return Pose(
            ankles={side: inside @ spot for side, (spot, _) in self._feet.items()},
            head=self._joint("neck_top"),
            foot_yaw={
                side: math.remainder(yaw - self._heading, 2 * math.pi)
                for side, (_, yaw) in self._feet.items()
            },
            drop_m=self.STANCE_DROP_M,
        )

    def _idle(self, first: int, last: int) -> None:
        glances = self._glances(first, last)
        amount, period = self.BREATH
        for frame in range(first, last + 1):
            pose = self._standing()
            pose.head_yaw, pose.head_pitch = on_keys(glances, frame)
            pose.drop_m += amount * math.sin(2 * math.pi * frame / period)
            self._put(frame, pose)

    def _glances(self, first: int, last: int) -> list[tuple[int, Row]]:
        """Yaw and pitch of the head: a quick turn, then the head rests."""
        before, turn, rest = self.GLANCE
        most_yaw, least_pitch, most_pitch = self.GLANCE_RAD
        glances: list[tuple[int, Row]] = [(first, (0.0, 0.0))]
        at = first + self._rng.randint(*before)
        while at + 14 < last:
            glances.append((at, glances[-1][1]))
            aim = self._rng.uniform(-most_yaw, most_yaw), self._rng.uniform(least_pitch, most_pitch)
            glances.append((at + turn, aim))
            at += turn + self._rng.randint(*rest)
        return [*glances, (max(last - 6, at), glances[-1][1]), (max(last, at + 1), (0.0, 0.0))]

    def _landings(self, path: keys.Path, steps: int, stride: float) -> Landings:
        """Where the feet come down along a path."""
        landings = {side: [(-1.0, *self._feet[side])] for side in SIDES}
        for k in range(steps):
            side = SIDES[k % 2]
            s = min(path.length, (k + 1.5) * stride)
            yaw = heading_on(path, s)
            there = Matrix.Translation(path.point(s)) @ Matrix.Rotation(yaw, 4, "Z")
            ankle = self._joint("ankle", side)
            ankle.x *= self.TRACK
            landings[side].append((k + 1.0, there @ ankle, yaw))
        return landings

    def _set_feet(self, pose: Pose, landings: Landings, steps_done: float) -> None:
        """Feet on their way between touch-downs, after `steps_done` steps of both feet."""
        inside = self._root().inverted()
        for side in SIDES:
            spot, yaw, lift, curl = self._foot(landings[side], steps_done)
            pose.ankles[side] = inside @ spot + Vector((0.0, 0.0, lift))
            pose.foot_yaw[side] = math.remainder(yaw - self._heading, 2 * math.pi)
            pose.foot_pitch[side] = curl

    def _foot(
        self, landings: list[tuple[float, Vector, float]], steps_done: float
    ) -> tuple[Vector, float, float, float]:
        """(spot, yaw, lift in metres, curl in radians) of a foot."""
        lift, curl = self.STEP_LIFT
        for (_, spot, yaw), (landing, next_spot, next_yaw) in zip(landings, landings[1:], strict=False):
            if steps_done < landing:
                u = steps_done - (landing - 1.0)
                if u <= 0.0:
                    return spot, yaw, 0.0, 0.0
                t, swing = keys.ease(u), math.sin(math.pi * u) ** 2
                turn = math.remainder(next_yaw - yaw, 2 * math.pi)
                return spot.lerp(next_spot, t), yaw + t * turn, lift * swing, curl * swing
        _, spot, yaw = landings[-1]
        return spot, yaw, 0.0, 0.0


def heading_on(path: keys.Path, s: float) -> float:
    """The heading along a path after `s` metres (radians)."""
    along = path.tangent(s)
    return math.atan2(along.x, -along.y)


def even(t: float, ramp: float) -> float:
    """Distance share at a time share: eased start and stop, even pace between."""
    t = min(1.0, max(0.0, t))
    if t < ramp:
        return 0.5 * t * t / ramp / (1.0 - ramp)
    if t > 1.0 - ramp:
        return 1.0 - 0.5 * (1.0 - t) ** 2 / ramp / (1.0 - ramp)
    return (t - 0.5 * ramp) / (1.0 - ramp)


def on_keys(points: Sequence[tuple[int, Row]], frame: int) -> Row:
    """Values at a frame between eased keys (frame, values)."""
    for (a, before), (b, after) in zip(points, points[1:], strict=False):
        if frame <= b:
            t = keys.ease_between(frame, a, b) if b > a else 1.0
            return tuple(x + (y - x) * t for x, y in zip(before, after, strict=True))
    return points[-1][1]
