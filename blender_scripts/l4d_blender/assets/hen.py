"""A hen of about 40 cm: feathered body, hackle, comb, wattles, tail fan and scaly legs, skinned to loose
bones.

Owns the shape, the joints and the skinning. The armature's bones have no parents: each carries its part
from rest to pose, so that motion/hens.py may place every part by itself. Front is -Y, origin between the
feet.
"""

from __future__ import annotations

import math
import random

import bpy
from mathutils import Matrix, Vector

from l4d_blender.scene.catalogue import kind, words

from . import mesh
from .materials import outdoors
from .rigs import hang, upright_armature

#: Joints in metres in the rest pose; left is +X.
BODY_PIVOT = Vector((0.0, 0.01, 0.215))
NECK_LOW = Vector((0.0, -0.060, 0.262))
NECK_MID = Vector((0.0, -0.131, 0.313))
NECK_TOP = Vector((0.0, -0.141, 0.400))
BEAK_TIP = Vector((0.0, -0.222, 0.401))
HIP = {"left": Vector((0.045, 0.005, 0.200)), "right": Vector((-0.045, 0.005, 0.200))}
HOCK = {"left": Vector((0.050, 0.040, 0.108)), "right": Vector((-0.050, 0.040, 0.108))}
ANKLE = {"left": Vector((0.050, 0.000, 0.014)), "right": Vector((-0.050, 0.000, 0.014))}

_MIDDLE = {"pivot": BODY_PIVOT, "neck_low": NECK_LOW, "neck_mid": NECK_MID, "neck_top": NECK_TOP}
_LEGS = {"hip": HIP, "hock": HOCK, "ankle": ANKLE}

#: One row per vertex of a part: the bones that carry it and their shares.
Weights = list[dict[str, float]]


def joint(name: str, side: str = "left") -> Vector:
    """A rest joint; those of legs exist on both sides."""
    return (_LEGS[name][side] if name in _LEGS else _MIDDLE[name]).copy()


def _weigh(part: bpy.types.Object, weights: str | Weights) -> None:
    """Hangs a part on one bone, or each of its vertices on several."""
    rows = [{weights: 1.0}] * len(part.data.vertices) if isinstance(weights, str) else weights
    for bone in sorted({bone for row in rows for bone in row}):
        group = part.vertex_groups.new(name=bone)
        for index, row in enumerate(rows):
            if bone in row:
                group.add([index], row[bone], "REPLACE")


def _tuft_curve(part: bpy.types.Object, amount: float, rng: random.Random) -> None:
    """Roughens a smooth part into layered plumage: shallow scallops with a random phase."""
    phase = rng.uniform(0.0, 6.0)
    for vertex in part.data.vertices:
        p = vertex.co
        wave = math.sin(70 * p.y + 22 * p.x + phase) * math.sin(95 * p.z + 15 * p.y + phase)
        vertex.co += vertex.normal * amount * wave


def _body(name: str, rng: random.Random) -> bpy.types.Object:
    spine = [
        (-0.142, 0.232, 0.012, 0.014),
        (-0.130, 0.228, 0.040, 0.046),
        (-0.100, 0.222, 0.066, 0.074),
        (-0.060, 0.218, 0.083, 0.092),
        (0.000, 0.220, 0.092, 0.096),
        (0.050, 0.232, 0.086, 0.086),
        (0.100, 0.252, 0.068, 0.066),
        (0.140, 0.276, 0.046, 0.048),
        (0.175, 0.300, 0.022, 0.030),
        (0.190, 0.310, 0.008, 0.012),
    ]
    points = [Vector((0, y, z)) for y, z, _, _ in spine]
    body = mesh.tube(f"{name}_body", points, [(rx, rz) for _, _, rx, rz in spine], segments=24)
    mesh.subdivide(body, 1)
    _tuft_curve(body, 0.0022, rng)
    return body


def _feather(
    name: str, root: Vector, tip: Vector, width_m: float, normal: Vector, droop_m: float
) -> bpy.types.Object:
    """A leaf-shaped blade, doubled so that it has no wrong side."""
    along = tip - root
    across = along.cross(normal).normalized()
    outward = across.cross(along).normalized()
    verts, stations = [], 6
    for k in range(stations + 1):
        t = k / stations
        half = 0.5 * width_m * (math.sin(math.pi * min(1.0, 0.12 + 0.88 * t) ** 0.8) ** 0.6 if t < 1 else 0.0)
        centre = root + along * t + outward * droop_m * t * t
        verts += [centre - across * half, centre + outward * 0.15 * width_m, centre + across * half]
    faces = []
    for k in range(stations):
        a, b = 3 * k, 3 * (k + 1)
        faces += [(a, a + 1, b + 1, b), (a + 1, a + 2, b + 2, b + 1)]
    return mesh.from_pydata(name, verts, faces, smooth=True)


