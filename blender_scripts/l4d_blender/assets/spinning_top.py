"""A spinning top: a turned body with coloured segments, a pointed foot and a stem to twist.

Owns the shape and how far it can lean before its rim touches the ground. Knows nothing of spinning. Its point
is the origin, its axis +Z.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import dataclass
from math import atan2, pi

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.assets.toy_robot import printed_tin
from l4d_blender.scene.catalogue import COLOURS, Choice, kind, words
from l4d_blender.scene.colour import Colour, rgb

Profile = Sequence[tuple[float, float]]

RED, CREAM, BLUE, GREEN, YELLOW = (
    (0.50, 0.04, 0.03),
    (0.72, 0.64, 0.46),
    (0.04, 0.13, 0.38),
    (0.06, 0.25, 0.12),
    (0.72, 0.46, 0.04),
)
BEECH: Colour = (0.58, 0.40, 0.23)
# Three segments of a colour and a cream one, so that one sees it turn.
SEGMENTS: dict[str, tuple[Colour, ...]] = {
    word: (COLOURS[word], rgb(0.62 * c for c in COLOURS[word]), COLOURS[word], CREAM)
    for word in ("red", "orange", "yellow", "green", "teal", "blue", "purple", "black")
}

BROAD: Profile = (
    (0.0, 0.0),
    (0.0022, 0.0012),
    (0.0042, 0.006),
    (0.0105, 0.015),
    (0.0270, 0.024),
    (0.0370, 0.030),
    (0.0395, 0.034),
    (0.0385, 0.038),
    (0.0300, 0.043),
    (0.0140, 0.047),
    (0.0075, 0.050),
    (0.0060, 0.058),
    (0.0058, 0.078),
    (0.0066, 0.082),
    (0.0050, 0.086),
    (0.0, 0.087),
)
PEAR: Profile = (
    (0.0, 0.0),
    (0.0022, 0.0012),
    (0.0038, 0.005),
    (0.0120, 0.018),
    (0.0240, 0.034),
    (0.0295, 0.047),
    (0.0300, 0.054),
    (0.0265, 0.061),
    (0.0160, 0.066),
    (0.0080, 0.069),
    (0.0056, 0.074),
    (0.0052, 0.088),
    (0.0074, 0.092),
    (0.0074, 0.095),
    (0.0, 0.098),
)


@dataclass(frozen=True)
class Look:
    """Profile, material ("tin" or "wood") and the colours of its segments, each once round the axis."""

    profile: Profile = BROAD
    material: str = "tin"
    segments: tuple[Colour, ...] = (RED, CREAM, BLUE, CREAM)


@kind(
    "top",
    (0.079, 0.079, 0.087),
    "graspable",
    "spins",
    shape=Choice("look.profile", {"broad": BROAD, "pear": PEAR}),
    material=words("look.material", "tin", "wood"),
    colour=Choice("look.segments", SEGMENTS),
)
def spinning_top(name: str, rng: random.Random, *, look: Look = Look()) -> bpy.types.Object:
    """A top about 9 cm tall; the segments are uneven, so that one sees it turn."""
    body = mesh.lathe(name, look.profile, 60, close_bottom=False)
    mesh.shade_smooth(body, 50.0)
    wood = products.wood(f"{name}_beech", BEECH, (0.40, 0.25, 0.12), rng, grain_axis="Z")
    steel = products.metal(f"{name}_steel", (0.58, 0.57, 0.55), rng)
    paint = printed_tin if look.material == "tin" else products.lacquer
    inks = [paint(f"{name}_ink{k}", colour, rng) for k, colour in enumerate(look.segments)]
    widest = max(r for r, _ in look.profile)
    base = wood if look.material == "wood" else inks[1]

    def choose(at, _normal) -> int:
        if at.z < 0.008:
            return 1
        r = (at.x**2 + at.y**2) ** 0.5
        if r < 0.30 * widest:
            return 0
        if look.material == "wood" and not 0.52 * widest < r < 0.97 * widest:
            return 0
        turn = (atan2(at.y, at.x) / (2 * pi)) % 1.0
        return 2 + int(turn * len(inks)) % len(inks)

    return mesh.paint(body, [base, steel, *inks], choose)


def lean_at_rest(profile: Profile) -> float:
    """Angle in radians between the axis and the vertical at which the rim touches the ground."""
    return min(atan2(z, r) for r, z in profile if r > 0.004 and z > 0.002)


def rim(profile: Profile) -> tuple[float, float]:
    """(radius, height) of the ring of the body that touches the ground when it has fallen."""
    return min(((r, z) for r, z in profile if r > 0.004 and z > 0.002), key=lambda p: atan2(p[1], p[0]))
