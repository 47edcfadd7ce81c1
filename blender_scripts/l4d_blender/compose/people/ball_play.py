"""Errands with balls: kicks that send one rolling, passes, throws.

The ball's way is part of the plan and is keyed from the same numbers. Draws on the plan; builds nothing.
"""

from __future__ import annotations

import random

import numpy as np
from mathutils import Quaternion

from ...motion import playing, throwing
from ...motion.ball_games import Ball, RollingBall, slowing
from ...motion.people import Person
from ...scene.timeline import FRAME_COUNT, LAST_FRAME
from ..areas import Area, Flat
from ..errors import NoRoom
from .errands import arriving
from .folk import Figure
from .rehearsal import ahead
from .roles import Item, Role

_STEP_IN_M = 0.42  # how far a kick carries the body, on the reference body
_CLEAR_M = 0.22  # a ball that hangs from a hand is beside the leg
_POWER = 2.2


def kick(rng: random.Random, area: Area, figure: Figure, item: Item, delay: int = 0) -> Role:
    """Steps up to a ball and kicks it away."""
    heading, end = _aim(rng, area, item, item.at, (0.9, 2.2))
    role = _kicker(rng, area, figure, item, heading, delay)
    strike = _kick(rng, role, item)
    _roll(rng, area, item, [(strike, end)])
    return role


def kicked_back(rng: random.Random, area: Area, one: Figure, two: Figure, item: Item) -> tuple[Role, Role]:
    """One kicks a ball to another, who kicks it on."""
    heading, between = _aim(rng, area, item, item.at, (1.1, 1.8))
    first = _kicker(rng, area, one, item, heading, rng.randint(0, 3))
    strike = _kick(rng, first, item)
    back = heading + 180.0 + rng.uniform(-70, 70)
    spot = playing.kick_spot(two.dress, between, back, item.ware.radius_m)
    if not area.is_free(spot, 0.26):
        raise NoRoom("there is no room to kick")
    second = Role(two, spot, back)
    second.disc.friends.add(item.name)
    second.wait(strike + 34)
    again = _kick(rng, second, item)
    _roll(rng, area, item, [(strike, between), (again, ahead(between, back, rng.uniform(0.8, 1.5)))])
    return first, second


def throw(rng: random.Random, area: Area, figure: Figure, item: Item, delay: int = 0) -> Role:
    """Has a ball in the hand and throws it underarm; it hops and rolls to rest."""
    at, side = area.spot(rng, 0.3), rng.choice("lr")
    role = Role(figure, at, rng.uniform(-180, 180))
    first = 4 + delay
    release, bounce = first + 18, first + 18 + rng.randint(12, 14)
    again, rest = bounce + 7, bounce + 7 + rng.randint(26, 32)
    way = role.facing + rng.uniform(-12, 12)
    reach = rng.uniform(1.3, 2.0)
    spots = [ahead(at, way, m) for m in (reach, reach + 0.35, reach + rng.uniform(0.6, 0.9))]
    if rest > LAST_FRAME or not area.is_free(ahead(at, way, 0.5), item.ware.radius_m + 0.03, spots[-1]):
        raise NoRoom("there is no room to throw")
    role.held[side] = item
    role.free_hands = {"l", "r"} - {side}
    role.disc.friends.add(item.name)
    item.holder = role
    role.hands_follow(0)
    frames = np.arange(FRAME_COUNT)
    knots = [release, bounce, again, rest]
    for axis in range(2):
        places = [item.disc.xy[0, axis], *(spot[axis] for spot in spots)]
        item.disc.xy[:, axis] = np.interp(frames, knots, places)
    item.disc.base_m[:] = np.interp(frames, knots[:2], [1.0, 0.0])
    role.do(lambda p: _hang(p, item, side))
    role.wait(first)
    role.act(
        40,
        lambda p, f: throwing.throw(
            p, item.prop.instance, f, release=release, towards=(*spots[-1], 0.1), side=side
        ),
        0.34,
    )
    role.let_go(item)
    hops = [(bounce, spots[0]), (again, spots[1])]
    role.after.append(lambda: _thrown(role, item, release, hops, (rest, spots[2])))
    return role


