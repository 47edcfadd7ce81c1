"""A woven rug with fringes on its short sides."""

from __future__ import annotations

import random
from collections.abc import Sequence

import bpy
from mathutils import Vector, noise

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior
from l4d_blender.scene.catalogue import Choice, kind

THICKNESS_M = 0.009
PALETTES: tuple[tuple[tuple[float, float, float], ...], ...] = (
    ((0.075, 0.12, 0.18), (0.40, 0.19, 0.08), (0.03, 0.03, 0.045), (0.56, 0.49, 0.36)),
    ((0.30, 0.065, 0.05), (0.06, 0.10, 0.19), (0.035, 0.03, 0.04), (0.56, 0.47, 0.33)),
    ((0.10, 0.19, 0.15), (0.50, 0.27, 0.09), (0.035, 0.035, 0.03), (0.66, 0.58, 0.42)),
)


@kind(
    "rug",
    (2.27, 1.5, 0.009),
    "surface",
    palette=Choice("palette", {str(k): palette for k, palette in enumerate(PALETTES)}),
)
def rug(
    name: str,
    rng: random.Random,
    *,
    size_m: tuple[float, float] = (2.15, 1.50),
    palette: Sequence[tuple[float, float, float]] = PALETTES[0],
) -> bpy.types.Object:
    """Lies on z = 0 and is `THICKNESS_M` thick; long side along X."""
    pile = interior.carpet(f"{name}_pile", size_m, palette, rng)
    threads = interior.wool(f"{name}_threads", (0.66, 0.58, 0.44), rng)
    phase = Vector((rng.uniform(0, 50), rng.uniform(0, 50), 0))

    def height(x: float, y: float) -> float:
        near_edge = min(size_m[0] / 2 - abs(x), size_m[1] / 2 - abs(y))
        return (THICKNESS_M - 0.001) * min(1.0, near_edge / 0.012 + 0.2) + 0.001 * noise.noise(
            Vector((9 * x, 9 * y, 0)) + phase
        )

    parts = [mesh.set_material(mesh.grid(f"{name}_sheet", *size_m, 72, 48, height), pile)]
    strands = int(size_m[1] / 0.022)
    for side in (-1, 1):
        for i in range(strands):
            y = -size_m[1] / 2 + (i + 0.5) * size_m[1] / strands
            x, slant = side * size_m[0] / 2, rng.uniform(-0.012, 0.012)
            line = [
                (x - side * 0.01, y, 0.006),
                (x + side * 0.025, y + slant * 0.4, 0.005),
                (x + side * rng.uniform(0.045, 0.060), y + slant, 0.003),
            ]
            parts.append(
                mesh.set_material(mesh.tube(f"{name}_fringe", line, [0.0042, 0.0035, 0.0024], 5), threads)
            )
    return mesh.join(name, parts)
