"""Ground truth at all 97 frames: oriented boxes, exact distances between meshes, contact.

Reads the evaluated Blender scene (so that what it says is what is rendered) and returns plain numbers;
queries are proved from them.
"""

from __future__ import annotations

import gc
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import bpy
import numpy as np
from mathutils import Vector

from ..scene import distances
from ..scene.scene import Instance, Scene
from ..scene.timeline import FPS, FRAME_COUNT, LAST_FRAME

CONTACT_M = 0.005  # closer than this is contact ...
RELEASE_M = 0.010  # ... which lasts until they are further apart than this
# Pairs that never come closer have no distances; a bit more than what counts as beside at each scale.
PAIR_REACH_M = {"outdoor": 1.2, "room": 0.8, "tabletop": 0.5}
_STATIC = 1e-6


@dataclass
class Shape:
    """The surface of one instance: per frame its points, axes and box; one entry if it never moves."""

    instance: Instance
    points: list[np.ndarray]  # vertices in world metres, float64
    triangles: np.ndarray
    axes: np.ndarray  # frames x 3 x 3, world_from_box
    centre: np.ndarray  # frames x 3
    extents: np.ndarray  # frames x 3, full side lengths

    def __post_init__(self) -> None:
        self.low = np.array([points.min(axis=0) for points in self.points])
        self.high = np.array([points.max(axis=0) for points in self.points])

    @property
    def static(self) -> bool:
        """Whether it stays as it is over the whole clip."""
        return len(self.points) == 1


def measure(scene: Scene) -> list[Shape]:
    """The shape of every instance over the whole clip, by id."""
    instances = sorted(scene.instances, key=lambda instance: instance.id)
    points: dict[str, list[np.ndarray]] = {instance.name: [] for instance in instances}
    axes: dict[str, list[np.ndarray]] = {instance.name: [] for instance in instances}
    surfaces = {instance.name: _Surface(instance) for instance in instances}
    for frame in range(FRAME_COUNT):
        bpy.context.scene.frame_set(frame)
        depsgraph = bpy.context.evaluated_depsgraph_get()
        for instance in instances:
            points[instance.name].append(surfaces[instance.name].points(depsgraph))
            axes[instance.name].append(_box_axes(instance, depsgraph))
    bpy.context.scene.frame_set(0)
    return [
        _shape(
            instance, points[instance.name], surfaces[instance.name].triangles, np.array(axes[instance.name])
        )
        for instance in instances
    ]


def tracks(scene: Scene, description: str, shapes: Sequence[Shape], cameras: list[dict]) -> dict:
    """The content of tracks.json."""
    return {
        "schema": "l4d/tracks/1",
        "scene": scene.name,
        "scale": scene.scale,
        "variant": 0,
        "seed": scene.seed,
        "fps": float(FPS),
        "frame_count": FRAME_COUNT,
        "exposure": round(scene.exposure, 6),
        "description": description,
        "instances": [_instance_entry(shape) for shape in shapes],
        "events": _event_entries(scene),
        "pair_reach_m": PAIR_REACH_M[scene.scale],
        "pairs": pairs(scene, shapes),
        "cameras": cameras,
    }


def pairs(scene: Scene, shapes: Sequence[Shape]) -> list[dict]:
    """Distances and contact of the pairs that matter, ordered by their ids.

    First only whether a pair ever comes within reach is looked for, where its boxes are nearest; then those
    that do (and those that interact) are measured at all frames.
    """
    acting = {frozenset((e.subject.name, e.object.name)) for e in scene.events if e.object is not None}
    bodies: dict[str, distances.Body] = {}
    candidates = [
        _Pair(a, b, bodies)
        for a, b in combinations(shapes, 2)
        if "object" in (a.instance.role, b.instance.role)
        or frozenset((a.instance.name, b.instance.name)) in acting
    ]
    reach_m = PAIR_REACH_M[scene.scale]
    with collector_paused():
        found = [pair for pair in candidates if pair.names in acting or pair.comes_within(reach_m)]
        for pair in found:
            pair.measure()
    return [
        {
            "a": pair.a.instance.name,
            "b": pair.b.instance.name,
            "distance_m": rounded(pair.distances),
            "contact": contact_runs(pair.distances),
        }
        for pair in found
    ]


