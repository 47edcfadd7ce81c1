"""Ground truth at all 97 frames: oriented boxes, exact distances between meshes, contact.

Reads the evaluated Blender scene (so that what it says is what is rendered) and returns plain numbers;
queries are proved from them.
"""

from __future__ import annotations

import gc
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import combinations

import bpy
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from .scene import Instance, Scene
from .timeline import FPS, FRAME_COUNT, LAST_FRAME

CONTACT_M = 0.005  # closer than this is contact ...
RELEASE_M = 0.010  # ... which lasts until they are further apart than this
# Pairs that never come closer have no distances; a bit more than what counts as beside at each scale.
PAIR_REACH_M = {"outdoor": 1.2, "room": 0.8, "tabletop": 0.5}
_STATIC = 1e-6
_EDGE_SAMPLE_M = 0.03
_EDGE_SAMPLES_MAX = 4000
_CLUSTER = 24


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
        "variant": scene.variant,
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
    that do (and those that interact) are measured at all frames, so that every surface is prepared once.
    """
    acting = {frozenset((e.subject.name, e.object.name)) for e in scene.events if e.object is not None}
    bodies = {shape.instance.name: _Body(shape) for shape in shapes}
    candidates = [
        _Pair(bodies[a.instance.name], bodies[b.instance.name])
        for a, b in combinations(shapes, 2)
        if "object" in (a.instance.role, b.instance.role)
        or frozenset((a.instance.name, b.instance.name)) in acting
    ]
    reach_m = PAIR_REACH_M[scene.scale]
    with collector_paused():
        found = [pair for pair in candidates if pair.names in acting or pair.comes_within(reach_m)]
        for frame in range(FRAME_COUNT):
            for pair in found:
                pair.measure(frame, np.inf)
    return [
        {
            "a": pair.a.shape.instance.name,
            "b": pair.b.shape.instance.name,
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
        parts = []
        for obj in self._objects:
            evaluated = obj.evaluated_get(depsgraph)
            local = self._rigid.get(obj.name)
            if local is None:
                local = _vertices(evaluated.data)
            matrix = np.array(evaluated.matrix_world, dtype=np.float64)
            parts.append(local @ matrix[:3, :3].T + matrix[:3, 3])
        return np.concatenate(parts)


class _Body:
    """A shape made ready for distance queries: BVH and query points of the frame that was asked for last.

    Query points are vertices and points along long edges, in clusters of neighbours: a cluster whose centre
    is further away than its radius plus the best distance so far needs no second look.
    """

    def __init__(self, shape: Shape) -> None:
        self.shape = shape
        self.tree: BVHTree
        self.points: np.ndarray
        self.centres: np.ndarray
        self.radii: np.ndarray
        self._triangles = shape.triangles.tolist()
        self._edges = _edge_samples(shape.points[0], shape.triangles)
        self._order, self.offsets = _clusters(self._query_points(shape.points[0]))
        self._frame: int | None = None

    def index(self, frame: int) -> int:
        """Where a frame is in the shape's arrays."""
        return 0 if self.shape.static else frame

    def move_to(self, frame: int) -> None:
        """Rebuilds what depends on the frame."""
        frame = self.index(frame)
        if frame == self._frame:
            return
        vertices = self.shape.points[frame]
        self.tree = BVHTree.FromPolygons(vertices.tolist(), self._triangles, all_triangles=True)
        self.points = self._query_points(vertices)[self._order]
        sizes = np.diff(self.offsets)
        self.centres = np.add.reduceat(self.points, self.offsets[:-1]) / sizes[:, None]
        spokes = np.linalg.norm(self.points - np.repeat(self.centres, sizes, axis=0), axis=1)
        self.radii = np.maximum.reduceat(spokes, self.offsets[:-1])
        self._frame = frame

    def _query_points(self, vertices: np.ndarray) -> np.ndarray:
        first, second, t = self._edges
        return np.concatenate([vertices, vertices[first] * (1.0 - t) + vertices[second] * t])


