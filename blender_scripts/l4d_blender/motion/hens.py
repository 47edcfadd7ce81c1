"""Hens that stand and look about, peck, and walk with planted feet and a head that holds still between
thrusts.

Owns the pose of a hen (legs and neck by two-bone reach) and records what each hen does while it keys it.
Feet are planned on level ground at the hen's own height; shapes and joints come from assets/hen.py.
"""

from __future__ import annotations

import math
import random
from dataclasses import dataclass, field

from mathutils import Matrix, Vector

from .. import keys
from ..assets import hen as shape
from ..scene import Instance
from ..timeline import LAST_FRAME

SIDES = ("left", "right")
STEP_M = 0.13

_DOWN_PITCH, _DOWN_DROP = 0.56, 0.016
_HEAD_UP = shape.NECK_TOP.copy()
_HEAD_HOVER = Vector((0.0, -0.185, 0.145))
_HEAD_GROUND = Vector((0.0, -0.172, 0.080))


@dataclass
class Pose:
    """A hen in its own frame: metres and radians, front -Y, feet where ankles are."""

    ankles: dict[str, Vector]
    foot_yaw: dict[str, float] = field(default_factory=lambda: {"left": 0.0, "right": 0.0})
    foot_pitch: dict[str, float] = field(default_factory=lambda: {"left": 0.0, "right": 0.0})
    drop_m: float = 0.0
    pitch: float = 0.0
    roll: float = 0.0
    head: Vector = field(default_factory=_HEAD_UP.copy)
    head_pitch: float = 0.0
    head_yaw: float = 0.0


def _two_bones(
    start: Vector, end: Vector, first: float, second: float, pole: Vector
) -> tuple[Vector, Vector]:
    """Where the middle joint and the end come to lie; the middle bends towards `pole`."""
    way = end - start
    reach = min(way.length, 0.998 * (first + second))
    way.normalize()
    along = (first**2 - second**2 + reach**2) / (2.0 * reach)
    off = math.sqrt(max(0.0, first**2 - along**2))
    bend = (pole - pole.project(way)).normalized()
    return start + along * way + off * bend, start + reach * way


def _segment(rest_start: Vector, rest_end: Vector, start: Vector, end: Vector) -> Matrix:
    """The motion that carries a bone from its rest place to another."""
    turn = (rest_end - rest_start).rotation_difference(end - start).to_matrix().to_4x4()
    return Matrix.Translation(start) @ turn @ Matrix.Translation(-rest_start)


def solve(pose: Pose) -> dict[str, Matrix]:
    """Per bone the motion from rest to pose, in the rig's space."""
    pivot = shape.BODY_PIVOT
    body = (
        Matrix.Translation(pivot - Vector((0.0, 0.0, pose.drop_m)))
        @ Matrix.Rotation(pose.roll, 4, "Y")
        @ Matrix.Rotation(pose.pitch, 4, "X")
        @ Matrix.Translation(-pivot)
    )
    moved = {"body": body}
    low = body @ shape.NECK_LOW
    first = (shape.NECK_MID - shape.NECK_LOW).length
    second = (shape.NECK_TOP - shape.NECK_MID).length
    mid, top = _two_bones(low, pose.head, first, second, Vector((0.0, -1.0, -0.3)))
    moved["neck_low"] = _segment(shape.NECK_LOW, shape.NECK_MID, low, mid)
    moved["neck_high"] = _segment(shape.NECK_MID, shape.NECK_TOP, mid, top)
    gaze = Matrix.Rotation(pose.head_yaw, 4, "Z") @ Matrix.Rotation(pose.head_pitch, 4, "X")
    moved["head"] = Matrix.Translation(top) @ gaze @ Matrix.Translation(-shape.NECK_TOP)
    for side in SIDES:
        hip = body @ shape.HIP[side]
        upper = (shape.HOCK[side] - shape.HIP[side]).length
        lower = (shape.ANKLE[side] - shape.HOCK[side]).length
        hock, ankle = _two_bones(hip, pose.ankles[side], upper, lower, Vector((0.0, 1.0, 0.2)))
        moved[f"thigh_{side}"] = _segment(shape.HIP[side], shape.HOCK[side], hip, hock)
        moved[f"shank_{side}"] = _segment(shape.HOCK[side], shape.ANKLE[side], hock, ankle)
        set_down = Matrix.Rotation(pose.foot_yaw[side], 4, "Z") @ Matrix.Rotation(
            pose.foot_pitch[side], 4, "X"
        )
        moved[f"foot_{side}"] = Matrix.Translation(ankle) @ set_down @ Matrix.Translation(-shape.ANKLE[side])
    return moved


