"""Children in a playroom: hugging and rocking a toy, sitting at a low table, building with blocks.

Verbs over a Person; knows nothing of what toys look like, only where hands hold them.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi, radians

import numpy as np
from mathutils import Matrix

from ..assets.anatomy import SIDES, vec
from ..scene.scene import Instance
from ..scene.timeline import FPS, LAST_FRAME
from .ik import ease, turn_z
from .people import Person
from .plan_person import ROWS, SIGN, Frames, Held


def hug(person: Person, thing: Instance, frames: Frames, *, half_m: float, per_s: float = 0.62) -> None:
    """Presses what both hands hold to the chest and rocks with it from side to side."""
    first, last = frames
    k = person.k
    rising = ease((ROWS - first - 8) / 14)
    swing = np.sin(2 * pi * per_s * np.clip(ROWS - first - 8, 0, None) / FPS) * rising
    for side, s in SIDES:
        turned = person.puppet.hand_rotation(side, vec(-0.42 * s, -0.88, 0.10), vec(-s, 0.30, 0.05))
        grip = np.stack(
            [s * half_m + 0.052 * k * swing, -0.240 * k + 0 * swing, 1.10 * k + 0 * swing], axis=1
        )
        wrist = grip - person.puppet.grip_offset(side, turned)
        person.wish(side, (first, first + 14), wrist, turned, "carry", pole=vec(s * 0.9, 0.4, -0.6))
    person.lean = person.lean + 0.17 * swing
    person.look_at(tuple(_ahead(person)), (first, LAST_FRAME))
    person.scene.event(person.instance, "hug", frames, thing)
    person.scene.event(thing, "rock", (first + 8, last))


def sit_at(person: Person, seat: Sequence[float], heading_deg: float, *, lean: float = 0.20) -> None:
    """Sits on a low seat all the clip, feet flat before it; `seat` is a point on its surface."""
    k = person.k
    person.heading[:] = radians(heading_deg)
    person.bend[:] = lean
    root = person.body.anatomy.joints["root"]
    person.crouch[:] = root[2] - 0.012 * k - (float(seat[2]) - person.ground_m + 0.085 * k)
    back = 0.17 * np.sin(lean) * k + 0.12 * person.crouch[0]
    xy = np.array(seat[:2]) - (turn_z(radians(heading_deg)) @ vec(0, root[1] + back, 0))[:2]
    person.xy[:] = xy
    for side, s in SIDES:
        spot = np.array([*seat[:2], 0.0]) + turn_z(radians(heading_deg)) @ vec(s * 0.11 * k, -0.40 * k, 0.0)
        feet = person.feet
        feet.spot[side][:] = spot
        feet.yaw[side][:] = radians(heading_deg) + s * 0.12
        feet.ankle[side][:] = feet.soles[side].lifted(spot, radians(heading_deg) + s * 0.12, 0.0)
    person.scene.event(person.instance, "sit", (0, LAST_FRAME))


def keep_hand_on(
    person: Person, thing: Instance, point: Sequence[float], *, side: str = "l", verb: str = "hold"
) -> None:
    """Keeps a palm all the clip at a world point of something that stands still; palm to the front."""
    s, facing = SIGN[side], turn_z(float(person.heading[0]))
    turned = person.puppet.hand_rotation(
        side, facing @ vec(0.15 * s, -0.45, 0.75), facing @ vec(0.10 * s, -1.0, -0.5)
    )
    wrist = np.array(point, float) - person.puppet.palm_offset(side, turned)
    person.wish(side, (-2, -1), wrist, turned, "world", pole=facing @ vec(s * 0.9, 0.3, -0.7))
    person.curl[side][:] = 0.34
    person.scene.event(person.instance, verb, (0, LAST_FRAME), thing)


def stack(
    person: Person,
    block: Instance,
    goal: Sequence[float],
    frames: Frames,
    *,
    height_m: float,
    side: str = "r",
) -> None:
    """Takes a block from above and sets it down so that its base comes to rest at a world point."""
    first, last = frames
    grasp, release = first + round(0.34 * (last - first)), first + round(0.76 * (last - first))
    facing = turn_z(float(person.heading[first]))
    s = SIGN[side]
    turned = person.puppet.hand_rotation(
        side, facing @ vec(-0.15 * s, -0.80, -0.58), facing @ vec(0.0, 0.50, -0.85)
    )
    at = np.array(block.matrix(0))
    top = vec(0, 0, height_m - 0.004)
    start, end = at[:3, 3] + top, np.array(goal, float) + top
    u = ease((ROWS - grasp - 2) / (release - grasp - 4))
    rise = ease((ROWS - grasp - 2) / (0.62 * (release - grasp)))
    sink = ease((ROWS - release + 0.34 * (release - grasp)) / (0.34 * (release - grasp) - 1))
    grip = start + (end - start) * u[:, None]
    grip[:, 2] = start[2] + (end[2] - start[2] + 0.050) * rise - 0.050 * sink
    wrist = grip - person.puppet.grip_offset(side, turned)
    pole = facing @ vec(s * 0.9, 0.4, -0.3)
    person.wish(side, (first, grasp - 1), wrist, turned, "world", pole=pole, arc=0.06)
    away = wrist[release] + vec(0, 0, 0.07) + facing @ vec(s * 0.06, 0.08, 0.0)
    person.wish(side, (release + 2, last), away, turned, "world", pole=pole)
    person.close_hand(side, first, 0.10)
    person.close_hand(side, grasp - 4, 0.46, within=5)
    person.close_hand(side, release, 0.12, within=5)
    person.held.append(
        Held(
            block,
            (side,),
            [start],
            grasp,
            last=release,
            rest_at=Matrix(at),
            goal=Matrix.Translation(goal) @ Matrix(at).to_3x3().to_4x4(),
        )
    )
    person.look_at(tuple(start), (max(first - 8, 0), grasp))
    person.look_at(tuple(end), (grasp, last))
    person.scene.event(person.instance, "stack", frames, block)


def wave_seated(person: Person, frames: Frames, *, side: str = "r", per_s: float = 1.5) -> None:
    """Raises a hand beside the head and waves with the forearm."""
    first, last = frames
    s, k = SIGN[side], person.k
    swing = np.sin(2 * pi * per_s * (ROWS - first) / FPS)
    drop = float(person.crouch[first])
    wrist = np.stack([s * (0.35 + 0.085 * swing), -0.15 + 0 * swing, 1.56 - 0.02 * swing**2], axis=1) * k
    wrist[:, 2] -= drop
    along = np.stack([s * (0.16 + 0.42 * swing), -0.08 + 0 * swing, 1.0 + 0 * swing], axis=1)
    turned = np.stack([person.puppet.hand_rotation(side, a, vec(0, -1, 0.1)) for a in along])
    person.wish(side, (first, first + 13), wrist, turned, "body", pole=vec(s * 0.8, 0.25, -0.9))
    person.close_hand(side, first, 0.06)
    up = ease((ROWS - first) / 14)
    person.bend = person.bend - 0.10 * up
    person.look_at(tuple(_ahead(person)), (first, LAST_FRAME))
    person.scene.event(person.instance, "wave", (first, last))


def _ahead(person: Person) -> np.ndarray:
    """A point far before the eyes."""
    facing = turn_z(float(person.heading[-1]))
    return np.array([*person.xy[-1], 0.0]) + facing @ vec(-0.5, -3.0, 1.0)
