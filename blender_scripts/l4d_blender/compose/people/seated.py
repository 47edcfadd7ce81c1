"""Errands of people on chairs: they sit down, read, telephone and wave while they sit."""

from __future__ import annotations

import random

import numpy as np
from mathutils import Euler, Matrix

from ...motion import reading, sitting, travellers
from ...motion.people import Person
from ...scene.timeline import LAST_FRAME
from ..areas import Area
from ..errors import NoRoom
from ..looks import Look
from ..stage import Chair, Stage
from .folk import Figure
from .rehearsal import ahead
from .roles import Role

_FEET_M = 0.41  # before the point on the seat
_PLAIN = Look("magazine", {}, {})


def sit_down(rng: random.Random, area: Area, figure: Figure, chair: Chair) -> Role:
    """Comes from a side and sits down."""
    feet = ahead(chair.seat[:2], chair.heading_deg, (_FEET_M + 0.04) * figure.scale)
    own = _own(chair)
    for _ in range(20):
        side = rng.choice((-1.0, 1.0)) * rng.uniform(35, 85)
        start = ahead(feet, chair.heading_deg + side, rng.uniform(0.6, 1.3))
        if area.is_free(start, 0.26) and area.is_clear(start, feet, 0.2, ignoring=own):
            break
    else:
        raise NoRoom("there is no way to the chair")
    role = _at_chair(figure, chair, start, 0.0)
    role.heading[:] = chair.heading_deg + (90.0 if side < 0 else -90.0) + rng.uniform(-15, 15)
    role.wait(rng.randint(0, 10))
    role.walk([feet], facing_deg=chair.heading_deg)
    _lower(role, chair)
    return role


def stand_then_sit(rng: random.Random, figure: Figure, chair: Chair) -> Role:
    """Stands before a chair for a while, perhaps waves, and sits down."""
    feet = ahead(chair.seat[:2], chair.heading_deg, (_FEET_M + 0.04) * figure.scale)
    role = _at_chair(figure, chair, feet, chair.heading_deg)
    role.disc.leaves_floor = 0
    if rng.random() < 0.5:
        role.wave(rng.randint(34, 44))
    else:
        role.stand(rng.randint(16, 40))
    _lower(role, chair)
    return role


def sit(rng: random.Random, figure: Figure, chair: Chair, gestures: tuple[str, ...]) -> Role:
    """Sits all the time and makes some gestures."""
    role = _seated(figure, chair)
    role.wait(rng.randint(0, 24))
    for gesture in gestures:
        frames = rng.randint(32, 42)
        if gesture == "wave" and frames <= role.left:
            side = rng.choice("lr")

            def wave(p: Person, f: tuple[int, int], side: str = side) -> None:
                sitting.wave_sitting(p, f, side=side)

            role.act(frames, wave, 0.40)
            role.wait(rng.randint(4, 12))
        elif gesture == "phone" and frames + 26 <= role.left:
            role.wait(26)
            last = LAST_FRAME if role.left - frames < 18 else role.now + frames
            role.act(last - role.now, lambda p, f: travellers.phone(p, f, side="r"), 0.34)
            if last < LAST_FRAME:

                def sink(p: Person, last: int = last) -> None:
                    sitting.hand_on_knee(p, "r", (last + 2, last + 16))

                role.do(sink)
    role.now = LAST_FRAME
    return role


def read(rng: random.Random, stage: Stage, figure: Figure, chair: Chair, number: int = 1) -> Role:
    """Sits with an open magazine and turns a page or two."""
    role = _seated(figure, chair)
    first = rng.randint(10, 26)
    pages = [(first, first + 18)]
    if rng.random() < 0.7:
        second = first + rng.randint(26, 44)
        pages.append((second, second + 18))
    pages = [page for page in pages if page[1] <= LAST_FRAME - 8]

    def do(p: Person) -> None:
        made = stage.scene.make("magazine", f"magazine_{number}", leaves=len(pages))
        prop = stage.register(
            "magazine",
            f"magazine_{number}",
            made,
            at=chair.seat[:2],
            heading_deg=chair.heading_deg,
            area=None,
            look=_PLAIN,
            landmark=True,
        )
        tilt = Euler((0.75, 0.0, np.pi)).to_matrix().to_4x4()
        seat = Matrix.Translation(chair.seat) @ Matrix.Rotation(np.radians(chair.heading_deg), 4, "Z")
        k = figure.scale
        spread = reading.Spread(
            prop.instance, made, seat @ Matrix.Translation((0.0, -0.39 * k, 0.30 * k)) @ tilt
        )
        reading.hold_open(p, spread)
        for leaf, page in enumerate(pages):
            reading.turn_page(p, spread, leaf, page)
        spread.finish()

    role.do(do)
    role.now = LAST_FRAME
    return role


def _own(chair: Chair) -> list[str]:
    return [chair.of.name] if chair.of else []


def _at_chair(figure: Figure, chair: Chair, at: tuple[float, float], heading_deg: float) -> Role:
    role = Role(figure, at, heading_deg)
    role.disc.ignores |= set(_own(chair))
    if chair.of is not None:
        role.touches.append(chair.of)
    return role


def _seated(figure: Figure, chair: Chair) -> Role:
    feet = ahead(chair.seat[:2], chair.heading_deg, _FEET_M * figure.scale)
    role = _at_chair(figure, chair, feet, chair.heading_deg)
    role.disc.xy[:] = ahead(chair.seat[:2], chair.heading_deg, 0.5 * _FEET_M)
    role.disc.radius_m[:], role.disc.leaves_floor = 0.34, 0
    role.disc.height_m = chair.seat[2] + 0.80 * figure.scale
    role.start = feet
    role.do(lambda p: sitting.sit_all_along(p, chair.seat))
    return role


def _lower(role: Role, chair: Chair) -> None:
    first = role.now
    if role.left < 30:
        raise NoRoom("there is no time to sit down")
    role.do(lambda p: p.sit(chair.seat, (first, LAST_FRAME)))
    role.disc.leaves_floor = min(role.disc.leaves_floor, first - 8)
    role.disc.xy[first + 16 :] = ahead(chair.seat[:2], chair.heading_deg, 0.5 * _FEET_M)
    role.now = LAST_FRAME
