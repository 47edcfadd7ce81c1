"""Hands and pens: a pen is taken, writes on a page and is laid down; another is pushed and rolls to rest.

Each method animates the hand and the pen and records what it shows. Knows how a pen is held and how it rolls;
the shapes are in assets/marker_pen.py and assets/notebook.py.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import pi, radians, sin

import bpy
import numpy as np
from mathutils import Matrix, Quaternion, Vector

from ..assets.hand import DIGITS
from ..assets.marker_pen import RADIUS_M, TIP_X_M
from ..scene import keys
from ..scene.scene import Instance
from ..scene.timeline import FPS, FRAME_COUNT
from .arm import matrix_of
from .grips import POSES, Placed, Pose, Solid, digit_frames
from .hands import Frames, _flesh, _rotation
from .ik import between, ease
from .toy_blocks import PushingHand

TIP = Vector((TIP_X_M, 0.0, RADIUS_M))
GRIP_M = 0.036  # from the nib to where the fingers close
_TILT_RAD = radians(54.0)
_LETTER_M = 0.0013
_LETTER_HZ = 2.6
_FOLLOW_FRAMES = 3.0


class PenHand(PushingHand):
    """A hand that writes with a pen or pushes one."""

    def push_rolling(self, distance_m: float, push: Frames, rest_at: int) -> None:
        """Pushes a lying pen away so that it rolls on, `distance_m` in all, and rests at a frame."""
        pen = self._require("push")
        first, last = push
        start = pen.matrix(first)
        across = (start.to_3x3() @ Vector((0.0, 1.0, 0.0))).normalized()
        fingers = Vector(-self._place[first][:3, 1])
        ahead = across if across.dot(fingers) > 0.0 else -across
        knots = [first, 0.5 * (first + last), last, 0.5 * (last + rest_at), rest_at]
        speed = np.interp(np.arange(FRAME_COUNT), knots, [0.0, 0.9, 1.0, 0.42, 0.0])
        speed[: first + 1] = 0.0
        gone = np.cumsum(speed) * distance_m / np.sum(speed)
        pace = gone[last] - gone[last - 1]
        held, rolled = [], []
        middle = start.translation + Vector((0.0, 0.0, RADIUS_M))
        for f in range(FRAME_COUNT):
            late = max(f - last, 0)
            follow = gone[last] + pace * _FOLLOW_FRAMES * (1.0 - np.exp(-late / _FOLLOW_FRAMES))
            held.append(Matrix.Translation(ahead * float(min(gone[f], follow))) @ start)
            turn = Matrix.Rotation(float(gone[f]) / RADIUS_M, 4, Vector((0.0, 0.0, 1.0)).cross(ahead))
            centre = middle + ahead * float(gone[f])
            rolled.append(Matrix.Translation(centre) @ turn @ Matrix.Translation(-middle) @ start)
        self._carry(pen, held, first)
        for obj in pen.objects:
            keys.key_matrices(obj, rolled)
        self.scene.event(self.instance, "push", push, pen)
        self.scene.event(pen, "roll", (first, rest_at))

    def write(
        self,
        page: Instance,
        line: tuple[Vector, Vector],
        *,
        lift: Frames,
        writing: Frames,
        lay: Frames,
        forward: Vector,
    ) -> list[float]:
        """Lifts the held pen off the page, writes from one point to another and lays it down where it was.

        `forward` is the direction in which the writer looks. Returns the share of the line that is written
        at each frame.
        """
        pen = self._require("write")
        took = lift[0]
        lying = pen.matrix(took)
        hand_lying, pose_lying = self._place[took][:3, :3].copy(), self._pose[took].copy()
        tilted, grip_m, hand_turn, pinch, pose = self._writing_grip(pen, lying, line[0], forward)
        grip = TIP + Vector((grip_m, 0.0, 0.0))
        pinch_lying = hand_lying.T @ (np.array(lying @ grip) - self._place[took][:3, 3])

        rest_rotation = lying.to_quaternion()
        track, shares = [], []
        for f in range(FRAME_COUNT):
            up = keys.ease_between(f, *lift) * (1.0 - keys.ease_between(f, *lay))
            share = min(max((f - writing[0]) / (writing[1] - writing[0]), 0.0), 1.0)
            shares.append(share)
            rotation = keys.slerp(rest_rotation, tilted, up)
            nib = line[0].lerp(line[1], share)
            if 0.0 < share < 1.0:
                stroke = _LETTER_M * sin(2 * pi * _LETTER_HZ * (f - writing[0]) / FPS)
                nib = nib + forward * stroke
            poised = nib + tilted @ (grip - TIP)
            hop = 0.035 * (sin(pi * keys.ease_between(f, *lift)) + sin(pi * keys.ease_between(f, *lay)))
            at = (lying @ grip).lerp(poised, up) + Vector((0.0, 0.0, hop))
            track.append(Matrix.Translation(at - rotation @ grip) @ rotation.to_matrix().to_4x4())
            if f >= took:
                turned = between(hand_lying, hand_turn, float(ease(up)))
                held_at = pinch_lying + (pinch - pinch_lying) * up
                self._place[f] = matrix_of(turned, np.array(at) - turned @ held_at)
                self._pose[f] = pose_lying + (pose - pose_lying) * up
        for obj in pen.objects:
            keys.key_matrices(obj, [lying if f < took else track[f] for f in range(FRAME_COUNT)])
        self._busy[took:] = 1.0
        self.scene.event(self.instance, "lift", lift, pen)
        self.scene.event(pen, "write", writing)
        self.scene.event(self.instance, "write_in", writing, page)
        self.scene.event(self.instance, "put_down", lay, pen)
        return shares

    def _writing_grip(
        self, pen: Instance, lying: Matrix, nib: Vector, forward: Vector
    ) -> tuple[Quaternion, float, np.ndarray, np.ndarray, Pose]:
        """While it writes: the pen's rotation, nib to fingers, the hand's rotation, pinch point, fingers."""
        up = Vector((0.0, 0.0, 1.0))
        outwards = forward.cross(up) * (1.0 if self.side == "r" else -1.0)
        back = up * np.sin(_TILT_RAD) + (0.55 * outwards - 0.84 * forward) * np.cos(_TILT_RAD)
        along_now = lying.to_3x3() @ Vector((1.0, 0.0, 0.0))
        rotation = along_now.rotation_difference(back) @ lying.to_quaternion()
        fingers = np.array(0.80 * forward - 0.42 * outwards - 0.42 * up)
        turned = _rotation(fingers, np.array(-0.78 * outwards - 0.62 * up))

        opened = POSES["pinch_open"]
        tips = [digit_frames(d, opened[n])[0][3] for n, d in enumerate(DIGITS[:3])]
        hand = Placed(matrix_of(turned, np.zeros(3)), self.side, self.scale, -1.0)
        pinch = turned.T @ hand.world((0.5 * tips[0] + 0.25 * (tips[1] + tips[2]))[None])[0]
        points, radii = _flesh(POSES["pinch_closed"])
        lowest = float((hand.world(points)[:, 2] - radii * self.scale).min() - (turned @ pinch)[2])
        grip_m = max(GRIP_M, (0.001 - lowest) / float(np.sin(_TILT_RAD)))

        at = nib + rotation @ Vector((grip_m, 0.0, 0.0))
        pen_at = Matrix.Translation(nib - rotation @ TIP) @ rotation.to_matrix().to_4x4()
        solid = _posed(pen, pen_at)
        hand.matrix[:3, 3] = np.array(at) - turned @ pinch
        return rotation, grip_m, turned, pinch, hand.close(solid, opened, POSES["pinch_closed"])


def appear(words: Sequence[bpy.types.Object], reached: Sequence[float], shares: Sequence[float]) -> None:
    """Words rise out of the page (they wait just below its surface) when the nib has come to their end."""
    for word, share in zip(words, reached):
        place = word.matrix_basis.copy()
        below = Matrix.Translation((0.0, 0.0, -0.002)) @ place
        keys.key_matrices(word, [place if done >= share else below for done in shares])


def _posed(thing: Instance, matrix: Matrix) -> Solid:
    """The surface of a thing somewhere else than it is."""
    obj = thing.objects[0]
    probe = bpy.data.objects.new("probe", obj.data)
    probe.matrix_basis = matrix
    solid = Solid([probe], 0)
    bpy.data.objects.remove(probe)
    return solid
