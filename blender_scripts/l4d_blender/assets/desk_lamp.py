"""An articulated desk lamp: weighted foot, two arms with joints, a conical shade, a bulb.

Owns the lamp's shape and where its light comes from. Knows nothing of the light that a scene puts there.
The shade reaches towards -Y; the foot stands on z = 0.
"""

from __future__ import annotations

import random
from math import pi

import bpy
from mathutils import Matrix, Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.scene.catalogue import colours, kind
from l4d_blender.scene.colour import Colour

SHOULDER = Vector((0.0, 0.012, 0.035))
ELBOW = Vector((0.0, 0.085, 0.245))
NECK = Vector((0.0, -0.125, 0.385))
SHADE_TILT_RAD = -0.42

# Where a light belongs, in the lamp's axes (metres): just below the bulb, inside the shade.
LIGHT = NECK + Matrix.Rotation(SHADE_TILT_RAD, 3, "X") @ Vector((0.0, 0.0, -0.086))


@kind("lamp", (0.239, 0.398, 0.403), colour=colours("enamel"))
def desk_lamp(name: str, rng: random.Random, *, enamel: Colour = (0.58, 0.26, 0.035)) -> bpy.types.Object:
    """A lamp about 45 cm tall."""
    paint = products.lacquer(f"{name}_enamel", enamel, rng)
    steel = products.metal(f"{name}_steel", (0.58, 0.58, 0.60), rng, roughness=0.28)
    inside = products.lacquer(f"{name}_reflector", (0.85, 0.82, 0.74), rng)
    bulb_glow = products.glow(f"{name}_bulb", (1.0, 0.72, 0.38), 9.0)
    cord_skin = products.rubber(f"{name}_cord", (0.03, 0.03, 0.03), rng)

    foot = mesh.lathe(
        f"{name}_foot",
        [
            (0.074, 0.0),
            (0.078, 0.002),
            (0.079, 0.010),
            (0.076, 0.016),
            (0.060, 0.020),
            (0.020, 0.024),
            (0.014, 0.034),
            (0.0, 0.036),
        ],
        48,
    )
    parts = [mesh.set_material(foot, paint)]
    for start, end in ((SHOULDER, ELBOW), (ELBOW, NECK)):
        for side in (-0.009, 0.009):
            offset = Vector((side, 0.0, 0.0))
            rod = mesh.tube(f"{name}_rod", [start + offset, end + offset], 0.0042, segments=12)
            parts.append(mesh.set_material(rod, steel))
    for joint in (SHOULDER, ELBOW, NECK):
        knuckle = mesh.cylinder(f"{name}_knuckle", 0.013, 0.032, 24, bevel_m=0.002)
        mesh.transform(
            knuckle,
            Matrix.Translation(joint)
            @ Matrix.Rotation(0.5 * pi, 4, "Y")
            @ Matrix.Translation((0.0, 0.0, -0.016)),
        )
        parts.append(mesh.set_material(knuckle, paint))

    hang = Matrix.Translation(NECK) @ Matrix.Rotation(SHADE_TILT_RAD, 4, "X")
    shade = mesh.lathe(
        f"{name}_shade",
        [
            (0.018, 0.012),
            (0.024, 0.008),
            (0.026, -0.010),
            (0.034, -0.026),
            (0.056, -0.060),
            (0.074, -0.098),
            (0.0755, -0.101),
            (0.0735, -0.100),
            (0.054, -0.061),
            (0.032, -0.029),
            (0.0, -0.022),
        ][::-1],
        48,
        close_bottom=False,
        close_top=True,
    )
    mesh.paint(shade, [paint, inside], lambda centre, normal: int(_faces_axis(centre, normal)))
    bulb = mesh.ellipsoid(f"{name}_glass", (0.019, 0.019, 0.024), 20, 12, centre=(0.0, 0.0, -0.052))
    mesh.set_material(bulb, bulb_glow)
    for part in (shade, bulb):
        parts.append(mesh.transform(part, hang))

    cord = mesh.tube(
        f"{name}_cord",
        [
            (0.0, 0.074, 0.006),
            (0.01, 0.10, 0.004),
            (0.04, 0.14, 0.003),
            (0.10, 0.16, 0.003),
            (0.16, 0.15, 0.003),
        ],
        0.003,
        segments=8,
    )
    parts.append(mesh.set_material(cord, cord_skin))
    return mesh.join(name, parts)


def _faces_axis(centre: Vector, normal: Vector) -> bool:
    """Whether a face of the shade looks inwards, at the bulb."""
    return normal.x * centre.x + normal.y * centre.y < 0.0 or (normal.z < -0.5 and centre.z < -0.015)
