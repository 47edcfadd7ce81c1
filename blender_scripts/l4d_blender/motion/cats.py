"""Cats that act, and balls that roll: animation and ground truth by the same call.

A `Cat` fills one `Pose` per canonical frame; actions change the poses from their first frame on and record
what they do as events. `finish` solves the limbs and keys the rig. Paw targets live in the world, so that a
planted paw stays where it is whatever the body does. Owns motion only: shape is assets/cat.py, the stage is
the recipe's.

Body frame: -Y forward, +X left, +Z up; positive pitch lowers the nose, positive yaw turns left, radians.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field

import numpy as np
from mathutils import Matrix, Quaternion, Vector

from l4d_blender import keys
from l4d_blender.assets import cat as anatomy
from l4d_blender.scene import Instance, Scene
from l4d_blender.timeline import FPS, FRAME_COUNT, LAST_FRAME

SPINE = ("lumbar", "loin", "back", "withers", "chest")
PAWS = ("fore.L", "fore.R", "hind.L", "hind.R")
PAW_TIP_RADIUS_M = 0.0155

STRIDE_M = 0.36
SWING = 0.40
LONGEST_STEP_AHEAD_M = 0.11
# A lateral sequence that starts with a forefoot: hind feet can stay behind longest.
GAIT_PHASE = {"fore.R": 0.0, "hind.L": 0.25, "fore.L": 0.5, "hind.R": 0.75}

Frames = tuple[int, int]
Ground = Callable[[float, float], float]


def level(height_m: float) -> Ground:
    """Ground of one height everywhere."""
    return lambda x, y: height_m


FLOOR = level(0.0)


def _array(*shape: int) -> Callable[[], np.ndarray]:
    return lambda: np.zeros(shape)


@dataclass
class Pose:
    """Everything that can be blended. `paws` rows: world x, y, z of the pad, pitch, yaw, heel (hind only)."""

    root: np.ndarray = field(default_factory=_array(3))
    floor: np.ndarray = field(default_factory=_array(1))
    pelvis: np.ndarray = field(default_factory=lambda: np.array(anatomy.JOINTS["pelvis"]))
    pelvis_turn: np.ndarray = field(default_factory=_array(3))
    spine: np.ndarray = field(default_factory=_array(5, 3))
    neck: np.ndarray = field(default_factory=_array(2))
    head: np.ndarray = field(default_factory=_array(3))
    tail: np.ndarray = field(default_factory=_array(anatomy.TAIL_BONES, 2))
    ears: np.ndarray = field(default_factory=_array(2))
    lids: np.ndarray = field(default_factory=_array(1))
    breath: np.ndarray = field(default_factory=_array(1))
    paws: np.ndarray = field(default_factory=_array(4, 6))

    def copy(self) -> Pose:
        """A pose that shares nothing with this one."""
        return Pose(**{key: value.copy() for key, value in vars(self).items()})

    def blended(self, other: Pose, t: float) -> Pose:
        """The share `t` of the way to another pose."""
        return Pose(**{key: (1 - t) * value + t * getattr(other, key) for key, value in vars(self).items()})

    def world(self) -> Matrix:
        """World matrix of the body frame."""
        x, y, heading = self.root
        return Matrix.Translation((x, y, self.floor[0])) @ Matrix.Rotation(heading, 4, "Z")


def _place_paws(pose: Pose, local: dict[str, Sequence[float]]) -> Pose:
    """Puts the paws at (x, y, z, pitch, yaw, heel) of the body frame."""
    world = pose.world()
    for i, paw in enumerate(PAWS):
        x, y, z, pitch, yaw, heel = local[paw]
        point = world @ Vector((x, y, z))
        pose.paws[i] = (*point, pitch, pose.root[2] + yaw, heel)
    return pose


def _mirrored(fore: Sequence[float], hind: Sequence[float]) -> dict[str, Sequence[float]]:
    def right(row: Sequence[float]) -> Sequence[float]:
        return (-row[0], *row[1:4], -row[4], row[5])

    return {"fore.L": fore, "fore.R": right(fore), "hind.L": hind, "hind.R": right(hind)}


def _tail(pitches: Sequence[float], yaws: Sequence[float]) -> np.ndarray:
    return np.stack([np.asarray(pitches, float), np.asarray(yaws, float)], axis=1)


def _ramp(first: float, last: float) -> np.ndarray:
    return np.linspace(first, last, anatomy.TAIL_BONES)


def standing(root: np.ndarray, floor: float) -> Pose:
    """Alert on four legs, tail low with its tip up."""
    pose = Pose(root=np.array(root, float), floor=np.array([floor]))
    pose.neck[0] = 0.25
    pose.head[0] = 0.06
    pose.tail = _tail([-0.55, -0.25, -0.05, 0.1, 0.2, 0.25, 0.25, 0.25, 0.2], _ramp(0.0, 0.1))
    return _place_paws(pose, _mirrored((0.036, -0.128, 0, 0, 0.05, 0), (0.041, 0.150, 0, 0, 0.08, 0)))


def sitting(root: np.ndarray, floor: float, tail_side: float = 1.0) -> Pose:
    """Upright on the haunches, hind feet flat beside the straight front legs, tail laid round one flank."""
    pose = Pose(root=np.array(root, float), floor=np.array([floor]))
    pose.pelvis = np.array([0.0, 0.110, 0.078])
    pose.pelvis_turn[0] = -0.92
    pose.spine[:, 0] = (0.12, 0.14, 0.10, 0.02, -0.05)
    pose.neck[0] = 0.10
    pose.head[0] = 0.05
    pose.tail = _tail(
        [0.62, 0.30, 0.16, 0.06, 0.0, 0.0, 0.0, 0.0, 0.0],
        tail_side * np.array([0.35, 0.40, 0.42, 0.42, 0.40, 0.36, 0.30, 0.26, 0.2]),
    )
    return _place_paws(pose, _mirrored((0.030, -0.098, 0, 0, 0.08, 0), (0.068, 0.020, 0, 0, 0.30, -1.0)))


def crouching(root: np.ndarray, floor: float) -> Pose:
    """Low in front, haunches bunched, head forward: a cat about to play."""
    pose = Pose(root=np.array(root, float), floor=np.array([floor]))
    pose.pelvis = np.array([0.0, 0.120, 0.135])
    pose.pelvis_turn[0] = 0.10
    pose.spine[:, 0] = (-0.12, 0.02, 0.06, 0.02, -0.04)
    pose.neck[0] = 0.55
    pose.head[0] = 0.30
    pose.tail = _tail([-0.95, 0.35, 0.28, 0.16, 0.06, 0.02, 0.06, 0.1, 0.1], _ramp(0.15, 0.25))
    return _place_paws(pose, _mirrored((0.042, -0.150, 0, 0, 0.05, 0), (0.062, 0.075, 0, 0, 0.15, -0.75)))


def poised(root: np.ndarray, floor: float) -> Pose:
    """Half sitting on bunched haunches, chest low enough for a paw to reach ahead: how a cat bats things."""
    pose = Pose(root=np.array(root, float), floor=np.array([floor]))
    pose.pelvis = np.array([0.0, 0.120, 0.098])
    pose.pelvis_turn[0] = -0.52
    pose.spine[:, 0] = (0.02, 0.10, 0.12, 0.06, 0.0)
    pose.neck[0] = 0.12
    pose.head[0] = 0.45
    pose.tail = _tail([0.10, 0.25, 0.16, 0.06, 0.02, 0.02, 0.06, 0.1, 0.1], _ramp(0.2, 0.3))
    return _place_paws(pose, _mirrored((0.040, -0.158, 0, 0, 0.05, 0), (0.066, 0.045, 0, 0, 0.25, -0.95)))


def curled(root: np.ndarray, floor: float) -> Pose:
    """Asleep in a ring on the left side of its spine: nose to tail, paws inside, eyes shut."""
    pose = Pose(root=np.array(root, float), floor=np.array([floor]))
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
    return _place_paws(
        pose,
        {
            "fore.L": (0.075, -0.050, 0.02, 0.2, 0.9, 0),
            "fore.R": (0.050, -0.020, 0.015, 0.2, 1.2, 0),
            "hind.L": (0.070, 0.030, 0.02, 0, 0.4, -0.9),
            "hind.R": (0.045, 0.010, 0.015, 0, 0.5, -0.9),
        },
    )


class Ball:
    """A ball on a floor that rolls without slipping along straight pushes."""

    def __init__(
        self,
        instance: Instance,
        radius_m: float,
        at: Sequence[float],
        floor_m: float = 0.0,
        turn: float = 0.0,
    ) -> None:
        """`at` is (x, y); `turn` (radians, about a slanted axis) is how it happens to lie at first."""
        self.instance, self.radius_m, self._floor_m = instance, radius_m, floor_m
        self._turn = Quaternion((0.5, 0.3, 0.8), turn)
        self.moving: list[Frames] = []
        self.place(at)

    def place(self, at: Sequence[float]) -> None:
        """Lies at (x, y) until it is pushed."""
        centre = Vector((at[0], at[1], self._floor_m + self.radius_m))
        self.centres = [centre.copy() for _ in range(FRAME_COUNT)]

    def roll_to(self, to: Sequence[float], frames: Frames) -> None:
        """A push at the first frame, then friction: fast at first, at rest at the last frame."""
        first, last = frames
        start = self.centres[first].copy()
        end = Vector((to[0], to[1], start.z))
        for frame in range(first, FRAME_COUNT):
            u = min((frame - first) / (last - first), 1.0)
            self.centres[frame] = start.lerp(end, u * u * (6 - 8 * u + 3 * u * u))
        self.moving.append(frames)

    def finish(self) -> None:
        """Keys position and rolling, and records one `roll` per uninterrupted stretch of motion."""
        turn = self._turn
        matrices = []
        for frame, centre in enumerate(self.centres):
            step = centre - self.centres[max(frame - 1, 0)]
            if step.length > 1e-9:
                axis = Vector((0, 0, 1)).cross(step)
                turn = Quaternion(axis, step.length / self.radius_m) @ turn
            spun = turn.to_matrix().to_4x4()
            matrices.append(Matrix.Translation(centre) @ spun @ Matrix.Translation((0, 0, -self.radius_m)))
        keys.key_matrices(self.instance.objects[0], matrices)
        for first, last in _merged(self.moving):
            self.instance.scene.event(self.instance, "roll", (first, last))


def _merged(intervals: Iterable[Frames]) -> list[Frames]:
    merged: list[Frames] = []
    for first, last in sorted(intervals):
        if merged and first <= merged[-1][1] + 1:
            merged[-1] = (merged[-1][0], max(last, merged[-1][1]))
        else:
            merged.append((first, last))
    return merged


@dataclass(frozen=True)
class Tap:
    """A paw strikes a ball at `frame`; the ball comes to rest at `to` (world x, y) at frame `rest`."""

    frame: int
    paw: str
    to: tuple[float, float]
    rest: int


class Cat:
    """One cat of a scene. Actions take inclusive canonical frames and must be called in the order of time."""

    def __init__(
        self,
        scene: Scene,
        name: str,
        id: int,
        *,
        coat: anatomy.Coat,
        at: Sequence[float],
        heading: float,
        ground: Ground = FLOOR,
        posture: str = "stand",
        tail_side: float = 1.0,
        attributes: dict[str, str] | None = None,
    ) -> None:
        """`at` is (x, y) of the middle, `heading` 0 faces -Y; posture stand, sit, crouch, poise or sleep.

        `ground` gives the height in metres of what is underfoot at (x, y).
        """
        self.scene = scene
        self._rng = scene.rng(f"{name}/motion")
        body = anatomy.cat(name, scene.rng(f"coat/{coat.name}"), coat=coat)
        self.rig = body.parent
        self.instance = scene.instance(
            name, id, "cat", body, attributes=attributes or {}, front="-y", frame_object=self.rig
        )
        self._ground, self._tail_side = ground, tail_side
        start = self._posture(posture, np.array([at[0], at[1], heading]))
        self.poses = [start.copy() for _ in range(FRAME_COUNT)]
        self._asleep = posture == "sleep"
        self.reach_error_m = 0.0

    def sleep(self, frames: Frames = (0, LAST_FRAME)) -> None:
        """Stays curled up: slow breathing, an ear that twitches once."""
        first, last = frames
        for frame in range(first, last + 1):
            self.poses[frame].breath[0] = math.sin(2 * math.pi * 0.5 * frame / FPS)
        twitch = self._rng.randrange(first + 10, last - 10)
        for frame in range(twitch, twitch + 8):
            self.poses[frame].ears[0] += 0.5 * math.sin(math.pi * (frame - twitch) / 7)
        self.scene.event(self.instance, "sleep", frames)

    def sit(self, frames: Frames) -> None:
        """Keeps the sitting pose that it is in (or has come into by `sit_down`)."""
        self.scene.event(self.instance, "sit", frames)

    def sit_down(self, frames: Frames) -> None:
        """Lowers the haunches; each paw that has to move takes one step."""
        self._change("sit", frames)

    def stand_up(self, frames: Frames) -> None:
        """Rises onto four legs on the spot."""
        self._change("stand", frames)

    def crouch(self, frames: Frames) -> None:
        """Ducks, ready to pounce."""
        self._change("crouch", frames)

    def poise(self, frames: Frames) -> None:
        """Gets ready to bat something that lies 0.25 to 0.3 m ahead."""
        self._change("poise", frames)

    def walk_along(self, points: Sequence[Sequence[float]], frames: Frames) -> None:
        """A four-beat walk along a smooth curve from where it stands through `points` (x, y)."""
        first, last = frames
        start = self.poses[first].copy()
        x, y, heading = start.root
        ahead = Vector((math.sin(heading), -math.cos(heading), 0.0))
        here = Vector((x, y, 0.0))
        path = _Track(keys.Path([here, here + 0.12 * ahead, *[Vector((p[0], p[1], 0.0)) for p in points]]))
        gait = _Gait(path, start, (last - first) / FPS, self._ground)
        rest = standing(start.root, float(start.floor[0]))
        for frame in range(first, last + 1):
            u = (frame - first) / (last - first)
            pose = gait.pose(u, rest)
            blend = keys.ease(min(u * (last - first) / 7, 1.0))
            paws = pose.paws
            root = pose.root
            pose = start.blended(pose, blend)
            pose.paws, pose.root = paws, root
            self.poses[frame] = pose
        self._hold(last)
        self.scene.event(self.instance, "walk", frames)

    def play_with(self, ball: Ball, taps: Sequence[Tap], frames: Frames) -> None:
        """Strikes the ball with a paw at every tap, eyes on it; records `bat` over `frames`."""
        for tap in taps:
            ball.roll_to(tap.to, (tap.frame, tap.rest))
        for tap in taps:
            self._strike(ball, tap)
        self.watch([c.copy() for c in ball.centres], frames)
        self.scene.event(self.instance, "bat", frames, ball.instance)

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
            pose.head = pose.head + keys.ease_between(frame, first, first + ease_frames) * (
                previous - pose.head
            )
        if event_object is not None:
            self.scene.event(self.instance, "watch", frames, event_object)

    def finish(self) -> None:
        """Adds small signs of life, solves every frame and keys the rig."""
        if not self._asleep:
            self._blink_and_breathe()
        roots, bones = [], []
        for pose in self.poses:
            matrix, bone = self._solve(pose)
            roots.append(matrix)
            bones.append(bone)
        keys.key_matrices(self.rig, roots)
        keys.key_bones(self.rig, bones, space="armature")

    def _posture(self, posture: str, root: np.ndarray) -> Pose:
        floor = self._ground(root[0], root[1])
        if posture == "sit":
            pose = sitting(root, floor, self._tail_side)
        else:
            pose = {"stand": standing, "crouch": crouching, "poise": poised, "sleep": curled}[posture](
                root, floor
            )
        for paw in pose.paws:
            paw[2] += self._ground(paw[0], paw[1]) - floor
        return pose

    def _hold(self, frame: int) -> None:
        for later in range(frame + 1, FRAME_COUNT):
            self.poses[later] = self.poses[frame].copy()

    def _change(self, posture: str, frames: Frames) -> None:
        """From whatever pose into a posture on the spot; paws step one after the other, diagonally."""
        first, last = frames
        start = self.poses[first].copy()
        goal = self._posture(posture, start.root)
        goal.head[1:] = start.head[1:]
        slots = {"fore.L": 0.0, "hind.R": 0.18, "fore.R": 0.36, "hind.L": 0.54}
        for frame in range(first, last + 1):
            u = (frame - first) / (last - first)
            pose = start.blended(goal, keys.ease(u))
            for i, paw in enumerate(PAWS):
                t = keys.ease((u - slots[paw]) / 0.42)
                pose.paws[i] = (1 - t) * start.paws[i] + t * goal.paws[i]
                far = float(np.linalg.norm(goal.paws[i, :2] - start.paws[i, :2]))
                pose.paws[i, 2] += min(0.8 * far, 0.028) * math.sin(math.pi * t)
            self.poses[frame] = pose
        self._hold(last)

    def _strike(self, ball: Ball, tap: Tap) -> None:
        """Lift, swing to the ball, push along with it for a moment, come back to the ground."""
        i = PAWS.index(tap.paw)
        push = 3
        direction = (ball.centres[tap.rest] - ball.centres[tap.frame]).normalized()
        for frame in range(max(tap.frame - 6, 0), min(tap.frame + push + 7, LAST_FRAME) + 1):
            pose = self.poses[frame]
            centre = ball.centres[min(max(frame, tap.frame), tap.frame + push)]
            contact = self._strike_paw(pose, i, centre, direction, ball.radius_m)
            if frame < tap.frame:
                t = keys.ease((frame - tap.frame + 6) / 6)
                back = 0.080 * math.sin(math.pi * t)
            else:
                t = 1.0 - keys.ease((frame - tap.frame - push) / 6)
                back = 0.020 * math.sin(math.pi * t) if frame > tap.frame + push else 0.0
            struck = contact.copy()
            struck[:2] -= back * np.array(direction[:2])
            struck[2] += 0.5 * back
            pose.paws[i] = (1 - t) * pose.paws[i] + t * struck
            lean = 0.028 * t
            side = 1.0 if tap.paw.endswith("L") else -1.0
            pose.pelvis[1] -= lean
            pose.spine[3:, 1] += -0.07 * side * t
            pose.spine[:, 2] += 0.03 * side * t

    def _strike_paw(
        self, pose: Pose, paw: int, centre: Vector, direction: Vector, radius: float
    ) -> np.ndarray:
        """The paw row that lays the tip of the paw on the ball's side, opposite to where it is to go."""
        pitch = 0.35
        tip = centre - direction * (radius + PAW_TIP_RADIUS_M)
        tip.z = centre.z + 0.2 * radius
        side = "." + PAWS[paw][-1]
        yaw = pose.root[2]
        turn = Matrix.Rotation(yaw, 3, "Z") @ Matrix.Rotation(pitch, 3, "X")
        tip_rest = Vector((anatomy.LIMB_JOINTS["forepaw"][0], -0.156, 0.0115))
        tip_rest.x *= 1 if side == ".L" else -1
        pad = tip - turn @ (tip_rest - anatomy.joint("forepaw" + side))
        return np.array([pad.x, pad.y, pad.z - _toe_lift(pitch), pitch, yaw, 0.0])

    def _local(self, pose: Pose, point: Vector) -> Vector:
        return pose.world().inverted() @ point

    def _aim(self, pose: Pose, target: Vector) -> np.ndarray:
        """Head pitch, yaw, roll that point the nose at a world point, within what a neck can do."""
        deltas = self._body(pose)
        eyes = deltas["head"] @ anatomy.joint("skull")
        to = self._local(pose, target) - eyes
        yaw = max(-1.25, min(1.25, math.atan2(to.x, -to.y)))
        pitch = max(-0.6, min(0.85, math.atan2(-to.z, math.hypot(to.x, to.y))))
        return np.array([pitch, yaw, 0.12 * yaw])

    def _blink_and_breathe(self) -> None:
        for frame, pose in enumerate(self.poses):
            pose.breath[0] = math.sin(2 * math.pi * 0.7 * frame / FPS)
            sway = math.sin(2 * math.pi * 0.6 * frame / FPS + self.instance.id)
            pose.tail[5:, 1] += 0.10 * sway
        for blink in (self._rng.randrange(8, 40), self._rng.randrange(50, 88)):
            for frame in range(blink, blink + 7):
                self.poses[frame].lids[0] = max(
                    self.poses[frame].lids[0], math.sin(math.pi * (frame - blink) / 6)
                )

    def _body(self, pose: Pose) -> dict[str, Matrix]:
        """Displacement of trunk, neck, head and tail from rest, in the rig's space."""
        rest = anatomy.joint
        pitch, roll, yaw = pose.pelvis_turn
        turn = Matrix.Rotation(yaw, 4, "Z") @ Matrix.Rotation(pitch, 4, "X") @ Matrix.Rotation(roll, 4, "Y")
        deltas = {"pelvis": Matrix.Translation(pose.pelvis) @ turn @ Matrix.Translation(-rest("pelvis"))}
        parent = "pelvis"
        for bone, bend in zip(SPINE, pose.spine):
            deltas[bone] = deltas[parent] @ _about(rest(bone), _rotation(bend))
            parent = bone

        trunk = deltas["chest"].to_quaternion()
        pitch, yaw, roll = pose.head
        head = (
            Matrix.Rotation(yaw, 4, "Z") @ Matrix.Rotation(pitch, 4, "X") @ Matrix.Rotation(roll, 4, "Y")
        ).to_quaternion()
        lower, side = pose.neck
        arch = Quaternion((1, 0, 0), lower) @ Quaternion((0, 0, 1), side)
        neck = keys.slerp(trunk, head, 0.45) @ arch
        anchor = deltas["chest"] @ rest("neck")
        deltas["neck"] = _placed(anchor, neck, rest("neck"))
        anchor = deltas["neck"] @ rest("skull")
        deltas["head"] = _placed(anchor, head, rest("skull"))

        parent = "pelvis"
        for i, (pitch, yaw) in enumerate(pose.tail):
            deltas[f"tail{i}"] = deltas[parent] @ _about(rest(f"tail{i}"), _rotation((pitch, 0.0, yaw)))
            parent = f"tail{i}"
        for k, side in enumerate((".L", ".R")):
            ear = _rotation((0.5 * pose.ears[k], 0.0, (1 if k == 0 else -1) * 0.5 * pose.ears[k]))
            deltas["ear" + side] = deltas["head"] @ _about(rest("ear" + side), ear)
            lid = _rotation((-0.62 + 1.80 * float(pose.lids[0]), 0.0, 0.0))
            deltas["lid" + side] = deltas["head"] @ _about(rest("eye" + side), lid)
        return deltas

    def _solve(self, pose: Pose) -> tuple[Matrix, dict[str, Matrix]]:
        """The rig's world matrix and every bone's matrix in the rig's space."""
        deltas = self._body(pose)
        root = pose.world()
        to_local = root.inverted()
        for i, paw in enumerate(PAWS):
            kind, side = paw.split(".")
            x, y, z, pitch, yaw, heel = pose.paws[i]
            pad = to_local @ Vector((x, y, z + _toe_lift(pitch)))
            turn = Matrix.Rotation(yaw - pose.root[2], 3, "Z")
            if kind == "fore":
                self._solve_foreleg(deltas, "." + side, pad, turn @ Matrix.Rotation(pitch, 3, "X"))
            else:
                self._solve_hindleg(deltas, "." + side, pad, turn, pitch, heel)
        swell = 0.0022 * float(pose.breath[0])
        for bone, share in (("back", 0.8), ("withers", 1.0), ("loin", 0.6)):
            deltas[bone] = Matrix.Translation((0, 0, swell * share)) @ deltas[bone]
        rest = {bone.name: bone.matrix_local for bone in self.rig.data.bones}
        return root, {name: deltas[name] @ rest[name] for name in rest}

    def _solve_foreleg(self, deltas: dict[str, Matrix], side: str, pad: Vector, turn: Matrix) -> None:
        rest = anatomy.joint
        wrist = pad + turn @ (rest("wrist" + side) - rest("forepaw" + side))
        chest = deltas["withers"]
        reach = (chest.inverted() @ pad).y - rest("forepaw" + side).y
        shrug = max(-0.5, min(0.45, 2.6 * reach))
        scapula = chest @ _about(rest("scapula" + side), _rotation((shrug, 0.0, 0.0)))
        shoulder = scapula @ rest("shoulder" + side)
        back = chest.to_3x3() @ Vector((0.18 if side == ".L" else -0.18, 1.0, 0.0))
        elbow, wrist = self._bend(shoulder, wrist, side, ("shoulder", "elbow", "wrist"), back)
        deltas["scapula" + side] = scapula
        self._aim_pair(
            deltas,
            side,
            ("upperarm", "forearm"),
            ("shoulder", "elbow", "wrist"),
            (shoulder, elbow, wrist),
            back,
            Vector((0.0, 1.0, 0.0)),
        )
        deltas["forepaw" + side] = _placed(wrist, turn.to_quaternion(), rest("wrist" + side))

    def _solve_hindleg(
        self, deltas: dict[str, Matrix], side: str, pad: Vector, turn: Matrix, pitch: float, heel: float
    ) -> None:
        rest = anatomy.joint
        shank = turn @ Matrix.Rotation(heel + pitch, 3, "X")
        hock = pad + shank @ (rest("hock" + side) - rest("hindpaw" + side))
        pelvis = deltas["pelvis"]
        hip = pelvis @ rest("hip" + side)
        outward = 0.16 if side == ".L" else -0.16
        forward = pelvis.to_3x3() @ Vector((outward, -1.0, 0.0)) + Vector((outward, -0.4, 0.3))
        knee, reached = self._bend(hip, hock, side, ("hip", "knee", "hock"), forward)
        slack = reached - hock
        self._aim_pair(
            deltas,
            side,
            ("thigh", "shin"),
            ("hip", "knee", "hock"),
            (hip, knee, reached),
            forward,
            Vector((0.0, -1.0, 0.0)),
        )
        deltas["hindpaw" + side] = _placed(reached, shank.to_quaternion(), rest("hock" + side))
        toes = turn @ Matrix.Rotation(pitch, 3, "X")
        deltas["hindtoe" + side] = _placed(pad + slack, toes.to_quaternion(), rest("hindpaw" + side))

    def _bend(
        self, top: Vector, end: Vector, side: str, names: tuple[str, str, str], pole: Vector
    ) -> tuple[Vector, Vector]:
        """Middle joint and reachable end of a two-bone limb that bends towards `pole`."""
        a, b, c = (anatomy.joint(name + side) for name in names)
        upper, lower = (b - a).length, (c - b).length
        span = end - top
        longest, shortest = 0.999 * (upper + lower), 1.02 * abs(upper - lower)
        length = min(max(span.length, shortest), longest)
        self.reach_error_m = max(self.reach_error_m, abs(span.length - length))
        axis = span.normalized()
        along = (upper * upper - lower * lower + length * length) / (2 * length)
        height = math.sqrt(max(upper * upper - along * along, 0.0))
        out = (pole - pole.project(axis)).normalized()
        return top + axis * along + out * height, top + axis * length

    def _aim_pair(
        self,
        deltas: dict[str, Matrix],
        side: str,
        bones: tuple[str, str],
        names: Sequence[str],
        points: Sequence[Vector],
        pole: Vector,
        rest_pole: Vector,
    ) -> None:
        """Turns two bones from their rest directions onto the solved joints without twisting them."""
        for k, bone in enumerate(bones):
            rest_from, rest_to = (anatomy.joint(names[k + i] + side) for i in (0, 1))
            before = _frame(rest_to - rest_from, rest_pole)
            after = _frame(points[k + 1] - points[k], pole)
            turn = (after @ before.transposed()).to_quaternion()
            deltas[bone + side] = _placed(points[k], turn, rest_from)


