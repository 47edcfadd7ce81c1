"""Finger poses, and how fingers find the surface of what they take.

A pose is an array of five digits (thumb first) by four angles in radians: sideways (opposition of the
thumb), then the bend of the three joints. Everything is in right-hand
space. Knows shapes and distances; knows no time.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

import bpy
import numpy as np
from mathutils import Vector
from mathutils.bvhtree import BVHTree

from ..assets.anatomy import FINGERS, vec
from ..assets.hand import DIGITS, JOINTS, RADII, thumb_up
from ..scene import keys
from .ik import turn_about, turn_y, turn_z

Pose: TypeAlias = np.ndarray
TOUCH_M = 0.0003


def _pose(thumb: Sequence[float], *fingers: Sequence[float]) -> Pose:
    rows = [thumb, *(fingers if len(fingers) == 4 else fingers * 4)]
    return np.array(rows, float)


POSES: dict[str, Pose] = {
    "flat": _pose((0.06, 0.0, 0.02, 0.06), (0.0, 0.04, 0.05, 0.03)),
    "relaxed": _pose(
        (0.34, 0.06, 0.18, 0.22),
        (0.0, 0.22, 0.34, 0.18),
        (0.0, 0.28, 0.40, 0.22),
        (0.0, 0.34, 0.44, 0.24),
        (0.0, 0.38, 0.44, 0.26),
    ),
    "point": _pose(
        (0.85, 0.30, 0.50, 0.45),
        (0.0, 0.04, 0.06, 0.04),
        (0.0, 1.35, 1.60, 0.95),
        (0.0, 1.38, 1.62, 0.95),
        (0.0, 1.38, 1.60, 0.95),
    ),
    "fist": _pose((0.95, 0.30, 0.55, 0.60), (0.0, 1.40, 1.65, 1.00)),
    "open_wide": _pose(
        (0.30, -0.30, -0.05, 0.05),
        (0.10, 0.10, 0.22, 0.12),
        (0.0, 0.10, 0.22, 0.12),
        (-0.08, 0.12, 0.24, 0.14),
        (-0.16, 0.14, 0.26, 0.16),
    ),
    "wrapped": _pose((1.00, 0.22, 0.50, 0.75), (0.0, 1.40, 1.60, 1.00)),
    "mouse_open": _pose(
        (0.42, -0.12, 0.05, 0.12),
        (0.03, 0.02, 0.14, 0.10),
        (-0.02, 0.02, 0.14, 0.10),
        (-0.10, 0.10, 0.20, 0.14),
        (-0.22, 0.14, 0.22, 0.16),
    ),
    "mouse_closed": _pose(
        (0.62, 0.42, 0.40, 0.55),
        (0.03, 0.62, 0.80, 0.50),
        (-0.02, 0.62, 0.80, 0.50),
        (-0.06, 0.95, 0.95, 0.60),
        (-0.14, 1.00, 0.95, 0.60),
    ),
    "pinch_open": _pose(
        (0.95, -0.05, 0.10, 0.18),
        (0.0, 0.62, 0.42, 0.22),
        (0.0, 0.66, 0.46, 0.24),
        (0.0, 0.55, 0.55, 0.30),
        (0.0, 0.50, 0.55, 0.30),
    ),
    "pinch_closed": _pose(
        (1.15, 0.22, 0.42, 0.55),
        (0.0, 1.05, 0.85, 0.45),
        (0.0, 1.10, 0.90, 0.48),
        (0.0, 0.75, 0.85, 0.45),
        (0.0, 0.66, 0.85, 0.45),
    ),
}


def digit_frames(digit: str, angles: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
    """Joint positions (4) and rotations from rest (3) of one digit, in the hand's frame."""
    rest = JOINTS[digit]
    if digit == "thumb":
        way = rest[3] - rest[2]
        hinge = np.cross(way, -thumb_up())
        rotation = turn_y(angles[0])
    else:
        hinge = np.cross(rest[1] - rest[0], vec(0, 0, -1))
        rotation = turn_z(angles[0])
    joints, rotations = [rest[0]], []
    for n in range(3):
        rotation = rotation @ turn_about(hinge, angles[n + 1])
        rotations.append(rotation)
        joints.append(joints[-1] + rotation @ (rest[n + 1] - rest[n]))
    return np.array(joints), rotations