@contextmanager
def collector_paused() -> Iterator[None]:
    """Millions of short lists without cycles: looking through them for garbage took half of the time."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()


def contact_runs(distances: Sequence[float]) -> list[list[int]]:
    """Runs [first, last] of frames in contact: begins at 5 mm or less, ends beyond 10 mm."""
    if len(distances) == 1:
        return [[0, LAST_FRAME]] if distances[0] <= CONTACT_M else []
    runs: list[list[int]] = []
    touching = False
    for frame, distance in enumerate(distances):
        touching = distance <= (RELEASE_M if touching else CONTACT_M)
        if touching and runs and runs[-1][1] == frame - 1:
            runs[-1][1] = frame
        elif touching:
            runs.append([frame, frame])
    return runs


def rounded(values: Iterable[float] | np.ndarray) -> list:
    """Micrometres are enough; adding zero turns -0.0 into 0.0."""
    return (np.round(np.asarray(values, dtype=np.float64), 6) + 0.0).tolist()


class _Surface:
    """Reads the vertices of one instance's objects from the evaluated scene."""

    def __init__(self, instance: Instance) -> None:
        self._objects = instance.objects
        self._rigid: dict[str, np.ndarray] = {}
        self._last: tuple[list[np.ndarray], np.ndarray] | None = None
        triangles, offset = [], 0
        for obj in self._objects:
            mesh = obj.data
            if not _deforms(obj):
                self._rigid[obj.name] = _vertices(mesh)
            mesh.calc_loop_triangles()
            corners = np.empty(3 * len(mesh.loop_triangles), dtype=np.int32)
            mesh.loop_triangles.foreach_get("vertices", corners)
            triangles.append(corners.reshape(-1, 3) + offset)
            offset += len(mesh.vertices)
        self.triangles = np.concatenate(triangles)

    def points(self, depsgraph: bpy.types.Depsgraph) -> np.ndarray:
        """World vertices at the frame; the very same array as before if nothing moved."""
        evaluated = [obj.evaluated_get(depsgraph) for obj in self._objects]
        matrices = [np.array(obj.matrix_world, dtype=np.float64) for obj in evaluated]
        if len(self._rigid) == len(self._objects) and self._last is not None:
            before, points = self._last
            if all(map(np.array_equal, before, matrices)):
                return points
        parts = []
        for obj, shown, matrix in zip(self._objects, evaluated, matrices):
            local = self._rigid.get(obj.name)
            if local is None:
                local = _vertices(shown.data)
            parts.append(local @ matrix[:3, :3].T + matrix[:3, 3])
        points = np.concatenate(parts)
        self._last = matrices, points
        return points


class _Pair:
    """Two instances and the distance between them, frame after frame (one frame if neither moves)."""

    def __init__(self, a: Shape, b: Shape, bodies: dict[str, distances.Body]) -> None:
        self.a, self.b = a, b
        self.names = frozenset((a.instance.name, b.instance.name))
        frames = 1 if a.static and b.static else FRAME_COUNT
        self.distances = [np.inf] * frames
        self._bodies = bodies

    def comes_within(self, limit: float) -> bool:
        """Whether the surfaces are ever closer than `limit`; frames with near boxes are tried first."""
        gaps = self._boxes_apart()
        for frame in np.argsort(gaps, kind="stable").tolist():
            if gaps[frame] >= limit:
                return False
            self.distances[frame] = self._gap.at(frame, limit)
            if self.distances[frame] < np.inf:
                return True
        return False

    @cached_property
    def _gap(self) -> distances.Gap:
        """Bodies are made ready when a pair first asks for them: most pairs never do."""
        for shape in (self.a, self.b):
            if shape.instance.name not in self._bodies:
                self._bodies[shape.instance.name] = distances.Body(shape.points, shape.triangles)
        return distances.Gap(*(self._bodies[shape.instance.name] for shape in (self.a, self.b)))

    def measure(self) -> None:
        """Finds the distances that are not known yet."""
        for frame, known in enumerate(self.distances):
            if known == np.inf:
                self.distances[frame] = self._gap.at(frame)

    def _boxes_apart(self) -> np.ndarray:
        """How far the boxes are apart, frame by frame."""
        gap = np.maximum(self.a.low - self.b.high, self.b.low - self.a.high)
        return np.linalg.norm(np.maximum(gap, 0.0), axis=1)