class _Pair:
    """Two bodies and the distance between their surfaces, frame after frame (one frame if neither moves)."""

    def __init__(self, a: _Body, b: _Body) -> None:
        self.a, self.b = a, b
        self.names = frozenset((a.shape.instance.name, b.shape.instance.name))
        frames = 1 if a.shape.static and b.shape.static else FRAME_COUNT
        self.distances = [np.inf] * frames
        self._start_a = self._start_b = 0

    def comes_within(self, limit: float) -> bool:
        """Whether the surfaces are ever closer than `limit`; frames with near boxes are tried first."""
        gaps = [self._boxes_apart(frame) for frame in range(len(self.distances))]
        for frame in sorted(range(len(gaps)), key=gaps.__getitem__):
            if gaps[frame] >= limit:
                return False
            self.measure(frame, limit)
            if self.distances[frame] < np.inf:
                return True
        return False

    def measure(self, frame: int, limit: float) -> None:
        """Finds the distance at `frame` if it is not known and below `limit`; 0 if the surfaces intersect."""
        if frame >= len(self.distances) or self.distances[frame] < np.inf:
            return
        a, b = self.a, self.b
        i, j = a.index(frame), b.index(frame)
        gap = self._boxes_apart(frame)
        if gap >= limit:
            return
        a.move_to(frame)
        b.move_to(frame)
        if gap == 0.0 and a.tree.overlap(b.tree):
            self.distances[frame] = 0.0
            return
        best, self._start_a = _nearest(a, b, b.shape.low[j], b.shape.high[j], self._start_a, limit)
        best, self._start_b = _nearest(b, a, a.shape.low[i], a.shape.high[i], self._start_b, best)
        self.distances[frame] = best if best < limit else np.inf

    def _boxes_apart(self, frame: int) -> float:
        a, b = self.a.shape, self.b.shape
        i, j = self.a.index(frame), self.b.index(frame)
        return _gap(a.low[i], a.high[i], b.low[j], b.high[j])


def _gap(low_a: np.ndarray, high_a: np.ndarray, low_b: np.ndarray, high_b: np.ndarray) -> float:
    """Distance between two world-aligned boxes."""
    return float(np.linalg.norm(np.maximum(np.maximum(low_a - high_b, low_b - high_a), 0.0)))


def _nearest(
    source: _Body, target: _Body, low: np.ndarray, high: np.ndarray, start: int, limit: float
) -> tuple[float, int]:
    """Least distance below `limit` from the points of `source` to the surface of `target`, inside low..high.

    Also returns which point it was: in the next frame its distance is the first bound (`start`).
    """
    find = target.tree.find_nearest
    best, chosen = min(find(source.points[start])[3], limit), start
    apart = np.maximum(np.maximum(low - source.centres, source.centres - high), 0.0)
    near = np.nonzero(np.sqrt(np.einsum("ij,ij->i", apart, apart)) - source.radii < best)[0]
    bounds = []
    for cluster, centre, radius in zip(near.tolist(), source.centres[near], source.radii[near].tolist()):
        distance = find(centre, best + radius)[3]
        if distance is not None:
            bounds.append((distance - radius, cluster))
    for bound, cluster in sorted(bounds):
        if bound >= best:
            break
        first, last = source.offsets[cluster], source.offsets[cluster + 1]
        for i, point in enumerate(source.points[first:last].tolist(), start=int(first)):
            distance = find(point, best)[3]
            if distance is not None and distance < best:
                best, chosen = distance, i
    return best, chosen


def _clusters(points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """An order of the points, and the offsets in it of clusters of neighbours (median splits)."""
    parts, leaves = [np.arange(len(points))], []
    while parts:
        part = parts.pop()
        if len(part) <= _CLUSTER:
            leaves.append(part)
            continue
        axis = int(np.argmax(np.ptp(points[part], axis=0)))
        part = part[np.argsort(points[part, axis], kind="stable")]
        parts += [part[: len(part) // 2], part[len(part) // 2 :]]
    return np.concatenate(leaves), np.cumsum([0] + [len(leaf) for leaf in leaves])


def _edge_samples(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points along long edges, as (vertex, vertex, share): big faces have few vertices."""
    edges = np.unique(np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)
    lengths = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    step = max(_EDGE_SAMPLE_M, lengths.sum() / _EDGE_SAMPLES_MAX)
    counts = np.floor(lengths / step).astype(np.int64)
    chosen = np.repeat(np.arange(len(edges)), counts)
    within = np.arange(len(chosen)) - np.repeat(np.cumsum(counts) - counts, counts)
    t = (within + 1) / (counts[chosen] + 1)
    return edges[chosen, 0], edges[chosen, 1], t[:, None]


def _shape(instance: Instance, points: list[np.ndarray], triangles: np.ndarray, axes: np.ndarray) -> Shape:
    local = [p @ r for p, r in zip(points, axes)]
    low = np.array([p.min(axis=0) for p in local])
    high = np.array([p.max(axis=0) for p in local])
    centre = np.einsum("fij,fj->fi", axes, (low + high) / 2)
    extents = high - low
    moving = any(np.abs(p - points[0]).max() > _STATIC for p in points[1:])
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
