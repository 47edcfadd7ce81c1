"""Who is cast: groups of people of one noun, dressed so that their looks cross and two are twins.

Owns wardrobes: which clothes and hair a noun may have, and what a viewer calls them. Builds no bodies and
knows no acts.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from ...assets.anatomy import BUILDS as BODIES
from ...assets.anatomy import CHIN_M
from ...assets.person import Cloth
from ...assets.person import Look as Dress
from .. import looks

BUILDS: dict[str, tuple[str, ...]] = {
    "person": ("woman", "man"),
    "pedestrian": ("woman", "man"),
    "woman": ("woman",),
    "man": ("man",),
    "child": ("child",),
    "cook": ("woman", "man"),
    "athlete": ("woman", "man"),
}
"""The bodies that each noun may have."""

_HEIGHTS = {"woman": 1.68, "man": 1.77, "child": 1.18}
_TOPS = ("white", "red", "yellow", "green", "blue", "orange", "pink", "purple", "black", "grey")
_TROUSERS = ("beige", "black", "blue", "grey", "white", "red")
_SKIRTS = ("red", "green", "blue", "yellow", "black", "pink")
_HAIR_COLOURS = ("black", "brown", "blond", "red", "grey")
_PATTERNS = {"plain": "plain", "striped": "stripes", "checked": "checks", "dotted": "dots"}
_SKINS = ("pale", "fair", "tan", "brown", "dark")


@dataclass(frozen=True)
class Figure:
    """One person before there is a body: what queries may name, and the clothes that show it."""

    name: str
    noun: str
    look: looks.Look
    dress: Dress
    hat: bool = False

    @property
    def scale(self) -> float:
        """Of the body, 1 for the reference woman."""
        return self.dress.height_m * (1.0 - 1.0 / BODIES[self.dress.build].heads) / CHIN_M


def cast(rng: random.Random, noun: str, count: int, *, wardrobe: str | None = None) -> list[Figure]:
    """A group of `count` people of a noun; two are twins, two properties cross.

    `wardrobe` is the noun whose clothes they wear, if it is not their own.
    """
    options = _options(rng, wardrobe or noun)
    members = looks.crossed(rng, "person", count, options)
    if not all(_builds(noun, member.words) for member in members):  # athletes with buns, on men
        members = looks.crossed(rng, "person", count, {**options, "hair": ("short",)})
    bodies: dict[tuple[tuple[str, str], ...], Dress] = {}
    figures = []
    for k, member in enumerate(members, 1):
        key = tuple(sorted(member.words.items()))
        if key not in bodies:
            bodies[key] = _dressed(rng, noun, member.words)
        dress = replace(bodies[key], height_m=bodies[key].height_m * rng.uniform(0.985, 1.015))
        look = looks.Look("person", {}, _properties(member.words))
        figures.append(Figure(f"{noun}_{k}", noun, look, dress, member.words.get("hat") == "tall"))
    return figures


# ---- wardrobes ---------------------------------------------------------------------------------------


def _options(rng: random.Random, noun: str) -> Mapping[str, Sequence[str]]:
    """Words per property; those with one word only are the same for all of the group."""
    options: dict[str, Sequence[str]] = {"top": _TOPS, "hair_colour": _HAIR_COLOURS}
    if noun == "cook":
        options |= {
            "hat": ("tall", "none"),
            "apron": ("white", "red", "blue", "black", "striped"),
            "sleeves": ("short", "long"),
            "trousers": ("black", "grey"),
        }
        return {**options, "top": ("white", "grey", "light_blue", "red", "yellow")}
    if noun == "athlete":
        return {
            **options,
            "bottom": ("shorts", "leggings"),
            "sleeves": ("none", "short"),
            "hair": ("short", rng.choice(("bun", "long"))),
        }
    options |= {"pattern": tuple(_PATTERNS), "sleeves": ("short", "long")}
    if noun == "man":
        options |= {"trousers": _TROUSERS}
        if rng.random() < 0.4:
            options |= {"jacket": ("none", *rng.sample(("red", "green", "blue", "black"), 2))}
    elif noun == "child":
        options |= {"trousers": _TROUSERS, "bottom": ("trousers", "shorts"), "hair": ("short", "long")}
    else:
        options |= {"hair": ("short", rng.choice(("long", "bun")))}
        clothes = rng.choice(("trousers",) * 3 + ("skirt", "dress", "dress", "jacket", "jacket"))
        if clothes == "dress" and noun == "woman":
            del options["top"]
            return {**options, "dress": _TOPS}
        if clothes == "skirt" and noun == "woman":
            return {**options, "skirt": _SKIRTS}
        options |= {"trousers": _TROUSERS}
        if clothes == "jacket":
            options |= {"jacket": ("none", *rng.sample(("red", "yellow", "green", "blue"), 2))}
    return _under_jackets(rng, options) if "jacket" in options else options


def _under_jackets(rng: random.Random, options: Mapping[str, Sequence[str]]) -> Mapping[str, Sequence[str]]:
    """A jacket hides most of what is under it: that is the same for all."""
    return {**options, "top": (rng.choice(_TOPS),), "pattern": ("plain",), "sleeves": ("long",)}


def _properties(words: Mapping[str, str]) -> dict[str, str]:
    """What queries may name: shorts show no trousers."""
    seen = dict(words)
    if seen.get("bottom") == "shorts":
        seen.pop("trousers", None)
    return seen


def _dressed(rng: random.Random, noun: str, words: Mapping[str, str]) -> Dress:
    """The clothes that show these words on a drawn body."""
    hair = words.get("hair", "short")
    build = rng.choice(_builds(noun, words))
    if "hair" not in words and build != "man":
        hair = rng.choice(("bob", "bun", "ponytail", "short"))
    top = _cloth(words.get("dress") or words.get("top", "white"), words.get("pattern", "plain"))
    bottom, lower = "trousers", _cloth(words.get("trousers", "black"), "plain")
    if words.get("bottom") == "shorts":
        bottom = "shorts"
    if words.get("trousers") == "blue":
        lower = Cloth("denim", "denim")
    if "skirt" in words:
        bottom, lower = "skirt", Cloth(words["skirt"])
    if "dress" in words:
        bottom, lower = "dress", top
    apron, jacket = words.get("apron", "none"), words.get("jacket", "none")
    return Dress(
        build=build,
        height_m=_HEIGHTS[build] * rng.uniform(0.985, 1.015),
        girth=rng.uniform(0.97, 1.08),
        skin=rng.choice(_SKINS),
        hair=hair,
        hair_colour=words["hair_colour"],
        top=top,
        sleeve=words.get("sleeves", "short"),
        bottom=bottom,
        lower=lower,
        apron=None if apron == "none" else _apron(apron),
        jacket=None if jacket == "none" else Cloth(jacket),
        shoe_colour=rng.choice(("brown", "black", "white", "grey")),
        jaw=rng.uniform(0.95, 1.05),
        nose=rng.uniform(0.92, 1.08),
        seed=rng.randrange(1000),
    )


def _builds(noun: str, words: Mapping[str, str]) -> list[str]:
    """The builds of a noun that wear hair like that."""
    return [build for build in BUILDS[noun] if build != "man" or words.get("hair", "short") == "short"]


def _cloth(colour: str, pattern: str) -> Cloth:
    second = "white" if colour not in ("white", "yellow", "light_blue") else "navy"
    return Cloth(colour, _PATTERNS[pattern], second, repeat_m=0.075)


def _apron(word: str) -> Cloth:
    return Cloth("white", "stripes", "blue", repeat_m=0.07) if word == "striped" else Cloth(word)
