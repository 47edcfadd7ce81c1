"""A hand seen from near: palm, four fingers of three phalanges, thumb, nails, and a sleeved arm.

Hand frame: wrist at the origin, fingers along -Y, palm facing -Z; the rest pose is flat, the arm lies
straight behind it along +Y. Right hands have the thumb at +X, left hands are their mirror image. Owns shape
and weights.
"""

from __future__ import annotations

import random
from dataclasses import dataclass, field

import bpy
import numpy as np
from mathutils import Matrix

from l4d_blender.scene.catalogue import Choice, kind

from ..scene.colour import rgb
from .anatomy import FINGERS, Bone, vec
from .implicit import Blob, Cone, Ellipsoid, Grid, blended, clip, relax, smooth_min, smoothstep, surface_nets
from .materials import skin as materials
from .person import CLOTH_COLOURS, SKIN_TONES, Cloth
from .rigs import armature
from .shell import Shell, make_mesh, merged

DIGITS = ("thumb", *FINGERS)
FOREARM_M, UPPER_ARM_M = 0.255, 0.285
ELBOW = vec(0.0, FOREARM_M, 0.0)
SHOULDER = vec(0.0, FOREARM_M + UPPER_ARM_M, 0.0)
CELL_M = 0.0030

KNUCKLES = {
    "index": (0.0265, -0.089, 0.002),
    "middle": (0.0055, -0.093, 0.0035),
    "ring": (-0.0150, -0.088, 0.002),
    "pinky": (-0.0335, -0.078, -0.002),
}
LENGTHS = {
    "index": (0.044, 0.026, 0.021),
    "middle": (0.049, 0.030, 0.022),
    "ring": (0.045, 0.028, 0.022),
    "pinky": (0.035, 0.021, 0.019),
    "thumb": (0.046, 0.034, 0.026),
}
SPREAD = {"index": 0.075, "middle": 0.0, "ring": -0.075, "pinky": -0.16}
RADII = {
    "index": (0.0096, 0.0086, 0.0078, 0.0062),
    "middle": (0.0098, 0.0088, 0.0080, 0.0064),
    "ring": (0.0094, 0.0084, 0.0076, 0.0061),
    "pinky": (0.0084, 0.0074, 0.0067, 0.0054),
    "thumb": (0.0150, 0.0112, 0.0102, 0.0074),
}


@dataclass(frozen=True)
class HandLook:
    """Skin tone (a name of person.SKIN_TONES), sleeve and size of a hand."""

    skin: str = "fair"
    sleeve: Cloth = field(default_factory=lambda: Cloth("blue"))
    cuff: str = "navy"
    scale: float = 1.0
    nails: tuple[float, float, float] | None = None


def digit_joints(digit: str) -> np.ndarray:
    """The four joints of a right finger or thumb in the flat rest pose, root to tip."""
    if digit == "thumb":
        ways = [vec(0.66, -0.70, -0.26), vec(0.55, -0.81, -0.20), vec(0.47, -0.86, -0.16)]
        points = [vec(0.021, -0.022, -0.009)]
    else:
        turn = SPREAD[digit]
        ways = [vec(np.sin(turn), -np.cos(turn), 0.0)] * 3
        points = [np.array(KNUCKLES[digit])]
    for way, length in zip(ways, LENGTHS[digit]):
        points.append(points[-1] + length * way / np.linalg.norm(way))
    return np.array(points)


JOINTS = {digit: digit_joints(digit) for digit in DIGITS}


def _bones() -> list[Bone]:
    bones = [Bone("hand", vec(0, 0, 0), vec(0, -0.06, 0), None)]
    for digit in DIGITS:
        p = JOINTS[digit]
        for n in range(3):
            parent = "hand" if n == 0 else f"{digit}_{n}"
            bones.append(Bone(f"{digit}_half_{n + 1}", p[n], p[n + 1], parent))
            bones.append(Bone(f"{digit}_{n + 1}", p[n], p[n + 1], parent))
    bones += [
        Bone("wrist", vec(0, 0, 0), vec(0, 0.05, 0), None),
        Bone("forearm", ELBOW, vec(0, 0, 0), None),
        Bone("elbow", ELBOW, vec(0, 0.1, 0), None),
        Bone("upper_arm", SHOULDER, ELBOW, None),
    ]
    return bones


