"""Teapots: a thrown or spun body with a spout, an ear and a lid.

Owns the shape of pots and says where the spout ends and where a hand takes the ear. Knows nothing of who
pours. The spout points to -Y, the ear is at +Y; the pot stands on z = 0.
"""

from __future__ import annotations

import random
from dataclasses import dataclass

import bpy
from mathutils import Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products, tableware
from l4d_blender.scene import keys
from l4d_blender.scene.catalogue import colours, kind, words
from l4d_blender.scene.colour import Colour

Profile = tuple[tuple[float, float], ...]

# Outer walls as (radius, height) in metres, from the foot to the shoulder where the lid sits.
ROUND: Profile = (
    (0.040, 0.0),
    (0.043, 0.003),
    (0.044, 0.007),
    (0.056, 0.018),
    (0.067, 0.034),
    (0.0725, 0.053),
    (0.0715, 0.072),
    (0.063, 0.090),
    (0.050, 0.102),
    (0.043, 0.106),
)
TALL: Profile = (
    (0.061, 0.0),
    (0.063, 0.003),
    (0.0630, 0.012),
    (0.0600, 0.040),
    (0.0560, 0.080),
    (0.0520, 0.120),
    (0.0490, 0.148),
    (0.0480, 0.156),
    (0.0465, 0.160),
)
BAR_M = (0.0078, 0.0054)  # half width and half thickness of the ear


@dataclass(frozen=True)
class Look:
    """What a pot looks like: round or tall, ceramic or enamel, plain, dipped or banded, its knob."""

    shape: str = "round"
    material: str = "ceramic"
    colour: Colour = (0.07, 0.16, 0.26)
    pattern: str = "plain"  # plain, banded, dipped
    accent: Colour = (0.70, 0.67, 0.60)
    knob: str = "ball"  # ball, wood

    @property
    def profile(self) -> Profile:
        """The wall."""
        return ROUND if self.shape == "round" else TALL

    @property
    def height_m(self) -> float:
        """Height of the shoulder, without the lid."""
        return self.profile[-1][1]

    @property
    def spout_tip(self) -> Vector:
        """Where tea leaves the spout, in the pot's axes (metres)."""
        return Vector((0.0, -0.130, 0.106)) if self.shape == "round" else Vector((0.0, -0.124, 0.150))

    @property
    def grip(self) -> Vector:
        """Middle of the ear's outer bar that fingers close around, in the pot's axes (metres)."""
        return Vector((0.0, 0.127, 0.060)) if self.shape == "round" else Vector((0.0, 0.115, 0.090))


@kind(
    "teapot",
    (0.146, 0.268, 0.148),
    "graspable",
    "pours",
    "container",
    front="-y",
    colour=colours("look.colour"),
    shape=words("look.shape", "round", "tall"),
    pattern=words("look.pattern", "plain", "banded", "dipped"),
)
def teapot(name: str, rng: random.Random, *, look: Look = Look()) -> bpy.types.Object:
    """A pot with its lid on, 13 cm (round) or 19 cm (tall)."""
    skin = tableware.enamel if look.material == "enamel" else products.glaze
    glaze, accent = skin(f"{name}_glaze", look.colour, rng), skin(f"{name}_accent", look.accent, rng)
    height = look.height_m
    body = mesh.lathe(f"{name}_body", _rings(look.profile), 64)
    mesh.paint(body, [glaze, accent], lambda centre, _: _zone(look, centre.z / height))
    spout = mesh.set_material(_spout(f"{name}_spout", look), glaze)
    ear = mesh.set_material(_ear(f"{name}_ear", look), accent if look.material == "enamel" else glaze)
    return mesh.join(name, [body, spout, ear, *_lid(name, look, glaze, accent, rng)])


def _rings(profile: Profile) -> list[tuple[float, float]]:
    """The wall, finely divided so that bands have clean edges, closed at the top under the lid."""
    path = keys.Path([(r, 0.0, z) for r, z in profile])
    points = [path.point(path.length * k / 60) for k in range(61)]
    top_r, top_z = profile[-1]
    return [(p.x, p.z) for p in points] + [(top_r - 0.004, top_z + 0.001), (0.0, top_z + 0.001)]


