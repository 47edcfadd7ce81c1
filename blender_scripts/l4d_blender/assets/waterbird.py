"""Gulls and ducks at real size: body, neck, bill, webbed feet, and wings whose feathers fan out and fold.

Owns skin weights, plumage as a colour per vertex, and where every feather lies at any spread of the wing;
proportions and colours come from waterbird_species.py. Refuses to know how a bird moves
(motion/waterbirds.py). The armature's bones have no parents: each carries its part from rest to pose. In the
rest pose the wings are spread; front is -Y, origin between the feet.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import bpy
import numpy as np
from mathutils import Matrix, Quaternion, Vector

from l4d_blender.scene.catalogue import kind, words

from ..scene.colour import Colour, rgb
from . import implicit, mesh
from .materials.birds import beak, eye, plumage_surface, scales
from .rigs import hang, upright_armature
from .waterbird_species import DUCK, GULL, HEADS, PLUMAGES, Plumage, Species

__all__ = ["DUCK", "GULL", "PLUMAGES", "SIDES", "Species", "waterbird", "wing_motion"]

SIDES = ("left", "right")
MIRROR = Matrix.Diagonal((-1.0, 1.0, 1.0, 1.0))
PRIMARIES, SECONDARIES = 9, 10
ARM = ("humerus", "forearm", "hand")
VOXEL_M = 0.0070

# --- the wing: where arm and feathers lie -----------------------------------------------------------------


def _frame(root: Vector, along: Vector, normal: Vector) -> Matrix:
    y = along.normalized()
    z = (normal - normal.project(y)).normalized()
    matrix = Matrix((y.cross(z), y, z)).transposed().to_4x4()
    matrix.translation = root
    return matrix


def _blend(a: Matrix, b: Matrix, t: float) -> Quaternion:
    p, q = a.to_quaternion(), b.to_quaternion()
    return p.slerp(-q if p.dot(q) < 0.0 else q, t)


def _turned(a: Vector, b: Vector, t: float) -> Vector:
    return Quaternion().slerp(a.rotation_difference(b), t) @ a


_FOLDED_NORMAL = Vector((0.86, 0.0, 0.50))
_UP = Vector((0.0, 0.0, 1.0))


def feather_names(side: str) -> list[str]:
    """Bones of one wing's feathers."""
    return [f"primary{k}_{side}" for k in range(PRIMARIES)] + [
        f"secondary{k}_{side}" for k in range(SECONDARIES)
    ]


def wing_frames(species: Species, spread: float, flap: float = 0.0, bend: float = 0.0) -> dict[str, Matrix]:
    """Frames of the left wing's parts in the body's rest space; `spread` 0 folded .. 1 open.

    `flap` (radians) lifts the whole wing at the shoulder, `bend` the part beyond the wrist. A frame's y axis
    runs along the part, its z axis is the wing's upper side.
    """
    fold = 1.0 - spread
    opened, folded = [[Vector(p) for p in row] for row in (species.wing_open, species.wing_folded)]
    points = [opened[0].lerp(folded[0], fold)]
    for k in range(3):
        a, b = opened[k + 1] - opened[k], folded[k + 1] - folded[k]
        length = a.length + (b.length - a.length) * fold
        points.append(points[-1] + length * _turned(a.normalized(), b.normalized(), fold))
    shoulder, elbow, wrist, hand = points

    frames: dict[str, Matrix] = {}

    def put(name: str, root: Vector, open_way: Vector, folded_way: Vector, layer: float) -> None:
        a, b = _frame(root, open_way, _UP), _frame(root, folded_way, _FOLDED_NORMAL)
        frame = _blend(a, b, fold).to_matrix().to_4x4()
        frame.translation = root + layer * (frame.to_3x3() @ _UP)
        frames[name] = frame

    for k, name in enumerate(ARM):
        put(name, points[k], opened[k + 1] - opened[k], folded[k + 1] - folded[k], 0.0)
    tips = Vector(species.folded_tips)
    for k in range(PRIMARIES):
        t = k / (PRIMARIES - 1)
        angle = math.radians(8.0 + 62.0 * t**1.15)
        way = Vector((math.sin(angle), math.cos(angle), -0.02))
        lies = tips + Vector((-0.02, 0.0, 0.10 - 0.10 * t))
        put(f"primary{k}", wrist.lerp(hand, 0.12 + 0.88 * t), way, lies, -0.0012 * (k + 2))
    for k in range(SECONDARIES):
        t = k / (SECONDARIES - 1)
        root = wrist.lerp(elbow, t / 0.62) if t < 0.62 else elbow.lerp(shoulder, (t - 0.62) / 0.50)
        way = Vector((0.10 - 0.20 * t, 1.0, -0.05))
        lies = Vector((-0.14 - 0.10 * t, 1.0, 0.10 - 0.16 * t))
        put(f"secondary{k}", root, way, lies, 0.0010 * (k - 2))

    knuckle = Matrix.Translation(wrist) @ Matrix.Rotation(-bend, 4, "Y") @ Matrix.Translation(-wrist)
    whole = Matrix.Translation(shoulder) @ Matrix.Rotation(-flap, 4, "Y") @ Matrix.Translation(-shoulder)
    beyond = {"hand", *(f"primary{k}" for k in range(PRIMARIES))}
    return {name: whole @ (knuckle @ f if name in beyond else f) for name, f in frames.items()}


