"""What an arrangement may be filled with: kinds of the catalogue, a drawn look for each, and its properties.

Owns which kinds are left out and how much room each needs. Knows no places.
"""

from __future__ import annotations

import random
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from math import hypot
from typing import Any

from ...scene import catalogue
from .. import looks
from ..hands.graspables import GRASPABLES
from ..looks import Look
from ..people import cookery, deskwork, folk
from ..people.wares import WARES
from ..themes import themes

_LEFT_OUT = frozenset(
    """
    pot.soup notebook.word hand sitter person fence picket_fence dock tree tree.bush house barn bus swing
    slide tent well market_stall shopfront terminal high_table kitchen_units.base_run kitchen_units.island
    ground.straw_litter lake.lily_pads reeds street_furniture.lamp_post street_furniture.sign_post park_lamp
    farm_tools.ladder gym_equipment.barbell_stand dining_table.tablecloth dining_table.runner chair_row
    crayons.loose_crayons workshop_clutter.loose_parts computer_mouse.cable
    """.split()
)
"""Parts of other things, what is too large to stand among others, what people and hands draw themselves."""

_BALL_RADII_M = (0.035, 0.05, 0.09, 0.12, 0.15)
_ROOM_M = {"waterbird": 0.35, "cat": 0.45, "dog": 0.45, "hen": 0.45}
_DUCKS = frozenset({"drake", "duck_hen", "white_duck", "black_duck"})
_STATES = {"notebook.open_notebook": {"state": "open"}, "notebook.shut_notebook": {"state": "shut"}}


@dataclass(frozen=True)
class Item:
    """One thing before it is built: its noun, its look, and the radius of the disc that it needs."""

    noun: str
    look: Look
    radius_m: float
    words: Mapping[str, Any] = field(default_factory=dict)


@cache
def kinds_by_noun() -> Mapping[str, tuple[str, ...]]:
    """The kinds that may be put somewhere, by the noun that they are called."""
    found: dict[str, list[str]] = {}
    for name, kind in catalogue.kinds().items():
        if name not in _LEFT_OUT and not kind.affordances & {"backdrop", "hangs"}:
            found.setdefault(kind.category, []).append(name)
    found["duck"] = found["bird"] = ["waterbird"]
    return {noun: tuple(sorted(kinds)) for noun, kinds in sorted(found.items())}


@cache
def cast_nouns() -> tuple[str, ...]:
    """The nouns, other than people, of the groups that composed scenes are about."""
    cast = {noun for theme in themes().values() for noun in theme.categories} - set(folk.BUILDS)
    return tuple(sorted(cast & set(kinds_by_noun())))


def draw(rng: random.Random, noun: str) -> Item:
    """One thing of a noun in a drawn look."""
    kind = rng.choice(kinds_by_noun()[noun])
    if noun == "pot":
        return Item(noun, rng.choice(cookery.draw_pots(rng, 3)), 0.19)
    if noun == "laptop":
        return Item(noun, rng.choice(deskwork.draw_laptops(rng, 3)), deskwork.LAPTOP_M)
    if noun in WARES and noun != "ball" and rng.random() < 0.7:
        ware = WARES[noun]
        return Item(noun, rng.choice(ware.draw(rng, 3)), ware.radius_m)
    if kind in GRASPABLES and noun != "ball" and rng.random() < 0.5:
        graspable = GRASPABLES[kind]
        look = rng.choice(graspable.group(rng, 3))
        return Item(noun, look, graspable.radius_m, graspable.fixed)
    return _any_look(rng, noun, kind)


def _any_look(rng: random.Random, noun: str, kind: str) -> Item:
    """Every attribute that has words gets one; what a viewer calls them are the properties."""
    entry, words = catalogue.find(kind), {}
    for key, attribute in entry.attributes.items():
        if isinstance(attribute, catalogue.Choice):
            words[key] = rng.choice(list(attribute.values))
    if kind == "waterbird":
        of_noun = [word for word in looks.words_of(kind, "plumage") if (word in _DUCKS) == (noun == "duck")]
        words["plumage"] = rng.choice(of_noun)
    if words.get("mark") == words.get("colour"):
        words.pop("mark", None)
    look = looks.of(kind, words, _STATES.get(kind))
    properties = {key: value for key, value in look.attributes.items() if key not in ("mark", "palette")}
    extra: dict[str, Any] = {}
    radius_m = _ROOM_M.get(kind, _radius(kind))
    if kind == "ball":
        extra["radius_m"] = radius_m = rng.choice(_BALL_RADII_M)
    return Item(noun, Look(kind, look.words, properties), radius_m, extra)


def _radius(kind: str) -> float:
    x, y, _ = catalogue.find(kind).size_m
    return hypot(x, y) / 2
