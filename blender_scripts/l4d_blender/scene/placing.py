"""Where things are put: a point, a heading in degrees, and what they stand on.

A heading turns counter-clockwise seen from above; what has a front faces -Y at heading 0.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import radians
from typing import Any, Protocol, TypeAlias, TypeVar

import bpy
from mathutils import Matrix, Vector

Point: TypeAlias = Sequence[float] | Vector
Spot: TypeAlias = tuple[Point, float]
"""A point and a heading in degrees: `scene.place(thing, *SPOT)`."""


class Body(Protocol):
    """What an asset with moving parts returns: its mesh objects, the one with the axes first."""

    @property
    def parts(self) -> list[bpy.types.Object]:
        """All mesh objects."""

    def place(self, matrix: Matrix) -> None:
        """Moves all parts to where the matrix says."""


class HeightField(Protocol):
    """Uneven ground."""

    height: Callable[[float, float], float]


Thing: TypeAlias = bpy.types.Object | Sequence[bpy.types.Object] | Body
Support: TypeAlias = float | Matrix | bpy.types.Object | HeightField
AnyThing = TypeVar("AnyThing", bound=Thing)


def parts(thing: Thing) -> list[bpy.types.Object]:
    """The mesh objects of a thing, the one with the axes first."""
    if isinstance(thing, bpy.types.Object):
        return [thing]
    several: Any = thing
    return list(getattr(several, "parts", several))


def pose(at: Point, heading_deg: float = 0.0, *, tilt_deg: float = 0.0, scale: float = 1.0) -> Matrix:
    """The matrix of something at a point (x, y or x, y, z), turned, leant back about its own X, scaled."""
    matrix = Matrix.Translation((*at, 0.0)[:3]) @ Matrix.Rotation(radians(heading_deg), 4, "Z")
    if tilt_deg:
        matrix @= Matrix.Rotation(radians(tilt_deg), 4, "X")
    return matrix if scale == 1.0 else matrix @ Matrix.Scale(scale, 4)


def place(
    thing: AnyThing,
    at: Point,
    heading_deg: float = 0.0,
    *,
    on: Support = 0.0,
    tilt_deg: float = 0.0,
    scale: float = 1.0,
) -> AnyThing:
    """Puts a thing at a point and returns it; what a rig moves goes with its rig.

    `on` is what it stands on: a height in metres, ground with a `height(x, y)`, or another thing (or its
    matrix), in whose own axes the point and the heading are then meant.
    """
    x, y, z = (*at, 0.0)[:3]
    if isinstance(on, int | float):
        matrix = pose((x, y, on + z), heading_deg, tilt_deg=tilt_deg, scale=scale)
    elif hasattr(on, "height"):
        matrix = pose((x, y, on.height(x, y) + z), heading_deg, tilt_deg=tilt_deg, scale=scale)
    else:
        frame = on.matrix_basis if isinstance(on, bpy.types.Object) else on
        matrix = frame @ pose((x, y, z), heading_deg, tilt_deg=tilt_deg, scale=scale)
    if isinstance(thing, bpy.types.Object):
        (thing.parent or thing).matrix_basis = matrix
    elif hasattr(thing, "place"):
        thing.place(matrix)
    else:
        for part in parts(thing):
            part.matrix_basis = matrix
    return thing


@dataclass
class Loose:
    """Draws how far things are off their spots, as people put them: at most so many metres and degrees."""

    rng: random.Random
    metres: float
    degrees: float = 0.0

    def point(self, at: Point, share: float = 1.0) -> tuple[float, ...]:
        """A point near `at`; `share` scales how far off it may be."""
        dx, dy = (self.rng.uniform(-self.metres, self.metres) * share for _ in range(2))
        return at[0] + dx, at[1] + dy, *at[2:]

    def __call__(self, spot: Spot, share: float = 1.0) -> Spot:
        """A spot near another, turned a little."""
        at, heading_deg = spot
        return self.point(at, share), heading_deg + self.rng.uniform(-self.degrees, self.degrees) * share
