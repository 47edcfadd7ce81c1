"""What a composed scene is made from: its seed, and what is pinned instead of drawn.

Owns the JSON form, which replaces a recipe's Python file. Knows nothing of Blender.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

SCHEMA = "l4d/composition/1"
SCALES = ("outdoor", "room", "tabletop")
_KEYS = {"schema", "scene", "scale", "seed", "draw", "place", "theme", "categories", "verbs"}


class SpecError(Exception):
    """A composition that cannot be; `hint` says what to do about it."""

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message)
        self.hint = hint


@dataclass(frozen=True)
class Spec:
    """One composed scene. `draw` counts what was thrown away before it; empty fields are drawn.

    `categories` and `verbs` are demands: a draw that lacks one of them is thrown away.
    """

    scene: str
    scale: str
    seed: int
    draw: int = 0
    place: str | None = None
    theme: str | None = None
    categories: tuple[str, ...] = ()
    verbs: tuple[str, ...] = ()

    def to_json(self) -> dict[str, Any]:
        """The content of a composition's file; what is not pinned is left out."""
        pinned = {
            "place": self.place,
            "theme": self.theme,
            "categories": list(self.categories),
            "verbs": list(self.verbs),
        }
        return {
            "schema": SCHEMA,
            "scene": self.scene,
            "scale": self.scale,
            "seed": self.seed,
            "draw": self.draw,
            **{key: value for key, value in pinned.items() if value},
        }


def read(path: Path) -> Spec:
    """Reads a composition; errors name the file and the field."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise SpecError(f"{path}: {error}", "write a composition as `l4d compose` does") from error
    try:
        return from_json(content)
    except SpecError as error:
        raise SpecError(f"{path}: {error}", error.hint) from error


def from_json(content: Any) -> Spec:
    """A composition from its JSON."""
    if not isinstance(content, Mapping) or content.get("schema") != SCHEMA:
        raise SpecError("not a composition", f'it is an object whose "schema" is "{SCHEMA}"')
    unknown = sorted(set(content) - _KEYS)
    if unknown:
        raise SpecError(f"unknown field {unknown[0]!r}", f"fields are {', '.join(sorted(_KEYS))}")
    spec = Spec(
        _field(content, "scene", str),
        _field(content, "scale", str),
        _field(content, "seed", int),
        _field(content, "draw", int, 0),
        _field(content, "place", str, None),
        _field(content, "theme", str, None),
        _words(content, "categories"),
        _words(content, "verbs"),
    )
    if spec.scale not in SCALES:
        raise SpecError(f"scale is {spec.scale!r}", f"one of {', '.join(SCALES)}")
    if spec.seed < 0 or spec.draw < 0:
        raise SpecError("seed and draw are at least 0", "see docs/compose.md")
    return spec


_REQUIRED = object()


def _field(content: Mapping[str, Any], key: str, kind: type, default: Any = _REQUIRED) -> Any:
    value = content.get(key, default)
    if value is _REQUIRED:
        raise SpecError(f"{key} is missing", f"{key} is a {kind.__name__}")
    if value is not default and (not isinstance(value, kind) or isinstance(value, bool)):
        raise SpecError(f"{key} is {value!r}", f"{key} is a {kind.__name__}")
    return value


def _words(content: Mapping[str, Any], key: str) -> tuple[str, ...]:
    value = content.get(key, [])
    if not isinstance(value, list) or not all(isinstance(word, str) for word in value):
        raise SpecError(f"{key} is {value!r}", f"{key} is a list of words")
    return tuple(value)
