"""A dog of about half a metre at the shoulder: one smooth skinned body, ears, eyes, jaw and a collar.

Owns proportions (joints, volumes), skin weights and where a coat has which colour. Refuses to know how a dog
moves (motion/dogs.py). The armature's bones have no parents: each carries its flesh from rest to pose. Rest
pose: standing, facing -Y, paws on z = 0, origin between the paws; metres.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import dataclass

import bpy
import numpy as np
from mathutils import Matrix, Vector, noise

from l4d_blender.scene.catalogue import kind, words

from ..scene.colour import Colour, rgb
from . import implicit, mesh
from .materials import dogs as materials
from .rigs import hang, upright_armature

VOXEL_M = 0.0088
BODY_FACES = 13000
TAIL_BONES = 6
SIDES = (".L", ".R")


JOINTS: dict[str, tuple[float, float, float]] = {
    "pelvis": (0.0, 0.255, 0.455),
    "loin": (0.0, 0.150, 0.465),
    "ribs": (0.0, 0.010, 0.460),
    "chest": (0.0, -0.120, 0.455),
    "neck": (0.0, -0.225, 0.455),
    "skull": (0.0, -0.345, 0.570),
    "jaw": (0.0, -0.385, 0.556),
    "nose": (0.0, -0.545, 0.562),
}
LIMB_JOINTS: dict[str, tuple[float, float, float]] = {
    "scapula": (0.055, -0.165, 0.470),
    "shoulder": (0.078, -0.245, 0.355),
    "elbow": (0.082, -0.165, 0.262),
    "wrist": (0.078, -0.180, 0.100),
    "forepaw": (0.078, -0.196, 0.020),
    "hip": (0.068, 0.250, 0.405),
    "knee": (0.088, 0.180, 0.275),
    "hock": (0.076, 0.300, 0.150),
    "hindpaw": (0.076, 0.268, 0.020),
}
EYE = Vector((0.0405, -0.4460, 0.6045))
COLLAR_AT = Vector((0.0, -0.262, 0.485))
NECK_WAY = Vector((0.0, -0.72, 0.69)).normalized()
COLLAR_RADIUS_M = 0.083


def tail_joint(i: int) -> Vector:
    """Rest joints of the tail, from its root."""
    return Vector((0.0, 0.325 + 0.058 * i, 0.445 - 0.020 * i + 0.003 * i * i))


def joint(name: str) -> Vector:
    """A rest joint by name; limb joints take a side suffix ("wrist.L" is at +x)."""
    if name.endswith(SIDES):
        x, y, z = LIMB_JOINTS[name[:-2]]
        return Vector((x if name.endswith("L") else -x, y, z))
    if name.startswith("tail"):
        return tail_joint(int(name[4:]))
    return Vector(JOINTS[name])


def bone_heads() -> dict[str, Vector]:
    """Every bone and the joint that it turns about; the pelvis comes first, it carries the heading."""
    heads = {name: joint(name) for name in ("pelvis", "loin", "ribs", "chest", "neck")}
    heads |= {"head": joint("skull"), "jaw": joint("jaw")}
    heads |= {f"tail{i}": tail_joint(i) for i in range(TAIL_BONES)}
    for side in SIDES:
        for bone, at in (
            ("scapula", "scapula"),
            ("upperarm", "shoulder"),
            ("forearm", "elbow"),
            ("forepaw", "wrist"),
            ("foretoe", "forepaw"),
            ("thigh", "hip"),
            ("shin", "knee"),
            ("hindpaw", "hock"),
            ("hindtoe", "hindpaw"),
        ):
            heads[bone + side] = joint(at + side)
    return heads


@dataclass(frozen=True)
class Coat:
    """Linear RGB: `base` all over, `pale` on belly, muzzle and feathering, `dark` on ears and back."""

    base: Colour
    pale: Colour
    dark: Colour
    white: Colour | None = None
    ears: str = "floppy"
    eye: Colour = (0.055, 0.025, 0.010)


COATS: dict[str, Coat] = {
    "golden": Coat(base=(0.46, 0.235, 0.075), pale=(0.66, 0.44, 0.21), dark=(0.33, 0.145, 0.040)),
    "black_white": Coat(
        base=(0.020, 0.018, 0.018),
        pale=(0.030, 0.026, 0.024),
        dark=(0.014, 0.013, 0.013),
        white=(0.74, 0.71, 0.66),
        ears="pricked",
    ),
    "chocolate": Coat(base=(0.115, 0.048, 0.022), pale=(0.17, 0.080, 0.040), dark=(0.075, 0.030, 0.014)),
    "black": Coat(base=(0.020, 0.018, 0.018), pale=(0.030, 0.026, 0.024), dark=(0.014, 0.013, 0.013)),
    "white": Coat(base=(0.62, 0.57, 0.49), pale=(0.72, 0.69, 0.63), dark=(0.52, 0.44, 0.34), ears="pricked"),
    "grey": Coat(
        base=(0.17, 0.17, 0.18), pale=(0.30, 0.30, 0.30), dark=(0.085, 0.087, 0.095), ears="pricked"
    ),
    "brown_white": Coat(
        base=(0.20, 0.075, 0.025),
        pale=(0.24, 0.10, 0.04),
        dark=(0.13, 0.045, 0.016),
        white=(0.74, 0.71, 0.66),
    ),
}


# --- flesh ------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class _Egg:
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


Flesh = list[tuple[str, implicit.Cone | _Egg]]


def _flesh() -> Flesh:
    """All volumes of a dog at rest, each with the bone that carries it."""

    def egg(bone: str, centre, radii, pitch: float = 0.0, blend: float = 0.05):
        return bone, _Egg(np.array(centre, float), np.array(radii, float), pitch, blend)

    def cone(bone: str, a, b, ra: float, rb: float, blend: float = 0.03):
        return bone, implicit.Cone(np.array(a, float), np.array(b, float), ra, rb, blend)

    volumes = [
        egg("chest", (0, -0.170, 0.372), (0.096, 0.125, 0.118), 0.20),
        egg("chest", (0, -0.235, 0.365), (0.066, 0.060, 0.085), 0.35),
        egg("ribs", (0, -0.055, 0.378), (0.098, 0.145, 0.112), 0.05),
        egg("loin", (0, 0.085, 0.402), (0.084, 0.135, 0.086), -0.10),
        egg("pelvis", (0, 0.215, 0.412), (0.080, 0.105, 0.080), 0.10),
        egg("chest", (0, -0.130, 0.440), (0.060, 0.090, 0.045), 0.0),
        cone("neck", (0, -0.190, 0.430), (0, -0.275, 0.510), 0.084, 0.070, 0.05),
        cone("neck", (0, -0.275, 0.510), (0, -0.352, 0.580), 0.070, 0.060, 0.04),
        egg("head", (0, -0.385, 0.600), (0.062, 0.068, 0.054), 0.0, 0.025),
        egg("head", (0, -0.400, 0.572), (0.056, 0.055, 0.042), 0.0, 0.025),
        cone("head", (0, -0.435, 0.578), (0, -0.528, 0.564), 0.038, 0.0275, 0.022),
        egg("head", (0, -0.430, 0.602), (0.040, 0.030, 0.024), 0.35, 0.016),
        egg("head", (0, -0.540, 0.560), (0.0250, 0.016, 0.019), 0.0, 0.010),
        egg("head", (0, -0.555, 0.573), (0.0145, 0.0095, 0.0105), 0.0, 0.004),
        cone("jaw", (0, -0.405, 0.545), (0, -0.505, 0.533), 0.026, 0.0165, 0.006),
    ]
    for s, side in ((1, ".L"), (-1, ".R")):
        j = {name: np.array(joint(name + side)) for name in LIMB_JOINTS}
        volumes += [
            egg("head", (0.044 * s, -0.398, 0.580), (0.026, 0.036, 0.030), 0.0, 0.02),
            egg("head", (0.016 * s, -0.535, 0.553), (0.0155, 0.020, 0.0155), 0.0, 0.008),
            egg("head", (0.028 * s, -0.428, 0.617), (0.018, 0.015, 0.010), 0.3, 0.014),
            egg("scapula" + side, (0.062 * s, -0.190, 0.400), (0.040, 0.060, 0.100), 0.45),
            cone("upperarm" + side, j["shoulder"], j["elbow"], 0.054, 0.040, 0.04),
            cone("forearm" + side, j["elbow"], j["wrist"], 0.039, 0.0235, 0.02),
            cone("forepaw" + side, j["wrist"], j["forepaw"] + (0, 0.004, 0.012), 0.0235, 0.0225, 0.01),
            egg("foretoe" + side, (0.078 * s, -0.214, 0.020), (0.030, 0.040, 0.020), 0.0, 0.012),
            egg("thigh" + side, (0.078 * s, 0.225, 0.350), (0.048, 0.088, 0.112), -0.40),
            cone("thigh" + side, j["hip"], j["knee"], 0.066, 0.050, 0.03),
            cone("shin" + side, j["knee"], j["hock"], 0.046, 0.0215, 0.025),
            cone("hindpaw" + side, j["hock"], j["hindpaw"] + (0, 0.004, 0.012), 0.0215, 0.0200, 0.01),
            egg("hindtoe" + side, (0.076 * s, 0.250, 0.019), (0.028, 0.040, 0.019), 0.0, 0.012),
        ]
        for i in (-1.0, -0.34, 0.34, 1.0):
            drop = 0.007 * i * i
            for bone, x, y in (("foretoe", 0.078, -0.243), ("hindtoe", 0.076, 0.221)):
                centre = (x * s + 0.0185 * i, y + drop, 0.0155)
                volumes.append(egg(bone + side, centre, (0.0098, 0.0170, 0.0145), 0.0, 0.005))
    radii = (0.036, 0.036, 0.035, 0.033, 0.029, 0.022, 0.010)
    volumes.append(cone("pelvis", (0, 0.255, 0.432), tail_joint(0), 0.056, radii[0], 0.04))
    for i in range(TAIL_BONES):
        volumes.append(cone(f"tail{i}", tail_joint(i), tail_joint(i + 1), radii[i], radii[i + 1], 0.01))
    return volumes


@dataclass
class _Skin:
    """What all dogs share; built once per process."""

    vertices: np.ndarray
    faces: np.ndarray
    groups: list[str]
    weights: np.ndarray


_skins: list[_Skin] = []


def _skin() -> _Skin:
    if not _skins:
        flesh = _flesh()
        low = np.min([shape.bounds()[0] for _, shape in flesh], axis=0) - 0.03
        high = np.max([shape.bounds()[1] for _, shape in flesh], axis=0) + 0.03
        grid = implicit.Grid.over(low, high, VOXEL_M)
        for _, shape in flesh:
            grid.add(shape, margin=0.07)
        verts, quads = implicit.surface_nets(grid)
        verts = implicit.relax(verts, quads, 3)
        verts[:, 2] = np.maximum(verts[:, 2], 0.0005)
        rough = mesh.from_pydata("dog_decimation", verts.tolist(), quads.tolist())
        mesh.decimate(rough, min(1.0, BODY_FACES / (2 * len(quads))))
        data = rough.data
        data.calc_loop_triangles()
        points = np.array([tuple(v.co) for v in data.vertices])
        faces = np.array([tuple(t.vertices) for t in data.loop_triangles])
        bpy.data.objects.remove(rough)
        _skins.append(_Skin(points, faces, *_weights(flesh, points, faces)))
    return _skins[0]


def _weights(flesh: Flesh, points: np.ndarray, faces: np.ndarray) -> tuple[list[str], np.ndarray]:
    """Weights fall off with the distance to each bone's flesh, then diffuse over the surface."""
    groups = sorted({bone for bone, _ in flesh})
    distance = np.full((len(points), len(groups)), 1.0)
    for bone, shape in flesh:
        column = groups.index(bone)
        distance[:, column] = np.minimum(distance[:, column], shape(points))
    softness = np.array([0.006 if g in ("head", "jaw") else 0.012 for g in groups])
    weights = np.exp(-np.clip(distance - distance.min(axis=1, keepdims=True), 0, 0.2) / softness)
    edges = np.concatenate([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])
    a, b = np.unique(np.sort(edges, axis=1), axis=0).T
    count = len(points)
    degree = np.maximum(np.bincount(a, minlength=count) + np.bincount(b, minlength=count), 1)
    # The mouth must be able to open: lips would tear apart if jaw and head mixed too far.
    for _ in range(9):
        mean = [np.bincount(a, c[b], count) + np.bincount(b, c[a], count) for c in weights.T]
        weights = 0.45 * weights + 0.55 * np.stack(mean, axis=1) / degree[:, None]
    weights[weights < 0.02 * weights.max(axis=1, keepdims=True)] = 0.0
    return groups, weights / weights.sum(axis=1, keepdims=True)


