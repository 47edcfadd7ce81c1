"""People who work in an office: open a laptop, type, write on a board, drink from a mug.

Verbs over a Person that aim with fingertips; each animates the body (and what it moves) and records what it
shows. Knows how hands meet keys, lids and pens; refuses to know desks and rooms.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from math import pi, radians

import bpy
import numpy as np
from mathutils import Matrix, Vector

from ..assets.anatomy import SIDES, vec
from ..assets.laptop import Laptop
from ..scene import keys
from ..scene.scene import Instance
from ..scene.timeline import FPS, FRAME_COUNT
from .fingertips import Rigid, move_rigid, pen_in_hand, tip_offset
from .ik import ease, turn_about, turn_z
from .people import Person
from .plan_person import ROWS, SIGN, Frames
from .sitting import UP, way_ahead, way_inwards

OPEN_RAD = radians(108.0)
REACH_FRAMES = 9
PEN_CURL = 0.46


class Computer:
    """A laptop that stands somewhere: its instance and the lid's angle at all frames."""

    def __init__(self, instance: Instance, made: Laptop, at: Matrix, is_open: bool) -> None:
        self.instance, self.made, self.at = instance, made, at
        self.angles = np.full(FRAME_COUNT, OPEN_RAD if is_open else 0.0)
        made.base.matrix_basis = at

    @property
    def away(self) -> np.ndarray:
        """The direction from the user to the screen."""
        return np.array((self.at.to_3x3() @ Vector((0.0, 1.0, 0.0))).normalized())

    def place(self, point: Vector) -> np.ndarray:
        """World position of a point of the base."""
        return np.array(self.at @ point)

    def finish(self) -> None:
        """Keys the lid."""
        matrices = [self.at @ self.made.lid_matrix(float(a)) for a in self.angles]
        self.made.lid.matrix_basis = matrices[0]
        if np.ptp(self.angles) > 0.0:
            keys.key_matrices(self.made.lid, matrices)


# ---- laptops -----------------------------------------------------------------------------------


def open_lid(
    person: Person, computer: Computer, frames: Frames, *, side: str = "r", aside_m: float = 0.05
) -> None:
    """Takes the rim of a shut lid, swings it up, lets go."""
    first, last = frames
    swing = (first + 2, last)
    u = ease((ROWS - swing[0]) / (swing[1] - swing[0]))
    start = float(computer.angles[first])
    computer.angles = np.where(first > ROWS, computer.angles, start + (OPEN_RAD - start) * u)
    away, medial = computer.away, way_inwards(person, side, last)
    tilts = radians(-4.0) + radians(46.0) * u
    curl, wrists, turned = 0.20, [], []
    for angle, tilt in zip(computer.angles, tilts):
        along = np.cos(tilt) * away + np.sin(tilt) * UP + 0.25 * medial
        palm = np.cos(tilt) * UP - np.sin(tilt) * away + 0.55 * medial
        rotation = person.puppet.hand_rotation(side, along, palm)
        rim = computer.place(computer.made.lid_edge(float(angle), -SIGN[side] * aside_m))
        tip = rim - 0.010 * away
        wrists.append(tip - tip_offset(person.puppet, side, "middle", curl, rotation))
        turned.append(rotation)
    person.wish(side, (first - 5, swing[0]), np.array(wrists), np.array(turned), "world", arc=0.12)
    person.close_hand(side, first - 5, curl)
    person.look_at(tuple(computer.place(computer.made.home_row())), (first - 5, last))
    person.scene.event(person.instance, "open", frames, computer.instance)
    person.scene.event(computer.instance, "swing_open", (swing[0], last))


def type_on(person: Person, computer: Computer, frames: Frames, *, arrive: int = REACH_FRAMES) -> None:
    """Types with both hands; the fingers come to the keys during the `arrive` frames before."""
    first, last = frames
    away = computer.away
    for n, (side, s) in enumerate(SIDES):
        medial = way_inwards(person, side, first)
        turned = person.puppet.hand_rotation(
            side, away - 0.34 * UP + 0.16 * medial, -UP - 0.30 * away + 0.12 * medial
        )
        t = (ROWS - first) / FPS
        phase = person.phase + 1.9 * n
        busy = ease((ROWS - first) / 5.0) * ease((last - ROWS) / 4.0)
        tap = np.clip(np.sin(2 * pi * 2.7 * t + phase), 0.0, None) * busy
        drift = 0.020 * np.sin(2 * pi * 0.83 * t + phase) + 0.010 * np.sin(2 * pi * 1.41 * t + 2 * phase)
        rows = 0.8 * np.sin(2 * pi * 0.61 * t + 2.3 * phase)
        curl = 0.36 + 0.08 * np.sin(2 * pi * 2.7 * t + phase + 0.9) * busy
        wrists = np.array(
            [
                computer.place(computer.made.home_row(-s * 0.062 + float(d * b), float(r * b)))
                + (0.007 + 0.011 * float(up)) * UP
                - tip_offset(person.puppet, side, "middle", float(c), turned)
                for d, r, b, up, c in zip(drift, rows, busy, tap, curl)
            ]
        )
        person.wish(side, (first - arrive, first), wrists, turned, "world", arc=0.03)
        person.curl[side] = np.where(first - 4 <= ROWS, curl, person.curl[side])
    person.look_at(tuple(computer.place(0.6 * computer.made.lid_edge(OPEN_RAD))), (first - arrive, last))
    person.scene.event(person.instance, "type_on", frames, computer.instance)


# ---- mugs --------------------------------------------------------------------------------------


