"""Gulls and ducks that stand, walk, drink and eat from dishes, glide in to land, and swim.

Plans a pose per canonical frame and records what each bird does while it plans it. A bird's calls follow one
another in time and cover the whole clip; feet are planned on level ground at the bird's own height. Poses are
waterbird_pose.py's business, shapes those of assets/waterbird.py.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import bpy
from mathutils import Matrix, Vector

from .. import keys
from ..assets import waterbird as shape
from ..scene import Instance, Scene
from ..timeline import LAST_FRAME
from .waterbird_pose import SIDES, Pose, body_motion, solve

STEP_M = 0.115
DRAFT_M = 0.090  # how deep a floating bird's standing plane lies under the water
DIP_FRAMES = 20  # one sip: down, a moment at the water, up with a raised bill
PECK_FRAMES = 15

Row = tuple[float, ...]


class WaterBird:
    """Plays one bird through the clip: each call continues where the last one ended; `finish` keys it."""

    def __init__(
        self,
        scene: Scene,
        name: str,
        id: int,
        *,
        species: shape.Species,
        plumage: str,
        category: str,
        attributes: Mapping[str, str],
        at: Sequence[float],
        heading: float,
    ) -> None:
        """`at` is (x, y, z of what it stands on); `heading` 0 faces -Y, counter-clockwise from above."""
        body = shape.waterbird(name, scene.rng(f"plumage/{plumage}"), species=species, plumage=plumage)
        self.instance = scene.instance(
            name, id, category, body, attributes=attributes, front="-y", frame_object=body.parent
        )
        self._species, self._rig, self._rng = species, body.parent, scene.rng(f"{name}/acts")
        self._position, self._heading = Vector(at).to_3d(), heading
        self._roots: dict[int, Matrix] = {}
        self._poses: dict[int, Pose] = {}
        self._wake: tuple[bpy.types.Object, dict[int, float]] | None = None
        self._plant_feet()

    # ---- on its feet -----------------------------------------------------------------------------

    def stand(self, first: int, last: int) -> None:
        """Stands and looks about in the quick turns of a bird."""
        self._idle(first, last)
        self.instance.scene.event(self.instance, "stand", (first, last))

    def pause(self, first: int, last: int) -> None:
        """Stands for a moment that is not worth telling."""
        self._idle(first, last)

    def drink(self, dish: Instance, point: Sequence[float], first: int, last: int) -> None:
        """Dips the bill into the dish at a world point, raises it and swallows, sip after sip."""
        sips = max(1, round((last - first) / DIP_FRAMES))
        span = (last - first) / sips
        self._bow(point, first, last, [first + span * k for k in range(sips + 1)], 0.22, 0.72, 0.95, -0.55)
        self.instance.scene.event(self.instance, "drink", (first, last), dish)

    def eat(self, tray: Instance, point: Sequence[float], first: int, last: int) -> None:
        """Picks grain from the tray round a world point, peck after peck, staying low in between."""
        pecks = max(1, round((last - first - 12) / PECK_FRAMES))
        span = (last - first) / (pecks + 0.6)
        beats = [first + span * (k + 0.3 * (k > 0)) for k in range(pecks + 1)]
        self._bow(point, first, last, [*beats[:-1], float(last)], 0.66, 0.86, 1.0, 0.25)
        self.instance.scene.event(self.instance, "eat", (first, last), tray)

    def walk(self, path: keys.Path, first: int, last: int) -> None:
        """Waddles the whole path, which starts where the bird stands; both feet are down at either end."""
        steps = max(2, round(path.length / STEP_M))
        stride = path.length / steps
        landings = self._landings(path, steps, stride)
        start_heading = self._heading
        for frame in range(first, last + 1):
            s = path.length * _even((frame - first) / (last - first), 0.16)
            self._position = path.point(s)
            self._heading = start_heading + math.remainder(_heading(path, s) - start_heading, 2 * math.pi)
            inside = self._root().inverted()
            pose = self._standing()
            for side in SIDES:
                spot, yaw, lift, curl = _foot(landings[side], s / stride)
                pose.ankles[side] = inside @ spot + Vector((0.0, 0.0, lift))
                pose.foot_yaw[side] = math.remainder(yaw - self._heading, 2 * math.pi)
                pose.foot_pitch[side] = curl
            stir = min(1.0, s / stride, (path.length - s) / stride)
            swing = math.pi * s / stride
            pose.drop_m = 0.007 * stir + 0.003 * math.cos(2 * swing) * stir
            pose.roll = 0.06 * math.sin(swing) * stir
            pose.head += Vector((0.0, -0.008 * math.cos(2 * swing), -0.006)) * stir
            self._put(frame, pose)
        self._feet = {side: landings[side][-1][1:] for side in SIDES}
        self.instance.scene.event(self.instance, "walk", (first, last))

    def turn(self, heading: float, first: int, last: int) -> None:
        """Turns on the spot the short way, with small steps."""
        start = self._heading
        sweep = math.remainder(heading - start, 2 * math.pi)
        steps = max(2, 2 * round(abs(sweep) / 1.1))
        landings = {side: [(-1.0, *self._feet[side])] for side in SIDES}
        for k in range(steps):
            side = SIDES[k % 2]
            yaw = start + sweep * min(1.0, (k + 1.5) / steps)
            there = Matrix.Translation(self._position) @ Matrix.Rotation(yaw, 4, "Z")
            landings[side].append((k + 1.0, there @ self._species.joint("ankle", side), yaw))
        for frame in range(first, last + 1):
            u = _even((frame - first) / (last - first), 0.2)
            self._heading = start + sweep * u
            inside = self._root().inverted()
            pose = self._standing()
            for side in SIDES:
                spot, yaw, lift, curl = _foot(landings[side], u * steps)
                pose.ankles[side] = inside @ spot + Vector((0.0, 0.0, lift))
                pose.foot_yaw[side] = math.remainder(yaw - self._heading, 2 * math.pi)
                pose.foot_pitch[side] = curl
            pose.drop_m += 0.004 * math.sin(math.pi * u)
            pose.roll = 0.03 * math.sin(math.pi * u * steps)
            self._put(frame, pose)
        self._feet = {side: landings[side][-1][1:] for side in SIDES}

    # ---- in the air ------------------------------------------------------------------------------

    def glide_in(self, points: Sequence[Sequence[float]], first: int, touch: int, last: int) -> None:
        """Glides along points down to a spot, brakes with spread wings, lands at `touch`, folds by `last`."""
        path = keys.Path(points)
        self._position = path.point(path.length)
        self._heading = math.atan2(path.tangent(path.length).x, -path.tangent(path.length).y)
        self._plant_feet()
        rest, spots = self._heading, {side: spot for side, (spot, _) in self._feet.items()}
        for frame in range(first, last + 1):
            t = min(1.0, (frame - first) / (touch - first))
            s = path.length * (1.0 - (1.0 - t) ** 1.7)
            self._position = path.point(s)
            way = path.tangent(min(s, 0.9 * path.length))
            near = keys.ease((t - 0.6) / 0.4)
            travel = math.atan2(way.x, -way.y)
            self._heading = travel + near * math.remainder(rest - travel, 2 * math.pi)
            self._put(frame, self._airborne(frame, t, touch, last, spots))
        scene = self.instance.scene
        scene.event(self.instance, "fly", (first, touch))
        scene.event(self.instance, "land", (max(first, touch - 6), last))

    def _airborne(self, frame: int, t: float, touch: int, last: int, spots: dict[str, Vector]) -> Pose:
        flare = keys.ease((t - 0.38) / 0.45)
        down = keys.ease_between(frame, touch - 2, touch + 9)
        folding = keys.ease_between(frame, touch + 5, last)
        pose = self._standing()
        pose.pitch = (0.10 - 0.72 * flare) * (1.0 - down)
        pose.drop_m = 0.030 * math.sin(math.pi * min(1.0, max(0.0, (frame - touch) / 12.0)))
        strokes = math.sin(2.0 * math.pi * 2.4 * (frame - touch) / 24.0)
        power = flare * (1.0 - keys.ease_between(frame, touch, touch + 6))
        pose.spread = 1.0 - folding
        pose.flap = 0.13 + 0.42 * power * strokes + 0.30 * flare * (1.0 - folding) - 0.13 * folding
        pose.bend = -0.20 + 0.30 * power * math.sin(2.0 * math.pi * 2.4 * (frame - touch - 3) / 24.0)
        pose.bend *= 1.0 - folding
        body = body_motion(self._species, pose)
        stretched = body @ (self._species.joint("neck_top") + Vector((0.0, -0.030, -0.040)))
        pose.head = stretched.lerp(self._species.joint("neck_top") - Vector((0, 0, pose.drop_m)), down)
        pose.head_pitch = 0.12 * (1.0 - down)
        inside = self._root().inverted()
        lowered = keys.ease((t - 0.30) / 0.40)
        for side in SIDES:
            x = self._species.joint("ankle", side).x
            tucked = body @ Vector((0.7 * x, 0.145, 0.150))
            ready = Vector((1.2 * x, -0.030, 0.020))
            hanging = tucked.lerp(ready, lowered)
            planted = keys.ease((t - 0.80) / 0.20) if frame < touch else 1.0
            pose.ankles[side] = hanging.lerp(inside @ spots[side], planted)
            pose.foot_pitch[side] = (2.9 * (1.0 - lowered) - 0.5 * lowered) * (1.0 - planted)
        return pose

    # ---- on the water ----------------------------------------------------------------------------

    def swim(self, path: keys.Path, first: int, last: int, wake: bpy.types.Object | None = None) -> None:
        """Paddles along a path on the water; a wake mesh travels with it and grows with the pace."""
        start_heading = self._heading
        pace: dict[int, float] = {}
        for frame in range(first, last + 1):
            t = (frame - first) / (last - first)
            s = path.length * _even(t, 0.25)
            self._position = path.point(s)
            self._heading = start_heading + math.remainder(_heading(path, s) - start_heading, 2 * math.pi)
            pace[frame] = min(1.0, t / 0.25, (1.0 - t) / 0.25)
            self._put(frame, self._floating(frame, pace[frame]))
        self.instance.scene.event(self.instance, "swim", (first, last))
        if wake is not None:
            self._wake = wake, pace

    def rest(self, first: int, last: int) -> None:
        """Sits still on the water and looks about."""
        glances = self._glances(first, last)
        for frame in range(first, last + 1):
            pose = self._floating(frame, 0.0)
            pose.head_yaw, pose.head_pitch = _on_keys(glances, frame)
            self._put(frame, pose)
        self.instance.scene.event(self.instance, "rest", (first, last))

    def _floating(self, frame: int, pace: float) -> Pose:
        pose = self._standing()
        stroke = 2.0 * math.pi * 1.4 * frame / 24.0
        for side, sign in zip(SIDES, (1.0, -1.0), strict=True):
            x = self._species.joint("ankle", side).x
            pose.ankles[side] = Vector((x, 0.075 + 0.035 * pace * sign * math.sin(stroke), 0.035))
            pose.foot_pitch[side] = 0.9
        pose.drop_m = 0.003 * math.sin(2.0 * math.pi * 0.55 * frame / 24.0)
        pose.pitch = -0.03 * pace + 0.012 * math.sin(2.0 * math.pi * 0.5 * frame / 24.0)
        pose.roll = 0.03 * pace * math.sin(stroke)
        pose.head += Vector((0.0, -0.010 * pace * math.sin(2 * stroke), 0.0))
        return pose

    # ---- keys ------------------------------------------------------------------------------------

    def finish(self) -> None:
        """Keys the rig and its bones; the calls so far must have covered the whole clip."""
        missing = [frame for frame in range(LAST_FRAME + 1) if frame not in self._poses]
        if missing:
            raise ValueError(f"{self.instance.name} has nothing to do at frame {missing[0]}")
        rest = {bone.name: bone.matrix_local.copy() for bone in self._rig.data.bones}
        poses = {
            frame: {bone: moved @ rest[bone] for bone, moved in solve(self._species, pose).items()}
            for frame, pose in self._poses.items()
        }
        keys.key_matrices(self._rig, self._roots)
        keys.key_bones(self._rig, poses, space="armature")
        if self._wake is not None:
            wake, pace = self._wake
            keys.key_matrices(wake, [self._wake_matrix(pace, frame) for frame in range(LAST_FRAME + 1)])

    def _wake_matrix(self, paces: dict[int, float], frame: int) -> Matrix:
        """Ripples need a moment to build up, and outlive the pace that made them."""
        pace = 0.0
        for earlier in range(min(paces), frame + 1):
            pace += 0.14 * (paces.get(earlier, 0.0) - pace)
        root = self._roots[frame]
        level = Matrix.Translation((root.translation.x, root.translation.y, root.translation.z + DRAFT_M))
        size = 0.45 + 0.55 * pace
        grown = Matrix.Diagonal((size, size, max(pace, 0.02), 1.0))
        return level @ root.to_3x3().normalized().to_4x4() @ grown

    def _root(self) -> Matrix:
        return Matrix.Translation(self._position) @ Matrix.Rotation(self._heading, 4, "Z")

    def _put(self, frame: int, pose: Pose) -> None:
        self._roots[frame], self._poses[frame] = self._root(), pose

    def _plant_feet(self) -> None:
        root = self._root()
        self._feet = {side: (root @ self._species.joint("ankle", side), self._heading) for side in SIDES}

    def _standing(self) -> Pose:
        inside = self._root().inverted()
        return Pose(
            ankles={side: inside @ spot for side, (spot, _) in self._feet.items()},
            head=self._species.joint("neck_top"),
            foot_yaw={
                side: math.remainder(yaw - self._heading, 2 * math.pi)
                for side, (_, yaw) in self._feet.items()
            },
            drop_m=0.003,
        )

    def _idle(self, first: int, last: int) -> None:
        glances = self._glances(first, last)
        for frame in range(first, last + 1):
            pose = self._standing()
            pose.head_yaw, pose.head_pitch = _on_keys(glances, frame)
            pose.drop_m += 0.0012 * math.sin(2 * math.pi * frame / 44.0)
            self._put(frame, pose)

    def _glances(self, first: int, last: int) -> list[tuple[int, Row]]:
        """Yaw and pitch of the head: a turn takes five frames, then the head rests."""
        glances: list[tuple[int, Row]] = [(first, (0.0, 0.0))]
        at = first + self._rng.randint(4, 10)
        while at + 14 < last:
            glances.append((at, glances[-1][1]))
            glances.append((at + 6, (self._rng.uniform(-0.7, 0.7), self._rng.uniform(-0.10, 0.15))))
            at += 6 + self._rng.randint(9, 18)
        return [*glances, (max(last - 6, at), glances[-1][1]), (max(last, at + 1), (0.0, 0.0))]

    def _bow(
        self,
        point: Sequence[float],
        first: int,
        last: int,
        beats: Sequence[float],
        low_share: float,
        high_share: float,
        gaze_down: float,
        gaze_up: float,
    ) -> None:
        """Reaches a world point with the bill once between each two beats.

        Shares say when within a beat the bill is down; between beats the head comes up for a sip that has to
        be swallowed (`gaze_up` below zero: bill raised) or hovers over the food (above zero).
        """
        swallows = gaze_up < 0.0
        inside = self._root().inverted()
        goal = inside @ Vector(point)
        lowest, top = self._reach(goal, gaze_down)
        up = self._species.joint("neck_top")
        for frame in range(first, last + 1):
            k = max(i for i, beat in enumerate(beats[:-1]) if beat <= frame)
            share = (frame - beats[k]) / (beats[k + 1] - beats[k])
            if swallows:
                dip = keys.ease(share / low_share) * (1.0 - keys.ease((share - 0.50) / 0.24))
                toss = keys.ease((share - 0.58) / 0.16) * (1.0 - keys.ease((share - 0.84) / 0.16))
                bent = dip
            else:
                dip = 0.62 + 0.38 * math.sin(math.pi * min(max(share, 0.0), 1.0)) ** 2
                bent = keys.ease_between(frame, first, first + 8) * (
                    1.0 - keys.ease_between(frame, last - 8, last)
                )
                dip, toss = dip * bent, 0.0
            pose = self._standing()
            pose.pitch = lowest * (0.88 * bent + 0.12 * dip)
            pose.drop_m += 0.010 * bent
            body_up = body_motion(self._species, pose) @ up
            pose.head = (up + 0.35 * bent * (body_up - up)).lerp(top, dip)
            pose.head_pitch = gaze_down * dip + gaze_up * (toss if swallows else bent * (1.0 - dip))
            self._put(frame, pose)

    def _reach(self, goal: Vector, gaze: float) -> tuple[float, Vector]:
        """How far to pitch the body, and where the neck ends, so that the bill's tip is at `goal`."""
        species = self._species
        bill = species.joint("bill_tip") - species.joint("neck_top")
        top = goal - Matrix.Rotation(gaze, 3, "X") @ bill
        low, mid = species.joint("neck_low"), species.joint("neck_mid")
        arm = (mid - low).length + (species.joint("neck_top") - mid).length
        for k in range(60):
            pitch = 0.02 * k
            pose = self._standing()
            pose.pitch, pose.drop_m = pitch, pose.drop_m + 0.010
            if (body_motion(self._species, pose) @ low - top).length < 0.96 * arm:
                return pitch, top
        raise ValueError(f"{self.instance.name} can't reach {tuple(round(c, 3) for c in goal)} with its bill")

    def _landings(
        self, path: keys.Path, steps: int, stride: float
    ) -> dict[str, list[tuple[float, Vector, float]]]:
        """Per foot the (step count at landing, spot, yaw) of each touch-down, first where it stands."""
        landings = {side: [(-1.0, *self._feet[side])] for side in SIDES}
        for k in range(steps):
            side = SIDES[k % 2]
            s = min(path.length, (k + 1.5) * stride)
            yaw = _heading(path, s)
            there = Matrix.Translation(path.point(s)) @ Matrix.Rotation(yaw, 4, "Z")
            ankle = self._species.joint("ankle", side)
            ankle.x *= 0.75
            landings[side].append((k + 1.0, there @ ankle, yaw))
        return landings


def _heading(path: keys.Path, s: float) -> float:
    along = path.tangent(s)
    return math.atan2(along.x, -along.y)


def _even(t: float, ramp: float) -> float:
    """Distance share at a time share: eased start and stop, even pace between."""
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
            t, swing = keys.ease(u), math.sin(math.pi * u) ** 2
            turn = math.remainder(next_yaw - yaw, 2 * math.pi)
            return spot.lerp(next_spot, t), yaw + t * turn, 0.026 * swing, 0.6 * swing
    _, spot, yaw = landings[-1]
    return spot, yaw, 0.0, 0.0


def _on_keys(points: Sequence[tuple[int, Row]], frame: int) -> Row:
    """Values at a frame between eased keys (frame, values)."""
    for (a, before), (b, after) in zip(points, points[1:], strict=False):
        if frame <= b:
            t = keys.ease_between(frame, a, b) if b > a else 1.0
            return tuple(x + (y - x) * t for x, y in zip(before, after, strict=True))
    return points[-1][1]
