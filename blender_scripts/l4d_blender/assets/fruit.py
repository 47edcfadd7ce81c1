"""Fruit that fills a bowl beside the apples: oranges, lemons, pears, bananas, grapes; and the bowl.

Owns the shapes. Every piece lies or stands on z = 0 round the origin.
"""

from __future__ import annotations

import random
from math import cos, pi, sin

import bpy
from mathutils import Matrix, Vector, noise

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products, tableware
from l4d_blender.assets.parts import Parts
from l4d_blender.scene import keys
from l4d_blender.scene.catalogue import colours, kind
from l4d_blender.scene.colour import Colour

BOWL_RIM_M, BOWL_HEIGHT_M, BOWL_FLOOR_M = 0.158, 0.072, 0.0085


@kind("bowl", (0.317, 0.317, 0.072), "container", colour=colours("glaze"))
def fruit_bowl(name: str, rng: random.Random, *, glaze: Colour = (0.1, 0.17, 0.3)) -> bpy.types.Object:
    """A wide shallow bowl with a bare rim; things in it lie at `BOWL_FLOOR_M`, level out to 9 cm."""
    r, h, floor = BOWL_RIM_M, BOWL_HEIGHT_M, BOWL_FLOOR_M
    wall = [
        (0.055, 0.0),
        (0.060, 0.0015),
        (0.062, 0.005),
        (0.092, 0.009),
        (0.118, 0.021),
        (0.142, 0.043),
        (r, h - 0.003),
        (r + 0.001, h - 0.001),
        (r - 0.001, h),
        (r - 0.004, h - 0.0005),
        (0.137, 0.047),
        (0.113, 0.027),
        (0.094, 0.0135),
        (0.086, floor),
        (0.0, floor),
    ]
    path = keys.Path([(a, 0.0, z) for a, z in wall[:-1]])
    points = [path.point(path.length * k / 90) for k in range(91)]
    bowl = mesh.lathe(name, [(p.x, p.z) for p in points] + [(0.0, floor)], 72)
    skins = [
        products.glaze(f"{name}_glaze", glaze, rng, speckle=0.5),
        products.stoneware(f"{name}_clay", rng),
    ]
    return mesh.paint(bowl, skins, lambda centre, _: int(centre.z > h - 0.006 or centre.z < 0.003))


@kind("orange", (0.073, 0.074, 0.072), "graspable", "rolls")
def orange(name: str, rng: random.Random, *, radius_m: float = 0.037) -> bpy.types.Object:
    """An orange with its button."""
    return _citrus(name, rng, (radius_m, radius_m, 0.95 * radius_m), (0.66, 0.20, 0.012), 0.02)


@kind("lemon", (0.086, 0.054, 0.054), "graspable")
def lemon(name: str, rng: random.Random) -> bpy.types.Object:
    """A lemon that lies along X."""
    fruit = _citrus(name, rng, (0.027, 0.027, 0.036), (0.72, 0.50, 0.035), 0.22)
    return mesh.drop_to_base(mesh.rotate(fruit, "Y", 84.0))


@kind("pear", (0.072, 0.072, 0.118), "graspable")
def pear(name: str, rng: random.Random) -> bpy.types.Object:
    """A pear that stands."""
    section = [
        (0.0, 0.004),
        (0.012, 0.0),
        (0.026, 0.006),
        (0.035, 0.022),
        (0.036, 0.038),
        (0.030, 0.056),
        (0.0215, 0.071),
        (0.0165, 0.084),
        (0.012, 0.093),
        (0.004, 0.097),
        (0.0, 0.0965),
    ]
    path = keys.Path([(a, 0.0, z) for a, z in section])
    points = [path.point(path.length * k / 40) for k in range(41)]
    body = mesh.lathe(
        name, [(0.0 if k in (0, 40) else max(p.x, 0.0006), p.z) for k, p in enumerate(points)], 44
    )
    shift = Vector([rng.uniform(-9, 9) for _ in range(3)])
    mesh.displace(body, lambda p, _: 0.0016 * noise.noise(p * 34 + shift))
    mesh.set_material(body, tableware.ripe_skin(f"{name}_skin", (0.38, 0.38, 0.06), (0.22, 0.13, 0.03), rng))
    stem = mesh.tube(
        f"{name}_stem",
        [(0, 0, 0.094), (0.002, 0.001, 0.106), (0.007, 0.002, 0.116)],
        [0.0015, 0.0013, 0.002],
        8,
    )
    mesh.set_material(stem, products.wood(f"{name}_wood", (0.14, 0.08, 0.03), (0.07, 0.04, 0.015), rng))
    return mesh.join(name, [body, stem])


