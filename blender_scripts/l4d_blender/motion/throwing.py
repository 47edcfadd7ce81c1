"""People who throw a ball underarm, and what a thrown ball does: arcs, hops, a roll to rest.

Adds one verb to Person. The ball's way after the hand is planned apart (`toss`), once the thrower is
finished, because it starts where the hand lets go.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np
from mathutils import Vector

from ..assets.anatomy import vec
from ..scene.scene import Instance, RecipeError
from ..scene.timeline import FPS, FRAME_COUNT
from .ball_games import Ball
from .people import Person
from .plan_person import ROWS, SIGN, Frames

GRAVITY = 9.81
_BALL_CURL = 0.50


class Thrower(Person):
    """A person who can have a ball in one hand and throw it."""

    def hold_ball(self, ball: Instance, radius_m: float, *, side: str = "r") -> None:
        """Has the ball in a hanging hand from the first frame on."""
        self.hold(ball, (0.0, 0.0, radius_m), side=side, clear_m=0.09)
        self._curl[side][:] = _BALL_CURL

    def throw(
        self, ball: Instance, frames: Frames, *, release: int, towards: Sequence[float], side: str = "r"
    ) -> None:
        """Swings the arm back, then forward and up, and lets the ball go at `release`."""
        first, last = frames
        held = next((h for h in self._held if h.instance is ball and h.last is None), None)
        if held is None:
            raise RecipeError(f"{self.instance.name} doesn't hold {ball.name}", "call hold_ball first")
        s, k = SIGN[side], self._k
        back = release - 7
        rotations = [
            self.puppet.hand_rotation(side, way, palm)
            for way, palm in (
                (vec(0.1 * s, 0.55, -0.85), vec(0, -0.8, -0.5)),
                (vec(-0.05 * s, -0.80, 0.55), vec(0, -0.55, 0.80)),
            )
        ]
        places = [vec(s * 0.21, 0.30, 0.86) * k, vec(s * 0.12, -0.46, 1.34) * k]
        elbow = vec(s * 0.5, 0.9, -0.5)
        self._wish(side, (first, back), places[0], rotations[0], "body", pole=elbow)
        self._wish(side, (back, release + 7), places[1], rotations[1], "body", pole=elbow, arc=-0.30)
        self._lower(side, (release + 12, last))
        self._close(side, release - 1, 0.10, within=5)
        self._close(side, last - 8, 0.28)
        lean = np.clip((ROWS - first) / (last - first), 0.0, 1.0)
        self._bend = self._bend + 0.20 * np.sin(pi * lean) ** 2
        self._crouch = self._crouch + 0.05 * k * np.sin(pi * lean) ** 2
        held.last = release
        self.look_at(tuple(towards), (max(first - 6, 0), last))
        self.scene.event(self.instance, "throw", frames, ball)


def toss(
    ball: Ball, release: int, hops: Sequence[tuple[int, Sequence[float]]], rest: tuple[int, Sequence[float]]
) -> None:
    """Follows the hand until `release`, flies from hop to hop (frame, x y), then rolls to rest.

    Heights between hops are those of free fall, so hops that lie close together are low.
    """
    middle = Vector((0.0, 0.0, ball.radius_m))
    ground = ball.centres[0].z
    for frame in range(release + 1):
        ball.centres[frame] = ball.instance.matrix(frame) @ middle
    start, at = release, ball.centres[release].copy()
    for frame, (x, y) in hops:
        end = Vector((x, y, ground))
        seconds = (frame - start) / FPS
        for f in range(start, frame + 1):
            t = (f - start) / FPS
            point = at.lerp(end, t / seconds)
            point.z += 0.5 * GRAVITY * t * (seconds - t)
            ball.centres[f] = point
        start, at = frame, end
    for f in range(start, FRAME_COUNT):
        ball.centres[f] = at.copy()
    ball.roll_to(rest[1], (start, rest[0]))
