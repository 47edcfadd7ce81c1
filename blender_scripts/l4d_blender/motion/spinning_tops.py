"""Spinning tops: one that runs down and falls over, one that fingers stand up and twist.

Each function plans a top over the whole clip, keys it and records what it shows. Knows how tops lean, wander
and roll to rest; shapes are in assets/spinning_top.py.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import atan2, pi, radians, sin

from mathutils import Matrix, Vector

from ..assets.spinning_top import Profile, lean_at_rest, rim
from ..scene import keys
from ..scene.scene import Instance
from ..scene.timeline import FPS, FRAME_COUNT, LAST_FRAME
from .hands import Frames, Hand

SPIN_HZ = 2.7
_WANDER_M = 0.006


@dataclass
class Attitude:
    """How a top stands: lean from the vertical, where it leans to, its turn round its own axis (radians)."""

    lean: float
    towards: float
    turn: float

    def matrix(self, point: Vector) -> Matrix:
        """World matrix of a top whose point stands there."""
        tip = Matrix.Rotation(self.towards, 4, "Z") @ Matrix.Rotation(self.lean, 4, "Y")
        return Matrix.Translation(point) @ tip @ Matrix.Rotation(self.turn - self.towards, 4, "Z")


def run_down(top: Instance, profile: Profile, at: Vector, *, falls: Frames, towards_deg: float) -> None:
    """Spins from the start, leans more and more, falls over during `falls` and rolls to rest."""
    lying = lean_at_rest(profile)
    radius, height = rim(profile)
    first, last = falls
    touch = first + 0.55 * (last - first)
    track, state = [], Attitude(0.07, radians(towards_deg), 0.0)
    for f in range(FRAME_COUNT):
        slowing = min(f / touch, 1.0)
        sway = 0.07 + 0.16 * slowing**2
        state.lean = sway + (lying - sway) * keys.ease_between(f, first, touch) ** 1.3
        if f < touch:
            state.towards += 2 * pi * (0.45 + 0.75 * slowing) / FPS
            state.turn += 2 * pi * SPIN_HZ * (1.0 - 0.62 * slowing) / FPS
        else:
            rolled = 2 * pi * 0.9 * (1.0 - keys.ease_between(f, touch, last)) / FPS
            reach = (radius**2 + height**2) ** 0.5
            state.towards += rolled
            state.turn += rolled - rolled * reach / radius
        circle = 2 * pi * 0.5 * f / FPS
        wander = _WANDER_M * (1.0 - keys.ease_between(f, first - 12, touch))
        point = at + Vector((wander * sin(circle), wander * sin(circle + 1.2), 0.0))
        track.append(state.matrix(point))
    _key(top, track)
    top.scene.event(top, "spin", (0, first))
    top.scene.event(top, "topple", falls)


def spin_on(top: Instance, profile: Profile, at: Vector, *, towards_deg: float) -> None:
    """Spins over the whole clip and only begins to sway."""
    track, state = [], Attitude(0.05, radians(towards_deg), 0.0)
    for f in range(FRAME_COUNT):
        gone = f / LAST_FRAME
        state.lean = 0.05 + 0.06 * gone**2
        state.towards += 2 * pi * (0.40 + 0.35 * gone) / FPS
        state.turn += 2 * pi * SPIN_HZ * (1.0 - 0.35 * gone) / FPS
        circle = 2 * pi * 0.5 * f / FPS
        track.append(state.matrix(at + _WANDER_M * Vector((sin(circle), sin(circle + 1.2), 0.0))))
    _key(top, track)
    top.scene.event(top, "spin", (0, LAST_FRAME))


def lie(top: Instance, profile: Profile, at: Vector, towards_deg: float) -> None:
    """Lies on its rim."""
    _key(top, [Attitude(lean_at_rest(profile), radians(towards_deg), 0.0).matrix(at)] * FRAME_COUNT)


class TopHand(Hand):
    """A hand that sets tops spinning."""

    def twirl(
        self,
        top: Instance,
        profile: Profile,
        *,
        at: Vector,
        towards_deg: float,
        approach: Frames,
        upright: int,
        let_go: int,
        heading_deg: float,
        way: float = 1.0,
        falls: Frames | None = None,
    ) -> None:
        """Takes a lying top by its stem, stands it up until frame `upright`, twists it, lets it spin.

        `way` is 1 for counter-clockwise, -1 for clockwise. With `falls` it leans more and more, falls over
        during these frames and rolls to rest.
        """
        lying = lean_at_rest(profile)
        start = Attitude(lying, radians(towards_deg), 0.0).matrix(at)
        stem = max(z for _, z in profile) - 0.012
        self.approach(
            top, approach, grip="pinch", heading_deg=heading_deg, point=start @ Vector((0.0, 0.0, stem))
        )
        took = approach[1]
        held, track, turn = [], [], 0.0
        for f in range(FRAME_COUNT):
            up = keys.ease_between(f, took, upright)
            twist = 0.0 if f <= upright else min((f - upright) / (let_go - upright), 1.0) ** 2
            turn += way * (2 * pi * SPIN_HZ * twist / FPS * (1.0 if f <= let_go else 0.985 ** (f - let_go)))
            away = max(f - let_go, 0)
            lean = lying * (1.0 - up) + 0.06 * min(away / 8.0, 1.0)
            towards = radians(towards_deg) + 2 * pi * 0.5 * away / FPS
            track.append(Attitude(lean, towards, turn).matrix(at))
            twisted = way * min(way * turn, 1.1)
            held.append(Attitude(lying * (1.0 - up), radians(towards_deg), twisted).matrix(at))
        if falls is not None:
            track = _toppling(track, profile, at, let_go, falls, way)
        self._carry(top, held, took)
        self.release((let_go, let_go + 7))
        _key(top, track)
        self.scene.event(self.instance, "spin", (upright, let_go), top)
        top.scene.event(top, "spin", (let_go - 4, falls[0] if falls else LAST_FRAME))
        if falls is not None:
            top.scene.event(top, "topple", falls)


def _toppling(
    track: list[Matrix], profile: Profile, at: Vector, let_go: int, falls: Frames, way: float
) -> list[Matrix]:
    """The track of a top that is let go, but it falls over."""
    lying = lean_at_rest(profile)
    radius, height = rim(profile)
    first, last = falls
    touch = first + 0.55 * (last - first)
    turned = track[let_go].to_3x3() @ Vector((1.0, 0.0, 0.0))
    state = Attitude(0.0, 0.0, atan2(turned.y, turned.x))
    ending = list(track[: let_go + 1])
    for f in range(let_go + 1, FRAME_COUNT):
        slowing = min((f - let_go) / (touch - let_go), 1.0)
        sway = 0.06 * min((f - let_go) / 8.0, 1.0) + 0.14 * slowing**2
        state.lean = sway + (lying - sway) * keys.ease_between(f, first, touch) ** 1.3
        if f < touch:
            state.towards += 2 * pi * (0.45 + 0.75 * slowing) / FPS
            state.turn += way * 2 * pi * SPIN_HZ * (1.0 - 0.62 * slowing) / FPS
        else:
            rolled = way * 2 * pi * 0.9 * (1.0 - keys.ease_between(f, touch, last)) / FPS
            state.towards += rolled
            state.turn += rolled - rolled * (radius**2 + height**2) ** 0.5 / radius
        ending.append(state.matrix(at))
    return ending


def _key(top: Instance, track: list[Matrix]) -> None:
    for obj in top.objects:
        keys.key_matrices(obj, track)
