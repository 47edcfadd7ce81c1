"""Dogs that act: run with planted paws, sit, lie down, get up, look about, nudge a ball with the nose.

Postures and limbs are dog_poses.py's business, what dogs share with cats quadrupeds.py's, shape is
assets/dog.py.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import ClassVar

import numpy as np
from mathutils import Matrix, Vector

from ..assets import dog as anatomy
from ..scene import keys
from ..scene.scene import Instance, Scene
from ..scene.timeline import FPS
from .dog_poses import NOSE_TIP, POSTURES, DogPose, solve, standing, trunk
from .quadrupeds import PAWS, Frames, Gait, Quadruped


class Dog(Quadruped[DogPose]):
    """One dog of a scene."""

    STEP_STARTS = (0.0, 0.15, 0.30, 0.45)
    STEP_SHARE = 0.5
    STEP_LIFT = (0.4, 0.045)
    GAZE = (1.2, -0.55, 0.75, 0.10)
    SETTLE_FRAMES = 8

    def __init__(
        self,
        scene: Scene,
        name: str,
        id: int,
        *,
        coat: str,
        collar: str,
        at: Sequence[float],
        heading_deg: float,
        posture: str = "stand",
        attributes: Mapping[str, str] | None = None,
    ) -> None:
        """`at` is (x, y) of the middle, `heading_deg` 0 faces -Y; posture stand, sit or lie."""
        start = POSTURES[posture]((at[0], at[1], math.radians(heading_deg)))
        shape = anatomy.dog(name, scene.rng(f"coat/{coat}"), coat=coat, collar=collar)
        super().__init__(scene, name, id, "dog", shape, attributes, start)
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

    # ---- running ---------------------------------------------------------------------------------

    def run_along(
        self, points: Sequence[Sequence[float]], frames: Frames, *, after: Instance | None = None
    ) -> None:
        """Runs along a smooth curve from where it stands; `after` is what it chases."""
        self._travel(_Trot, points, frames)
        self.scene.event(self.instance, "run", frames)
        if after is not None:
            self.scene.event(self.instance, "chase", frames, after)

    def walk_along(self, points: Sequence[Sequence[float]], frames: Frames) -> None:
        """A four-beat walk along a smooth curve from where it stands."""
        self._travel(_Walk, points, frames)
        self.scene.event(self.instance, "walk", frames)

    def _travel(self, gait: type[_Trot], points: Sequence[Sequence[float]], frames: Frames) -> None:
        first, last = frames
        start = self.poses[first].copy()
        x, y, heading = start.root
        here = Vector((x, y, 0.0))
        ahead = here + 0.20 * Vector((math.sin(heading), -math.cos(heading), 0.0))
        track = _Track(keys.Path([here, ahead, *[Vector((p[0], p[1], 0.0)) for p in points]]), heading)
        self._go(gait(track, start, (last - first) / FPS), standing(start.root), frames)

    # ---- head and nose ---------------------------------------------------------------------------

    def nose_spot(self, frame: int, forward_m: float = 0.0) -> Vector:
        """Where the nose would be in the world if the dog put it down at a frame."""
        pose = POSTURES["sniff"](self.poses[frame].root)
        tip = pose.world() @ (trunk(pose)["head"] @ NOSE_TIP)
        heading = pose.root[2]
        return tip + forward_m * Vector((math.sin(heading), -math.cos(heading), 0.0))

    def nudge(self, thing: Instance, frames: Frames, *, strike: int, bow: float = 1.0) -> None:
        """Puts the nose down to a thing before its paws and shoves it at `strike`, then looks up again.

        `bow` says how far down the nose goes; `nudge_reach` tells it for a ball.
        """
        first, last = frames
        low = POSTURES["sniff"](self.poses[first].root)
        if bow < 1.0:
            low = standing(self.poses[first].root).blended(low, bow)
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

    def _joint(self, name: str) -> Vector:
        return anatomy.joint(name)

    def _body(self, pose: DogPose) -> dict[str, Matrix]:
        return trunk(pose)

    def _solve(self, pose: DogPose) -> dict[str, Matrix]:
        return solve(pose)

    def _posture(self, posture: str, root: np.ndarray) -> DogPose:
        return POSTURES[posture](root)

    def _live(self) -> None:
        """Pants, breathes and wags."""
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


class _Trot(Gait[DogPose]):
    """Foot plants of a running trot."""

    STRIDE_M = 0.80
    SWING = 0.57
    PHASE: ClassVar = {"fore.R": 0.0, "hind.L": 0.0, "fore.L": 0.5, "hind.R": 0.5}
    SOFT = 0.26
    STANCE: ClassVar = {"fore": (0.060, -0.196), "hind": (0.064, 0.268)}
    REACH_AHEAD_M = 0.12
    MAX_HZ = 2.9
    LIFT_M: ClassVar = {"fore": 0.095, "hind": 0.070}
    HEEL: ClassVar = {"fore": 0.75, "hind": -0.35}
    PEEL: ClassVar = {"fore": 0.85, "hind": 0.75}
    BOB_M = (-0.022, 0.016)

    def pose(self, u: float, rest: DogPose) -> DogPose:
        """The pose at a share of the time."""
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
        pose.pelvis[2] += moving * (self.BOB_M[0] + self.BOB_M[1] * math.cos(2 * swing - 0.5))
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
        kind = paw.split(".")[0]
        peel = self.PEEL[kind]
        if beat >= landing:
            row = plant.copy()
            following = swings[current + 1][0] if current + 1 < len(swings) else None
            if following is not None and following > 0.2:
                row[3] = peel * keys.ease((beat - following + 0.16) / 0.16)
            return row
        t = (beat - lift) / (landing - lift)
        before = swings[current - 1][2]
        row = before + keys.ease(t) * (plant - before)
        row[2] += self.LIFT_M[kind] * math.sin(math.pi * t) ** 1.1
        started = lift > 0.2
        row[3] = (peel if started else peel * keys.ease(t / 0.3)) * (1 - keys.ease(1.3 * t))
        row[5] += self.HEEL[kind] * math.sin(math.pi * t) ** 2
        return row


class _Walk(_Trot):
    """Foot plants of a lateral-sequence walk."""

    STRIDE_M = 0.62
    SWING = 0.42
    PHASE: ClassVar = {"fore.R": 0.0, "hind.L": 0.25, "fore.L": 0.5, "hind.R": 0.75}
    SOFT = 0.24
    MAX_HZ = 2.6
    LIFT_M: ClassVar = {"fore": 0.055, "hind": 0.042}
    HEEL: ClassVar = {"fore": 0.45, "hind": -0.22}
    PEEL: ClassVar = {"fore": 0.60, "hind": 0.50}
    BOB_M = (-0.016, 0.007)


def nudge_reach(radius_m: float) -> tuple[float, float]:
    """(how far a dog bows, metres from its middle to a ball's) so that its nose meets the ball."""
    shove = keys.ease(4 / 6)
    for k in range(101):
        bow = k / 100
        pose = standing((0.0, 0.0, 0.0)).blended(POSTURES["sniff"]((0.0, 0.0, 0.0)), bow)
        pose.pelvis[1] -= 0.045 * shove
        pose.head[0] -= 0.22 * shove
        nose = trunk(pose)["head"] @ NOSE_TIP
        if nose.z <= 1.15 * radius_m:
            break
    above = min(max(nose.z - radius_m, -0.9 * radius_m), 0.9 * radius_m)
    return bow, -nose.y + math.sqrt(radius_m**2 - above**2)
