"""What a classroom has: a pupil's desk, a blackboard, a globe on a stand."""

from __future__ import annotations

import random
from math import radians

import bpy
from mathutils import Matrix

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import interior, products
from l4d_blender.assets.materials.base import Nodes, principled
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import colours, kind
from l4d_blender.scene.colour import Colour


@kind("desk", (0.7, 0.5, 0.74), "surface", front="-y", colour=colours("frame"))
def pupil_desk(name: str, rng: random.Random, *, frame: Colour = (0.10, 0.14, 0.20)) -> bpy.types.Object:
    """A small table on a steel frame, with a tray for books; who sits there is at -Y."""
    wood = products.wood(f"{name}_wood", (0.50, 0.36, 0.20), (0.34, 0.22, 0.11), rng, grain_axis="X")
    steel = products.lacquer(f"{name}_steel", frame, rng)
    parts = Parts(name)
    parts.box("top", wood, (0.70, 0.50, 0.025), 0.008, 2, z=0.715)
    parts.box("tray", steel, (0.56, 0.34, 0.015), 0.004, 1, y=0.04, z=0.60)
    for x in (-1, 1):
        for y in (-0.20, 0.20):
            parts.tube("leg", steel, [(0.31 * x, y, 0.0), (0.31 * x, y, 0.715)], 0.014, 10)
        parts.box("bar", steel, (0.022, 0.40, 0.022), 0.004, 1, x=0.31 * x, z=0.60)
    return parts.join()


@kind("blackboard", (2.3, 0.1, 1.21), "hangs", front="-y", colour=colours("slate"))
def blackboard(
    name: str,
    rng: random.Random,
    *,
    slate: Colour = (0.03, 0.07, 0.05),
    width_m: float = 2.2,
    height_m: float = 1.1,
) -> bpy.types.Object:
    """A board with wiped chalk and a ledge; the wall is y = 0, the lower edge of the slate at z = 0."""
    material = bpy.data.materials.new(f"{name}_slate")
    n = Nodes(material)
    wiped = n.noise(3.0, 4.0, vector=n.mapping(n.object_coords(), scale=(1.0, 1.0, 0.35)))
    dust = n.math("MULTIPLY", n.map_range(wiped, 0.45, 0.75), 0.35)
    n.set("Base Color", n.mix(dust, slate, (0.30, 0.31, 0.30)))
    n.set("Roughness", 0.85)
    wood = interior.wood(f"{name}_wood", (0.40, 0.25, 0.12), rng, grain_axis="X")
    chalk = principled(f"{name}_chalk", (0.7, 0.7, 0.66), roughness=1.0)
    parts = Parts(name)
    parts.box("board", material, (width_m, 0.02, height_m), y=-0.012)
    for z in (-0.05, height_m):
        parts.box("rail", wood, (width_m + 0.1, 0.04, 0.05), 0.006, 1, y=-0.02, z=z)
    for x in (-1.0, 1.0):
        parts.box("rail", wood, (0.05, 0.04, height_m), 0.006, 1, x=x * (width_m + 0.05) / 2, y=-0.02)
    parts.box("ledge", wood, (width_m, 0.09, 0.02), 0.004, 1, y=-0.055, z=-0.06)
    for _ in range(rng.randint(3, 6)):
        x, z = rng.uniform(-0.42, 0.3) * width_m, rng.uniform(0.15, 0.9) * height_m
        for k in range(rng.randint(3, 7)):
            line = mesh.box(f"{name}_line", (rng.uniform(0.03, 0.09), 0.001, 0.012))
            mesh.rotate(line, "Y", rng.choice((0, 0, 90, 40, -40)))
            parts.add(line, chalk, x=x + 0.06 * k, y=-0.0235, z=z)
    return parts.join()


@kind("globe", (0.446, 0.429, 1.113), front=None)
def globe(name: str, rng: random.Random) -> bpy.types.Object:
    """A globe of the earth on a wooden stand that reaches to the hip."""
    material = bpy.data.materials.new(f"{name}_earth")
    n = Nodes(material)
    land = n.noise(rng.uniform(3.5, 5.0), 6.0)
    tone = n.ramp(land, [(0.0, (0.05, 0.16, 0.34)), (0.52, (0.07, 0.22, 0.40)), (0.54, (0.36, 0.34, 0.12))])
    n.set("Base Color", tone)
    n.set("Roughness", 0.35)
    wood = interior.wood(f"{name}_wood", (0.28, 0.15, 0.07), rng, grain_axis="Z")
    brass = products.metal(f"{name}_brass", (0.56, 0.42, 0.20), rng, roughness=0.3)
    ball = mesh.transform(
        mesh.ellipsoid(f"{name}_ball", (0.19, 0.19, 0.19), 32, 20), Matrix.Rotation(radians(23), 4, "X")
    )
    parts = Parts(name)
    parts.add(ball, material, z=0.89)
    parts.torus("ring", brass, 0.215, 0.008, 40, 8, z=0.89, turn=("X", 90.0))
    parts.cylinder("pole", wood, 0.022, 0.68, 16, 0.004)
    for k in range(3):
        foot = mesh.tube(
            f"{name}_foot", [(0.0, 0.0, 0.16), (0.0, -0.14, 0.10), (0.0, -0.23, 0.014)], 0.014, 8
        )
        parts.add(foot, wood, turn=("Z", 120 * k))
    return parts.join()
