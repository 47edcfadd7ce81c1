"""Cats that act: animation and ground truth by the same call.

Postures and limbs are cat_poses.py's business, what cats share with dogs quadrupeds.py's, shape is
assets/cat.py.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from mathutils import Matrix, Vector

from ..assets import cat as shape
from ..assets import cat_anatomy as anatomy
from ..scene import keys
from ..scene.scene import Scene
from ..scene.timeline import FPS, LAST_FRAME
from .ball_games import Ball
from .cat_poses import PAW_TIP_RADIUS_M, POSTURES, CatPose, body, sitting, solve, standing, toe_lift
from .quadrupeds import PAWS, Frames, Gait, Quadruped

Ground = Callable[[float, float], float]


def level(height_m: float) -> Ground:
    """Ground of one height everywhere."""
    return lambda x, y: height_m


FLOOR = level(0.0)


@dataclass(frozen=True)
class Tap:
    """A paw strikes a ball at `frame`; the ball comes to rest at `to` (world x, y) at frame `rest`."""

    frame: int
    paw: str
    to: tuple[float, float]
    rest: int


class Cat(Quadruped[CatPose]):
    """One cat of a scene."""

    STEP_STARTS = (0.0, 0.18, 0.36, 0.54)
    STEP_SHARE = 0.42
    STEP_LIFT = (0.8, 0.028)
    GAZE = (1.25, -0.6, 0.85, 0.12)
    SETTLE_FRAMES = 7

    def __init__(
        self,
        scene: Scene,
        name: str,
        id: int,
        *,
        coat: shape.Coat,
        collar: str = "none",
        at: Sequence[float],
        heading_deg: float,
        ground: Ground = FLOOR,
        posture: str = "stand",
        tail_side: float = 1.0,
        attributes: Mapping[str, str] | None = None,
    ) -> None:
        """`at` is (x, y) of the middle, `heading_deg` 0 faces -Y; posture stand, sit, crouch, poise or sleep.

        `ground` gives the height in metres of what is underfoot at (x, y).
        """
        self._ground, self._tail_side = ground, tail_side
        self._asleep = posture == "sleep"
        start = self._posture(posture, np.array([at[0], at[1], math.radians(heading_deg)]))
        made = shape.cat(name, scene.rng(f"coat/{coat.name}"), coat=coat, collar=collar)
        super().__init__(scene, name, id, "cat", made, attributes, start)

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
        gait = _Walk(path, start, (last - first) / FPS, self._ground)
        self._go(gait, standing(start.root, float(start.floor[0])), frames)
        self.scene.event(self.instance, "walk", frames)

    def play_with(self, ball: Ball, taps: Sequence[Tap], frames: Frames) -> None:
        """Strikes the ball with a paw at every tap, eyes on it; records `bat` over `frames`."""
        for tap in taps:
            ball.roll_to(tap.to, (tap.frame, tap.rest))
        for tap in taps:
            self._strike(ball, tap)
        self.watch([c.copy() for c in ball.centres], frames)
        self.scene.event(self.instance, "bat", frames, ball.instance)

    def _joint(self, name: str) -> Vector:
        return anatomy.joint(name)

    def _body(self, pose: CatPose) -> dict[str, Matrix]:
        return body(pose)

    def _solve(self, pose: CatPose) -> dict[str, Matrix]:
        return solve(pose)

    def _posture(self, posture: str, root: np.ndarray) -> CatPose:
        floor = self._ground(root[0], root[1])
        pose = sitting(root, floor, self._tail_side) if posture == "sit" else POSTURES[posture](root, floor)
        for paw in pose.paws:
            paw[2] += self._ground(paw[0], paw[1]) - floor
        return pose

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
        self, pose: CatPose, paw: int, centre: Vector, direction: Vector, radius: float
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
        return np.array([pad.x, pad.y, pad.z - toe_lift(pitch), pitch, yaw, 0.0])

    def _live(self) -> None:
        """Blinks and breathes, and the tail's tip sways."""
        if self._asleep:
            return
        for frame, pose in enumerate(self.poses):
            pose.breath[0] = math.sin(2 * math.pi * 0.7 * frame / FPS)
            sway = math.sin(2 * math.pi * 0.6 * frame / FPS + self.instance.id)
            pose.tail[5:, 1] += 0.10 * sway
        for blink in (self._rng.randrange(8, 40), self._rng.randrange(50, 88)):
            for frame in range(blink, blink + 7):
                self.poses[frame].lids[0] = max(
                    self.poses[frame].lids[0], math.sin(math.pi * (frame - blink) / 6)
                )


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


class _Walk(Gait[CatPose]):
    """Foot plants of a lateral-sequence walk."""

    STRIDE_M = 0.36
    SWING = 0.40
    # A lateral sequence that starts with a forefoot: hind feet can stay behind longest.
    PHASE: ClassVar = {"fore.R": 0.0, "hind.L": 0.25, "fore.L": 0.5, "hind.R": 0.75}
    SOFT = 0.24
    STANCE: ClassVar = {"fore": (0.030, -0.128), "hind": (0.036, 0.150)}
    REACH_AHEAD_M = 0.11
    MAX_HZ = 2.6

    def __init__(self, track: _Track, start: CatPose, seconds: float, ground: Ground) -> None:
        self._ground, self._heading = ground, start.root[2]
        super().__init__(track, start, seconds)

    def _height(self, point: Vector) -> float:
        return self._ground(point.x, point.y)

    def _unwrapped(self, heading: float) -> float:
        return self._heading + (heading - self._heading + math.pi) % (2 * math.pi) - math.pi

    def pose(self, u: float, rest: CatPose) -> CatPose:
        """The pose at a share of the time."""
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
