"""A domestic cat: one smooth skinned mesh on an armature.

Owns ears, eyes, lids and coat markings as mesh attributes; joints, flesh and weights are cat_anatomy.py's.
Refuses to know how a cat moves (motion/cats.py) and how fur is shaded (materials/interior.py).

Rest pose: standing, facing -Y, tail straight back, paws on z = 0, origin between the paws; metres.
"""

from __future__ import annotations

import math
import random
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Vector, noise

from l4d_blender.assets.cat_anatomy import (
    BONES,
    EYE_RADIUS_M,
    LID_RADIUS_M,
    LIMB_JOINTS,
    Skin,
    at_rest,
    joint,
    rest_skin,
)
from l4d_blender.assets.materials import dogs, interior
from l4d_blender.assets.rigs import armature, hang
from l4d_blender.scene.catalogue import Choice, kind, words


@dataclass(frozen=True)
class Coat:
    """Linear RGB colours; how strong the stripes are; `bib` over 0.5 adds white chest, socks and blaze."""

    name: str
    base: tuple[float, float, float]
    dark: tuple[float, float, float]
    pale: tuple[float, float, float]
    eye: tuple[float, float, float]
    skin: tuple[float, float, float] = (0.52, 0.23, 0.21)
    stripes: float = 1.0
    bib: float = 0.25


GREY_TABBY = Coat(
    "grey_tabby",
    base=(0.200, 0.178, 0.152),
    dark=(0.028, 0.024, 0.022),
    pale=(0.50, 0.46, 0.40),
    eye=(0.42, 0.55, 0.10),
)
ORANGE = Coat(
    "orange",
    base=(0.55, 0.205, 0.05),
    dark=(0.27, 0.070, 0.013),
    pale=(0.80, 0.73, 0.64),
    eye=(0.62, 0.36, 0.05),
    stripes=0.85,
    bib=0.8,
)
BLACK = Coat(
    "black",
    base=(0.022, 0.02, 0.02),
    dark=(0.008, 0.008, 0.008),
    pale=(0.045, 0.04, 0.038),
    eye=(0.65, 0.48, 0.06),
    skin=(0.12, 0.06, 0.06),
    stripes=0.25,
    bib=0.1,
)
_SMOKE, _GINGER, _INK = (0.115, 0.118, 0.128), (0.52, 0.21, 0.055), (0.022, 0.020, 0.020)
_WHITE, _CREAM = (0.66, 0.62, 0.56), (0.60, 0.47, 0.31)
PLAIN_GREY = Coat(
    "plain_grey",
    base=_SMOKE,
    dark=(0.075, 0.077, 0.085),
    pale=(0.15, 0.155, 0.165),
    eye=(0.58, 0.36, 0.05),
    skin=(0.16, 0.12, 0.12),
    stripes=0.0,
    bib=0.0,
)
GREY_BIB = Coat(
    "grey_bib",
    base=_SMOKE,
    dark=(0.075, 0.077, 0.085),
    pale=_WHITE,
    eye=(0.45, 0.50, 0.10),
    stripes=0.0,
    bib=0.9,
)
BLACK_BIB = Coat(
    "black_bib",
    base=_INK,
    dark=(0.010, 0.009, 0.009),
    pale=_WHITE,
    eye=(0.42, 0.52, 0.10),
    stripes=0.0,
    bib=0.9,
)
ORANGE_TABBY = Coat(
    "orange_tabby",
    base=_GINGER,
    dark=(0.25, 0.065, 0.012),
    pale=(0.66, 0.42, 0.20),
    eye=(0.55, 0.42, 0.06),
    stripes=1.0,
    bib=0.2,
)
WHITE = Coat(
    "white",
    base=_WHITE,
    dark=(0.52, 0.48, 0.42),
    pale=(0.74, 0.71, 0.66),
    eye=(0.10, 0.30, 0.50),
    stripes=0.0,
)
CREAM = Coat(
    "cream",
    base=_CREAM,
    dark=(0.44, 0.30, 0.16),
    pale=(0.72, 0.64, 0.50),
    eye=(0.40, 0.45, 0.12),
    stripes=0.0,
    bib=0.2,
)
COATS = {
    coat.name: coat
    for coat in (*(GREY_TABBY, ORANGE, BLACK), *(PLAIN_GREY, GREY_BIB, BLACK_BIB, ORANGE_TABBY, WHITE, CREAM))
}
COLLAR_AT, COLLAR_WAY = Vector((0.0, -0.187, 0.288)), Vector((0.0, -0.66, 0.75)).normalized()
_LIKE_SKIN = "skin"  # weights of the nearest points of the skin


