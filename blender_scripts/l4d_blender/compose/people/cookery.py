"""Cooks at a counter: one stirs and tastes, one pours from a jug, each before a pot of its own.

Owns where pots, spoon and jug are from a cook and how long each step takes; cooks face -Y.
"""

from __future__ import annotations

import random
from math import radians

import numpy as np

from ...assets import kitchen_jug, pot
from ...motion import cooks
from ...motion.handling import Grip, key_path, rest_hand, still
from ...motion.people import Person
from ...scene.timeline import FRAME_COUNT, LAST_FRAME
from .. import looks
from ..areas import Flat
from ..looks import Look
from ..stage import Prop, Stage

ENAMELS = {"red": (0.50, 0.035, 0.025), "blue": (0.03, 0.10, 0.33), "green": (0.05, 0.22, 0.11)}
SOUPS = (
    ((0.62, 0.13, 0.03), (0.20, 0.30, 0.06)),
    ((0.72, 0.33, 0.04), (0.25, 0.33, 0.07)),
    ((0.30, 0.36, 0.07), (0.66, 0.30, 0.05)),
)
AHEAD_M = 0.54  # from a cook to the pot
_LOW_M = 0.030  # a pot that is poured into is less full


def draw_pots(rng: random.Random, count: int) -> list[Look]:
    """Small pots with a long handle and large ones with loops, of steel or enamel."""
    words = {"size": ("small", "large"), "colour": ("grey", *ENAMELS)}
    found = []
    for member in looks.crossed(rng, "pot", count, words):
        enamel = ENAMELS.get(member.words["colour"])
        small = member.words["size"] == "small"
        shape = pot.PotLook(0.150, 0.185, "two_loops", enamel)
        if small:
            shape = pot.PotLook(0.122, 0.138, "one_long", enamel)
        properties = {**member.attributes, "material": "steel" if enamel is None else "enamel"}
        found.append(Look("pot", {"look": shape}, properties))
    return found


def put_pot(
    stage: Stage, look: Look, name: str, at: Flat, top_m: float, heading_deg: float, soup: int, low: bool
) -> Prop:
    """A pot with soup on a counter."""
    scene, shape = stage.scene, look.words["look"]
    body = scene.make("pot", name, scene.rng("pot"), look=shape)
    colour, bits = SOUPS[soup]
    surface = scene.make("pot.soup", f"{name}_soup", scene.rng(name), look=shape, colour=colour, bits=bits)
    scene.place(body, (*at, top_m), heading_deg)
    scene.place(surface, (*at, top_m + shape.soup_m - (_LOW_M if low else 0.0)), heading_deg)
    return stage.register(
        "pot", name, [body, surface], at=at, heading_deg=heading_deg, area=None, look=look, radius_m=0.19
    )


def stir(
    rng: random.Random, stage: Stage, cook: Person, x: float, own: Prop, other: Prop | None, top_m: float
) -> None:
    """Stirs its pot, tastes or stirs another one, all with one wooden spoon; the left hand rests."""
    spoon = _landmark(stage, "kitchen_tools.wooden_spoon", "spoon")
    way, change = cooks.SpoonPath(), rng.randint(28, 40)
    cook.stoop(-2, -1, 0.16)
    _round(cook, way, own, (0, change), top_m)
    later = change + rng.randint(30, 36)
    if rng.random() < 0.6 or other is None:
        cook.stoop(change - 2, change + 10, 0.05)
        cooks.taste(cook, way, (change + 6, later - 6))
    if later <= LAST_FRAME - 16:
        cook.stoop(later - 16, later, 0.22)
        _round(cook, way, other or own, (later, LAST_FRAME), top_m)
    cooks.use_spoon(cook, spoon.instance, way, 0.255)
    rest_hand(cook, "l", (x + 0.27, cook.stands_at[1] - 0.30, top_m), (0, LAST_FRAME))
    cook.look_at((own.at[0], own.at[1] - 0.4, top_m + 0.1), (0, change))


def pour(rng: random.Random, stage: Stage, cook: Person, x: float, own: Prop, top_m: float) -> None:
    """Pours from a jug into its pot and puts the jug down beside it."""
    jug = _landmark(stage, "kitchen_jug", "jug")
    shape, first, y = own.look.words["look"], rng.randint(8, 26), cook.stands_at[1]
    last, turn = first + rng.randint(24, 30), radians(16)
    cook.stoop(-2, -1, 0.10)
    route = cooks.JugPath(kitchen_jug.LIP, turn)
    over = np.array([own.at[0] + 0.035, own.at[1] + 0.005, top_m + shape.height_m + 0.135])
    route.stand(0, (x + 0.22, y - 0.36, top_m + 0.10))
    if first > 12:
        route.stand(first - 10, (x + 0.22, y - 0.36, top_m + 0.10))
    route.at(first, over, 1.00)
    route.at(last - 2, over + np.array((0, 0, 0.004)), 1.20)
    route.at(last + 8, over + np.array((0.10, 0.04, 0.02)), 0.10)
    down = (last + 6, last + 24)
    route.stand(down[1], (x + 0.29, y - 0.36, top_m))
    handle = Grip(kitchen_jug.GRIP, (0, 0, 1), (-0.30, -0.95, 0))
    path = cooks.pour(
        cook, jug.instance, route, handle, own.instance, (first, last), side="l", puts_down=down
    )
    colour, _ = SOUPS[0]
    falling = kitchen_jug.stream("stream", colour=colour)
    surface = np.full(FRAME_COUNT, top_m + shape.soup_m - _LOW_M)
    key_path(falling, cooks.stream_matrices(path, kitchen_jug.LIP, surface, (first - 1, last - 2), turn))
    rest_hand(cook, "r", (x - 0.27, y - 0.30, top_m), (0, LAST_FRAME))
    cook.look_at((own.at[0], own.at[1] - 0.4, top_m + 0.1), (0, last))


def _round(cook: Person, way: cooks.SpoonPath, into: Prop, frames: tuple[int, int], top_m: float) -> None:
    shape = into.look.words["look"]
    size = {"radius_m": 0.40 * shape.radius_m, "height_m": 0.25 * shape.height_m, "lean": (-0.22, 0.40, 1.0)}
    cooks.stir(cook, way, into.instance, still((*into.at, top_m)), frames, **size)


def _landmark(stage: Stage, kind: str, name: str) -> Prop:
    thing = stage.scene.make(kind, name)
    return stage.register(
        kind, name, thing, at=(0.0, 0.0), heading_deg=0.0, area=None, look=Look(kind, {}, {}), landmark=True
    )