class HenActor:
    """Plays one hen through the clip: each call continues where the last one ended; `finish` keys it."""

    def __init__(self, hen: Instance, position: Vector, heading: float, rng: random.Random) -> None:
        """`heading` in radians: 0 faces -Y, counter-clockwise seen from above."""
        self._hen = hen
        self._rig = hen.objects[0].parent
        self._rng = rng
        self._position = Vector(position).to_3d()
        self._heading = heading
        root = self._root()
        self._feet = {side: (root @ shape.ANKLE[side], heading) for side in SIDES}
        self._roots: dict[int, Matrix] = {}
        self._poses: dict[int, Pose] = {}

    def stand(self, first: int, last: int) -> None:
        """Stands and looks about in the quick turns of a bird."""
        glances = self._glances(first, last)
        for frame in range(first, last + 1):
            pose = self._standing()
            pose.head_yaw, pose.head_pitch = _on_keys(glances, frame)
            pose.drop_m += 0.0015 * math.sin(2 * math.pi * frame / 40.0)
            self._put(frame, pose)
        self._hen.scene.event(self._hen, "stand", (first, last))

    def peck(self, first: int, last: int) -> None:
        """Bends down and pecks at the ground in bouts, then comes up again."""
        heads = [(first, (*_HEAD_UP, 0.0)), (first + 9, (*_HEAD_HOVER, 0.85))]
        at = first + 9
        while at + 14 + 9 <= last:
            aside = self._rng.uniform(-0.018, 0.018)
            down = _HEAD_GROUND + Vector((aside, self._rng.uniform(-0.006, 0.010), 0.0))
            hover = _HEAD_HOVER + Vector((aside, 0.0, self._rng.uniform(-0.02, 0.02)))
            heads += [
                (at + 4, (*down, 1.15)),
                (at + 6, (*down, 1.15)),
                (at + 10, (*hover, 0.85)),
                (at + 14, (*hover, 0.8)),
            ]
            at += 14
        heads.append((last, (*_HEAD_UP, 0.0)))
        for frame in range(first, last + 1):
            bent = keys.ease_between(frame, first, first + 10) * (
                1.0 - keys.ease_between(frame, last - 10, last)
            )
            pose = self._standing()
            pose.pitch, pose.drop_m = _DOWN_PITCH * bent, _DOWN_DROP * bent
            x, y, z, pose.head_pitch = _on_keys(heads, frame)
            pose.head = Vector((x, y, z))
            self._put(frame, pose)
        self._hen.scene.event(self._hen, "peck", (first, last))

    def walk(self, path: keys.Path, first: int, last: int) -> None:
        """Walks the whole path, which starts where the hen stands; both feet are down at either end."""
        steps = max(2, round(path.length / STEP_M))
        stride = path.length / steps
        landings = self._landings(path, steps, stride)
        for frame in range(first, last + 1):
            s = path.length * _glide((frame - first) / (last - first))
            self._position = path.point(s)
            along = path.tangent(s)
            self._heading = math.atan2(along.x, -along.y)
            inside = self._root().inverted()
            pose = Pose(ankles={})
            for side in SIDES:
                spot, yaw, lift, curl = _foot(landings[side], s / stride)
                pose.ankles[side] = inside @ spot + Vector((0.0, 0.0, lift))
                pose.foot_yaw[side] = math.remainder(yaw - self._heading, 2 * math.pi)
                pose.foot_pitch[side] = curl
            stir = min(1.0, s / stride, (path.length - s) / stride)
            pose.drop_m = 0.010 * stir + 0.003 * math.cos(2 * math.pi * s / stride) * stir
            pose.roll = 0.035 * math.sin(math.pi * s / stride) * stir
            pose.head = inside @ self._held_head(path, s, stride, stir)
            self._put(frame, pose)
        self._feet = {side: landings[side][-1][1:] for side in SIDES}
        self._hen.scene.event(self._hen, "walk", (first, last))

    def finish(self) -> None:
        """Keys the rig and its bones; the calls so far must have covered the whole clip."""
        missing = [frame for frame in range(LAST_FRAME + 1) if frame not in self._poses]
        if missing:
            raise ValueError(f"{self._hen.name} has nothing to do at frame {missing[0]}")
        rest = {bone.name: bone.matrix_local.copy() for bone in self._rig.data.bones}
        poses = {
            frame: {bone: moved @ rest[bone] for bone, moved in solve(pose).items()}
            for frame, pose in self._poses.items()
        }
        keys.key_matrices(self._rig, self._roots)
        keys.key_bones(self._rig, poses, space="armature")

    def _root(self) -> Matrix:
        return Matrix.Translation(self._position) @ Matrix.Rotation(self._heading, 4, "Z")

    def _put(self, frame: int, pose: Pose) -> None:
        self._roots[frame], self._poses[frame] = self._root(), pose

    def _standing(self) -> Pose:
        inside = self._root().inverted()
        return Pose(
            ankles={side: inside @ spot for side, (spot, _) in self._feet.items()},
            foot_yaw={
                side: math.remainder(yaw - self._heading, 2 * math.pi)
                for side, (_, yaw) in self._feet.items()
            },
            drop_m=0.004,
        )

    def _glances(self, first: int, last: int) -> list[tuple[int, tuple[float, ...]]]:
        """Yaw and pitch of the head: a turn takes five frames, then the head rests."""
        glances = [(first, (0.0, 0.0))]
        at = first + self._rng.randint(3, 9)
        while at + 14 < last:
            glances += [
                (at, glances[-1][1]),
                (at + 5, (self._rng.uniform(-0.75, 0.75), self._rng.uniform(-0.15, 0.2))),
            ]
            at += 5 + self._rng.randint(8, 18)
        glances += [(max(last - 6, at), glances[-1][1]), (max(last, at + 1), (0.0, 0.0))]
        return glances

    def _landings(
        self, path: keys.Path, steps: int, stride: float
    ) -> dict[str, list[tuple[float, Vector, float]]]:
        """Per foot the (step count at landing, spot, yaw) of each touch-down, first where it stands."""
        landings = {side: [(-1.0, *self._feet[side])] for side in SIDES}
        for k in range(steps):
            side = SIDES[k % 2]
            s = min(path.length, (k + 1.5) * stride)
            along = path.tangent(s)
            yaw = math.atan2(along.x, -along.y)
            there = Matrix.Translation(path.point(s)) @ Matrix.Rotation(yaw, 4, "Z")
            inward = 0.55
            ankle = Vector((shape.ANKLE[side].x * inward, shape.ANKLE[side].y, shape.ANKLE[side].z))
            landings[side].append((k + 1.0, there @ ankle, yaw))
        return landings

    def _held_head(self, path: keys.Path, s: float, stride: float, stir: float) -> Vector:
        """World place of the head: still for half a step, then thrust forward by a whole one."""
        step, share = divmod(s / stride, 1.0)
        held = stride * (step + keys.ease((share - 0.5) / 0.5)) + 0.25 * stride
        s_head = s + (held - s) * stir
        behind = path.length - 1e-6
        place = path.point(min(s_head, behind)) + path.tangent(min(s_head, behind)) * (
            max(0.0, s_head - behind)
        )
        forward = path.tangent(min(s_head, behind))
        return place + forward * -_HEAD_UP.y + Vector((0.0, 0.0, _HEAD_UP.z - 0.012 * stir))


