"""Cut flowers in a jug: stems, leaves and round heads of many petals.

Owns jug and bouquet. Knows nothing of tables; it stands on z = 0.
"""

from __future__ import annotations

import random
from math import cos, pi, sin

import bpy
from mathutils import Matrix, Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products, tableware
from l4d_blender.assets.parts import Parts
from l4d_blender.scene import keys
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.colour import Colour

DAISY = ((0.74, 0.72, 0.66), (0.66, 0.36, 0.03))
ROSE = ((0.62, 0.13, 0.17), (0.50, 0.05, 0.08))
CORNFLOWER = ((0.10, 0.15, 0.52), (0.16, 0.06, 0.30))
_JUG = (
    (0.034, 0.0),
    (0.036, 0.002),
    (0.047, 0.020),
    (0.052, 0.045),
    (0.047, 0.072),
    (0.036, 0.094),
    (0.033, 0.106),
    (0.037, 0.120),
    (0.038, 0.122),
    (0.035, 0.121),
    (0.030, 0.106),
    (0.030, 0.095),
)


@kind("vase", (0.178, 0.189, 0.263), "graspable")
def flower_vase(
    name: str,
    rng: random.Random,
    *,
    kinds: tuple[tuple[Colour, Colour], ...] = (DAISY, CORNFLOWER),
    heads: int = 17,
    glaze: Colour = (0.46, 0.5, 0.46),
) -> bpy.types.Object:
    """A jug 12 cm tall whose bouquet reaches about 25 cm."""
    parts = Parts(name)
    parts.lathe("jug", products.glaze(f"{name}_glaze", glaze, rng, speckle=0.4), _JUG, 44)
    green = products.leaf(f"{name}_leaf", (0.06, 0.17, 0.035), rng)
    hearts = [tableware.petal(f"{name}_heart{k}", kind[1], kind[1], rng) for k, kind in enumerate(kinds)]
    petals = [tableware.petal(f"{name}_petal{k}", *kind, rng) for k, kind in enumerate(kinds)]
    for k in range(heads):
        share = (k + 0.5) / heads
        azimuth = 2.39996 * k + rng.uniform(-0.25, 0.25)
        reach, top = 0.095 * share**0.6, 0.245 - 0.085 * share + rng.uniform(-0.018, 0.018)
        out = Vector((cos(azimuth), sin(azimuth), 0.0))
        tip, root = out * reach + Vector((0, 0, top)), -0.3 * out * reach * 0.3 + Vector((0, 0, 0.04))
        path = keys.Path([root, out * 0.022 + Vector((0, 0, 0.118)), tip])
        line = [path.point(path.length * step / 7) for step in range(8)]
        parts.tube("stem", green, line, 0.0014, 6, cap=False)
        which = k % len(kinds)
        look = (line[-1] - line[-2]).normalized().lerp(out, 0.25).normalized()
        turn = look.to_track_quat("Z", "Y").to_matrix().to_4x4()
        pose = Matrix.Translation(tip) @ turn @ Matrix.Scale(rng.uniform(0.85, 1.15), 4)
        parts += _head(f"{name}_head", pose, petals[which], hearts[which], rng)
        for t in (0.55, 0.72):
            at, away = path.point(t * path.length), 2.0 * rng.uniform(0, pi)
            blade = _leaf(f"{name}_blade", rng.uniform(0.035, 0.055))
            turn = Matrix.Rotation(away, 4, "Z") @ Matrix.Rotation(rng.uniform(0.1, 0.8), 4, "X")
            parts.add(blade, green, within=Matrix.Translation(at) @ turn)
    return parts.join()


def _head(
    name: str, pose: Matrix, petal: bpy.types.Material, heart: bpy.types.Material, rng: random.Random
) -> list[bpy.types.Object]:
    """Two rings of petals round a domed heart."""
    verts: list[Vector] = []
    faces: list[tuple[int, ...]] = []
    for ring, (count, length, rise) in enumerate(((13, 0.019, 0.10), (10, 0.014, 0.55))):
        for k in range(count):
            angle = 2 * pi * (k + 0.5 * ring + rng.uniform(-0.15, 0.15)) / count
            along, side = Vector((cos(angle), sin(angle), rise)), Vector((-sin(angle), cos(angle), 0.0))
            first = len(verts)
            for t, half in ((0.15, 0.25), (0.5, 0.9), (0.85, 0.85), (1.0, 0.3)):
                centre = along * (length * t) - Vector((0, 0, 0.004 * t * t))
                verts += [centre - side * 0.0030 * half, centre + side * 0.0030 * half]
            faces += [
                (first + 2 * j, first + 2 * j + 2, first + 2 * j + 3, first + 2 * j + 1) for j in range(3)
            ]
    crown = mesh.set_material(mesh.from_pydata(name, verts, faces), petal)
    dome = mesh.set_material(mesh.ellipsoid(name, (0.0056, 0.0056, 0.0038), 12, 8), heart)
    return [mesh.transform(crown, pose), mesh.transform(dome, pose)]


def _leaf(name: str, length: float) -> bpy.types.Object:
    verts: list[Vector] = []
    faces: list[tuple[int, ...]] = []
    for j in range(7):
        t = j / 6
        half = 0.17 * length * max(sin(pi * t**0.8), 0.03)
        z = 0.25 * length * sin(pi * t) - 0.2 * length * t
        verts += [
            (-half, length * t, z + 0.3 * half),
            (0.0, length * t, z),
            (half, length * t, z + 0.3 * half),
        ]
    for j in range(6):
        a = 3 * j
        faces += [(a, a + 1, a + 4, a + 3), (a + 1, a + 2, a + 5, a + 4)]
    return mesh.from_pydata(name, verts, faces)
