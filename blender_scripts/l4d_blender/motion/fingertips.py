"""Where fingertips are, and things that move rigidly with a hand.

Answers for a Puppet what bones will do to its fingers, so that verbs can aim with a fingertip or a pen
instead of the wrist. Knows no verbs and records no events.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from mathutils import Matrix

from ..assets.anatomy import FINGERS
from ..scene import keys
from ..scene.scene import Instance
from ..scene.timeline import FRAME_COUNT
from .acting import Played
from .ik import ease, turn_about
from .puppet import Puppet


def tip_offset(puppet: Puppet, side: str, finger: str, curl: float, rotation: np.ndarray) -> np.ndarray:
    """From the wrist to a fingertip of a hand with this rotation and fingers curled by `curl`."""
    j = puppet.joints
    along, palm, thumb = puppet.anatomy.hand_frame(side)
    base, knee, tip = (j[f"{finger}_{n}_{side}"] for n in ("1", "2", "tip"))
    if finger == "thumb":
        sign = 1.0 if np.cross(along, thumb) @ palm > 0.0 else -1.0
        first = turn_about(np.cross(along, palm), 0.55 * curl) @ turn_about(along, sign * 0.55 * curl)
        second = first @ turn_about(np.cross(along + 0.6 * thumb, palm - 0.6 * thumb), 0.75 * curl)
    else:
        bent = curl * (1.0 + 0.07 * FINGERS.index(finger)) if curl < 0.6 else curl
        first = turn_about(np.cross(along, palm), 1.30 * bent)
        second = first @ turn_about(np.cross(along, palm), 1.75 * bent)
    return rotation @ (base - j[f"hand_{side}"] + first @ (knee - base) + second @ (tip - knee))


def pen_in_hand(puppet: Puppet, side: str, curl: float, beyond_m: float) -> tuple[np.ndarray, np.ndarray]:
    """Tip and direction (towards the tip) of a pen between thumb and index, for a hand in its rest rotation,
    relative to the wrist; the tip is `beyond_m` beyond the pinch."""
    along, palm, thumb = puppet.anatomy.hand_frame(side)
    still = np.eye(3)
    pinch = 0.5 * (
        tip_offset(puppet, side, "index", curl, still) + tip_offset(puppet, side, "thumb", curl, still)
    )
    web = puppet.hand_scale * (0.062 * along + 0.036 * thumb - 0.004 * palm)
    way = (pinch - web) / np.linalg.norm(pinch - web)
    return pinch + beyond_m * way, way


@dataclass
class Rigid:
    """Something that one hand holds without letting it turn in its grip, from `first` to `last`.

    `in_hand` is its matrix in the rest pose of the body (None: as it lies when the hand takes it); `goal`
    is where it comes to rest, reached within the last `settle` frames.
    """

    instance: Instance
    side: str
    first: int
    last: int
    in_hand: Matrix | None = None
    goal: Matrix | None = None
    settle: int = 8


def move_rigid(thing: Rigid, played: Played) -> None:
    """Keys the held thing: still, with the hand, still again."""
    hand = [Matrix(world @ bones[f"hand_{thing.side}"]) for world, bones in zip(played.world, played.bones)]
    for obj in thing.instance.objects:
        before = [keys.object_matrix(obj, f) for f in range(FRAME_COUNT)]
        in_hand = thing.in_hand or hand[thing.first].inverted() @ before[thing.first]
        matrices = []
        for f in range(FRAME_COUNT):
            if f < thing.first:
                matrices.append(before[f])
                continue
            now = hand[min(f, thing.last)] @ in_hand
            if thing.goal is not None:
                u = float(ease((f - thing.last + thing.settle) / thing.settle))
                now = _between(now, thing.goal, u)
            matrices.append(now)
        keys.key_matrices(obj, matrices)


def _between(a: Matrix, b: Matrix, t: float) -> Matrix:
    place = a.translation.lerp(b.translation, t)
    turn = keys.slerp(a.to_quaternion(), b.to_quaternion(), t)
    return Matrix.LocRotScale(place, turn, None)