def _step(edge_0: float, edge_1: float, x: np.ndarray) -> np.ndarray:
    t = np.clip((x - edge_0) / (edge_1 - edge_0), 0.0, 1.0)
    return t * t * (3 - 2 * t)


def _markings(vertices: np.ndarray, coat: Coat, seed: Vector) -> np.ndarray:
    """Per vertex (stripe, pale, skin, 1): a mackerel tabby with ringed limbs and tail, bib, nose, pads."""
    x, y, z = vertices.T
    wobble = np.array([noise.noise(Vector(v) * 22 + seed) for v in vertices])
    wobble_large = np.array([noise.noise(Vector(v) * 9 - seed) for v in vertices])

    def bands(coordinate: np.ndarray, period_m: float, duty: float) -> np.ndarray:
        return _step(math.cos(math.pi * duty), 1.0, np.cos(2 * math.pi * coordinate / period_m))

    flank = bands(y + 0.10 * (z - 0.2) + 0.010 * wobble_large + 0.005 * wobble, 0.036, 0.62)
    flank *= _step(0.135, 0.185, z + 0.02 * wobble_large)
    spine = _step(0.016, 0.005, np.abs(x) + 0.004 * wobble) * _step(0.235, 0.255, z) * (y > -0.19)
    limb = bands(z + 0.004 * wobble, 0.034, 0.55) * _step(0.160, 0.125, z) * _step(0.02, 0.045, z)
    tail = bands(y + 0.003 * wobble, 0.042, 0.62)
    on_tail = _step(0.195, 0.215, y)
    tail_tip = _step(0.445, 0.465, y)
    forehead = bands(x + 0.001 * wobble, 0.0135, 0.5) * _step(0.345, 0.356, z) * (y < -0.2)
    cheek = (
        bands(z + 0.25 * np.abs(x), 0.020, 0.45) * _step(0.030, 0.042, np.abs(x)) * (y < -0.215) * (z < 0.335)
    )
    head = y < -0.205
    body = np.maximum(np.maximum(flank, limb), spine)
    stripe = np.where(head, np.maximum(forehead, cheek), body)
    stripe = np.maximum(stripe * (1 - on_tail), on_tail * np.maximum(tail, tail_tip))

    muzzle = _step(-0.272, -0.282, y + 0.004 * wobble) * _step(0.318, 0.309, z)
    chin = _step(0.300, 0.292, z) * (y < -0.225)
    brow = _step(0.010, 0.006, np.hypot(np.abs(x) - 0.022, z - 0.344)) * (y < -0.25)
    belly = (
        _step(0.165, 0.145, z + 0.015 * wobble_large)
        * (np.abs(x) < 0.045)
        * (z > 0.11)
        * (y > -0.12)
        * (y < 0.1)
    )
    pale = np.maximum.reduce([0.9 * muzzle, chin, 0.6 * brow, 0.8 * belly])
    if coat.bib > 0.5:
        chest = _step(-0.125, -0.150, y + 0.02 * wobble_large) * _step(0.255, 0.235, z + 0.012 * wobble)
        socks = _step(0.070, 0.052, z + 0.02 * wobble_large)
        blaze = _step(0.0105, 0.006, np.abs(x) + 0.002 * wobble) * (y < -0.25) * (z < 0.352)
        white_muzzle = _step(-0.262, -0.272, y) * _step(0.325, 0.315, z)
        pale = np.maximum.reduce([pale, chest * (y > -0.215), socks, blaze, white_muzzle, tail_tip * on_tail])
    nose = _step(0.0075, 0.0055, np.linalg.norm(vertices - (0, -0.2985, 0.3135), axis=1))
    pads = (z < 0.0025).astype(float)
    skin = np.maximum(nose, pads)
    return np.stack([coat.stripes * stripe * (1 - pale), pale, skin, np.ones_like(x)], axis=1)


