"""Cooking pots: steel saucepans with one long handle, enamelled stock pots with two loops, soup inside.

A pot is two objects, body and soup, so that the soup can rise. Knows where its handles are gripped; refuses
to know who cooks.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from math import cos, pi, sin

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import kitchen
from l4d_blender.assets.materials.base import principled
from l4d_blender.scene.catalogue import COLOURS, Choice, kind

WALL_M = 0.004
LOOP_OUT_M = 0.052
LOOP_HALF_M = 0.048
LONG_HANDLE_M = 0.21


@dataclass(frozen=True)
class PotLook:
    """Size, handles ("one_long" along +Y, "two_loops" along X), surface (a colour: enamel; None: steel)."""

    radius_m: float
    height_m: float
    handles: str
    enamel: tuple[float, float, float] | None = None

    @property
    def grip(self) -> tuple[float, float, float]:
        """Where a fist closes round the handle, in the pot's own space."""
        if self.handles == "one_long":
            return 0.0, self.radius_m + 0.66 * LONG_HANDLE_M, self.height_m - 0.002
        return self.radius_m + 0.72 * LOOP_OUT_M, 0.0, 0.80 * self.height_m + 0.004

    @property
    def soup_m(self) -> float:
        """Height of a nearly full pot's soup."""
        return self.height_m - 0.026


SAUCEPAN = PotLook(0.112, 0.125, "one_long")


def stock_pot(colour: tuple[float, float, float]) -> PotLook:
    """A big enamelled pot."""
    return PotLook(0.146, 0.185, "two_loops", colour)


@kind(
    "pot",
    (0.235, 0.46, 0.132),
    "graspable",
    "container",
    size=Choice("look", {"small": SAUCEPAN, "large": stock_pot(COLOURS["red"])}),
)
def pot(name: str, rng: random.Random, *, look: PotLook = SAUCEPAN) -> bpy.types.Object:
    """The empty pot; origin at the centre of its base."""
    r, h = look.radius_m, look.height_m
    metal = kitchen.steel(f"{name}_steel", rng)
    skin = metal if look.enamel is None else kitchen.enamel(f"{name}_enamel", look.enamel, rng)
    lining = (
        metal
        if look.enamel is None
        else principled(f"{name}_lining", (0.70, 0.68, 0.62), roughness=0.25, variation=0.1)
    )
    rim = metal if look.enamel is None else kitchen.cast_iron(f"{name}_rim")
    body = mesh.lathe(
        f"{name}_body",
        [
            (r - 0.016, 0.0),
            (r - 0.006, 0.003),
            (r - 0.001, 0.011),
            (r, 0.022),
            (r, 0.70 * h),
            (r, h - 0.006),
            (r + 0.005, h - 0.003),
            (r + 0.0055, h),
            (r + 0.002, h + 0.002),
            (r - WALL_M, h - 0.003),
            (r - WALL_M, 0.5 * h),
            (r - WALL_M, 0.018),
            (r - 0.018, 0.006),
            (0.0, 0.006),
        ],
        segments=56,
    )
    mesh.paint(
        body,
        (skin, lining, rim),
        lambda centre, normal: (
            2 if centre.z > h - 0.007 else 1 if normal.x * centre.x + normal.y * centre.y < 0 else 0
        ),
    )
    handles = _long_handle(name, look) if look.handles == "one_long" else _loops(name, look, rim)
    return mesh.join(name, [body, *handles])


@kind("soup", (0.218, 0.218, 0.002))
def soup(
    name: str,
    rng: random.Random,
    *,
    look: PotLook = SAUCEPAN,
    colour: tuple[float, float, float] = (0.62, 0.13, 0.03),
    bits: tuple[float, float, float] = (0.20, 0.30, 0.06),
) -> bpy.types.Object:
    """The soup's surface at z = 0, creeping up the wall a little."""
    r = look.radius_m - WALL_M
    surface = mesh.lathe(
        name, [(0.0, 0.0), (0.35 * r, 0.0), (0.7 * r, 0.0), (r - 0.004, 0.0), (r + 0.001, 0.002)], segments=48
    )
    return mesh.set_material(surface, kitchen.soup(f"{name}_surface", colour, bits, rng))


def _long_handle(name: str, look: PotLook) -> list[bpy.types.Object]:
    """A riveted steel bracket and a black grip that rises a little."""
    r, h = look.radius_m, look.height_m
    root = h - 0.032
    line = [(0.0, r - 0.002 + LONG_HANDLE_M * t, root + 0.030 * min(1.0, 2.2 * t)) for t in _steps(12)]
    swell = [(0.017, 0.006) if t < 0.2 else (0.0135 + 0.003 * sin(pi * t), 0.0095) for t in _steps(12)]
    swell[-1] = (0.009, 0.006)
    bar = mesh.tube(f"{name}_handle", line, swell, segments=14, up=(0, 0, 1))
    black = principled(f"{name}_bakelite", (0.018, 0.017, 0.017), roughness=0.35, bump=(260, 0.0003))
    bracket = principled(f"{name}_bracket", (0.5, 0.5, 0.51), roughness=0.3, metallic=1.0)
    mesh.paint(bar, (black, bracket), lambda centre, normal: 1 if centre.y < r + 0.045 else 0)
    ring = mesh.move(
        mesh.rotate(mesh.torus(f"{name}_eye", 0.010, 0.003, 20, 8), "X", 15),
        y=r + LONG_HANDLE_M + 0.008,
        z=h - 0.002,
    )
    return [bar, mesh.set_material(ring, bracket)]


def _loops(name: str, look: PotLook, material: bpy.types.Material) -> list[bpy.types.Object]:
    """Two thick bails at the sides."""
    r, z = look.radius_m, 0.80 * look.height_m
    loops = []
    for side in (-1, 1):
        line = [
            (
                side * (r - 0.003 + LOOP_OUT_M * sin(pi * t) ** 0.6),
                LOOP_HALF_M * cos(pi * t) * (1.0 + 0.25 * abs(cos(pi * t))),
                z + 0.006 * sin(pi * t),
            )
            for t in _steps(18)
        ]
        flare = [0.0075 + 0.004 * abs(cos(pi * t)) ** 6 for t in _steps(18)]
        bar = mesh.tube(f"{name}_loop", line, flare, segments=12)
        loops.append(mesh.set_material(bar, material))
    return loops


def _steps(count: int) -> list[float]:
    return [i / (count - 1) for i in range(count)]
