"""Who and what is cast: groups of one category whose looks cross, so that no single property gives one away.

Of two properties with two values each, every value is shared: a referent needs both, or a place or an act.
Twins look the same in everything. Draws words of the catalogue; builds nothing.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ..scene import catalogue

Words = Mapping[str, str]


@dataclass(frozen=True)
class Look:
    """One of a kind: the words that the catalogue gets, and the properties that queries may name."""

    kind: str
    words: Mapping[str, Any]
    attributes: Words


def of(kind: str, words: Words, fixed: Words | None = None) -> Look:
    """A look by the words of the catalogue; `fixed` are properties that all of the kind have."""
    properties: dict[str, str] = dict(fixed or {})
    for key, word in words.items():
        properties.update(PROPERTIES.get((kind, key), {}).get(word, {key: word}))
    return Look(kind, dict(words), properties)


def crossed(
    rng: random.Random,
    kind: str,
    count: int,
    options: Mapping[str, Sequence[str]],
    fixed: Words | None = None,
) -> list[Look]:
    """Looks for a group of `count` (3 to 5): two keys of `options` cross, two members are twins.

    `options` maps the kind's attributes to the words that may be drawn. Every other key has one word for all.
    """
    keys = [key for key, words in options.items() if len(words) >= 2]
    rng.shuffle(keys)
    first, second = keys[0], keys[1] if len(keys) > 1 else None
    shared = {key: rng.choice(list(words)) for key, words in options.items() if key not in (first, second)}
    a, b = rng.sample(list(options[first]), 2)
    if second is None:
        pairs = [{first: a}, {first: b}]
    else:
        c, d = rng.sample(list(options[second]), 2)
        pairs = [{first: a, second: c}, {first: a, second: d}, {first: b, second: c}, {first: b, second: d}]
        pairs = [pairs[0], *rng.sample(pairs[1:], 3)]
    twin = pairs[0]
    members = [twin, twin, *pairs[1:]][:count]
    looks = [of(kind, {**shared, **words}, fixed) for words in members]
    rng.shuffle(looks)
    return looks


def words_of(kind: str, key: str) -> list[str]:
    """The words that an attribute of a kind may have."""
    attribute = catalogue.find(kind).attributes[key]
    if not isinstance(attribute, catalogue.Choice):
        raise catalogue.CatalogueError(f"{key} of {kind} has numbers, not words")
    return list(attribute.values)


PROPERTIES: dict[tuple[str, str], dict[str, dict[str, str]]] = {
    ("cat", "coat"): {
        "grey_tabby": {"colour": "grey", "pattern": "striped"},
        "orange": {"colour": "orange", "pattern": "white_bib"},
        "black": {"colour": "black", "pattern": "plain"},
        "plain_grey": {"colour": "grey", "pattern": "plain"},
        "grey_bib": {"colour": "grey", "pattern": "white_bib"},
        "black_bib": {"colour": "black", "pattern": "white_bib"},
        "orange_tabby": {"colour": "orange", "pattern": "striped"},
        "white": {"colour": "white", "pattern": "plain"},
        "cream": {"colour": "cream", "pattern": "plain"},
    },
    ("dog", "coat"): {
        "golden": {"colour": "golden", "pattern": "plain", "ears": "floppy"},
        "black_white": {"colour": "black_and_white", "pattern": "patched", "ears": "pricked"},
        "chocolate": {"colour": "brown", "pattern": "plain", "ears": "floppy"},
        "black": {"colour": "black", "pattern": "plain", "ears": "floppy"},
        "white": {"colour": "white", "pattern": "plain", "ears": "pricked"},
        "grey": {"colour": "grey", "pattern": "plain", "ears": "pricked"},
        "brown_white": {"colour": "brown_and_white", "pattern": "patched", "ears": "floppy"},
    },
    ("car", "roof"): {
        "plain": {"roof": "plain"},
        "rack": {"roof": "box"},
        "white": {"roof": "white_roof"},
        "black": {"roof": "black_roof"},
    },
    ("hen", "plumage"): {
        "russet": {"colour": "russet"},
        "white": {"colour": "white"},
        "slate": {"colour": "grey"},
        "buff": {"colour": "golden"},
    },
    ("waterbird", "plumage"): {
        "grey_backed": {"back": "grey"},
        "black_backed": {"back": "black"},
        "mottled_young": {"back": "brown"},
        "drake": {"colour": "grey", "pattern": "plain", "collar": "white"},
        "duck_hen": {"colour": "brown", "pattern": "mottled", "collar": "none"},
        "white_duck": {"colour": "white", "pattern": "plain", "collar": "none"},
        "black_duck": {"colour": "black", "pattern": "plain", "collar": "none"},
    },
}
"""What a word of the catalogue means to somebody who looks, where it is more than `key: word`."""
