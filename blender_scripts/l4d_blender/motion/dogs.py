"""Dogs that act: run with planted paws, sit, lie down, get up, look about, nudge a ball with the nose.

A `Dog` holds one `Pose` per canonical frame; actions change the poses from their first frame on and record
what they show. Postures and limbs are dog_poses.py's business, shape is assets/dog.py.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np
from mathutils import Vector

from .. import keys
from ..assets import dog as anatomy
from ..scene import Instance, Scene
from ..timeline import FPS, FRAME_COUNT
from .dog_poses import NOSE_TIP, PAWS, POSTURES, Pose, solve, standing, trunk

STRIDE_M = 0.80
SWING = 0.57  # share of a stride that a paw is in the air: a running trot
PHASE = {"fore.R": 0.0, "hind.L": 0.0, "fore.L": 0.5, "hind.R": 0.5}
REACH_AHEAD_M = 0.12

Frames = tuple[int, int]


class Dog:
    """One dog of a scene. Actions take inclusive canonical frames and are called in the order of time."""

    def __init__(
        self,
        scene: Scene,
        name: str,
        id: int,
        *,
        coat: str,
        collar: str,
        at: Sequence[float],
        heading: float,
        posture: str = "stand",
        attributes: Mapping[str, str] | None = None,
    ) -> None:
        """`at` is (x, y) of the middle, `heading` 0 faces -Y; posture stand, sit or lie."""
        self.scene = scene
        self._rng = scene.rng(f"{name}/motion")
        body = anatomy.dog(name, scene.rng(f"coat/{coat}"), coat=coat, collar=collar)
        self.rig = body.parent
        self.instance = scene.instance(
            name, id, "dog", body, attributes=attributes, front="-y", frame_object=self.rig
        )
        start = POSTURES[posture]((at[0], at[1], heading))
        self.poses = [start.copy() for _ in range(FRAME_COUNT)]
        self._wags: list[tuple[Frames, float]] = []

    # ---- postures --------------------------------------------------------------------------------

    def sit(self, frames: Frames) -> None:
        """Keeps sitting (having begun so, or after `sit_down`)."""
        self.scene.event(self.instance, "sit", frames)

    def sit_down(self, frames: Frames) -> None:
        """Lowers the haunches to the ground."""
        self._change("sit", frames)
        self.scene.event(self.instance, "sit_down", frames)

    def lie_down(self, frames: Frames) -> None:
        """Goes down on the belly, paws ahead."""
        self._change("lie", frames)
        self.scene.event(self.instance, "lie_down", frames)

    def stand_up(self, frames: Frames) -> None:
        """Rises onto four legs."""
        self._change("stand", frames)
        self.scene.event(self.instance, "stand_up", frames)

    def _change(self, posture: str, frames: Frames) -> None:
        """From whatever pose into a posture on the spot; paws that have to move take one step each."""
        first, last = frames
        start = self.poses[first].copy()
        goal = POSTURES[posture](start.root)
        goal.head[1:] = start.head[1:]
        slots = {"fore.L": 0.0, "hind.R": 0.15, "fore.R": 0.30, "hind.L": 0.45}
        for frame in range(first, last + 1):
            u = (frame - first) / (last - first)
            pose = start.blended(goal, keys.ease(u))
            for i, paw in enumerate(PAWS):
                t = keys.ease((u - slots[paw]) / 0.5)
                pose.paws[i] = (1 - t) * start.paws[i] + t * goal.paws[i]
                far = float(np.linalg.norm(goal.paws[i, :2] - start.paws[i, :2]))
                pose.paws[i, 2] += min(0.4 * far, 0.045) * math.sin(math.pi * t)
            self.poses[frame] = pose
        self._hold(last)

    # ---- running ---------------------------------------------------------------------------------

    def run_along(
        self, points: Sequence[Sequence[float]], frames: Frames, *, after: Instance | None = None
    ) -> None:
        """Runs along a smooth curve from where it stands; `after` is what it chases."""
        first, last = frames
        start = self.poses[first].copy()
        x, y, heading = start.root
        here = Vector((x, y, 0.0))
        ahead = here + 0.20 * Vector((math.sin(heading), -math.cos(heading), 0.0))
        track = _Track(keys.Path([here, ahead, *[Vector((p[0], p[1], 0.0)) for p in points]]), heading)
        gait = _Gait(track, start, (last - first) / FPS)
        rest = standing(start.root)
        for frame in range(first, last + 1):
            u = (frame - first) / (last - first)
            pose = gait.pose(u, rest)
            paws, root = pose.paws, pose.root
            pose = start.blended(pose, keys.ease((frame - first) / 8))
            pose.paws, pose.root = paws, root
            self.poses[frame] = pose
        self._hold(last)
        self.scene.event(self.instance, "run", frames)
        if after is not None:
            self.scene.event(self.instance, "chase", frames, after)

    # ---- head and nose ---------------------------------------------------------------------------

    def nose_spot(self, frame: int, forward_m: float = 0.0) -> Vector:
        """Where the nose would be in the world if the dog put it down at a frame."""
        pose = POSTURES["sniff"](self.poses[frame].root)
        tip = pose.world() @ (trunk(pose)["head"] @ NOSE_TIP)
        heading = pose.root[2]
        return tip + forward_m * Vector((math.sin(heading), -math.cos(heading), 0.0))

    def nudge(self, thing: Instance, frames: Frames, *, strike: int) -> None:
        """Puts the nose down to a thing before its paws and shoves it at `strike`, then looks up again."""
        first, last = frames
        low = POSTURES["sniff"](self.poses[first].root)
        for frame in range(first, last + 1):
            pose = self.poses[frame]
            down = keys.ease_between(frame, first, strike - 3) * (
                1.0 - keys.ease_between(frame, strike + 5, last)
            )
            shove = keys.ease_between(frame, strike - 4, strike + 2) * (
                1.0 - keys.ease_between(frame, strike + 3, strike + 12)
            )
            bowed = pose.blended(low, down)
            bowed.paws, bowed.tail = pose.paws, pose.tail
            bowed.pelvis[1] -= 0.045 * shove
            bowed.head[0] -= 0.22 * shove
            self.poses[frame] = bowed
        self.scene.event(self.instance, "nudge", frames, thing)

    def watch(self, targets: Sequence[Vector] | Vector, frames: Frames, *, ease_frames: int = 8) -> None:
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

    def tilt(self, roll: float, frames: Frames) -> None:
        """Leans the head to one side for a while and half shuts its mouth: what a petted dog does."""
        first, last = frames
        for frame in range(first, last + 1):
            share = keys.ease_between(frame, first, first + 8) * (
                1 - keys.ease_between(frame, last - 8, last)
            )
            self.poses[frame].head[2] += share * (roll + 0.05 * math.sin(2 * math.pi * frame / 34.0))
            self.poses[frame].head[0] -= 0.12 * share

    def wag(self, frames: Frames, amount: float = 0.35) -> None:
        """Swings the tail."""
        self._wags.append((frames, amount))

    def crown(self, frame: int) -> Vector:
        """The top of its head in the world."""
        pose = self.poses[frame]
        return pose.world() @ (trunk(pose)["head"] @ Vector((0.0, -0.375, 0.654)))

    def shoulders(self, frame: int) -> Vector:
        """The top of its withers in the world."""
        pose = self.poses[frame]
        return pose.world() @ (trunk(pose)["chest"] @ Vector((0.0, -0.150, 0.486)))

    # ---- keys ------------------------------------------------------------------------------------

    def finish(self) -> None:
        """Adds wagging and panting, solves every frame and keys the rig."""
        beat = self._rng.uniform(0.0, 6.3)
        for frame, pose in enumerate(self.poses):
            pant = 0.5 + 0.5 * math.sin(2 * math.pi * 1.6 * frame / FPS + beat)
            pose.jaw[0] += 0.20 + 0.10 * pant
            pose.spine[1, 0] += 0.006 * math.sin(2 * math.pi * 0.8 * frame / FPS + beat)
            for (first, last), amount in self._wags:
                share = keys.ease_between(frame, first, first + 8) * (
                    1 - keys.ease_between(frame, last - 8, last)
                )
                for i in range(anatomy.TAIL_BONES):
                    pose.tail[i, 1] += share * amount * math.sin(2 * math.pi * 2.0 * frame / FPS - 0.45 * i)
        keys.key_matrices(self.rig, [pose.world() for pose in self.poses])
        rest = {bone.name: bone.matrix_local.copy() for bone in self.rig.data.bones}
        bones = []
        for pose in self.poses:
            moved = solve(pose)
            bones.append({name: moved[name] @ rest[name] for name in rest})
        keys.key_bones(self.rig, bones, space="armature")

    def _hold(self, frame: int) -> None:
        for later in range(frame + 1, FRAME_COUNT):
            self.poses[later] = self.poses[frame].copy()

    def _aim(self, pose: Pose, target: Vector) -> np.ndarray:
        """Head pitch, yaw, roll that point the nose at a world point, within what a neck can do."""
        eyes = trunk(pose)["head"] @ anatomy.joint("skull")
        to = pose.world().inverted() @ target - eyes
        yaw = max(-1.2, min(1.2, math.atan2(to.x, -to.y)))
        pitch = max(-0.55, min(0.75, math.atan2(-to.z, math.hypot(to.x, to.y))))
        return np.array([pitch, yaw, 0.10 * yaw])


class _Track:
    """A path that goes straight on beyond both of its ends; its heading never jumps by a full turn."""

    def __init__(self, path: keys.Path, start_heading: float) -> None:
        self._path, self.length = path, path.length
        self._samples = np.arange(-1.0, path.length + 1.0, 0.02)
        ahead = [self.point(s + 0.06) - self.point(s - 0.06) for s in self._samples.tolist()]
        headings = np.unwrap([math.atan2(way.x, -way.y) for way in ahead])
        turns = round((start_heading - headings[0]) / (2 * math.pi))
        self._headings = headings + 2 * math.pi * turns

    def point(self, s: float) -> Vector:
        inside = min(max(s, 0.0), self.length)
        return self._path.point(inside) + (s - inside) * self._path.tangent(inside)

    def heading(self, s: float) -> float:
        return float(np.interp(s, self._samples, self._headings))


class _Gait:
    """Foot plants of a running trot along a track; `u` is 0..1 over its time."""

    def __init__(self, track: _Track, start: Pose, seconds: float) -> None:
        self._track = track
        self._beats = max(1, round(track.length / STRIDE_M)) + SWING
        if self._beats / seconds > 2.9:
            raise ValueError(f"{track.length:.2f} m in {seconds:.2f} s: {self._beats / seconds:.1f} Hz")
        self._steps = {paw: self._plan(paw, start.paws[i]) for i, paw in enumerate(PAWS)}

    def _plan(self, paw: str, start: np.ndarray) -> list[tuple[float, float, np.ndarray]]:
        """Swings of a paw as (lift-off, landing, plant), in strides."""
        swings, lift = [], PHASE[paw]
        while lift + SWING <= self._beats + 1e-6:
            landing = lift + SWING
            middle = landing + (1 - SWING) / 2
            s = self._distance(middle / self._beats)
            if lift + 1 + SWING > self._beats + 1e-6:
                s = min(self._track.length, self._distance(landing / self._beats) + REACH_AHEAD_M)
            swings.append((lift, landing, self._neutral(paw, s)))
            lift += 1.0
        return [(-1.0, 0.0, start), *swings]

    def _distance(self, u: float) -> float:
        """Metres gone at u: even speed with soft start and stop."""
        soft = 0.26
        u = min(max(u, 0.0), 1.0)
        peak = 1.0 / (1.0 - soft)
        if u < soft:
            return self._track.length * peak * u * u / (2 * soft)
        if u > 1 - soft:
            return self._track.length * (1 - peak * (1 - u) ** 2 / (2 * soft))
        return self._track.length * peak * (u - soft / 2)

    def _neutral(self, paw: str, s: float) -> np.ndarray:
        kind, side = paw.split(".")
        x, y = (0.060, -0.196) if kind == "fore" else (0.064, 0.268)
        at = s - y
        heading = self._track.heading(at)
        left = Vector((math.cos(heading), math.sin(heading), 0.0)) * (x if side == "L" else -x)
        point = self._track.point(at) + left
        return np.array([point.x, point.y, 0.0, 0.0, heading, 0.0])

    def pose(self, u: float, rest: Pose) -> Pose:
        pose = rest.copy()
        beat, s = u * self._beats, self._distance(u)
        moving = min(1.0, 6 * u, 6 * (1 - u))
        hips, chest = self._track.point(s - 0.255), self._track.point(s + 0.20)
        forward = chest - hips
        along = self._track.heading(s)
        heading = along + math.remainder(math.atan2(forward.x, -forward.y) - along, 2 * math.pi)
        middle = hips.lerp(chest, 0.255 / 0.455)
        pose.root = np.array([middle.x, middle.y, heading])
        swing = 2 * math.pi * beat
        pose.pelvis[2] += moving * (-0.022 + 0.016 * math.cos(2 * swing - 0.5))
        pose.pelvis_turn = moving * np.array(
            [0.03 * math.sin(2 * swing), 0.03 * math.sin(swing), 0.05 * math.cos(swing)]
        )
        rear = self._track.heading(s - 0.22) - heading
        front = self._track.heading(s + 0.22) - heading
        pose.pelvis_turn[2] += rear
        pose.spine[:, 1] += (front - rear - moving * 0.08 * math.cos(swing)) / 3
        pose.spine[:, 0] += moving * 0.02 * math.sin(2 * swing + 1.0)
        pose.neck[0] += moving * 0.22
        turning = self._track.heading(s + 0.5) - heading
        pose.head = np.array([0.05 + 0.03 * moving * math.sin(2 * swing), 0.8 * front + 0.4 * turning, 0.0])
        pose.tail[:, 1] += (
            moving * 0.10 * np.array([math.sin(swing - 0.5 * i) for i in range(len(pose.tail))])
        )
        for i, paw in enumerate(PAWS):
            pose.paws[i] = self._paw(paw, beat)
        return pose

    def _paw(self, paw: str, beat: float) -> np.ndarray:
        swings = self._steps[paw]
        current = max(k for k, step in enumerate(swings) if step[0] <= beat)
        lift, landing, plant = swings[current]
        fore = paw.startswith("fore")
        peel = 0.85 if fore else 0.75
        if beat >= landing:
            row = plant.copy()
            following = swings[current + 1][0] if current + 1 < len(swings) else None
            if following is not None and following > 0.2:
                row[3] = peel * keys.ease((beat - following + 0.16) / 0.16)
            return row
        t = (beat - lift) / (landing - lift)
        before = swings[current - 1][2]
        row = before + keys.ease(t) * (plant - before)
        row[2] += (0.095 if fore else 0.070) * math.sin(math.pi * t) ** 1.1
        started = lift > 0.2
        row[3] = (peel if started else peel * keys.ease(t / 0.3)) * (1 - keys.ease(1.3 * t))
        row[5] += (0.75 if fore else -0.35) * math.sin(math.pi * t) ** 2
        return row