def wing_motion(species: Species, spread: float, flap: float, bend: float) -> dict[str, Matrix]:
    """Per bone of both wings the motion from rest (spread) to pose, in the body's rest space."""
    rest, posed = wing_frames(species, 1.0), wing_frames(species, spread, flap, bend)
    moved = {}
    for name, frame in posed.items():
        left = frame @ rest[name].inverted()
        moved[f"{name}_left"] = left
        moved[f"{name}_right"] = MIRROR @ left @ MIRROR
    return moved


# --- shape ------------------------------------------------------------------------------------------------


@dataclass
class _Parts:
    """Pieces of a bird with their bones, colours and materials."""

    found: list[bpy.types.Object] = field(default_factory=list)

    def add(
        self,
        part: bpy.types.Object,
        weights: str | list[dict[str, float]],
        paint: Callable[[Vector], Colour],
        material: bpy.types.Material,
    ) -> None:
        rows = [{weights: 1.0}] * len(part.data.vertices) if isinstance(weights, str) else weights
        for bone in sorted({bone for row in rows for bone in row}):
            group = part.vertex_groups.new(name=bone)
            for index, row in enumerate(rows):
                if row.get(bone, 0.0) > 0.0:
                    group.add([index], row[bone], "REPLACE")
        layer = part.data.attributes.new("plumage", "FLOAT_COLOR", "POINT")
        flat = [c for vertex in part.data.vertices for c in (*paint(vertex.co), 1.0)]
        layer.data.foreach_set("color", flat)
        mesh.set_material(part, material)
        self.found.append(part)


_trunks: dict[str, tuple[np.ndarray, np.ndarray]] = {}


def _trunk(species: Species) -> tuple[np.ndarray, np.ndarray]:
    """Body, neck and head as one skin; built once per process and species."""
    if species.name not in _trunks:
        blobs = []
        for volume in species.volumes:
            rows = [np.array(v, float) if isinstance(v, tuple) else v for v in volume]
            blobs.append(implicit.Cone(*rows) if len(rows) == 5 else implicit.Ellipsoid(*rows))
        low = np.min([blob.bounds()[0] for blob in blobs], axis=0) - 0.02
        high = np.max([blob.bounds()[1] for blob in blobs], axis=0) + 0.02
        grid = implicit.Grid.over(low, high, VOXEL_M)
        for blob in blobs:
            grid.add(blob, margin=0.05)
        verts, quads = implicit.surface_nets(grid)
        _trunks[species.name] = implicit.relax(verts, quads, 3), quads
    return _trunks[species.name]


