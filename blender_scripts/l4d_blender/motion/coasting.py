"""Hands that push things which go on by themselves: toy cars roll out, plates and blocks slide to rest.

Adds to the hands that push, roll and twist; knows friction, no shapes.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from mathutils import Matrix, Vector

from ..scene import keys
from ..scene.timeline import FRAME_COUNT
from .hands import Frames
from .rolling import Momentum, Roller
from .toy_blocks import PushingHand

_FOLLOW_FRAMES = 8


class CoastingHand(PushingHand, Roller):
    """A hand that gives pushes."""

    def push_on(
        self, way_m: Sequence[float], frames: Frames, *, let_go: int, thing_verb: str = "roll"
    ) -> None:
        """Pushes what it touches along a vector (x, y) until `let_go`; it rests at the last frame."""
        thing = self._require("push")
        first, last = frames
        start = self._where(thing, first)
        momentum = Momentum(first, let_go, last)
        way = Vector((float(way_m[0]), float(way_m[1]), 0.0))
        gone = [way * momentum.share(f) for f in range(FRAME_COUNT)]
        for obj in thing.objects:
            before = [keys.object_matrix(obj, f) for f in range(FRAME_COUNT)]
            keys.key_matrices(
                obj,
                [
                    before[f] if f < first else Matrix.Translation(gone[f]) @ before[first]
                    for f in range(FRAME_COUNT)
                ],
            )
        self._keyed[thing.name] = [
            thing.matrix(f) if f < first else Matrix.Translation(gone[f]) @ start for f in range(FRAME_COUNT)
        ]
        self._follow(np.array([tuple(v) for v in gone]), first, let_go)
        self.scene.event(self.instance, "push", (first, let_go), thing)
        self.scene.event(thing, thing_verb, frames)

    def _follow(self, gone: np.ndarray, first: int, let_go: int) -> None:
        """The hand keeps its touch until it lets go, then slows down where it is."""
        touch, speed = self._place[first].copy(), gone[let_go] - gone[let_go - 1]
        for f in range(first, FRAME_COUNT):
            place = touch.copy()
            after = min(max(f - let_go, 0), _FOLLOW_FRAMES)
            place[:3, 3] += gone[min(f, let_go)] + speed * (after - after**2 / (2.0 * _FOLLOW_FRAMES))
            self._place[f] = place
        self._busy[first:] = 1.0
        self._holding = None