def digit_samples(digit: str, angles: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points along the phalanges, their flesh radii and the phalanx of each."""
    joints, _ = digit_frames(digit, angles)
    radii, points, sizes, phalanx = RADII[digit], [], [], []
    for n in range(3):
        for t in (0.35, 0.65, 0.97) if n < 2 else (0.35, 0.62, 0.86):
            points.append(joints[n] + t * (joints[n + 1] - joints[n]))
            sizes.append(radii[n] + t * (radii[n + 1] - radii[n]))
            phalanx.append(n)
    return np.array(points), np.array(sizes), np.array(phalanx)


def palm_samples(pose: Pose) -> tuple[np.ndarray, np.ndarray]:
    """Balls that fill the underside of the palm and the first phalanges of the fingers."""
    points = [
        vec(0.020, -0.030, -0.012),
        vec(0.024, -0.055, -0.010),
        vec(-0.023, -0.028, -0.010),
        vec(-0.026, -0.055, -0.008),
        vec(0.0, -0.055, -0.002),
        vec(0.0, -0.075, -0.001),
    ]
    sizes = [0.0140, 0.0115, 0.0125, 0.0115, 0.0105, 0.0105]
    for n, digit in enumerate(FINGERS):
        p, r, phalanx = digit_samples(digit, pose[n + 1])
        points += [JOINTS[digit][0] + vec(0, 0, -0.002), *p[phalanx == 0]]
        sizes += [0.0115, *r[phalanx == 0]]
    return np.array(points), np.array(sizes)


class Solid:
    """The surface of something at one frame, to measure distances from."""

    def __init__(self, objects: Sequence[bpy.types.Object], frame: float) -> None:
        verts: list[Vector] = []
        polygons: list[tuple[int, ...]] = []
        for obj in objects:
            matrix, count = keys.object_matrix(obj, frame), len(verts)
            verts += [matrix @ v.co for v in obj.data.vertices]
            polygons += [tuple(v + count for v in p.vertices) for p in obj.data.polygons]
        self.tree = BVHTree.FromPolygons(verts, polygons)
        points = np.array(verts)
        self.low, self.high = points.min(axis=0), points.max(axis=0)
        self.centre = 0.5 * (self.low + self.high)

    def distance(self, points: np.ndarray) -> np.ndarray:
        """Metres to the surface; negative inside."""
        out = np.empty(len(points))
        for n, p in enumerate(points):
            hit, normal, _, gap = self.tree.find_nearest(Vector(p))
            out[n] = gap if (Vector(p) - hit).dot(normal) >= 0.0 else -gap
        return out


class Placed:
    """A hand at one place in the world: maps right-hand space to it (mirrored for left hands)."""

    def __init__(self, matrix: np.ndarray, side: str, scale: float, table_m: float) -> None:
        self.matrix, self.scale, self.table_m = matrix.copy(), scale, table_m
        self.mirror = vec(-1, 1, 1) if side == "l" else vec(1, 1, 1)

    def world(self, points: np.ndarray) -> np.ndarray:
        """World positions of points in right-hand space."""
        return (points * self.mirror * self.scale) @ self.matrix[:3, :3].T + self.matrix[:3, 3]

    def clearance(self, solid: Solid, points: np.ndarray, radii: np.ndarray) -> np.ndarray:
        """Free space round balls of flesh: to the thing and to the table top."""
        at = self.world(points)
        return np.minimum(solid.distance(at), at[:, 2] - self.table_m) - radii * self.scale

    def advance(self, solid: Solid, pose: Pose, way: np.ndarray, reach_m: float, tips: bool = False) -> float:
        """Moves along `way` until flesh touches; returns the distance gone."""
        points, radii = palm_samples(pose)
        if tips:
            extra = [digit_samples(d, pose[n])[:2] for n, d in enumerate(DIGITS) if n > 0]
            points = np.vstack([points, *[p for p, _ in extra]])
            radii = np.concatenate([radii, *[r for _, r in extra]])
        gone = 0.0
        for _ in range(60):
            at = self.world(points)
            free = float(np.min(solid.distance(at) - radii * self.scale))
            if free < TOUCH_M or gone >= reach_m:
                break
            step = min(max(free, 0.0004), reach_m - gone)
            self.matrix[:3, 3] += way * step
            gone += step
        return gone

    def close(
        self, solid: Solid, start: Pose, end: Pose, digits: Sequence[str] = DIGITS, steps: int = 48
    ) -> Pose:
        """Bends each digit from `start` towards `end`; a phalanx that touches stops its joints."""
        pose = start.copy()
        for n, digit in enumerate(DIGITS):
            if digit not in digits:
                continue
            angles, frozen = start[n].copy(), -1
            for step in range(1, steps + 1):
                trial = angles.copy()
                goal = start[n] + (end[n] - start[n]) * step / steps
                trial[0] = goal[0] if frozen < 0 else angles[0]
                for joint in range(frozen + 1, 3):
                    trial[joint + 1] = goal[joint + 1]
                points, radii, phalanx = digit_samples(digit, trial)
                touching = phalanx[self.clearance(solid, points, radii) < TOUCH_M]
                touching = touching[touching > frozen]
                if len(touching):
                    frozen = int(touching.max())
                    if frozen == 2:
                        break
                    continue
                angles = trial
            pose[n] = angles
        return pose