def _neck_weights(species: Species, point: Vector) -> dict[str, float]:
    """Shares of body, neck and head by how far along the neck's middle line a point lies."""
    low, mid, top = (species.joint(j) for j in ("neck_low", "neck_mid", "neck_top"))
    first, second = mid - low, top - mid
    start = low - 0.6 * first
    t1 = min(1.6, max(0.0, (point - start).dot(first) / first.length_squared))
    t2 = min(1.4, max(0.0, (point - mid).dot(second) / second.length_squared))
    along = t1 if t1 < 1.2 or t2 <= 0.0 else 1.6 + t2
    ladder = [("body", 0.25), ("neck_low", 1.1), ("neck_high", 2.1), ("head", 2.65)]
    if along <= ladder[0][1]:
        return {"body": 1.0}
    for (lower, a), (upper, b) in zip(ladder, ladder[1:], strict=False):
        if along < b:
            share = (along - a) / (b - a)
            return {lower: 1.0 - share, upper: share}
    return {"head": 1.0}


def _mixed(a: Colour, b: Colour, t: float) -> Colour:
    t = min(1.0, max(0.0, t))
    return rgb(x + (y - x) * t for x, y in zip(a, b, strict=True))


def _trunk_paint(species: Species, coat: Plumage, rng: random.Random) -> Callable[[Vector], Colour]:
    """Where hood, ring, breast, mantle and belly meet; edges fray a little."""
    neck, head = species.joint("neck_low"), species.joint("neck_top")
    back_z = species.joint("pivot").z + 0.026
    hood_z = coat.hood_to_z_m if coat.hood_to_z_m is not None else head.z - 0.02
    fray = rng.uniform(0, 9)

    def paint(p: Vector) -> Colour:
        wave = 0.003 * math.sin(90 * p.x + fray) * math.sin(70 * p.y)
        colour = _mixed(coat.body, coat.breast, (neck.y + 0.045 - p.y) / 0.03)
        on_back = (p.z - back_z + wave) / 0.012
        if p.y > neck.y - 0.005:
            colour = _mixed(colour, coat.mantle, min(on_back, (species.tail_root[1] - 0.01 - p.y) / 0.02))
        if p.y < neck.y + 0.02 and p.z > neck.z - 0.02:
            # The hood's rim is lower behind than under the bill.
            rim = hood_z + 0.30 * (head.y - p.y)
            if coat.ring is not None and abs(p.z - rim + 0.004) < 0.0065:
                return coat.ring
            colour = _mixed(colour, coat.hood, (p.z - rim + wave) / 0.005)
        return colour

    return paint


def _blade(
    name: str, frame: Matrix, length_m: float, width_m: float, camber_m: float, start: float = 0.0
) -> bpy.types.Object:
    """A feather along a frame's y axis, slightly arched, its quill as a ridge."""
    verts, faces, stations = [], [], 7
    for k in range(stations + 1):
        t = k / stations
        half = 0.5 * width_m * min(1.0, 0.55 + 1.4 * t) * (1.0 - max(0.0, (t - 0.72) / 0.28) ** 2.2)
        y, z = start + length_m * t, -camber_m * t * t
        verts += [frame @ Vector(p) for p in ((-half, y, z), (0.0, y, z + 0.06 * width_m), (half, y, z))]
    for k in range(stations):
        a, b = 3 * k, 3 * (k + 1)
        faces += [(a, a + 1, b + 1, b), (a + 1, a + 2, b + 2, b + 1)]
    return mesh.from_pydata(name, verts, faces, smooth=True)


