"""Hands that serve at a table: take pots by the ear, pour, stir with a spoon.

Adds to `Hand` what happens with vessels; what is poured or stirred is told by the recipe, the surfaces of
tea are keyed by assets/tea.py. Knows timing and touch, no shapes beyond spout and spoon.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import cos, pi, radians, sin

import numpy as np
from mathutils import Matrix, Vector

from ..assets.anatomy import vec
from ..scene.scene import Instance
from ..scene.timeline import FRAME_COUNT
from .arm import DOWN, matrix_of, thumbward
from .grips import POSES, Placed, Pose, Solid
from .hands import Frames, Hand, Point, _rotation
from .ik import between, ease, turn_z

TIP_FRAMES = 11  # from upright to pouring
_UPRIGHT_RAD = 0.06  # how far a pot that is carried leans


@dataclass(frozen=True)
class Stirring:
    """How a spoon goes round in a vessel.

    `foot` is the middle of the vessel's floor in world metres, `rim_m` its inner radius and height over that
    floor, `toward` the horizontal direction in which the handle leans, `spoon_tip` is in the spoon's axes;
    the tip describes a circle on the floor and the handle a smaller one at the rim.
    """

    foot: Vector
    rim_m: tuple[float, float]
    toward: Vector
    spoon_tip: Vector
    circle_m: float = 0.014

    def at(self, angle: float) -> Matrix:
        """Where the spoon is: at angle 0 it leans on the rim."""
        lean = Vector((self.toward.x, self.toward.y, 0.0)).normalized()
        around = lean * cos(angle) + Vector((0.0, 0.0, 1.0)).cross(lean) * sin(angle)
        inner, height = self.rim_m
        low = self.foot + around * self.circle_m
        high = self.foot + lean * (inner - 0.5 * self.circle_m - 0.0035) + around * (0.5 * self.circle_m)
        return spoon_between(low, high + Vector((0.0, 0.0, height)), self.spoon_tip)


class Server(Hand):
    """A hand that knows how to serve."""

    def _fit(
        self, solid: Solid, grip: str, heading: float, point: Point | None
    ) -> tuple[np.ndarray, np.ndarray, Pose, Pose, np.ndarray]:
        """Grip "ear": the palm against the outer side of an upright bar, fingers round it from behind."""
        if grip != "ear":
            return super()._fit(solid, grip, heading, point)
        fingers = turn_z(heading) @ vec(0, -1, 0)
        way = thumbward(self.side, fingers)
        hand = Placed(
            matrix_of(_rotation(fingers + 0.10 * DOWN, way), vec(0, 0, 0)),
            self.side,
            self.scale,
            self.table_m,
        )
        contact = vec(0.004, -0.090, -0.010)
        hand.matrix[:3, 3] = np.array(point, float) - 0.05 * way - hand.world(contact[None])[0]
        hand.advance(solid, POSES["open_wide"], way, 0.08)
        place = hand.matrix.copy()
        pose = hand.close(solid, POSES["open_wide"], POSES["wrapped"])
        before = place.copy()
        before[:3, 3] -= 0.06 * way
        return before, place, POSES["open_wide"], pose, -way

    def hold_from_start(
        self, thing: Instance, *, grip: str, point: Point, heading_deg: float | None = None
    ) -> None:
        """Has something in its fingers when the clip begins."""
        self.approach(thing, (-24, 0), grip=grip, point=point, heading_deg=heading_deg)

    def raise_spout(self, spout: Vector, to: Point, frames: Frames) -> None:
        """Lifts a pot so that its spout's tip (`spout`, in the pot's axes) arrives at a point."""
        thing = self._require("lift")
        self._swing(thing, spout, Vector(to), _UPRIGHT_RAD, frames, rise_first=True)
        self.scene.event(self.instance, "lift", frames, thing)

    def pour(self, into: Instance, spout: Vector, frames: Frames, *, tip_deg: float) -> Frames:
        """Tips the pot over its spout, waits, and rights it again; returns when tea flows, both inclusive."""
        thing = self._require("pour")
        first, last = frames
        tip = self._where(thing, first) @ spout
        self._swing(thing, spout, tip - Vector((0, 0, 0.012)), radians(tip_deg), (first, first + TIP_FRAMES))
        self._swing(thing, spout, tip, _UPRIGHT_RAD, (last - TIP_FRAMES, last))
        flow = (first + TIP_FRAMES - 3, last - TIP_FRAMES + 4)
        self.scene.event(thing, "tip", frames)
        self.scene.event(thing, "pour_into", flow, into)
        return flow

    def stir(
        self, cup: Instance, way: Stirring, frames: Frames, *, rounds: float, start_deg: float = 0.0
    ) -> None:
        """Moves the held spoon round in a vessel, from where `way` has it at an angle."""
        spoon = self._require("stir")
        first, last = frames
        moved = []
        for f in range(FRAME_COUNT):
            t = float(ease((f - first) / (last - first)))
            moved.append(way.at(radians(start_deg) + 2 * pi * rounds * t))
        self._carry(spoon, moved, first)
        self.scene.event(self.instance, "stir", frames, cup)
        self.scene.event(spoon, "stir", frames, cup)
        self.scene.event(spoon, "circle", frames)

    def lay_down(self, to: Matrix, frames: Frames) -> None:
        """Sets what it holds down in a given pose; `release` follows."""
        thing = self._require("lay down")
        self._carry_between(thing, self._where(thing, frames[0]), to, frames, fall_last=True)
        self.scene.event(self.instance, "put_down", frames, thing)

    def _swing(
        self,
        thing: Instance,
        pivot: Vector,
        to: Vector,
        lean: float,
        frames: Frames,
        *,
        rise_first: bool = False,
    ) -> None:
        """Moves a pivot of the held thing to a point while the thing comes to lean forward by an angle."""
        first, last = frames
        start = self._where(thing, first)
        here, yaw = start @ pivot, _yaw(start)
        upright = Matrix.Rotation(yaw, 3, "Z") @ Matrix.Rotation(lean, 3, "X")
        a, b = np.array(start.to_3x3()), np.array(upright)
        moved = []
        for f in range(FRAME_COUNT):
            t = min(max((f - first) / (last - first), 0.0), 1.0)
            up = float(ease(t))
            across = float(ease((t - 0.45) / 0.55)) if rise_first else up
            at = Vector((*(here.xy + (to.xy - here.xy) * across), here.z + (to.z - here.z) * up))
            turned = Matrix(between(a, b, across)).to_4x4()
            moved.append(Matrix.Translation(at) @ turned @ Matrix.Translation(-pivot))
        self._carry(thing, moved, first)


def spoon_between(low: Vector, high: Vector, spoon_tip: Vector) -> Matrix:
    """A spoon with its tip at `low` whose handle passes through `high`, hollow side up."""
    along = (high - low).normalized()
    across = along.cross(Vector((0.0, 0.0, 1.0))).normalized()
    turned = Matrix((across, along, across.cross(along))).transposed().to_4x4()
    return Matrix.Translation(low) @ turned @ Matrix.Translation(-spoon_tip)


def _yaw(matrix: Matrix) -> float:
    front = matrix.to_3x3() @ Vector((1.0, 0.0, 0.0))
    return float(np.arctan2(front.y, front.x))
