"""Rotations and two-bone limbs in numpy: the arithmetic under every body that acts.

Knows triangles and frames of axes; refuses to know whose limbs they are. Radians and metres.
"""

from __future__ import annotations

import numpy as np


def unit(v: np.ndarray) -> np.ndarray:
    """A vector of length one."""
    return v / max(float(np.linalg.norm(v)), 1e-12)


def turn_x(angle: float) -> np.ndarray:
    """Rotation about X."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]])


def turn_y(angle: float) -> np.ndarray:
    """Rotation about Y."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def turn_z(angle: float) -> np.ndarray:
    """Rotation about Z."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def turn_about(axis: np.ndarray, angle: float) -> np.ndarray:
    """Rotation about any axis."""
    x, y, z = unit(axis)
    c, s = np.cos(angle), np.sin(angle)
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + s * k + (1.0 - c) * (k @ k)


def rotation_vector(r: np.ndarray) -> np.ndarray:
    """Axis times angle of a rotation matrix."""
    skew = np.array([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]])
    sine, cosine = 0.5 * float(np.linalg.norm(skew)), 0.5 * (float(np.trace(r)) - 1.0)
    angle = float(np.arctan2(sine, cosine))
    if sine > 1e-7:
        return skew * (angle / (2.0 * sine))
    if cosine > 0.0:
        return np.zeros(3)
    column = int(np.argmax(np.diag(r)))
    axis = (r + np.eye(3))[:, column]
    return unit(axis) * np.pi


def between(a: np.ndarray, b: np.ndarray, t: float) -> np.ndarray:
    """The rotation at t on the short way from a to b."""
    way = rotation_vector(a.T @ b)
    angle = float(np.linalg.norm(way))
    return a if angle < 1e-9 else a @ turn_about(way, angle * t)


def twist_about(r: np.ndarray, axis: np.ndarray) -> float:
    """The part of a rotation that turns about `axis`, in -pi..pi."""
    side = unit(np.cross(axis, [0.3, 0.5, 0.81]))
    moved = r @ axis
    swing = _shortest(moved, axis)
    back = swing @ (r @ side)
    return float(np.arctan2(np.dot(np.cross(side, back), axis), np.dot(side, back)))


def _shortest(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    axis = np.cross(a, b)
    sine, cosine = float(np.linalg.norm(axis)), float(a @ b)
    return np.eye(3) if sine < 1e-9 else turn_about(axis, np.arctan2(sine, cosine))


def axes(along: np.ndarray, hinge: np.ndarray) -> np.ndarray:
    """Columns: along, hinge made perpendicular, and their cross product."""
    a = unit(along)
    n = unit(hinge - (hinge @ a) * a)
    return np.stack([a, n, np.cross(a, n)], axis=1)


def two_bone(
    root: np.ndarray, target: np.ndarray, upper: float, lower: float, pole: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Middle joint, reachable end and hinge axis of a limb that bends away towards `pole`.

    Lengths never change: a target out of reach is approached as far as the limb goes.
    """
    way = target - root
    span = float(np.clip(np.linalg.norm(way), abs(upper - lower) + 1e-4, (upper + lower) * 0.9995))
    ahead = unit(way)
    aside = unit(pole - (pole @ ahead) * ahead)
    along = (upper**2 - lower**2 + span**2) / (2.0 * span)
    height = np.sqrt(max(upper**2 - along**2, 0.0))
    middle = root + along * ahead + height * aside
    return middle, root + span * ahead, np.cross(ahead, -aside)


def smooth(values: np.ndarray, sigma: float) -> np.ndarray:
    """Gaussian smoothing along the first axis; ends are held."""
    if sigma <= 0.0:
        return values
    reach = int(np.ceil(3.0 * sigma))
    kernel = np.exp(-0.5 * (np.arange(-reach, reach + 1) / sigma) ** 2)
    kernel /= kernel.sum()
    padded = np.concatenate([np.repeat(values[:1], reach, 0), values, np.repeat(values[-1:], reach, 0)])
    flat = padded.reshape(len(padded), -1)
    columns = [np.convolve(flat[:, n], kernel, mode="valid") for n in range(flat.shape[1])]
    return np.stack(columns, axis=1).reshape(values.shape)


def ease(t: np.ndarray | float) -> np.ndarray:
    """Smootherstep of 0..1, on arrays."""
    t = np.clip(t, 0.0, 1.0)
    return t * t * t * (t * (6.0 * t - 15.0) + 10.0)