def _wing(name: str, species: Species, side: str, coat: Plumage, parts: _Parts, surface) -> None:
    """Arm, flight feathers and their coverts on one side."""
    frames = wing_frames(species, 1.0)
    scale = species.secondary_m / 0.138

    def add(part: bpy.types.Object, bone: str, paint: Callable[[Vector], Colour]) -> None:
        if side == "right":
            mesh.transform(part, MIRROR)
        parts.add(part, f"{bone}_{side}", paint, surface)

    points = [Vector(p) for p in species.wing_open]
    for k, bone in enumerate(ARM):
        length = (points[k + 1] - points[k]).length
        flesh = mesh.ellipsoid(f"{name}_{bone}", (0.040 * scale, 0.62 * length, 0.013 * scale), 16, 10)
        back = -0.012 if bone != "humerus" else 0.0
        mesh.transform(flesh, frames[bone] @ Matrix.Translation((back, 0.5 * length, 0.0)))
        add(flesh, bone, lambda p: coat.wing)

    def pale_edge(frame: Matrix, length: float, colour: Colour, edge: Colour, at: float):
        inverse = frame.inverted()
        fix = MIRROR if side == "right" else Matrix.Identity(4)
        return lambda p: _mixed(colour, edge, ((inverse @ fix @ p).y / length - at) / 0.05)

    pale = _mixed(coat.wing, coat.body, 0.75)
    for k in range(PRIMARIES):
        t = k / (PRIMARIES - 1)
        frame = frames[f"primary{k}"]
        length = species.primary_m[0] + (species.primary_m[1] - species.primary_m[0]) * math.sin(1.45 * t)
        quill = _blade(f"{name}_primary", frame, length, 0.040 * scale, 0.010)
        dark_from = 0.80 - 0.45 * t
        add(quill, f"primary{k}", pale_edge(frame, length, coat.wing, coat.tips, dark_from))
        lift = frame @ Matrix.Translation((0, 0, 0.004))
        covert = _blade(f"{name}_covert", lift, 0.42 * length, 0.036 * scale, 0.004, -0.012)
        add(covert, f"primary{k}", lambda p: coat.wing)
    for k in range(SECONDARIES):
        frame = frames[f"secondary{k}"]
        length = species.secondary_m * (1.0 + 0.10 * max(0, k - 6))
        quill = _blade(f"{name}_secondary", frame, length, 0.046 * scale, 0.012)
        add(quill, f"secondary{k}", pale_edge(frame, length, coat.wing, pale, 0.86))
        for reach, lift in ((0.62, 0.0030), (0.36, 0.0055)):
            raised = frame @ Matrix.Translation((0, 0, lift))
            covert = _blade(f"{name}_covert", raised, reach * length, 0.042 * scale, 0.006, -0.014)
            shade = _mixed(coat.wing, coat.mantle, 0.5 if reach > 0.5 else 1.0)
            edge = _mixed(shade, pale, 0.35)
            add(covert, f"secondary{k}", pale_edge(raised, reach * length, shade, edge, 0.80))


def _tail(name: str, species: Species, coat: Plumage, parts: _Parts, surface) -> None:
    root = Vector(species.tail_root)
    for k in range(-4, 5):
        spread = k / 4.0
        way = Vector((0.30 * spread, 1.0, 0.02 - 0.05 * abs(spread)))
        at = root + Vector((0.018 * spread, -0.012 * abs(spread), 0.004 - 0.003 * abs(spread)))
        length = species.tail_m * (1.0 - 0.08 * abs(spread))
        feather = _blade(f"{name}_tail", _frame(at, way, _UP), length, 0.036, 0.004)
        parts.add(feather, "body", lambda p: coat.tail, surface)


