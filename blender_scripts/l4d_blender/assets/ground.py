"""Open ground: a height field with worn paths, its mesh, and what grows or lies on it.

Owns `Terrain` (heights and wear as functions of x, y), the mesh that samples it, grass blades, straw litter
and stones. Knows nothing of what stands on it: recipes say where feet have worn the grass away.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import bpy
import numpy as np
from mathutils import Vector, noise

from l4d_blender.scene.catalogue import kind

from . import mesh
from .materials import outdoors

Point2 = tuple[float, float]


def _smoothstep(low: float, high: float, value: float) -> float:
    t = min(1.0, max(0.0, (value - low) / (high - low)))
    return t * t * (3.0 - 2.0 * t)


@dataclass(frozen=True)
class Path:
    """A worn track: a polyline with a half width; wheel ruts if carts use it."""

    points: Sequence[Point2]
    half_width_m: float
    ruts: bool = False

    def distance(self, x: float, y: float) -> float:
        """Metres from the centre line."""
        best = math.inf
        for (ax, ay), (bx, by) in zip(self.points, self.points[1:], strict=False):
            dx, dy = bx - ax, by - ay
            t = min(1.0, max(0.0, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy)))
            best = min(best, math.hypot(x - ax - t * dx, y - ay - t * dy))
        return best


@dataclass(frozen=True)
class Terrain:
    """Heights in metres and wear (0 grass .. 1 bare soil) of a yard that is level where people act.

    Inside `level_radius_m` the relief stays within a few millimetres of zero, so that feet that are
    planned on z = 0 neither float nor sink visibly; beyond `hills_from_m` the land rises to a skyline.
    """

    seed: int = 0
    yard: Sequence[tuple[Point2, float]] = ()
    paths: Sequence[Path] = ()
    level_radius_m: float = 3.6
    hills_from_m: float = 22.0
    hill_height_m: float = 7.0
    offset: Vector = field(init=False)

    def __post_init__(self) -> None:
        rng = random.Random(self.seed)
        object.__setattr__(self, "offset", Vector([rng.uniform(-50, 50) for _ in range(3)]))

    def _noise(self, x: float, y: float, per_metre: float) -> float:
        return noise.noise(Vector((x * per_metre, y * per_metre, 0.0)) + self.offset)

    def height(self, x: float, y: float) -> float:
        """Metres above the level of the yard."""
        r = math.hypot(x, y)
        away = _smoothstep(self.level_radius_m, self.level_radius_m + 5.0, r)
        z = 0.006 * self._noise(x, y, 2.3) * (1.0 + 3.0 * away) + away * 0.10 * self._noise(x, y, 0.28)
        for path in self.paths:
            if path.ruts:
                rut = abs(path.distance(x, y) - 0.55)
                z -= 0.035 * away * math.exp(-((rut / 0.11) ** 2))
        hills = _smoothstep(self.hills_from_m, self.hills_from_m * 3.2, r)
        return z + hills * self.hill_height_m * (0.55 + 0.75 * self._noise(x, y, 0.021))

    def wear(self, x: float, y: float) -> float:
        """0 where grass grows, 1 where soil is bare; the edge is ragged."""
        ragged = 0.38 * self._noise(x, y, 0.9) + 0.22 * self._noise(x, y, 3.1)
        wear = 0.0
        for (cx, cy), radius in self.yard:
            wear = max(wear, 1.15 - math.hypot(x - cx, y - cy) / radius)
        for path in self.paths:
            d = path.distance(x, y) / path.half_width_m
            crown = 0.55 * math.exp(-((d / 0.35) ** 2)) if path.ruts else 0.0
            wear = max(wear, 1.1 - d - crown)
        return min(1.0, max(0.0, 0.5 + 1.5 * (wear + 0.55 * ragged - 0.32)))


LEVEL = Terrain()


@kind("ground", (176.1, 176.1, 6.39), "backdrop")
def ground(
    name: str, rng: random.Random, *, terrain: Terrain = LEVEL, radius_m: float = 85.0, sectors: int = 168
) -> bpy.types.Object:
    """The terrain as one polar mesh, fine near the middle, coarse at the skyline; wear is an attribute."""
    radii = [0.0]
    while radii[-1] < radius_m:
        radii.append(radii[-1] + max(0.10, 0.058 * radii[-1]))
    verts: list[tuple[float, float, float]] = [(0.0, 0.0, terrain.height(0.0, 0.0))]
    for r in radii[1:]:
        for k in range(sectors):
            angle = 2.0 * math.pi * k / sectors
            x, y = r * math.cos(angle), r * math.sin(angle)
            verts.append((x, y, terrain.height(x, y)))
    faces: list[tuple[int, ...]] = [(0, 1 + k, 1 + (k + 1) % sectors) for k in range(sectors)]
    for ring in range(len(radii) - 2):
        a, b = 1 + ring * sectors, 1 + (ring + 1) * sectors
        for k in range(sectors):
            j = (k + 1) % sectors
            faces.append((a + k, b + k, b + j, a + j))
    surface = mesh.from_pydata(name, verts, faces, smooth=True)
    wear = surface.data.attributes.new("wear", "FLOAT", "POINT")
    wear.data.foreach_set("value", [terrain.wear(x, y) for x, y, _ in verts])
    mesh.set_material(surface, outdoors.yard_ground(f"{name}_soil_and_grass"))
    return surface


def _blades(
    roots: np.ndarray, heading: np.ndarray, length: np.ndarray, width: np.ndarray, bend: np.ndarray
) -> tuple[list, list]:
    """Curved blades of five vertices each (two quads' worth of width, pointed tip)."""
    side = np.stack([-np.sin(heading), np.cos(heading), np.zeros_like(heading)], axis=1)
    lean = np.stack([np.cos(heading), np.sin(heading), np.zeros_like(heading)], axis=1)
    up = np.array([0.0, 0.0, 1.0])
    half = 0.5 * width[:, None] * side
    mid = roots + 0.55 * length[:, None] * (up + 0.35 * bend[:, None] * lean)
    tip = roots + length[:, None] * ((1.0 - 0.35 * bend[:, None] ** 2) * up + bend[:, None] * lean)
    verts = np.stack([roots - half, roots + half, mid - 0.8 * half, mid + 0.8 * half, tip], axis=1)
    base = 5 * np.arange(len(roots))[:, None]
    quads = (base + np.array([[0, 1, 3, 2]])).tolist()
    tips = (base + np.array([[2, 3, 4]])).tolist()
    return verts.reshape(-1, 3).tolist(), quads + tips


@kind("grass", (9.73, 9.77, 0.209), "backdrop")
def grass(
    name: str,
    rng: random.Random,
    *,
    terrain: Terrain = LEVEL,
    tufts: int = 300,
    radius_m: float = 5.0,
    blades_per_tuft: int = 11,
    length_m: tuple[float, float] = (0.05, 0.16),
    keep: Callable[[float, float], float] | None = None,
) -> bpy.types.Object:
    """Tufts of grass wherever the terrain is not worn, in one mesh.

    `keep(x, y)` may thin them (0 none, 1 all); tufts are denser towards the middle, where cameras look.
    """
    centres: list[tuple[float, float, float]] = []
    attempts = 0
    while len(centres) < tufts and attempts < 30 * tufts:
        attempts += 1
        r, angle = radius_m * rng.random() ** 0.62, rng.uniform(0.0, 2.0 * math.pi)
        x, y = r * math.cos(angle), r * math.sin(angle)
        chance = (1.0 - terrain.wear(x, y)) ** 1.5
        if keep is not None:
            chance *= keep(x, y)
        if rng.random() < chance:
            centres.append((x, y, r))
    draw = np.random.default_rng(rng.getrandbits(64))
    count = len(centres) * blades_per_tuft
    middle = np.repeat(np.array(centres), blades_per_tuft, axis=0)
    size = np.repeat(draw.uniform(0.6, 1.25, len(centres)), blades_per_tuft)
    spread = 0.055 * size * np.sqrt(draw.uniform(0.0, 1.0, count))
    heading = draw.uniform(0.0, 2.0 * np.pi, count)
    roots = middle.copy()
    roots[:, 0] += spread * np.cos(heading)
    roots[:, 1] += spread * np.sin(heading)
    roots[:, 2] = [terrain.height(x, y) - 0.004 for x, y in roots[:, :2]]
    # Far blades are wider: thinner than a pixel they would only be noise.
    far = 1.0 + middle[:, 2] / 5.0
    length = draw.uniform(*length_m, count) * size
    width = draw.uniform(0.005, 0.010, count) * far
    bend = draw.uniform(0.1, 0.75, count)
    facing = heading + draw.normal(0.0, 0.5, count)
    verts, faces = _blades(roots, facing, length, width, bend)
    blades = mesh.from_pydata(name, verts, faces, smooth=False)
    mesh.set_material(blades, outdoors.grass_blades(f"{name}_blades"))
    return blades


@kind("straw", (1.73, 1.73, 0.021), "backdrop")
def straw_litter(
    name: str,
    rng: random.Random,
    *,
    terrain: Terrain = LEVEL,
    spots: Sequence[tuple[Point2, float, int]] = (((0.0, 0.0), 1.0, 60),),
) -> bpy.types.Object:
    """Loose stalks lying on the ground; each spot is (centre, radius in metres, stalks)."""
    draw = np.random.default_rng(rng.getrandbits(64))
    verts: list[tuple[float, float, float]] = []
    faces: list[tuple[int, ...]] = []
    for (cx, cy), radius, stalks in spots:
        for _ in range(stalks):
            r, angle = radius * abs(draw.normal(0.0, 0.5)), draw.uniform(0.0, 2.0 * np.pi)
            x, y = cx + r * math.cos(angle), cy + r * math.sin(angle)
            heading, half, width = (
                draw.uniform(0, 2 * np.pi),
                draw.uniform(0.03, 0.10),
                draw.uniform(0.003, 0.006),
            )
            dx, dy = half * math.cos(heading), half * math.sin(heading)
            wx, wy = -width * math.sin(heading), width * math.cos(heading)
            low, high = (
                terrain.height(x - dx, y - dy) + 0.003,
                terrain.height(x + dx, y + dy) + draw.uniform(0.004, 0.02),
            )
            k = len(verts)
            verts += [
                (x - dx - wx, y - dy - wy, low),
                (x - dx + wx, y - dy + wy, low),
                (x + dx + wx, y + dy + wy, high),
                (x + dx - wx, y + dy - wy, high),
            ]
            faces.append((k, k + 3, k + 2, k + 1))
    litter = mesh.from_pydata(name, verts, faces, smooth=False)
    mesh.set_material(litter, outdoors.straw(f"{name}_straw"))
    return litter


@kind("stones", (7.6, 7.37, 0.075), "backdrop")
def stones(
    name: str,
    rng: random.Random,
    *,
    terrain: Terrain = LEVEL,
    count: int = 60,
    radius_m: float = 4.0,
    size_m: tuple[float, float] = (0.015, 0.06),
    keep: Callable[[float, float], float] | None = None,
) -> bpy.types.Object:
    """Half-buried stones strewn over the ground, in one mesh."""
    verts: list[Vector] = []
    faces: list[tuple[int, ...]] = []
    pattern = mesh.ellipsoid("stone_pattern", (1.0, 1.0, 1.0), 7, 4)
    shape = [v.co.copy() for v in pattern.data.vertices]
    polygons = [tuple(p.vertices) for p in pattern.data.polygons]
    bpy.data.objects.remove(pattern)
    placed = 0
    while placed < count:
        r, angle = radius_m * math.sqrt(rng.random()), rng.uniform(0.0, 2.0 * math.pi)
        x, y = r * math.cos(angle), r * math.sin(angle)
        if keep is not None and rng.random() > keep(x, y):
            placed += 1
            continue
        size = size_m[0] + (size_m[1] - size_m[0]) * rng.random() ** 3
        stretch = Vector((rng.uniform(0.8, 1.4), rng.uniform(0.7, 1.1), rng.uniform(0.4, 0.7))) * size
        turn, shift = rng.uniform(0.0, 6.3), Vector([rng.uniform(-9, 9) for _ in range(3)])
        c, s, z = math.cos(turn), math.sin(turn), terrain.height(x, y)
        k = len(verts)
        for v in shape:
            p = v * (1.0 + 0.3 * noise.noise(1.3 * v + shift)) * stretch
            verts.append(Vector((x + c * p.x - s * p.y, y + s * p.x + c * p.y, z + p.z)))
        faces += [tuple(k + i for i in polygon) for polygon in polygons]
        placed += 1
    strewn = mesh.from_pydata(name, verts, faces, smooth=True)
    mesh.set_material(strewn, outdoors.field_stone(f"{name}_stone"))
    return strewn
