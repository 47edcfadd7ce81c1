"""What cooks hold and hang up: the wooden spoon, ladles, a rail of tools, a crock full of them."""

from __future__ import annotations

import random
from math import cos, pi, sin

import bpy
from mathutils import Matrix, Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior
from l4d_blender.assets.materials.base import principled
from l4d_blender.assets.parts import Parts, placed
from l4d_blender.scene.catalogue import colours, kind

SPOON_LENGTH_M = 0.35


@kind("spoon", (0.06, 0.02, 0.351), "graspable", "stirs")
def wooden_spoon(name: str, rng: random.Random, *, length_m: float = SPOON_LENGTH_M) -> bpy.types.Object:
    """A cook's spoon that stands on the tip of its bowl, shaft along +Z, hollow towards -Y."""
    wood = interior.wood(f"{name}_wood", (0.47, 0.27, 0.12), rng, grain_axis="Z")
    bowl = mesh.ellipsoid(f"{name}_bowl", (0.030, 0.011, 0.044), 20, 14, centre=(0, 0, 0.043))
    mesh.displace(
        bowl,
        lambda p, normal: Vector(
            (0, max(0.0, 0.013 - 14.0 * (p.x**2 + 0.5 * (p.z - 0.043) ** 2)) * (p.y < 0), 0)
        ),
    )
    steps = [i / 9 for i in range(10)]
    shaft = mesh.tube(
        f"{name}_shaft",
        [(0, 0.002, 0.075 + (length_m - 0.075) * t) for t in steps],
        [0.0085 - 0.001 * sin(pi * t) + 0.0015 * t for t in steps],
        segments=12,
    )
    return mesh.join(name, [mesh.set_material(bowl, wood), mesh.set_material(shaft, wood)])


@kind("rail", (1.0, 0.14, 0.375), "hangs")
def hanging_rail(name: str, rng: random.Random, *, width_m: float = 1.0) -> bpy.types.Object:
    """A steel rail on a wall (plane y = 0, room at -Y) with ladles, turners and a whisk on hooks."""
    steel = principled(f"{name}_steel", (0.50, 0.50, 0.51), roughness=0.3, metallic=1.0, variation=0.2)
    black = principled(f"{name}_grips", (0.025, 0.023, 0.022), roughness=0.5, variation=0.2)
    wood = interior.wood(f"{name}_wood", (0.36, 0.20, 0.09), rng, grain_axis="Z")
    parts = Parts(name)
    parts.tube("bar", steel, [(-width_m / 2, -0.05, 0), (width_m / 2, -0.05, 0)], 0.008, 12)
    for x in (-0.44 * width_m, 0.44 * width_m):
        parts.tube("foot", steel, [(x, 0, 0), (x, -0.05, 0)], 0.007, 10)
    count = max(4, int(width_m / 0.13))
    makers = (_ladle, _turner, _whisk, _skimmer, _sieve)
    order = rng.sample(range(len(makers)), len(makers))
    for k in range(count):
        x = width_m * ((k + 0.5) / count - 0.5) * 0.92 + rng.uniform(-0.012, 0.012)
        grip = wood if rng.random() < 0.35 else black
        tool = makers[order[k % len(makers)]](f"{name}_tool", steel, grip)
        tool = mesh.transform(
            tool,
            Matrix.Translation((x, -0.055, -0.012))
            @ Matrix.Rotation(rng.uniform(-0.05, 0.05), 4, "Y")
            @ Matrix.Rotation(rng.uniform(-0.4, 0.4), 4, "Z"),
        )
        hook = placed(
            mesh.torus(f"{name}_hook", 0.013, 0.0025, 16, 6),
            steel,
            within=Matrix.Translation((x, -0.05, -0.004)) @ Matrix.Rotation(pi / 2, 4, "Y"),
        )
        parts += [tool, hook]
    return parts.join()


