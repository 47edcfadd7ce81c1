"""From arrays to skinned Blender meshes: one place that makes meshes, skin weights, rigs and vertex colours.

Knows armatures and attributes; refuses to know what the shapes depict.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import bmesh
import bpy
import numpy as np

from . import mesh
from .rigs import hang

Weights = dict[str, np.ndarray]
MAX_BONES_PER_VERTEX = 4


@dataclass
class Shell:
    """A surface before it becomes a mesh: `material` numbers faces, `tint` and `strand` are per vertex."""

    name: str
    verts: np.ndarray
    faces: list[tuple[int, ...]]
    weights: Weights
    materials: Sequence[bpy.types.Material]
    material: np.ndarray | None = None
    tint: np.ndarray | None = None
    strand: np.ndarray | None = None
    extra: dict[str, np.ndarray] = field(default_factory=dict)


def make_mesh(shell: Shell, rig: bpy.types.Object) -> bpy.types.Object:
    """The mesh object of a shell, deformed by the rig and parented to it."""
    obj = mesh.from_pydata(shell.name, shell.verts.tolist(), shell.faces, smooth=True)
    for material in shell.materials:
        obj.data.materials.append(material)
    if shell.material is not None:
        obj.data.polygons.foreach_set("material_index", shell.material.astype(np.int32))
    mesh.store_rest_position(obj)
    tint = shell.tint if shell.tint is not None else np.ones((len(shell.verts), 3))
    colours = obj.data.attributes.new("tint", "FLOAT_COLOR", "POINT")
    colours.data.foreach_set("color", np.hstack([tint, np.ones((len(tint), 1))]).ravel())
    if shell.strand is not None:
        strands = obj.data.attributes.new("strand", "FLOAT_VECTOR", "POINT")
        strands.data.foreach_set("vector", shell.strand.ravel())
    _assign(obj, shell.weights)
    return hang(obj, rig)


def _assign(obj: bpy.types.Object, weights: Weights) -> None:
    names = list(weights)
    table = np.stack([weights[name] for name in names], axis=1)
    order = np.argsort(-table, axis=1)[:, :MAX_BONES_PER_VERTEX]
    best = np.take_along_axis(table, order, axis=1)
    best[best < 0.004] = 0.0
    best /= best.sum(axis=1, keepdims=True)
    used = sorted(set(order[best > 0.0].tolist()))
    group = {column: obj.vertex_groups.new(name=names[column]).index for column in used}
    bm = bmesh.new()
    bm.from_mesh(obj.data)
    layer = bm.verts.layers.deform.verify()
    for vertex, columns, values in zip(bm.verts, order.tolist(), best.tolist()):
        deform = vertex[layer]
        for column, value in zip(columns, values):
            if value > 0.0:
                deform[group[column]] = value
    bm.to_mesh(obj.data)
    bm.free()


def rigid(bone: str, count: int) -> Weights:
    """Weights of vertices that all follow one bone."""
    return {bone: np.ones(count)}


def merged(name: str, parts: Sequence[Shell]) -> Shell:
    """One shell from several; equal materials are shared."""
    materials: list[bpy.types.Material] = []
    verts, faces, material, tints, strands = [], [], [], [], []
    bones = sorted({bone for part in parts for bone in part.weights})
    weights: dict[str, list[np.ndarray]] = {bone: [] for bone in bones}
    count = 0
    for part in parts:
        slots = []
        for item in part.materials:
            if item not in materials:
                materials.append(item)
            slots.append(materials.index(item))
        index = part.material if part.material is not None else np.zeros(len(part.faces), int)
        material.append(np.array(slots)[index.astype(int)])
        verts.append(part.verts)
        faces += [tuple(v + count for v in face) for face in part.faces]
        size = len(part.verts)
        tints.append(part.tint if part.tint is not None else np.ones((size, 3)))
        strands.append(part.strand if part.strand is not None else np.zeros((size, 3)))
        for bone in bones:
            weights[bone].append(part.weights.get(bone, np.zeros(size)))
        count += size
    return Shell(
        name,
        np.concatenate(verts),
        faces,
        {b: np.concatenate(w) for b, w in weights.items()},
        materials,
        np.concatenate(material),
        np.concatenate(tints),
        np.concatenate(strands),
    )


def tube(
    points: np.ndarray, radii: np.ndarray, sides: int, up: np.ndarray
) -> tuple[np.ndarray, list[tuple[int, ...]]]:
    """A closed elliptical tube along points; radii are (across, along `up`) per point."""
    rings = []
    for n, (p, r) in enumerate(zip(points, radii)):
        ahead = points[min(n + 1, len(points) - 1)] - points[max(n - 1, 0)]
        ahead /= np.linalg.norm(ahead)
        across = np.cross(up, ahead)
        across /= np.linalg.norm(across)
        over = np.cross(ahead, across)
        angle = 2.0 * np.pi * np.arange(sides) / sides
        rings.append(p + r[0] * np.cos(angle)[:, None] * across + r[1] * np.sin(angle)[:, None] * over)
    verts = np.concatenate([*rings, points[:1], points[-1:]])
    faces = grid_faces(len(points), sides, wrap=True)
    first, last = len(points) * sides, len(points) * sides + 1
    top = (len(points) - 1) * sides
    faces += [(first, (n + 1) % sides, n) for n in range(sides)]
    faces += [(last, top + n, top + (n + 1) % sides) for n in range(sides)]
    return verts, faces


def grid_faces(rows: int, columns: int, wrap: bool = False) -> list[tuple[int, ...]]:
    """Quads of a grid of vertices, row after row; they face outwards if columns turn left as rows rise."""
    faces: list[tuple[int, ...]] = []
    for row in range(rows - 1):
        for column in range(columns if wrap else columns - 1):
            right = (column + 1) % columns
            a, b = row * columns + column, row * columns + right
            faces.append((a, b, b + columns, a + columns))
    return faces