def _shape(instance: Instance, points: list[np.ndarray], triangles: np.ndarray, axes: np.ndarray) -> Shape:
    low, high = np.empty((len(points), 3)), np.empty((len(points), 3))
    for k, (surface, turn) in enumerate(zip(points, axes)):
        if k > 0 and surface is points[k - 1] and np.array_equal(turn, axes[k - 1]):
            low[k], high[k] = low[k - 1], high[k - 1]
            continue
        local = surface @ turn
        low[k], high[k] = local.min(axis=0), local.max(axis=0)
    centre = np.einsum("fij,fj->fi", axes, (low + high) / 2)
    extents = high - low
    moving = any(p is not points[0] and np.abs(p - points[0]).max() > _STATIC for p in points[1:])
    if not moving and np.abs(axes - axes[0]).max() <= _STATIC:
        points, axes, centre, extents = points[:1], axes[:1], centre[:1], extents[:1]
    return Shape(instance, points, triangles, axes, centre, extents)


def _box_axes(instance: Instance, depsgraph: bpy.types.Depsgraph) -> np.ndarray:
    """world_from_box: the frame object's own axes; for a body with a skeleton upright, along its heading."""
    obj = instance.frame_object.evaluated_get(depsgraph)
    rig = obj if obj.type == "ARMATURE" else _rig(instance.frame_object)
    if rig is None:
        matrix = np.array(obj.matrix_world.to_3x3().normalized(), dtype=np.float64)
        return _orthonormal(matrix)
    rig = rig.evaluated_get(depsgraph)
    root = next(bone for bone in rig.pose.bones if bone.parent is None)
    posed_from_rest = rig.matrix_world @ root.matrix @ root.bone.matrix_local.inverted()
    front = posed_from_rest.to_3x3() @ Vector((0.0, -1.0, 0.0))
    if np.hypot(front.x, front.y) < 1e-3:
        front = posed_from_rest.to_3x3() @ Vector((0.0, 0.0, 1.0))
    length = np.hypot(front.x, front.y)
    y = np.array([-front.x / length, -front.y / length, 0.0])
    z = np.array([0.0, 0.0, 1.0])
    return np.stack([np.cross(y, z), y, z], axis=1)


def _orthonormal(matrix: np.ndarray) -> np.ndarray:
    """The rotation nearest to a float32 one, so that rounding leaves no skew behind; mirroring is dropped."""
    u, _, vt = np.linalg.svd(matrix)
    u[:, -1] *= np.sign(np.linalg.det(u @ vt))
    return u @ vt


def _rig(obj: bpy.types.Object) -> bpy.types.Object | None:
    return next((m.object for m in obj.modifiers if m.type == "ARMATURE" and m.object), None)


def _deforms(obj: bpy.types.Object) -> bool:
    return bool(obj.modifiers) or obj.data.shape_keys is not None


def _vertices(mesh: bpy.types.Mesh) -> np.ndarray:
    flat = np.empty(3 * len(mesh.vertices), dtype=np.float32)
    mesh.vertices.foreach_get("co", flat)
    return flat.reshape(-1, 3).astype(np.float64)


def _instance_entry(shape: Shape) -> dict:
    instance = shape.instance
    return {
        "id": instance.id,
        "name": instance.name,
        "role": instance.role,
        "category": instance.category,
        "attributes": dict(sorted(instance.attributes.items())),
        "front": instance.front,
        "track": {
            "centre": rounded(shape.centre),
            "axes": rounded(shape.axes.reshape(-1, 9)),
            "extents": rounded(shape.extents),
        },
    }


def _event_entries(scene: Scene) -> list[dict]:
    entries = [
        {
            "subject": event.subject.name,
            "verb": event.verb,
            "object": event.object.name if event.object else None,
            "frames": list(event.frames),
        }
        for event in scene.events
    ]
    return sorted(entries, key=lambda e: (e["frames"], e["subject"], e["verb"], e["object"] or ""))
