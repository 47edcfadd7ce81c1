"""Float64 ray casting through pixel centres: the judge of what Cycles wrote."""

from __future__ import annotations

import bpy
import numpy as np


def scene_triangles(frame: int) -> tuple[np.ndarray, np.ndarray]:
    """World triangles (n x 3 x 3, float64) of the current Blender scene and the id of each."""
    bpy.context.scene.frame_set(frame)
    depsgraph = bpy.context.evaluated_depsgraph_get()
    corners, ids = [], []
    for obj in bpy.context.scene.objects:
        if obj.type != "MESH":
            continue
        evaluated = obj.evaluated_get(depsgraph)
        mesh = evaluated.data
        mesh.calc_loop_triangles()
        points = np.array([vertex.co for vertex in mesh.vertices], dtype=np.float64)
        index = np.array([triangle.vertices for triangle in mesh.loop_triangles])
        matrix = np.array(evaluated.matrix_world, dtype=np.float64)
        corners.append((points @ matrix[:3, :3].T + matrix[:3, 3])[index])
        ids.append(np.full(len(index), obj.pass_index))
    return np.concatenate(corners), np.concatenate(ids)


def cast(
    triangles: np.ndarray, ids: np.ndarray, view: dict, width: int, height: int
) -> tuple[np.ndarray, np.ndarray]:
    """Planar depth (inf: no hit) and id per pixel, with the camera of a view.json."""
    world_from_camera = np.array(view["world_from_camera"][0]).reshape(4, 4)
    camera_from_world = np.linalg.inv(world_from_camera)
    local = triangles @ camera_from_world[:3, :3].T + camera_from_world[:3, 3]
    u, v = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    x, y = (u - view["cx"]) / view["fx"], (v - view["cy"]) / view["fy"]
    rays = np.stack([x, y, np.ones_like(x)], axis=-1)
    depth = np.full((height, width), np.inf)
    hit = np.zeros((height, width), dtype=np.uint32)
    for (a, b, c), number in zip(local, ids):
        window = _window(np.stack([a, b, c]), view, width, height)
        d = rays[window]
        if d.size == 0:
            continue
        normal = np.cross(b - a, c - a)
        with np.errstate(divide="ignore", invalid="ignore"):
            z = (a @ normal) / (d @ normal)
            p = d * z[..., None]
            inside = (z > 0.0) & (z < depth[window])
            for start, end in ((a, b), (b, c), (c, a)):
                inside &= np.cross(end - start, p - start) @ normal >= 0.0
        depth[window][inside] = z[inside]
        hit[window][inside] = number
    return depth, hit


def _window(corners: np.ndarray, view: dict, width: int, height: int) -> tuple[slice, slice]:
    """Rows and columns whose centres a triangle may cover: all, if it reaches behind the camera."""
    if corners[:, 2].min() <= 1e-6:
        return slice(0, height), slice(0, width)
    u = view["fx"] * corners[:, 0] / corners[:, 2] + view["cx"] - 0.5
    v = view["fy"] * corners[:, 1] / corners[:, 2] + view["cy"] - 0.5
    (left, right), (top, bottom) = ((int(np.floor(w.min())), int(np.ceil(w.max())) + 1) for w in (u, v))
    return slice(max(top, 0), max(bottom, 0)), slice(max(left, 0), max(right, 0))
