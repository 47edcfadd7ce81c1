"""The head: a sculpted face, eyes with lids, brows, lips, ears and hair, in one coordinate frame.

Head frame: chin at z = 0, crown near z = 0.227, facing -Y, for a head of 22.7 cm; `place` puts it on a neck.
Knows shapes only; colours come in as materials.
"""

from __future__ import annotations

from dataclasses import dataclass

import bpy
import numpy as np

from .anatomy import vec
from .implicit import (
    Blob,
    Cone,
    Ellipsoid,
    Grid,
    blended,
    relax,
    smooth_min,
    smoothstep,
    surface_nets,
    vertex_normals,
)
from .shell import Shell, grid_faces, rigid, tube

CENTRE = vec(0, -0.002, 0.112)
EYE = vec(0.0305, -0.0735, 0.1135)
EYE_RADIUS = 0.0125
HAIR_STYLES = ("short", "bob", "ponytail", "bun", "long")


@dataclass(frozen=True)
class Face:
    """What tells one face from another; factors around 1."""

    jaw: float = 1.0
    nose: float = 1.0
    brow: float = 1.0
    cheeks: float = 1.0
    feminine: bool = True


def skull(face: Face) -> list[Blob]:
    """Skull and jaw without features."""
    j = face.jaw
    return [
        Ellipsoid(vec(0, 0.014, 0.142), vec(0.0735, 0.094, 0.086), 0.02),
        Ellipsoid(vec(0, -0.026, 0.085), vec(0.060 * j, 0.060, 0.074), 0.03),
        Ellipsoid(vec(0, -0.040, 0.036), vec(0.041 * j, 0.042, 0.036), 0.03),
    ]


def face_blobs(face: Face) -> list[Blob]:
    """The sculpted face."""
    blobs = skull(face)
    blobs.append(Ellipsoid(vec(0, -0.074, 0.015), vec(0.016 * face.jaw, 0.013, 0.014), 0.016))
    for s in (-1.0, 1.0):
        blobs.append(Ellipsoid(vec(s * 0.040, -0.054, 0.086), vec(0.021, 0.021, 0.022) * face.cheeks, 0.022))
        ridge = 0.0075 if face.feminine else 0.0095
        blobs.append(
            Cone(vec(s * 0.010, -0.0815, 0.131), vec(s * 0.042, -0.0655, 0.133), ridge, ridge, 0.016)
        )
        blobs.append(Ellipsoid(vec(s * 0.0305, -0.092, 0.1130), vec(0.0185, 0.0135, 0.0120), -0.012))
    n = face.nose
    blobs.append(Cone(vec(0, -0.083, 0.126), vec(0, -0.099 - 0.006 * n, 0.088), 0.0065, 0.0100 * n, 0.010))
    for s in (-1.0, 1.0):
        blobs.append(Ellipsoid(vec(s * 0.0105, -0.0945, 0.0815), vec(0.0075 * n, 0.0095, 0.0070), 0.006))
    blobs.append(Ellipsoid(vec(0, -0.082, 0.0575), vec(0.023, 0.011, 0.011), 0.012))
    return blobs


def head_shell(face: Face, material: bpy.types.Material, lip_tint: np.ndarray) -> list[Shell]:
    """Skull, face, ears and lips, as one skin."""
    blobs = face_blobs(face)
    u = 2.0 * np.pi * np.arange(56) / 56
    azimuth = u - 0.52 * np.sin(u)
    v = np.linspace(0.0, 1.0, 44)
    polar = np.pi * (0.02 + 0.86 * (v - 0.055 * np.sin(2.0 * np.pi * v)))
    rows = np.stack(
        [
            np.outer(np.sin(polar), np.sin(azimuth)),
            -np.outer(np.sin(polar), np.cos(azimuth)),
            np.repeat(np.cos(polar)[:, None], 56, axis=1),
        ],
        axis=-1,
    )
    points = CENTRE + _cast(blobs, CENTRE, rows.reshape(-1, 3))[:, None] * rows.reshape(-1, 3)
    faces = [face[::-1] for face in grid_faces(44, 56, wrap=True)]
    crown = points[:56].mean(axis=0) + vec(0, 0, 0.0005)
    verts = np.vstack([points, crown])
    faces += [(len(points), n, (n + 1) % 56) for n in range(56)]
    parts = [
        Shell("head", verts, faces, rigid("head", len(verts)), [material], tint=_complexion(verts, face))
    ]
    parts += [_ear(s, material) for s in (-1.0, 1.0)]
    parts.append(_lips(blobs, material, lip_tint))
    return parts


