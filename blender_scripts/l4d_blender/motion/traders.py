"""People who hand things over: one holds out what hangs from the hand, the other takes it.

Verbs over a Person. Finish the giver before the taker: the thing follows the first hand, then the second.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi

import numpy as np
from mathutils import Matrix, Vector

from ..assets.anatomy import vec
from ..scene import keys
from ..scene.scene import Instance, RecipeError
from ..scene.timeline import FPS, FRAME_COUNT
from .ik import ease, turn_z
from .people import Person
from .plan_person import ROWS, SIGN, Frames, Held


def _dangling(person: Person, side: str) -> np.ndarray:
    """Rotation, in the body's space, of a hand that holds a bar before the body: thumb ahead."""
    s = SIGN[side]
    return person.puppet.hand_rotation(side, vec(0.04 * s, -0.22, -1.0), vec(-s, 0.0, -0.08))


def offer(person: Person, thing: Instance, frames: Frames, *, release: int, side: str = "r") -> None:
    """Holds out what hangs from a hand; it is let go at `release`, then the arm sinks."""
    first, last = frames
    held = next((h for h in person.held if h.instance is thing and h.last is None), None)
    if held is None:
        raise RecipeError(f"{person.instance.name} doesn't hold {thing.name}", "hold or lift it first")
    wrist = vec(SIGN[side] * 0.05, -0.46, 1.00) * person.k
    person.wish(side, (first, first + 18), wrist, _dangling(person, side), "body")
    person.close_hand(side, release, 0.12, within=6)
    person.lower_arm(side, (release + 5, last))
    held.last = release
    person.scene.event(person.instance, "hand_over", (first, release + 4), thing)
    person.report_hold(held)


def take(
    person: Person,
    thing: Instance,
    grip: Sequence[float],
    frames: Frames,
    *,
    release: int,
    side: str = "r",
    clear_m: float,
) -> None:
    """Grips what somebody holds out (`grip` in the thing's own space) and lets it hang at the side."""
    first, last = frames
    at = np.array(thing.matrix(release))
    point = at[:3, :3] @ np.array(grip, float) + at[:3, 3]
    turned = turn_z(float(person.heading[release])) @ _dangling(person, side)
    wrist = point - person.puppet.grip_offset(side, turned)
    person.wish(side, (first, release - 5), wrist, turned, "world", arc=0.04)
    person.close_hand(side, first, 0.10)
    person.close_hand(side, release - 7, 0.86, within=6)
    person.carry(side, "side", (release + 2, last), clear_m, [point])
    person.held.append(Held(thing, (side,), [point], release, rest_at=Matrix(at)))
    person.look_at(tuple(point), (max(first - 8, 0), last))
    person.scene.event(person.instance, "take", frames, thing)


def swing_while_carried(
    thing: Instance,
    grip: Sequence[float],
    stretches: Sequence[Frames],
    *,
    angle: float = 0.11,
    per_s: float = 1.25,
) -> None:
    """Lets a finished, carried thing swing to and fro under the hand during some stretches, and says so."""
    obj, hinge = thing.objects[0], Vector(grip)
    sway = np.zeros(FRAME_COUNT)
    for first, last in stretches:
        beat = np.sin(2 * pi * per_s * (ROWS - first) / FPS)
        fades = ease((ROWS - first) / 6) * (1.0 - ease((ROWS - last + 4) / 9))
        sway += angle * beat * np.where(first <= ROWS, fades, 0.0)
        thing.scene.event(thing, "swing", (first, last))
    about = Matrix.Translation(hinge)
    keys.key_matrices(
        obj,
        [
            keys.object_matrix(obj, f) @ about @ Matrix.Rotation(float(sway[f]), 4, "Y") @ about.inverted()
            for f in range(FRAME_COUNT)
        ],
    )