BONES = _bones()


def _palm_blobs() -> list[Blob]:
    up = vec(0, 0, 1)
    blobs: list[Blob] = [Cone(vec(0, 0.09, 0.0), vec(0, 0.0, 0.0), 0.031, 0.0275, 0.0, up, 0.72)]
    for digit in FINGERS:
        knuckle = np.array(KNUCKLES[digit])
        start = vec(0.45 * knuckle[0], -0.012, -0.001)
        blobs.append(Cone(start, knuckle + vec(0, 0.002, -0.002), 0.0175, 0.0118, 0.014, up, 0.80))
    blobs += [
        Ellipsoid(vec(0.021, -0.043, -0.0105), vec(0.0170, 0.031, 0.0155), 0.014),
        Ellipsoid(vec(-0.024, -0.040, -0.0085), vec(0.0150, 0.036, 0.0140), 0.014),
        Ellipsoid(vec(0.0, -0.055, -0.002), vec(0.030, 0.038, 0.0115), 0.012),
    ]
    for digit in FINGERS:
        knuckle = np.array(KNUCKLES[digit])
        blobs.append(Ellipsoid(knuckle + vec(0, 0.003, 0.0052), vec(0.0078, 0.0095, 0.0064), 0.005))
        blobs.append(
            Cone(vec(0.4 * knuckle[0], -0.01, 0.0125), knuckle + vec(0, 0.008, 0.0062), 0.0022, 0.0030, 0.006)
        )
    return blobs


def _digit_blobs(digit: str) -> list[Blob]:
    p, r = JOINTS[digit], RADII[digit]
    blobs: list[Blob] = []
    for n in range(3):
        way = (p[n + 1] - p[n]) / np.linalg.norm(p[n + 1] - p[n])
        end = p[n + 1] - way * (r[3] * 0.9 if n == 2 else 0.0)
        blobs.append(Cone(p[n], end, r[n], r[n + 1], 0.004))
        if n < 2:
            blobs.append(Ellipsoid(p[n + 1] + vec(0, 0, 0.0012), vec(1, 1, 1) * r[n + 1] * 1.07, 0.003))
    tip = p[3] - way * r[3] * 1.5
    blobs.append(Ellipsoid(tip + vec(0, 0, -0.0012), vec(1, 1, 0.85) * r[3] * 1.16, 0.004))
    return blobs


DIGIT_BLOBS = {digit: _digit_blobs(digit) for digit in DIGITS}


def _skin_shell(material: bpy.types.Material) -> Shell:
    grid = Grid.over(vec(-0.075, -0.215, -0.045), vec(0.10, 0.088, 0.042), CELL_M)
    for blob in _palm_blobs():
        grid.add(blob, margin=0.03)
    everywhere = grid.points()
    for digit in DIGITS:
        low, high = JOINTS[digit].min(axis=0) - 0.030, JOINTS[digit].max(axis=0) + 0.030
        first = np.clip(((low - grid.origin) / CELL_M).astype(int), 0, None)
        last = ((high - grid.origin) / CELL_M).astype(int) + 1
        window = tuple(slice(a, b) for a, b in zip(first, last))
        p = everywhere[window]
        width = 0.011 * smoothstep(-0.122, -0.098, p[..., 1]) + 0.0006 if digit != "thumb" else 0.013
        grid.values[window] = smooth_min(grid.values[window], blended(DIGIT_BLOBS[digit], p), width)
    verts, faces = surface_nets(grid)
    verts = relax(verts, faces, 1)
    verts, cut = clip(verts, faces, verts[:, 1] - 0.075)
    weights = hand_weights(verts)
    return Shell("skin", verts, cut, weights, [material], tint=_complexion(verts))


