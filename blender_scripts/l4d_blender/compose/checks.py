"""What a composed scene must not be: things in each other, things that float, things that no one can see.

Judges what was measured of the evaluated scene, whatever the theme intended.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from ..worker import tracks, visibility
from .errors import Rejected
from .stage import Stage

DEPTH_M = {"tabletop": 0.004, "room": 0.02, "outdoor": 0.03}
"""How deep one thing may be inside another: motion code presses flesh a little into what it grips."""
_FRAMES = range(0, 97, 8)


def collisions(stage: Stage, shapes: list[tracks.Shape]) -> None:
    """Rejects a scene in which two instances that have nothing to do with each other are in each other."""
    acting = {
        frozenset((event.subject.name, event.object.name))
        for event in stage.scene.events
        if event.object is not None
    }
    limit_m = DEPTH_M[stage.scene.scale]
    pairs = [
        (a, b)
        for a, b in combinations(shapes, 2)
        if (names := frozenset((a.instance.name, b.instance.name))) not in acting
        and names not in stage.allowed_contact
    ]
    with tracks.collector_paused():
        for frame in _FRAMES:
            trees: dict[str, BVHTree] = {}
            for a, b in pairs:
                if frame > 0 and a.static and b.static:
                    continue
                depth_m = max(_depth(a, b, frame, trees), _depth(b, a, frame, trees))
                if depth_m > limit_m:
                    raise Rejected(
                        f"{a.instance.name} and {b.instance.name} are {100 * depth_m:.1f} cm in each other "
                        f"at frame {frame}"
                    )


def unseen(seen: visibility.Visibility, test: str) -> None:
    """Rejects a scene in which an object is hidden from the held-out camera or from most others."""
    found = visibility.warnings(seen, test)
    if found:
        raise Rejected(found[0][0])


def _depth(inner: tracks.Shape, outer: tracks.Shape, frame: int, trees: dict[str, BVHTree]) -> float:
    """How deep points of one surface are below another's, in metres; 0 if they are apart.

    `trees` keeps what was built for the same frame.
    """
    i, j = (0 if shape.static else frame for shape in (inner, outer))
    low, high = outer.low[j], outer.high[j]
    if np.any(inner.low[i] > high) or np.any(inner.high[i] < low):
        return 0.0
    points = inner.points[i]
    points = points[np.all((points > low) & (points < high), axis=1)]
    if not len(points):
        return 0.0
    name = outer.instance.name
    if name not in trees:
        trees[name] = BVHTree.FromPolygons(
            outer.points[j].tolist(), outer.triangles.tolist(), all_triangles=True
        )
    tree = trees[name]
    step = max(1, len(points) // 400)
    deepest = 0.0
    for point in points[::step].tolist():
        nearest, normal, _, distance = tree.find_nearest(point)
        if nearest is None or distance <= deepest:
            continue
        if (Vector(point) - nearest).dot(normal) < -0.7 * distance and _is_inside(tree, Vector(point)):
            deepest = distance
    return deepest


def _is_inside(tree: BVHTree, point: Vector) -> bool:
    """By the parity of what a ray meets, for most of three rays: surfaces may have small holes."""
    votes = 0
    for way in (Vector((0.31, 0.17, 0.94)), Vector((-0.62, 0.41, 0.67)), Vector((0.23, -0.71, 0.66))):
        start, hits = point, 0
        while hits < 64:
            hit, _, _, _ = tree.ray_cast(start, way)
            if hit is None:
                break
            hits += 1
            start = hit + way * 1e-5
        votes += hits % 2
    return votes >= 2