def _hang(person: Person, item: Item, side: str) -> None:
    """A ball at a hanging hand, with the palm against its outer side."""
    sign, radius = (1.0 if side == "l" else -1.0), item.ware.radius_m
    person.hold(item.prop.instance, (sign * 0.85 * radius, 0.0, radius), side=side, clear_m=_CLEAR_M)
    person.curl[side][:] = 0.45  # fingers that lie round something big


def _thrown(
    role: Role, item: Item, release: int, hops: list[tuple[int, Flat]], rest: tuple[int, Flat]
) -> None:
    ball = Ball(item.prop.instance, item.ware.radius_m, rest[1], role.ground_m)
    throwing.toss(ball, release, hops, rest)
    ball.finish()


def _aim(
    rng: random.Random, area: Area, item: Item, ball: Flat, way_m: tuple[float, float]
) -> tuple[float, Flat]:
    """A heading for a kick with room before and behind the ball, and where the ball shall stop."""
    for _ in range(24):
        heading = rng.uniform(-180, 180)
        end = ahead(ball, heading, rng.uniform(*way_m))
        start = ahead(ball, heading, -0.9)
        if area.is_free(ball, item.ware.radius_m + 0.03, end) and area.is_free(start, 0.26, ball):
            return heading, end
    raise NoRoom("there is no room to kick")


def _kicker(rng: random.Random, area: Area, figure: Figure, item: Item, heading: float, delay: int) -> Role:
    """Somebody who stands behind a ball, or who walks up to it."""
    spot = playing.kick_spot(figure.dress, item.at, heading, item.ware.radius_m)
    if not area.is_free(spot, 0.24):
        raise NoRoom("there is no room to kick")
    if rng.random() < 0.5:
        role = Role(figure, spot, heading)
        role.wait(delay)
    else:
        role = arriving(rng, area, figure, spot, heading, (0.45, 1.0), spread_deg=35.0)
        role.wait(min(delay, 6))
        role.walk([spot], facing_deg=heading)
    return role


def _kick(rng: random.Random, role: Role, item: Item) -> int:
    """Plans a kick from where somebody stands; returns the frame at which foot and ball meet."""
    first, here, heading = role.now, role.here, role.facing
    strike = first + rng.randint(10, 12)
    role.act(
        strike + 16 - first,
        lambda p, f: playing.kick(p, item.prop.instance, f, strike=strike, side="r"),
        0.36,
    )
    role.disc.xy[first:] = ahead(here, heading, 0.5 * _STEP_IN_M * role.k)
    role.disc.xy[strike:] = ahead(here, heading, _STEP_IN_M * role.k)
    role.disc.friends.add(item.name)
    return strike


def _roll(rng: random.Random, area: Area, item: Item, rolls: list[tuple[int, Flat]]) -> None:
    """Lets a ball roll from where it lies from each frame to each place."""
    here, spans = item.at, []
    for start, end in rolls:
        if not area.is_free(here, item.ware.radius_m + 0.03, end):
            raise NoRoom("there is no room to roll")
        stop = start + rng.randint(30, 34)
        if stop > LAST_FRAME:
            raise NoRoom("there is no time to roll")
        t = np.clip((np.arange(start, FRAME_COUNT) - start) / (stop - start), 0.0, 1.0)
        share = (1.0 - (1.0 - t) ** _POWER)[:, None]
        item.disc.xy[start:] = np.array(here) + share * (np.array(end) - np.array(here))
        spans.append((start, stop, end))
        here = end
    turn, radius = Quaternion((0.5, 0.3, 0.8), rng.uniform(0.0, 6.0)), item.ware.radius_m

    def key() -> None:
        at = item.prop.instance.matrix(0).translation
        centre = (at.x, at.y, at.z + radius)
        ball = RollingBall(item.prop.instance, radius, centre, turn)
        for start, stop, end in spans:
            ball.roll_along([(*end, centre[2])], (start, stop), slowing(_POWER))
        ball.finish()

    item.before.append(key)
