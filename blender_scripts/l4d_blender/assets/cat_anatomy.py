"""What is under a cat's coat: joints, bones, volumes of flesh, and the skin with its weights.

Knows no colours, ears and eyes (cat.py). Rest pose: standing, facing -Y, tail straight back, paws on z = 0,
origin between the paws; metres.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import bpy
import numpy as np
from mathutils import Vector

from l4d_blender.assets import implicit, rigs

VOXEL_M = 0.0036
BODY_FACES = 11500
TAIL_BONES = 9


def _tail_joints() -> list[tuple[float, float, float]]:
    return [(0.0, 0.186 + 0.034 * i, 0.240 - 0.004 * i) for i in range(TAIL_BONES + 1)]


JOINTS: dict[str, tuple[float, float, float]] = {
    "pelvis": (0.0, 0.165, 0.236),
    "lumbar": (0.0, 0.108, 0.246),
    "loin": (0.0, 0.052, 0.250),
    "back": (0.0, -0.004, 0.249),
    "withers": (0.0, -0.060, 0.246),
    "chest": (0.0, -0.115, 0.242),
    "neck": (0.0, -0.166, 0.272),
    "skull": (0.0, -0.203, 0.306),
    "nose": (0.0, -0.300, 0.308),
}
LIMB_JOINTS: dict[str, tuple[float, float, float]] = {
    "scapula": (0.028, -0.100, 0.250),
    "shoulder": (0.039, -0.150, 0.176),
    "elbow": (0.041, -0.098, 0.132),
    "wrist": (0.037, -0.113, 0.033),
    "forepaw": (0.037, -0.128, 0.0),
    "foretoe": (0.037, -0.158, 0.008),
    "hip": (0.035, 0.150, 0.212),
    "knee": (0.049, 0.098, 0.142),
    "hock": (0.041, 0.178, 0.069),
    "hindpaw": (0.041, 0.154, 0.0),
    "hindtoe": (0.041, 0.118, 0.008),
    "ear": (0.0305, -0.224, 0.352),
    "eartip": (0.0465, -0.219, 0.397),
    "eye": (0.0238, -0.2735, 0.3265),
}
EYE_RADIUS_M = 0.0135
LID_RADIUS_M = 0.0148


def joint(name: str) -> Vector:
    """A rest joint by name; limb joints take a side suffix ("wrist.L" is at +x)."""
    if name.endswith((".L", ".R")):
        x, y, z = LIMB_JOINTS[name[:-2]]
        return Vector((x if name.endswith("L") else -x, y, z))
    if name.startswith("tail"):
        return Vector(_tail_joints()[int(name[4:])])
    return Vector(JOINTS[name])


@dataclass(frozen=True)
class Bone:
    """A bone between two named rest joints."""

    name: str
    parent: str | None
    head: str
    tail: str


def _bones() -> list[Bone]:
    chain = ["pelvis", "lumbar", "loin", "back", "withers", "chest", "neck", "skull", "nose"]
    names = ["pelvis", "lumbar", "loin", "back", "withers", "chest", "neck", "head"]
    bones = [Bone(n, names[i - 1] if i else None, chain[i], chain[i + 1]) for i, n in enumerate(names)]
    bones += [
        Bone(f"tail{i}", f"tail{i - 1}" if i else "pelvis", f"tail{i}", f"tail{i + 1}")
        for i in range(TAIL_BONES)
    ]
    for s in (".L", ".R"):
        bones += [
            Bone("scapula" + s, "withers", "scapula" + s, "shoulder" + s),
            Bone("upperarm" + s, "scapula" + s, "shoulder" + s, "elbow" + s),
            Bone("forearm" + s, "upperarm" + s, "elbow" + s, "wrist" + s),
            Bone("forepaw" + s, "forearm" + s, "wrist" + s, "foretoe" + s),
            Bone("thigh" + s, "pelvis", "hip" + s, "knee" + s),
            Bone("shin" + s, "thigh" + s, "knee" + s, "hock" + s),
            Bone("hindpaw" + s, "shin" + s, "hock" + s, "hindpaw" + s),
            Bone("hindtoe" + s, "hindpaw" + s, "hindpaw" + s, "hindtoe" + s),
            Bone("ear" + s, "head", "ear" + s, "eartip" + s),
            Bone("lid" + s, "head", "eye" + s, "nose"),
        ]
    return bones


BONES = _bones()


@dataclass(frozen=True)
class _Flesh:
    """A volume and the bone that carries it."""

    bone: str
    shape: implicit.Cone | _TiltedEllipsoid


@dataclass(frozen=True)
class _TiltedEllipsoid:
    """An ellipsoid turned by `pitch` radians about X, for `implicit.Grid`."""

    centre: np.ndarray
    radii: np.ndarray
    pitch: float
    blend: float

    def _axes(self) -> np.ndarray:
        c, s = math.cos(self.pitch), math.sin(self.pitch)
        return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        reach = np.sqrt(np.square(self._axes() * self.radii).sum(axis=1))
        return self.centre - reach, self.centre + reach

    def __call__(self, points: np.ndarray) -> np.ndarray:
        local = (points - self.centre) @ self._axes() / self.radii
        scaled = np.linalg.norm(local, axis=-1)
        return scaled * (scaled - 1.0) / np.maximum(np.linalg.norm(local / self.radii, axis=-1), 1e-9)


def _volumes() -> list[_Flesh]:
    """All flesh of a cat at rest."""

    def cone(bone, a, b, ra, rb, blend=0.014):
        return _Flesh(bone, implicit.Cone(np.array(a), np.array(b), ra, rb, blend))

    def egg(centre, radii, pitch, bone, blend):
        return _Flesh(bone, _TiltedEllipsoid(np.array(centre), np.array(radii), pitch, blend))

    volumes = [
        egg((0, -0.095, 0.202), (0.053, 0.074, 0.066), 0.16, "chest", 0.03),
        egg((0, -0.045, 0.203), (0.057, 0.085, 0.066), 0.05, "withers", 0.03),
        egg((0, 0.015, 0.208), (0.056, 0.080, 0.060), -0.03, "back", 0.03),
        egg((0, 0.066, 0.212), (0.054, 0.075, 0.056), -0.06, "loin", 0.03),
        egg((0, 0.112, 0.216), (0.052, 0.070, 0.054), 0, "lumbar", 0.03),
        egg((0, 0.150, 0.214), (0.050, 0.054, 0.052), 0.2, "pelvis", 0.03),
        egg((0, -0.142, 0.212), (0.040, 0.034, 0.052), 0.45, "chest", 0.03),
        cone("neck", (0, -0.125, 0.235), (0, -0.172, 0.270), 0.055, 0.049, 0.03),
        cone("neck", (0, -0.166, 0.262), (0, -0.208, 0.304), 0.049, 0.042, 0.02),
        egg((0, -0.232, 0.326), (0.0455, 0.047, 0.041), 0, "head", 0.015),
        egg((0, -0.240, 0.304), (0.046, 0.034, 0.026), 0, "head", 0.018),
        egg((0, -0.276, 0.304), (0.0205, 0.021, 0.0145), 0, "head", 0.012),
        egg((0, -0.274, 0.290), (0.012, 0.013, 0.010), 0, "head", 0.010),
        cone("head", (0, -0.256, 0.335), (0, -0.2895, 0.3145), 0.0150, 0.0085, 0.012),
        egg((0, -0.2955, 0.3125), (0.0068, 0.0052, 0.0050), 0, "head", 0.005),
    ]
    for s, side in ((1, ".L"), (-1, ".R")):
        j = {name: joint(name + side) for name in LIMB_JOINTS}
        volumes += [
            egg((0.0125 * s, -0.2865, 0.3015), (0.0125, 0.0120, 0.0105), 0, "head", 0.006),
            egg((0.0275 * s, -0.247, 0.306), (0.0245, 0.026, 0.022), 0, "head", 0.015),
            egg((0.0225 * s, -0.2605, 0.340), (0.0165, 0.0115, 0.0085), 0.3, "head", 0.010),
            egg((0.036 * s, -0.112, 0.210), (0.022, 0.036, 0.060), 0.45, "scapula" + side, 0.03),
            cone("upperarm" + side, j["shoulder"], j["elbow"], 0.0285, 0.0230, 0.022),
            cone("forearm" + side, j["elbow"], j["wrist"], 0.0225, 0.0150, 0.012),
            cone("forepaw" + side, j["wrist"], j["wrist"] + Vector((0, -0.012, -0.016)), 0.0155, 0.0150),
            egg((0.037 * s, -0.141, 0.0125), (0.0185, 0.0235, 0.0125), 0, "forepaw" + side, 0.008),
            egg((0.042 * s, 0.132, 0.176), (0.026, 0.058, 0.062), -0.35, "thigh" + side, 0.025),
            cone("thigh" + side, j["hip"], j["knee"], 0.040, 0.030, 0.02),
            cone("shin" + side, j["knee"], j["hock"], 0.0285, 0.0140, 0.016),
            cone("hindpaw" + side, j["hock"], j["hindpaw"] + Vector((0, -0.008, 0.013)), 0.0142, 0.0138),
            egg((0.041 * s, 0.133, 0.0125), (0.0185, 0.0290, 0.0125), 0, "hindtoe" + side, 0.008),
        ]
        for i in (-1.0, -0.35, 0.35, 1.0):
            drop = 0.005 * i * i
            volumes += [
                egg(
                    (0.037 * s + 0.0115 * i, -0.1575 + drop, 0.0105),
                    (0.0062, 0.0105, 0.0095),
                    0,
                    "forepaw" + side,
                    0.003,
                ),
                egg(
                    (0.041 * s + 0.0115 * i, -0.0015 + 0.117 + drop, 0.0105),
                    (0.0062, 0.0105, 0.0095),
                    0,
                    "hindtoe" + side,
                    0.003,
                ),
            ]
    tail = _tail_joints()
    radii = [0.0215 - 0.0009 * i for i in range(TAIL_BONES + 1)]
    volumes.append(cone("pelvis", (0, 0.160, 0.228), tail[0], 0.034, radii[0], 0.02))
    volumes += [
        cone(f"tail{i}", tail[i], tail[i + 1], radii[i], radii[i + 1], 0.006) for i in range(TAIL_BONES)
    ]
    return volumes


@dataclass
class Skin:
    """Everything a cat of any coat shares; built once per process."""

    vertices: np.ndarray
    faces: np.ndarray
    groups: list[str]
    weights: np.ndarray


@cache
def rest_skin() -> Skin:
    """The skin of a cat at rest."""
    volumes = _volumes()
    low = np.min([v.shape.bounds()[0] for v in volumes], axis=0) - 0.02
    high = np.max([v.shape.bounds()[1] for v in volumes], axis=0) + 0.02
    grid = implicit.Grid.over(low, high, VOXEL_M)
    for volume in volumes:
        grid.add(volume.shape, margin=0.04)
    vertices, quads = implicit.surface_nets(grid)
    vertices = implicit.relax(vertices, quads, 3)
    vertices[:, 2] = np.maximum(vertices[:, 2], 0.0005)
    vertices, faces = _decimate(vertices, quads)
    groups, weights = _weights(volumes, vertices, faces)
    return Skin(vertices, faces, groups, weights)


def _decimate(vertices: np.ndarray, quads: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    mesh = bpy.data.meshes.new("cat_decimation")
    mesh.from_pydata(vertices, [], quads.tolist())
    obj = bpy.data.objects.new("cat_decimation", mesh)
    bpy.context.scene.collection.objects.link(obj)
    modifier = obj.modifiers.new("decimate", "DECIMATE")
    modifier.ratio = min(1.0, BODY_FACES / (2 * len(quads)))
    reduced = bpy.data.meshes.new_from_object(obj.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    reduced.calc_loop_triangles()
    points = np.empty(len(reduced.vertices) * 3)
    reduced.vertices.foreach_get("co", points)
    corners = np.empty(len(reduced.loop_triangles) * 3, dtype=np.int32)
    reduced.loop_triangles.foreach_get("vertices", corners)
    bpy.data.objects.remove(obj)
    bpy.data.meshes.remove(mesh)
    bpy.data.meshes.remove(reduced)
    return points.reshape(-1, 3), corners.reshape(-1, 3)


def _weights(volumes: list[_Flesh], vertices: np.ndarray, faces: np.ndarray) -> tuple[list[str], np.ndarray]:
    """Weights fall off with the distance to each bone's flesh, then diffuse over the surface."""
    groups = sorted({v.bone for v in volumes})
    distance = np.full((len(vertices), len(groups)), 1.0)
    for volume in volumes:
        column = groups.index(volume.bone)
        distance[:, column] = np.minimum(distance[:, column], volume.shape(vertices))
    softness = np.array([0.004 if g == "head" else 0.006 for g in groups])
    weights = np.exp(-np.clip(distance - distance.min(axis=1, keepdims=True), 0, 0.1) / softness)
    average = _neighbour_average(len(vertices), faces)
    for _ in range(14):
        weights = 0.4 * weights + 0.6 * average(weights)
    weights[weights < 0.02 * weights.max(axis=1, keepdims=True)] = 0.0
    return groups, weights / weights.sum(axis=1, keepdims=True)


def _neighbour_average(count: int, triangles: np.ndarray):
    """A function that replaces each vertex's row by the mean over its edge neighbours."""
    edges = np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]])
    a, b = np.unique(np.sort(edges, axis=1), axis=0).T
    degree = np.maximum(np.bincount(a, minlength=count) + np.bincount(b, minlength=count), 1)

    def average(rows: np.ndarray) -> np.ndarray:
        columns = [np.bincount(a, column[b], count) + np.bincount(b, column[a], count) for column in rows.T]
        return np.stack(columns, axis=1) / degree[:, None]

    return average


def at_rest(bone: Bone) -> rigs.Bone:
    """The bone with its places; lids point ahead of their eyes."""
    tail = joint(bone.tail)
    if bone.name.startswith("lid"):
        tail = joint("eye" + bone.name[-2:]) + Vector((0, -0.02, 0))
    return rigs.Bone(bone.name, joint(bone.head), tail, bone.parent)