def _tail(name: str) -> list[bpy.types.Object]:
    feathers = []
    for k in range(-4, 5):
        spread = k / 4.0
        root = Vector((0.012 * spread, 0.145, 0.285 - 0.006 * abs(spread)))
        pitch = math.radians(58 - 26 * abs(spread))
        length = 0.150 - 0.025 * abs(spread)
        tip = root + length * Vector((0.42 * spread, math.cos(pitch), math.sin(pitch)))
        feathers.append(
            _feather(f"{name}_tail{k}", root, tip, 0.048, Vector((1.0, 0.0, 0.25 * spread)), -0.03)
        )
    return feathers


def _wing(name: str, side: float, rng: random.Random) -> list[bpy.types.Object]:
    shield = mesh.ellipsoid(f"{name}_wing", (0.024, 0.092, 0.056), 20, 12)
    _tuft_curve(shield, 0.002, rng)
    place = Matrix.Translation((side * 0.076, 0.015, 0.242)) @ Matrix.Rotation(0.22, 4, "X")
    mesh.transform(shield, place)
    parts = [shield]
    for k in range(5):
        root = Vector((side * (0.088 - 0.002 * k), 0.02, 0.262 - 0.019 * k))
        tip = Vector((side * (0.052 - 0.004 * k), 0.150 - 0.012 * k, 0.272 - 0.021 * k))
        parts.append(_feather(f"{name}_quill{k}", root, tip, 0.034, Vector((side, 0.3, 0.0)), 0.0))
    return parts


def _neck(name: str, rng: random.Random) -> tuple[bpy.types.Object, Weights]:
    points = [
        Vector((0, -0.040, 0.240)),
        Vector((0, -0.080, 0.272)),
        Vector((0, -0.112, 0.300)),
        Vector((0, -0.131, 0.330)),
        Vector((0, -0.139, 0.362)),
        Vector((0, -0.142, 0.392)),
        Vector((0, -0.148, 0.410)),
    ]
    neck = mesh.tube(f"{name}_neck", points, [0.070, 0.064, 0.054, 0.043, 0.034, 0.028, 0.020], segments=18)
    mesh.subdivide(neck, 1)
    _tuft_curve(neck, 0.002, rng)
    ladder = [("body", 0.040), ("neck_low", 0.098), ("neck_high", 0.142), ("head", 0.185)]
    return neck, [_between(ladder, _climb(vertex.co)) for vertex in neck.data.vertices]


def _climb(point: Vector) -> float:
    """Metres along the neck's middle line, from inside the breast to the head."""
    low, mid, top = Vector((0, -0.030, 0.235)), NECK_MID, NECK_TOP
    first, second = mid - low, top - mid
    t1 = min(1.0, max(0.0, (point - low).dot(first) / first.length_squared))
    t2 = min(1.0, max(0.0, (point - mid).dot(second) / second.length_squared))
    return t1 * first.length + t2 * second.length


def _between(ladder: list[tuple[str, float]], value: float) -> dict[str, float]:
    """Shares of the two rungs around `value`."""
    if value <= ladder[0][1]:
        return {ladder[0][0]: 1.0}
    for (low, a), (high, b) in zip(ladder, ladder[1:], strict=False):
        if value < b:
            share = (value - a) / (b - a)
            return {low: 1.0 - share, high: share}
    return {ladder[-1][0]: 1.0}


def _comb(name: str) -> bpy.types.Object:
    """Five points on a thin plate; the outline is cut in the mirror plane."""
    outline = [
        (-0.178, 0.421),
        (-0.180, 0.436),
        (-0.172, 0.430),
        (-0.168, 0.448),
        (-0.160, 0.434),
        (-0.152, 0.454),
        (-0.146, 0.436),
        (-0.136, 0.450),
        (-0.133, 0.432),
        (-0.121, 0.438),
        (-0.124, 0.418),
        (-0.150, 0.412),
    ]
    count, half = len(outline), 0.0045
    verts = [(x, y, z) for x in (-half, half) for y, z in outline]
    faces: list[tuple[int, ...]] = [tuple(range(count)), tuple(range(2 * count - 1, count - 1, -1))]
    faces += [((k + 1) % count, k, k + count, (k + 1) % count + count) for k in range(count)]
    return mesh.from_pydata(f"{name}_comb", verts, faces, smooth=False)


