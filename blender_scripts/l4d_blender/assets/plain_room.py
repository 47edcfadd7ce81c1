"""The shell of any room, open towards -Y and above: a floor, three walls with openings, skirting.

Owns what is fixed to the building, in finishes that are drawn or chosen by words. Knows nothing of what fills
the openings (lit_window.py) or of furniture. Back wall at +Y, floor at z = 0.
"""

from __future__ import annotations

import random
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import bpy
from mathutils import Matrix

from l4d_blender.assets import mesh, office_room, waiting_room
from l4d_blender.assets.materials import gym, interior, kitchen, products
from l4d_blender.assets.materials.base import principled
from l4d_blender.assets.parts import Parts, placed
from l4d_blender.scene import placing
from l4d_blender.scene.catalogue import kind, words
from l4d_blender.scene.colour import Colour

Opening = tuple[float, float, float, float]
"""From, to along the wall (x of the back wall, y of the others), from, to in height."""

FLOORS = ("boards", "tiles", "chequered", "carpet", "rubber", "concrete")
WALLS = ("plaster", "wallpaper", "two_tone", "panelled", "brick", "boards", "tiled")
DADO_M = 1.05


@dataclass(eq=False)
class Shell:
    """The sheets of a room, each with its own axes, so that patterns run along every wall."""

    parts: list[bpy.types.Object]

    def __post_init__(self) -> None:
        self._local = [part.matrix_basis.copy() for part in self.parts]

    def place(self, matrix: Matrix) -> None:
        """Moves the room."""
        for part, local in zip(self.parts, self._local):
            part.matrix_basis = matrix @ local


@kind("room", (6.0, 4.8, 2.7), "backdrop", floor=words("floor", *FLOORS), wall=words("wall", *WALLS))
def plain_room(
    name: str,
    rng: random.Random,
    *,
    half_width_m: float = 3.0,
    back_m: float = 1.8,
    front_m: float = -3.0,
    height_m: float = 2.7,
    floor: str = "boards",
    wall: str = "plaster",
    floor_colour: Colour = (0.30, 0.18, 0.10),
    wall_colour: Colour = (0.55, 0.52, 0.45),
    second_colour: Colour = (0.30, 0.34, 0.32),
    trim_colour: Colour = (0.68, 0.66, 0.61),
    openings: Mapping[str, Sequence[Opening]] | None = None,
) -> Shell:
    """Walls "back" (y = back_m), "left" and "right" (x = +-half_width_m), floor to y = front_m."""
    openings = openings or {}
    material = _floor_material(f"{name}_floor", floor, floor_colour, second_colour, rng)
    ground = mesh.from_pydata(
        f"{name}_floor",
        [(x, y, 0.0) for x, y in _ring(half_width_m, front_m, back_m)],
        [(0, 1, 2, 3)],
        smooth=False,
    )
    parts = Parts(name)
    parts.add(ground, material)
    trim = principled(f"{name}_trim", trim_colour, roughness=0.45, variation=0.06)
    layers = _layers(name, wall, wall_colour, second_colour, trim_colour, height_m, rng)
    for side, heading, at, span, sign in (
        ("back", 0.0, (0.0, back_m), (-half_width_m, half_width_m), 1.0),
        ("left", 90.0, (-half_width_m, 0.0), (front_m, back_m), 1.0),
        ("right", -90.0, (half_width_m, 0.0), (front_m, back_m), -1.0),
    ):
        frame = placing.pose(at, heading)
        along = _between(sign * span[0], sign * span[1])
        holes = [(*_between(sign * a, sign * b), low, high) for a, b, low, high in openings.get(side, ())]
        for k, (low, high, out, upright, paint) in enumerate(layers):
            sheet = mesh.set_material(_sheet(f"{name}_{side}_{k}", along, (low, high), holes, upright), paint)
            turn = Matrix.Identity(4) if upright else Matrix.Rotation(1.5707963, 4, "X")
            sheet.matrix_basis = frame @ Matrix.Translation((0.0, -out, 0.0)) @ turn
            parts.add(sheet)
        rails = [(0.016, 0.09, 0.0)] if wall not in ("two_tone", "panelled") else _RAILS
        parts += _trim(f"{name}_{side}", along, holes, rails, trim, frame)
        if wall == "panelled":
            parts += _battens(f"{name}_{side}", along, holes, layers[-1][-1], frame)
        parts += _reveals(f"{name}_{side}", holes, trim, frame)
    return Shell(parts)


_RAILS = [(0.018, 0.12, 0.0), (0.03, 0.04, DADO_M - 0.02)]
_Layer = tuple[float, float, float, bool, bpy.types.Material]


def _layers(
    name: str, wall: str, colour: Colour, second: Colour, trim: Colour, height: float, rng: random.Random
) -> list[_Layer]:
    """From, to in height; how far before the wall; whether its own axes are XZ (else XY); material."""
    if wall == "wallpaper":
        return [(0.0, height, 0.0, True, interior.wallpaper(f"{name}_paper", colour, second, rng))]
    if wall == "brick":
        return [(0.0, height, 0.0, True, gym.brickwork(f"{name}_bricks", colour, rng))]
    if wall == "boards":
        return [(0.0, height, 0.0, False, interior.floorboards(f"{name}_boards", colour, rng))]
    plaster = (0.0, height, 0.0, True, interior.plaster(f"{name}_plaster", colour, rng))
    if wall == "two_tone":
        return [plaster, (0.0, DADO_M, 0.004, True, products.lacquer(f"{name}_lower", second, rng))]
    if wall == "panelled":
        return [plaster, (0.0, DADO_M, 0.008, True, products.lacquer(f"{name}_panels", second, rng))]
    if wall == "tiled":
        return [plaster, (0.0, 1.5, 0.006, True, kitchen.wall_tiles(f"{name}_tiles", second, rng))]
    return [plaster]


