"""A small barn: weathered boards on a stone footing, a doorway with one leaf open on a dark inside, tiled
roof.

Front is -Y, origin at the middle of the footing's base. Scenery or a landmark; nothing in it moves.
"""

from __future__ import annotations

import math
import random

import bpy
from mathutils import Matrix, Vector, noise

from l4d_blender.scene.catalogue import kind

from ..scene.colour import rgb
from . import haystack, mesh
from .materials import outdoors
from .parts import placed

WIDTH_M, DEPTH_M = 6.0, 5.0
EAVES_M, RIDGE_M = 2.7, 4.5
FOOTING_M = 0.45
DOOR_WIDTH_M, DOOR_HEIGHT_M = 1.9, 2.25
_BOARD_M = 0.026


def _board(
    name: str, left: float, right: float, bottom: float, top_left: float, top_right: float, y: float
) -> bpy.types.Object:
    """An upright board in the XZ plane whose top may be cut obliquely; its face is at -Y."""
    front, back = y - _BOARD_M, y
    verts = [
        (left, front, bottom),
        (right, front, bottom),
        (right, front, top_right),
        (left, front, top_left),
        (left, back, bottom),
        (right, back, bottom),
        (right, back, top_right),
        (left, back, top_left),
    ]
    faces = [(0, 1, 2, 3), (5, 4, 7, 6), (4, 0, 3, 7), (1, 5, 6, 2), (3, 2, 6, 7), (4, 5, 1, 0)]
    return mesh.from_pydata(name, verts, faces, smooth=False)


def _gable_height(x: float) -> float:
    return RIDGE_M - (RIDGE_M - EAVES_M) * abs(x) / (WIDTH_M / 2)


def _gable_wall(name: str, rng: random.Random, door: bool) -> list[bpy.types.Object]:
    """Boards across the front (or back), left out in the doorway and over the loft hatch."""
    boards = []
    x = -WIDTH_M / 2
    while x < WIDTH_M / 2 - 0.02:
        width = min(rng.uniform(0.15, 0.24), WIDTH_M / 2 - x)
        if x < 0.0 < x + width:
            width = -x
        left, right = x + 0.004, x + width - 0.004
        middle = 0.5 * (left + right)
        bottom = FOOTING_M - 0.03 + rng.uniform(-0.02, 0.01)
        y = -DEPTH_M / 2 - rng.uniform(0.0, 0.008)
        if door and abs(middle) < DOOR_WIDTH_M / 2:
            bottom = DOOR_HEIGHT_M + 0.06
        boards.append(
            _board(f"{name}_board", left, right, bottom, _gable_height(left), _gable_height(right), y)
        )
        x += width
    return boards


def _side_wall(name: str, rng: random.Random) -> list[bpy.types.Object]:
    boards = []
    x = -DEPTH_M / 2
    while x < DEPTH_M / 2 - 0.02:
        width = min(rng.uniform(0.15, 0.24), DEPTH_M / 2 - x)
        y = -WIDTH_M / 2 - rng.uniform(0.0, 0.008)
        boards.append(
            _board(f"{name}_board", x + 0.004, x + width - 0.004, FOOTING_M - 0.04, EAVES_M, EAVES_M, y)
        )
        x += width
    return boards


def _footing(name: str, rng: random.Random) -> list[bpy.types.Object]:
    """A low wall of field stones under the boards, open at the door."""
    stones = []
    look = outdoors.field_stone(f"{name}_stone")
    runs = [
        (Vector((-WIDTH_M / 2, -DEPTH_M / 2, 0)), Vector((-DOOR_WIDTH_M / 2, -DEPTH_M / 2, 0))),
        (Vector((DOOR_WIDTH_M / 2, -DEPTH_M / 2, 0)), Vector((WIDTH_M / 2, -DEPTH_M / 2, 0))),
        (Vector((-WIDTH_M / 2, DEPTH_M / 2, 0)), Vector((-WIDTH_M / 2, -DEPTH_M / 2, 0))),
        (Vector((WIDTH_M / 2, -DEPTH_M / 2, 0)), Vector((WIDTH_M / 2, DEPTH_M / 2, 0))),
    ]
    for start, end in runs:
        way = (end - start).normalized()
        turn = Matrix.Rotation(math.atan2(way.y, way.x), 4, "Z")
        for course in range(3):
            along = -0.1 * (course % 2)
            while along < (end - start).length:
                length = rng.uniform(0.24, 0.48)
                height = FOOTING_M / 2.7
                stone = mesh.bevel_box(
                    f"{name}_stone", (length * 0.97, 0.24, height * rng.uniform(0.9, 1.0)), 0.03, 2
                )
                shift = Vector([rng.uniform(-9, 9) for _ in range(3)])

                def uneven(p: Vector, _: Vector, shift: Vector = shift) -> float:
                    return 0.016 * noise.noise(p * 7.0 + shift)

                mesh.displace(stone, uneven)
                at = start + way * min(along + length / 2, (end - start).length - length / 3)
                mesh.transform(stone, Matrix.Translation(at + Vector((0, 0, height * course - 0.06))) @ turn)
                mesh.set_material(stone, look)
                stones.append(stone)
                along += length
    return stones


