"""The part of a person that a desk leaves visible: a torso in a pullover, upper arms, thighs in jeans.

Owns the still body behind two acting hands, scenery only. Knows nothing of hands or chairs. It faces -Y;
z = 0 is the seat. The neck is cut off: cameras must not look that high.
"""

from __future__ import annotations

import random
from math import cos, pi, sin

import bpy
from mathutils import Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.colour import Colour

SHOULDER = Vector((0.185, 0.01, 0.53))

# Height, half width, half depth, shift towards +Y of each section of the torso (metres).
_SECTIONS = (
    (0.00, 0.185, 0.135, 0.00),
    (0.06, 0.188, 0.138, -0.005),
    (0.14, 0.178, 0.128, -0.004),
    (0.22, 0.168, 0.118, 0.0),
    (0.30, 0.172, 0.118, 0.004),
    (0.38, 0.186, 0.122, 0.006),
    (0.46, 0.198, 0.120, 0.008),
    (0.52, 0.196, 0.108, 0.012),
    (0.57, 0.160, 0.088, 0.016),
    (0.60, 0.095, 0.068, 0.016),
    (0.63, 0.062, 0.060, 0.012),
    (0.67, 0.058, 0.057, 0.006),
)


@kind("sitter", (0.391, 0.661, 1.07), front="-y")
def sitter(
    name: str,
    rng: random.Random,
    *,
    pullover: bpy.types.Material | None = None,
    jeans: Colour = (0.04, 0.07, 0.14),
) -> bpy.types.Object:
    """Torso and thighs; the pullover's material comes from whoever dresses the hands."""
    sections = []
    for z, half_width, half_depth, shift in _SECTIONS:
        ring = []
        for k in range(40):
            a = 2 * pi * k / 40
            fold = 1.0 + 0.018 * sin(5 * a + 19 * z) * sin(31 * z + 2 * cos(a))
            x, y = (abs(f) ** 0.94 * (1 if f >= 0 else -1) for f in (cos(a), sin(a)))
            ring.append(Vector((half_width * x * fold, half_depth * y * fold + shift, z)))
        sections.append(ring)
    pullover = pullover or products.knit(f"{name}_pullover", (0.10, 0.13, 0.22), rng)
    torso = mesh.set_material(mesh.loft(f"{name}_torso", sections), pullover)
    mesh.subdivide(torso, 1)

    denim = products.woven_cloth(f"{name}_denim", jeans, rng, threads_per_m=600.0, contrast=0.3)
    parts = [torso]
    for side in (-1.0, 1.0):
        thigh = mesh.tube(
            f"{name}_thigh",
            [
                (0.09 * side, 0.06, 0.07),
                (0.10 * side, -0.12, 0.075),
                (0.11 * side, -0.30, 0.075),
                (0.115 * side, -0.44, 0.07),
                (0.115 * side, -0.49, 0.02),
            ],
            [0.092, 0.088, 0.078, 0.066, 0.055],
            segments=20,
        )
        shin = mesh.tube(
            f"{name}_shin",
            [(0.115 * side, -0.46, 0.06), (0.115 * side, -0.45, -0.40)],
            [0.062, 0.05],
            segments=18,
        )
        parts += [mesh.set_material(thigh, denim), mesh.set_material(shin, denim)]
    return mesh.join(name, parts)
