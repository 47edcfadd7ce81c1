"""A plain family house for a background: plaster or brick walls, a gabled tile roof, windows, a door.

Front = -Y; the origin lies on the ground in the middle. Scenery for distances of ten metres and more.
"""

from __future__ import annotations

import math
import random

import bpy
from mathutils import Matrix, Vector

from l4d_blender.scene.catalogue import kind

from ..scene.colour import Colour
from . import mesh
from .materials import outdoors
from .materials.base import Nodes, principled
from .parts import Parts, placed

WALL_COLOURS: tuple[Colour, ...] = (
    (0.62, 0.55, 0.43),
    (0.60, 0.47, 0.35),
    (0.50, 0.52, 0.50),
    (0.64, 0.60, 0.53),
    (0.42, 0.22, 0.15),
)


@kind("house", (9.72, 8.08, 8.64), "backdrop", front="-y")
def house(
    name: str, rng: random.Random, *, size_xy: tuple[float, float] = (9.0, 7.0), eaves_m: float = 4.6
) -> bpy.types.Object:
    """A house of two storeys with its ridge along X."""
    sx, sy = size_xy
    ridge = eaves_m + 0.42 * sy
    wall = _render(f"{name}_wall", rng.choice(WALL_COLOURS))
    frame = principled(f"{name}_frame", (0.70, 0.69, 0.65), roughness=0.5)
    pane = _pane(f"{name}_pane")
    wood = principled(
        f"{name}_door",
        rng.choice([(0.10, 0.16, 0.12), (0.16, 0.06, 0.03), (0.07, 0.09, 0.16)]),
        roughness=0.5,
    )
    parts = [_walls(f"{name}_walls", sx, sy, eaves_m, ridge, wall), *_roof(name, rng, sx, sy, eaves_m, ridge)]
    columns = max(2, round(sx / 2.6))
    door = rng.randrange(columns)
    for face, width, depth in (("front", sx, sy), ("side", sy, sx)):
        count = columns if face == "front" else max(2, round(sy / 3.0))
        for k in range(count):
            for storey, z in enumerate((0.95, 3.25 * eaves_m / 4.6)):
                u = width * ((k + 0.5) / count - 0.5)
                if face == "front" and storey == 0 and k == door:
                    pieces = [(wood, (0.98, 0.10, 2.05), 0.05, 0.02), (frame, (1.16, 0.06, 2.18), 0.05, 0.0)]
                else:
                    pieces = [
                        (frame, (1.16, 0.10, 1.36), z, 0.0),
                        *_panes(pane, z),
                        (frame, (1.34, 0.22, 0.07), z - 0.07, 0.02),
                    ]
                for s in (-1, 1):
                    parts += [_set_in(f"{name}_hole", piece, u, depth, face, s) for piece in pieces]
    stack = mesh.bevel_box(f"{name}_chimney", (0.6, 0.6, 1.5), 0.02, 1)
    mesh.move(stack, sx * rng.uniform(-0.3, 0.3), 0.5, ridge - 0.8)
    parts.append(mesh.set_material(stack, principled(f"{name}_brick", (0.26, 0.10, 0.06), variation=0.4)))
    return mesh.join(name, parts)


def _panes(pane: bpy.types.Material, z: float) -> list[tuple]:
    """Two casements of two panes each, in front of the frame."""
    made = []
    for x in (-0.26, 0.26):
        made += [
            (pane, (0.44, 0.02, 0.74), z + 0.50, 0.055, x),
            (pane, (0.44, 0.02, 0.36), z + 0.08, 0.055, x),
        ]
    return made


def _set_in(name: str, piece: tuple, u: float, depth: float, face: str, side: int) -> bpy.types.Object:
    material, size, z, out, *shift = piece
    part = mesh.box(name, size)
    mesh.move(part, x=u + (shift[0] if shift else 0.0), y=-depth / 2 - out, z=z)
    turn = (0.0 if side < 0 else math.pi) + (math.pi / 2 if face == "side" else 0.0)
    return placed(part, material, within=Matrix.Rotation(turn, 4, "Z"))


def _walls(name: str, sx: float, sy: float, eaves: float, ridge: float, material: bpy.types.Material):
    x, y = sx / 2, sy / 2
    verts = [(-x, -y, -0.4), (x, -y, -0.4), (x, y, -0.4), (-x, y, -0.4), (-x, -y, eaves), (x, -y, eaves)]
    verts += [(x, y, eaves), (-x, y, eaves), (-x, 0.0, ridge), (x, 0.0, ridge)]
    faces = [(0, 1, 5, 4), (2, 3, 7, 6), (1, 2, 6, 9, 5), (3, 0, 4, 8, 7)]
    return mesh.set_material(mesh.from_pydata(name, verts, faces, smooth=False), material)


def _roof(name: str, rng: random.Random, sx: float, sy: float, eaves: float, ridge: float) -> list:
    tiles = outdoors.clay_tiles(f"{name}_tiles")
    trim = principled(f"{name}_trim", (0.30, 0.28, 0.25), roughness=0.7)
    slope = math.atan2(ridge - eaves, sy / 2)
    long = (sy / 2 + 0.45) / math.cos(slope)
    rows, parts = 14, Parts(name)
    for s in (-1, 1):
        for k in range(rows):
            course = mesh.bevel_box(f"{name}_course", (sx + 0.7, long / rows * 1.25, 0.05), 0.012, 1)
            mesh.displace(course, lambda p, _: Vector((0.0, 0.0, 0.02 * math.sin(21.0 * p.x))))
            down = long * (k + 0.5) / rows
            mesh.transform(
                course,
                Matrix.Rotation(0.0 if s < 0 else math.pi, 4, "Z")
                @ Matrix.Translation((0.0, -down * math.cos(slope), ridge + 0.10 - down * math.sin(slope)))
                @ Matrix.Rotation(slope - 0.02, 4, "X"),
            )
            parts.add(course, tiles)
        gutter = [
            (-sx / 2 - 0.35, s * (sy / 2 + 0.47), eaves - 0.16),
            (sx / 2 + 0.35, s * (sy / 2 + 0.47), eaves - 0.16),
        ]
        parts.tube("gutter", trim, gutter, 0.07, 8)
    parts.tube("cap", tiles, [(-sx / 2 - 0.36, 0, ridge + 0.11), (sx / 2 + 0.36, 0, ridge + 0.11)], 0.13, 10)
    return parts


def _render(name: str, colour: Colour) -> bpy.types.Material:
    """Plaster that rain has streaked."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    streaks = n.noise(1.0, 4.0, vector=n.mapping(n.object_coords(), scale=(0.9, 0.9, 0.30)))
    dark = tuple(0.80 * c for c in colour)
    n.set("Base Color", n.ramp(streaks, [(0.30, dark), (0.62, colour)]))
    n.set("Roughness", 0.9)
    return material


def _pane(name: str) -> bpy.types.Material:
    """Opaque glass: dark rooms and a bit of sky."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    n.set("Base Color", n.ramp(n.noise(0.7, 2.0), [(0.4, (0.030, 0.038, 0.045)), (0.65, (0.16, 0.20, 0.24))]))
    n.set("Roughness", 0.12)
    return material
