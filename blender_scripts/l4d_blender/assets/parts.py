"""Assets from parts: each has a shape, a material and a place, and all are joined into one object.

    parts = Parts(name)
    parts.box("top", oak, (1.0, 0.6, 0.03), 0.004, z=0.7)
    for side in (-1, 1):
        parts.cylinder("leg", oak, 0.02, 0.7, x=0.4 * side)
    parts.add(bent_rail(), steel, z=0.3)
    return parts.join()

What a part is called says what it is; only the name of the whole remains.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypedDict, Unpack

import bpy
from mathutils import Matrix

from . import mesh
from .mesh import Point

CORNERS = ((-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0))


class Place(TypedDict, total=False):
    """Where a part goes: turned about an axis by degrees, then shifted, then put into a frame."""

    turn: tuple[str, float]
    x: float
    y: float
    z: float
    within: Matrix


def placed(
    shape: bpy.types.Object, material: bpy.types.Material | None, **place: Unpack[Place]
) -> bpy.types.Object:
    """The shape itself at its place, of one material (None: of those that it has).

    Each step is a call of its own in `mesh`, never one product of matrices, which would round otherwise.
    """
    if "turn" in place:
        mesh.rotate(shape, *place["turn"])
    if not place.keys().isdisjoint("xyz"):
        mesh.move(shape, place.get("x", 0.0), place.get("y", 0.0), place.get("z", 0.0))
    if "within" in place:
        mesh.transform(shape, place["within"])
    return mesh.set_material(shape, material) if material else shape


class Parts(list[bpy.types.Object]):
    """The parts of the object `name`, in the order in which they are joined.

    The methods that are called as functions in `mesh` take those functions' arguments, after the material.
    It is a list, so that what a helper returns is added with `+=`.
    """

    def __init__(self, name: str) -> None:
        super().__init__()
        self.name = name

    def join(self) -> bpy.types.Object:
        """One object of all parts."""
        return mesh.join(self.name, self)

    def add(
        self, shape: bpy.types.Object, material: bpy.types.Material | None = None, **place: Unpack[Place]
    ) -> bpy.types.Object:
        """Adds any shape; without a material it keeps those that it has."""
        self.append(placed(shape, material, **place))
        return shape

    def box(
        self,
        what: str,
        material: bpy.types.Material,
        size_xyz: Point,
        bevel_m: float = 0.0,
        segments: int = 3,
        **place: Unpack[Place],
    ) -> bpy.types.Object:
        """Adds a box, with rounded edges if `bevel_m` says so."""
        return self.add(mesh.bevel_box(self._named(what), size_xyz, bevel_m, segments), material, **place)

    def cylinder(
        self,
        what: str,
        material: bpy.types.Material,
        radius: float,
        height: float,
        segments: int = 32,
        bevel_m: float = 0.0,
        top_radius: float | None = None,
        **place: Unpack[Place],
    ) -> bpy.types.Object:
        """Adds an upright cylinder or cone."""
        shape = mesh.cylinder(self._named(what), radius, height, segments, bevel_m, top_radius)
        return self.add(shape, material, **place)

    def ellipsoid(
        self,
        what: str,
        material: bpy.types.Material,
        radii: Point,
        segments: int = 24,
        rings: int = 16,
        centre: Point = (0.0, 0.0, 0.0),
        **place: Unpack[Place],
    ) -> bpy.types.Object:
        """Adds an ellipsoid."""
        return self.add(mesh.ellipsoid(self._named(what), radii, segments, rings, centre), material, **place)

    def torus(
        self,
        what: str,
        material: bpy.types.Material,
        major: float,
        minor: float,
        segments: int = 48,
        sides: int = 16,
        **place: Unpack[Place],
    ) -> bpy.types.Object:
        """Adds a ring in the XY plane."""
        return self.add(mesh.torus(self._named(what), major, minor, segments, sides), material, **place)

    def lathe(
        self,
        what: str,
        material: bpy.types.Material,
        profile: Sequence[tuple[float, float]],
        segments: int = 48,
        close_bottom: bool = True,
        close_top: bool = False,
        **place: Unpack[Place],
    ) -> bpy.types.Object:
        """Adds a solid of revolution."""
        shape = mesh.lathe(self._named(what), profile, segments, close_bottom, close_top)
        return self.add(shape, material, **place)

    def tube(
        self,
        what: str,
        material: bpy.types.Material,
        points: Sequence[Point],
        radii: float | Sequence[float | tuple[float, float]],
        segments: int = 16,
        cap: bool = True,
        up: Point | None = None,
        closed: bool = False,
        **place: Unpack[Place],
    ) -> bpy.types.Object:
        """Adds a tube along points."""
        shape = mesh.tube(self._named(what), points, radii, segments, cap, up, closed)
        return self.add(shape, material, **place)

    def _named(self, what: str) -> str:
        return f"{self.name}_{what}"
