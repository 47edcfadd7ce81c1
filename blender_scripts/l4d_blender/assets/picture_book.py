"""A children's book that lies open: a hill, a house and a sun on its pages, lines of large print below.

Owns the open book; knows nothing of the one that closes (book.py). It lies on z = 0 and is read from -Y.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from math import cos, pi, sin

import bmesh
import bpy
from mathutils import Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.lettering import lettering
from l4d_blender.assets.materials import products
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import colours, kind
from l4d_blender.scene.colour import Colour

SIZE_M = (0.30, 0.20)
_COVER_M = 0.003
_PRINT_M = 0.0003


@kind("picture_book", (0.308, 0.208, 0.015), "surface", "graspable", colour=colours("cover"))
def picture_book(
    name: str,
    rng: random.Random,
    *,
    cover: Colour = (0.35, 0.09, 0.05),
    sky: Colour = (0.36, 0.52, 0.6),
    words: tuple[str, str] = ("The little house", "on the green hill"),
) -> bpy.types.Object:
    """An open spread 30 cm wide with pages that rise towards the spine."""
    width, depth = SIZE_M
    board = mesh.bevel_box(f"{name}_boards", (width + 0.008, depth + 0.008, _COVER_M), 0.001)
    pages = mesh.grid(f"{name}_pages", width, depth, 48, 4, lambda x, _: _page_z(x))
    mesh.solidify(pages, 0.004)
    parts = Parts(name)
    parts.add(board, products.book_cloth(f"{name}_cloth", cover, rng))
    parts.add(pages, products.paper(f"{name}_paper", (0.78, 0.74, 0.64), rng))

    def printed(label: str, outline: Sequence[tuple[float, float]], colour: Colour, level: int) -> None:
        parts.add(_patch(f"{name}_{label}", outline, level), products.paper(f"{name}_{label}", colour, rng))

    left, right, low, high = -0.140, -0.012, -0.045, 0.088
    printed("sky", ((left, low), (right, low), (right, high), (left, high)), sky, 1)
    hill = [(left + (right - left) * k / 12, low + 0.030 + 0.030 * sin(pi * k / 12)) for k in range(13)]
    printed("hill", ((left, low), (right, low), *reversed(hill)), (0.16, 0.33, 0.08), 2)
    printed(
        "wall", ((-0.096, 0.000), (-0.060, 0.000), (-0.060, 0.030), (-0.096, 0.030)), (0.72, 0.62, 0.42), 3
    )
    printed("roof", ((-0.102, 0.030), (-0.054, 0.030), (-0.078, 0.053)), (0.50, 0.07, 0.04), 3)
    printed(
        "door", ((-0.082, 0.000), (-0.073, 0.000), (-0.073, 0.018), (-0.082, 0.018)), (0.16, 0.08, 0.04), 4
    )
    printed("sun", _disc(-0.033, 0.068, 0.012), (0.80, 0.52, 0.05), 3)
    printed("pond", _disc(0.085, 0.046, 0.034), (0.14, 0.32, 0.50), 2)
    printed("duck", _disc(0.085, 0.050, 0.013), (0.80, 0.55, 0.06), 3)
    printed("beak", _disc(0.101, 0.056, 0.006), (0.70, 0.22, 0.03), 4)

    ink = products.paper(f"{name}_ink", (0.03, 0.03, 0.035), rng)
    for row, line in enumerate((*words, "stands all alone,", "but not for long.")):
        text = lettering(f"{name}_line", line, 0.0062, bold_m=0.0001)
        x = -0.076 if row < 2 else 0.078
        mesh.move(text, x, -0.060 - 0.015 * (row % 2) + (0.05 if row >= 2 else 0.0))
        mesh.displace(text, lambda at, _: Vector((0.0, 0.0, _page_z(at.x) + 2 * _PRINT_M - at.z)))
        parts.add(text, ink)
    return parts.join()


def _page_z(x: float) -> float:
    """Height of the open pages: high beside the gutter, low at the gutter itself and at the outer edges."""
    t = abs(x) / (0.5 * SIZE_M[0])
    return _COVER_M + 0.005 + 0.007 * (1.0 - t) ** 1.5 * min(1.0, t / 0.09)


def _disc(x: float, y: float, radius: float) -> list[tuple[float, float]]:
    return [(x + radius * cos(2 * pi * k / 20), y + 0.85 * radius * sin(2 * pi * k / 20)) for k in range(20)]


def _patch(name: str, outline: Sequence[tuple[float, float]], level: int) -> bpy.types.Object:
    """A convex printed area that follows the page, cut into strips so that it bends with it."""
    sheet = mesh.from_pydata(
        name, [(x, y, 0.0) for x, y in outline], [tuple(range(len(outline)))], smooth=False
    )
    sheet = _sliced(sheet)
    return mesh.displace(sheet, lambda at, _: Vector((0.0, 0.0, _page_z(at.x) + level * _PRINT_M - at.z)))


def _sliced(sheet: bpy.types.Object) -> bpy.types.Object:
    """Cuts a flat outline every few millimetres across X."""
    bm = bmesh.new()
    bm.from_mesh(sheet.data)
    low = min(v.co.x for v in bm.verts)
    high = max(v.co.x for v in bm.verts)
    x = low + 0.006
    while x < high:
        bmesh.ops.bisect_plane(
            bm, geom=[*bm.verts, *bm.edges, *bm.faces], plane_co=(x, 0, 0), plane_no=(1, 0, 0)
        )
        x += 0.006
    bm.to_mesh(sheet.data)
    bm.free()
    return sheet
