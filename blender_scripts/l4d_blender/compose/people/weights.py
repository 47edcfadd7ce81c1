"""Errands with dumbbells: somebody takes one up, curls it and perhaps puts it back."""

from __future__ import annotations

import random

import numpy as np

from ...assets import gym_equipment
from ...motion import lifters
from ...motion.people import Person
from ..areas import Area
from ..errors import NoRoom
from .errands import arriving
from .folk import Figure
from .rehearsal import ahead
from .roles import Item, Role

STEP_M = gym_equipment.STEP_TOP_M  # they lie on steps: no one curls from the floor
_OVERHAND_DEG = float(np.degrees(lifters.OVERHAND))


def train(rng: random.Random, area: Area, figure: Figure, item: Item, delay: int = 0) -> Role:
    """Bends to a dumbbell, curls it some times, and puts it back if there is time."""
    side = rng.choice("lr")
    sign = 1.0 if side == "l" else -1.0
    for _ in range(12):
        facing = rng.uniform(-180, 180)
        stand = ahead(item.at, facing, -0.40 * figure.scale, -sign * 0.22 * figure.scale)
        if area.is_free(stand, 0.28):
            break
    else:
        raise NoRoom("no room to stand")
    if rng.random() < 0.5:
        role = Role(figure, stand, facing)
        role.wait(delay)
    else:
        role = arriving(rng, area, figure, stand, facing, (0.45, 1.2))
        role.walk([stand], facing_deg=facing)
    item.heading_deg = facing + (_OVERHAND_DEG if side == "r" else -_OVERHAND_DEG)
    item.on = STEP_M
    item.disc.friends.add(role.disc.name)
    first = role.now
    take, reps = (first, first + rng.randint(24, 28)), rng.choice((1, 2, 2))
    curl = (take[1], take[1] + reps * rng.randint(22, 26))
    back = (curl[1], curl[1] + rng.randint(22, 26))
    put_down = back if back[1] <= 96 and rng.random() < 0.75 else None
    if curl[1] > 96:
        raise NoRoom("there is no time to curl")

    def do(p: Person, _: tuple[int, int]) -> None:
        bar_m = item.look.words["look"].bar_height_m
        rest = np.array(item.prop.instance.matrix(0))
        lifters.train(
            p, item.prop.instance, rest, bar_m, side=side, take=take, curl=curl, reps=reps, put_down=put_down
        )

    role.act((curl if put_down is None else put_down)[1] - first, do, 0.42)
    for f in range(take[0] + 14, 97 if put_down is None else put_down[0] + 14):
        item.disc.xy[f] = ahead(stand, facing, 0.25 * figure.scale, sign * 0.24 * figure.scale)
        item.disc.base_m[f] = 0.9 * figure.scale
    if put_down is None:
        role.held[side] = item
        role.free_hands = {"l", "r"} - {side}
    return role