def hand_weights(p: np.ndarray) -> dict[str, np.ndarray]:
    """Bone weights of points on palm, digits and wrist, in right-hand space."""
    near = {"palm": blended(_palm_blobs(), p)} | {digit: blended(DIGIT_BLOBS[digit], p) for digit in DIGITS}
    nearest = np.min(list(near.values()), axis=0)
    weights: dict[str, np.ndarray] = {}
    share = {name: np.exp(-np.clip((d - nearest) / 0.0022, 0, 40)) for name, d in near.items()}
    total = np.sum(list(share.values()), axis=0)
    palm = share["palm"] / total
    for digit in DIGITS:
        mine = share[digit] / total
        for bone, w in _digit_weights(p, digit).items():
            if bone == "hand":
                palm = palm + mine * w
            else:
                weights[bone] = mine * w
    fore = smoothstep(0.018, 0.050, p[:, 1])
    half = smoothstep(-0.014, 0.016, p[:, 1]) * (1.0 - fore)
    return weights | {"hand": palm * (1.0 - fore - half), "wrist": palm * half, "forearm": palm * fore}


def _digit_weights(p: np.ndarray, digit: str) -> dict[str, np.ndarray]:
    joints, r = JOINTS[digit], RADII[digit]
    along = np.full(len(p), 0.0)
    best, start = np.full(len(p), 1e9), 0.0
    for n in range(3):
        axis = joints[n + 1] - joints[n]
        length = float(np.linalg.norm(axis))
        t = np.clip((p - joints[n]) @ axis / length**2, -1.0 if n == 0 else 0.0, 1.0)
        gap = np.linalg.norm(p - joints[n] - t[:, None] * axis, axis=1)
        along, best, start = (
            np.where(gap < best, start + t * length, along),
            np.minimum(gap, best),
            start + length,
        )
    first, second = LENGTHS[digit][0], LENGTHS[digit][0] + LENGTHS[digit][1]
    k = r[1]
    steps = [
        smoothstep(-1.2 * k, 0.1 * k, along),
        smoothstep(0.1 * k, 1.3 * k, along),
        smoothstep(first - 0.95 * k, first - 0.05 * k, along),
        smoothstep(first + 0.05 * k, first + 0.95 * k, along),
        smoothstep(second - 0.8 * k, second - 0.05 * k, along),
        smoothstep(second + 0.05 * k, second + 0.8 * k, along),
    ]
    names = (
        "hand",
        f"{digit}_half_1",
        f"{digit}_1",
        f"{digit}_half_2",
        f"{digit}_2",
        f"{digit}_half_3",
        f"{digit}_3",
    )
    weights, rest = {}, np.ones(len(p))
    for name, step in zip(names, [*steps, np.zeros(len(p))]):
        weights[name] = rest * (1.0 - step)
        rest = rest * step
    return weights


def _complexion(p: np.ndarray) -> np.ndarray:
    """Vertex colours: red knuckles and fingertips, a paler palm with its creases."""
    red = np.zeros(len(p))
    for digit in DIGITS:
        joints = JOINTS[digit]
        for n, strength in ((0, 0.5), (1, 0.8), (2, 0.5)):
            top = joints[n] + vec(0, 0, RADII[digit][n])
            red += strength * np.exp(-((np.linalg.norm((p - top) * vec(1, 0.8, 1), axis=1) / 0.0085) ** 2))
        red += 0.7 * np.exp(-((np.linalg.norm(p - joints[3], axis=1) / 0.011) ** 2))
    red += 0.35 * np.exp(-((np.linalg.norm(p - vec(0.022, -0.045, -0.025), axis=1) / 0.02) ** 2))
    pale = smoothstep(0.0, -0.012, p[:, 2]) * 0.5
    tint = 1.0 - np.clip(red, 0, 1)[:, None] * vec(0.04, 0.20, 0.19) - pale[:, None] * vec(0.0, 0.02, 0.03)
    for digit in DIGITS:
        for n in (1, 2):
            joint = JOINTS[digit][n]
            way = (JOINTS[digit][n] - JOINTS[digit][n - 1]) / LENGTHS[digit][n - 1]
            d = p - joint
            ring = np.exp(-(((d @ way) / 0.0016) ** 2)) * (np.linalg.norm(d, axis=1) < 0.013)
            tint -= (0.16 * ring)[:, None] * vec(0.6, 1, 1)
    return np.clip(tint, 0, 1)


