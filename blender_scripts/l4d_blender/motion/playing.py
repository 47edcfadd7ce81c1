"""Children at play: kicking a ball, swinging on a swing, cheering.

Verbs over a Person; knows how legs pump and kick. The swing's angles over time are a function of their own
(`swing_angles`), so that seat and rider share them.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import pi, radians

import numpy as np
from mathutils import Matrix

from ..assets.anatomy import SIDES, Anatomy, vec
from ..assets.person import Look
from ..scene.scene import Instance
from ..scene.timeline import FPS, LAST_FRAME
from . import gait
from .ik import ease, smooth, turn_x, turn_z
from .people import Person
from .plan_person import ROWS, SIGN, Frames

#: Shares of body scale: how far a body moves into a kick, how far ahead its ankle is when the foot meets the
#: ball, and the ball from the ankle (less than a foot: the instep goes under the widest part of a ball).
_STEP_IN, _ANKLE_AHEAD, _TOE_AHEAD = 0.42, 0.20, 0.09


def swing_angles(amplitude: float, frames: Frames, *, drag: int, length_m: float) -> np.ndarray:
    """Angle of a swing (radians, positive forward) that starts at its back turning point at frame 0.

    From `drag` on feet brake it; at the end of `frames` it hangs still.
    """
    first, last = frames
    omega = np.sqrt(9.81 / length_m) / FPS
    free = -amplitude * np.cos(omega * (ROWS - first)) * np.exp(-0.004 * (ROWS - first))
    brake = 1.0 - ease((ROWS - drag) / (last - drag))
    return np.where(first >= ROWS, free[first], free * brake)


def kick_spot(
    look: Look, ball: Sequence[float], heading_deg: float, radius_m: float, side: str = "r"
) -> tuple[float, float]:
    """Where somebody must stand before `kick` so that the foot meets a ball that lies at a point."""
    k = Anatomy(look.build, look.height_m).scale
    ahead = (_STEP_IN + _ANKLE_AHEAD + _TOE_AHEAD) * k + radius_m
    spot = np.array([ball[0], ball[1], 0.0]) - turn_z(radians(heading_deg)) @ vec(
        SIGN[side] * 0.082 * k, -ahead, 0.0
    )
    return float(spot[0]), float(spot[1])


def kick(person: Person, ball: Instance, frames: Frames, *, strike: int, side: str = "r") -> None:
    """Steps beside the ball, swings the leg through it and puts the foot down again.

    Stand at `kick_spot`, facing the way that the ball shall go; the foot meets it at `strike`.
    """
    first, last = frames
    k, heading, other = person.k, float(person.heading[first]), "l" if side == "r" else "r"
    facing = turn_z(heading)
    start = person.xy[first].copy()
    end = start + (facing @ vec(0, -_STEP_IN * k, 0))[:2]
    planted = first + 0.62 * (strike - first)
    beside = end + (facing @ vec(0, -0.10 * k, 0))[:2]
    spot = gait.stance_spot(person.body.anatomy, other, beside, heading)
    person.feet.apply(gait.Step(other, first, planted, spot, heading, 0.8))
    u = ease((ROWS - first) / (strike + 2 - first))
    person.xy = np.where((first < ROWS)[:, None], start + (end - start) * u[:, None], person.xy)

    def at(ahead: float, height: float) -> np.ndarray:
        return np.array([*end, 0.0]) + facing @ vec(SIGN[side] * 0.082 * k, -ahead * k, height * k)

    stands = person.feet.ankle[side][first].copy()
    back = round(strike - 0.42 * (strike - first))
    land = min(strike + 16, last)
    _fly(
        person,
        side,
        [
            (first, stands, 0.0),
            (first + 0.35 * (strike - first), stands + vec(0, 0, 0.055 * k), 0.55),
            (back, at(-0.46, 0.34), 1.15),
            (strike, at(_ANKLE_AHEAD, 0.115), 0.30),
            (strike + 5, at(0.50, 0.36), -0.15),
            (strike + 10, at(0.26, 0.20), 0.05),
            (land, at(-0.022, 0.082), 0.0),
        ],
        heading,
    )
    rest = gait.stance_spot(person.body.anatomy, side, end, heading)
    person.feet.spot[side][land:] = rest
    _lean_through(person, [(first, 0.0), (back, -0.10), (strike, 0.10), (strike + 5, -0.16), (land, 0.0)])
    person.lead = other
    person.look_at(ball, (max(first - 12, 0), LAST_FRAME))
    person.scene.event(person.instance, "kick", (first, last), ball)


def cheer(person: Person, frames: Frames, *, per_s: float = 1.6) -> None:
    """Throws up both arms and bounces at the knees."""
    first, last = frames
    k = person.k
    beat = 2 * pi * per_s * (ROWS - first) / FPS
    for side, s in SIDES:
        high = 1.74 + 0.06 * np.sin(beat)
        wrist = np.stack([s * (0.29 + 0.02 * np.cos(beat)), -0.05 + 0 * beat, high], axis=1) * k
        turned = person.puppet.hand_rotation(side, vec(0.30 * s, -0.10, 1.0), vec(0.15 * s, -1.0, 0.1))
        person.wish(side, (first, first + 12), wrist, turned, "body", pole=vec(s * 1.0, 0.2, -0.4))
        person.lower_arm(side, (last - 12, last))
        person.close_hand(side, first, 0.05)
        person.close_hand(side, last - 10, 0.28)
    during = ease((ROWS - first) / 8) * (1.0 - ease((ROWS - last + 12) / 10))
    person.crouch = person.crouch + 0.030 * k * (1.0 + np.cos(beat + 0.6)) * during
    person.scene.event(person.instance, "cheer", frames)


# ---- on a swing ------------------------------------------------------------------------------


def ride(
    person: Person,
    hung: Matrix,
    angles: np.ndarray,
    *,
    hang_m: float,
    chains_apart_m: float,
    drag: int,
    stop: int,
) -> np.ndarray:
    """Sits on a swing all the clip: pumps while it swings, drags the feet from `drag` to `stop`.

    `hung` is the resting matrix of the seat's pivot, `angles` how far it swings forward per frame. Returns
    where the rider sits (n, 3), for `kick_seated`.
    """
    k, pivot = person.k, np.array(hung)
    heading = float(np.arctan2(-pivot[0, 1], pivot[1, 1]))
    person.heading[:] = heading
    pump = np.clip(smooth(np.gradient(angles), 2.0) / 0.022, -1.0, 1.0) * (
        1.0 - ease((ROWS - drag + 10) / 14)
    )
    person.bend = -0.9 * angles - 0.20 * pump + 0.02 + 0.10 * np.sin(pi * ease((ROWS - drag) / (stop - drag)))
    swung = np.array([pivot[:3, :3] @ turn_x(-a) for a in angles])

    def on_seat(x: float, y: float, z: float) -> np.ndarray:
        """World place, per frame, of a point given relative to the middle of the resting seat."""
        return pivot[:3, 3] + np.einsum("fij,j->fi", swung, vec(x, y, z - hang_m))

    seat = on_seat(0.0, 0.025 * k, 0.085 * k)
    root = person.body.anatomy.joints["root"]
    person.crouch = root[2] - 0.012 * k - seat[:, 2] + person.ground_m
    back = 0.17 * np.sin(person.bend) * k + 0.12 * person.crouch
    person.xy = seat[:, :2] - np.array([(turn_z(heading) @ vec(0, root[1] + b, 0))[:2] for b in back])
    for side, s in SIDES:
        turned = np.array(
            [
                person.puppet.hand_rotation(side, r @ vec(-0.25 * s, -1, 0), r @ vec(-s, 0.25, 0))
                for r in swung
            ]
        )
        grip = on_seat(s * 0.5 * chains_apart_m, 0.0, 0.56 * k)
        wrist = grip - np.array([person.puppet.grip_offset(side, r) for r in turned])
        person.wish(side, (-2, -1), wrist, turned, "world", pole=vec(s * 0.8, 0.5, -0.6))
        person.curl[side][:] = 0.86
        _dangle(person, side, on_seat, seat[np.minimum(ROWS, stop)], heading, pump, (drag, stop))
    person.scene.event(person.instance, "swing", (0, stop))
    return seat


def _dangle(
    person: Person,
    side: str,
    on_seat: Callable[[float, float, float], np.ndarray],
    seat: np.ndarray,
    heading: float,
    pump: np.ndarray,
    brake: Frames,
) -> None:
    """Feet of a rider: stretched on the way forward, tucked on the way back, then on the ground."""
    k, s, (drag, stop) = person.k, SIGN[side], brake
    stretched = on_seat(s * 0.085 * k, -0.74 * k, -0.02 * k)
    tucked = on_seat(s * 0.085 * k, -0.26 * k, -0.36 * k)
    u = 0.5 + 0.5 * pump
    air = tucked + (stretched - tucked) * u[:, None]
    sole = person.feet.soles[side]
    drags = 1.0 - ease((ROWS - stop + 12) / 12)
    ground = np.array(
        [
            sole.lifted(
                np.array([*p[:2], 0.0]) + turn_z(heading) @ vec(s * 0.085, -0.30 - 0.05 * d, 0) * k,
                heading,
                0.30 * d,
            )
            for p, d in zip(seat, drags)
        ]
    )
    down = ease((ROWS - drag + 8) / 12)
    person.feet.ankle[side] = air + (ground - air) * down[:, None]
    person.feet.yaw[side][:] = heading
    in_air = 0.15 - 0.35 * u + 0.25 * (1 - u)
    person.feet.pitch[side] = in_air + (0.30 * drags - in_air) * down
    person.feet.planted[side] = stop <= ROWS


def kick_seated(
    person: Person, seat: np.ndarray, ball: Instance, frames: Frames, *, strike: int, side: str = "r"
) -> None:
    """Kicks from a hanging seat: the foot goes back under it, then forward through the ball."""
    first, last = frames
    k, heading = person.k, float(person.heading[first])
    here = np.array([*seat[strike][:2], 0.0])

    def at(ahead: float, height: float) -> np.ndarray:
        return here + turn_z(heading) @ vec(SIGN[side] * 0.085, -ahead, height) * k

    stands = person.feet.ankle[side][first].copy()
    _fly(
        person,
        side,
        [
            (first, stands, 0.0),
            (strike - 6, at(0.04, 0.17), 0.85),
            (strike, at(0.60, 0.16), 0.10),
            (strike + 5, at(0.72, 0.40), -0.35),
            (strike + 10, at(0.55, 0.20), -0.10),
            (last, person.feet.ankle[side][last].copy(), 0.0),
        ],
        heading,
    )
    rock = ease((ROWS - first) / (strike - first)) * (1.0 - ease((ROWS - strike - 2) / (last - strike)))
    person.bend = person.bend - 0.22 * rock
    person.look_at(ball, (max(first - 14, 0), LAST_FRAME))
    person.scene.event(person.instance, "kick", frames, ball)


def seated_kick_point(
    person: Person, seat: np.ndarray, radius_m: float, side: str = "r"
) -> tuple[float, float]:
    """Where a ball must lie for `kick_seated` once the swing hangs still."""
    local = vec(SIGN[side] * 0.085, -(0.60 + _TOE_AHEAD), 0.0) * person.k - vec(0, radius_m - 0.015, 0)
    spot = np.array([*seat[-1][:2], 0.0]) + turn_z(float(person.heading[-1])) @ local
    return float(spot[0]), float(spot[1])


# ---- strokes ---------------------------------------------------------------------------------


def _fly(person: Person, side: str, knots: list[tuple[float, np.ndarray, float]], yaw: float) -> None:
    """Moves one foot through (frame, ankle, pitch) on a smooth curve; it stands again after the last."""
    frames = np.array([knot[0] for knot in knots], float)
    values = np.array([[*knot[1], knot[2]] for knot in knots])
    path = _hermite(frames, values, ROWS.astype(float))
    inside = (frames[0] <= ROWS) & (frames[-1] >= ROWS)
    feet = person.feet
    feet.ankle[side][inside] = path[inside, :3]
    feet.pitch[side][inside] = path[inside, 3]
    feet.toe[side][inside] = 0.0
    feet.yaw[side][frames[0] <= ROWS] = yaw
    feet.planted[side][inside] = False
    after = frames[-1] < ROWS
    feet.ankle[side][after], feet.pitch[side][after] = values[-1, :3], values[-1, 3]
    feet.planted[side][after] = True
    feet.last_end[side] = float(frames[-1])


def _lean_through(person: Person, knots: list[tuple[float, float]]) -> None:
    frames = np.array([knot[0] for knot in knots], float)
    values = np.array([[knot[1]] for knot in knots])
    lean = _hermite(frames, values, ROWS.astype(float))[:, 0]
    person.bend = person.bend + np.where((frames[0] <= ROWS) & (frames[-1] >= ROWS), lean, 0.0)


def _hermite(knots: np.ndarray, values: np.ndarray, at: np.ndarray) -> np.ndarray:
    """A curve through values with tangents from their neighbours, resting at both ends."""
    slopes = np.zeros_like(values)
    slopes[1:-1] = (values[2:] - values[:-2]) / (knots[2:] - knots[:-2])[:, None]
    n = np.clip(np.searchsorted(knots, at, side="right") - 1, 0, len(knots) - 2)
    span = (knots[n + 1] - knots[n])[:, None]
    t = np.clip((at[:, None] - knots[n][:, None]) / span, 0.0, 1.0)
    h = (2 * t**3 - 3 * t**2 + 1, t**3 - 2 * t**2 + t, -2 * t**3 + 3 * t**2, t**3 - t**2)
    return h[0] * values[n] + h[1] * span * slopes[n] + h[2] * values[n + 1] + h[3] * span * slopes[n + 1]
