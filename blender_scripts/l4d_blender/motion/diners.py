"""Hands that eat: take a spoon from above, bring it where it is needed, push a dish with what lies in it.

Adds to `Server` what happens at a dinner table. Knows timing and touch, no dishes.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import cos, radians, sin

import numpy as np
from mathutils import Matrix

from ..assets.anatomy import vec
from ..assets.hand import DIGITS
from ..scene import keys
from ..scene.scene import Instance
from ..scene.timeline import FRAME_COUNT
from .arm import DOWN, matrix_of, thumbward
from .grips import POSES, Placed, Pose, Solid, digit_frames
from .hands import Frames, Point, _rotation
from .ik import turn_z, unit
from .servers import Server

# How steeply the fingers point down: a spoon that lies is taken flatter than one that leans in a bowl.
PITCH = {"pick": radians(42.0), "pen": radians(64.0)}


class Diner(Server):
    """A hand at dinner."""

    def _fit(
        self, solid: Solid, grip: str, heading: float, point: Point | None
    ) -> tuple[np.ndarray, np.ndarray, Pose, Pose, np.ndarray]:
        """Grips "pick" and "pen": thumb against fingertips round a handle, from above."""
        if grip not in PITCH:
            return super()._fit(solid, grip, heading, point)
        pitch = PITCH[grip]
        fingers = turn_z(heading) @ vec(0, -1, 0)
        thumb = thumbward(self.side, fingers)
        along = cos(pitch) * fingers + sin(pitch) * DOWN
        palm = cos(pitch) * DOWN - sin(pitch) * fingers + 0.30 * thumb
        hand = Placed(matrix_of(_rotation(along, palm), vec(0, 0, 0)), self.side, self.scale, self.table_m)
        opened = POSES["pinch_open"]
        tips = [digit_frames(d, opened[n])[0][3] for n, d in enumerate(DIGITS[:3])]
        contact = 0.5 * tips[0] + 0.25 * (tips[1] + tips[2])
        hand.matrix[:3, 3] = np.array(point, float) - hand.world(contact[None])[0]
        place = hand.matrix.copy()
        pose = hand.close(solid, opened, POSES["pinch_closed"])
        way = unit(0.5 * along + DOWN)
        before = place.copy()
        before[:3, 3] -= 0.05 * way
        return before, place, opened, pose, -way

    def bring(self, to: Matrix, frames: Frames) -> None:
        """Moves what it holds through the air into a pose."""
        thing = self._require("carry")
        self._carry_between(thing, self._where(thing, frames[0]), to, frames)
        self.scene.event(self.instance, "carry", frames, thing)

    def push_dish(self, path: Sequence[Point], frames: Frames, *, load: Sequence[Instance] = ()) -> None:
        """Slides the dish that it touches; what stands in it rides along."""
        dish = self._require("push")
        self.slide(path, frames, verb="push")
        back = dish.matrix(0).inverted()
        for thing in load:
            moved = [dish.matrix(f) @ back for f in range(FRAME_COUNT)]
            for obj in thing.objects:
                start = keys.object_matrix(obj, 0)
                keys.key_matrices(obj, [shift @ start for shift in moved])
            self.scene.event(thing, "ride", frames)