def _door_leaf(name: str, rng: random.Random, opening: float) -> list[bpy.types.Object]:
    """A leaf of boards with a Z of battens, hinged at its own x = 0 and swung out by `opening` radians."""
    width, height = DOOR_WIDTH_M / 2, DOOR_HEIGHT_M - 0.05
    parts, x = [], 0.0
    while x < width - 0.02:
        board = min(rng.uniform(0.13, 0.19), width - x)
        parts.append(_board(f"{name}_leaf", x + 0.003, x + board - 0.003, 0.06, height, height, 0.0))
        x += board
    for z in (0.35, height - 0.35):
        batten = mesh.bevel_box(f"{name}_batten", (width - 0.08, 0.03, 0.13), 0.006, 1)
        mesh.transform(batten, Matrix.Translation((width / 2, -_BOARD_M - 0.015, z - 0.065)))
        parts.append(batten)
    rise, run = height - 0.83, width - 0.16
    brace = mesh.bevel_box(f"{name}_brace", (math.hypot(rise, run), 0.028, 0.12), 0.006, 1)
    mesh.transform(
        brace,
        Matrix.Translation((width / 2, -_BOARD_M - 0.014, height / 2))
        @ Matrix.Rotation(-math.atan2(rise, run), 4, "Y")
        @ Matrix.Translation((0, 0, -0.06)),
    )
    parts.append(brace)
    for part in parts:
        mesh.transform(part, Matrix.Rotation(-opening, 4, "Z"))
    return parts


def _tiles(name: str, rng: random.Random) -> bpy.types.Object:
    """Two slopes of curved tiles in overlapping rows, and ridge tiles."""
    verts: list[Vector] = []
    faces: list[tuple[int, ...]] = []

    def tile(pose: Matrix, width: float, length: float, bow: float) -> None:
        first, steps = len(verts), 4
        for j in (0, 1):
            for k in range(steps + 1):
                angle = math.pi * k / steps
                at = Vector((-0.5 * width * math.cos(angle), -length * j, bow * math.sin(angle) + 0.012 * j))
                verts.append(pose @ at)
        for k in range(steps):
            faces.append((first + k, first + steps + 1 + k, first + steps + 2 + k, first + k + 1))

    overhang_x, overhang_y = 0.35, 0.40
    half = WIDTH_M / 2 + overhang_x
    slope = math.atan2(RIDGE_M - EAVES_M, WIDTH_M / 2)
    run = half / math.cos(slope)
    rows, columns = 14, 34
    span = DEPTH_M + 2 * overhang_y
    sag = [rng.uniform(0.0, 0.05) for _ in range(3)]
    for side in (-1.0, 1.0):
        turn = Matrix.Rotation(side * math.pi / 2, 4, "Z") @ Matrix.Rotation(slope, 4, "X")
        for row in range(rows):
            for column in range(columns):
                along = span * ((column + 0.5) / columns - 0.5)
                down = run * row / rows
                drop = sum(
                    a * math.sin(math.pi * (k + 1) * (column + 0.5) / columns) for k, a in enumerate(sag)
                )
                pose = (
                    Matrix.Translation((0, 0, RIDGE_M + 0.05 - drop * (1 - row / rows)))
                    @ turn
                    @ Matrix.Translation((along, -down, rng.uniform(0.0, 0.008)))
                    @ Matrix.Rotation(rng.gauss(0.0, 0.02), 4, "Z")
                )
                tile(pose, span / columns * 1.04, run / rows * 1.18, 0.055)
    for column in range(24):
        along = span * (column / 24 - 0.5) + span / 24
        pose = Matrix.Translation((0, along, RIDGE_M + 0.06))
        tile(pose, 0.26, span / 24 * 1.12, 0.10)
    roof = mesh.from_pydata(name, verts, faces, smooth=True)
    mesh.set_material(roof, outdoors.clay_tiles(f"{name}_tiles"))
    return roof