@kind("bananas", (0.161, 0.119, 0.045), "graspable")
def bananas(name: str, rng: random.Random, *, count: int = 4) -> bpy.types.Object:
    """A bunch that lies on its side and bends towards -Y; the crown is at +X."""
    skin = tableware.ripe_skin(f"{name}_skin", (0.70, 0.46, 0.045), (0.13, 0.07, 0.02), rng)
    parts = Parts(name)
    for k in range(count):
        lift, off = 0.019 + 0.006 * (k % 2), 0.030 * (k - (count - 1) / 2)
        points, radii = [], []
        for j in range(19):
            t = j / 18
            angle = 2.35 * (t - 0.5)
            points.append(
                (
                    0.082 * sin(angle),
                    -0.075 * cos(angle) + 0.05 + 0.72 * off * (1 - t) ** 0.6,
                    lift + 0.010 * sin(pi * t),
                )
            )
            body = min(1.0, 5.5 * t + 0.22, 9.0 * (1 - t) + 0.22)
            radii.append(0.0172 * body * (0.93 + 0.07 * sin(pi * t)))
        parts.tube(f"{k}", skin, points, radii, 10)
    return mesh.drop_to_base(parts.join())


@kind("grapes", (0.073, 0.174, 0.048), "graspable")
def grapes(
    name: str, rng: random.Random, *, count: int = 38, colour: Colour = (0.055, 0.016, 0.05)
) -> bpy.types.Object:
    """A bunch of dark grapes that lies along Y, its stalk at +Y."""
    bloom = tableware.wax(f"{name}_bloom", colour, rng)
    parts = Parts(name)
    for k in range(count):
        t = (k + 0.5) / count
        width = 0.030 * (1 - t) ** 0.5 + 0.006
        angle, level = 2.39996 * k, rng.random() ** 0.6
        at = (width * cos(angle) * (1 - 0.4 * level), 0.055 - 0.12 * t, 0.010 + 0.030 * level * (1 - 0.6 * t))
        size = rng.uniform(0.0088, 0.0108)
        parts.ellipsoid(f"{k}", bloom, (size, size, 1.12 * size), 14, 10, at)
    stalk = mesh.tube(f"{name}_stalk", [(0, 0.03, 0.02), (0.004, 0.07, 0.03), (0.0, 0.10, 0.026)], 0.0022, 8)
    parts.add(stalk, products.wood(f"{name}_wood", (0.20, 0.16, 0.06), (0.1, 0.07, 0.03), rng))
    return mesh.drop_to_base(parts.join())


def _citrus(
    name: str, rng: random.Random, radii: tuple[float, float, float], colour: Colour, tip: float
) -> bpy.types.Object:
    body = mesh.ellipsoid(f"{name}_body", radii, 40, 28)
    reach = radii[2]
    mesh.displace(
        body,
        lambda p, _: (
            Vector((0, 0, 1))
            * (1 if p.z > 0 else -1)
            * tip
            * reach
            * max(0.0, abs(p.z) / reach - 0.8)
            * 5
            * 0.8
        ),
    )
    mesh.set_material(body, tableware.peel(f"{name}_peel", colour, rng))
    button = mesh.ellipsoid(
        f"{name}_button", (0.0032, 0.0032, 0.0018), 10, 6, (0, 0, reach * (1 + 0.8 * tip))
    )
    mesh.set_material(button, products.leaf(f"{name}_green", (0.10, 0.14, 0.04), rng))
    fruit = mesh.join(name, [body, button])
    turn = Matrix.Rotation(rng.uniform(0, 6), 4, "Z") @ Matrix.Rotation(rng.uniform(0.3, 0.9), 4, "X")
    return mesh.drop_to_base(mesh.transform(fruit, turn) if tip < 0.1 else fruit)