def _ear(side: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """A cupped triangular shell: vertices, quads and the share of bare skin (inside) per vertex."""
    across, up = 9, 9
    base, tip = Vector(LIMB_JOINTS["ear"]), Vector(LIMB_JOINTS["eartip"])
    base = base + Vector((-0.002, 0.004, -0.014))
    rise = tip - base
    right = Vector((0.86, -0.10, -0.42)).normalized()
    out = right.cross(rise).normalized()
    vertices, skin = [], []
    for layer in (0, 1):
        for j in range(up):
            v = j / (up - 1)
            width = 0.0250 * (1 - v**1.6) * (1 + 0.12 * math.sin(math.pi * v)) + 0.0018
            for i in range(across):
                u = 2 * i / (across - 1) - 1
                cup = 0.017 * (1 - v) ** 0.7 * u * u
                thick = 0.0030 * (1 - 0.6 * v) * (1 if layer else -1) * 0.5
                p = base + rise * v + right * (u * width) + out * (cup + thick)
                vertices.append((p.x * side, p.y, p.z))
                inner = layer == 1 and abs(u) < 0.72 and 0.1 < v < 0.86
                skin.append(1.0 if inner else 0.0)
    count = across * up

    def at(layer: int, i: int, j: int) -> int:
        return layer * count + j * across + i

    quads = []
    for j in range(up - 1):
        for i in range(across - 1):
            quads.append([at(0, i, j), at(0, i, j + 1), at(0, i + 1, j + 1), at(0, i + 1, j)])
            quads.append([at(1, i, j), at(1, i + 1, j), at(1, i + 1, j + 1), at(1, i, j + 1)])
        quads.append([at(0, 0, j), at(1, 0, j), at(1, 0, j + 1), at(0, 0, j + 1)])
        last = across - 1
        quads.append([at(0, last, j), at(0, last, j + 1), at(1, last, j + 1), at(1, last, j)])
    for i in range(across - 1):
        top = up - 1
        quads.append([at(0, i, top), at(1, i, top), at(1, i + 1, top), at(0, i + 1, top)])
    quads = np.array(quads)
    return np.array(vertices), quads if side > 0 else quads[:, ::-1], np.array(skin)


def _ball(
    centre: Vector, radius: float, segments: int, rings: int, upper_only: bool = False
) -> tuple[np.ndarray, np.ndarray]:
    """A sphere whose poles are on Y; `upper_only` keeps the half that a closing lid is made of."""
    vertices, quads = [], []
    sweep = math.pi if upper_only else 2 * math.pi
    columns = segments + 1 if upper_only else segments
    for i in range(columns):
        a = sweep * i / segments
        for j in range(rings + 1):
            b = math.pi * j / rings
            along = -math.cos(b) if not upper_only else math.cos(b)
            ring = math.sin(b)
            if upper_only:
                p = (along * radius, -math.cos(a) * ring * radius, math.sin(a) * ring * radius)
            else:
                p = (math.cos(a) * ring * radius, along * radius, math.sin(a) * ring * radius)
            vertices.append((centre.x + p[0], centre.y + p[1], centre.z + p[2]))
    for i in range(columns - 1 if upper_only else columns):
        for j in range(rings):
            k, n = i * (rings + 1), ((i + 1) % columns) * (rings + 1)
            quads.append([k + j, n + j, n + j + 1, k + j + 1])
    quads = np.array(quads)
    return np.array(vertices), quads if upper_only else quads[:, ::-1]


def _collar(skin: Skin) -> tuple[np.ndarray, np.ndarray]:
    """A band round the neck, wherever its skin is: vertices and quads."""
    segments, half, thick = 36, 0.0075, 0.0045
    turn = Vector((0.0, 0.0, 1.0)).rotation_difference(COLLAR_WAY).to_matrix()
    local = (skin.vertices - np.array(COLLAR_AT)) @ np.array(turn)
    near = local[(np.abs(local[:, 2]) < 0.012) & (np.hypot(local[:, 0], local[:, 1]) < 0.075)]
    angles = np.arctan2(near[:, 1], near[:, 0])
    radii = np.hypot(near[:, 0], near[:, 1])
    vertices = []
    for i in range(segments):
        a = 2 * math.pi * i / segments - math.pi
        apart = np.abs((angles - a + math.pi) % (2 * math.pi) - math.pi)
        radius = float(radii[apart < 0.22].max())
        for r, z in ((-0.002, -half), (thick, -half), (thick, half), (-0.002, half)):
            point = Vector(((radius + r) * math.cos(a), (radius + r) * math.sin(a), z))
            vertices.append(tuple(COLLAR_AT + turn @ point))
    quads = []
    for i in range(segments):
        k, n = 4 * i, 4 * ((i + 1) % segments)
        quads += [[k + j, n + j, n + (j + 1) % 4, k + (j + 1) % 4] for j in range(4)]
    return np.array(vertices), np.array(quads)


@kind(
    "cat",
    (0.164, 0.806, 0.397),
    "walks",
    front="-y",
    coat=Choice("coat", COATS),
    collar=words("collar", "none", *dogs.COLLARS),
)
def cat(name: str, rng: random.Random, *, coat: Coat = GREY_TABBY, collar: str = "none") -> bpy.types.Object:
    """The skinned mesh in its rest pose; its parent is the armature, which stands where the cat stands."""
    skin = rest_skin()
    seed = Vector((rng.uniform(0, 50), rng.uniform(0, 50), rng.uniform(0, 50)))
    parts: list[tuple[np.ndarray, np.ndarray, np.ndarray, str | None, int]] = [
        (skin.vertices, skin.faces, _markings(skin.vertices, coat, seed), None, 0)
    ]
    for side, suffix in ((1, ".L"), (-1, ".R")):
        vertices, faces, bare = _ear(side)
        marks = np.zeros((len(vertices), 4))
        marks[:, 2], marks[:, 3] = 0.75 * bare, 1
        marks[:, 0] = 0.5 * coat.stripes * (1 - bare)
        parts.append((vertices, faces, marks, "ear" + suffix, 0))
        eye = joint("eye" + suffix)
        vertices, faces = _ball(eye, EYE_RADIUS_M, 20, 14)
        parts.append((vertices, faces, np.zeros((len(vertices), 4)), "head", 1))
        vertices, faces = _ball(eye, LID_RADIUS_M, 10, 14, upper_only=True)
        marks = np.zeros((len(vertices), 4))
        marks[:, 0] = 0.35 * coat.stripes
        parts.append((vertices, faces, marks, "lid" + suffix, 0))
    if collar != "none":
        vertices, faces = _collar(skin)
        parts.append((vertices, faces, np.zeros((len(vertices), 4)), _LIKE_SKIN, 2))

    mesh = bpy.data.meshes.new(name)
    offset, all_faces, material_index = 0, [], []
    for vertices, faces, _, _, material in parts:
        all_faces += (faces + offset).tolist()
        material_index += [material] * len(faces)
        offset += len(vertices)
    points = np.concatenate([p[0] for p in parts])
    mesh.from_pydata(points, [], all_faces)
    mesh.polygons.foreach_set("material_index", material_index)
    mesh.shade_smooth()
    rest = mesh.attributes.new("rest_position", "FLOAT_VECTOR", "POINT")
    rest.data.foreach_set("vector", points.astype(np.float32).ravel())
    marks = np.concatenate([p[2] for p in parts]).astype(np.float32)
    mesh.attributes.new("coat", "FLOAT_COLOR", "POINT").data.foreach_set("color", marks.ravel())
    mesh.materials.append(interior.fur(f"{name}_fur", coat, rng))
    mesh.materials.append(interior.cat_eye(f"{name}_eye", coat.eye, tuple(LIMB_JOINTS["eye"])))
    if collar != "none":
        mesh.materials.append(dogs.collar(f"{name}_collar", collar))
    mesh.update()

    body = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(body)
    _weigh(body, skin, parts)
    return hang(body, armature(f"{name}_armature", [at_rest(bone) for bone in BONES]))


def _weigh(body: bpy.types.Object, skin: Skin, parts: list) -> None:
    for bone in BONES:
        body.vertex_groups.new(name=bone.name)
    for column, group in enumerate(skin.groups):
        target = body.vertex_groups[group]
        for index in np.nonzero(skin.weights[:, column])[0]:
            target.add([int(index)], float(skin.weights[index, column]), "REPLACE")
    offset = 0
    for vertices, _, _, bone, _ in parts:
        if bone == _LIKE_SKIN:
            _weigh_like_skin(body, skin, vertices, offset)
        elif bone is not None:
            body.vertex_groups[bone].add(list(range(offset, offset + len(vertices))), 1.0, "REPLACE")
        offset += len(vertices)


def _weigh_like_skin(body: bpy.types.Object, skin: Skin, vertices: np.ndarray, offset: int) -> None:
    for k, vertex in enumerate(vertices):
        nearest = int(np.argmin(np.square(skin.vertices - vertex).sum(axis=1)))
        for column in np.nonzero(skin.weights[nearest])[0]:
            body.vertex_groups[skin.groups[column]].add(
                [offset + k], float(skin.weights[nearest, column]), "REPLACE"
            )