def _cast(blobs: list[Blob], origin: np.ndarray, directions: np.ndarray, reach: float = 0.15) -> np.ndarray:
    """Distance along each ray to the outermost crossing of the surface."""
    steps = np.linspace(0.06, reach, 40)
    values = blended(blobs, origin + steps[:, None, None] * directions[None])
    inside = values < 0.0
    last = len(steps) - 1 - np.argmax(inside[::-1], axis=0)
    last = np.minimum(last, len(steps) - 2)
    column = np.arange(len(directions))
    a, b = values[last, column], values[last + 1, column]
    t = np.where(np.abs(a - b) > 1e-9, a / (a - b), 0.0)
    return steps[last] + np.clip(t, 0, 1) * (steps[1] - steps[0])


def _front(blobs: list[Blob], x: np.ndarray, z: np.ndarray) -> np.ndarray:
    """The y of the face's surface in front of (x, z)."""
    origin = np.stack([x, np.full_like(x, -0.02), z], axis=-1)
    steps = np.linspace(0.0, 0.12, 160)
    values = blended(blobs, origin[None] + steps[:, None, None] * vec(0, -1, 0))
    return -0.02 - steps[np.clip(len(steps) - 1 - np.argmax((values < 0.0)[::-1], axis=0), 0, None)]


def _complexion(p: np.ndarray, face: Face) -> np.ndarray:
    """Vertex colours: flushed cheeks, nose and ears, shaded eye sockets, a shaved chin."""

    def spot(centre: np.ndarray, radius: float) -> np.ndarray:
        return np.exp(-((np.linalg.norm(p - centre, axis=1) / radius) ** 2))

    flush = 0.55 * spot(vec(0, -0.105, 0.085), 0.018)
    dusk = np.zeros(len(p))
    for s in (-1.0, 1.0):
        flush = flush + 0.75 * spot(vec(s * 0.043, -0.070, 0.078), 0.022)
        dusk = dusk + spot(vec(s * 0.0305, -0.080, 0.114), 0.015)
    tint = 1.0 - flush[:, None] * vec(0.02, 0.16, 0.15) - dusk[:, None] * vec(0.16, 0.20, 0.17)
    if not face.feminine:
        beard = smoothstep(0.078, 0.055, p[:, 2]) * smoothstep(-0.01, -0.035, p[:, 1])
        tint -= beard[:, None] * vec(0.16, 0.13, 0.09)
    return np.clip(tint, 0.0, 1.0)


def _ear(side: float, material: bpy.types.Material) -> Shell:
    """An ear: a tilted bowl with a rolled rim and a lobe."""
    rows, columns = 7, 18
    verts = []
    for row in range(rows):
        r = row / (rows - 1)
        for column in range(columns):
            a = 2.0 * np.pi * column / columns
            egg = 1.0 + 0.12 * np.sin(a)
            rim = 0.004 * np.sin(np.pi * min(r * 1.15, 1.0)) * 1.5 - 0.005 * (r < 0.35)
            verts.append((0.009 * (r < 0.9) + rim, 0.0165 * r * egg * np.cos(a), 0.031 * r * np.sin(a)))
    p = np.array(verts)
    flare = 0.42 * (p[:, 1] + 0.016)
    tilt = 0.25 * p[:, 2]
    placed = np.stack([side * (0.0655 + p[:, 0] + flare), 0.016 + p[:, 1] + tilt, 0.103 + p[:, 2]], axis=1)
    faces = grid_faces(rows, columns, wrap=True)
    if side < 0.0:
        faces = [face[::-1] for face in faces]
    tint = np.tile(vec(0.98, 0.86, 0.85), (len(p), 1))
    return Shell("ear", placed, faces, rigid("head", len(p)), [material], tint=tint)


def _lips(blobs: list[Blob], material: bpy.types.Material, tint: np.ndarray) -> Shell:
    """Upper and lower lip as swollen patches on the face, meeting at a dark line."""
    columns, rows = 17, 9
    u, v = np.meshgrid(np.linspace(-1, 1, columns), np.linspace(-1, 1, rows))
    bow = 1.0 - 0.16 * np.exp(-((u / 0.16) ** 2))
    edge = np.sqrt(np.clip(1.0 - u**2, 0.0, 1.0))
    height = np.where(v > 0.0, 0.0064 * bow, 0.0072) * edge**0.8
    x, z = 0.0235 * u, 0.0535 + v * height + 0.0030 * u**2
    y = _front(blobs, x.ravel(), z.ravel()).reshape(x.shape)
    swell = 0.0042 * edge * np.clip(1.0 - v**2, 0, 1) ** 0.6 - 0.0042 * edge * np.exp(-((v / 0.17) ** 2))
    verts = np.stack([x, y - swell - 0.0002, z], axis=-1).reshape(-1, 3)
    line = np.exp(-((v / 0.15) ** 2)).reshape(-1, 1)
    colours = tint * (1.0 - 0.62 * line)
    fade = (edge * np.clip(1.0 - np.abs(v) ** 6, 0, 1)).reshape(-1, 1) ** 0.5
    colours = colours * fade + (1.0 - fade) * np.maximum(tint, 0.86)
    return Shell(
        "lips", verts, grid_faces(rows, columns), rigid("head", len(verts)), [material], tint=colours
    )