def _floor_material(
    name: str, floor: str, colour: Colour, second: Colour, rng: random.Random
) -> bpy.types.Material:
    if floor == "tiles":
        return kitchen.floor_tiles(name, colour, rng, size_m=rng.choice((0.2, 0.3, 0.4)))
    if floor == "chequered":
        return waiting_room.linoleum(name, (colour, products.scaled(colour, 0.35)), rng)
    if floor == "carpet":
        return office_room.carpet_tiles(name, colour, rng)
    if floor == "rubber":
        return gym.rubber_floor(name, rng)
    if floor == "concrete":
        return principled(
            name, colour, roughness=0.55, variation=0.35, variation_scale=1.3, bump=(35, 0.0012)
        )
    return interior.floorboards(name, colour, rng)


def _ring(half_width: float, front: float, back: float) -> list[tuple[float, float]]:
    return [(-half_width, front), (half_width, front), (half_width, back), (-half_width, back)]


def _between(a: float, b: float) -> tuple[float, float]:
    """Two ends, the lower one first."""
    low, high = sorted((a, b))
    return low, high


def _sheet(
    name: str, along: tuple[float, float], tall: tuple[float, float], holes: Sequence[Opening], upright: bool
) -> bpy.types.Object:
    """A wall from `low` to `high` without its holes, in its own XZ plane (or XY, to be turned up)."""
    us = sorted({*along, *(u for a, b, _, _ in holes for u in (a, b) if along[0] < u < along[1])})
    zs = sorted({*tall, *(z for _, _, a, b in holes for z in (a, b) if tall[0] < z < tall[1])})
    verts: list[tuple[float, float]] = []
    faces: list[tuple[int, ...]] = []
    for u0, u1 in zip(us, us[1:]):
        for z0, z1 in zip(zs, zs[1:]):
            u, z = 0.5 * (u0 + u1), 0.5 * (z0 + z1)
            if any(a < u < b and low < z < high for a, b, low, high in holes):
                continue
            faces.append(tuple(range(len(verts), len(verts) + 4)))
            verts += [(u0, z0), (u1, z0), (u1, z1), (u0, z1)]
    points = [(u, 0.0, z) if upright else (u, z, 0.0) for u, z in verts]
    return mesh.from_pydata(name, points, faces, smooth=False)


def _trim(
    name: str,
    along: Sequence[float],
    holes: Sequence[Opening],
    rails: Sequence[tuple[float, float, float]],
    paint: bpy.types.Material,
    frame: Matrix,
) -> list[bpy.types.Object]:
    """Skirting and rails, interrupted where the wall is."""
    made = []
    for k, (out, tall, z) in enumerate(rails):
        cuts = sorted((a, b) for a, b, low, high in holes if low < z + tall and high > z)
        start = along[0]
        for a, b in [*cuts, (along[1], along[1])]:
            if a - start > 0.02:
                bar = mesh.bevel_box(f"{name}_rail_{k}", (a - start, out, tall), 0.004, 1)
                placed(bar, paint, x=0.5 * (a + start), y=-0.5 * out, z=z)
                bar.matrix_basis = frame
                made.append(bar)
            start = max(start, b)
    return made


def _battens(
    name: str, along: Sequence[float], holes: Sequence[Opening], paint: bpy.types.Material, frame: Matrix
) -> list[bpy.types.Object]:
    """Upright laths that divide panelling into fields."""
    count = max(1, round((along[1] - along[0]) / 0.42))
    laths = Parts(f"{name}_laths")
    for k in range(count + 1):
        u = along[0] + (along[1] - along[0]) * k / count
        if not any(a - 0.05 < u < b + 0.05 and low < DADO_M for a, b, low, _ in holes):
            laths.add(mesh.bevel_box("lath", (0.07, 0.022, DADO_M), 0.004, 1), x=u, y=-0.011)
    made = mesh.set_material(laths.join(), paint)
    made.matrix_basis = frame
    return [made]


def _reveals(
    name: str, holes: Sequence[Opening], paint: bpy.types.Material, frame: Matrix
) -> list[bpy.types.Object]:
    """The thickness of the wall round each opening."""
    made = []
    for k, (a, b, low, high) in enumerate(holes):
        ring = [(a, low), (b, low), (b, high), (a, high)]
        verts = [(u, y, z) for y in (0.0, 0.14) for u, z in ring]
        faces = [(i, (i + 1) % 4, 4 + (i + 1) % 4, 4 + i) for i in range(4)]
        tube = mesh.set_material(mesh.from_pydata(f"{name}_reveal_{k}", verts, faces, smooth=False), paint)
        tube.matrix_basis = frame
        made.append(tube)
    return made
