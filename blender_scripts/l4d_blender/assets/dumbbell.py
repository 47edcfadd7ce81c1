"""Dumbbells: rubber hexagons or round plates on a chromed, knurled bar along Y."""

from __future__ import annotations

import random
from dataclasses import dataclass
from math import cos, pi, sin

import bpy

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import gym
from l4d_blender.scene.catalogue import COLOURS, Choice, kind
from l4d_blender.scene.colour import Colour


@dataclass(frozen=True)
class DumbbellLook:
    """Kind of heads ("hex" or "round"), their colour and size."""

    heads: str
    colour: Colour
    ring: Colour
    radius_m: float
    head_m: float
    bar_m: float = 0.145

    @property
    def bar_height_m(self) -> float:
        """Height of the bar's axis when the dumbbell lies on a floor."""
        return self.radius_m * (cos(pi / 6) if self.heads == "hex" else 1.0)

    @property
    def grip(self) -> tuple[float, float, float]:
        """The middle of the bar."""
        return 0.0, 0.0, self.bar_height_m


def hexagonal(colour: Colour, ring: Colour) -> DumbbellLook:
    """A 17 kg rubber hexagon dumbbell."""
    return DumbbellLook("hex", colour, ring, radius_m=0.088, head_m=0.105)


def round_plates(colour: Colour, ring: Colour) -> DumbbellLook:
    """A big dumbbell with painted round plates."""
    return DumbbellLook("round", colour, ring, radius_m=0.100, head_m=0.120)


BLUE_HEX = hexagonal((0.032, 0.033, 0.036), (0.03, 0.12, 0.42))


@kind(
    "dumbbell",
    (0.172, 0.357, 0.152),
    "graspable",
    shape=Choice(
        "look",
        {
            "hex": hexagonal(COLOURS["black"], COLOURS["blue"]),
            "round": round_plates(COLOURS["black"], COLOURS["red"]),
        },
    ),
)
def dumbbell(name: str, rng: random.Random, *, look: DumbbellLook = BLUE_HEX) -> bpy.types.Object:
    """The dumbbell; origin on the floor under the middle of its bar."""
    coat = gym.cast(f"{name}_coat", look.colour, rng)
    ring = gym.cast(f"{name}_ring", look.ring, rng)
    steel = gym.knurled_steel(f"{name}_bar", rng)
    half = look.bar_m / 2
    grip = [0.0135, 0.0145, 0.0165, 0.0175, 0.0165, 0.0145, 0.0135]
    bar = mesh.tube(
        f"{name}_bar", [(0, half * (k / 3 - 1) * 1.04, 0) for k in range(7)], grip, segments=20, up=(0, 0, 1)
    )
    parts = [mesh.set_material(bar, steel)]
    for side in (-1, 1):
        parts += [mesh.move(part, y=side * half) for part in _head(name, look, side, coat, ring)]
    return mesh.move(mesh.join(name, parts), z=look.bar_height_m)


def _head(
    name: str, look: DumbbellLook, side: int, coat: bpy.types.Material, ring: bpy.types.Material
) -> list[bpy.types.Object]:
    r, depth = look.radius_m, look.head_m
    if look.heads == "hex":
        # Inset at both ends; flat sides down.
        profile = [
            (0.58, 0.0),
            (0.80, 0.006),
            (0.97, 0.026),
            (1.0, 0.036),
            (1.0, depth - 0.020),
            (0.94, depth - 0.006),
            (0.74, depth),
            (0.66, depth - 0.004),
        ]
        sections = [
            [(f * r * sin(pi * k / 3), side * y, f * r * cos(pi * k / 3)) for k in range(6)]
            for f, y in profile
        ]
        for section in sections:
            section[:] = [
                (x * cos(pi / 6) - z * sin(pi / 6), y, x * sin(pi / 6) + z * cos(pi / 6))
                for x, y, z in section
            ]
        body = mesh.bevel(mesh.loft(f"{name}_head", sections), 0.006, 2, 40)
        mesh.shade_smooth(body, 32)
        disc = mesh.move(
            mesh.rotate(mesh.cylinder(f"{name}_disc", 0.60 * r, 0.004, 40, 0.001), "X", -90.0),
            y=depth - 0.003,
        )
        if side < 0:
            mesh.rotate(disc, "Z", 180)
        return [mesh.set_material(body, coat), mesh.set_material(disc, ring)]
    plates = []
    for k, (size, thick, start, material) in enumerate(
        (
            (0.34, 0.012, 0.0, ring),
            (1.0, 0.050, 0.010, coat),
            (0.86, 0.030, 0.060, coat),
            (0.34, 0.030, 0.090, ring),
        )
    ):
        plate = mesh.rotate(mesh.cylinder(f"{name}_plate_{k}", size * r, thick, 56, 0.007), "X", -90.0)
        mesh.move(plate, y=start)
        if k in (1, 2):
            lip = mesh.move(
                mesh.rotate(mesh.torus(f"{name}_lip", 0.80 * size * r, 0.006, 48, 10), "X", 90.0),
                y=start + thick,
            )
            plates.append(mesh.set_material(mesh.rotate(lip, "Z", 180) if side < 0 else lip, ring))
        plates.append(mesh.set_material(mesh.rotate(plate, "Z", 180) if side < 0 else plate, material))
    return plates
