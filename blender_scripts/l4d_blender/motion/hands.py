"""Hands that act on a table: each method animates a hand (and what it moves) and records what it shows.

Actions are planned in rising frame order; `finish` turns the plan into keys. The arm follows from a fixed
shoulder. Knows timing and touch; shapes are in assets/hand.py, finger poses in grips.py, the arm in arm.py.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import pi, radians

import numpy as np
from mathutils import Matrix, Vector

from ..assets.anatomy import vec
from ..assets.hand import DIGITS, HandLook, hand
from ..scene import keys
from ..scene.scene import Instance, RecipeError, Scene
from ..scene.timeline import FPS, FRAME_COUNT, LAST_FRAME, MIN_EVENT_FRAMES
from .arm import DOWN, Arm, matrix_of, thumbward
from .grips import POSES, Placed, Pose, Solid, digit_frames, digit_samples, palm_samples
from .ik import between, ease, smooth, turn_z, unit

ROWS = np.arange(FRAME_COUNT)
Frames = tuple[int, int]
Point = Sequence[float]


class Hand:
    """One hand of a scene, on an arm that comes from `shoulder` (all points in world metres).

    `rest_at` is where the palm lies at frame 0; `heading_deg` is the direction of the fingers (0: -Y,
    counter-clockwise from above; default: away from the shoulder); `table_m` is the height of the table top.
    """

    def __init__(
        self,
        scene: Scene,
        name: str,
        id: int,
        *,
        side: str = "r",
        look: HandLook | None = None,
        category: str = "hand",
        attributes: Mapping[str, str] | None = None,
        shoulder: Point,
        rest_at: Point,
        heading_deg: float | None = None,
        table_m: float = 0.0,
        pose: str = "relaxed",
    ) -> None:
        self.scene, self.side, self.table_m = scene, side, table_m
        self.body = hand(name, scene.rng(name), look=look or HandLook(), side=side)
        self.scale = self.body.scale
        self.instance = scene.instance(
            name,
            id,
            category,
            self.body.meshes,
            attributes=attributes,
            front="-y",
            frame_object=self.body.rig,
        )
        self.shoulder = np.array(shoulder, float)
        self._phase = scene.rng(f"{name}/idle").uniform(0.0, 2.0 * pi)
        start = self._resting(np.array(rest_at, float), self._heading_to(rest_at, heading_deg), POSES[pose])
        self._place = np.tile(start, (FRAME_COUNT, 1, 1))
        self._pose = np.tile(POSES[pose], (FRAME_COUNT, 1, 1))
        self._busy = np.zeros(FRAME_COUNT)
        self._home = (start.copy(), POSES[pose])
        self._holding: Instance | None = None
        self._fist: np.ndarray | None = None
        self._retreat = vec(0, 0, 1)
        self._keyed: dict[str, list[Matrix]] = {}

    # ---- empty-handed ----------------------------------------------------------------------------

    def move_to(
        self,
        point: Point,
        frames: Frames,
        *,
        heading_deg: float | None = None,
        pose: str = "relaxed",
        arc_m: float = 0.05,
    ) -> None:
        """Moves through the air and comes to rest with the palm on (or over) a point."""
        goal = self._resting(np.array(point, float), self._heading_to(point, heading_deg), POSES[pose])
        goal[2, 3] = max(goal[2, 3], goal[2, 3] + float(point[2]) - self.table_m)
        self._travel(goal, POSES[pose], frames, arc_m)

    def point_at(self, target: Instance | Point, frames: Frames, *, height_m: float = 0.09) -> None:
        """Stretches the index finger towards something and keeps it there."""
        goal = np.array(
            target.matrix(frames[1]).translation if isinstance(target, Instance) else target, float
        )
        here = self._place[frames[0]][:3, 3]
        flat = unit((goal - here) * vec(1, 1, 0))
        turned = _rotation(flat + 0.22 * DOWN, DOWN + 0.35 * thumbward(self.side, flat))
        place = matrix_of(turned, np.array([*here[:2], self.table_m + height_m]) + 0.03 * flat)
        self._travel(place, POSES["point"], (frames[0], min(frames[0] + 16, frames[1])), 0.03)
        if isinstance(target, Instance):
            self.scene.event(self.instance, "point_at", frames, target)
        else:
            self.scene.event(self.instance, "point", frames)

    def withdraw(self, frames: Frames, *, to: Point | None = None) -> None:
        """Goes back to where it began (or to a point) and rests."""
        if self._holding is not None:
            raise RecipeError(
                f"{self.instance.name} withdraws while it holds {self._holding.name}", "release first"
            )
        if to is not None:
            self.move_to(to, frames)
        else:
            self._travel(*self._home, frames, 0.04)

    # ---- taking and letting go -------------------------------------------------------------------

    def approach(
        self,
        thing: Instance,
        frames: Frames,
        *,
        grip: str = "mouse",
        heading_deg: float | None = None,
        point: Point | None = None,
    ) -> None:
        """Reaches for something and closes round it, so that flesh touches at the last frame.

        `grip` is mouse (palm on top, fingers curled over), flat (palm on top, fingers straight), side (wraps
        a cup or bottle from the thumb side), top (fingers round it from above), pinch (thumb against
        fingertips) or push (fingertips against it). `heading_deg` is where the fingers point, `point` another
        spot to aim at than the middle of the thing.
        """
        if self._holding is not None:
            raise RecipeError(f"{self.instance.name} already holds {self._holding.name}", "release it first")
        first, last = frames
        solid = Solid(thing.objects, last)
        heading = self._heading_to(solid.centre if point is None else point, heading_deg)
        before, place, opened, closed, away = self._fit(solid, grip, heading, point)
        split = first + round(0.68 * (last - first))
        self._travel(before, opened, (first, split), 0.05, blend_end=0.35)
        self._travel(place, closed, (split, last), 0.0)
        self._holding, self._retreat, self._opened = thing, away, opened
        self._fist = np.linalg.inv(np.array(thing.matrix(last))) @ place
        self._since = last

    def _fit(
        self, solid: Solid, grip: str, heading: float, point: Point | None
    ) -> tuple[np.ndarray, np.ndarray, Pose, Pose, np.ndarray]:
        """Pre-grasp place, grasp place, open pose, closed pose and the direction to back away in."""
        fingers, aim = (
            turn_z(heading) @ vec(0, -1, 0),
            solid.centre if point is None else np.array(point, float),
        )
        thumb = thumbward(self.side, fingers)
        names = {
            "mouse": ("mouse_open", "mouse_closed"),
            "flat": ("flat", "relaxed"),
            "side": ("open_wide", "wrapped"),
            "top": ("open_wide", "wrapped"),
            "pinch": ("pinch_open", "pinch_closed"),
            "push": ("flat", "flat"),
        }
        if grip not in names:
            raise RecipeError(f"unknown grip {grip!r}", f"one of {', '.join(names)}")
        opened, closed = (POSES[n] for n in names[grip])
        if grip in ("mouse", "flat", "top"):
            turned, way = _rotation(fingers + 0.10 * DOWN, DOWN), DOWN
            contact = vec(0, -0.076 if grip == "mouse" else -0.085, -0.012)
            start = np.array([*aim[:2], solid.high[2] + 0.06])
        elif grip == "side":
            turned, way = _rotation(fingers + 0.12 * DOWN, thumb + 0.05 * DOWN), thumb
            contact = vec(0.010, -0.086, -0.012)
            start = aim - way * (0.5 * float(np.abs(solid.high - solid.low) @ np.abs(way)) + 0.06)
        elif grip == "pinch":
            turned, way = (
                _rotation(fingers + 0.55 * DOWN, DOWN - 0.55 * fingers + 0.35 * thumb),
                fingers + 0.3 * DOWN,
            )
            tips = [digit_frames(d, opened[n])[0][3] for n, d in enumerate(DIGITS[:3])]
            contact, start = 0.5 * tips[0] + 0.25 * (tips[1] + tips[2]), aim
        else:
            turned, way = _rotation(fingers + 0.16 * DOWN, DOWN + 0.15 * fingers), fingers
            contact = vec(0.0, -0.185, -0.004)
            start = aim - way * (0.5 * float(np.abs(solid.high - solid.low) @ np.abs(way)) + 0.06)
        way = unit(way)
        hand = Placed(matrix_of(turned, vec(0, 0, 0)), self.side, self.scale, self.table_m)
        hand.matrix[:3, 3] = start - hand.world(contact[None])[0]
        if grip != "pinch":
            hand.advance(solid, opened, way, 0.16, tips=grip == "push")
            hand.matrix[2, 3] = max(hand.matrix[2, 3], self.table_m + 0.0215 * self.scale)
        place = hand.matrix.copy()
        pose = opened if grip == "push" else hand.close(solid, opened, closed)
        before = place.copy()
        before[:3, 3] -= way * (0.05 if grip != "mouse" else 0.045)
        return before, place, opened, pose, -way

    def release(self, frames: Frames) -> None:
        """Opens the fingers and backs a hand's breadth away."""
        thing = self._require("let go")
        first = frames[0]
        self._note_hold(thing, first)
        goal = self._place[first].copy()
        goal[:3, 3] += self._retreat * 0.05 + vec(0, 0, 0.012)
        self._travel(goal, self._opened, frames, 0.0, pose_first=True)
        self._holding = None

    # ---- moving things ---------------------------------------------------------------------------

    def slide(
        self,
        path: Sequence[Point],
        frames: Frames,
        *,
        verb: str = "push",
        turn_deg: float = 0.0,
        thing_verb: str | None = "slide",
        ease_ends: bool = True,
    ) -> None:
        """Slides what it touches over the table: its origin follows `path` (points after its place now)."""
        thing = self._require("slide")
        first, last = frames
        start = thing.matrix(first) if thing.name not in self._keyed else self._keyed[thing.name][first]
        way = keys.Path(
            [tuple(start.translation), *[(float(p[0]), float(p[1]), start.translation.z) for p in path]]
        )
        moved = []
        for f in range(FRAME_COUNT):
            t = np.clip((f - first) / (last - first), 0.0, 1.0)
            u = float(ease(t)) if ease_ends else float(t)
            shift = Matrix.Translation(way.point(u * way.length) - start.translation)
            moved.append(shift @ _spin(start, radians(turn_deg) * u) @ start)
        self._carry(thing, moved, first)
        self.scene.event(self.instance, verb, frames, thing)
        if thing_verb:
            self.scene.event(thing, thing_verb, frames)

    def lift(self, frames: Frames, *, height_m: float = 0.12, toward: Point | None = None) -> None:
        """Raises what it holds straight up, or up and over towards a point."""
        thing = self._require("lift")
        start = self._where(thing, frames[0])
        goal = start.copy()
        goal.translation.z += height_m
        if toward is not None:
            goal.translation.x, goal.translation.y = float(toward[0]), float(toward[1])
        self._carry_between(thing, start, goal, frames, rise_first=True)
        self.scene.event(self.instance, "lift", frames, thing)

    def carry(self, to: Point, frames: Frames, *, tilt_deg: float = 0.0, turn_deg: float = 0.0) -> None:
        """Moves what it holds through the air, so that its origin ends at a point; may tip it (to pour)."""
        thing = self._require("carry")
        start = self._where(thing, frames[0])
        axis = start.to_3x3().inverted() @ Vector(self._place[frames[0]][:3, :3] @ vec(0, 1, 0))
        goal = (
            Matrix.Translation(to)
            @ Matrix.Rotation(radians(turn_deg), 4, "Z")
            @ start.to_3x3().to_4x4()
            @ Matrix.Rotation(radians(tilt_deg), 4, axis)
        )
        self._carry_between(thing, start, goal, frames)
        self.scene.event(self.instance, "carry", frames, thing)

    def put_down(self, at: Point, frames: Frames) -> None:
        """Sets what it holds upright on a point (where its origin comes to rest); `release` follows."""
        thing = self._require("put down")
        start = self._where(thing, frames[0])
        upright = Matrix.Rotation(start.to_euler().z, 4, "Z")
        self._carry_between(thing, start, Matrix.Translation(at) @ upright, frames, fall_last=True)
        self.scene.event(self.instance, "put_down", frames, thing)

    def _carry_between(
        self,
        thing: Instance,
        start: Matrix,
        goal: Matrix,
        frames: Frames,
        *,
        rise_first: bool = False,
        fall_last: bool = False,
    ) -> None:
        first, last = frames
        a, b = np.array(start), np.array(goal)
        moved = []
        for f in range(FRAME_COUNT):
            t = (f - first) / (last - first)
            u = float(ease(t))
            across = (
                float(ease((t - 0.25) / 0.75)) if rise_first else float(ease(t / 0.75)) if fall_last else u
            )
            matrix = np.eye(4)
            matrix[:3, :3] = between(a[:3, :3], b[:3, :3], across)
            matrix[:3, 3] = a[:3, 3] + (b[:3, 3] - a[:3, 3]) * np.array([across, across, u])
            moved.append(Matrix(matrix))
        self._carry(thing, moved, first)

    def _carry(self, thing: Instance, moved: list[Matrix], first: int) -> None:
        """Keys a thing from `first` on; the hand keeps its grip on it."""
        before = self._keyed.get(thing.name) or [thing.matrix(f) for f in range(FRAME_COUNT)]
        track = [before[f] if f < first else moved[f] for f in range(FRAME_COUNT)]
        rest = before[first].inverted()
        for obj in thing.objects:
            if obj.parent is None:
                old = [keys.object_matrix(obj, f) for f in range(FRAME_COUNT)]
                keys.key_matrices(
                    obj, [old[f] if f < first else moved[f] @ rest @ old[first] for f in range(FRAME_COUNT)]
                )
        self._keyed[thing.name] = track
        for f in range(first, FRAME_COUNT):
            self._place[f] = np.array(moved[f]) @ self._fist
        self._busy[first:] = 1.0

    # ---- small helpers ---------------------------------------------------------------------------

    def _require(self, verb: str) -> Instance:
        if self._holding is None:
            raise RecipeError(
                f"{self.instance.name} can't {verb}: it holds nothing", "approach something first"
            )
        return self._holding

    def _where(self, thing: Instance, frame: int) -> Matrix:
        return self._keyed[thing.name][frame].copy() if thing.name in self._keyed else thing.matrix(frame)

    def _note_hold(self, thing: Instance, until: int) -> None:
        if until - self._since + 1 >= MIN_EVENT_FRAMES:
            self.scene.event(self.instance, "hold", (self._since, until), thing)

    def _heading_to(self, point: Point, heading_deg: float | None) -> float:
        """Fingers point away from the shoulder, turned a little inwards, as arms do (radians)."""
        if heading_deg is not None:
            return radians(heading_deg)
        way = np.array([float(point[0]), float(point[1])]) - self.shoulder[:2]
        inwards = 0.22 if self.side == "r" else -0.22
        return float(np.arctan2(way[0], -way[1])) + inwards

    def _resting(self, palm_at: np.ndarray, heading: float, pose: Pose) -> np.ndarray:
        """A hand that lies with its palm's middle over a point, as low as table and fingers allow."""
        turned = _rotation(turn_z(heading) @ vec(0, -1, 0) + 0.03 * DOWN, DOWN)
        hand = Placed(matrix_of(turned, vec(0, 0, 0)), self.side, self.scale, self.table_m)
        at = np.concatenate([hand.world(_flesh(pose)[0])])
        lowest = float((at[:, 2] - _flesh(pose)[1] * self.scale).min())
        middle = hand.world(vec(0, -0.065, 0)[None])[0]
        return matrix_of(turned, np.array([*(palm_at[:2] - middle[:2]), self.table_m - lowest + 0.0003]))

    def _travel(
        self,
        goal: np.ndarray,
        pose: Pose,
        frames: Frames,
        arc_m: float,
        *,
        blend_end: float = 0.0,
        pose_first: bool = False,
    ) -> None:
        """Eases place and pose to a goal and stays there."""
        first, last = frames
        start, start_pose = self._place[max(first, 0)].copy(), self._pose[max(first, 0)].copy()
        for f in range(max(first, 0), FRAME_COUNT):
            t = min((f - first) / max(last - first, 1), 1.0)
            u = float(ease(t))
            lift = arc_m * np.sin(pi * u) ** 1.2
            matrix = np.eye(4)
            matrix[:3, :3] = between(start[:3, :3], goal[:3, :3], u)
            gone = float(ease((t - 0.4) / 0.6)) if pose_first else u
            matrix[:3, 3] = start[:3, 3] + (goal[:3, 3] - start[:3, 3]) * gone + vec(0, 0, lift)
            self._place[f] = matrix
            self._pose[f] = start_pose + (pose - start_pose) * float(ease(t / 0.6) if pose_first else u)
        self._busy[max(first, 0) :] = 1.0
        self._busy[min(last + 1, LAST_FRAME) :] = 0.0

    # ---- keys ------------------------------------------------------------------------------------

    def finish(self) -> None:
        """Turns the plan into keys; call it once, after the last action."""
        if self._holding is not None:
            self._note_hold(self._holding, LAST_FRAME)
            self._busy[self._since :] = 1.0
        calm = 1.0 - smooth(np.clip(self._busy, 0.0, 1.0), 3.0)
        stir = 0.022 * np.sin(2 * pi * 0.33 * ROWS / FPS + self._phase)[:, None] * np.linspace(1.0, 0.4, 5)
        poses = self._pose.copy()
        poses[:, :, 1] += np.minimum(stir, 0.0) * calm[:, None]
        arm = Arm(self.instance.name, self.side, self.scale, self.shoulder, self.table_m, self._place)
        world = [self._place[f] for f in range(FRAME_COUNT)]
        bones = [arm.bones(world[f], poses[f], arm.elbows[f], arm.shoulders[f]) for f in range(FRAME_COUNT)]
        rest = {bone.name: np.array(bone.matrix_local) for bone in self.body.rig.data.bones}
        keys.key_matrices(self.body.rig, [Matrix(m) for m in world])
        keys.key_bones(
            self.body.rig,
            [{n: Matrix(m @ rest[n]) for n, m in pose.items()} for pose in bones],
            space="armature",
        )
        self.elbows = arm.elbows


