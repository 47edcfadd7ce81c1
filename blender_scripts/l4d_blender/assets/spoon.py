"""Spoons of metal or wood: a bowl, a neck and a handle that widens towards its end.

Owns the shape. Knows nothing of hands or dishes. The bowl points to -Y, the handle lies along +Y; the spoon
lies on z = 0 as on a table, hollow side up, its origin between bowl and handle.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from math import pi, sin

import bpy
from mathutils import Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products, tableware
from l4d_blender.scene.catalogue import COLOURS, Choice, kind
from l4d_blender.scene.colour import Colour

SILVER: Colour = (0.72, 0.70, 0.66)


@dataclass(frozen=True)
class Look:
    """Sizes in metres; `material` is metal or wood; a coloured grip covers the rear part of the handle,
    and a ring to hang it by may end it."""

    length_m: float = 0.145
    bowl_m: tuple[float, float] = (0.030, 0.046)  # width, length
    handle_m: tuple[float, float] = (0.0055, 0.011)  # width at the neck and near the end
    thickness_m: float = 0.0022
    material: str = "metal"
    colour: Colour = SILVER
    grip: Colour | None = None
    ring: bool = False

    @property
    def tip(self) -> Vector:
        """The foremost point of the bowl in the spoon's axes."""
        return Vector((0.0, -self.bowl_m[1], 0.0))

    @property
    def end(self) -> Vector:
        """The end of the handle in the spoon's axes."""
        return Vector((0.0, self.length_m - self.bowl_m[1], self.thickness_m))


@kind(
    "spoon",
    (0.033, 0.147, 0.017),
    "graspable",
    "stirs",
    grip=Choice("look.grip", {"bare": None, **COLOURS}),
    end=Choice("look.ring", {"plain": False, "ring": True}),
)
def spoon(name: str, rng: random.Random, *, look: Look = Look()) -> bpy.types.Object:
    """One spoon."""
    if look.material == "wood":
        skin = products.wood(f"{name}_wood", look.colour, products.scaled(look.colour, 0.5), rng)
    else:
        skin = products.metal(f"{name}_metal", look.colour, rng, roughness=0.24)
    parts = [mesh.set_material(_bowl(f"{name}_bowl", look), skin)]
    handle = _handle(f"{name}_handle", look, look.end.y)
    materials = [skin]
    if look.grip is not None:
        coat = tableware.enamel if look.material == "metal" else products.lacquer
        materials.append(coat(f"{name}_grip", look.grip, rng))
    from_y = 0.42 * look.end.y
    mesh.paint(handle, materials, lambda centre, _: int(look.grip is not None and centre.y > from_y))
    parts.append(handle)
    if look.ring:
        ring = mesh.torus(f"{name}_ring", 0.0125, 0.0030, 28, 10)
        parts.append(mesh.set_material(mesh.move(ring, y=look.end.y + 0.011, z=0.003), skin))
    return mesh.drop_to_base(mesh.join(name, parts))


def _bowl(name: str, look: Look) -> bpy.types.Object:
    """A hollow egg shape."""
    width, length = look.bowl_m
    depth = 0.24 * width if look.material == "metal" else 0.20 * width
    rows, columns = 30, 24
    verts, faces = [], []
    for j in range(rows + 1):
        t = j / rows
        half = 0.5 * width * max(sin(pi * t**1.18) ** 0.62, 0.07)
        for i in range(columns + 1):
            s = 2 * i / columns - 1
            hollow = depth * (1 - s * s) * sin(pi * min(t, 1.0)) ** 0.7
            verts.append(Vector((half * s, -length * (1 - t), depth - hollow)))
    for j in range(rows):
        for i in range(columns):
            a = j * (columns + 1) + i
            faces.append((a, a + 1, a + columns + 2, a + columns + 1))
    sheet = mesh.from_pydata(name, verts, faces)
    mesh.solidify(sheet, look.thickness_m if look.material == "metal" else 2.2 * look.thickness_m)
    return mesh.shade_smooth(sheet, 50.0)


def _handle(name: str, look: Look, length: float) -> bpy.types.Object:
    """An oval bar that rises from the bowl's rim and droops to the table at its end."""
    depth = 0.24 * look.bowl_m[0]
    neck, wide = look.handle_m
    steps = 34
    points, radii = [], []
    for k in range(steps + 1):
        t = k / steps
        y = -0.008 + (length + 0.008) * t
        z = depth * (1 - t) ** 1.5 + look.thickness_m * 0.5 + 0.010 * sin(pi * t) * (length / 0.1)
        end = min(1.0, (1.0 - t) / 0.05 + 0.35)
        half = 0.5 * (neck + (wide - neck) * t**1.4) * end
        thick = (0.62 if look.material == "metal" else 1.0) * look.thickness_m
        thick = max(thick, 0.42 * half if look.material == "wood" else 0.0) * (0.6 + 0.4 * end)
        points.append((0.0, y, z))
        radii.append((half, thick))
    return mesh.tube(name, points, radii, 16)
