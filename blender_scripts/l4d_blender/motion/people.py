"""People that act: every method animates a person and records what it shows, in one call.

Actions are planned in rising frame order; `finish` turns the plan into one key per bone and frame. The module
knows intentions (walk, lift, wave) and their timing; gait.py knows feet, puppet.py knows joints. Verbs that
only some people need are functions over a Person in modules of their own (cooks.py, playing.py, ...).
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi, radians

import numpy as np
from mathutils import Matrix

from ..assets.anatomy import SIDES, vec
from ..scene import keys
from ..scene.scene import Instance, RecipeError
from ..scene.timeline import FPS, FRAME_COUNT, LAST_FRAME, MIN_EVENT_FRAMES
from . import gait
from .acting import bake_person, check
from .ik import ease, turn_z, unit
from .plan_person import ROWS, SIGN, Frames, Held, PersonPlan


class Person(PersonPlan):
    """One person of a scene. `heading_deg` 0 faces -Y and grows counter-clockwise seen from above."""

    # ---- standing, walking, turning --------------------------------------------------------------

    def stand(self, frames: Frames = (0, LAST_FRAME)) -> None:
        """Stands and breathes (what a person does anyway), and says so."""
        self.scene.event(self.instance, "stand", frames)

    def walk_to(self, xy: Sequence[float], frames: Frames, *, facing_deg: float | None = None) -> None:
        """Walks straight to a point; `facing_deg` is the heading on arrival."""
        self.walk_along([xy], frames, facing_deg=facing_deg)

    def walk_along(
        self, points: Sequence[Sequence[float]], frames: Frames, *, facing_deg: float | None = None
    ) -> None:
        """Walks through points with planted feet; whatever is held is carried."""
        first, last = frames
        here, heading = self.xy[first].copy(), float(self.heading[first])
        path = keys.Path([(*here, 0.0), *[(float(p[0]), float(p[1]), 0.0) for p in points]])
        facing = None if facing_deg is None else radians(facing_deg)
        steps, distance, headings = gait.walk_steps(
            self.body.anatomy, path, heading, facing, frames, self.lead
        )
        for step in steps:
            self.feet.apply(step)
        self.lead = "l" if steps[-1].side == "r" else "r"
        way = np.array([np.array(path.point(float(s)))[:2] for s in distance])
        self.xy = np.where(
            (first - 6 <= ROWS)[:, None], way + (self.xy - here) * (first > ROWS)[:, None], self.xy
        )
        self.heading = np.where(first - 6 <= ROWS, headings, self.heading)
        self.scene.event(self.instance, "walk", frames)
        for held in self.held:
            if held.last is None and last - max(first, held.first) + 1 >= MIN_EVENT_FRAMES:
                self.scene.event(self.instance, "carry", (max(first, held.first), last), held.instance)

    def turn(self, heading_deg: float, frames: Frames) -> None:
        """Turns on the spot with small steps, the short way."""
        first, last = frames
        start = float(self.heading[first])
        end = start + (radians(heading_deg) - start + pi) % (2 * pi) - pi
        for step in gait.turn_steps(self.body.anatomy, self.xy[first], start, end, frames):
            self.feet.apply(step)
        self.heading = (
            start + (end - start) * ease((ROWS - first) / (last - first))
            if first == 0
            else np.where(
                first > ROWS, self.heading, start + (end - start) * ease((ROWS - first) / (last - first))
            )
        )

    def reach_spot(
        self,
        point: Sequence[float],
        heading_deg: float,
        side: str = "r",
        ahead_m: float = 0.36,
        aside_m: float = 0.14,
    ) -> tuple[float, float]:
        """Where to stand, facing `heading_deg`, so that `point` lies conveniently before a hand."""
        local = vec(SIGN[side] * aside_m, -ahead_m, 0.0) * self.k
        spot = np.array([point[0], point[1], 0.0]) - turn_z(radians(heading_deg)) @ local
        return float(spot[0]), float(spot[1])

    # ---- torso -----------------------------------------------------------------------------------

    def bend_down(self, frames: Frames, *, depth: float = 0.8, stay: int | None = None) -> None:
        """Bends hips and knees and straightens up again; `depth` 1 brings the hands to the shins."""
        first, last = frames
        stay = (last - first) // 5 if stay is None else stay
        middle = (first + last) // 2
        self.stoop(first, middle - stay // 2, depth)
        self.stoop(middle + stay // 2, last, 0.0)
        self.scene.event(self.instance, "bend_down", frames)

    def crouch_down(self, frames: Frames, *, depth: float = 1.3) -> None:
        """Goes down on the heels and stays there until the interval ends, then rises within 14 frames."""
        first, last = frames
        self.stoop(first, min(first + 16, last), depth)
        self.squat(first, min(first + 16, last), depth)
        if last < LAST_FRAME:
            self.stoop(last - 14, last, 0.0)
        self.scene.event(self.instance, "crouch", frames)

    def sit(self, seat: Sequence[float], frames: Frames, *, down: int = 22) -> None:
        """Lowers itself on a seat (a point on its surface right behind the feet) and sits."""
        first, last = frames
        drop = self.body.anatomy.joints["root"][2] - (float(seat[2]) - self.ground_m + 0.085 * self.k)
        u = ease((ROWS - first) / down)
        self.crouch = np.where(first > ROWS, self.crouch, self.crouch[first] * (1 - u) + drop * u)
        slide = np.array(seat[:2]) - self.xy[first]
        self.slide = np.where((first > ROWS)[:, None], self.slide, slide * u[:, None])
        lean = 0.55 * np.sin(pi * np.clip((ROWS - first) / (1.25 * down), 0, 1)) ** 2 + 0.06 * u
        self.bend = np.where(first > ROWS, self.bend, self.bend[first] * (1 - u) + lean)
        for side, s in SIDES:
            wrist = vec(s * 0.115, -0.40, 0.0) * self.k + vec(
                0, 0, float(seat[2]) - self.ground_m + 0.15 * self.k
            )
            turned = self.puppet.hand_rotation(side, vec(-0.25 * s, -0.95, -0.12), vec(0.1 * s, 0, -1))
            shift = turn_z(-float(self.heading[first])) @ np.array([*slide, 0.0])
            self.wish(side, (first + 4, first + down), wrist + shift, turned, "body")
        self.scene.event(self.instance, "sit", (min(first + down // 2, last - MIN_EVENT_FRAMES + 1), last))

    # ---- gestures --------------------------------------------------------------------------------

    def wave(self, frames: Frames, *, side: str = "r", per_s: float = 1.5) -> None:
        """Raises a hand and waves with the forearm."""
        first, last = frames
        s, k = SIGN[side], self.k
        swing = np.sin(2 * pi * per_s * (ROWS - first) / FPS)
        wrist = (
            np.stack([s * (0.30 + 0.085 * swing), -0.16 + 0.0 * swing, 1.60 - 0.022 * swing**2], axis=1) * k
        )
        along = np.stack([s * (0.16 + 0.42 * swing), -0.08 + 0 * swing, 1.0 + 0 * swing], axis=1)
        turned = np.stack([self.puppet.hand_rotation(side, a, vec(0, -1, 0.1)) for a in along])
        self.wish(side, (first, first + 14), wrist, turned, "body", pole=vec(s * 0.8, 0.25, -0.9))
        self.lower_arm(side, (last - 14, last))
        self.close_hand(side, first, 0.06)
        self.close_hand(side, last - 10, 0.28)
        self.scene.event(self.instance, "wave", frames)

    def point_at(
        self,
        spot: Instance | Sequence[float],
        frames: Frames,
        *,
        side: str = "r",
        target: Instance | None = None,
    ) -> None:
        """Stretches an arm and the index finger towards something; `target` is what a bare point is of."""
        first, last = frames
        goal = self.track_of(spot)
        shoulder = self.to_world(vec(SIGN[side] * 0.16, -0.02, 1.37) * self.k)
        way = goal - shoulder
        way /= np.linalg.norm(way, axis=1, keepdims=True)
        wrist = shoulder + 0.47 * self.k * way
        down = np.array([0, 0, -1.0]) + 0.5 * SIGN[side] * turn_z(float(self.heading[first])) @ vec(-1, 0, 0)
        turned = np.stack([self.puppet.hand_rotation(side, w, down) for w in way])
        self.wish(side, (first, first + 14), wrist, turned, "world")
        self.lower_arm(side, (last - 12, last))
        for frame, curl, index in ((first + 4, 0.85, 1.0), (last - 8, 0.28, 0.0)):
            self.close_hand(side, frame, curl)
            u = ease((ROWS - frame) / 8)
            self.pointing[side] = np.where(
                frame > ROWS, self.pointing[side], index * u + (1 - u) * self.pointing[side][frame]
            )
        self.look_at(spot, frames)
        if isinstance(spot, Instance):
            target = spot
        self.scene.event(self.instance, "point" if target is None else "point_at", frames, target)

    def look_at(self, target: Instance | Sequence[float], frames: Frames) -> None:
        """Turns the head towards something for a while (as far as necks go)."""
        first, last = frames
        rise = ease((ROWS - first) / 10) if first > 0 else np.ones(FRAME_COUNT)
        fall = 1.0 - ease((ROWS - last) / 10) if last < LAST_FRAME else 1.0
        self.gazes.append((rise * fall, target))

    # ---- hands that touch ------------------------------------------------------------------------

    def reach(
        self,
        target: Sequence[float] | Instance,
        frames: Frames,
        *,
        side: str = "r",
        verb: str | None = "touch",
        strokes: float = 0.0,
        stroke_m: Sequence[float] = (0.0, 0.12, 0.0),
        height_m: float = 0.0,
    ) -> None:
        """Bends down as far as needed and lays the palm on a point, rubbing it to and fro `strokes` times.

        The base for pet, feed and touch: `verb` names the recorded event (its object is the target instance).
        """
        first, last = frames
        near = (last - first) // 3
        point = self.track_of(target) + vec(0, 0, height_m)
        spot = point[first + near]
        way = np.array([spot[0], spot[1]]) - self.xy[first]
        flat = unit(np.array([way[0], way[1], 0.0]))
        rotation = self.puppet.hand_rotation(side, flat + vec(0, 0, -0.45), vec(0, 0, -1.0) - 0.45 * flat)
        wrist = point - self.puppet.palm_offset(side, rotation)
        rub = np.sin(
            2 * pi * strokes * np.clip((ROWS - first - near) / max(last - first - 2 * near, 1), 0, 1)
        )
        wrist = wrist + 0.5 * rub[:, None] * (turn_z(float(self.heading[first])) @ np.array(stroke_m, float))
        depth = self.depth_for({side: wrist[first + near]}, first + near)
        self.stoop(first, first + near, depth)
        self.stoop(last - near, last, 0.0)
        self.wish(side, (first + 2, first + near), wrist, rotation, "world")
        self.lower_arm(side, (last - near, last))
        self.close_hand(side, first, 0.10)
        self.close_hand(side, last - near, 0.28)
        self.look_at(target if isinstance(target, Instance) else tuple(spot), frames)
        if verb and isinstance(target, Instance):
            self.scene.event(self.instance, verb, frames, target)
        elif verb:
            self.scene.event(self.instance, verb, frames)

    def pet(self, target: Instance, point: Sequence[float], frames: Frames, *, side: str = "r") -> None:
        """Strokes an animal at a world point."""
        self.reach(point, frames, side=side, verb=None, strokes=max(1.0, (frames[1] - frames[0]) / FPS * 0.5))
        self.scene.event(self.instance, "pet", frames, target)

    def toss(
        self,
        frames: Frames,
        *,
        side: str = "r",
        target: Instance | None = None,
        verb: str = "scatter_grain",
        per_s: float = 0.8,
    ) -> None:
        """Takes from the hip and sows with a sweep of the arm, again and again."""
        first, last = frames
        s, k = SIGN[side], self.k
        phase = np.clip((ROWS - first) / FPS * per_s, 0.0, None) % 1.0
        out = ease(phase / 0.42) * (1.0 - ease((phase - 0.50) / 0.50))
        wrist = (
            np.stack(
                [
                    s * (0.06 + 0.34 * out),
                    -0.27 - 0.26 * np.sin(pi * np.clip(out, 0, 1)) - 0.10 * out,
                    1.00 + 0.10 * np.sin(pi * out) + 0.02 * out,
                ],
                axis=1,
            )
            * k
        )
        turned = np.stack(
            [
                self.puppet.hand_rotation(
                    side, vec(s * (0.7 * u - 0.5), -1.0, 0.05), vec(-s * (1 - u), 0, 0.15 + u)
                )
                for u in out
            ]
        )
        self.wish(side, (first, first + 10), wrist, turned, "body")
        self.lower_arm(side, (last - 12, last))
        self.curl[side] = np.where((first <= ROWS) & (last >= ROWS), 0.62 - 0.5 * out, self.curl[side])
        if target is None:
            self.scene.event(self.instance, verb, frames)
        else:
            self.scene.event(self.instance, verb, frames, target)

    # ---- holding ---------------------------------------------------------------------------------

    def lift(
        self,
        thing: Instance,
        grip: Sequence[float] | Sequence[Sequence[float]],
        frames: Frames,
        *,
        side: str = "r",
        bar: Sequence[float] | None = None,
        carry: str = "side",
        clear_m: float = 0.16,
    ) -> None:
        """Bends, grips `thing` and raises it; from then on it moves with the hand.

        `grip` is a point in the thing's own space (two points: both hands), `bar` the direction there of the
        handle that the fingers close round; `carry` is side, front or chest; `clear_m` keeps a hanging thing
        off the leg (about its radius).
        """
        first, last = frames
        grasp = first + round(0.46 * (last - first))
        before = next((h for h in reversed(self.held) if h.instance is thing and h.goal is not None), None)
        at = np.array(before.goal if before else thing.matrix(grasp))
        points = np.atleast_2d(np.array(grip, float))
        sides = (side,) if len(points) == 1 else ("l", "r")
        grips = [at[:3, :3] @ p + at[:3, 3] for p in points]
        if len(grips) == 2:
            facing = turn_z(float(self.heading[grasp])) @ vec(1, 0, 0)
            grips.sort(key=lambda p: -float(p @ facing))
        axis = None if bar is None else at[:3, :3] @ np.array(bar, float)
        turned = [self.grip_rotation(s, grasp, axis, len(sides) == 2) for s in sides]
        wrists = {s: g - self.puppet.grip_offset(s, r) for s, g, r in zip(sides, grips, turned)}
        depth = self.depth_for(wrists, grasp)
        twist = 0.0 if len(sides) == 2 else SIGN[side] * -0.22 * min(depth, 1.0)
        self.stoop(first, grasp - 1, depth, twist)
        self.stoop(grasp + 2, last, 0.0)
        for s, rotation in zip(sides, turned):
            self.wish(s, (first + 2, grasp - 1), wrists[s], rotation, "world", arc=0.05)
            self.close_hand(s, first, 0.12)
            self.close_hand(s, grasp - 4, 0.86, within=6)
            self.carry(s, carry, (grasp + 2, last), clear_m, grips)
        moved = (
            None
            if before is None
            else {
                obj.name: before.goal @ before.rest_at.inverted() @ keys.object_matrix(obj, 0)
                for obj in thing.objects
            }
        )
        self.held.append(Held(thing, sides, grips, grasp, rest_at=Matrix(at), again=moved))
        self.look_at(tuple(np.mean(grips, axis=0)), (first, max(grasp, first + 1)))
        self.scene.event(self.instance, "lift", frames, thing)

    def put_down(self, thing: Instance, at: Sequence[float], frames: Frames) -> None:
        """Sets a held thing down so that its origin comes to rest at a world point, and lets go."""
        first, last = frames
        held = next((h for h in self.held if h.instance is thing and h.last is None), None)
        if held is None:
            raise RecipeError(
                f"{self.instance.name} doesn't hold {thing.name} at frame {first}", "lift it first"
            )
        release = first + round(0.55 * (last - first))
        origin = np.array(held.rest_at)[:3, 3]
        yaw = float(self.heading[release] - self.heading[held.first])
        goals = [np.array(at, float) + turn_z(yaw) @ (g - origin) for g in held.grips]
        turned = [turn_z(yaw) @ self.wish_rotation_at(s, held.first) for s in held.sides]
        wrists = {s: g - self.puppet.grip_offset(s, r) for s, g, r in zip(held.sides, goals, turned)}
        self.stoop(first, release - 1, self.depth_for(wrists, release))
        self.stoop(release + 2, last, 0.0)
        for s, rotation in zip(held.sides, turned):
            self.wish(s, (first, release - 1), wrists[s], rotation, "world")
            self.close_hand(s, release + 1, 0.15)
            self.lower_arm(s, (release + 4, last))
        held.last = release
        held.goal = Matrix.Translation(at) @ Matrix.Rotation(yaw, 4, "Z") @ held.rest_at.to_3x3().to_4x4()
        self.scene.event(self.instance, "put_down", frames, thing)
        self.report_hold(held)

    def hold(
        self,
        thing: Instance,
        grip: Sequence[float] | Sequence[Sequence[float]],
        *,
        side: str = "r",
        bar: Sequence[float] | None = None,
        carry: str = "side",
        clear_m: float = 0.16,
    ) -> None:
        """Has something in the hand(s) from the first frame on, the way `lift` leaves it."""
        points = np.atleast_2d(np.array(grip, float))
        sides = (side,) if len(points) == 1 else ("l", "r")
        at = np.array(thing.matrix(0))
        grips = [at[:3, :3] @ p + at[:3, 3] for p in points]
        for s in sides:
            self.carry(s, carry, (-2, -1), clear_m, grips)
            self.curl[s][:] = 0.86
        way = None if bar is None else at[:3, :3] @ np.array(bar, float)
        yaw = None if way is None else float(np.arctan2(way[1], way[0]))
        self.held.append(Held(thing, sides, grips, 0, rest_at=Matrix(at), from_start=True, bar_yaw=yaw))

    def carry(self, side: str, style: str, frames: Frames, clear_m: float, grips: list[np.ndarray]) -> None:
        """Leads a hand to where it carries things; `style` and `clear_m` as in `lift`."""
        s, k = SIGN[side], self.k
        if len(grips) == 2:
            half = 0.5 * float(np.linalg.norm(grips[0] - grips[1]))
            height = {"side": 0.86, "front": 0.98, "chest": 1.16}[style] * k
            turned = self.puppet.hand_rotation(side, vec(-0.15 * s, -0.7, -0.75), vec(-s, 0.0, 0.25))
            wrist = vec(s * half, -0.36 * k, height) - self.puppet.grip_offset(side, turned)
        elif style == "side":
            turned = self.puppet.hand_rotation(side, vec(0.10 * s, -0.02, -1.0), vec(-s, 0, -0.08))
            wrist = vec(s * (0.165 * k + 0.86 * clear_m), -0.02 * k, 0.86 * k)
        else:
            height = {"front": 1.02, "chest": 1.20}[style] * k
            turned = self.puppet.hand_rotation(side, vec(-0.45 * s, -0.9, 0.1), vec(-s, 0.3, 0.1))
            wrist = vec(s * 0.16 * k, -0.30 * k, height)
        self.wish(
            side, frames, wrist, turned, "carry", pole=vec(s * 0.5, 0.9, -0.4) if style == "side" else None
        )

    def grip_rotation(self, side: str, frame: int, axis: np.ndarray | None, both: bool) -> np.ndarray:
        """A hand that comes from above with the thumb side along the handle."""
        facing = turn_z(float(self.heading[frame]))
        s = SIGN[side]
        if both:
            return self.puppet.hand_rotation(
                side, facing @ vec(-0.1 * s, -0.55, -0.85), facing @ vec(-s, 0, 0.1)
            )
        thumb = facing @ vec(-0.75 * s, -0.66, 0)
        if axis is not None:
            flat = unit(axis * np.array([1.0, 1.0, 0.0]))
            thumb = flat if flat @ thumb > 0.0 else -flat
        down = vec(0, 0, -1)
        palm = np.cross(down, thumb) * (1.0 if side == "l" else -1.0)
        palm = palm if (np.cross(down, palm) * -s) @ thumb > 0 else -palm
        along = down + 0.18 * (facing @ vec(0, -1, 0))
        return self.puppet.hand_rotation(side, along, palm)

    def finish(self) -> None:
        """Turns the plan into keys; call it once, before others hold the same thing."""
        if self.finished:
            raise RecipeError(f"{self.instance.name} is finished already")
        self.finished = True
        for held in self.held:
            if held.last is None:
                self.report_hold(held)
        self.played = bake_person(self)
        check(self, self.played)
        for then in self.late:
            then(self.played)
