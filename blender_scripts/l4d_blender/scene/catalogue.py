"""The kinds of things that scenes are made of: what each is called, can look like, is good for, and its size.

An asset is a function in `l4d_blender.assets` with the signature `(name, rng, *, attributes)`; the decorator
`kind` enters it here. `scene.make` builds one by the name of its kind. An asset is imported when asked for,
so that a change to one leaves the plans of other scenes valid.
"""

from __future__ import annotations

import difflib
import importlib
import inspect
import pkgutil
import random
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, TypeAlias, TypeVar

from .placing import Thing

AFFORDANCES = frozenset(
    {
        "backdrop",  # surrounds a scene: walls, ground; not something to put somewhere
        "container",  # holds things or liquid
        "drives",
        "flies",
        "graspable",  # a hand can take it
        "hangs",  # belongs on a wall
        "opens",
        "pours",
        "pushable",  # slides when pushed
        "rocks",
        "rolls",
        "seat",
        "spins",
        "stacks",  # others of its kind stand on it
        "stirs",
        "surface",  # things stand on it
        "swims",
        "swings",
        "walks",
        "writes",
    }
)

COLOURS: dict[str, tuple[float, float, float]] = {
    "red": (0.48, 0.045, 0.035),
    "orange": (0.66, 0.20, 0.025),
    "yellow": (0.70, 0.43, 0.03),
    "green": (0.06, 0.24, 0.08),
    "teal": (0.045, 0.20, 0.23),
    "blue": (0.035, 0.11, 0.38),
    "navy": (0.030, 0.050, 0.13),
    "purple": (0.18, 0.05, 0.28),
    "brown": (0.22, 0.11, 0.05),
    "beige": (0.50, 0.42, 0.30),
    "white": (0.72, 0.70, 0.65),
    "grey": (0.28, 0.29, 0.30),
    "black": (0.030, 0.031, 0.034),
}
"""Linear RGB of the words for colours that any paint, glaze or cloth may have."""


class CatalogueError(Exception):
    """No such kind, attribute or value; `hint` names those that exist."""

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.hint = hint


@dataclass(frozen=True)
class Choice:
    """An attribute with words as values: `values` says what the asset gets for each.

    `parameter` is the keyword that gets it, or a field of one ("look.pattern").
    """

    parameter: str
    values: Mapping[str, Any]


@dataclass(frozen=True)
class Range:
    """An attribute with numbers as values (the unit is in the parameter's name)."""

    parameter: str
    low: float
    high: float


Attribute: TypeAlias = Choice | Range
Factory = TypeVar("Factory", bound=Callable[..., Thing])


def colours(parameter: str, *words: str) -> Choice:
    """A colour by its word: one of `words`, or any of COLOURS."""
    return Choice(parameter, {word: COLOURS[word] for word in words or COLOURS})


def words(parameter: str, *values: str) -> Choice:
    """Words that the asset itself understands."""
    return Choice(parameter, {value: value for value in values})


@dataclass(frozen=True)
class Kind:
    """An entry: `category` is the noun of queries, `size_m` the box of one with default attributes."""

    name: str
    category: str
    factory: Callable[..., Thing]
    size_m: tuple[float, float, float]
    affordances: frozenset[str]
    front: str | None = None
    attributes: Mapping[str, Attribute] = field(default_factory=dict)

    def build(self, name: str, rng: random.Random, **attributes: Any) -> Any:
        """Builds one at the origin; a keyword is an attribute of this entry or a parameter of its asset."""
        return self.factory(name, rng, **self.arguments(**attributes))

    def arguments(self, **attributes: Any) -> dict[str, Any]:
        """What the asset function gets for attributes: `find("cat").arguments(coat="black")["coat"]`."""
        defaults = {
            parameter.name: parameter.default
            for parameter in inspect.signature(self.factory).parameters.values()
            if parameter.kind is parameter.KEYWORD_ONLY
        }
        arguments, fields = {}, []
        for key, value in attributes.items():
            attribute = self.attributes.get(key)
            if attribute is None or (isinstance(attribute, Choice) and not isinstance(value, str)):
                if key not in defaults:
                    known = ", ".join(sorted({*self.attributes, *defaults})) or "none"
                    raise CatalogueError(f"{self.name} has no attribute {key!r}", f"it has {known}")
                arguments[key] = value
                continue
            parameter, _, part = attribute.parameter.partition(".")
            value = self._value(key, attribute, value)
            if part:
                fields.append((parameter, part, value))
            else:
                arguments[parameter] = value
        for parameter, part, value in fields:
            arguments[parameter] = replace(arguments.get(parameter, defaults[parameter]), **{part: value})
        return arguments

    def _value(self, key: str, attribute: Attribute, value: Any) -> Any:
        if isinstance(attribute, Range):
            if not attribute.low <= value <= attribute.high:
                raise CatalogueError(
                    f"{key} of {self.name} is {value}", f"from {attribute.low} to {attribute.high}"
                )
            return value
        if value not in attribute.values:
            raise CatalogueError(
                f"{key} of {self.name} is {value!r}", f"one of {', '.join(attribute.values)}"
            )
        return attribute.values[value]


_KINDS: dict[str, Kind] = {}


def kind(
    category: str,
    size_m: tuple[float, float, float],
    *affordances: str,
    front: str | None = None,
    **attributes: Attribute,
) -> Callable[[Factory], Factory]:
    """Enters an asset function in the catalogue, as `<module>` or `<module>.<function>`."""
    unknown = set(affordances) - AFFORDANCES
    if unknown:
        raise CatalogueError(f"no affordance {', '.join(sorted(unknown))}", ", ".join(sorted(AFFORDANCES)))

    def enter(factory: Factory) -> Factory:
        module = factory.__module__.rpartition(".")[2]
        name = module if module == factory.__name__ else f"{module}.{factory.__name__}"
        _KINDS[name] = Kind(name, category, factory, size_m, frozenset(affordances), front, attributes)
        return factory

    return enter


def find(name: str) -> Kind:
    """The kind of that name."""
    module = name.partition(".")[0]
    if name not in _KINDS and module in _modules():
        importlib.import_module(f"l4d_blender.assets.{module}")
    if name not in _KINDS:
        close = difflib.get_close_matches(name, kinds(), 3)
        raise CatalogueError(
            f"no kind {name!r} in the catalogue", f"did you mean {', '.join(close)}?" if close else ""
        )
    return _KINDS[name]


def kinds() -> dict[str, Kind]:
    """All kinds, by name; imports every asset."""
    for module in _modules():
        importlib.import_module(f"l4d_blender.assets.{module}")
    return dict(sorted(_KINDS.items()))


def _modules() -> list[str]:
    from .. import assets

    return [module.name for module in pkgutil.iter_modules(assets.__path__) if not module.ispkg]
