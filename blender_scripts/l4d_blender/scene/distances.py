"""Distances between the surfaces of posed bodies, frame after frame.

A surface is cut once into patches of neighbouring faces. At a frame the boxes of the patches bound from below
how near two bodies can be, and the points that were nearest in the frame before bound it from above; search
trees are built of the few faces in between and of nothing else. What is left out cannot change the result.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from mathutils.bvhtree import BVHTree
from mathutils.geometry import closest_point_on_tri

_EDGE_SAMPLE_M = 0.03
_EDGE_SAMPLES_MAX = 4000
_PATCH = 32  # faces in a patch
_GROUP = 32  # patches in a group
_LOOKS = 4  # frames at which neighbours are looked for
_MET = 16  # pairs of faces that are remembered to have met
_BLOCK = 4000  # pairs of patches that are looked at together
_SLACK_M = 1e-4  # search trees hold 32 bit numbers: a bound must not be sharper than they are
_CORNERS = [[3 * face, 3 * face + 1, 3 * face + 2] for face in range(1 << 12)]


class Boxes(NamedTuple):
    """World-aligned boxes, one row each."""

    low: np.ndarray
    high: np.ndarray

    @property
    def hull(self) -> Boxes:
        """The box round all of them."""
        return Boxes(self.low.min(axis=0)[None], self.high.max(axis=0)[None])

    def of(self, rows: np.ndarray | list[int]) -> Boxes:
        """Some of them."""
        return Boxes(self.low[rows], self.high[rows])

    def apart(self, other: Boxes) -> np.ndarray:
        """Distance from each (rows) to each of the others (columns)."""
        squares = np.zeros((len(self.low), len(other.low)))
        for axis in range(3):
            below = other.low[:, axis] - self.high[:, axis, None]
            gap = np.maximum(below, self.low[:, axis, None] - other.high[:, axis], out=below)
            np.maximum(gap, 0.0, out=gap)
            squares += np.multiply(gap, gap, out=gap)
        return np.sqrt(squares, out=squares)

    def middle(self, row: int) -> np.ndarray:
        """The middle of one of them."""
        return 0.5 * (self.low[row] + self.high[row])


class Pose(NamedTuple):
    """A body at a frame: its vertices, the boxes of its patches and of groups of patches."""

    vertices: np.ndarray
    patches: Boxes
    groups: Boxes
    whole: Boxes


class Nearest(NamedTuple):
    """Where two surfaces were nearest: a query point of one body and a face of the other."""

    on_first: bool
    point: int
    face: int


class Body:
    """A surface over time, cut into patches.

    Query points are vertices and points along long edges: big faces have few vertices.
    """

    def __init__(self, points: list[np.ndarray], triangles: np.ndarray) -> None:
        self._points = points
        self._poses: dict[int, Pose] = {}
        self._whole: tuple[BVHTree, np.ndarray] | None = None
        rest = points[0]
        loose = np.setdiff1d(np.arange(len(rest)), triangles)
        # Neighbours at several times: a hand on a knee is no part of the leg.
        often = np.concatenate(points[:: max(1, len(points) // _LOOKS)], axis=1)
        order, faces_in = _clusters(often[triangles].mean(axis=1), _PATCH)
        alone, loose_in = _clusters(often[loose], _PATCH)
        self.triangles = triangles[order]
        self._face_offsets = np.concatenate([[0], np.cumsum(faces_in), np.full(len(loose_in), len(order))])
        patch_of_face = np.repeat(np.arange(len(faces_in)), faces_in)
        corner_of = _unique_pairs(np.repeat(patch_of_face, 3), self.triangles.ravel())[0]
        patch_of_loose = len(faces_in) + np.repeat(np.arange(len(loose_in)), loose_in)
        corner_of = np.concatenate([corner_of, np.stack([patch_of_loose, loose[alone]], axis=1)])
        self._corners = corner_of[:, 1]
        count = len(faces_in) + len(loose_in)
        self._corner_offsets = _offsets(corner_of[:, 0], count)
        self._groups = np.arange(0, count, _GROUP)
        self._query(rest, corner_of, patch_of_face, count)

    @property
    def static(self) -> bool:
        """Whether it is the same at all frames."""
        return len(self._points) == 1

    def pose(self, frame: int) -> Pose:
        """The body at a frame."""
        frame = 0 if self.static else frame
        if frame not in self._poses:
            vertices = self._points[frame]
            corners = np.ascontiguousarray(vertices[self._corners].T)
            low = np.minimum.reduceat(corners, self._corner_offsets[:-1], axis=1).T
            high = np.maximum.reduceat(corners, self._corner_offsets[:-1], axis=1).T
            groups = Boxes(np.minimum.reduceat(low, self._groups), np.maximum.reduceat(high, self._groups))
            self._poses[frame] = Pose(vertices, Boxes(low, high), groups, groups.hull)
        return self._poses[frame]

    def patches_in(self, groups: np.ndarray) -> np.ndarray:
        """The patches of some groups."""
        patches = (groups[:, None] * _GROUP + np.arange(_GROUP)).ravel()
        return patches[patches < len(self._corner_offsets) - 1]

    def near_vertex(self, pose: Pose, at: np.ndarray) -> tuple[np.ndarray, float]:
        """A vertex that is near a point, and how far it is from there: the nearest of the nearest patches."""
        apart = pose.patches.apart(Boxes(at[None], at[None]))[:, 0]
        few = min(4, len(apart))
        patches = np.argpartition(apart, few - 1)[:few]
        points = pose.vertices[self._corners[_ranges(self._corner_offsets, patches)]]
        way = points - at
        squares = np.einsum("ij,ij->i", way, way)
        nearest = int(squares.argmin())
        return points[nearest], float(np.sqrt(squares[nearest]))

    def is_loose(self, patches: np.ndarray) -> np.ndarray:
        """Which of some patches have vertices alone."""
        return self._face_offsets[patches] == self._face_offsets[patches + 1]

    def patch_of(self, faces: np.ndarray) -> np.ndarray:
        """The patches that faces are in."""
        return np.searchsorted(self._face_offsets, faces, side="right") - 1

    def query_points_of(self, patches: np.ndarray) -> np.ndarray:
        """The numbers of the query points that some patches have."""
        return _ranges(self._point_offsets, patches)

    def query_points(self, pose: Pose, points: np.ndarray | int) -> np.ndarray:
        """Where query points are."""
        t = self._share[points]
        return pose.vertices[self._from[points]] * (1.0 - t) + pose.vertices[self._to[points]] * t

    def tree(self, pose: Pose, patches: np.ndarray) -> tuple[BVHTree, np.ndarray]:
        """A search tree of the faces of some patches (at least), and which faces these are.

        What never moves has one tree of all its faces.
        """
        if not self.static:
            return self._planted(pose, _ranges(self._face_offsets, patches))
        if self._whole is None:
            self._whole = self._planted(pose, np.arange(len(self.triangles)))
        return self._whole

    def _planted(self, pose: Pose, faces: np.ndarray) -> tuple[BVHTree, np.ndarray]:
        corners = pose.vertices[self.triangles[faces].ravel()].tolist()
        polygons = _CORNERS[: len(faces)]
        if len(polygons) < len(faces):
            polygons = np.arange(3 * len(faces)).reshape(-1, 3).tolist()
        return BVHTree.FromPolygons(corners, polygons, all_triangles=True), faces

    def _query(self, rest: np.ndarray, corner_of: np.ndarray, patch_of_face: np.ndarray, count: int) -> None:
        """Gives every query point to one of the patches that it is on."""
        vertices, first_use = np.unique(corner_of[:, 1], return_index=True)
        ends = self.triangles.ravel(), np.roll(self.triangles, -1, axis=1).ravel()
        edges, first_face = _unique_pairs(np.minimum(*ends), np.maximum(*ends))
        chosen, t = _edge_samples(rest, edges)
        patch = np.concatenate([corner_of[first_use, 0], patch_of_face[first_face[chosen] // 3]])
        order = np.argsort(patch, kind="stable")
        self._from = np.concatenate([vertices, edges[chosen, 0]])[order]
        self._to = np.concatenate([vertices, edges[chosen, 1]])[order]
        self._share = np.concatenate([np.zeros(len(vertices)), t])[order][:, None]
        self._point_offsets = _offsets(patch[order], count)


class Gap:
    """Finds the distance between two bodies; frames are best asked for in order."""

    def __init__(self, first: Body, second: Body) -> None:
        self.first, self.second = first, second
        self._nearest: Nearest | None = None
        self._met: tuple[np.ndarray, np.ndarray] | None = None  # patches that met last

    def at(self, frame: int, limit: float = np.inf) -> float:
        """The distance at a frame if it is below `limit`, else infinity; 0 if the surfaces meet."""
        a, b = self.first.pose(frame), self.second.pose(frame)
        if self._met is not None and self._meet(a, b, *self._met):
            return 0.0
        bound = min(limit, self._bound(a, b)) + _SLACK_M
        rows, columns, apart = self._between(a, b, bound)
        if not len(rows):
            return np.inf
        touching = _nearer(rows, columns, apart, 0.0)
        if touching[2].size and self._meet(a, b, *touching[:2]):
            return 0.0
        ours, theirs = (self.first, a, rows), (self.second, b, columns)
        if (self.first.static, len(columns)) > (self.second.static, len(rows)):  # theirs is the cheaper tree
            ours, theirs, apart = theirs, ours, apart.T
        best, kept = self._search(*ours, *theirs, bound)
        near = apart <= best + _SLACK_M
        loose = theirs[0].is_loose(theirs[2])  # no faces that patches of ours could be near to
        kept = np.union1d(kept, np.nonzero(near[:, loose].any(axis=1))[0])
        if len(kept):
            columns = theirs[2][near[kept].any(axis=0)]
            best, _ = self._search(*theirs[:2], columns, *ours[:2], ours[2][kept], best)
        assert best < bound or limit < bound, "the bound is a distance of two points"
        return best if best < limit else np.inf

    def _search(
        self,
        body: Body,
        pose: Pose,
        patches: np.ndarray,
        other: Body,
        other_pose: Pose,
        others: np.ndarray,
        best: float,
    ) -> tuple[float, np.ndarray]:
        """The least distance below `best` from query points of patches of a body to faces of the other's.

        Remembers the point and the face. Also gives the rows of the patches that may be as near as that.
        """
        tree, faces = other.tree(other_pose, others)
        rows, bounds = _sifted(pose.patches.of(patches), tree, best)
        boxes, found = other_pose.patches.of(others), None
        for block in np.array_split(patches[rows], 1 + len(rows) * len(others) // _BLOCK):
            numbers = body.query_points_of(block)
            points = body.query_points(pose, numbers)
            least = Boxes(points, points).apart(boxes).min(axis=1)
            order = np.argsort(least, kind="stable")
            order = order[: np.searchsorted(least[order], best + _SLACK_M, side="right")]
            for bound, number, point in zip(
                least[order].tolist(), numbers[order].tolist(), points[order].tolist()
            ):
                if bound > best + _SLACK_M:
                    break
                _, _, face, distance = tree.find_nearest(point, best)
                if distance is not None and distance < best:
                    best, found = distance, (number, face)
        if found is not None:
            self._nearest = Nearest(body is self.first, found[0], int(faces[found[1]]))
        return best, rows[bounds <= best + _SLACK_M]

    def _meet(self, a: Pose, b: Pose, rows: np.ndarray, columns: np.ndarray) -> bool:
        """Whether faces of these patches intersect; remembers a few that do."""
        tree_a, faces_a = self.first.tree(a, rows)
        tree_b, faces_b = self.second.tree(b, columns)
        met = tree_a.overlap(tree_b)
        if not met:
            self._met = None
            return False
        if self._met is None or len(met) < _MET // 4:
            some = np.array(met[:: max(1, len(met) // _MET)])
            self._met = (
                np.unique(self.first.patch_of(faces_a[some[:, 0]])),
                np.unique(self.second.patch_of(faces_b[some[:, 1]])),
            )
        return True

    def _bound(self, a: Pose, b: Pose) -> float:
        """No more than this: to and fro between near vertices, from where the bodies were nearest last."""
        best = np.inf
        if self._nearest is not None:
            at, best = self._still(a, b, self._nearest)
        else:
            at = a.patches.middle(int(a.patches.apart(b.whole)[:, 0].argmin()))
        last = np.inf
        for turn in range(8):
            body, pose = ((self.second, b), (self.first, a))[turn % 2]
            at, distance = body.near_vertex(pose, at)
            if turn > 1 and distance >= last:
                break
            if turn > 0:
                best = min(best, distance)
            last = distance
        return best

    def _still(self, a: Pose, b: Pose, last: Nearest) -> tuple[np.ndarray, float]:
        """Where on the first body they were nearest last, and how far that is from the face now."""
        body, pose, other, other_pose = self.first, a, self.second, b
        if not last.on_first:
            body, pose, other, other_pose = other, other_pose, body, pose
        point = body.query_points(pose, last.point)
        nearest = np.array(closest_point_on_tri(point, *other_pose.vertices[other.triangles[last.face]]))
        return (point if last.on_first else nearest), float(np.linalg.norm(nearest - point))

    def _between(self, a: Pose, b: Pose, bound: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Patches of both that may be nearer than `bound`, and how far their boxes are apart."""
        groups = a.groups.apart(b.groups) <= bound
        rows = self.first.patches_in(np.nonzero(groups.any(axis=1))[0])
        columns = self.second.patches_in(np.nonzero(groups.any(axis=0))[0])
        for _ in range(2):
            if not len(rows) or not len(columns):
                break
            rows = rows[a.patches.of(rows).apart(b.patches.of(columns).hull)[:, 0] <= bound]
            if len(rows):
                columns = columns[b.patches.of(columns).apart(a.patches.of(rows).hull)[:, 0] <= bound]
        if not len(rows) or not len(columns):
            return rows[:0], columns[:0], np.empty((0, 0))
        return _nearer(rows, columns, a.patches.of(rows).apart(b.patches.of(columns)), bound)


