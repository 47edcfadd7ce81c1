"""People who throw a ball underarm, and what a thrown ball does: arcs, hops, a roll to rest.

The ball's way after the hand is planned apart (`toss`), once the thrower is finished, because it starts where
the hand lets go.
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


def hold_ball(person: Person, ball: Instance, radius_m: float, *, side: str = "r") -> None:
    """Has the ball in a hanging hand from the first frame on."""
    person.hold(ball, (0.0, 0.0, radius_m), side=side, clear_m=0.09)
    person.curl[side][:] = _BALL_CURL


def throw(
    person: Person, ball: Instance, frames: Frames, *, release: int, towards: Sequence[float], side: str = "r"
) -> None:
    """Swings the arm back, then forward and up, and lets the ball go at `release`."""
    first, last = frames
    held = next((h for h in person.held if h.instance is ball and h.last is None), None)
    if held is None:
        raise RecipeError(f"{person.instance.name} doesn't hold {ball.name}", "call hold_ball first")
    s, k = SIGN[side], person.k
    back = release - 7
    rotations = [
        person.puppet.hand_rotation(side, way, palm)
        for way, palm in (
            (vec(0.1 * s, 0.55, -0.85), vec(0, -0.8, -0.5)),
            (vec(-0.05 * s, -0.80, 0.55), vec(0, -0.55, 0.80)),
        )
    ]
    places = [vec(s * 0.21, 0.30, 0.86) * k, vec(s * 0.12, -0.46, 1.34) * k]
    elbow = vec(s * 0.5, 0.9, -0.5)
    person.wish(side, (first, back), places[0], rotations[0], "body", pole=elbow)
    person.wish(side, (back, release + 7), places[1], rotations[1], "body", pole=elbow, arc=-0.30)
    person.lower_arm(side, (release + 12, last))
    person.close_hand(side, release - 1, 0.10, within=5)
    person.close_hand(side, last - 8, 0.28)
    lean = np.clip((ROWS - first) / (last - first), 0.0, 1.0)
    person.bend = person.bend + 0.20 * np.sin(pi * lean) ** 2
    person.crouch = person.crouch + 0.05 * k * np.sin(pi * lean) ** 2
    held.last = release
    person.look_at(tuple(towards), (max(first - 6, 0), last))
    person.scene.event(person.instance, "throw", frames, ball)


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