def _glide(t: float) -> float:
    """Distance share at a time share: short eased start and stop, even pace between."""
    ramp = 0.16
    t = min(1.0, max(0.0, t))
    if t < ramp:
        return 0.5 * t * t / ramp / (1.0 - ramp)
    if t > 1.0 - ramp:
        return 1.0 - 0.5 * (1.0 - t) ** 2 / ramp / (1.0 - ramp)
    return (t - 0.5 * ramp) / (1.0 - ramp)


def _foot(
    landings: list[tuple[float, Vector, float]], steps_done: float
) -> tuple[Vector, float, float, float]:
    """(spot, yaw, lift in metres, curl in radians) of a foot after `steps_done` steps of both feet."""
    for (_, spot, yaw), (landing, next_spot, next_yaw) in zip(landings, landings[1:], strict=False):
        if steps_done < landing:
            u = steps_done - (landing - 1.0)
            if u <= 0.0:
                return spot, yaw, 0.0, 0.0
            t = keys.ease(u)
            turn = math.remainder(next_yaw - yaw, 2 * math.pi)
            return (
                spot.lerp(next_spot, t),
                yaw + t * turn,
                0.035 * math.sin(math.pi * u) ** 2,
                0.7 * math.sin(math.pi * u) ** 2,
            )
    _, spot, yaw = landings[-1]
    return spot, yaw, 0.0, 0.0


def _on_keys(points: list[tuple[int, tuple[float, ...]]], frame: int) -> tuple[float, ...]:
    """Values at a frame between eased keys (frame, values)."""
    for (a, before), (b, after) in zip(points, points[1:], strict=False):
        if frame <= b:
            t = keys.ease_between(frame, a, b) if b > a else 1.0
            return tuple(x + (y - x) * t for x, y in zip(before, after, strict=True))
    return points[-1][1]
