"""What cats and dogs have in common: poses that blend, paws that stay planted, gaits, heads that follow.

A `Quadruped` holds one pose per canonical frame; actions change the poses from their first frame on and
record what they show. Paws are kept in the world, so that a planted paw stays where it is whatever the body
does.

Body frame: -Y forward, +X left, +Z up; positive pitch lowers the nose, positive yaw turns left; radians.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import ClassVar, Generic, Protocol, Self, TypeVar

import bpy
import numpy as np
from mathutils import Matrix, Quaternion, Vector

from ..scene import keys
from ..scene.scene import Instance, Scene
from ..scene.timeline import FRAME_COUNT
from .limbs import about, carried

PAWS = ("fore.L", "fore.R", "hind.L", "hind.R")
STEP_ORDER = ("fore.L", "hind.R", "fore.R", "hind.L")

Frames = tuple[int, int]
Joint = Callable[[str], Vector]


def zeros(*shape: int) -> Callable[[], np.ndarray]:
    """A default for a field of a pose."""
    return lambda: np.zeros(shape)


@dataclass
class Pose:
    """`root` x, y, heading; `floor` z; paws: world x, y, z of the pad, toe pitch, yaw, heel."""

    root: np.ndarray = field(default_factory=zeros(3))
    floor: np.ndarray = field(default_factory=zeros(1))
    pelvis: np.ndarray = field(default_factory=zeros(3))
    pelvis_turn: np.ndarray = field(default_factory=zeros(3))
    neck: np.ndarray = field(default_factory=zeros(2))
    head: np.ndarray = field(default_factory=zeros(3))
    paws: np.ndarray = field(default_factory=zeros(4, 6))

    def copy(self) -> Self:
        """A pose of its own with the same numbers."""
        return type(self)(**{key: value.copy() for key, value in vars(self).items()})

    def blended(self, other: Self, t: float) -> Self:
        """The pose at `t` (0..1) between this one and another."""
        mixed = {key: (1 - t) * value + t * getattr(other, key) for key, value in vars(self).items()}
        return type(self)(**mixed)

    def world(self) -> Matrix:
        """World matrix of the body frame."""
        x, y, heading = self.root
        return Matrix.Translation((x, y, self.floor[0])) @ Matrix.Rotation(heading, 4, "Z")

    def put_paws(self, local: Mapping[str, Sequence[float]]) -> Self:
        """Puts the paws at (x, y, z, pitch, yaw, heel) of the body frame."""
        world = self.world()
        for i, paw in enumerate(PAWS):
            x, y, z, pitch, yaw, heel = local[paw]
            self.paws[i] = (*(world @ Vector((x, y, z))), pitch, self.root[2] + yaw, heel)
        return self


AnyPose = TypeVar("AnyPose", bound=Pose)


def mirrored(fore: Sequence[float], hind: Sequence[float]) -> dict[str, Sequence[float]]:
    """Four paws from the left ones."""

    def right(row: Sequence[float]) -> Sequence[float]:
        return (-row[0], *row[1:4], -row[4], row[5])

    return {"fore.L": fore, "fore.R": right(fore), "hind.L": hind, "hind.R": right(hind)}


def turned(pitch: float, yaw: float, roll: float) -> Matrix:
    """A rotation by roll, then pitch, then yaw."""
    return Matrix.Rotation(yaw, 4, "Z") @ Matrix.Rotation(pitch, 4, "X") @ Matrix.Rotation(roll, 4, "Y")


def move_pelvis(pose: Pose, joint: Joint) -> Matrix:
    """The motion of the pelvis from rest."""
    pitch, roll, yaw = pose.pelvis_turn
    return Matrix.Translation(pose.pelvis) @ turned(pitch, yaw, roll) @ Matrix.Translation(-joint("pelvis"))


def move_head(moved: dict[str, Matrix], pose: Pose, joint: Joint) -> None:
    """Adds neck and head: the head looks where the pose says, the neck is half-way to it."""
    head = turned(*pose.head).to_quaternion()
    arch = Quaternion((1, 0, 0), pose.neck[0]) @ Quaternion((0, 0, 1), pose.neck[1])
    neck = keys.slerp(moved["chest"].to_quaternion(), head, 0.45) @ arch
    moved["neck"] = carried(moved["chest"] @ joint("neck"), neck, joint("neck"))
    moved["head"] = carried(moved["neck"] @ joint("skull"), head, joint("skull"))


def move_chain(moved: dict[str, Matrix], parent: str, bones: Mapping[str, Matrix], joint: Joint) -> None:
    """Adds bones that hang on each other, each turned about its own joint."""
    for bone, bend in bones.items():
        moved[bone] = moved[parent] @ about(joint(bone), bend)
        parent = bone


class Track(Protocol):
    """A way over the ground that goes straight on beyond both of its ends."""

    length: float

    def point(self, s: float) -> Vector:
        """The place after `s` metres."""

    def heading(self, s: float) -> float:
        """The heading there."""


class Gait(Generic[AnyPose]):
    """Foot plants along a track; `u` is 0..1 over its time. Subclasses say how the body goes with them."""

    STRIDE_M: float
    SWING: float  # share of a stride that a paw is in the air
    PHASE: ClassVar[Mapping[str, float]]
    SOFT: float  # share of the time in which it gets up to speed
    STANCE: ClassVar[Mapping[str, tuple[float, float]]]  # x, y of a left paw that stands
    REACH_AHEAD_M: float  # of the last step
    MAX_HZ: float

    def __init__(self, track: Track, start: AnyPose, seconds: float) -> None:
        self._track = track
        self._beats = max(1, round(track.length / self.STRIDE_M)) + self.SWING
        if self._beats / seconds > self.MAX_HZ:
            raise ValueError(f"{track.length:.2f} m in {seconds:.2f} s: {self._beats / seconds:.1f} Hz")
        self._steps = {paw: self._plan(paw, start.paws[i]) for i, paw in enumerate(PAWS)}

    def _plan(self, paw: str, start: np.ndarray) -> list[tuple[float, float, np.ndarray]]:
        """Swings of a paw as (lift-off, landing, plant), in strides."""
        swings, lift = [], self.PHASE[paw]
        while lift + self.SWING <= self._beats + 1e-6:
            landing = lift + self.SWING
            middle = landing + (1 - self.SWING) / 2
            s = self._distance(middle / self._beats)
            if lift + 1 + self.SWING > self._beats + 1e-6:
                s = min(self._track.length, self._distance(landing / self._beats) + self.REACH_AHEAD_M)
            swings.append((lift, landing, self._neutral(paw, s)))
            lift += 1.0
        return [(-1.0, 0.0, start), *swings]

    def _distance(self, u: float) -> float:
        """Metres gone at u: even speed with soft start and stop."""
        soft = self.SOFT
        u = min(max(u, 0.0), 1.0)
        peak = 1.0 / (1.0 - soft)
        if u < soft:
            return self._track.length * peak * u * u / (2 * soft)
        if u > 1 - soft:
            return self._track.length * (1 - peak * (1 - u) ** 2 / (2 * soft))
        return self._track.length * peak * (u - soft / 2)

    def _neutral(self, paw: str, s: float) -> np.ndarray:
        """Where a paw stands when the body is `s` metres along."""
        kind, side = paw.split(".")
        x, y = self.STANCE[kind]
        at = s - y
        heading = self._track.heading(at)
        left = Vector((math.cos(heading), math.sin(heading), 0.0)) * (x if side == "L" else -x)
        point = self._track.point(at) + left
        return np.array([point.x, point.y, self._height(point), 0.0, self._unwrapped(heading), 0.0])

    def _height(self, point: Vector) -> float:
        """Height of the ground."""
        return 0.0

    def _unwrapped(self, heading: float) -> float:
        """The same heading without a jump by a full turn."""
        return heading

    def pose(self, u: float, rest: AnyPose) -> AnyPose:
        """The pose at a share of the time; `rest` is the animal standing."""
        raise NotImplementedError


class Quadruped(Generic[AnyPose]):
    """One animal of a scene. Actions take inclusive canonical frames and are called in the order of time."""

    STEP_STARTS: tuple[float, float, float, float]  # of paws in STEP_ORDER, when it changes its posture
    STEP_SHARE: float
    STEP_LIFT: tuple[float, float]  # share of the way, at most so many metres
    GAZE: tuple[float, float, float, float]  # most yaw, least and most pitch, roll by yaw
    SETTLE_FRAMES: int  # until the start of a walk has the body of the gait

    def __init__(
        self,
        scene: Scene,
        name: str,
        id: int,
        category: str,
        body: bpy.types.Object,
        attributes: Mapping[str, str] | None,
        start: AnyPose,
    ) -> None:
        self.scene, self.rig = scene, body.parent
        self._rng = scene.rng(f"{name}/motion")
        self.instance = scene.instance(
            name, id, category, body, attributes=attributes, front="-y", frame_object=self.rig
        )
        self.poses = [start.copy() for _ in range(FRAME_COUNT)]

    def watch(
        self,
        targets: Sequence[Vector] | Vector,
        frames: Frames,
        *,
        ease_frames: int = 8,
        event_object: Instance | None = None,
    ) -> None:
        """Turns the head to a point (or one point per frame) and keeps looking there until told otherwise."""
        first, last = frames
        previous = None
        for frame in range(first, FRAME_COUNT):
            pose = self.poses[frame]
            target = targets if isinstance(targets, Vector) else targets[min(frame, last)]
            aim = self._aim(pose, target)
            previous = aim if previous is None else previous + 0.30 * (aim - previous)
            share = keys.ease_between(frame, first, first + ease_frames)
            pose.head = pose.head + share * (previous - pose.head)
        if event_object is not None:
            self.scene.event(self.instance, "watch", frames, event_object)

    def finish(self) -> None:
        """Adds small signs of life, solves every frame and keys the rig; call it once, at the end."""
        self._live()
        rest = {bone.name: bone.matrix_local.copy() for bone in self.rig.data.bones}
        moved = [self._solve(pose) for pose in self.poses]
        keys.key_matrices(self.rig, [pose.world() for pose in self.poses])
        bones = [{name: motions[name] @ rest[name] for name in rest} for motions in moved]
        keys.key_bones(self.rig, bones, space="armature")

    def _posture(self, posture: str, root: np.ndarray) -> AnyPose:
        raise NotImplementedError

    def _joint(self, name: str) -> Vector:
        raise NotImplementedError

    def _body(self, pose: AnyPose) -> dict[str, Matrix]:
        """Motions of trunk, neck and head from rest, in the rig's space."""
        raise NotImplementedError

    def _solve(self, pose: AnyPose) -> dict[str, Matrix]:
        """Motions of all bones from rest, in the rig's space."""
        raise NotImplementedError

    def _live(self) -> None:
        """Adds what an animal does all the time."""

    def _hold(self, frame: int) -> None:
        for later in range(frame + 1, FRAME_COUNT):
            self.poses[later] = self.poses[frame].copy()

    def _change(self, posture: str, frames: Frames) -> None:
        """From whatever pose into a posture on the spot; paws that have to move take one step each."""
        first, last = frames
        start = self.poses[first].copy()
        goal = self._posture(posture, start.root)
        goal.head[1:] = start.head[1:]
        slots = dict(zip(STEP_ORDER, self.STEP_STARTS))
        share, most = self.STEP_LIFT
        for frame in range(first, last + 1):
            u = (frame - first) / (last - first)
            pose = start.blended(goal, keys.ease(u))
            for i, paw in enumerate(PAWS):
                t = keys.ease((u - slots[paw]) / self.STEP_SHARE)
                pose.paws[i] = (1 - t) * start.paws[i] + t * goal.paws[i]
                far = float(np.linalg.norm(goal.paws[i, :2] - start.paws[i, :2]))
                pose.paws[i, 2] += min(share * far, most) * math.sin(math.pi * t)
            self.poses[frame] = pose
        self._hold(last)

    def _go(self, gait: Gait[AnyPose], rest: AnyPose, frames: Frames) -> None:
        """Follows a gait from the pose that it is in."""
        first, last = frames
        start = self.poses[first].copy()
        for frame in range(first, last + 1):
            walking = gait.pose((frame - first) / (last - first), rest)
            pose = start.blended(walking, keys.ease((frame - first) / self.SETTLE_FRAMES))
            pose.paws, pose.root = walking.paws, walking.root
            self.poses[frame] = pose
        self._hold(last)

    def _aim(self, pose: AnyPose, target: Vector) -> np.ndarray:
        """Head pitch, yaw, roll that point the nose at a world point, within what a neck can do."""
        most_yaw, least_pitch, most_pitch, roll = self.GAZE
        eyes = self._body(pose)["head"] @ self._joint("skull")
        to = pose.world().inverted() @ target - eyes
        yaw = max(-most_yaw, min(most_yaw, math.atan2(to.x, -to.y)))
        pitch = max(least_pitch, min(most_pitch, math.atan2(-to.z, math.hypot(to.x, to.y))))
        return np.array([pitch, yaw, roll * yaw])