def _sifted(boxes: Boxes, tree: BVHTree, limit: float) -> tuple[np.ndarray, np.ndarray]:
    """Which boxes may be within `limit` of a tree, the nearest first, and how far they are from it at least.

    Judged by their middles: boxes round long faces that are askew look nearer than they are.
    """
    middles = 0.5 * (boxes.low + boxes.high)
    radii = 0.5 * np.linalg.norm(boxes.high - boxes.low, axis=1)
    rows, bounds = [], []
    for row, (middle, radius) in enumerate(zip(middles.tolist(), radii.tolist())):
        distance = tree.find_nearest(middle, limit + radius + _SLACK_M)[3]
        if distance is not None:
            rows.append(row)
            bounds.append(distance - radius)
    order = np.argsort(bounds, kind="stable")
    return np.array(rows, dtype=np.int64)[order], np.array(bounds)[order]


def _nearer(
    rows: np.ndarray, columns: np.ndarray, apart: np.ndarray, bound: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What is left without rows and columns of which nothing is as near as `bound`."""
    near = apart <= bound
    keep, other = near.any(axis=1), near.any(axis=0)
    return rows[keep], columns[other], apart[np.ix_(keep, other)]


def _clusters(points: np.ndarray, most: int) -> tuple[np.ndarray, list[int]]:
    """An order of the points in which neighbours are together, and how many are in each cluster.

    Median splits, in any number of dimensions.
    """
    parts, leaves = [np.arange(len(points))], []
    while parts:
        part = parts.pop()
        if len(part) <= most:
            leaves.append(part)
            continue
        axis = int(np.argmax(np.ptp(points[part], axis=0)))
        part = part[np.argsort(points[part, axis], kind="stable")]
        parts += [part[: len(part) // 2], part[len(part) // 2 :]]
    return np.concatenate(leaves), [len(leaf) for leaf in leaves if len(leaf)]


def _unique_pairs(first: np.ndarray, second: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The different pairs of two columns, sorted, and where each comes first."""
    width = int(second.max()) + 1
    keys, where = np.unique(first.astype(np.int64) * width + second, return_index=True)
    return np.stack(np.divmod(keys, width), axis=1), where


def _offsets(sorted_keys: np.ndarray, count: int) -> np.ndarray:
    return np.searchsorted(sorted_keys, np.arange(count + 1))


def _ranges(offsets: np.ndarray, chosen: np.ndarray) -> np.ndarray:
    """All numbers from offsets[c] up to offsets[c + 1], for each chosen c."""
    first, counts = offsets[chosen], offsets[chosen + 1] - offsets[chosen]
    ends = np.cumsum(counts)
    return np.arange(counts.sum()) + np.repeat(first - (ends - counts), counts)


def _edge_samples(points: np.ndarray, edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points along long edges: which edge, and at which share of it."""
    lengths = np.linalg.norm(points[edges[:, 0]] - points[edges[:, 1]], axis=1)
    step = max(_EDGE_SAMPLE_M, lengths.sum() / _EDGE_SAMPLES_MAX)
    counts = np.floor(lengths / step).astype(np.int64)
    chosen = np.repeat(np.arange(len(edges)), counts)
    within = np.arange(len(chosen)) - np.repeat(np.cumsum(counts) - counts, counts)
    return chosen, (within + 1) / (counts[chosen] + 1)