def thumb_up() -> np.ndarray:
    """Out of the thumb's nail, right hand."""
    way = JOINTS["thumb"][3] - JOINTS["thumb"][2]
    way = way / np.linalg.norm(way)
    out = vec(0.62, 0.18, 0.76)
    out = out - (out @ way) * way
    return out / np.linalg.norm(out)


def _nail(digit: str, material: bpy.types.Material) -> Shell:
    """A curved plate on the back of the last phalanx."""
    joints, r = JOINTS[digit], RADII[digit]
    way = (joints[3] - joints[2]) / np.linalg.norm(joints[3] - joints[2])
    up = thumb_up() if digit == "thumb" else vec(0, 0, 1)
    across = np.cross(way, up)
    u, v = np.meshgrid(np.linspace(-1, 1, 9), np.linspace(0, 1, 8))
    radius = (r[2] + (r[3] - r[2]) * (0.45 + 0.5 * v)) * 1.045
    length = 0.52 * LENGTHS[digit][2]
    side = u * (0.95 - 0.25 * np.abs(2 * v - 0.9) ** 3)
    angle = side * 0.82
    lift = radius * np.cos(angle) + 0.0009 * np.sin(np.pi * np.clip(v * 0.9, 0, 1)) - 0.0006
    base = joints[2] + way * (LENGTHS[digit][2] * 0.44)
    flat = (
        base
        + (v * length)[..., None] * way
        + (radius * np.sin(angle))[..., None] * across
        + lift[..., None] * up
        - (0.0016 * smoothstep(0.75, 1.0, v))[..., None] * up
    )
    verts = flat.reshape(-1, 3)
    thick = verts - 0.0012 * up
    faces: list[tuple[int, ...]] = []
    for row in range(7):
        for column in range(8):
            a = row * 9 + column
            faces.append((a, a + 1, a + 10, a + 9))
    rim = [
        *range(9),
        *[9 * k + 8 for k in range(1, 8)],
        *range(70, 62, -1),
        *[9 * k for k in range(6, 0, -1)],
    ]
    faces += [
        (rim[(n + 1) % len(rim)], rim[n], 72 + rim[n], 72 + rim[(n + 1) % len(rim)]) for n in range(len(rim))
    ]
    normal = np.cross(verts[1] - verts[0], verts[9] - verts[0])
    if normal @ up < 0.0:
        faces = [face[::-1] for face in faces]
    tip = np.where(v.ravel()[:, None] > 0.9, vec(1.0, 1.0, 1.0), vec(1.0, 0.93, 0.92))
    return Shell(
        "nail",
        np.vstack([verts, thick]),
        faces,
        {f"{digit}_3": np.ones(144)},
        [material],
        tint=np.vstack([tip, tip]),
    )