class _Track:
    """A path that goes straight on beyond both of its ends."""

    def __init__(self, path: keys.Path) -> None:
        self._path, self.length = path, path.length

    def point(self, s: float) -> Vector:
        inside = min(max(s, 0.0), self.length)
        return self._path.point(inside) + (s - inside) * self._path.tangent(inside)

    def heading(self, s: float) -> float:
        ahead = self.point(s + 0.03) - self.point(s - 0.03)
        return math.atan2(ahead.x, -ahead.y)


class _Gait:
    """Foot plants of a lateral-sequence walk along a track; `u` is 0..1 over its time."""

    def __init__(self, track: _Track, start: Pose, seconds: float, ground: Ground) -> None:
        self._track, self._ground = track, ground
        self._cycles = max(1, round(track.length / STRIDE_M))
        self._beats = self._cycles + SWING
        self._heading = start.root[2]
        if self._beats / seconds > 2.6:
            raise ValueError(
                f"a walk of {track.length:.2f} m in {seconds:.2f} s needs {self._beats / seconds:.1f} Hz"
            )
        self._steps = {paw: self._plan(paw, start.paws[i]) for i, paw in enumerate(PAWS)}

    def _plan(self, paw: str, start: np.ndarray) -> list[tuple[float, float, np.ndarray]]:
        """Swings of a paw as (lift-off, landing, plant), in gait cycles."""
        swings = []
        lift = GAIT_PHASE[paw]
        while lift + SWING <= self._beats + 1e-6:
            landing = lift + SWING
            middle = landing + (1 - SWING) / 2
            last = lift + 1 + SWING > self._beats + 1e-6
            s = self._distance(middle / self._beats)
            if last:
                s = min(self._track.length, self._distance(landing / self._beats) + LONGEST_STEP_AHEAD_M)
            swings.append((lift, landing, self._neutral(paw, s)))
            lift += 1.0
        return [(-1.0, 0.0, start), *swings]

    def _distance(self, u: float) -> float:
        """Metres gone at u: even speed with soft start and stop."""
        soft = 0.24
        u = min(max(u, 0.0), 1.0)
        peak = 1.0 / (1.0 - soft)
        if u < soft:
            return self._track.length * peak * u * u / (2 * soft)
        if u > 1 - soft:
            return self._track.length * (1 - peak * (1 - u) ** 2 / (2 * soft))
        return self._track.length * peak * (u - soft / 2)

    def _neutral(self, paw: str, s: float) -> np.ndarray:
        kind, side = paw.split(".")
        x, y = (0.030, -0.128) if kind == "fore" else (0.036, 0.150)
        at = s - y
        heading = self._track.heading(at)
        left = Vector((math.cos(heading), math.sin(heading), 0.0)) * (x if side == "L" else -x)
        point = self._track.point(at) + left
        return np.array(
            [point.x, point.y, self._ground(point.x, point.y), 0.0, self._unwrapped(heading), 0.0]
        )

    def _unwrapped(self, heading: float) -> float:
        return self._heading + (heading - self._heading + math.pi) % (2 * math.pi) - math.pi

    def pose(self, u: float, rest: Pose) -> Pose:
        pose = rest.copy()
        beat = u * self._beats
        s = self._distance(u)
        moving = min(1.0, 6 * u, 6 * (1 - u))
        hips, chest = self._track.point(s - 0.165), self._track.point(s + 0.115)
        forward = chest - hips
        middle = hips.lerp(chest, 0.165 / 0.28)
        heading = self._unwrapped(math.atan2(forward.x, -forward.y))
        pose.root = np.array([middle.x, middle.y, heading])
        pose.floor[0] = 0.5 * (self._ground(hips.x, hips.y) + self._ground(chest.x, chest.y))
        swing = 2 * math.pi * beat
        pose.pelvis[2] += moving * (-0.010 + 0.004 * math.cos(2 * swing + 0.6))
        pose.pelvis_turn = moving * np.array(
            [0.02 * math.sin(2 * swing), 0.05 * math.sin(swing), 0.06 * math.cos(swing)]
        )
        rear = self._unwrapped(self._track.heading(s - 0.13)) - heading
        front = self._unwrapped(self._track.heading(s + 0.13)) - heading
        pose.pelvis_turn[2] += rear
        pose.spine[:, 2] += (front - rear - moving * 0.12 * math.cos(swing)) / 5
        pose.spine[:, 1] -= moving * 0.018 * math.sin(swing)
        pose.neck[0] += moving * 0.22
        pose.head = np.array(
            [0.10, 0.8 * front + 0.5 * (self._unwrapped(self._track.heading(s + 0.4)) - heading), 0]
        )
        wave = np.array([math.sin(swing - 0.55 * i) for i in range(anatomy.TAIL_BONES)])
        pose.tail[:, 0] += moving * np.array([0.45, 0.12, 0, 0, 0, -0.1, -0.15, -0.15, -0.1])
        pose.tail[:, 1] += moving * 0.07 * wave
        for i, paw in enumerate(PAWS):
            pose.paws[i] = self._paw(paw, beat, s)
        return pose

    def _paw(self, paw: str, beat: float, s: float) -> np.ndarray:
        swings = self._steps[paw]
        current = max(k for k, step in enumerate(swings) if step[0] <= beat)
        lift, landing, plant = swings[current]
        fore = paw.startswith("fore")
        if beat >= landing:
            row = plant.copy()
            following = swings[current + 1][0] if current + 1 < len(swings) else None
            if following is not None:
                row[3] = (0.55 if fore else 0.35) * keys.ease((beat - following + 0.18) / 0.18)
            return row
        t = (beat - lift) / (landing - lift)
        row = swings[current - 1][2] + keys.ease(t) * (plant - swings[current - 1][2])
        row[2] += (0.034 if fore else 0.026) * math.sin(math.pi * t) ** 1.2
        peel = (0.55 if fore else 0.35) if current > 0 and lift > 0.15 else 0.55 * keys.ease(t / 0.3)
        row[3] = peel * (1 - keys.ease(t)) + (0.75 if fore else 0.5) * math.sin(math.pi * t) ** 2 * (1 - t)
        return row


def _toe_lift(pitch: float) -> float:
    """How far the pad rises when the paw rolls over its toes."""
    return 0.030 * math.sin(pitch) if pitch > 0 else 0.0


def _rotation(vector: Sequence[float]) -> Matrix:
    angle = math.sqrt(sum(x * x for x in vector))
    return Matrix.Rotation(angle, 4, Vector(vector)) if angle > 1e-12 else Matrix.Identity(4)


def _about(point: Vector, rotation: Matrix) -> Matrix:
    return Matrix.Translation(point) @ rotation @ Matrix.Translation(-point)


def _placed(at: Vector, turn: Quaternion, rest: Vector) -> Matrix:
    return Matrix.Translation(at) @ turn.to_matrix().to_4x4() @ Matrix.Translation(-rest)


def _frame(direction: Vector, pole: Vector) -> Matrix:
    z = direction.normalized()
    x = pole.cross(z).normalized()
    return Matrix((x, z.cross(x), z)).transposed()