def _leg(name: str, species: Species, side: str, coat: Plumage, parts: _Parts, surface, skin) -> None:
    hip, hock, ankle = (species.joint(j, side) for j in ("hip", "hock", "ankle"))
    thick, thin = species.leg_m
    thigh = mesh.tube(
        f"{name}_thigh",
        [hip + Vector((0, 0, 0.02)), hip.lerp(hock, 0.35), hip.lerp(hock, 0.75), hock],
        [0.026, 0.023, 0.012, thick],
        segments=12,
    )
    parts.add(thigh, f"thigh_{side}", lambda p: coat.body, surface)
    shank = mesh.tube(
        f"{name}_shank",
        [hock + Vector((0, 0, 0.004)), hock.lerp(ankle, 0.12), hock.lerp(ankle, 0.9), ankle],
        [1.15 * thick, thin, thin, 1.1 * thin],
        segments=10,
    )
    parts.add(shank, f"shank_{side}", lambda p: coat.legs, skin)
    tips = []
    for turn in (-0.52, 0.0, 0.52):
        length = species.web_m * (1.0 if turn == 0.0 else 0.93)
        tip = ankle + Vector((math.sin(turn) * length, -math.cos(turn) * length, 0.0))
        tip.z = 0.0035
        tips.append(tip)
        bow = ankle.lerp(tip, 0.45) + Vector((0, 0, 0.002))
        toe = mesh.tube(f"{name}_toe", [ankle, bow, tip], [0.0060, 0.0048, 0.0026], segments=7)
        parts.add(toe, f"foot_{side}", lambda p: coat.legs, skin)
    verts = [ankle - Vector((0, 0, 0.003))]
    for k, tip in enumerate(tips):
        verts.append(tip)
        if k < 2:
            verts.append((tip + tips[k + 1]) / 2 + Vector((0, 0.009, 0.0)))
    web = mesh.from_pydata(f"{name}_web", verts, [(0, k + 2, k + 1) for k in range(4)], smooth=True)
    mesh.solidify(web, 0.0025, offset=0.0)
    parts.add(web, f"foot_{side}", lambda p: _mixed(coat.legs, (0.1, 0.08, 0.06), 0.25), skin)
    if species is GULL:
        return
    spur = mesh.tube(f"{name}_hind_toe", [ankle, ankle + Vector((0, 0.018, -0.004))], [0.004, 0.002], 6)
    parts.add(spur, f"foot_{side}", lambda p: coat.legs, skin)


def _face(name: str, species: Species, coat: Plumage, parts: _Parts) -> None:
    horn, bright = beak(f"{name}_bill"), eye(f"{name}_eye", coat.eye)
    bill = mesh.tube(f"{name}_bill", [p for p, _ in species.bill], [r for _, r in species.bill], segments=12)
    parts.add(bill, "head", lambda p: coat.bill, horn)
    for side in SIDES:
        ball = mesh.ellipsoid(f"{name}_eye", (0.0040, 0.0062, 0.0062), 12, 8)
        mesh.transform(ball, Matrix.Translation(species.joint("eye", side)))
        parts.add(ball, "head", lambda p: coat.eye, bright)


@kind(
    "bird",
    (1.21, 0.474, 0.339),
    "walks",
    "flies",
    "swims",
    front="-y",
    plumage=words("plumage", *PLUMAGES),
    head=words("head", "own", *HEADS),
)
def waterbird(
    name: str, rng: random.Random, *, species: Species = GULL, plumage: str = "grey_backed", head: str = "own"
) -> bpy.types.Object:
    """The skinned mesh; its parent is the armature, which stands where the bird stands."""
    coat = PLUMAGES[plumage]
    if head != "own":
        coat = replace(coat, hood=HEADS[head])
    surface, skin = plumage_surface(f"{name}_feathers", coat.mottle), scales(f"{name}_legs")
    parts = _Parts()
    verts, quads = _trunk(species)
    trunk = mesh.from_pydata(f"{name}_trunk", verts.tolist(), quads.tolist())
    weights = [_neck_weights(species, vertex.co) for vertex in trunk.data.vertices]
    parts.add(trunk, weights, _trunk_paint(species, coat, rng), surface)
    _face(name, species, coat, parts)
    _tail(name, species, coat, parts, surface)
    for side in SIDES:
        _wing(name, species, side, coat, parts, surface)
        _leg(name, species, side, coat, parts, surface, skin)
    bird = mesh.store_rest_position(mesh.join(name, parts.found))
    return hang(bird, upright_armature(f"{name}_rig", _bone_heads(species), 0.04))


def _bone_heads(species: Species) -> dict[str, Vector]:
    heads = {
        "body": species.joint("pivot"),
        "neck_low": species.joint("neck_low"),
        "neck_high": species.joint("neck_mid"),
        "head": species.joint("neck_top"),
    }
    for side in SIDES:
        for bone, joint in (("thigh", "hip"), ("shank", "hock"), ("foot", "ankle")):
            heads[f"{bone}_{side}"] = species.joint(joint, side)
        for part, frame in wing_frames(species, 1.0).items():
            root = frame.translation
            heads[f"{part}_{side}"] = root if side == "left" else MIRROR @ root
    return heads
