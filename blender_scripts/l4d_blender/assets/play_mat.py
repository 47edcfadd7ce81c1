"""A play mat of foam tiles that lock into one another like a puzzle, in several colours."""

from __future__ import annotations

import random
from collections.abc import Sequence
from math import cos, pi, sin

import bpy

from l4d_blender.scene.catalogue import kind

from ..scene.colour import Colour
from . import mesh
from .materials.base import Nodes
from .materials.products import scaled
from .parts import Parts

THICKNESS_M = 0.014
COLOURS: tuple[Colour, ...] = ((0.15, 0.33, 0.40), (0.62, 0.42, 0.12), (0.42, 0.14, 0.10), (0.24, 0.36, 0.14))


@kind("mat", (1.68, 1.26, 0.015), "surface")
def play_mat(
    name: str,
    rng: random.Random,
    *,
    tiles: tuple[int, int] = (4, 3),
    tile_m: float = 0.42,
    colours: Sequence[Colour] = COLOURS,
) -> bpy.types.Object:
    """The mat round the origin, its top at THICKNESS_M."""
    foams = [_foam(f"{name}_foam_{k}", colour) for k, colour in enumerate(colours)]
    parts = Parts(name)
    nx, ny = tiles
    for i in range(nx):
        for j in range(ny):
            x, y = tile_m * (i - (nx - 1) / 2), tile_m * (j - (ny - 1) / 2)
            foam = foams[(i + 2 * j + (i * j) % 2) % len(foams)]
            parts.box("tile", foam, (tile_m - 0.003, tile_m - 0.003, THICKNESS_M), 0.003, 2, x=x, y=y)
            for along_x in (True, False):
                if (i if along_x else j) + 1 < (nx if along_x else ny):
                    for k in (-1, 0, 1):
                        side, off = tile_m / 2 + 0.012, 0.30 * tile_m * k
                        knob = _knob(f"{name}_knob", 0.034 + rng.uniform(-0.001, 0.001))
                        at = (x + side, y + off) if along_x else (x + off, y + side)
                        parts.add(mesh.move(knob, *at), foam)
    return parts.join()


def _knob(name: str, radius: float) -> bpy.types.Object:
    """What reaches into the neighbour, a hair proud of it."""
    top = THICKNESS_M + 0.0006
    ring = [(radius * cos(2 * pi * k / 20), radius * sin(2 * pi * k / 20)) for k in range(20)]
    verts = [(x, y, z) for z in (0.004, top) for x, y in ring]
    faces = [tuple(range(20, 40))] + [(k, (k + 1) % 20, 20 + (k + 1) % 20, 20 + k) for k in range(20)]
    return mesh.from_pydata(name, verts, faces, smooth=False)


def _foam(name: str, colour: Colour) -> bpy.types.Material:
    """Soft foam with a printed grain, scuffed."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    scuffs = n.noise(7.0, 4.0, roughness=0.7)
    n.set(
        "Base Color",
        n.ramp(scuffs, [(0.3, scaled(colour, 0.78)), (0.55, colour), (0.8, scaled(colour, 1.25))]),
    )
    n.set("Roughness", 0.85)
    n.bump(n.voronoi(220.0), 0.4, 0.0012)
    material.diffuse_color = (*colour, 1.0)
    return material
