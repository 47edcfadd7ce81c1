"""Athletes: people who take up a dumbbell, curl it, put it back, and who stretch.

Knows how an arm carries a weight; refuses to know the gym.
"""

from __future__ import annotations

from math import pi, radians

import numpy as np

from ..assets.anatomy import SIDES, vec
from ..scene.scene import Instance
from ..scene.timeline import LAST_FRAME, MIN_EVENT_FRAMES
from .handling import Grip, grip, key_path
from .ik import between, ease, smooth, turn_x, turn_y, turn_z
from .people import Person
from .plan_person import ROWS, SIGN, Frames

FOREARM_M = 0.335  # from the elbow to the middle of the fist, on the reference body
HANG, BOTTOM, TOP = radians(12), radians(40), radians(126)
SUPINE = radians(-62)  # the palm turns up in a curl; dumbbells are taken up with the palm to the body
OVERHAND = radians(78)
_SWAY_RAD = 0.34


def rest_matrix(person: Person, at: tuple[float, float, float], side: str) -> np.ndarray:
    """How a dumbbell lies at a point so that this athlete can take it overhand."""
    matrix = np.eye(4)
    matrix[:3, :3] = turn_z(float(person.heading[0]) + _turned(side, OVERHAND))
    matrix[:3, 3] = at
    return matrix


def train(
    person: Person,
    weight: Instance,
    rest: np.ndarray,
    bar_m: float,
    *,
    side: str,
    take: Frames,
    curl: Frames,
    reps: int,
    put_down: Frames | None = None,
) -> None:
    """Takes a dumbbell up from `rest`, curls it `reps` times and puts it back where it was.

    It leaves its place halfway through `take`. A curl may go on beyond the clip.
    """
    grasp = take[0] + round(0.5 * (take[1] - take[0]))
    lifted = ease((ROWS - grasp) / (take[1] - grasp))
    release = LAST_FRAME
    if put_down is not None:
        release = put_down[0] + round(0.62 * (put_down[1] - put_down[0]))
        lifted = lifted * (1.0 - ease((ROWS - put_down[0]) / (release - put_down[0])))
    path = _between_rest_and_arm(person, rest, bar_m, side, lifted, curl, reps)
    for obj in weight.objects:
        key_path(obj, path)

    _bow(person, side, path[grasp] @ np.array([0, 0, bar_m, 1.0]), take, grasp)
    if put_down is not None:
        _bow(person, side, path[release] @ np.array([0, 0, bar_m, 1.0]), put_down, release)
    grip(
        person,
        weight,
        path,
        Grip((0, 0, bar_m), (0, -1, 0), (0, 0, -1)),
        (grasp, release),
        side=side,
        approach=min(grasp, 12),
        arc_m=0.0,
        puts_down=None if put_down is None else (put_down[0], release + 1),
    )
    person.scene.event(person.instance, "lift", (max(grasp - 2, 0), take[1]), weight)
    person.scene.event(weight, "rise", (grasp, max(take[1], grasp + MIN_EVENT_FRAMES - 1)))
    person.scene.event(person.instance, "curl", (curl[0], min(curl[1], LAST_FRAME)), weight)


def stretch(person: Person, frames: Frames, *, period: int = 40) -> None:
    """Arms overhead, bends to one side and the other; lets the arms sink when it ends."""
    first, last = frames
    shape = ease((ROWS - first + 10 * (first == 0)) / 10) * (1.0 - ease((ROWS - last + 10) / 10))
    bend = _SWAY_RAD * np.sin(2 * pi * (ROWS - first) / period + 0.5) * shape
    person.lean = person.lean + bend
    pivot = vec(0.0, 0.015, 1.05) * person.k
    for side, s in SIDES:
        above = vec(s * 0.055, -0.035, 1.835) * person.k - pivot
        wrist = np.stack([pivot + turn_y(float(b)) @ above for b in bend])
        turned = np.stack(
            [
                person.puppet.hand_rotation(
                    side, turn_y(float(b)) @ vec(-0.25 * s, -0.05, 1.0), vec(-s, 0, 0)
                )
                for b in bend
            ]
        )
        start = (-2, -1) if first == 0 else (first, first + 12)
        person.wish(side, start, wrist, turned, "body", pole=vec(s * 1.0, 0.15, 0.3))
        person.lower_arm(side, (last - 10, last + 2))
    person.scene.event(person.instance, "stretch", (first, last - 4))


def _between_rest_and_arm(
    person: Person, rest: np.ndarray, bar_m: float, side: str, lifted: np.ndarray, curl: Frames, reps: int
) -> np.ndarray:
    """World matrices of the dumbbell: at rest where `lifted` is 0, in the moving arm where it is 1."""
    heading, k = turn_z(float(person.heading[curl[0]])), person.k
    here = np.array([*person.xy[curl[0]], person.ground_m])
    share = np.clip((ROWS - curl[0]) / (curl[1] - curl[0]), 0.0, 1.0)
    working = smooth(np.minimum(1.0, 1.7 * np.sin(pi * share)), 1.5)
    low = HANG + (BOTTOM - HANG) * working
    swing = low + (TOP - low) * (0.5 - 0.5 * np.cos(2 * pi * reps * share))
    elbow = vec(SIGN[side] * 0.238, 0.005, 1.085) * k
    path = np.tile(np.eye(4), (len(ROWS), 1, 1))
    bar = np.array([0.0, 0.0, bar_m])
    for f in ROWS:
        phi, w = float(swing[f]), float(lifted[f])
        arm = heading @ turn_x(-phi) @ turn_z(_turned(side, SUPINE * float(working[f])))
        fist = elbow + FOREARM_M * k * vec(SIGN[side] * 0.04, -np.sin(phi), -np.cos(phi))
        in_arm = here + heading @ fist
        on_rest = rest[:3, 3] + rest[:3, :3] @ bar
        rotation = between(rest[:3, :3], arm, w)
        path[f, :3, :3] = rotation
        path[f, :3, 3] = on_rest + (in_arm - on_rest) * w - rotation @ bar
    return path


def _bow(person: Person, side: str, grip: np.ndarray, frames: Frames, bottom: int) -> None:
    """Bends so that a hand reaches a grip at frame `bottom`, and straightens up by the end."""
    heading = turn_z(float(person.heading[bottom]))
    turned = person.puppet.hand_rotation(side, vec(0, 0, -1), heading @ vec(0, 1, 0))
    wrist = grip[:3] - person.puppet.grip_offset(side, turned)
    depth = person.depth_for({side: wrist}, bottom)
    person.stoop(frames[0], bottom - 1, depth, -0.12 * SIGN[side] * min(depth, 1.0))
    person.stoop(bottom + 2, frames[1], 0.0)
    person.look_at(tuple(grip[:3] + heading @ vec(0, -0.5, 0)), (max(frames[0], 0), bottom))


def _turned(side: str, angle: float) -> float:
    return angle if side == "r" else -angle
