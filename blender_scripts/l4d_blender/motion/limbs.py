"""Limbs of animals: joints that reach, and bones that follow, as motions from rest in the rig's space."""

from __future__ import annotations

import math
from collections.abc import Sequence

from mathutils import Matrix, Quaternion, Vector


def about(point: Vector, rotation: Matrix) -> Matrix:
    """A rotation round a point."""
    return Matrix.Translation(point) @ rotation @ Matrix.Translation(-point)


def carried(at: Vector, turn: Quaternion, rest: Vector) -> Matrix:
    """The motion of a bone whose root goes from `rest` to `at` while it turns."""
    return Matrix.Translation(at) @ turn.to_matrix().to_4x4() @ Matrix.Translation(-rest)


def segment(rest_start: Vector, rest_end: Vector, start: Vector, end: Vector) -> Matrix:
    """The motion of a bone from its rest place to another, the short way round."""
    return carried(start, (rest_end - rest_start).rotation_difference(end - start), rest_start)


def two_bones(
    start: Vector, end: Vector, first: float, second: float, pole: Vector, longest: float = 0.999
) -> tuple[Vector, Vector]:
    """Middle joint and reachable end of two bones (lengths `first`, `second`) that bend towards `pole`.

    They stretch to the share `longest` of their length.
    """
    way = end - start
    reach = min(max(way.length, 1.02 * abs(first - second)), longest * (first + second))
    axis = way.normalized()
    along = (first * first - second * second + reach * reach) / (2 * reach)
    off = math.sqrt(max(first * first - along * along, 0.0))
    return start + axis * along + (pole - pole.project(axis)).normalized() * off, start + axis * reach


def frame(direction: Vector, pole: Vector) -> Matrix:
    """Axes of a bone: z along it, y towards the pole."""
    z = direction.normalized()
    x = pole.cross(z).normalized()
    return Matrix((x, z.cross(x), z)).transposed()


def untwisted(
    rest: Sequence[Vector], points: Sequence[Vector], rest_pole: Vector, pole: Vector
) -> list[Matrix]:
    """Motions of the bones between joints, from their rest places to solved ones, without twisting."""
    moved = []
    for k in range(len(points) - 1):
        before, after = frame(rest[k + 1] - rest[k], rest_pole), frame(points[k + 1] - points[k], pole)
        moved.append(carried(points[k], (after @ before.transposed()).to_quaternion(), rest[k]))
    return moved
