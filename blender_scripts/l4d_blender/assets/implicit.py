"""Organic surfaces from signed distances: blended cones and ellipsoids, surface nets, clipping at crisp hems.

Works on numpy arrays only; it knows nothing of Blender, bodies or clothes. All lengths are metres.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

import numpy as np

Field = Callable[[np.ndarray], np.ndarray]
Faces = list[tuple[int, ...]]


def smooth_min(a: np.ndarray, b: np.ndarray, width: float | np.ndarray) -> np.ndarray:
    """Minimum of two distances, rounded over `width` where they meet."""
    width = np.maximum(width, 1e-9)
    h = np.maximum(width - np.abs(a - b), 0.0) / width
    return np.minimum(a, b) - h * h * width * 0.25


def smoothstep(low: float, high: float, x: np.ndarray) -> np.ndarray:
    """Rises from 0 at `low` to 1 at `high` with level ends (also downwards)."""
    t = np.clip((x - low) / (high - low), 0.0, 1.0)
    return t * t * (3.0 - 2.0 * t)


@dataclass(frozen=True)
class Cone:
    """A rounded cone from `a` to `b`; `squash` < 1 flattens it along the unit vector `flat`."""

    a: np.ndarray
    b: np.ndarray
    ra: float
    rb: float
    blend: float = 0.02
    flat: np.ndarray | None = None
    squash: float = 1.0

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest corner of a box round the surface."""
        reach = max(self.ra, self.rb)
        return np.minimum(self.a, self.b) - reach, np.maximum(self.a, self.b) + reach

    def __call__(self, p: np.ndarray) -> np.ndarray:
        """Signed distance at points (..., 3), about metres."""
        axis = self.b - self.a
        t = np.clip((p - self.a) @ axis / max(float(axis @ axis), 1e-12), 0.0, 1.0)
        offset = p - self.a - t[..., None] * axis
        scale = 1.0
        if self.flat is not None:
            along = offset @ self.flat
            offset = offset + (along * (1.0 / self.squash - 1.0))[..., None] * self.flat
            scale = 0.5 * (1.0 + self.squash)
        return (np.linalg.norm(offset, axis=-1) - (self.ra + (self.rb - self.ra) * t)) * scale


