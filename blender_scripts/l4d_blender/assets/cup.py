"""Cups and mugs: one thrown body, one handle, perhaps something to drink.

Owns the shape of cups and where a hand takes them. Knows nothing of who lifts one, or of saucers.
The handle points along +X; the cup stands on z = 0.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from itertools import pairwise

import bpy
from mathutils import Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.scene import keys
from l4d_blender.scene.catalogue import Choice, colours, kind, words
from l4d_blender.scene.colour import Colour

Profile = tuple[tuple[float, float], ...]

COFFEE: Colour = (0.030, 0.012, 0.005)
TEA: Colour = (0.26, 0.080, 0.012)

# Outer walls as (radius, height) in metres, from the foot to the lip.
TULIP: Profile = (
    (0.0275, 0.0),
    (0.0285, 0.0015),
    (0.0290, 0.004),
    (0.0330, 0.009),
    (0.0372, 0.019),
    (0.0400, 0.032),
    (0.0416, 0.050),
    (0.0424, 0.068),
    (0.0428, 0.084),
    (0.0434, 0.098),
)
STRAIGHT: Profile = (
    (0.0350, 0.0),
    (0.0375, 0.0015),
    (0.0390, 0.005),
    (0.0395, 0.012),
    (0.0395, 0.030),
    (0.0395, 0.048),
    (0.0395, 0.066),
    (0.0395, 0.084),
    (0.0395, 0.102),
)
BOWL: Profile = (
    (0.0250, 0.0),
    (0.0255, 0.005),
    (0.0330, 0.011),
    (0.0400, 0.020),
    (0.0450, 0.032),
    (0.0480, 0.045),
    (0.0495, 0.056),
    (0.0505, 0.066),
)

WALL_M = 0.0034
BOTTOM_M = 0.006
FULL_BELOW_LIP_M = 0.013


@dataclass(frozen=True)
class Look:
    """What a cup looks like; two cups of one look are twins."""

    profile: Profile = TULIP
    glaze: Colour = (0.70, 0.68, 0.63)
    pattern: str = "plain"  # plain, rim_band, stripes, dipped, speckled
    accent: Colour = (0.03, 0.06, 0.20)
    liquid: Colour | None = None


@dataclass(frozen=True)
class Handle:
    """The ear of a cup in the plane y = 0: where it joins the wall, and how far it reaches from the axis."""

    top: tuple[float, float]
    bottom: tuple[float, float]
    reach_m: float

    @classmethod
    def of(cls, profile: Profile) -> Handle:
        """The ear that suits a body of this profile."""
        height = profile[-1][1]
        top_z, bottom_z = 0.87 * height, 0.24 * height
        top, bottom = _radius_at(profile, top_z), _radius_at(profile, bottom_z)
        return cls((top, top_z), (bottom, bottom_z), reach_m=max(top, bottom) + 0.031)

    @property
    def grip(self) -> Vector:
        """Middle of the upright bar that fingers close around, in the cup's axes (metres)."""
        return Vector((self.reach_m, 0.0, 0.5 * (self.top[1] + self.bottom[1])))

    def curve(self, steps: int = 22) -> list[Vector]:
        """Centre line from the upper joint to the lower one, both ends a little sunk into the wall."""
        (upper_x, upper_z), (lower_x, lower_z), out = self.top, self.bottom, self.reach_m
        path = keys.Path(
            [
                (upper_x - 0.0025, 0.0, upper_z),
                (out - 0.012, 0.0, upper_z + 0.002),
                (out - 0.002, 0.0, upper_z - 0.010),
                (out, 0.0, 0.55 * upper_z + 0.45 * lower_z),
                (out - 0.004, 0.0, lower_z + 0.012),
                (out - 0.015, 0.0, lower_z + 0.001),
                (lower_x - 0.0025, 0.0, lower_z),
            ]
        )
        return [path.point(path.length * step / (steps - 1)) for step in range(steps)]


