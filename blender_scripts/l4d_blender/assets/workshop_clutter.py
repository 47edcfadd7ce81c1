"""Small things of a tinkerer's table: a screwdriver, loose cogs and screws, a spool of thread, an oil can.

Owns these still lives; each lies or stands on z = 0.
"""

from __future__ import annotations

import random
from math import cos, sin

import bpy
from mathutils import Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.assets.parts import Parts
from l4d_blender.assets.toy_robot import gear
from l4d_blender.scene.catalogue import colours, kind


@kind("screwdriver", (0.198, 0.025, 0.026), "graspable", "rolls")
def screwdriver(name: str, rng: random.Random) -> bpy.types.Object:
    """A screwdriver 19 cm long that lies along X, its blade to -X."""
    blade = mesh.lathe(f"{name}_blade", [(0.0032, -0.092), (0.0032, 0.004)], 16)
    tip = mesh.bevel_box(f"{name}_tip", (0.0075, 0.0016, 0.012), 0.0004, segments=1)
    parts = Parts(name)
    parts.lathe(
        "grip",
        products.satin_plastic(f"{name}_red", (0.50, 0.16, 0.02), rng, roughness=0.25),
        [
            (0.006, 0.0),
            (0.010, 0.004),
            (0.0085, 0.014),
            (0.0125, 0.030),
            (0.0130, 0.060),
            (0.0105, 0.082),
            (0.0115, 0.090),
            (0.006, 0.095),
            (0.0, 0.096),
        ],
        10,
    )
    parts.add(blade, products.metal(f"{name}_steel", (0.5, 0.5, 0.52), rng))
    parts.add(tip, products.metal(f"{name}_tip", (0.3, 0.3, 0.32), rng), z=-0.102)
    driver = mesh.rotate(parts.join(), "Y", 90.0)
    return mesh.move(driver, z=0.0125)


@kind("parts", (0.102, 0.082, 0.007))
def loose_parts(name: str, rng: random.Random, *, count: int = 9) -> bpy.types.Object:
    """Cogs and screws strewn over a hand's breadth."""
    brass = products.metal(f"{name}_brass", (0.60, 0.42, 0.15), rng)
    steel = products.metal(f"{name}_steel", (0.52, 0.52, 0.54), rng)
    parts = Parts(name)
    for k in range(count):
        a, r = 2.4 * k, 0.014 * (k + 0.6) ** 0.62
        at = Vector((r * cos(a), 0.8 * r * sin(a), 0.0))
        if k % 3 == 0:
            radius = rng.uniform(0.006, 0.010)
            parts.add(gear(f"{name}_cog", radius, 0.002), brass, x=at.x, y=at.y)
        else:
            screw = mesh.lathe(
                f"{name}_screw",
                [(0.0006, -0.010), (0.0014, -0.006), (0.0014, 0.002), (0.0032, 0.0035), (0.0032, 0.005)],
                12,
                close_top=True,
            )
            mesh.rotate(mesh.rotate(screw, "Y", 84.0), "Z", rng.uniform(0.0, 360.0))
            parts.add(screw, steel, x=at.x, y=at.y, z=0.0030)
    return parts.join()


@kind("spool", (0.039, 0.039, 0.05), "graspable", "rolls", colour=colours("thread"))
def spool(
    name: str, rng: random.Random, *, thread: tuple[float, float, float] = (0.1, 0.13, 0.32)
) -> bpy.types.Object:
    """A wooden spool of thread, 5 cm tall."""
    beech = products.wood(f"{name}_beech", (0.50, 0.34, 0.18), (0.34, 0.2, 0.1), rng, grain_axis="Z")
    yarn = products.woven_cloth(f"{name}_yarn", thread, rng, threads_per_m=1400.0)
    parts = Parts(name)
    parts.lathe(
        "core",
        beech,
        [
            (0.018, 0.0),
            (0.0195, 0.003),
            (0.017, 0.007),
            (0.009, 0.010),
            (0.009, 0.040),
            (0.017, 0.043),
            (0.0195, 0.047),
            (0.018, 0.050),
        ],
        32,
        close_top=True,
    )
    parts.cylinder("wound", yarn, 0.0155, 0.031, 32, bevel_m=0.003, z=0.0095)
    return parts.join()


@kind("oil_can", (0.072, 0.099, 0.13), "graspable")
def oil_can(name: str, rng: random.Random) -> bpy.types.Object:
    """A little can with a long bent spout, 13 cm tall."""
    copper = products.metal(f"{name}_copper", (0.52, 0.24, 0.11), rng)
    can = mesh.lathe(
        f"{name}_can",
        [
            (0.034, 0.0),
            (0.036, 0.003),
            (0.034, 0.014),
            (0.024, 0.042),
            (0.010, 0.060),
            (0.008, 0.066),
            (0.0, 0.067),
        ],
        40,
    )
    spout = mesh.tube(
        f"{name}_spout",
        [(0, 0, 0.062), (0, -0.006, 0.085), (0, -0.030, 0.110), (0, -0.062, 0.128)],
        [0.0055, 0.0042, 0.003, 0.0018],
        segments=12,
    )
    return mesh.set_material(mesh.join(name, [can, spout]), copper)
