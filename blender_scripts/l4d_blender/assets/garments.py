"""Clothes as geometry of their own: cut from inflated body surfaces or lofted round the hips, with hems.

A garment is a Shell in the rest pose with weights of the body's bones; skirts hang on bones of their own.
Knows tailoring; refuses to know colours (materials come in) and motion.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import bpy
import numpy as np

from .anatomy import SIDES, Anatomy, Bone, vec
from .implicit import (
    Blob,
    Cone,
    Ellipsoid,
    Grid,
    Stack,
    blended,
    clip,
    hem,
    relax,
    smoothstep,
    surface_nets,
    vertex_normals,
)
from .shell import Shell, grid_faces

BODY_CELL_M = 0.0185
SKIRT_BONES = 10
SLEEVES = {"none": 0.0, "short": 0.17, "elbow": 0.27, "long": 0.512}


@dataclass
class Tailor:
    """Cuts garments for one body: keeps the sampled flesh and the wrinkles' phases."""

    anatomy: Anatomy
    phase: float

    def __post_init__(self) -> None:
        k = self.anatomy.scale
        reach = abs(self.anatomy.joints["hand_l"][0]) + 0.08
        self.grid = Grid.over(vec(-reach, -0.25 * k, -0.02), vec(reach, 0.25 * k, 1.52 * k), BODY_CELL_M)
        for blob in self.anatomy.flesh():
            self.grid.add(blob)

    def surface(self, ease: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
        """The body inflated by `ease` metres (per lattice point or everywhere)."""
        inflated = Grid(self.grid.origin, self.grid.cell, self.grid.values - ease)
        verts, faces = surface_nets(inflated)
        return relax(verts, faces, 2), faces

    def wrinkled(self, verts: np.ndarray, faces: np.ndarray, height: float, where: np.ndarray) -> np.ndarray:
        """Presses creases of a height in metres into a surface, scaled per vertex by `where`."""
        normals = vertex_normals(verts, [tuple(f) for f in faces.tolist()])
        x, y, z = (verts / self.anatomy.scale).T
        wave = np.sin(70 * z + 18 * x + 9 * np.sin(11 * x + self.phase) + self.phase) + 0.7 * np.sin(
            48 * z - 31 * np.abs(x) + 14 * y + 2.3 * self.phase
        )
        return verts + (height * wave * where)[:, None] * normals

    def reach_along_arms(self, verts: np.ndarray) -> np.ndarray:
        """Metres from the shoulder along the nearest arm; below zero on trunk and legs."""
        a = self.anatomy
        trunk = np.minimum(
            blended(a.torso, verts), np.minimum(blended(a.legs["l"], verts), blended(a.legs["r"], verts))
        )
        out = np.full(len(verts), -1.0)
        for side, s in SIDES:
            along, _ = a.along_limb(verts, [f"upper_arm_{side}", f"forearm_{side}", f"hand_{side}"])
            mine = (blended(a.arms[side], verts) < trunk - 0.004) & (s * verts[:, 0] > 0.0)
            out = np.where(mine, along, out)
        return out


def top(
    tailor: Tailor,
    name: str,
    material: bpy.types.Material,
    *,
    sleeve: str = "short",
    hem_z: float = 0.86,
    ease: float = 0.011,
    neck: tuple[float, float] = (0.082, 0.0),
    loose: float = 0.012,
) -> Shell:
    """A shirt or blouse; `neck` = radius of the neckline and its dip in front, `hem_z` on the 1.70 m body."""
    k = tailor.anatomy.scale
    z = tailor.grid.points()[..., 2] / k
    slack = ease + loose * smoothstep(1.20, 1.04, z) * smoothstep(0.6, 0.8, z)
    verts, faces = tailor.surface(slack)
    arms = tailor.reach_along_arms(verts)
    folds = np.where(arms > 0.0, smoothstep(0.02, 0.2, arms), smoothstep(1.28, 1.05, verts[:, 2] / k))
    verts = tailor.wrinkled(verts, faces, 0.0028, folds)
    keep = np.maximum(np.where(arms < 0.0, hem_z * k - verts[:, 2], -1.0), _neckline(tailor, verts, *neck))
    if sleeve == "none":
        keep = np.maximum(keep, np.where(verts[:, 2] > 1.1 * k, np.abs(verts[:, 0]) - 0.152 * k, -1.0))
        keep = np.maximum(keep, np.where(arms > 0.0, arms - 0.03, -1.0))
    else:
        keep = np.maximum(
            keep, np.where(arms > 0.0, arms - SLEEVES[sleeve] * k * tailor.anatomy.build.arms, -1.0)
        )
    verts, cut = clip(verts, faces, keep)
    verts, cut = hem(verts, cut, 0.005, 0.03)
    return Shell(name, verts, cut, tailor.anatomy.body_weights(verts), [material])


def _neckline(tailor: Tailor, verts: np.ndarray, radius: float, dip: float) -> np.ndarray:
    """Positive inside the opening round the neck."""
    k = tailor.anatomy.scale
    p = verts / k - vec(0, 0.012 - 0.35 * dip, 1.447)
    q = np.stack([p[:, 0], p[:, 1], p[:, 2] * 0.9], axis=1)
    q[:, 2] = np.where(p[:, 1] < 0.0, q[:, 2] * radius / (radius + dip), q[:, 2])
    opening = np.maximum(radius - np.linalg.norm(q, axis=1), p[:, 2] - 0.012)
    return np.where(verts[:, 2] > 1.15 * k, opening, -1.0) * k


def jacket(tailor: Tailor, name: str, materials: list[bpy.types.Material], *, hem_z: float = 0.82) -> Shell:
    """An open jacket with a standing collar."""
    k = tailor.anatomy.scale
    verts, faces = tailor.surface(0.026)
    arms = tailor.reach_along_arms(verts)
    folds = np.where(arms > 0.0, smoothstep(0.02, 0.2, arms), smoothstep(1.30, 1.05, verts[:, 2] / k))
    verts = tailor.wrinkled(verts, faces, 0.0036, folds)
    gap = (0.022 + 0.075 * smoothstep(1.05, 1.40, verts[:, 2] / k)) * k
    opening = np.where((verts[:, 1] < 0.0) & (arms < 0.0), gap - np.abs(verts[:, 0]), -1.0)
    keep = np.maximum(
        np.where(arms < 0.0, hem_z * k - verts[:, 2], -1.0), _neckline(tailor, verts, 0.086, 0.02)
    )
    keep = np.maximum(np.maximum(keep, opening), np.where(arms > 0.0, arms - 0.52 * k, -1.0))
    verts, cut = clip(verts, faces, keep)
    verts, cut = hem(verts, cut, 0.007, 0.03)
    return Shell(name, verts, cut, tailor.anatomy.body_weights(verts), materials[:1])


def trousers(
    tailor: Tailor, name: str, material: bpy.types.Material, *, hem_z: float = 0.075, wide: float = 0.020
) -> Shell:
    """Trousers from the waist down to `hem_z` (0.50 makes shorts); `wide` is the slack at the ankle."""
    k = tailor.anatomy.scale
    z = tailor.grid.points()[..., 2] / k
    slack = 0.008 + wide * smoothstep(0.62, 0.12, z)
    inseam = np.where(z < 0.745, 0.56 * BODY_CELL_M - np.abs(tailor.grid.points()[..., 0]), -1.0)
    verts, faces = tailor.surface(np.minimum(slack, tailor.grid.values - inseam))
    folds = 0.35 + smoothstep(0.62, 0.50, verts[:, 2] / k) + smoothstep(0.30, 0.1, verts[:, 2] / k)
    verts = tailor.wrinkled(verts, faces, 0.0030, folds)
    arms = tailor.reach_along_arms(verts)
    keep = np.maximum(
        np.maximum(verts[:, 2] - 1.0 * k, hem_z * k - verts[:, 2]), np.where(arms > 0.0, 1.0, -1.0)
    )
    keep = np.maximum(keep, np.abs(verts[:, 0]) - 0.30 * k)
    verts, cut = clip(verts, faces, keep)
    verts, cut = hem(verts, cut, 0.006, 0.03)
    return Shell(name, verts, cut, tailor.anatomy.body_weights(verts), [material])


@dataclass
class Skirt:
    """A skirt's shape: where rings lie and how wide they are; also what an apron is draped over."""

    anatomy: Anatomy
    waist_z: float = 1.03
    hem_z: float = 0.50
    flare: float = 0.34
    folds: int = 11
    phase: float = 0.0

    def ring(self, turn: np.ndarray, z: np.ndarray, offset: float = 0.0) -> np.ndarray:
        """Points at angles `turn` (0 = front, counter-clockwise from above) and reference heights z."""
        k, trunk = self.anatomy.scale, self.anatomy.torso[0]
        assert isinstance(trunk, Stack)
        held = np.maximum(z, 0.885)
        wide, deep, shift = trunk.section(held * k)
        belly = 0.016 * smoothstep(1.0, 0.90, z)
        drop = np.maximum(0.895 - z, 0.0)
        spread = self.flare * drop * (1.0 - 0.18 * smoothstep(0.0, 0.5, drop)) + 0.012
        depth = smoothstep(0.93, self.hem_z, z)
        fold = (
            (
                np.sin(self.folds * turn + self.phase)
                + 0.55 * np.sin((self.folds * 2 - 5) * turn + 2.1 * self.phase)
                + 0.4 * np.sin(3 * turn + self.phase)
            )
            * 0.016
            * depth
        )
        rx = wide + (spread + fold + offset) * k
        ry = deep + (1.10 * spread + belly + fold + offset) * k
        back = 0.022 * k * np.clip(-np.cos(turn), 0, 1) * smoothstep(1.0, 0.90, z)
        x, y = rx * np.sin(turn), shift - (ry + back) * np.cos(turn)
        return np.stack([x, y, z * k + 0.0 * x], axis=-1)

    @cached_property
    def bones(self) -> list[Bone]:
        """The ribs that the skirt hangs on, two segments each."""
        mid = 0.5 * (0.93 + self.hem_z)
        bones = []
        for n in range(SKIRT_BONES):
            turn = np.array([2.0 * np.pi * n / SKIRT_BONES])
            a, b, c = (self.ring(turn, np.array([z]))[0] for z in (0.95, mid, self.hem_z))
            bones.append(Bone(f"skirt_{n}_1", a, b, "pelvis"))
            bones.append(Bone(f"skirt_{n}_2", b, c, f"skirt_{n}_1"))
        return bones

    def weights(self, turn: np.ndarray, z: np.ndarray) -> dict[str, np.ndarray]:
        """Shares of pelvis, waist and the two nearest pairs of skirt bones."""
        mid = 0.5 * (0.93 + self.hem_z)
        hang = smoothstep(0.995, 0.90, z)
        lower = smoothstep(mid + 0.06, mid - 0.06, z)
        spine = smoothstep(0.97, 1.08, z) * (1.0 - hang)
        weights = {"pelvis": 1.0 - hang - spine, "spine": spine}
        place = (turn / (2.0 * np.pi) * SKIRT_BONES) % SKIRT_BONES
        for n in range(SKIRT_BONES):
            gap = np.abs((place - n + SKIRT_BONES / 2) % SKIRT_BONES - SKIRT_BONES / 2)
            near = np.clip(1.0 - gap, 0.0, 1.0)
            near = near * near * (3.0 - 2.0 * near)
            weights[f"skirt_{n}_1"] = hang * near * (1.0 - lower)
            weights[f"skirt_{n}_2"] = hang * near * lower
        return weights

    def panel(
        self,
        name: str,
        material: bpy.types.Material,
        *,
        first: float = 0.0,
        last: float = 2.0 * np.pi,
        top_z: float | None = None,
        hem_z: float | None = None,
        offset: float = 0.0,
        columns: int = 80,
        rows: int = 14,
        cloth_m: float = 0.006,
    ) -> Shell:
        """The skirt between two angles, with a lip at its open edges."""
        closed = abs(last - first - 2.0 * np.pi) < 1e-6
        turns = np.linspace(first, last, columns, endpoint=not closed)
        heights = np.linspace(self.hem_z if hem_z is None else hem_z, top_z or self.waist_z, rows)
        z, turn = np.meshgrid(heights, turns, indexing="ij")
        verts = self.ring(turn.ravel(), z.ravel(), offset)
        verts, faces = hem(verts, grid_faces(rows, columns, wrap=closed), cloth_m, 0.02)
        angle = _nearest_rows(verts, turn.ravel(), z.ravel(), self.ring(turn.ravel(), z.ravel(), offset))
        return Shell(name, verts, faces, self.weights(*angle), [material])


def _nearest_rows(
    verts: np.ndarray, turn: np.ndarray, z: np.ndarray, grid: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Angle and height of every vertex; lip and lining take those of the grid point that they came from."""
    extra = verts[len(grid) :]
    nearest = np.array([int(np.argmin(((grid - p) ** 2).sum(axis=1))) for p in extra], dtype=int)
    return np.concatenate([turn, turn[nearest]]), np.concatenate([z, z[nearest]])


def bib(tailor: Tailor, name: str, material: bpy.types.Material) -> Shell:
    """The upper part of an apron, with straps over the shoulders."""
    k = tailor.anatomy.scale
    verts, faces = tailor.surface(0.021)
    x, y, z = np.abs(verts[:, 0]) / k, verts[:, 1] / k, verts[:, 2] / k
    front = np.maximum.reduce([x - (0.105 - 0.10 * (z - 1.0) * 0.6), z - 1.29, 0.985 - z, y - 0.0])
    straps = np.maximum.reduce([np.abs(x - 0.078) - 0.017, 1.27 - z, z - 1.42])
    keep = np.minimum(front, straps) * k
    verts, cut = clip(verts, faces, keep)
    verts, cut = hem(verts, cut, 0.004, 0.01)
    return Shell(name, verts, cut, tailor.anatomy.body_weights(verts), [material])


def shoes(
    anatomy: Anatomy,
    name: str,
    upper: bpy.types.Material,
    sole: bpy.types.Material,
    *,
    shaft_z: float = 0.095,
) -> Shell:
    """A pair of shoes, or boots where `shaft_z` (on the 1.70 m body) reaches up the calf."""
    parts_v, parts_f, zones, count = [], [], [], 0
    k = anatomy.scale
    for side, s in SIDES:
        ankle, ball, tip = (anatomy.joints[f"{n}_{side}"] for n in ("foot", "toe", "toe_tip"))
        grid = Grid.over(
            vec(ankle[0] - 0.075 * k, tip[1] - 0.05 * k, -0.02),
            vec(ankle[0] + 0.075 * k, ankle[1] + 0.10 * k, (shaft_z + 0.05) * k),
            0.0125 * k,
        )
        up = vec(0, 0, 1)
        heel = vec(ankle[0], ankle[1] + 0.030 * k, 0.028 * k)
        blobs: list[Blob] = [
            Cone(heel, ball + vec(0, 0, 0.010 * k), 0.034 * k, 0.043 * k, 0.0, up, 0.72),
            Cone(
                ball + vec(0, 0, 0.010 * k),
                tip + vec(-s * 0.008, 0.012, 0.008) * k,
                0.043 * k,
                0.031 * k,
                0.02 * k,
                up,
                0.66,
            ),
            Cone(
                ankle + vec(0, 0.004, 0) * k, ball + vec(0, 0.02, 0.022) * k, 0.040 * k, 0.027 * k, 0.03 * k
            ),
            Cone(
                heel + vec(0, -0.004, 0.02) * k,
                ankle + vec(0, 0.008, (shaft_z - 0.082)) * k,
                0.037 * k,
                (0.043 if shaft_z < 0.15 else 0.056) * k,
                0.03 * k,
            ),
        ]
        for blob in blobs:
            grid.add(blob, margin=0.05)
        p = grid.points()
        grid.values = np.maximum(grid.values, 0.001 - p[..., 2])
        verts, faces = surface_nets(grid)
        low = verts[:, 2] < 0.020 * k
        centre = np.array([ankle[0], 0.0, 0.0])
        grow = 1.0 + 0.075 * low
        verts[:, 0] = centre[0] + (verts[:, 0] - centre[0]) * grow
        verts[low, 2] = np.maximum(verts[low, 2], 0.0)
        verts, cut = clip(verts, faces, verts[:, 2] - shaft_z * k)
        verts, cut = hem(verts, cut, 0.005, 0.025)
        middle = np.array([verts[list(face), 2].mean() for face in cut])
        parts_v.append(verts)
        parts_f += [tuple(v + count for v in face) for face in cut]
        zones.append((middle < 0.017 * k).astype(int))
        count += len(verts)
    verts = np.concatenate(parts_v)
    return Shell(
        name, verts, parts_f, _shoe_weights(anatomy, verts), [upper, sole], material=np.concatenate(zones)
    )


def _shoe_weights(anatomy: Anatomy, verts: np.ndarray) -> dict[str, np.ndarray]:
    k = anatomy.scale
    weights: dict[str, np.ndarray] = {}
    for side, s in SIDES:
        mine = (s * verts[:, 0] > 0.0).astype(float)
        ball = anatomy.joints[f"toe_{side}"][1]
        toe = smoothstep(ball + 0.022 * k, ball - 0.022 * k, verts[:, 1])
        calf = smoothstep(0.075 * k, 0.125 * k, verts[:, 2])
        weights |= {
            f"toe_{side}": mine * toe * (1 - calf),
            f"calf_{side}": mine * calf,
            f"foot_{side}": mine * (1 - toe) * (1 - calf),
        }
    return weights


def belt(
    skirt: Skirt,
    name: str,
    material: bpy.types.Material,
    *,
    z: float = 1.0,
    height: float = 0.035,
    offset: float = 0.012,
) -> Shell:
    """A band round the waist: a belt, or the ties of an apron."""
    return skirt.panel(name, material, top_z=z + height, hem_z=z, offset=offset, columns=48, rows=4)


def button_row(
    anatomy: Anatomy,
    tailor: Tailor,
    name: str,
    material: bpy.types.Material,
    heights: list[float],
    ease: float,
) -> Shell:
    """Buttons down the front of a garment that stands `ease` off the body."""
    k, parts, faces, count = anatomy.scale, [], [], 0
    for z in heights:
        y = np.linspace(-0.25, 0.0, 400) * k
        line = np.stack([np.zeros(400), y, np.full(400, z * k)], axis=1)
        front = y[int(np.argmax(blended(anatomy.torso, line) < ease))]
        ball = Ellipsoid(vec(0, front - 0.001, z * k), vec(0.009, 0.005, 0.009))
        turn = 2 * np.pi * np.arange(10) / 10
        rings = [
            np.stack([r * np.cos(turn), np.full(10, -d), r * np.sin(turn)], axis=1)
            for r, d in ((1.0, -0.4), (0.9, 0.7), (0.3, 1.0))
        ]
        verts = np.concatenate([ball.centre + ball.radii * ring for ring in rings])
        parts.append(verts)
        faces += [tuple(v + count for v in face) for face in grid_faces(3, 10, wrap=True)]
        faces.append(tuple(count + 20 + n for n in range(10)))
        count += len(verts)
    verts = np.concatenate(parts)
    return Shell(name, verts, faces, anatomy.body_weights(verts), [material])