def drink_from(
    person: Person,
    mug: Instance,
    handle: Sequence[float],
    rim: Sequence[float],
    frames: Frames,
    *,
    side: str = "r",
) -> None:
    """Takes a mug by its handle and drinks until the interval ends.

    `handle` is the middle of the handle's grip and `rim` the radius and height of the rim, both in the
    mug's own space; the mug's body must be on the inner side of the hand.
    """
    first, last = frames
    grasp, mouth_at = first + 8, first + 19
    at = np.array(mug.matrix(0))
    middle = at[:3, 3]
    grip = at[:3, :3] @ np.array(handle, float) + middle
    ahead = way_ahead(person, first)
    palm = (middle - grip) * np.array([1.0, 1.0, 0.0])
    palm /= np.linalg.norm(palm)
    turned = person.puppet.hand_rotation(side, -SIGN[side] * np.cross(palm, UP), palm)
    person.wish(
        side, (first, grasp - 2), grip - person.puppet.grip_offset(side, turned), turned, "world", arc=0.03
    )
    person.close_hand(side, first, 0.25)
    person.close_hand(side, grasp - 5, 0.74, within=6)

    mouth = _mouth(person, mouth_at)
    lateral = np.cross(ahead, UP)
    low_elbow = vec(SIGN[side] * 0.6, 0.2, -1.0)
    for start, end, tip in ((grasp + 1, mouth_at, 0.25), (mouth_at, mouth_at + 8, 0.62)):
        tilt = turn_about(lateral, tip)
        centre = mouth - tilt @ (rim[1] * UP - rim[0] * ahead)
        bar = centre + tilt @ (grip - middle)
        rotation = tilt @ turned
        wrist = bar - person.puppet.grip_offset(side, rotation)
        person.wish(side, (start, end), wrist, rotation, "world", pole=low_elbow)
    person.look_at(tuple(mouth + 2.0 * ahead - 0.1 * UP), (grasp, last))
    person.late.append(partial(move_rigid, Rigid(mug, side, grasp, last)))
    person.scene.event(person.instance, "hold", (grasp, last), mug)
    person.scene.event(person.instance, "drink_from", (mouth_at, last), mug)


# ---- boards ------------------------------------------------------------------------------------


def write_on(
    person: Person,
    board: Instance,
    pen: Instance,
    line: Sequence[Vector],
    strokes: Sequence[bpy.types.Object],
    frames: Frames,
    tray: Vector,
    put_away: Frames,
    *,
    side: str = "r",
) -> None:
    """Writes a line (points in board space, one per frame) with a pen held from the first frame on, and
    lays the pen on the tray; `strokes` come out of the board where the pen has passed."""
    first, last = frames
    at = board.matrix(0)
    turn = np.array(at.to_3x3())
    inwards, across = turn @ vec(0, 1, 0), turn @ vec(1, 0, 0)
    tip, way = pen_in_hand(person.puppet, side, PEN_CURL, 0.040)
    rotation = person.puppet.hand_rotation(
        side, 0.80 * UP + 0.50 * inwards - 0.35 * across, inwards - 0.2 * UP
    )
    points = np.array([at @ line[int(np.clip(f - first, 0, len(line) - 1))] for f in range(FRAME_COUNT)])
    person.wish(side, (-2, -1), points - rotation @ tip, rotation, "world")
    person.curl[side][:] = PEN_CURL
    for k, stroke in enumerate(strokes):
        hidden = at @ Matrix.Translation((0.0, 0.012, 0.0))
        keys.key_matrices(stroke, [at if f > first + k else hidden for f in range(FRAME_COUNT)])

    spot = np.array(at @ tray)
    down = person.puppet.hand_rotation(side, inwards - 0.55 * UP - 0.3 * across, -UP - 0.3 * inwards)
    start, end = put_away
    arrive = end - 4
    person.wish(side, (start, arrive - 1), spot + 0.012 * UP - down @ (tip - 0.06 * way), down, "world")
    person.close_hand(side, arrive + 1, 0.25, within=5)
    person.lower_arm(side, (arrive + 2, end + 8))
    in_hand = _pen_matrix(person, side, tip, way)
    goal = at @ Matrix.Translation(tray) @ Matrix.Rotation(pi / 2, 4, "Y") @ Matrix.Translation((0, 0, -0.06))
    away = Rigid(pen, side, 0, arrive, in_hand=in_hand, goal=goal, settle=4)
    person.late.append(partial(move_rigid, away))
    person.look_at(tuple(points[last]), (0, last))
    person.scene.event(person.instance, "write_on", frames, board)
    person.scene.event(person.instance, "hold", (0, arrive), pen)
    person.scene.event(person.instance, "put_down", put_away, pen)


def _pen_matrix(person: Person, side: str, tip: np.ndarray, way: np.ndarray) -> Matrix:
    """The pen (tip at its origin, tail at +Z) in the rest pose of the body."""
    wrist = person.puppet.joints[f"hand_{side}"]
    turn = Vector((0.0, 0.0, 1.0)).rotation_difference(Vector(-way))
    return Matrix.Translation(wrist + tip) @ turn.to_matrix().to_4x4()


# ---- where the body is -------------------------------------------------------------------------


def _mouth(person: Person, frame: int) -> np.ndarray:
    """The lips of a head that looks straight ahead."""
    heading = turn_z(float(person.heading[frame]))
    stance = person.torso_at(frame, float(person.crouch[frame]), float(person.bend[frame]))
    stance.pelvis = stance.pelvis + heading.T @ np.array([*person.slide[frame], 0.0])
    at, chest = person.puppet.torso(stance)["chest"]
    neck = at + chest @ (person.puppet.joints["neck"] - person.puppet.joints["chest"])
    head = neck + chest @ (person.puppet.joints["head"] - person.puppet.joints["neck"])
    lips = head + vec(0.0, -0.105, 0.006) * person.k
    return np.array([*person.xy[frame], person.ground_m]) + heading @ lips
