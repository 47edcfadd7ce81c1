"""Gulls and ducks that stand, walk, drink and eat from dishes, glide in to land, and swim.

What they share with other birds is birds.py's business, shapes and joints are those of assets/waterbird.py.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import bpy
from mathutils import Matrix, Vector

from ..assets import waterbird as shape
from ..scene import keys
from ..scene.scene import Instance, Scene
from ..scene.timeline import LAST_FRAME
from .birds import SIDES, Bird, Pose, body_motion, even, heading_on, on_keys, solve

STEP_M = 0.115
DRAFT_M = 0.090  # how deep a floating bird's standing plane lies under the water
DIP_FRAMES = 20  # one sip: down, a moment at the water, up with a raised bill
PECK_FRAMES = 15


class WaterBird(Bird):
    """One water bird of a scene."""

    GLANCE = ((4, 10), 6, (9, 18))
    GLANCE_RAD = (0.7, -0.10, 0.15)
    BREATH = (0.0012, 44.0)

    def __init__(
        self,
        scene: Scene,
        name: str,
        id: int,
        *,
        species: shape.Species,
        plumage: str,
        head: str = "own",
        category: str,
        attributes: Mapping[str, str],
        at: Sequence[float],
        heading_deg: float,
    ) -> None:
        """`at` is (x, y, z of what it stands on); `heading_deg` 0 faces -Y, counter-clockwise from above."""
        body = shape.waterbird(
            name, scene.rng(f"plumage/{plumage}"), species=species, plumage=plumage, head=head
        )
        self._species = species
        self._wake: tuple[bpy.types.Object, dict[int, float]] | None = None
        super().__init__(scene, name, id, category, body, attributes, species.joint, at, heading_deg)

    # ---- on its feet -----------------------------------------------------------------------------

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
            s = path.length * even((frame - first) / (last - first), 0.16)
            self._position = path.point(s)
            self._heading = start_heading + math.remainder(heading_on(path, s) - start_heading, 2 * math.pi)
            pose = self._standing()
            self._set_feet(pose, landings, s / stride)
            stir = min(1.0, s / stride, (path.length - s) / stride)
            swing = math.pi * s / stride
            pose.drop_m = 0.007 * stir + 0.003 * math.cos(2 * swing) * stir
            pose.roll = 0.06 * math.sin(swing) * stir
            pose.head += Vector((0.0, -0.008 * math.cos(2 * swing), -0.006)) * stir
            self._put(frame, pose)
        self._feet = {side: landings[side][-1][1:] for side in SIDES}
        self.instance.scene.event(self.instance, "walk", (first, last))

    def turn(self, heading_deg: float, first: int, last: int) -> None:
        """Turns on the spot the short way, with small steps."""
        start = self._heading
        sweep = math.remainder(math.radians(heading_deg) - start, 2 * math.pi)
        steps = max(2, 2 * round(abs(sweep) / 1.1))
        landings = {side: [(-1.0, *self._feet[side])] for side in SIDES}
        for k in range(steps):
            side = SIDES[k % 2]
            yaw = start + sweep * min(1.0, (k + 1.5) / steps)
            there = Matrix.Translation(self._position) @ Matrix.Rotation(yaw, 4, "Z")
            landings[side].append((k + 1.0, there @ self._joint("ankle", side), yaw))
        for frame in range(first, last + 1):
            u = even((frame - first) / (last - first), 0.2)
            self._heading = start + sweep * u
            pose = self._standing()
            self._set_feet(pose, landings, u * steps)
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
        body = body_motion(self._joint, pose)
        stretched = body @ (self._joint("neck_top") + Vector((0.0, -0.030, -0.040)))
        pose.head = stretched.lerp(self._joint("neck_top") - Vector((0, 0, pose.drop_m)), down)
        pose.head_pitch = 0.12 * (1.0 - down)
        inside = self._root().inverted()
        lowered = keys.ease((t - 0.30) / 0.40)
        for side in SIDES:
            x = self._joint("ankle", side).x
            tucked = body @ Vector((0.7 * x, 0.145, 0.150))
            ready = Vector((1.2 * x, -0.030, 0.020))
            hanging = tucked.lerp(ready, lowered)
            planted = keys.ease((t - 0.80) / 0.20) if frame < touch else 1.0
            pose.ankles[side] = hanging.lerp(inside @ spots[side], planted)
            pose.foot_pitch[side] = (2.9 * (1.0 - lowered) - 0.5 * lowered) * (1.0 - planted)
        return pose

    def fly_over(
        self, points: Sequence[Sequence[float]], first: int, off: int, touch: int, last: int
    ) -> None:
        """Spreads its wings from `first` on, leaves the ground at `off`, lands along points, folds by `last`.

        The points begin where it stands and rise and sink between the two spots.
        """
        path = keys.Path(points)
        start, leaving = self._heading, {side: spot for side, (spot, _) in self._feet.items()}
        began = self._standing()
        self._position = path.point(path.length)
        self._heading = math.atan2(path.tangent(path.length).x, -path.tangent(path.length).y)
        self._plant_feet()
        landing, rest = {side: spot for side, (spot, _) in self._feet.items()}, self._heading
        climb, sink = 0.45 * (touch - off), 0.55 * (touch - off)
        for frame in range(first, last + 1):
            t = min(1.0, max(0.0, (frame - off) / (touch - off)))
            s = path.length * even(t, 0.30)
            self._position = path.point(s)
            way = path.tangent(min(max(s, 0.05 * path.length), 0.9 * path.length))
            travel = start + math.remainder(math.atan2(way.x, -way.y) - start, 2 * math.pi)
            gone, near = keys.ease(t / 0.3), keys.ease((t - 0.6) / 0.4)
            heading = start + gone * (travel - start)
            self._heading = heading + near * math.remainder(rest - heading, 2 * math.pi)
            if frame < off + climb:
                # A landing played backwards.
                pose = self._airborne(
                    off - frame, 1.0 - max(0.0, frame - off) / climb, 0, off - first, leaving
                )
                settled = keys.ease_between(frame, first, first + 8)
                pose.head = began.head.lerp(pose.head, settled)
            else:
                share = min(1.0, (frame - touch + sink) / sink)
                pose = self._airborne(frame, share, touch, last, landing)
            self._put(frame, pose)
        scene = self.instance.scene
        scene.event(self.instance, "fly", (off, touch))
        scene.event(self.instance, "land", (max(first, touch - 6), last))

    # ---- on the water ----------------------------------------------------------------------------

    def swim(self, path: keys.Path, first: int, last: int, wake: bpy.types.Object | None = None) -> None:
        """Paddles along a path on the water; a wake mesh travels with it and grows with the pace."""
        start_heading = self._heading
        pace: dict[int, float] = {}
        for frame in range(first, last + 1):
            t = (frame - first) / (last - first)
            s = path.length * even(t, 0.25)
            self._position = path.point(s)
            self._heading = start_heading + math.remainder(heading_on(path, s) - start_heading, 2 * math.pi)
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
            pose.head_yaw, pose.head_pitch = on_keys(glances, frame)
            self._put(frame, pose)
        self.instance.scene.event(self.instance, "rest", (first, last))

    def _floating(self, frame: int, pace: float) -> Pose:
        pose = self._standing()
        stroke = 2.0 * math.pi * 1.4 * frame / 24.0
        for side, sign in zip(SIDES, (1.0, -1.0), strict=True):
            x = self._joint("ankle", side).x
            pose.ankles[side] = Vector((x, 0.075 + 0.035 * pace * sign * math.sin(stroke), 0.035))
            pose.foot_pitch[side] = 0.9
        pose.drop_m = 0.003 * math.sin(2.0 * math.pi * 0.55 * frame / 24.0)
        pose.pitch = -0.03 * pace + 0.012 * math.sin(2.0 * math.pi * 0.5 * frame / 24.0)
        pose.roll = 0.03 * pace * math.sin(stroke)
        pose.head += Vector((0.0, -0.010 * pace * math.sin(2 * stroke), 0.0))
        return pose

    # ---- keys ------------------------------------------------------------------------------------

    def finish(self) -> None:
        """Keys the rig, its bones and the wake; the calls so far must have covered the whole clip."""
        super().finish()
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

    def _solve(self, pose: Pose) -> dict[str, Matrix]:
        moved = solve(self._joint, pose, Vector((0.0, -1.0, -0.2)))
        wings = shape.wing_motion(self._species, pose.spread, pose.flap, pose.bend)
        return moved | {part: moved["body"] @ motion for part, motion in wings.items()}

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
        up = self._joint("neck_top")
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
            body_up = body_motion(self._joint, pose) @ up
            pose.head = (up + 0.35 * bent * (body_up - up)).lerp(top, dip)
            pose.head_pitch = gaze_down * dip + gaze_up * (toss if swallows else bent * (1.0 - dip))
            self._put(frame, pose)

    def _reach(self, goal: Vector, gaze: float) -> tuple[float, Vector]:
        """How far to pitch the body, and where the neck ends, so that the bill's tip is at `goal`."""
        joint = self._joint
        bill = joint("bill_tip") - joint("neck_top")
        top = goal - Matrix.Rotation(gaze, 3, "X") @ bill
        low, mid = joint("neck_low"), joint("neck_mid")
        arm = (mid - low).length + (joint("neck_top") - mid).length
        for k in range(60):
            pitch = 0.02 * k
            pose = self._standing()
            pose.pitch, pose.drop_m = pitch, pose.drop_m + 0.010
            if (body_motion(self._joint, pose) @ low - top).length < 0.96 * arm:
                return pitch, top
        raise ValueError(f"{self.instance.name} can't reach {tuple(round(c, 3) for c in goal)} with its bill")