@dataclass(frozen=True)
class Ellipsoid:
    """An ellipsoid with axis-aligned radii; a `blend` below zero carves it out instead."""

    centre: np.ndarray
    radii: np.ndarray
    blend: float = 0.02

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest corner of a box round the surface."""
        return self.centre - self.radii, self.centre + self.radii

    def __call__(self, p: np.ndarray) -> np.ndarray:
        """Signed distance at points (..., 3), about metres."""
        q = (p - self.centre) / self.radii
        k1 = np.linalg.norm(q, axis=-1)
        k2 = np.linalg.norm(q / self.radii, axis=-1)
        return k1 * (k1 - 1.0) / np.maximum(k2, 1e-9)


@dataclass(frozen=True)
class Stack:
    """A trunk: ellipses of half-width and half-depth at rising heights, interpolated smoothly."""

    heights: np.ndarray
    half_width: np.ndarray
    half_depth: np.ndarray
    centre_y: np.ndarray
    blend: float = 0.03

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest corner of a box round the surface."""
        wide, deep = float(self.half_width.max()), float(self.half_depth.max() + np.abs(self.centre_y).max())
        return np.array([-wide, -deep, self.heights[0]]), np.array([wide, deep, self.heights[-1]])

    def section(self, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Half-width, half-depth and y of the centre at height z (monotone cubic blending)."""
        index = np.clip(np.searchsorted(self.heights, z) - 1, 0, len(self.heights) - 2)
        low, high = self.heights[index], self.heights[index + 1]
        t = np.clip((z - low) / (high - low), 0.0, 1.0)

        span, t2, t3 = high - low, t * t, t * t * t
        h00, h10, h01, h11 = 2 * t3 - 3 * t2 + 1, t3 - 2 * t2 + t, -2 * t3 + 3 * t2, t3 - t2

        def spline(values: np.ndarray) -> np.ndarray:
            slope = np.gradient(values, self.heights)
            return (
                h00 * values[index]
                + h10 * span * slope[index]
                + h01 * values[index + 1]
                + h11 * span * slope[index + 1]
            )

        return spline(self.half_width), spline(self.half_depth), spline(self.centre_y)

    def __call__(self, p: np.ndarray) -> np.ndarray:
        """Signed distance at points (..., 3), about metres."""
        wide, deep, shift = self.section(p[..., 2])
        x, y = p[..., 0], p[..., 1] - shift
        k1 = np.sqrt((x / wide) ** 2 + (y / deep) ** 2)
        k2 = np.sqrt((x / wide**2) ** 2 + (y / deep**2) ** 2)
        side = np.where(k2 > 1e-9, k1 * (k1 - 1.0) / np.maximum(k2, 1e-9), -np.minimum(wide, deep))
        cap = np.maximum(self.heights[0] - p[..., 2], p[..., 2] - self.heights[-1])
        outside = np.sqrt(np.maximum(side, 0.0) ** 2 + np.maximum(cap, 0.0) ** 2)
        return np.where((side > 0.0) & (cap > 0.0), outside, np.maximum(side, cap))


class Blob(Protocol):
    """A body of flesh: a signed distance that is blended with its neighbours'."""

    @property
    def blend(self) -> float:
        """Over how many metres it is rounded where it meets others."""

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest corner of a box round the surface."""

    def __call__(self, p: np.ndarray, /) -> np.ndarray:
        """Signed distance at points (..., 3), about metres."""


def blended(blobs: list[Blob], p: np.ndarray) -> np.ndarray:
    """Distance to the blended union of blobs at points (..., 3)."""
    distance = np.full(p.shape[:-1], 1e3)
    for blob in blobs:
        if blob.blend < 0.0:
            distance = -smooth_min(-distance, blob(p), -blob.blend)
        else:
            distance = smooth_min(distance, blob(p), blob.blend)
    return distance


@dataclass
class Grid:
    """Samples of a field on a regular lattice."""

    origin: np.ndarray
    cell: float
    values: np.ndarray

    @staticmethod
    def over(low: np.ndarray, high: np.ndarray, cell: float) -> Grid:
        """An empty lattice between two corners."""
        shape = np.ceil((np.asarray(high) - np.asarray(low)) / cell).astype(int) + 1
        return Grid(np.asarray(low, float), cell, np.full(shape, 1e3))

    def points(self) -> np.ndarray:
        """Lattice points, shape (nx, ny, nz, 3)."""
        axes = [self.origin[k] + self.cell * np.arange(self.values.shape[k]) for k in range(3)]
        return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)

    def add(self, blob: Blob, margin: float = 0.09) -> None:
        """Blend one blob in, touching only the lattice points near it."""
        low, high = blob.bounds()
        first = np.clip(np.floor((low - margin - self.origin) / self.cell).astype(int), 0, None)
        last = np.ceil((high + margin - self.origin) / self.cell).astype(int) + 1
        window = tuple(slice(a, min(b, n)) for a, b, n in zip(first, last, self.values.shape))
        axes = [self.origin[k] + self.cell * np.arange(window[k].start, window[k].stop) for k in range(3)]
        p = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
        if blob.blend < 0.0:
            self.values[window] = -smooth_min(-self.values[window], blob(p), -blob.blend)
        else:
            self.values[window] = smooth_min(self.values[window], blob(p), blob.blend)


CORNERS = np.array([(i, j, k) for i in (0, 1) for j in (0, 1) for k in (0, 1)])
EDGES = [(a, b) for a in range(8) for b in range(a + 1, 8) if np.abs(CORNERS[a] - CORNERS[b]).sum() == 1]


def surface_nets(grid: Grid) -> tuple[np.ndarray, np.ndarray]:
    """Quads of the zero level: one vertex per crossed cell at the mean of its edge crossings."""
    values = grid.values
    shape = np.array(values.shape) - 1
    corner = np.stack(
        [values[c[0] : c[0] + shape[0], c[1] : c[1] + shape[1], c[2] : c[2] + shape[2]] for c in CORNERS],
        axis=-1,
    )
    inside = corner < 0.0
    active = inside.any(-1) & ~inside.all(-1)
    index = np.full(shape, -1)
    index[active] = np.arange(int(active.sum()))
    samples = corner[active]
    total, count = np.zeros((len(samples), 3)), np.zeros(len(samples))
    for a, b in EDGES:
        crossed = (samples[:, a] < 0.0) != (samples[:, b] < 0.0)
        t = samples[crossed, a] / (samples[crossed, a] - samples[crossed, b])
        total[crossed] += CORNERS[a] + t[:, None] * (CORNERS[b] - CORNERS[a])
        count[crossed] += 1
    verts = grid.origin + grid.cell * (np.argwhere(active) + total / count[:, None])
    quads = [_quads_across(values < 0.0, index, axis) for axis in range(3)]
    return verts, np.concatenate(quads)


def _quads_across(inside: np.ndarray, index: np.ndarray, axis: int) -> np.ndarray:
    order = (axis, (axis + 1) % 3, (axis + 2) % 3)
    solid, cells = inside.transpose(order), index.transpose(order)
    here, there = solid[:-1, 1:-1, 1:-1], solid[1:, 1:-1, 1:-1]
    i, j, k = np.nonzero(here != there)
    quad = np.stack([cells[i, j, k], cells[i, j + 1, k], cells[i, j + 1, k + 1], cells[i, j, k + 1]], axis=1)
    outward = here[i, j, k]
    quad[~outward] = quad[~outward][:, ::-1]
    return quad


def relax(verts: np.ndarray, faces: np.ndarray, rounds: int, amount: float = 0.5) -> np.ndarray:
    """Laplacian smoothing of a closed quad mesh, shrinking undone every round (Taubin)."""
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 3]], faces[:, [3, 0]]])
    degree = np.bincount(edges.ravel(), minlength=len(verts))[:, None]
    for turn in range(2 * rounds):
        mean = np.zeros_like(verts)
        np.add.at(mean, edges[:, 0], verts[edges[:, 1]])
        np.add.at(mean, edges[:, 1], verts[edges[:, 0]])
        factor = amount if turn % 2 == 0 else -amount * 1.04
        verts = verts + factor * (mean / np.maximum(degree, 1) - verts)
    return verts


def clip(verts: np.ndarray, faces: Faces | np.ndarray, keep: np.ndarray) -> tuple[np.ndarray, Faces]:
    """The part of a mesh where the per-vertex value is below zero; crossed faces are cut exactly."""
    cut_points: list[np.ndarray] = []
    cut_index: dict[tuple[int, int], int] = {}

    def crossing(a: int, b: int) -> int:
        pair = (min(a, b), max(a, b))
        if pair not in cut_index:
            t = keep[a] / (keep[a] - keep[b])
            cut_index[pair] = len(verts) + len(cut_points)
            cut_points.append(verts[a] + t * (verts[b] - verts[a]))
        return cut_index[pair]

    kept: Faces = []
    for face in np.asarray(faces).tolist() if isinstance(faces, np.ndarray) else faces:
        below = [keep[v] < 0.0 for v in face]
        if all(below):
            kept.append(tuple(face))
        elif any(below):
            polygon = []
            for n, a in enumerate(face):
                b = face[(n + 1) % len(face)]
                if below[n]:
                    polygon.append(a)
                if below[n] != below[(n + 1) % len(face)]:
                    polygon.append(crossing(a, b))
            kept.append(tuple(polygon))
    points = np.concatenate([verts, np.array(cut_points).reshape(-1, 3)])
    return compact(points, kept)


def compact(verts: np.ndarray, faces: Faces) -> tuple[np.ndarray, Faces]:
    """Drop vertices that no face uses."""
    used = np.unique(np.concatenate([np.asarray(f) for f in faces])) if faces else np.zeros(0, int)
    renumber = np.full(len(verts), -1)
    renumber[used] = np.arange(len(used))
    return verts[used], [tuple(int(renumber[v]) for v in face) for face in faces]


def vertex_normals(verts: np.ndarray, faces: Faces) -> np.ndarray:
    """Unit normals, weighted by the area of the faces round a vertex."""
    normals = np.zeros_like(verts)
    for size in {len(face) for face in faces}:
        block = np.array([face for face in faces if len(face) == size])
        normal = np.cross(verts[block[:, 1]] - verts[block[:, 0]], verts[block[:, 2]] - verts[block[:, 0]])
        for column in range(size):
            np.add.at(normals, block[:, column], normal)
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)


def hem(verts: np.ndarray, faces: Faces, thickness: float, depth: float) -> tuple[np.ndarray, Faces]:
    """Give every open edge of a cloth shell a lip of `thickness` and a lining `depth` deep behind it."""
    directed = {(f[n], f[(n + 1) % len(f)]) for f in faces for n in range(len(f))}
    border = sorted((a, b) for a, b in directed if (b, a) not in directed)
    if not border:
        return verts, faces
    normals = vertex_normals(verts, faces)
    tangent = np.zeros_like(verts)
    for a, b in border:
        along = verts[b] - verts[a]
        tangent[a] += along
        tangent[b] += along
    rim = sorted({v for edge in border for v in edge})
    position = {v: n for n, v in enumerate(rim)}
    inward = np.cross(normals[rim], tangent[rim])
    inward /= np.maximum(np.linalg.norm(inward, axis=1, keepdims=True), 1e-12)
    lip = verts[rim] - thickness * normals[rim]
    lining = lip + depth * inward - 0.3 * thickness * normals[rim]
    first, second = len(verts), len(verts) + len(rim)
    bands = [(b, a, first + position[a], first + position[b]) for a, b in border]
    bands += [
        (first + position[b], first + position[a], second + position[a], second + position[b])
        for a, b in border
    ]
    return np.concatenate([verts, lip, lining]), faces + bands