# --- coat -------------------------------------------------------------------------------------------------


def _step(low: float, high: float, x: float) -> float:
    t = min(1.0, max(0.0, (x - low) / (high - low)))
    return t * t * (3.0 - 2.0 * t)


def _mixed(a: Colour, b: Colour, t: float) -> Colour:
    return rgb(x + (y - x) * t for x, y in zip(a, b, strict=True))


def _paint(coat: Coat, seed: Vector) -> Callable[[Vector], Colour]:
    """Colour at a point of the body at rest."""

    def colour(p: Vector) -> Colour:
        wave = noise.noise(p * 9.0 + seed)
        fine = noise.noise(p * 40.0 - seed)
        if (p - Vector((0.0, -0.5595, 0.5745))).length < 0.0135:
            return (0.012, 0.010, 0.010)
        under = _step(0.36, 0.29, p.z + 0.03 * wave) * (abs(p.x) < 0.09) * (p.z > 0.24)
        legs = 0.5 * _step(0.20, 0.05, p.z)
        brush = _step(0.40, 0.50, p.y) * _step(0.02, -0.02, p.z - 0.40 + 0.02 * wave)
        muzzle = 0.6 * _step(-0.46, -0.52, p.y)
        shade = _mixed(coat.base, coat.pale, min(1.0, max(under, legs, brush, muzzle)))
        back = _step(0.42, 0.48, p.z + 0.02 * wave) * _step(-0.22, -0.12, p.y)
        shade = _mixed(shade, coat.dark, 0.45 * back)
        if coat.white is None:
            return shade
        edge = 0.018 * wave + 0.006 * fine
        ring = _step(0.075, 0.060, abs((p.y + 0.262) * 0.72 - (p.z - 0.470) * 0.69 + edge) + 0.02)
        ring *= p.y < -0.14
        bib = _step(-0.215, -0.245, p.y + edge) * _step(0.50, 0.46, p.z)
        socks = _step(0.135, 0.115, p.z + edge) if p.y < 0.1 else _step(0.075, 0.055, p.z + edge)
        tip = _step(0.585, 0.605, p.y + edge)
        blaze = _step(0.018, 0.010, abs(p.x) + 0.3 * edge) * (p.y < -0.36) * (p.z > 0.55)
        snout = _step(-0.475, -0.495, p.y + 0.5 * edge)
        belly = _step(0.315, 0.285, p.z + edge) * (abs(p.x) < 0.07) * (p.z > 0.24)
        return _mixed(shade, coat.white, max(ring, bib, socks, tip, blaze, snout, belly))

    return colour


