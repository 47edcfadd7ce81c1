"""A small playground slide: a ladder, a railed platform and a steel chute that runs out near the ground.

Owns the shape and the line that something follows down the chute (`chute_line`). Front = -Y, where the chute
ends; the origin lies on the ground under the platform's middle.
"""

from __future__ import annotations

import math
import random

import bpy
from mathutils import Vector

from l4d_blender.scene.catalogue import kind

from . import mesh
from .materials import playground, products
from .parts import Parts

PLATFORM_M = 0.86
WIDTH_M = 0.44
TOP_Y_M = -0.26  # where the platform ends and the chute begins
END_Y_M = -1.95

_SIDE_M = 0.17


def height_at(y: float) -> float:
    """Height of the sliding surface over y (which falls from TOP_Y_M to END_Y_M)."""
    u = min(max((TOP_Y_M - y) / (TOP_Y_M - END_Y_M), 0.0), 1.0)
    # A smooth drop between two level ends.
    w = min(max((u - 0.02) / 0.90, 0.0), 1.0)
    fall = w * w * (3.0 - 2.0 * w)
    return PLATFORM_M + (0.062 - PLATFORM_M) * (0.35 * fall + 0.65 * _steady(w))


def _steady(w: float) -> float:
    """An almost even fall with short bends at both ends."""
    bend = 0.22
    if w < bend:
        return 0.5 * w * w / bend / (1.0 - bend)
    if w > 1.0 - bend:
        return 1.0 - 0.5 * (1.0 - w) ** 2 / bend / (1.0 - bend)
    return (w - 0.5 * bend) / (1.0 - bend)


def chute_line(radius_m: float, *, from_y_m: float = 0.0, points: int = 40) -> list[Vector]:
    """Centres of a ball that rests on the platform at `from_y_m` and follows the chute to its end."""
    line = []
    for k in range(points):
        y = from_y_m + (END_Y_M - from_y_m) * k / (points - 1)
        slope = (height_at(y - 0.01) - height_at(y + 0.01)) / 0.02
        normal = Vector((0.0, slope, 1.0)).normalized()
        line.append(Vector((0.0, y, height_at(y))) + radius_m * normal)
    return line


@kind("slide", (0.576, 2.59, 1.53), front="-y")
def slide(name: str, rng: random.Random, *, frame: str = "red", rails: str = "yellow") -> bpy.types.Object:
    """The whole slide as one object."""
    paint = products.lacquer(f"{name}_frame", playground.PAINTS[frame], rng)
    rail = products.lacquer(f"{name}_rail", playground.PAINTS[rails], rng)
    steel = products.metal(f"{name}_steel", (0.62, 0.63, 0.64), rng, roughness=0.34)
    board = products.satin_plastic(f"{name}_board", playground.PAINTS["light_blue"], rng)
    parts = Parts(name)
    parts += [_chute(f"{name}_chute", steel), *_lips(f"{name}_lip", rail)]

    parts.box("deck", paint, (WIDTH_M + 0.10, 0.56, 0.035), 0.008, y=0.02, z=PLATFORM_M - 0.037)
    half = WIDTH_M / 2 + 0.045
    for x in (-half, half):
        for y in (-0.24, 0.28):
            parts.add(_pipe(f"{name}_post", [(x, y, -0.05), (x, y, PLATFORM_M + 0.52)], 0.023, paint))
        hoop = [(x, -0.24, PLATFORM_M + 0.51), (x, -0.10, PLATFORM_M + 0.60), (x, 0.14, PLATFORM_M + 0.60)]
        parts.add(_pipe(f"{name}_hoop", [*hoop, (x, 0.28, PLATFORM_M + 0.51)], 0.023, rail))
        parts.box("panel", board, (0.022, 0.46, 0.30), 0.008, x=x, y=0.02, z=PLATFORM_M + 0.11)
        parts.add(
            _pipe(f"{name}_stile", [(x * 0.86, 0.28, PLATFORM_M), (x * 0.86, 0.62, -0.04)], 0.020, paint)
        )
        foot = [(x, -1.42, -0.05), (x, -1.42, height_at(-1.42) + 0.01)]
        parts.add(_pipe(f"{name}_foot", foot, 0.020, paint))
    for k in range(4):
        z = 0.15 + 0.185 * k
        y = 0.28 + 0.34 * (1.0 - z / PLATFORM_M)
        rung = [(-half * 0.86, y, z), (half * 0.86, y, z)]
        parts.add(_pipe(f"{name}_rung", rung, 0.016, rail))
    bar = [(-half, -0.24, PLATFORM_M + 0.50), (half, -0.24, PLATFORM_M + 0.50)]
    parts.add(_pipe(f"{name}_bar", bar, 0.020, rail))
    return parts.join()


def _pipe(name: str, line: list, radius: float, material: bpy.types.Material) -> bpy.types.Object:
    return mesh.set_material(mesh.tube(name, line, radius, 12), material)


def _stations(count: int = 44) -> list[float]:
    return [TOP_Y_M + (END_Y_M - TOP_Y_M) * k / (count - 1) for k in range(count)]


def _chute(name: str, material: bpy.types.Material) -> bpy.types.Object:
    """Bed and side walls: a folded sheet with a rounded trough."""
    half, sections = WIDTH_M / 2, []
    outline = [(-half, _SIDE_M), (-half, 0.05), (-half + 0.03, 0.008), (-half + 0.07, 0.0), (0.0, 0.0)]
    outline += [(half - 0.07, 0.0), (half - 0.03, 0.008), (half, 0.05), (half, _SIDE_M)]
    for y in _stations():
        z = height_at(y)
        lower = 1.0 - 0.45 * max(0.0, (y - END_Y_M) / -0.35 + 1.0) if y < END_Y_M + 0.35 else 1.0
        sections.append([(x, y, z + h * lower) for x, h in outline])
    count = len(outline)
    verts = [point for section in sections for point in section]
    faces = [
        (i * count + j, (i + 1) * count + j, (i + 1) * count + j + 1, i * count + j + 1)
        for i in range(len(sections) - 1)
        for j in range(count - 1)
    ]
    sheet = mesh.from_pydata(name, verts, faces)
    mesh.solidify(sheet, 0.012, offset=-1.0)
    mesh.shade_smooth(sheet, 40.0)
    return mesh.set_material(sheet, material)


def _lips(name: str, material: bpy.types.Material) -> list[bpy.types.Object]:
    """Round rails along the chute's side walls."""
    rails = Parts(name)
    for s in (-1, 1):
        line = []
        for y in _stations(20):
            lower = 1.0 - 0.45 * max(0.0, (y - END_Y_M) / -0.35 + 1.0) if y < END_Y_M + 0.35 else 1.0
            line.append((s * WIDTH_M / 2, y, height_at(y) + _SIDE_M * lower))
        rails.tube(f"{s}", material, line, 0.018, 10)
    assert math.isclose(line[0][2], PLATFORM_M + _SIDE_M, abs_tol=0.02)
    return rails
