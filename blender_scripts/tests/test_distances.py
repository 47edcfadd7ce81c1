"""Distances between surfaces: what patches and bounds leave out changes nothing."""

from __future__ import annotations

import bpy  # noqa: F401  brings mathutils
import numpy as np
import pytest

from l4d_blender.scene.distances import Body, Gap

FRAMES = 12


def _ball(rings: int, radius_m: float) -> tuple[np.ndarray, np.ndarray]:
    """A sphere of triangles."""
    turns = 2 * rings
    polar, around = np.meshgrid(np.linspace(0, np.pi, rings), 2 * np.pi * np.arange(turns) / turns)
    points = radius_m * np.stack(
        [np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar)], axis=-1
    ).reshape(-1, 3)
    corner = np.arange(turns)[:, None] * rings + np.arange(rings - 1)
    beside = np.roll(np.arange(turns), -1)[:, None] * rings + np.arange(rings - 1)
    faces = [
        np.stack(each, axis=-1) for each in ((corner, beside, beside + 1), (corner, beside + 1, corner + 1))
    ]
    return points, np.concatenate(faces).reshape(-1, 3)


def _plank() -> tuple[np.ndarray, np.ndarray]:
    """A long box of twelve faces, askew, and a vertex that no face has."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-0.1, 0.1) for z in (-0.02, 0.02)], float)
    a = 0.7
    turn = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    faces = [tri for a, b, c, d in quads for tri in ((a, b, c), (a, c, d))]
    return np.concatenate([corners @ turn.T, [[0.0, 0.0, 0.3]]]), np.array(faces)


def _moved(points: np.ndarray, start: tuple[float, ...], end: tuple[float, ...]) -> list[np.ndarray]:
    """Moving in a line while it is bent more and more."""
    frames = []
    for t in np.linspace(0.0, 1.0, FRAMES):
        bent = points.copy()
        bent[:, 0] += 0.3 * t * points[:, 2] ** 2
        frames.append(bent + np.array(start) + t * (np.array(end) - np.array(start)))
    return frames


def _all(first: Body, second: Body, frame: int) -> float:
    """Every query point against every face, both ways."""
    bodies = [
        (body, body.pose(frame), np.arange(len(body.pose(frame).patches.low))) for body in (first, second)
    ]
    trees = [body.tree(pose, patches)[0] for body, pose, patches in bodies]
    if trees[0].overlap(trees[1]):
        return 0.0
    return min(
        tree.find_nearest(point)[3]
        for (body, pose, patches), tree in zip(bodies, reversed(trees))
        for point in body.query_points(pose, body.query_points_of(patches)).tolist()
    )


@pytest.mark.parametrize(
    ("start", "end"),
    [
        ((1.2, 0.2, 0.1), (0.7, 0.9, 0.3)),  # comes near
        ((0.9, 0.2, 0.5), (-0.2, 0.0, 0.1)),  # goes through
        ((0.1, 0.1, 0.0), (2.5, 3.0, 1.0)),  # comes out
        ((3.0, 0.0, 0.0), (-3.0, 0.5, 0.6)),  # flies past, a long way from frame to frame
    ],
)
@pytest.mark.parametrize("still", [_plank(), _ball(40, 0.4)], ids=["plank", "ball"])
def test_a_distance_is_the_least_over_all_points_and_faces(still, start, end):
    points, faces = _ball(24, 0.25)
    first, second = Body([still[0]], still[1]), Body(_moved(points, start, end), faces)
    expected = [_all(first, second, frame) for frame in range(FRAMES)]
    gap = Gap(first, second)
    assert [gap.at(frame) for frame in range(FRAMES)] == expected
    limit = float(np.median(expected)) + 0.01
    for frame in (7, 0, 11, 3):  # out of order, each for the first time
        known = expected[frame] if expected[frame] < limit else np.inf
        assert Gap(first, second).at(frame, limit) == known
        assert gap.at(frame) == expected[frame]


def test_query_points_are_all_vertices_and_points_along_long_edges():
    points, faces = _plank()
    body = Body([points], faces)
    pose = body.pose(0)
    found = body.query_points(pose, body.query_points_of(np.arange(len(pose.patches.low))))
    for vertex in points:
        assert np.linalg.norm(found - vertex, axis=1).min() == 0.0
    along = 0.37 * points[0] + 0.63 * points[4]  # the long edges are 2 m
    assert np.linalg.norm(found - along, axis=1).min() <= 0.03
    assert (np.bincount(np.unique(found, axis=0, return_inverse=True)[1]) == 1).all(), "each of them once"


def test_a_vertex_without_a_face_counts():
    points, faces = _plank()
    ball, ball_faces = _ball(16, 0.1)
    gap = Gap(Body([points], faces), Body([ball + np.array([0.0, 0.0, 0.45])], ball_faces))
    assert gap.at(0) == pytest.approx(0.05, abs=1e-3)