def _floppy_ear(name: str, s: float) -> bpy.types.Object:
    """A leaf of leather that hangs beside the cheek, rooted high on the skull."""
    ear = mesh.tube(
        name,
        [
            (0.040 * s, -0.372, 0.646),
            (0.060 * s, -0.376, 0.642),
            (0.074 * s, -0.388, 0.612),
            (0.077 * s, -0.396, 0.578),
            (0.074 * s, -0.400, 0.548),
            (0.071 * s, -0.402, 0.536),
        ],
        [(0.022, 0.010), (0.034, 0.010), (0.040, 0.009), (0.036, 0.0085), (0.022, 0.007), (0.006, 0.003)],
        segments=16,
        up=(0.0, 0.0, 1.0),
    )
    return mesh.subdivide(ear, 1)


def _pricked_ear(name: str, s: float) -> bpy.types.Object:
    """An upright triangle whose tip folds over a little."""
    ear = mesh.tube(
        name,
        [
            (0.036 * s, -0.372, 0.632),
            (0.044 * s, -0.372, 0.660),
            (0.052 * s, -0.374, 0.688),
            (0.058 * s, -0.384, 0.708),
            (0.062 * s, -0.396, 0.712),
        ],
        [(0.032, 0.014), (0.030, 0.012), (0.020, 0.009), (0.010, 0.006), (0.003, 0.003)],
        segments=14,
        up=(0.0, -1.0, 0.0),
    )
    return mesh.subdivide(ear, 1)