def eye_shells(
    white: bpy.types.Material,
    iris: bpy.types.Material,
    pupil: bpy.types.Material,
    skin: bpy.types.Material,
    lash: bpy.types.Material,
) -> list[Shell]:
    """Eyeballs with iris and pupil, upper and lower lids and a dark lash line."""
    parts = []
    for s in (-1.0, 1.0):
        centre = EYE * vec(s, 1, 1)
        turns, rings = 20, 11
        opening = np.concatenate([np.linspace(0.0, 0.50, 5), np.linspace(0.62, 1.9, rings - 5)])
        angle = 2.0 * np.pi * np.arange(turns) / turns
        ball = np.stack(
            [
                np.outer(np.sin(opening), np.cos(angle)),
                np.repeat(-np.cos(opening)[:, None], turns, 1),
                np.outer(np.sin(opening), np.sin(angle)),
            ],
            axis=-1,
        ).reshape(-1, 3)
        faces = grid_faces(rings, turns, wrap=True)
        zone = np.concatenate([np.full(turns, m) for m in [2, 2, 1, 1] + [0] * (rings - 5)])
        parts.append(
            Shell(
                "eye",
                centre + EYE_RADIUS * ball,
                faces,
                rigid("head", len(ball)),
                [white, iris, pupil],
                material=zone,
            )
        )
        parts.append(_lid(s, centre, skin, low=0.36, high=1.35, radius=1.10))
        parts.append(_lid(s, centre, skin, low=-1.2, high=-0.52, radius=1.07))
        parts.append(_lid(s, centre, lash, low=0.33, high=0.47, radius=1.13))
    return parts


def _lid(
    side: float, centre: np.ndarray, material: bpy.types.Material, *, low: float, high: float, radius: float
) -> Shell:
    """A band of a sphere round the eyeball between two elevations, pinched together at the corners."""
    columns, rows = 15, 6
    u, v = np.meshgrid(np.linspace(-1.25, 1.25, columns), np.linspace(0, 1, rows))
    closing = np.cos(u * np.pi / 2.5 * 0.98)
    edge = low if abs(low) < abs(high) else high
    far = high if edge == low else low
    elevation = edge * closing + (far - edge * closing) * (v if edge == low else 1.0 - v)
    tint = np.tile(vec(0.93, 0.86, 0.86), (u.size, 1))
    p = np.stack([np.cos(elevation) * np.sin(u), -np.cos(elevation) * np.cos(u), np.sin(elevation)], axis=-1)
    return Shell(
        "lid",
        centre + EYE_RADIUS * radius * p.reshape(-1, 3),
        grid_faces(rows, columns),
        rigid("head", u.size),
        [material],
        tint=tint,
    )


def brow_shells(face: Face, material: bpy.types.Material) -> list[Shell]:
    """Eyebrows: tapered bands that follow the brow ridge."""
    blobs, parts = face_blobs(face), []
    thick = 0.0036 if face.feminine else 0.0052
    for s in (-1.0, 1.0):
        t = np.linspace(0, 1, 9)
        x, z = s * (0.0115 + 0.036 * t), 0.1290 + 0.0062 * np.sin(np.pi * (0.06 + 0.74 * t)) - 0.002 * t**3
        y = _front(blobs, x, z)
        line = np.stack([x, y - 0.0004, z], axis=1)
        width = thick * (0.55 + 0.45 * np.sin(np.pi * np.clip(0.2 + 0.75 * t, 0, 1))) * face.brow
        verts, faces = tube(line, np.stack([width * 0.5, width], axis=1), 6, vec(0, 0, 1))
        strand = np.stack([verts[:, 2] * 20, verts[:, 0] * 4, verts[:, 1]], axis=1)
        parts.append(Shell("brow", verts, faces, rigid("head", len(verts)), [material], strand=strand))
    return parts


