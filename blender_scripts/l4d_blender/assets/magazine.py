"""A magazine that lies open in V, with loose leaves that turn about its spine; and closed ones in a pile.

Owns the paper; knows nothing of hands. The spread lies in XY round the spine (the Y axis), the top of the
page at +Y, the reader above it at +Z.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from math import cos, radians, sin

import bpy
from mathutils import Matrix, Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.lettering import lettering
from l4d_blender.assets.materials import products
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.colour import Colour

PAGE_M = (0.212, 0.285)
SLOPE_RAD = radians(14.0)  # each half rises this much away from the spine
PICTURES: tuple[Colour, ...] = (
    (0.10, 0.30, 0.42),
    (0.55, 0.25, 0.07),
    (0.14, 0.28, 0.10),
    (0.48, 0.09, 0.12),
    (0.62, 0.45, 0.14),
)


@dataclass(frozen=True)
class Magazine:
    """The open body and its turning leaves; a leaf lies on the right half at an angle of 0 (radians)."""

    body: bpy.types.Object
    leaves: list[bpy.types.Object]

    @property
    def parts(self) -> list[bpy.types.Object]:
        """The body and its leaves."""
        return [self.body, *self.leaves]

    def place(self, matrix: Matrix) -> None:
        """Lays the magazine somewhere, all leaves on the right half."""
        self.body.matrix_basis = matrix
        for leaf in self.leaves:
            leaf.matrix_basis = matrix @ self.leaf_matrix(0.0)

    def leaf_matrix(self, angle_rad: float) -> Matrix:
        """Where a leaf is in the body's space."""
        return Matrix.Rotation(-SLOPE_RAD - angle_rad, 4, "Y") @ Matrix.Translation((0.0, 0.0, 0.0012))


def leaf_edge(angle_rad: float, up_m: float = 0.0, inset_m: float = 0.0) -> Vector:
    """A point of the outer edge of a leaf (or of a half: 0 right, `LEFT_RAD` left), in the body's space."""
    reach = PAGE_M[0] - inset_m
    a = SLOPE_RAD + angle_rad
    return Vector((reach * cos(a), up_m, reach * sin(a)))


LEFT_RAD = radians(180.0) - 2 * SLOPE_RAD


@kind("magazine", (0.418, 0.285, 0.054), "graspable", "opens", front="-y")
def magazine(name: str, rng: random.Random, *, leaves: int = 2) -> Magazine:
    """An open magazine with so many leaves that can be turned over, from the right to the left."""
    paper = products.paper(f"{name}_paper", (0.72, 0.71, 0.68), rng)
    parts = []
    for side in (1, -1):
        half = mesh.bevel_box(f"{name}_half", (PAGE_M[0], PAGE_M[1], 0.0035), 0.0008, segments=1)
        mesh.move(half, x=0.5 * PAGE_M[0], y=-0.0, z=-0.0035)
        printed = [mesh.set_material(half, paper), *_print(f"{name}_print", rng, 0.0002)]
        tilt = Matrix.Rotation(-SLOPE_RAD if side > 0 else SLOPE_RAD, 4, "Y")
        for part in printed:
            if side < 0:
                mesh.move(part, x=-PAGE_M[0])
            mesh.transform(part, tilt)
        parts += printed
    body = mesh.join(f"{name}_body", parts)
    return Magazine(body, [_leaf(f"{name}_leaf{k}", rng, paper) for k in range(leaves)])


@kind("magazines", (0.305, 0.345, 0.026), "surface")
def pile(name: str, rng: random.Random, *, count: int = 4) -> bpy.types.Object:
    """Closed magazines on top of each other, untidy, the uppermost with a title."""
    parts, z = [], 0.0
    for k in range(count):
        colour = rng.choice(PICTURES)
        cover = products.paper(f"{name}_cover{k}", colour, rng)
        sheet = mesh.bevel_box(f"{name}_{k}", (PAGE_M[0], PAGE_M[1], 0.006), 0.001, segments=1)
        mesh.set_material(sheet, cover)
        picture = mesh.box(f"{name}_picture", (0.17, 0.15, 0.0004))
        tone = products.paper(f"{name}_picture{k}", rng.choice(PICTURES), rng)
        mesh.set_material(mesh.move(picture, y=-0.03, z=0.006), tone)
        title = mesh.move(
            lettering(f"{name}_title", rng.choice(("TRAVEL", "GARDEN", "NEWS")), 0.034), y=0.105, z=0.0064
        )
        mesh.set_material(title, products.paper(f"{name}_ink{k}", (0.80, 0.78, 0.72), rng))
        turn = Matrix.Rotation(rng.uniform(-0.4, 0.4), 4, "Z")
        place = Matrix.Translation((rng.uniform(-0.015, 0.015), rng.uniform(-0.015, 0.015), z))
        parts += [mesh.transform(part, place @ turn) for part in (sheet, picture, title)]
        z += 0.0066
    return mesh.join(name, parts)


def _leaf(name: str, rng: random.Random, paper: bpy.types.Material) -> bpy.types.Object:
    """A thin sheet, printed on both faces, a little arched so that it reads as paper."""
    width, height = PAGE_M
    sheet = mesh.grid(name, width, height, 10, 2, lambda x, _: 0.010 * (1.0 - (2 * x / width) ** 2))
    mesh.set_material(mesh.solidify(mesh.move(sheet, x=0.5 * width), 0.0008, offset=0.0), paper)
    front = _print(f"{name}_front", rng, 0.0013, arch_m=0.010)
    back = _print(f"{name}_back", rng, 0.0)
    for part in back:
        mesh.rotate(part, "Y", 180.0)
        mesh.move(part, x=width)
        mesh.displace(part, lambda at, _: Vector((0, 0, 0.010 * (1 - (2 * at.x / width - 1) ** 2) - 0.0010)))
    return mesh.join(name, [sheet, *front, *back])


def _print(name: str, rng: random.Random, z: float, arch_m: float = 0.0) -> list[bpy.types.Object]:
    """A picture and two columns of text on a right-hand page whose spine is at x = 0."""
    width, height = PAGE_M
    top = rng.uniform(0.02, 0.06)
    blocks = {"picture": [(0.018, top, width - 0.016, 0.5 * height - 0.016)], "text": []}
    for left in (0.018, 0.112):
        y = top - 0.014
        while y > -0.5 * height + 0.016:
            blocks["text"].append((left, y - 0.0030, left + rng.uniform(0.062, 0.084), y))
            y -= 0.0078
    made = []
    for key, rectangles in blocks.items():
        verts: list[tuple[float, float, float]] = []
        faces: list[tuple[int, ...]] = []
        for x0, y0, x1, y1 in rectangles:
            cells = 4
            first = len(verts)
            for i in range(cells + 1):
                x = x0 + (x1 - x0) * i / cells
                lift = z + arch_m * (1.0 - (2 * x / width - 1) ** 2)
                verts += [(x, y0, lift), (x, y1, lift)]
            faces += [
                (first + 2 * i, first + 2 * i + 2, first + 2 * i + 3, first + 2 * i + 1) for i in range(cells)
            ]
        sheet = mesh.from_pydata(f"{name}_{key}", verts, faces, smooth=False)
        colour = rng.choice(PICTURES) if key == "picture" else (0.10, 0.10, 0.11)
        made.append(mesh.set_material(sheet, products.paper(f"{name}_{key}", colour, rng)))
    return made