@kind("crock", (0.147, 0.16, 0.364), "container", colour=colours("colour"))
def crock(
    name: str, rng: random.Random, *, colour: tuple[float, float, float] = (0.45, 0.38, 0.28)
) -> bpy.types.Object:
    """A stoneware crock with spoons, a whisk and a ladle upright in it."""
    glaze = interior.ceramic(f"{name}_glaze", colour, rng)
    pot = mesh.lathe(
        f"{name}_pot",
        [
            (0.058, 0),
            (0.066, 0.01),
            (0.070, 0.08),
            (0.066, 0.15),
            (0.069, 0.16),
            (0.060, 0.158),
            (0.058, 0.02),
            (0, 0.02),
        ],
        40,
    )
    parts = [mesh.set_material(pot, glaze)]
    steel = principled(f"{name}_steel", (0.50, 0.50, 0.51), roughness=0.3, metallic=1.0)
    black = principled(f"{name}_grips", (0.03, 0.025, 0.022), roughness=0.5)
    for k in range(5):
        if k < 3:
            tool = wooden_spoon(f"{name}_spoon_{k}", rng, length_m=rng.uniform(0.27, 0.33))
            length = max(v.co.z for v in tool.data.vertices)
            mesh.transform(tool, Matrix.Translation((0, 0, length)) @ Matrix.Rotation(pi, 4, "X"))
        else:
            tool = mesh.move((_whisk, _turner)[k - 3](f"{name}_tool_{k}", steel, black), z=0.30)
            mesh.transform(tool, Matrix.Translation((0, 0, 0.31)) @ Matrix.Rotation(pi, 4, "X"))
        turn, lean = 2 * pi * k / 5 + rng.uniform(-0.3, 0.3), rng.uniform(0.08, 0.16)
        mesh.transform(
            tool,
            Matrix.Translation((0.025 * cos(turn), 0.025 * sin(turn), 0.022))
            @ Matrix.Rotation(turn, 4, "Z")
            @ Matrix.Rotation(lean, 4, "Y")
            @ Matrix.Rotation(rng.uniform(0, 6), 4, "Z"),
        )
        parts.append(tool)
    return mesh.join(name, parts)


def _stem(
    name: str, length: float, steel: bpy.types.Material, grip: bpy.types.Material
) -> list[bpy.types.Object]:
    handle = mesh.tube(f"{name}_grip", [(0, 0, 0), (0, 0, -0.05), (0, 0, -0.11)], [(0.009, 0.006)] * 3, 10)
    rod = mesh.tube(f"{name}_rod", [(0, 0, -0.10), (0, 0, -length)], 0.0035, 8)
    return [mesh.set_material(handle, grip), mesh.set_material(rod, steel)]


def _ladle(name: str, steel: bpy.types.Material, grip: bpy.types.Material) -> bpy.types.Object:
    bowl = mesh.lathe(
        f"{name}_bowl",
        [
            (0.0, 0.0),
            (0.026, 0.006),
            (0.043, 0.026),
            (0.046, 0.042),
            (0.043, 0.042),
            (0.038, 0.026),
            (0, 0.004),
        ],
        28,
    )
    bowl = placed(bowl, steel, y=-0.04, z=-0.315)
    return mesh.join(name, [*_stem(name, 0.30, steel, grip), bowl])


def _turner(name: str, steel: bpy.types.Material, grip: bpy.types.Material) -> bpy.types.Object:
    blade = mesh.move(mesh.bevel_box(f"{name}_blade", (0.078, 0.003, 0.10), 0.001, 1), z=-0.33)
    return mesh.join(name, [*_stem(name, 0.25, steel, grip), mesh.set_material(blade, steel)])


def _skimmer(name: str, steel: bpy.types.Material, grip: bpy.types.Material) -> bpy.types.Object:
    disc = mesh.rotate(
        mesh.lathe(
            f"{name}_disc", [(0, -0.010), (0.03, -0.007), (0.052, 0.0), (0.052, 0.003), (0, -0.006)], 28
        ),
        "X",
        80,
    )
    return mesh.join(
        name, [*_stem(name, 0.26, steel, grip), mesh.set_material(mesh.move(disc, z=-0.30), steel)]
    )


def _sieve(name: str, steel: bpy.types.Material, grip: bpy.types.Material) -> bpy.types.Object:
    ring = mesh.rotate(mesh.torus(f"{name}_ring", 0.062, 0.004, 32, 8), "X", 90)
    mesh_bowl = mesh.rotate(mesh.ellipsoid(f"{name}_net", (0.060, 0.060, 0.030), 24, 12), "X", 90)
    net = principled(f"{name}_net", (0.30, 0.30, 0.31), roughness=0.5, metallic=0.7, bump=(900, 0.001))
    parts = [placed(ring, steel, z=-0.23), placed(mesh_bowl, net, z=-0.23)]
    return mesh.join(name, [*_stem(name, 0.17, steel, grip), *parts])


def _whisk(name: str, steel: bpy.types.Material, grip: bpy.types.Material) -> bpy.types.Object:
    wires = Parts(name)
    for k in range(5):
        a = pi * k / 5
        loop = [
            (
                0.034 * sin(t) ** 1.0 * cos(a) * (1 if s > 0 else -1),
                0.034 * sin(t) * sin(a) * (1 if s > 0 else -1),
                -0.13 - 0.15 * (1 - cos(t)) / 2,
            )
            for s in (1, -1)
            for t in ([pi * i / 8 for i in range(9)] if s > 0 else [pi * (8 - i) / 8 for i in range(1, 9)])
        ]
        wires.tube("wire", steel, loop, 0.0018, 6)
    return mesh.join(name, [*_stem(name, 0.14, steel, grip), *wires])