def hair_shell(style: str, face: Face, material: bpy.types.Material, phase: float) -> Shell:
    """A head of hair; `phase` (radians) varies its waves."""
    if style not in HAIR_STYLES:
        raise ValueError(f"hair style {style!r}: one of {', '.join(HAIR_STYLES)}")
    grid = Grid.over(vec(-0.15, -0.13, -0.24), vec(0.15, 0.21, 0.27), 0.0090)
    for blob in _hair_blobs(style):
        grid.add(blob, margin=0.06)
    p = grid.points()
    grid.values = -smooth_min(-grid.values, -_bare(style, p), 0.012)
    tail = _tail_blobs(style)
    for blob in tail:
        grid.add(blob, margin=0.06)
    verts, faces = surface_nets(grid)
    verts = relax(verts, faces, 2)
    normals = vertex_normals(verts, [tuple(f) for f in faces.tolist()])
    turn = np.arctan2(verts[:, 0], -(verts[:, 1] - 0.01))
    wave = np.sin(17.0 * turn + 24.0 * verts[:, 2] + phase) + 0.6 * np.sin(
        31.0 * turn - 15.0 * verts[:, 2] + 2 * phase
    )
    verts = verts + (0.0016 * wave * smoothstep(0.235, 0.19, verts[:, 2]))[:, None] * normals
    fall = np.where(verts[:, 2] > 0.13, np.hypot(verts[:, 0], verts[:, 1]), 0.10 + 0.13 - verts[:, 2])
    strand = np.stack([turn / 2.0, fall * 3.0, verts[:, 1] * 2.0], axis=1)
    weights = _hair_weights(verts) if style == "long" else rigid("head", len(verts))
    return Shell("hair", verts, [tuple(f) for f in faces.tolist()], weights, [material], strand=strand)


def _hair_blobs(style: str) -> list[Blob]:
    thick = {"short": 0.0105, "bob": 0.017, "ponytail": 0.0075, "bun": 0.0075, "long": 0.014}[style]
    cap = Ellipsoid(vec(0, 0.014, 0.143), vec(0.0735, 0.094, 0.086) + thick, 0.02)
    blobs: list[Blob] = [cap]
    if style == "short":
        blobs.append(Ellipsoid(vec(0, 0.031, 0.094), vec(0.060, 0.053, 0.050) + 0.4 * thick, 0.02))
    if style in ("ponytail", "bun"):
        blobs.append(Ellipsoid(vec(0, 0.035, 0.088), vec(0.064, 0.060, 0.056) + 0.6 * thick, 0.02))
    if style == "bob":
        blobs.append(Ellipsoid(vec(0, 0.020, 0.066), vec(0.098, 0.092, 0.088), 0.05))
    if style == "long":
        blobs.append(Ellipsoid(vec(0, 0.020, 0.075), vec(0.092, 0.092, 0.10), 0.04))
        blobs.append(Cone(vec(0, 0.045, 0.03), vec(0, 0.082, -0.15), 0.082, 0.058, 0.05, vec(0, 1, 0), 0.42))
    return blobs


def _tail_blobs(style: str) -> list[Blob]:
    if style == "bun":
        return [Ellipsoid(vec(0, 0.105, 0.185), vec(0.040, 0.034, 0.036), 0.012)]
    if style == "ponytail":
        return [
            Ellipsoid(vec(0, 0.108, 0.168), vec(0.020, 0.018, 0.018), 0.008),
            Cone(vec(0, 0.125, 0.165), vec(0, 0.142, 0.09), 0.024, 0.031, 0.02),
            Cone(vec(0, 0.142, 0.09), vec(0, 0.125, -0.05), 0.031, 0.012, 0.03),
        ]
    return []


def _bare(style: str, p: np.ndarray) -> np.ndarray:
    """Positive where the head is bare: face, ears and below the hair's lower edge."""
    low = {"short": 0.048, "bob": -0.022, "ponytail": 0.035, "bun": 0.035, "long": -0.26}[style]
    x, y, z = np.abs(p[..., 0]), p[..., 1], p[..., 2]
    pulled_back = style in ("short", "ponytail", "bun")
    top = 0.80 if pulled_back else 0.90
    face = 0.058 - np.sqrt((x * 0.93) ** 2 + (np.maximum(z - 0.118, (0.118 - z) * 0.35) * top) ** 2)
    face = face + (
        0.0035 * np.cos(x * 95.0 + 0.6) if pulled_back else 0.004 * np.cos(p[..., 0] * 240.0 + 1.0)
    )
    face = np.minimum(face, -0.012 - y)
    if pulled_back:
        temple = np.minimum(0.105 + 0.9 * np.clip(-y - 0.01, 0.0, 0.2) - z, 0.028 - y)
        face = np.maximum(face, temple)
    else:
        face = np.maximum(face, np.minimum(np.minimum(0.118 - z, -0.030 - y), 1.0))
    return np.maximum(face, low - z + 0.25 * np.clip(y - 0.03, 0, None) * (style == "bob"))


def _hair_weights(p: np.ndarray) -> dict[str, np.ndarray]:
    """Long hair rests on the back: its lower part follows the chest."""
    down = smoothstep(0.02, -0.12, p[:, 2])
    return {"head": 1.0 - 0.85 * down, "chest": 0.85 * down}


def place(parts: list[Shell], chin: np.ndarray, scale: float) -> list[Shell]:
    """Moves parts from the head frame to the body."""
    for part in parts:
        part.verts = chin + scale * part.verts
    return parts