@kind(
    "cup",
    (0.121, 0.087, 0.1),
    "graspable",
    "container",
    colour=colours("look.glaze"),
    pattern=words("look.pattern", "plain", "rim_band", "stripes", "dipped", "speckled"),
    content=Choice("look.liquid", {"empty": None, "coffee": COFFEE, "tea": TEA}),
    shape=Choice("look.profile", {"tall": TULIP, "straight": STRAIGHT, "wide": BOWL}),
)
def cup(name: str, rng: random.Random, *, look: Look = Look()) -> bpy.types.Object:
    """A glazed cup, 7 to 11 cm tall, with its handle along +X."""
    materials = [
        products.glaze(f"{name}_glaze", look.glaze, rng, speckle=0.6 if look.pattern == "speckled" else 0.0),
        products.glaze(f"{name}_accent", look.accent, rng),
        products.stoneware(f"{name}_clay", rng),
    ]
    body = mesh.lathe(f"{name}_body", _walls(look.profile), segments=56)
    height = look.profile[-1][1]
    mesh.paint(body, materials, lambda centre, normal: _material_at(look, height, centre, normal))

    curve = Handle.of(look.profile).curve()
    flare = [1.0 + 0.5 * max(0.0, abs(2 * k / (len(curve) - 1) - 1) - 0.75) / 0.25 for k in range(len(curve))]
    bar = mesh.tube(f"{name}_handle", curve, [(0.0058 * f, 0.0036 * f) for f in flare], segments=14)
    mesh.set_material(bar, materials[0])

    parts = [body, bar]
    if look.liquid is not None:
        parts.append(_drink(f"{name}_drink", look))
    return mesh.join(name, parts)


def _walls(profile: Profile) -> list[tuple[float, float]]:
    """Up the outside, over a rounded lip, down the inside to the axis."""
    lip_r, lip_z = profile[-1]
    lip = [
        (lip_r + 0.0002, lip_z + 0.0012),
        (lip_r - 0.30 * WALL_M, lip_z + 0.0022),
        (lip_r - 0.75 * WALL_M, lip_z + 0.0016),
    ]
    inside = [(r - WALL_M, z) for r, z in reversed(profile) if z > BOTTOM_M + 0.006]
    floor_r = inside[-1][0]
    inside += [(floor_r - 0.0035, BOTTOM_M + 0.0035), (floor_r - 0.011, BOTTOM_M), (0.0, BOTTOM_M)]
    outside = _with_rings(profile, [f * lip_z for f in (0.30, 0.36, 0.42, 0.48, 0.54, 0.60, 0.90, 0.955)])
    return [
        (0.0, 0.0015),
        (profile[0][0] - 0.004, 0.0015),
        (profile[0][0] - 0.0025, 0.0),
        *outside,
        *lip,
        *inside,
    ]


def _with_rings(profile: Profile, heights: list[float]) -> list[tuple[float, float]]:
    """The profile with extra points where bands of colour begin and end."""
    extra = [(_radius_at(profile, z), z) for z in heights]
    return sorted({*profile, *extra}, key=lambda point: point[1])


def _radius_at(profile: Profile, z: float) -> float:
    for (r0, z0), (r1, z1) in pairwise(profile):
        if z0 <= z <= z1:
            return r0 + (r1 - r0) * (z - z0) / (z1 - z0)
    raise ValueError(f"no wall at height {z}")


def _material_at(look: Look, height: float, centre: Vector, normal: Vector) -> int:
    """0 glaze, 1 accent, 2 bare clay, by the height of a face on the outer wall."""
    f = centre.z / height
    outside = normal.x * centre.x + normal.y * centre.y > 0.0
    if f < 0.02:
        return 2
    if not outside:
        return 0
    if look.pattern == "rim_band" and (0.90 < f < 0.955):
        return 1
    if look.pattern == "stripes" and (0.30 < f < 0.36 or 0.42 < f < 0.48 or 0.54 < f < 0.60):
        return 1
    if look.pattern == "dipped" and f < 0.42:
        return 2
    return 0


def _drink(name: str, look: Look) -> bpy.types.Object:
    """A disc of liquid below the lip that creeps up the wall by a millimetre."""
    z = look.profile[-1][1] - FULL_BELOW_LIP_M
    r = _radius_at(look.profile, z) - WALL_M
    assert look.liquid is not None
    surface = mesh.lathe(name, [(0.0, z), (0.5 * r, z), (0.9 * r, z), (r + 0.0004, z + 0.0010)], segments=40)
    mesh.set_material(surface, products.liquid(name, look.liquid))
    return surface
