"""A market stall: trestle counter with a cloth skirt, tilted crates of fruit, scales, a striped awning.

Front = -Y, where customers stand; the origin lies on the ground under the middle of the counter.
"""

from __future__ import annotations

import random
from math import pi, sin

import bpy
from mathutils import Matrix, Vector

from l4d_blender.scene.catalogue import kind

from ..scene.colour import Colour
from . import mesh
from .materials import interior, outdoors, products
from .materials.base import Nodes
from .materials.products import scaled
from .parts import Parts

COUNTER_M = 0.78
WIDTH_M, DEPTH_M = 2.10, 0.74

HEAPS: tuple[tuple[str, Colour, tuple[float, float, float]], ...] = (
    ("apples", (0.45, 0.04, 0.025), (0.040, 0.040, 0.037)),
    ("oranges", (0.72, 0.24, 0.02), (0.041, 0.041, 0.041)),
    ("lemons", (0.76, 0.54, 0.05), (0.040, 0.032, 0.032)),
    ("pears", (0.40, 0.42, 0.07), (0.036, 0.036, 0.046)),
    ("plums", (0.10, 0.03, 0.10), (0.029, 0.027, 0.027)),
    ("cabbages", (0.24, 0.36, 0.12), (0.082, 0.082, 0.074)),
    ("tomatoes", (0.56, 0.05, 0.02), (0.038, 0.038, 0.032)),
)


@kind("stall", (2.38, 1.38, 2.46), "surface", front="-y")
def market_stall(
    name: str,
    rng: random.Random,
    *,
    stripes: tuple[Colour, Colour] = ((0.5, 0.04, 0.04), (0.74, 0.7, 0.62)),
    skirt: Colour = (0.1, 0.2, 0.13),
    crates: int = 4,
) -> bpy.types.Object:
    """The whole stall as one object."""
    wood = outdoors.weathered_wood(f"{name}_wood", (0.34, 0.22, 0.12), grain_axis="X")
    post = outdoors.weathered_wood(f"{name}_post", (0.34, 0.22, 0.12), grain_axis="Z")
    parts = Parts(name)
    parts.box("top", wood, (WIDTH_M, DEPTH_M, 0.035), 0.006, z=COUNTER_M - 0.035)
    for x in (-WIDTH_M / 2 + 0.05, WIDTH_M / 2 - 0.05):
        for y, tall in ((-DEPTH_M / 2 + 0.04, 2.02), (DEPTH_M / 2 + 0.10, 2.42)):
            parts.box("pole", post, (0.055, 0.055, tall), 0.008, x=x, y=y)
    parts.add(_skirt(f"{name}_skirt", rng), interior.cloth(f"{name}_skirt", skirt, rng))
    parts += _awning(name, rng, stripes)
    heaps = rng.sample(HEAPS, crates)
    pitch = (WIDTH_M - 0.50) / crates
    for k, heap in enumerate(heaps):
        at = Matrix.Translation((-WIDTH_M / 2 + 0.10 + pitch * (k + 0.5), -0.06, COUNTER_M + 0.012))
        crate = _crate(f"{name}_crate_{k}", rng, (pitch - 0.04, 0.42), heap, wood)
        parts.add(crate, within=at @ Matrix.Rotation(0.26, 4, "X") @ Matrix.Translation((0, 0, 0.05)))
    parts.add(_scales(f"{name}_scales", rng), x=WIDTH_M / 2 - 0.22, y=0.02, z=COUNTER_M)
    return parts.join()


def _skirt(name: str, rng: random.Random) -> bpy.types.Object:
    """Cloth that hangs in folds round front and sides of the counter."""
    half_x, half_y, phase = WIDTH_M / 2 + 0.012, DEPTH_M / 2 + 0.012, rng.uniform(0, 6.28)
    line: list[Vector] = []
    corners = [(-half_x, half_y), (-half_x, -half_y), (half_x, -half_y), (half_x, half_y)]
    for (ax, ay), (bx, by) in zip(corners, corners[1:]):
        count = max(12, round(26 * Vector((bx - ax, by - ay)).length))
        line += [Vector((ax + (bx - ax) * k / count, ay + (by - ay) * k / count, 0.0)) for k in range(count)]
    line.append(Vector((*corners[-1], 0.0)))
    verts, rows = [], 7
    for row in range(rows):
        z = COUNTER_M - 0.02 - (COUNTER_M - 0.07) * row / (rows - 1)
        for k, p in enumerate(line):
            fold = 1.0 + 0.028 * (row / (rows - 1)) * (0.6 + sin(0.95 * k + phase) + 0.4 * sin(0.41 * k))
            verts.append((p.x * (1 + (fold - 1) * 0.45), p.y * fold, z))
    n = len(line)
    faces = [
        (r * n + k + 1, r * n + k, (r + 1) * n + k, (r + 1) * n + k + 1)
        for r in range(rows - 1)
        for k in range(n - 1)
    ]
    return mesh.from_pydata(name, verts, faces)


