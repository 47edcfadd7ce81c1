"""Hens that stand and look about, peck, and walk with planted feet and a head that holds still between
thrusts.

What they share with other birds is birds.py's business, shapes and joints are those of assets/hen.py.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from mathutils import Matrix, Vector

from ..assets import hen as shape
from ..scene import keys
from ..scene.scene import Scene
from .birds import Bird, Pose, even, heading_on, on_keys, solve

STEP_M = 0.13

_DOWN_PITCH, _DOWN_DROP = 0.56, 0.016
_HEAD_UP = shape.NECK_TOP.copy()
_HEAD_HOVER = Vector((0.0, -0.185, 0.145))
_HEAD_GROUND = Vector((0.0, -0.172, 0.080))


class Hen(Bird):
    """One hen of a scene."""

    STEP_LIFT = (0.035, 0.7)
    TRACK = 0.55
    STANCE_DROP_M = 0.004
    GLANCE = ((3, 9), 5, (8, 18))
    GLANCE_RAD = (0.75, -0.15, 0.2)
    BREATH = (0.0015, 40.0)

    def __init__(
        self,
        scene: Scene,
        name: str,
        id: int,
        *,
        plumage: str,
        neck: str = "own",
        attributes: Mapping[str, str] | None = None,
        at: Vector,
        heading_deg: float,
    ) -> None:
        """`heading_deg` 0 faces -Y, counter-clockwise seen from above."""
        body = shape.hen(name, scene.rng(name), plumage=plumage, neck=neck)
        looks = {"colour": plumage} if attributes is None else attributes
        super().__init__(scene, name, id, "hen", body, looks, shape.joint, at, heading_deg)

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
            x, y, z, pose.head_pitch = on_keys(heads, frame)
            pose.head = Vector((x, y, z))
            self._put(frame, pose)
        self.instance.scene.event(self.instance, "peck", (first, last))

    def walk(self, path: keys.Path, first: int, last: int) -> None:
        """Walks the whole path, which starts where the hen stands; both feet are down at either end."""
        steps = max(2, round(path.length / STEP_M))
        stride = path.length / steps
        landings = self._landings(path, steps, stride)
        for frame in range(first, last + 1):
            s = path.length * even((frame - first) / (last - first), 0.16)
            self._position, self._heading = path.point(s), heading_on(path, s)
            pose = self._standing()
            self._set_feet(pose, landings, s / stride)
            stir = min(1.0, s / stride, (path.length - s) / stride)
            pose.drop_m = 0.010 * stir + 0.003 * math.cos(2 * math.pi * s / stride) * stir
            pose.roll = 0.035 * math.sin(math.pi * s / stride) * stir
            pose.head = self._root().inverted() @ self._held_head(path, s, stride, stir)
            self._put(frame, pose)
        self._feet = {side: touched[-1][1:] for side, touched in landings.items()}
        self.instance.scene.event(self.instance, "walk", (first, last))

    def _solve(self, pose: Pose) -> dict[str, Matrix]:
        return solve(self._joint, pose, Vector((0.0, -1.0, -0.3)))

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
