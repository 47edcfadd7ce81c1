"""What is poured: the level of a drink in a vessel that rises, and the stream that falls into it.

Owns the two moving surfaces and their keys. Knows vessels by the profile of their inner wall only; who pours
decides when.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt

import bpy
import numpy as np
from mathutils import Matrix, Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.scene import keys
from l4d_blender.scene.colour import Colour
from l4d_blender.scene.timeline import FPS, FRAME_COUNT

GRAVITY = 9.81
STREAM_M = 0.0064  # half width where it is thinnest
_HIDDEN = Matrix.Scale(1e-3, 4)


def surface(name: str, colour: Colour) -> bpy.types.Object:
    """A disc of liquid with a radius of one metre, to be scaled to its vessel by `key_level`."""
    disc = mesh.lathe(name, [(0.0, 0.0), (0.5, 0.0), (0.93, 0.0), (1.0, 0.0006)], 44)
    return mesh.set_material(disc, products.liquid(f"{name}_liquid", colour))


def key_level(
    disc: bpy.types.Object,
    vessel: Sequence[Matrix],
    inner: Sequence[tuple[float, float]],
    levels: Sequence[float],
) -> None:
    """Keys a disc in a vessel: its height over the vessel's foot per frame, as wide as the wall is there.

    `inner` is the inner wall as (radius, height) from the bottom upwards.
    """
    heights, radii = [z for _, z in inner], [r for r, _ in inner]
    matrices = []
    for frame in range(FRAME_COUNT):
        r = float(np.interp(levels[frame], heights, radii)) + 0.0004
        matrices.append(
            vessel[frame] @ Matrix.Translation((0, 0, levels[frame])) @ Matrix.Diagonal((r, r, 1, 1))
        )
    keys.key_matrices(disc, matrices)


def rising(first: int, last: int, low_m: float, high_m: float) -> list[float]:
    """A level per frame that rises evenly from `first` to `last`."""
    share = [min(max((f - first) / (last - first), 0.0), 1.0) for f in range(FRAME_COUNT)]
    return [low_m + (high_m - low_m) * t for t in share]


def stream(
    name: str,
    colour: Colour,
    tip: Vector,
    toward: Vector,
    surface_z: Sequence[float],
    frames: tuple[int, int],
) -> bpy.types.Object:
    """Tea that falls from `tip` (leaving it along `toward`, metres per second) onto a rising surface.

    It lasts from the first to the last of `frames`: its head falls in, its tail follows; out of these frames
    it hides, shrunk to nothing, under the surface.
    """
    first, last = frames
    drop = tip.z - min(surface_z)
    fall = (toward.z + sqrt(toward.z**2 + 2.0 * GRAVITY * drop)) / GRAVITY
    times = [fall * k / 26 for k in range(27)]
    line = [Vector((toward.x * t, toward.y * t, toward.z * t - 0.5 * GRAVITY * t * t)) for t in times]
    sizes = [STREAM_M * (1.12 - 0.16 * t / fall + 0.02 * (k % 3)) for k, t in enumerate(times)]
    obj = mesh.set_material(mesh.tube(name, line, sizes, 14), products.liquid(f"{name}_tea", colour))
    falling = fall * FPS
    landing = Vector((tip.x + line[-1].x, tip.y + line[-1].y, 0.0))
    matrices = []
    for frame in range(FRAME_COUNT):
        head = min(max((frame - first + 1) / falling, 0.0), 1.0) ** 2
        tail = min(max((frame - last) / falling, 0.0), 1.0) ** 2
        under = landing + Vector((0, 0, surface_z[frame] - 0.012))
        if head <= 0.0 or tail >= 0.98:
            matrices.append(Matrix.Translation(under) @ _HIDDEN)
            continue
        reach = (tip.z - surface_z[frame] + 0.004) / drop
        start = tip + _at(line, tail)
        span = max(min(head, 1.0) * reach - tail, 0.02)
        matrices.append(Matrix.Translation(start) @ Matrix.Diagonal((1.0 - tail, 1.0 - tail, span, 1.0)))
    keys.key_matrices(obj, matrices)
    return obj


def landing_point(tip: Vector, toward: Vector, surface_z: float) -> Vector:
    """Where a stream from `tip` meets a level."""
    fall = (toward.z + sqrt(toward.z**2 + 2.0 * GRAVITY * (tip.z - surface_z))) / GRAVITY
    return Vector((tip.x + toward.x * fall, tip.y + toward.y * fall, surface_z))


def _at(line: Sequence[Vector], share: float) -> Vector:
    """The point of a falling line at a share of its depth."""
    depth = share * line[-1].z
    for a, b in zip(line, line[1:]):
        if b.z <= depth <= a.z:
            return a.lerp(b, (a.z - depth) / max(a.z - b.z, 1e-9))
    return line[-1] if depth < line[-1].z else line[0]