def _awning(name: str, rng: random.Random, stripes: tuple[Colour, Colour]) -> list[bpy.types.Object]:
    """A sloping striped roof with a scalloped edge."""
    canvas = _canvas(f"{name}_canvas", stripes)
    columns, rows, half = 56, 10, WIDTH_M / 2 + 0.14
    front, back = -DEPTH_M / 2 - 0.42, DEPTH_M / 2 + 0.20
    verts = []
    for r in range(rows):
        t = r / (rows - 1)
        for c in range(columns + 1):
            x = half * (2 * c / columns - 1)
            sag = -0.030 * sin(pi * t) - 0.012 * sin(5.0 * x) * sin(pi * t)
            verts.append((x, back + (front - back) * t, 2.46 - 0.58 * t + sag))
    for c in range(columns + 1):
        x = half * (2 * c / columns - 1)
        drop = 0.13 + 0.055 * abs(sin(pi * 9 * c / columns))
        verts.append((x, front - 0.012, 1.88 - drop))
    n = columns + 1
    faces = [
        (r * n + c, (r + 1) * n + c, (r + 1) * n + c + 1, r * n + c + 1)
        for r in range(rows)
        for c in range(columns)
    ]
    sheet = mesh.from_pydata(f"{name}_sheet", verts, faces)
    mesh.solidify(sheet, 0.006, offset=0.0)
    mesh.shade_smooth(sheet, 40.0)
    bar = [(-half, front, 1.885), (half, front, 1.885)]
    pipe = mesh.tube(f"{name}_bar", bar, 0.014, 10)
    return [
        mesh.set_material(sheet, canvas),
        mesh.set_material(pipe, products.metal(f"{name}_bar", (0.5, 0.5, 0.5), rng)),
    ]


def _crate(
    name: str,
    rng: random.Random,
    size: tuple[float, float],
    kind: tuple[str, Colour, tuple],
    wood: bpy.types.Material,
) -> bpy.types.Object:
    """A slatted crate, heaped."""
    sx, sy = size
    parts = Parts(name)
    for s in (-1, 1):
        for z in (0.02, 0.075):
            parts.add(mesh.bevel_box("slat", (sx, 0.010, 0.044), 0.003, 1), y=s * sy / 2, z=z)
            parts.add(mesh.bevel_box("end", (0.010, sy, 0.044), 0.003, 1), x=s * sx / 2, z=z)
    parts.add(mesh.box("floor", (sx, sy, 0.010)), z=0.012)
    for part in parts:
        mesh.set_material(part, wood)
    label, colour, radii = kind
    skin = products.glaze(f"{name}_{label}", colour, rng, speckle=0.3)
    step = 1.85 * radii[0]
    for i in range(int(sx / step)):
        for j in range(int(sy / step)):
            for layer in range(2):
                x = -sx / 2 + step * (i + 0.5 + 0.3 * layer) + rng.uniform(-0.15, 0.15) * step
                y = -sy / 2 + step * (j + 0.5 + 0.3 * layer) + rng.uniform(-0.15, 0.15) * step
                if abs(x) > sx / 2 - 0.8 * radii[0] or abs(y) > sy / 2 - 0.8 * radii[0]:
                    continue
                fruit = mesh.ellipsoid(f"{name}_fruit", radii, 12, 8)
                turn = Matrix.Rotation(rng.uniform(0, 3), 4, "Z") @ Matrix.Rotation(
                    rng.uniform(-0.7, 0.7), 4, "X"
                )
                z = 0.060 + (1.25 * layer + rng.uniform(0.0, 0.25)) * radii[2]
                mesh.transform(fruit, Matrix.Translation((x, y, z)) @ turn)
                parts.add(fruit, skin)
    return parts.join()


def _scales(name: str, rng: random.Random) -> bpy.types.Object:
    """A shop scale: enamelled body with a dial, a steel pan on top."""
    enamel = products.lacquer(f"{name}_enamel", (0.62, 0.62, 0.56), rng)
    steel = products.metal(f"{name}_steel", (0.62, 0.62, 0.63), rng)
    body = mesh.bevel_box(f"{name}_body", (0.24, 0.22, 0.20), 0.03)
    dial = mesh.cylinder(f"{name}_dial", 0.085, 0.014, 32, bevel_m=0.004)
    mesh.transform(dial, Matrix.Translation((0.0, -0.108, 0.105)) @ Matrix.Rotation(pi / 2, 4, "X"))
    face = mesh.cylinder(f"{name}_face", 0.074, 0.006, 32)
    mesh.transform(face, Matrix.Translation((0.0, -0.120, 0.105)) @ Matrix.Rotation(pi / 2, 4, "X"))
    hand = mesh.move(mesh.box(f"{name}_hand", (0.006, 0.004, 0.062)), x=0.0, y=-0.129, z=0.105)
    stem = mesh.move(mesh.cylinder(f"{name}_stem", 0.02, 0.06, 16), z=0.19)
    pan = mesh.lathe(
        f"{name}_pan",
        [(0.05, 0.0), (0.15, 0.022), (0.175, 0.05), (0.168, 0.05), (0.14, 0.028), (0.0, 0.008)],
        40,
    )
    mesh.move(pan, z=0.245)
    dark = products.satin_plastic(f"{name}_dark", (0.02, 0.02, 0.02), rng)
    white = products.satin_plastic(f"{name}_white", (0.74, 0.73, 0.68), rng)
    for part, material in (
        (body, enamel),
        (dial, steel),
        (face, white),
        (hand, dark),
        (stem, steel),
        (pan, steel),
    ):
        mesh.set_material(part, material)
    return mesh.join(name, [body, dial, face, hand, stem, pan])


def _canvas(name: str, stripes: tuple[Colour, Colour]) -> bpy.types.Material:
    """Striped canvas, weathered, with light coming through a little."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    x, _, _ = n.separate(n.object_coords())
    band = n.math("GREATER_THAN", n.math("FRACT", n.math("MULTIPLY", x, 1.0 / 0.26)), 0.5)
    stain = n.noise(3.0, 4.0)
    base = n.mix(band, stripes[0], stripes[1])
    n.set("Base Color", n.mix(n.map_range(stain, 0.5, 0.75, 0.0, 0.5), base, scaled(stripes[1], 0.45)))
    n.set("Roughness", 0.9)
    material.diffuse_color = (*stripes[0], 1.0)
    return material
