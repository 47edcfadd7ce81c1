"""Small things are looked at from near: a piece of a table to put them on, and the cameras moved in on it."""

from __future__ import annotations

import random
from dataclasses import replace
from math import hypot

from mathutils import Matrix, Vector

from ..areas import Area, Flat
from ..stage import Stage

_NEAREST = 0.62  # of the distance that the place chose


def piece(rng: random.Random, table: Area, size_m: tuple[float, float]) -> Area:
    """A random piece of an area, of a size or a bit more; what takes room on the area takes it there too."""
    a, b, _, d = table.corners
    grow = rng.uniform(1.0, 1.25)
    size_m = size_m[0] * grow, size_m[1] * grow
    along, across = _between(a, b), _between(a, d)
    shares = min(size_m[0] / hypot(*along), 1.0), min(size_m[1] / hypot(*across), 1.0)
    u, v = (rng.uniform(0.0, 1.0 - share) for share in shares)
    corners = [
        (a[0] + s * along[0] + t * across[0], a[1] + s * along[1] + t * across[1])
        for s, t in ((u, v), (u + shares[0], v), (u + shares[0], v + shares[1]), (u, v + shares[1]))
    ]
    return Area(table.name, corners, table.on, list(table.taken))


def move_in(stage: Stage, table: Area, part: Area) -> None:
    """Moves the rig so that it sees a piece as it saw the whole area, as near as the piece's size allows.

    From then on the piece is the area: what takes room there isn't known to the whole.
    """
    share = max(
        hypot(*_between(part.corners[k], part.corners[k + 1]))
        / hypot(*_between(table.corners[k], table.corners[k + 1]))
        for k in (0, 1)
    )
    share = max(_NEAREST, min(1.0, 0.06 + share))
    here, there = Vector(table.point(*table.centre)), Vector(part.point(*part.centre))
    moved = Matrix.Translation(there) @ Matrix.Scale(share, 4) @ Matrix.Translation(-here)
    rig = []
    for camera in stage.scene.camera_rig:
        pose = camera.world_from_camera.copy()
        pose.translation = Vector([round(x, 6) for x in moved @ pose.translation])
        rig.append(replace(camera, world_from_camera=pose))
    stage.film(rig)
    stage.areas[table.name] = part


def _between(a: Flat, b: Flat) -> Flat:
    return b[0] - a[0], b[1] - a[1]