def _inside(name: str) -> bpy.types.Object:
    """The walls seen through the doorway: dark boards round a shallow room."""
    half, deep, high = WIDTH_M / 2 - 0.1, DEPTH_M / 2 - 0.1, EAVES_M
    front = -DEPTH_M / 2 + 0.02
    corners = [(-half, front), (half, front), (half, deep), (-half, deep)]
    verts = [(x, y, z) for z in (0.02, high) for x, y in corners]
    faces = [(0, 1, 2, 3), (7, 6, 5, 4), (2, 6, 7, 3), (1, 5, 6, 2), (3, 7, 4, 0)]
    room = mesh.from_pydata(name, verts, faces, smooth=False)
    mesh.set_material(room, outdoors.weathered_wood(f"{name}_dark", (0.060, 0.045, 0.032)))
    return room


@kind("barn", (6.86, 6.19, 4.74), front="-y")
def barn(
    name: str, rng: random.Random, *, tone: tuple[float, float, float] = (0.155, 0.098, 0.066)
) -> bpy.types.Object:
    """6 m wide, 5 m deep, 4.5 m to the ridge; the roof's ridge runs from front to back."""
    boards = outdoors.weathered_wood(f"{name}_boards", tone)
    trim = outdoors.weathered_wood(f"{name}_trim", rgb(1.35 * c for c in tone))
    timber = outdoors.weathered_wood(f"{name}_timber", (0.17, 0.125, 0.09), grain_axis="X")
    plain = _gable_wall(name, rng, door=True)
    for turn, wall in (
        (math.pi, _gable_wall(name, rng, door=False)),
        (math.pi / 2, _side_wall(name, rng)),
        (-math.pi / 2, _side_wall(name, rng)),
    ):
        for board in wall:
            mesh.transform(board, Matrix.Rotation(turn, 4, "Z"))
        plain += wall
    for hinge, mirror, opening in ((-DOOR_WIDTH_M / 2, 1.0, 2.25), (DOOR_WIDTH_M / 2, -1.0, 0.35)):
        for part in _door_leaf(name, rng, opening):
            place = Matrix.Translation((hinge, -DEPTH_M / 2 - 0.03, 0)) @ Matrix.Diagonal((mirror, 1, 1, 1))
            plain.append(mesh.transform(part, place))
    for part in plain:
        mesh.set_material(part, boards)

    front = -DEPTH_M / 2 - 0.035
    frames = []
    for x in (-DOOR_WIDTH_M / 2 - 0.06, DOOR_WIDTH_M / 2 + 0.06, -WIDTH_M / 2 + 0.06, WIDTH_M / 2 - 0.06):
        high = DOOR_HEIGHT_M + 0.1 if abs(x) < 2 else EAVES_M - 0.02
        post = mesh.bevel_box(f"{name}_post", (0.13, 0.07, high), 0.01, 1)
        placed(post, trim, x=x, y=front)
        frames.append(post)
    for width, z, high in (
        (DOOR_WIDTH_M + 0.4, DOOR_HEIGHT_M + 0.02, 0.15),
        (WIDTH_M - 0.1, EAVES_M - 0.05, 0.14),
    ):
        lintel = mesh.bevel_box(f"{name}_lintel", (width, 0.08, high), 0.012, 1)
        placed(lintel, timber, y=front - 0.005, z=z)
        frames.append(lintel)
    hatch = mesh.bevel_box(f"{name}_hatch", (0.85, 0.05, 0.85), 0.01, 1)
    placed(hatch, outdoors.weathered_wood(f"{name}_hatch", (0.055, 0.042, 0.032)), y=front, z=3.0)
    hay = haystack.haystack(f"{name}_hay", rng, radius_m=1.1, height_m=1.3, stalks=500)
    mesh.transform(hay, Matrix.Translation((0.5, -0.8, 0.0)))
    return mesh.join(
        name,
        [
            *plain,
            *frames,
            hatch,
            *_footing(name, rng),
            _tiles(f"{name}_roof", rng),
            _inside(f"{name}_inside"),
            hay,
        ],
    )