def _zone(look: Look, f: float) -> int:
    if look.pattern == "banded":
        return int(0.66 < f < 0.71 or 0.76 < f < 0.85)
    if look.pattern == "dipped":
        return int(f < 0.34)
    return int(look.material == "enamel" and f > 0.985)


def _spout(name: str, look: Look) -> bpy.types.Object:
    tip = look.spout_tip
    if look.shape == "round":
        points = [(0, -0.058, 0.040), (0, -0.082, 0.050), (0, -0.099, 0.068), (0, -0.112, 0.090), tip]
        radii = [0.0235, 0.0185, 0.0140, 0.0108, 0.0088]
    else:
        points = [(0, -0.048, 0.062), (0, -0.074, 0.076), (0, -0.092, 0.102), (0, -0.106, 0.130), tip]
        radii = [0.0240, 0.0180, 0.0135, 0.0105, 0.0084]
    path = keys.Path(points)
    widths = keys.Path([(i, r, 0.0) for i, r in enumerate(radii)])
    line = [path.point(path.length * k / 20) for k in range(21)]
    sizes = [widths.point(widths.length * k / 20).y for k in range(21)]
    spout = mesh.tube(name, [*line, line[-1] - (line[-1] - line[-2]) * 1.2], [*sizes, 0.55 * sizes[-1]], 22)
    return spout


def _ear(name: str, look: Look) -> bpy.types.Object:
    """A bar from the shoulder out to the grip and back to the belly: three fingers fit in."""
    out, z = look.grip.y, look.grip.z
    if look.shape == "round":
        upper, lower = Vector((0, 0.056, z + 0.036)), Vector((0, 0.062, z - 0.034))
    else:
        upper, lower = Vector((0, 0.046, z + 0.052)), Vector((0, 0.053, z - 0.044))
    path = keys.Path(
        [
            upper,
            upper + Vector((0, 0.026, 0.008)),
            Vector((0, out - 0.009, z + 0.033)),
            Vector((0, out, z + 0.006)),
            Vector((0, out - 0.003, z - 0.022)),
            Vector((0, out - 0.018, z - 0.040)),
            lower,
        ]
    )
    line = [path.point(path.length * k / 30) for k in range(31)]
    flare = [1.0 + 0.45 * max(0.0, abs(2 * k / 30 - 1) - 0.8) / 0.2 for k in range(31)]
    return mesh.tube(name, line, [(BAR_M[0] * f, BAR_M[1] * f) for f in flare], 16)


def _lid(
    name: str, look: Look, glaze: bpy.types.Material, accent: bpy.types.Material, rng: random.Random
) -> list[bpy.types.Object]:
    r, z = look.profile[-1][0] + 0.0035, look.height_m
    dome = 0.020 if look.shape == "round" else 0.016
    cover = mesh.lathe(
        f"{name}_lid",
        [
            (r - 0.004, z - 0.002),
            (r, z),
            (r, z + 0.003),
            (0.93 * r, z + 0.0055),
            (0.72 * r, z + 0.0115),
            (0.4 * r, z + 0.8 * dome),
            (0.0, z + dome),
        ],
        48,
    )
    mesh.set_material(cover, glaze)
    top = z + dome
    knob = mesh.lathe(
        f"{name}_knob",
        [
            (0.0055, top - 0.003),
            (0.005, top + 0.002),
            (0.0095, top + 0.006),
            (0.0125, top + 0.012),
            (0.0110, top + 0.018),
            (0.0060, top + 0.0215),
            (0.0, top + 0.0225),
        ],
        28,
    )
    wood = look.knob == "wood"
    cork = (
        products.wood(f"{name}_knob_wood", (0.42, 0.22, 0.09), (0.2, 0.09, 0.03), rng, grain_axis="Z")
        if wood
        else None
    )
    return [cover, mesh.set_material(knob, cork or (accent if look.pattern != "plain" else glaze))]