def _sleeve(name: str, cloth: bpy.types.Material, rib: bpy.types.Material) -> Shell:
    """Sleeve from the cuff to the shoulder with creases that gather at wrist and elbow."""
    rows = np.concatenate(
        [[0.064, 0.056, 0.050, 0.048, 0.050], np.linspace(0.054, 0.092, 9), np.linspace(0.098, 0.53, 64)]
    )
    turns = 40
    angle = 2.0 * np.pi * np.arange(turns) / turns
    y, a = np.meshgrid(rows, angle, indexing="ij")
    cuff = smoothstep(0.100, 0.090, y)
    swell = 0.0325 + 0.019 * smoothstep(0.09, 0.22, y) + 0.006 * smoothstep(0.26, 0.45, y)
    crease = np.sin(2 * np.pi * y / 0.034 + 1.3 * np.sin(a) + 2.0 * np.sin(2 * a + 9 * y)) + 0.6 * np.sin(
        2 * np.pi * y / 0.021 + 2.2 * np.cos(a - 0.6)
    )
    gather = (
        0.0009
        + 0.0030 * np.exp(-(((y - 0.125) / 0.04) ** 2))
        + 0.0042 * np.exp(-(((y - FOREARM_M) / 0.06) ** 2))
    )
    radius = swell + crease * gather * (1.0 - cuff) + 0.0007 * cuff * np.sin(turns / 2 * a)
    inner = np.zeros_like(y)
    inner[:3] = np.array([[0.0045], [0.0042], [0.0036]])
    radius = radius - inner
    verts = np.stack(
        [radius * np.cos(a), y, 0.80 * radius * np.sin(a) * (1 + 0.12 * smoothstep(0.1, 0.3, y))], axis=-1
    )
    verts = verts.reshape(-1, 3)
    faces: list[tuple[int, ...]] = []
    zone: list[int] = []
    for row in range(len(rows) - 1):
        for column in range(turns):
            right = (column + 1) % turns
            faces.append(
                (
                    row * turns + right,
                    row * turns + column,
                    (row + 1) * turns + column,
                    (row + 1) * turns + right,
                )
            )
            zone.append(1 if row < 13 else 0)
    faces.append(tuple((len(rows) - 1) * turns + column for column in range(turns)))
    zone.append(0)
    s = verts[:, 1] - FOREARM_M
    before, after = smoothstep(-0.055, -0.004, s), smoothstep(0.004, 0.055, s)
    weights = {"forearm": 1.0 - before, "elbow": before * (1.0 - after), "upper_arm": before * after}
    return Shell(f"{name}.sleeve", verts, faces, weights, [cloth, rib], material=np.array(zone))


@dataclass
class HandBody:
    """A built hand: its armature and skinned meshes."""

    rig: bpy.types.Object
    meshes: list[bpy.types.Object]
    side: str
    scale: float

    @property
    def parts(self) -> list[bpy.types.Object]:
        """Hand and sleeve; the rig moves them."""
        return self.meshes

    def place(self, matrix: Matrix) -> None:
        """Moves hand and arm."""
        self.rig.matrix_basis = matrix


@kind("hand", (0.147, 0.724, 0.105), side=Choice("side", {"left": "l", "right": "r"}))
def hand(name: str, rng: random.Random, *, look: HandLook = HandLook(), side: str = "r") -> HandBody:
    """A flat hand with its arm at the origin; `side` is "l" or "r"."""
    tone = SKIN_TONES[look.skin]
    skin = materials.skin(f"{name}.skin", tone)
    nail_colour = look.nails or rgb(min(c * f, 1.0) for c, f in zip(tone, (1.22, 1.12, 1.16)))
    nail = materials.gloss(f"{name}.nail", nail_colour, 0.28)
    flesh = merged(f"{name}.hand", [_skin_shell(skin), *[_nail(digit, nail) for digit in DIGITS]])
    sleeve = _sleeve(name, *(_sleeve_materials(name, look)))
    for shell in (flesh, sleeve):
        shell.verts = shell.verts * look.scale
        if side == "l":
            shell.verts = shell.verts * vec(-1, 1, 1)
            shell.faces = [face[::-1] for face in shell.faces]
    mirror = vec(-1, 1, 1) if side == "l" else vec(1, 1, 1)
    bones = [
        Bone(b.name, b.head * mirror * look.scale, b.tail * mirror * look.scale, b.parent) for b in BONES
    ]
    rig = armature(f"{name}.rig", bones)
    return HandBody(rig, [make_mesh(flesh, rig), make_mesh(sleeve, rig)], side, look.scale)


def _sleeve_materials(name: str, look: HandLook) -> tuple[bpy.types.Material, bpy.types.Material]:
    cloth, second = (
        CLOTH_COLOURS[c] if isinstance(c, str) else c for c in (look.sleeve.colour, look.sleeve.second)
    )
    sleeve = materials.cloth(
        f"{name}.sleeve",
        cloth,
        pattern=look.sleeve.pattern,
        second=second,
        repeat_m=look.sleeve.repeat_m,
        level="y",
    )
    return sleeve, materials.cloth(f"{name}.cuff", CLOTH_COLOURS[look.cuff])
