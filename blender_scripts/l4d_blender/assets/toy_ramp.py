"""A wooden slide for toys: a platform on posts and a sloping chute with side rails.

Owns the slide's shape and the line along which things slide over it. Knows nothing of what slides. The chute
runs down towards -Y and ends at y = `FOOT_Y_M` on z = 0; the platform is at +Y.
"""

from __future__ import annotations

import random
from math import atan2, hypot

import bpy
from mathutils import Matrix

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.colour import Colour

HEIGHT_M = 0.095
EDGE_Y_M = 0.055
BACK_Y_M = 0.185
FOOT_Y_M = -0.125
WIDTH_M = 0.082
BOARD_M = 0.007
SLOPE_RAD = atan2(HEIGHT_M, EDGE_Y_M - FOOT_Y_M)


@kind("ramp", (0.121, 0.31, 0.122), "surface")
def toy_ramp(
    name: str, rng: random.Random, *, paint: Colour = (0.05, 0.22, 0.2), trim: Colour = (0.7, 0.42, 0.05)
) -> bpy.types.Object:
    """A slide 31 cm long and about 10 cm tall."""
    board = products.wood(f"{name}_board", (0.60, 0.42, 0.24), (0.40, 0.25, 0.12), rng, grain_axis="Y")
    green = products.lacquer(f"{name}_paint", paint, rng)
    yellow = products.lacquer(f"{name}_trim", trim, rng)

    deck = mesh.bevel_box(f"{name}_deck", (WIDTH_M, BACK_Y_M - EDGE_Y_M, BOARD_M), 0.0012)
    parts = Parts(name)
    parts.add(deck, board, y=0.5 * (BACK_Y_M + EDGE_Y_M), z=HEIGHT_M - BOARD_M)
    parts.add(_chute(f"{name}_chute"), board)
    for side in (-1.0, 1.0):
        x = side * (0.5 * WIDTH_M + 0.003)
        parts.add(_rail(f"{name}_rail"), green, x=x)
        for y in (BACK_Y_M - 0.014, EDGE_Y_M + 0.012):
            post = mesh.bevel_box(f"{name}_post", (0.014, 0.014, HEIGHT_M + 0.012), 0.003)
            parts.add(post, yellow, x=side * (0.5 * WIDTH_M + 0.011), y=y)
            knob = mesh.ellipsoid(f"{name}_knob", (0.0085, 0.0085, 0.0085), 16, 10)
            parts.add(knob, green, x=side * (0.5 * WIDTH_M + 0.011), y=y, z=HEIGHT_M + 0.018)
    for y in (BACK_Y_M - 0.014, EDGE_Y_M + 0.012):
        parts.box("brace", green, (WIDTH_M + 0.014, 0.010, 0.014), 0.002, y=y, z=0.030)
    return parts.join()


def _chute(name: str) -> bpy.types.Object:
    """The sloping board, whose top runs from the deck's edge to the ground."""
    across = 0.5 * WIDTH_M
    under = BOARD_M / HEIGHT_M * (EDGE_Y_M - FOOT_Y_M)
    section = (
        (EDGE_Y_M, HEIGHT_M),
        (EDGE_Y_M, HEIGHT_M - BOARD_M),
        (FOOT_Y_M + under, 0.0),
        (FOOT_Y_M, 0.0005),
    )
    chute = mesh.loft(name, [[(x, y, z) for y, z in section] for x in (-across, across)])
    return mesh.shade_smooth(chute, 20.0)


def _rail(name: str) -> bpy.types.Object:
    """A low cheek along the chute, in the axes of the slide."""
    length = hypot(HEIGHT_M, EDGE_Y_M - FOOT_Y_M)
    rail = mesh.bevel_box(name, (0.005, length - 0.022, 0.017), 0.0018)
    mesh.transform(
        rail,
        Matrix.Translation((0.0, EDGE_Y_M, HEIGHT_M - 0.006))
        @ Matrix.Rotation(SLOPE_RAD, 4, "X")
        @ Matrix.Translation((0.0, -0.5 * (length - 0.022), 0.0)),
    )
    return rail