# --- assembly ---------------------------------------------------------------------------------------------


@kind(
    "dog",
    (0.284, 1.24, 0.653),
    "walks",
    front="-y",
    coat=words("coat", *COATS),
    collar=words("collar", *materials.COLLARS),
)
def dog(name: str, rng: random.Random, *, coat: str = "golden", collar: str = "red") -> bpy.types.Object:
    """The skinned mesh at rest; its parent is the armature, which stands where the dog stands.

    `coat` is a key of COATS, `collar` one of materials.dogs.COLLARS.
    """
    look, skin = COATS[coat], _skin()
    colour = _paint(look, Vector([rng.uniform(-9, 9) for _ in range(3)]))
    body = mesh.from_pydata(f"{name}_skin", skin.vertices.tolist(), skin.faces.tolist())
    for column, bone in enumerate(skin.groups):
        group = body.vertex_groups.new(name=bone)
        for index in np.nonzero(skin.weights[:, column])[0]:
            group.add([int(index)], float(skin.weights[index, column]), "REPLACE")
    fur = materials.fur(f"{name}_fur")
    parts = [_finished(body, fur, colour)]

    def add(part: bpy.types.Object, bone: str, material: bpy.types.Material, shade) -> None:
        part.vertex_groups.new(name=bone).add(list(range(len(part.data.vertices))), 1.0, "REPLACE")
        parts.append(_finished(part, material, shade))

    for s in (1.0, -1.0):
        make = _floppy_ear if look.ears == "floppy" else _pricked_ear
        add(make(f"{name}_ear", s), "head", fur, lambda p: look.dark)
        ball = mesh.ellipsoid(f"{name}_eye", (0.0115, 0.0125, 0.0125), 16, 10)
        mesh.transform(ball, Matrix.Translation((EYE.x * s, EYE.y, EYE.z)))
        add(ball, "head", materials.eye(f"{name}_eye", look.eye), lambda p: look.eye)
    tongue = mesh.ellipsoid(f"{name}_tongue", (0.015, 0.045, 0.005), 12, 8, centre=(0, -0.462, 0.5535))
    add(tongue, "jaw", materials.tongue(f"{name}_tongue"), lambda p: (0.5, 0.12, 0.12))
    radius = COLLAR_RADIUS_M
    band = mesh.lathe(
        f"{name}_collar",
        [(radius, -0.013), (radius + 0.007, -0.013), (radius + 0.007, 0.013), (radius, 0.013)],
        40,
        close_bottom=False,
    )
    askew = Vector((0.0, 0.0, 1.0)).rotation_difference(NECK_WAY).to_matrix().to_4x4()
    band_frame = Matrix.Translation(COLLAR_AT) @ askew
    mesh.transform(band, band_frame @ Matrix.Diagonal((0.97, 1.04, 1.0, 1.0)))
    add(band, "neck", materials.collar(f"{name}_collar", collar), lambda p: (0.5, 0.5, 0.5))

    whole = mesh.store_rest_position(mesh.join(name, parts))
    return hang(whole, upright_armature(f"{name}_rig", bone_heads()))


def _finished(part: bpy.types.Object, material: bpy.types.Material, shade) -> bpy.types.Object:
    layer = part.data.attributes.new("coat", "FLOAT_COLOR", "POINT")
    layer.data.foreach_set("color", [c for v in part.data.vertices for c in (*shade(v.co), 1.0)])
    return mesh.set_material(mesh.shade_smooth(part), material)