def _head(name: str) -> list[tuple[bpy.types.Object, str]]:
    """Parts of the head, each with the tissue it is made of."""
    skull = mesh.ellipsoid(f"{name}_skull", (0.023, 0.031, 0.025), 16, 10)
    mesh.transform(skull, Matrix.Translation((0, -0.156, 0.405)))
    beak = mesh.tube(
        f"{name}_beak",
        [Vector((0, -0.178, 0.403)), Vector((0, -0.200, 0.405)), Vector((0, -0.215, 0.402)), BEAK_TIP],
        [0.0125, 0.0095, 0.005, 0.001],
        segments=10,
    )
    parts = [(skull, "feathers"), (beak, "horn"), (_comb(name), "comb")]
    for side in (-1.0, 1.0):
        wattle = mesh.ellipsoid(f"{name}_wattle", (0.006, 0.010, 0.019), 10, 8)
        mesh.transform(wattle, Matrix.Translation((side * 0.009, -0.178, 0.376)))
        face = mesh.ellipsoid(f"{name}_face", (0.006, 0.014, 0.012), 10, 8)
        mesh.transform(face, Matrix.Translation((side * 0.0195, -0.166, 0.405)))
        eye = mesh.ellipsoid(f"{name}_eye", (0.004, 0.0055, 0.0055), 10, 8)
        mesh.transform(eye, Matrix.Translation((side * 0.0235, -0.167, 0.409)))
        parts += [(wattle, "comb"), (face, "comb"), (eye, "eye")]
    return parts


def _leg(name: str, side: str) -> list[tuple[bpy.types.Object, str, str]]:
    """(part, bone, tissue) from the drumstick to the toes."""
    hip, hock, ankle = HIP[side], HOCK[side], ANKLE[side]
    drumstick = mesh.tube(
        f"{name}_drumstick_{side}",
        [hip + Vector((0, 0, 0.02)), hip.lerp(hock, 0.3), hip.lerp(hock, 0.7), hip.lerp(hock, 1.02)],
        [0.036, 0.040, 0.026, 0.011],
        segments=14,
    )
    shank = mesh.tube(
        f"{name}_shank_{side}",
        [hock + Vector((0, 0, 0.006)), hock.lerp(ankle, 0.1), hock.lerp(ankle, 0.9), ankle],
        [0.0095, 0.0085, 0.0075, 0.0085],
        segments=10,
    )
    parts = [(drumstick, f"thigh_{side}", "feathers"), (shank, f"shank_{side}", "scales")]
    for turn, length in ((-0.5, 0.050), (0.0, 0.060), (0.5, 0.050), (math.pi, 0.026)):
        way = Vector((math.sin(turn), -math.cos(turn), 0.0))
        points = [ankle, ankle + way * 0.4 * length + Vector((0, 0, -0.004)), ankle + way * length]
        points[2].z = 0.004
        toe = mesh.tube(f"{name}_toe_{side}", points, [0.008, 0.0065, 0.003], segments=8)
        parts.append((toe, f"foot_{side}", "scales"))
    return parts


@kind(
    "hen",
    (0.203, 0.486, 0.453),
    "walks",
    front="-y",
    plumage=words("plumage", *outdoors.PLUMAGES),
    neck=words("neck", "own", *outdoors.NECKS),
)
def hen(name: str, rng: random.Random, *, plumage: str = "russet", neck: str = "own") -> bpy.types.Object:
    """The skinned mesh; its parent is the armature, which stands where the hen stands.

    `plumage` is a key of `outdoors.PLUMAGES`, `neck` one of `outdoors.NECKS`. Textures stick to the
    attribute "rest_position".
    """
    tissues = outdoors.hen_tissues(name, plumage, neck)
    parts: list[bpy.types.Object] = []

    def add(part: bpy.types.Object, weights: str | Weights, tissue: str) -> None:
        mesh.set_material(part, tissues[tissue])
        _weigh(part, weights)
        parts.append(part)

    add(_body(name, rng), "body", "feathers")
    add(*_neck(name, rng), "hackle")
    for feather in _tail(name):
        add(feather, "body", "tail")
    for side in (-1.0, 1.0):
        for part in _wing(name, side, rng):
            add(part, "body", "wing")
    for part, tissue in _head(name):
        add(part, "head", tissue)
    for leg in ("left", "right"):
        for part, bone, tissue in _leg(name, leg):
            add(part, bone, tissue)

    bird = mesh.store_rest_position(mesh.join(name, parts))
    heads = {"body": BODY_PIVOT, "neck_low": NECK_LOW, "neck_high": NECK_MID, "head": NECK_TOP}
    for leg in ("left", "right"):
        heads |= {f"thigh_{leg}": HIP[leg], f"shank_{leg}": HOCK[leg], f"foot_{leg}": ANKLE[leg]}
    return hang(bird, upright_armature(f"{name}_rig", heads))
