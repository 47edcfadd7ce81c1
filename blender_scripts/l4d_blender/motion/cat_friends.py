"""People on their heels who stroke cats, and cats whose heads can be stroked.

Adds a squat that lasts and strokes of the hand from it; where a cat's crown is comes from the cat's own pose.
"""

from __future__ import annotations

from math import pi

import numpy as np
from mathutils import Vector

from ..assets.anatomy import vec
from ..scene.scene import RecipeError
from ..scene.timeline import FPS, LAST_FRAME
from .cats import Cat
from .ik import ease, turn_z
from .people import Person
from .plan_person import BEND_RAD, CROUCH_M, ROWS, SIGN, Frames

_CROWN = Vector((0.0, -0.222, 0.3655))
_REACH = 0.97  # share of an arm's length


class FriendlyCat(Cat):
    """A cat that knows where one may touch it."""

    def crown(self, frame: int) -> Vector:
        """The top of its head between the ears, in the world."""
        pose = self.poses[frame]
        return pose.world() @ (self._body(pose)["head"] @ _CROWN)

    def lean_in(self, frames: Frames, *, roll: float = 0.12) -> None:
        """Shuts its eyes half while a hand is on its head, and tilts it a little."""
        first, last = frames
        for frame in range(first, last + 1):
            share = float(ease((frame - first) / 8) * (1.0 - ease((frame - last + 8) / 8)))
            self.poses[frame].lids[0] = max(self.poses[frame].lids[0], 0.55 * share)
            self.poses[frame].head[2] += roll * share


def squat(person: Person, depth: float = 1.35) -> None:
    """Sits on the heels from the first frame to the last."""
    person.crouch = person.crouch + (CROUCH_M + 0.13) * person.k * depth
    person.bend = person.bend + 0.68 * BEND_RAD * depth
    for side, s in (("l", SIGN["l"]), ("r", SIGN["r"])):
        resting = vec(s * 0.17, -0.36, 0.60) * person.k
        turned = person.puppet.hand_rotation(side, vec(-0.3 * s, -0.95, -0.15), vec(0.1 * s, 0, -1))
        person.wish(side, (-2, -1), resting, turned, "body")
    person.scene.event(person.instance, "crouch", (0, LAST_FRAME))


def stroke(person: Person, cat: FriendlyCat, frames: Frames, *, side: str, per_s: float = 0.9) -> None:
    """Lays a palm on a cat's head and strokes it, then takes the hand back to the knee."""
    first, last = frames
    near = 11
    crown = np.array(cat.crown(first + near))
    heading = turn_z(float(person.heading[first]))
    flat = heading @ vec(-0.15 * SIGN[side], -1.0, 0.0)
    rotation = person.puppet.hand_rotation(side, flat + vec(0, 0, -0.30), vec(0, 0, -1.0) - 0.30 * flat)
    wrist = crown - person.puppet.palm_offset(side, rotation)
    _check_reach(person, side, wrist, first + near)
    beat = 2 * pi * per_s * np.clip((ROWS - first - near) / FPS, 0.0, (last - first - 2 * near) / FPS)
    rub = 0.016 * np.sin(beat)[:, None] * (heading @ vec(0.0, 1.0, 0.0))
    rub[:, 2] += 0.006 * (1.0 - np.cos(beat))
    knee = person.wishes[side][0]
    person.wish(side, (first, first + near), wrist + rub, rotation, "world", arc=0.10)
    person.wish(side, (last - near, last), knee.wrist[0], knee.rotation_at(0), "body")
    person.close_hand(side, first, 0.12)
    person.close_hand(side, last - near, 0.28)
    person.look_at(tuple(crown), (first, last))
    person.scene.event(person.instance, "pet", frames, cat.instance)


def _check_reach(person: Person, side: str, wrist: np.ndarray, frame: int) -> None:
    stance = person.torso_at(frame, crouch=float(person.crouch[frame]), bend=float(person.bend[frame]))
    here = np.array([*person.xy[frame], person.ground_m])
    local = turn_z(-float(person.heading[frame])) @ (wrist - here)
    gap = float(np.linalg.norm(local - person.puppet.shoulder(stance, side)))
    arm = sum(person.puppet.arm[side])
    if gap > _REACH * arm:
        raise RecipeError(
            f"{person.instance.name} can't reach at frame {frame}: {100 * (gap / arm - _REACH):.0f} % of an"
            " arm's length is missing",
            "let the cat sit closer",
        )
