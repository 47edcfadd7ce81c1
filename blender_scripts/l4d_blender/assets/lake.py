"""A lake: its shore and far bank as terrain, the water's surface, wakes, and lily pads.

Owns `Shore` (heights and wear, for the meshes of assets/ground.py) and everything that lies on the water.
Knows nothing of docks, boats or birds. Water is opaque: depth and ids end at its surface.
"""

from __future__ import annotations

import math
import random
from collections.abc import Sequence
from dataclasses import dataclass

import bpy
from mathutils import Matrix, Vector

from l4d_blender.scene.catalogue import kind

from . import mesh
from .ground import Terrain
from .materials import lakeside


@dataclass(frozen=True)
class Shore(Terrain):
    """Land on the -X side of the lake and beyond it; `water_m` is the level of the surface."""

    water_m: float = -0.30
    shore_x_m: float = -2.1
    far_bank_m: float = 40.0

    def depth_into_lake(self, x: float, y: float) -> float:
        """Metres from the shoreline, above zero over water."""
        line = self.shore_x_m + 0.45 * self._noise(0.0, y, 0.35) - 0.02 * y * y / (1.0 + 0.05 * abs(y))
        bank = self.far_bank_m * (1.0 + 0.18 * self._noise(x, y, 0.03))
        return min(x - line, bank - math.hypot(x, y))

    def height(self, x: float, y: float) -> float:
        """Metres above the dock's deck."""
        depth = self.depth_into_lake(x, y)
        if depth > 0.0:
            return self.water_m - 0.22 * min(depth, 3.0)
        rise = 0.36 * (1.0 - math.exp(depth / 0.9)) + 0.05 * min(-depth, 12.0)
        bumps = 0.03 * self._noise(x, y, 1.7) * min(1.0, -depth)
        far = max(0.0, math.hypot(x, y) - self.far_bank_m) / 30.0
        return self.water_m + rise + bumps + self.hill_height_m * far * (0.6 + 0.7 * self._noise(x, y, 0.02))

    def wear(self, x: float, y: float) -> float:
        """Mud and sand along the water, grass behind."""
        back = -self.depth_into_lake(x, y)
        return min(1.0, max(0.0, (0.75 - back + 0.35 * self._noise(x, y, 1.3)) / 0.45))


CALM = Shore()


@kind("water", (190.0, 190.0, 0.0), "backdrop")
def water(name: str, rng: random.Random, *, shore: Shore = CALM, size_m: float = 190.0) -> bpy.types.Object:
    """The surface, at the shore's water level."""
    sheet = mesh.grid(name, size_m, size_m, 24, 24)
    mesh.move(sheet, z=shore.water_m)
    return mesh.set_material(sheet, lakeside.lake_water(f"{name}_surface"))


def wake(name: str) -> bpy.types.Object:
    """Ripples that spread behind a swimming bird of half a metre: a patch for the water's surface.

    The bird's middle is at the origin and swims towards -Y; z scales with the pace.
    """

    def height(x: float, y: float) -> float:
        behind = y + 0.30
        if behind <= 0.0:
            return -0.012
        arm = abs(x) - 0.10 - 0.36 * behind
        crest = math.cos(max(-2.2, min(2.2, 42.0 * arm))) * math.exp(-((arm / 0.055) ** 2))
        inner = 0.35 * math.sin(34.0 * behind) * math.exp(-((x / (0.05 + 0.16 * behind)) ** 2))
        fade = math.exp(-behind / 0.55) * min(1.0, behind / 0.10)
        edge = max(0.0, abs(x) - 0.50) + max(0.0, behind - 1.15)
        return 0.020 * fade * (crest + inner) - 0.004 - 0.2 * edge

    patch = mesh.grid(name, 1.30, 1.80, 78, 108, lambda x, y: height(x, y + 0.42))
    mesh.move(patch, y=0.42)
    return mesh.set_material(patch, lakeside.lake_water(f"{name}_surface"))


@kind("lily_pads", (1.04, 0.599, 0.008))
def lily_pads(
    name: str,
    rng: random.Random,
    *,
    spots: Sequence[tuple[float, float]] = ((0.0, 0.0),),
    water_m: float = 0.0,
    each: int = 9,
) -> bpy.types.Object:
    """Floating leaves round some spots, one in six with a white flower."""
    parts = []
    for cx, cy in spots:
        for _ in range(each):
            reach, way = 0.42 * math.sqrt(rng.random()), rng.uniform(0.0, 2.0 * math.pi)
            place = Vector((cx + 1.5 * reach * math.cos(way), cy + reach * math.sin(way), water_m + 0.006))
            parts.append(_pad(f"{name}_pad", rng, place))
            if rng.random() < 0.17:
                parts += _flower(f"{name}_flower", rng, place)
    return mesh.join(name, parts)


def _pad(name: str, rng: random.Random, place: Vector) -> bpy.types.Object:
    radius, turn = rng.uniform(0.055, 0.105), rng.uniform(0.0, 6.3)
    rim = [turn + math.radians(9.0 + 342.0 * k / 17) for k in range(18)]
    verts = [Vector((0.0, 0.0, 0.0))]
    verts += [Vector((radius * math.cos(a), radius * math.sin(a), 0.004 * math.sin(3 * a))) for a in rim]
    pad = mesh.from_pydata(name, [place + v for v in verts], [(0, k + 1, k + 2) for k in range(17)])
    return mesh.set_material(pad, lakeside.lily_leaf(f"{name}_leaf"))


def _flower(name: str, rng: random.Random, place: Vector) -> list[bpy.types.Object]:
    petals = []
    for ring, (count, lean, length) in enumerate(((9, 1.05, 0.045), (7, 0.55, 0.040))):
        for k in range(count):
            petal = mesh.ellipsoid(name, (0.010, 0.5 * length, 0.0035), 8, 6, centre=(0, 0.5 * length, 0))
            turn = 2.0 * math.pi * (k + 0.5 * ring) / count + rng.uniform(-0.1, 0.1)
            tilt = Matrix.Rotation(0.5 * math.pi - lean, 4, "X")
            lift = Vector((0.0, 0.0, 0.008))
            mesh.transform(petal, Matrix.Translation(place + lift) @ Matrix.Rotation(turn, 4, "Z") @ tilt)
            petals.append(petal)
    bloom = mesh.join(name, petals)
    return [mesh.set_material(bloom, lakeside.petals(f"{name}_petals"))]