def wrist_bend(hand: Hand) -> float:
    """Largest angle in radians between hand and forearm over the clip: people manage about 1.2."""
    worst = 0.0
    for place, elbow in zip(hand._place, hand.elbows):
        way = unit(place[:3, 3] - elbow)
        worst = max(worst, float(np.arccos(np.clip(way @ (place[:3, :3] @ vec(0, -1, 0)), -1, 1))))
    return worst


def _flesh(pose: Pose) -> tuple[np.ndarray, np.ndarray]:
    points, radii = palm_samples(pose)
    extra = [digit_samples(d, pose[n])[:2] for n, d in enumerate(DIGITS)]
    points = np.vstack([points, vec(0.0, 0.03, 0.0), *[p for p, _ in extra]])
    return points, np.concatenate([radii, [0.021], *[r for _, r in extra]])


def _rotation(along: np.ndarray, palm: np.ndarray) -> np.ndarray:
    """Rotation of a hand whose fingers point `along` and whose palm looks towards `palm`."""
    y = -unit(along)
    z = -unit(palm - (palm @ y) * y)
    return np.stack([np.cross(y, z), y, z], axis=1)


def _spin(start: Matrix, angle: float) -> Matrix:
    at = Matrix.Translation(start.translation)
    return at @ Matrix.Rotation(angle, 4, "Z") @ at.inverted()
