"""Errands: whole little stories of one or two people with things, drawn on the plan.

Each draws where its people start, which ways they take and how long, for things that have their places.
Raises `NoRoom` where there is no room or time. Builds nothing.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from math import hypot

import numpy as np
from mathutils import Vector

from ...motion import nursery, traders, travellers
from ...motion.people import Person
from ...scene.timeline import FRAME_COUNT, LAST_FRAME
from ..areas import Area, Flat, heading_to
from ..errors import NoRoom
from .folk import Figure
from .rehearsal import Disc, ahead
from .roles import Item, Role

_BODY_M, _LOADED_M = 0.26, 0.34


def bystander(
    rng: random.Random,
    area: Area,
    figure: Figure,
    faces: Flat,
    loose_deg: float = 50.0,
    apart_from: Sequence[Disc] = (),
) -> Role:
    """Somebody who stands somewhere, turned roughly to a point, rather not beside others."""
    spots = [area.spot(rng, _BODY_M) for _ in range(3)]
    at = max(spots, key=lambda spot: min((_gap(spot, disc) for disc in apart_from), default=0.0))
    return Role(figure, at, heading_to(at, faces) + rng.uniform(-loose_deg, loose_deg))


def fetch(rng: random.Random, area: Area, figure: Figure, item: Item, delay: int = 0) -> Role:
    """Walks up to a thing, lifts it and carries it off."""
    side = None if item.ware.two_hands else rng.choice("lr")
    facing, stand = stand_before(rng, area, figure, item.at, side, item)
    role = arriving(rng, area, figure, stand, facing, (0.6, 1.5))
    role.wait(delay)
    role.walk([stand], facing_deg=facing, pace=rng.uniform(2.0, 2.3))
    role.lift(item, side, rng.randint(24, 30))
    if role.left >= 26:
        walk_off(rng, area, role, _LOADED_M)
    return role


def move(rng: random.Random, area: Area, figure: Figure, item: Item, delay: int = 0) -> Role:
    """Lifts a thing at its feet, carries it elsewhere and puts it down."""
    side = None if item.ware.two_hands else rng.choice("lr")
    facing, stand = stand_before(rng, area, figure, item.at, side, item)
    role = Role(figure, stand, facing)
    role.wait(delay)
    role.lift(item, side, rng.randint(24, 28))
    walk_off(rng, area, role, _LOADED_M, longest_m=1.6)
    role.put_down(item, rng.randint(22, 26))
    return role


def bring(rng: random.Random, area: Area, figure: Figure, item: Item, delay: int = 0) -> Role:
    """Comes with a thing in the hand and puts it down."""
    at = area.spot(rng, _LOADED_M)
    role = Role(figure, at, rng.uniform(-180, 180))
    role.hold(item, None if item.ware.two_hands else rng.choice("lr"))
    role.wait(delay)
    walk_off(rng, area, role, _LOADED_M, fresh=True)
    role.put_down(item, rng.randint(22, 28))
    if not area.is_free(item_end(item), 0.8 * item.ware.radius_m):
        raise NoRoom("there is no room to put something down")
    return role


def carry_about(rng: random.Random, area: Area, figure: Figure, item: Item, delay: int = 0) -> Role:
    """Walks past with a thing in the hand."""
    at = area.spot(rng, _LOADED_M)
    role = Role(figure, at, rng.uniform(-180, 180))
    role.hold(item, None if item.ware.two_hands else rng.choice("lr"))
    role.wait(delay)
    first, last = walk_off(rng, area, role, _LOADED_M, fresh=True)
    if item.ware.noun in ("basket", "bucket"):
        _swings(role, item, (first, last))
    return role


def relay(rng: random.Random, area: Area, figure: Figure, item: Item, before: Role) -> Role:
    """Takes up what another has put down, later."""
    at, free_from = item_end(item), before.now
    side = None if item.ware.two_hands else rng.choice("lr")
    facing, stand = stand_before(rng, area, figure, at, side, item)
    role = arriving(rng, area, figure, stand, facing, (0.45, 1.2))
    role.disc.friends.add(before.disc.name)
    role.waits_for.append(before)
    role.walk([stand], facing_deg=facing)
    role.wait(max(0, free_from - 2 - role.now))
    role.lift(item, side, rng.randint(24, 30))
    return role


def brought_and_taken(
    rng: random.Random, area: Area, one: Figure, two: Figure, item: Item
) -> tuple[Role, Role]:
    """One brings a thing and puts it down, another takes it up."""
    first = bring(rng, area, one, item)
    return first, relay(rng, area, two, item, first)


def hand_over(rng: random.Random, area: Area, giver: Figure, taker: Figure, item: Item) -> tuple[Role, Role]:
    """One holds out what hangs from the hand, the other comes and takes it."""
    at, release = area.spot(rng, 0.3), rng.randint(42, 52)
    first = Role(giver, at, rng.uniform(-180, 180))
    gap = 0.46 * first.k + 0.41 * taker.scale + 0.096
    stand = ahead(at, first.facing, gap, -0.05 * (first.k + taker.scale))
    if not area.is_free(stand, _BODY_M, at):
        raise NoRoom("there is no room to meet")
    second = arriving(rng, area, taker, stand, first.facing + 180.0, (0.5, 1.4))
    bar, (grip,) = np.array(item.ware.bar), item.ware.grips(item.look)
    near, far = (tuple(np.array(grip) + d * bar) for d in (-0.048, 0.048))
    ware = item.ware
    first.hold(item, "r", near)
    first.wait(release - 24)
    first.act(44, lambda p, f: traders.offer(p, item.prop.instance, f, release=f[0] + 24, side="r"), 0.30)
    second.walk([stand], facing_deg=first.facing + 180.0)
    if second.now > release - 16:
        raise NoRoom("somebody comes too late")
    second.wait(release - 16 - second.now)
    second.act(
        34,
        lambda p, f: traders.take(
            p, item.prop.instance, far, f, release=f[0] + 16, side="r", clear_m=ware.clear_m
        ),
        0.30,
    )
    first.let_go(item)
    second.held["r"] = item
    second.free_hands = {"l"}
    second.disc.friends |= {item.name}
    second.waits_for.append(first)
    second.hands_follow(release)
    first.disc.friends.add(second.disc.name)
    item.disc.friends |= {first.disc.name, second.disc.name}
    if second.left >= 26:
        walk_off(rng, area, second, _LOADED_M, turn_deg=140.0)
    return first, second


def fetch_and_hug(rng: random.Random, area: Area, figure: Figure, item: Item, delay: int = 0) -> Role:
    """Goes to something soft, takes it up with both hands and hugs it."""
    facing, stand = stand_before(rng, area, figure, item.at, None, item)
    if rng.random() < 0.35:
        role = Role(figure, stand, facing)
        role.wait(delay)
    else:
        role = arriving(rng, area, figure, stand, facing, (0.4, 1.1))
        role.walk([stand], facing_deg=facing)
    role.lift(item, None, rng.randint(26, 32))
    half_m = abs(item.ware.grips(item.look)[0][0])
    role.act(LAST_FRAME - role.now, lambda p, f: nursery.hug(p, item.prop.instance, f, half_m=half_m), 0.36)
    return role


def wait_with_suitcase(rng: random.Random, area: Area, figure: Figure, item: Item) -> Role:
    """Stands with a hand on the handle of a suitcase, then lets go."""
    side = rng.choice("lr")
    sign = 1.0 if side == "l" else -1.0
    facing = item.heading_deg + rng.uniform(-25, 25)
    at = ahead(item.at, facing, -0.05, -sign * 0.44 * figure.scale)
    if not area.is_free(at, _BODY_M):
        raise NoRoom("no room to stand")
    role = Role(figure, at, facing)
    role.free_hands = {"l", "r"} - {side}
    role.disc.friends.add(item.name)
    last = rng.randint(26, 60)

    def do(p: Person) -> None:
        pose = item.prop.instance.matrix(0)
        bar = pose.to_3x3() @ Vector((1.0, 0.0, 0.0))
        travellers.hand_on(p, item.prop.instance, pose @ item.thing.grip, last, side=side, bar=bar)

    role.do(do)
    gesture(rng, role, ("wave", "phone"))
    if role.now < last + 18:
        role.wait(last + 18 - role.now)
    role.free_hands = {"l", "r"}
    return role


def pull_suitcase(rng: random.Random, area: Area, figure: Figure, item: Item) -> Role:
    """Pulls a trolley suitcase along and parks it."""
    at, side = area.spot(rng, _LOADED_M), rng.choice("lr")
    role = Role(figure, at, rng.uniform(-180, 180))
    role.held[side] = item
    role.free_hands = {"l", "r"} - {side}
    role.disc.friends.add(item.name)
    parked: list[int] = []
    role.do(lambda p: parked.append(travellers.pull(p, item.thing, item.prop.instance, parked_at, side=side)))
    way = _way_out(rng, area, role, _LOADED_M, 1.0, 2.1, 180.0)
    role.heading[:] = heading_to(at, way[0])
    parked_at = role.walk(way, pace=rng.uniform(1.9, 2.2))[1]
    back = np.where(np.arange(FRAME_COUNT) < parked_at + 8, -0.55, -0.30) * role.k
    aside = (1.0 if side == "l" else -1.0) * 0.295 * role.k
    for f in range(FRAME_COUNT):
        item.disc.xy[f] = ahead(tuple(role.disc.xy[f]), float(role.heading[f]), float(back[f]), aside)
    role.wait(18)
    role.held.clear()
    role.free_hands = {"l", "r"} - {side}  # its arm has yet to sink
    return role


def gesture(rng: random.Random, role: Role, options: Sequence[str]) -> str:
    """One of these on the spot, if there is time and a free hand; else it stands."""
    lengths = {
        "wave": (34, 50),
        "phone": (26, 44),
        "stretch": (48, 60),
        "crouch": (36, 50),
        "cheer": (32, 44),
        "bend_down": (34, 44),
    }
    fitting = []
    for verb in options:
        needs = lengths[verb][0] + (28 if verb == "phone" and role.now > 0 else 0)
        one_handed = verb in ("wave", "phone")
        hands = role.free_hands if one_handed else not role.held and len(role.free_hands) == 2
        if needs <= role.left and hands:
            fitting.append(verb)
    if not fitting:
        role.stand()
        return "stand"
    verb = rng.choice(fitting)
    most = role.left - (28 if verb == "phone" and role.now > 0 else 0)
    getattr(role, verb)(rng.randint(lengths[verb][0], min(lengths[verb][1], most)))
    return verb


def _gap(spot: Flat, disc: Disc) -> float:
    return float(np.linalg.norm(disc.xy[::8] - np.array(spot), axis=1).min())


def item_end(item: Item) -> Flat:
    """Where something is in the end."""
    return float(item.disc.xy[-1, 0]), float(item.disc.xy[-1, 1])


# ---- ways --------------------------------------------------------------------------------------------


def stand_before(
    rng: random.Random, area: Area, figure: Figure, point: Flat, side: str | None, item: Item
) -> tuple[float, Flat]:
    """A heading and a free spot from which a thing at a point is taken."""
    ahead_m = item.ware.reach_m(item.look, figure.scale)
    for _ in range(12):
        facing = rng.uniform(-180, 180)
        k = figure.scale
        aside = 0.0 if side is None else (1.0 if side == "l" else -1.0) * 0.14 * k
        stand = ahead(point, facing, -ahead_m, -aside)
        if area.is_free(stand, _BODY_M):
            return facing, stand
    raise NoRoom("no room to stand")


def arriving(
    rng: random.Random,
    area: Area,
    figure: Figure,
    stand: Flat,
    facing: float,
    way_m: tuple[float, float],
    spread_deg: float = 60.0,
) -> Role:
    """Somebody who will come to a spot more or less from behind it."""
    for _ in range(16):
        start = ahead(stand, facing + rng.uniform(-spread_deg, spread_deg), -rng.uniform(*way_m))
        if area.is_free(start, _BODY_M, stand):
            return Role(figure, start, heading_to(start, stand) + rng.uniform(-15, 15))
    raise NoRoom("there is no way to get there")


def walk_off(
    rng: random.Random,
    area: Area,
    role: Role,
    radius_m: float,
    *,
    longest_m: float = 2.2,
    turn_deg: float = 100.0,
    fresh: bool = False,
) -> tuple[int, int]:
    """Walks somewhere that can be reached in time; who is `fresh` has looked that way all the time."""
    points = _way_out(rng, area, role, radius_m, 0.7, longest_m, 180.0 if fresh else turn_deg)
    if fresh:
        role.heading[:] = heading_to(role.here, points[0]) + rng.uniform(-12, 12)
    return role.walk(points, pace=rng.uniform(2.0, 2.3))


def _way_out(
    rng: random.Random,
    area: Area,
    role: Role,
    radius_m: float,
    shortest_m: float,
    longest_m: float,
    turn_deg: float,
) -> list[Flat]:
    """One or two points that lead away over free floor."""
    here = role.here
    for _ in range(24):
        heading = role.facing + rng.uniform(-turn_deg, turn_deg)
        goal = ahead(here, heading, rng.uniform(shortest_m, longest_m))
        if rng.random() < 0.4 and hypot(goal[0] - here[0], goal[1] - here[1]) > 1.2:
            halfway = (here[0] + goal[0]) / 2, (here[1] + goal[1]) / 2
            middle = ahead(halfway, heading, 0.0, rng.uniform(-0.2, 0.2))
            if area.is_free(here, radius_m, middle) and area.is_free(middle, radius_m, goal):
                return [middle, goal]
        elif area.is_free(here, radius_m, goal):
            return [goal]
    raise NoRoom("there is no way out")


def _swings(role: Role, item: Item, frames: tuple[int, int]) -> None:
    """A carried thing swings under the hand while somebody walks."""
    first, last = frames[0] + 4, min(frames[1], LAST_FRAME)
    if last - first < 20:
        return
    grip = item.ware.grips(item.look)[0]
    role.after.append(lambda: traders.swing_while_carried(item.prop.instance, grip, [(first, last)]))
