"""Farm tools that stand about: a wooden wheelbarrow, a ladder, a hay fork, a milk churn. Scenery or
landmarks.
"""

from __future__ import annotations

import math
import random

import bpy
from mathutils import Matrix, Vector

from l4d_blender.scene.catalogue import kind

from . import mesh
from .materials import outdoors
from .parts import Parts


def _bar(name: str, start: Vector, end: Vector, width: float, height: float) -> bpy.types.Object:
    """A squared timber between two points."""
    return mesh.tube(name, [start, start.lerp(end, 0.5), end], [(width * 0.7, height * 0.7)] * 3, segments=4)


@kind("wheelbarrow", (0.747, 1.67, 0.745), "container", front="-y")
def wheelbarrow(name: str, rng: random.Random) -> bpy.types.Object:
    """1.5 m long: a tray of boards on two shafts, a spoked wheel at -Y, handles at +Y."""
    timber = outdoors.weathered_wood(f"{name}_timber", (0.22, 0.165, 0.115), grain_axis="Y")
    iron = outdoors.wrought_iron(f"{name}_iron")
    boards = outdoors.weathered_wood(f"{name}_tray", (0.17, 0.19, 0.135), grain_axis="Y")
    wood, metal, tray = [], [], []
    for side in (-1.0, 1.0):
        wood.append(
            _bar(
                f"{name}_shaft",
                Vector((side * 0.10, -0.62, 0.24)),
                Vector((side * 0.31, 0.80, 0.55)),
                0.045,
                0.055,
            )
        )
        wood.append(
            _bar(
                f"{name}_leg",
                Vector((side * 0.25, 0.30, 0.46)),
                Vector((side * 0.29, 0.36, 0.0)),
                0.045,
                0.045,
            )
        )
        wood.append(
            _bar(
                f"{name}_spoke_post",
                Vector((side * 0.09, -0.62, 0.24)),
                Vector((side * 0.05, -0.62, 0.24)),
                0.03,
                0.05,
            )
        )
    rim = mesh.torus(f"{name}_rim", 0.215, 0.022, 28, 8)
    metal.append(
        mesh.transform(rim, Matrix.Translation((0, -0.62, 0.237)) @ Matrix.Rotation(math.pi / 2, 4, "Y"))
    )
    hub = mesh.cylinder(f"{name}_hub", 0.05, 0.12, 14, 0.01)
    wood.append(
        mesh.transform(hub, Matrix.Translation((-0.06, -0.62, 0.237)) @ Matrix.Rotation(math.pi / 2, 4, "Y"))
    )
    for k in range(6):
        a = math.pi * k / 3
        tip = Vector((0.0, -0.62 + 0.2 * math.cos(a), 0.237 + 0.2 * math.sin(a)))
        wood.append(mesh.tube(f"{name}_spoke", [Vector((0, -0.62, 0.237)), tip], 0.016, 6))

    # Trays flare: the floor is smaller than the brim, and the front board leans over the wheel.
    floor = [
        Vector((-0.20, -0.30, 0.34)),
        Vector((0.20, -0.30, 0.34)),
        Vector((0.26, 0.34, 0.47)),
        Vector((-0.26, 0.34, 0.47)),
    ]
    brim = [
        Vector((-0.32, -0.52, 0.66)),
        Vector((0.32, -0.52, 0.66)),
        Vector((0.37, 0.42, 0.74)),
        Vector((-0.37, 0.42, 0.74)),
    ]
    verts = [*floor, *brim]
    faces = [(3, 2, 1, 0), *[(k, (k + 1) % 4, 4 + (k + 1) % 4, 4 + k) for k in range(4)]]
    shell = mesh.solidify(mesh.from_pydata(f"{name}_tray", verts, faces, smooth=False), 0.02, offset=0.0)
    tray.append(mesh.bevel(shell, 0.006, 1))
    for parts, look in ((wood, timber), (metal, iron), (tray, boards)):
        for part in parts:
            mesh.set_material(part, look)
    return mesh.join(name, wood + metal + tray)


@kind("ladder", (0.445, 0.065, 3.2))
def ladder(name: str, rng: random.Random, *, length_m: float = 3.2) -> bpy.types.Object:
    """Stands upright along +Z, 0.42 m wide in X; the recipe leans it."""
    parts = Parts(name)
    for side in (-1.0, 1.0):
        parts.add(mesh.bevel_box("rail", (0.045, 0.065, length_m), 0.01, 1), x=side * 0.20)
    z = 0.28
    while z < length_m - 0.1:
        tilt = rng.uniform(-0.008, 0.008)
        parts.add(mesh.tube("rung", [Vector((-0.2, 0, z - tilt)), Vector((0.2, 0, z + tilt))], 0.017, 8))
        z += 0.29
    whole = parts.join()
    return mesh.set_material(whole, outdoors.weathered_wood(f"{name}_wood", (0.30, 0.23, 0.15)))


@kind("fork", (0.224, 0.055, 1.65), "graspable")
def hay_fork(name: str, rng: random.Random) -> bpy.types.Object:
    """1.65 m long, prongs down at z = 0, in the XZ plane."""
    shaft = mesh.tube(
        f"{name}_shaft",
        [Vector((0, 0, 0.36)), Vector((0.01, 0, 1.0)), Vector((0, 0, 1.65))],
        [0.015, 0.018, 0.015],
        9,
    )
    mesh.set_material(shaft, outdoors.turned_wood(f"{name}_shaft"))
    parts = Parts(name)
    parts.add(shaft)
    iron = outdoors.wrought_iron(f"{name}_iron")
    for side in (-1.0, 0.0, 1.0):
        points = [
            (0, 0, 0.42),
            (side * 0.06, 0, 0.36),
            (side * 0.10, -0.01, 0.25),
            (side * 0.105, -0.03, 0.12),
            (side * 0.10, -0.02, 0.0),
        ]
        parts.tube("prong", iron, [Vector(p) for p in points], [0.012, 0.009, 0.008, 0.007, 0.003], 7)
    return parts.join()


@kind("churn", (0.421, 0.346, 0.735), "container")
def milk_churn(name: str, rng: random.Random) -> bpy.types.Object:
    """A 0.7 m churn with shoulders, neck, lid and two ears."""
    profile = [
        (0.165, 0.0),
        (0.17, 0.012),
        (0.168, 0.03),
        (0.168, 0.22),
        (0.173, 0.232),
        (0.168, 0.245),
        (0.168, 0.44),
        (0.150, 0.50),
        (0.108, 0.555),
        (0.098, 0.58),
        (0.100, 0.63),
        (0.118, 0.655),
        (0.122, 0.67),
        (0.118, 0.69),
        (0.060, 0.705),
        (0.05, 0.73),
        (0.0, 0.735),
    ]
    body = mesh.lathe(f"{name}_body", profile, segments=36)
    parts = [body]
    for side in (-1.0, 1.0):
        ear = [
            Vector((side * 0.155, 0, 0.49)),
            Vector((side * 0.20, 0, 0.53)),
            Vector((side * 0.185, 0, 0.60)),
            Vector((side * 0.10, 0, 0.60)),
        ]
        parts.append(mesh.tube(f"{name}_ear", ear, 0.011, 8))
    whole = mesh.join(name, parts)
    return mesh.set_material(whole, outdoors.galvanised(f"{name}_tin", rng))
