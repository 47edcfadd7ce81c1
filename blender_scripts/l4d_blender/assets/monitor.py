"""A flat monitor on a stand, showing a text editor and a chart.

Owns the monitor and what is on its screen (opaque, self-lit). The screen faces -Y; the foot stands on z = 0.
"""

from __future__ import annotations

import random

import bpy
from mathutils import Matrix, Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.colour import Colour

BEZEL_M = 0.010
BOTTOM_M = 0.095
TILT_RAD = -0.10

PAPER: Colour = (0.030, 0.038, 0.055)
PANEL: Colour = (0.055, 0.066, 0.090)
INKS: tuple[Colour, ...] = (
    (0.55, 0.60, 0.66),
    (0.10, 0.34, 0.62),
    (0.52, 0.30, 0.08),
    (0.16, 0.46, 0.24),
    (0.50, 0.12, 0.18),
)


@kind("monitor", (0.48, 0.17, 0.374), front="-y")
def monitor(name: str, rng: random.Random, *, size_m: tuple[float, float] = (0.48, 0.28)) -> bpy.types.Object:
    """A monitor of (width, height) with its lower edge at `BOTTOM_M`."""
    width, height = size_m
    shell = products.satin_plastic(f"{name}_shell", (0.035, 0.036, 0.040), rng, roughness=0.5)
    steel = products.metal(f"{name}_stand", (0.45, 0.46, 0.48), rng, roughness=0.38)

    housing = mesh.bevel_box(f"{name}_housing", (width, 0.022, height), 0.004)
    back = mesh.bevel_box(f"{name}_back", (0.62 * width, 0.03, 0.62 * height), 0.012)
    mesh.move(back, y=0.016, z=0.19 * height)
    screen = _screen(f"{name}_screen", width - 2 * BEZEL_M, height - 2 * BEZEL_M - 0.006, rng)
    mesh.move(screen, y=-0.0114, z=BEZEL_M + 0.006)
    head = [mesh.set_material(housing, shell), mesh.set_material(back, shell), screen]
    tilt = Matrix.Translation((0.0, 0.0, BOTTOM_M)) @ Matrix.Rotation(TILT_RAD, 4, "X")
    for part in head:
        mesh.transform(part, tilt)

    foot = mesh.bevel_box(f"{name}_foot", (0.20, 0.17, 0.010), 0.004)
    mesh.move(foot, y=0.030)
    post = mesh.bevel_box(f"{name}_post", (0.045, 0.016, BOTTOM_M + 0.10), 0.005)
    mesh.move(post, y=0.052, z=0.004)
    stand = [mesh.set_material(foot, steel), mesh.set_material(post, steel)]
    return mesh.join(name, [*head, *stand])


def _screen(name: str, width: float, height: float, rng: random.Random) -> bpy.types.Object:
    """The picture as flat coloured panes, each layer 0.1 mm before the one behind it."""
    panes: list[tuple[float, float, float, float, int, int]] = [
        (0.0, 0.0, 1.0, 1.0, 0, 0),
        (0.0, 0.0, 0.17, 1.0, 1, 1),
    ]
    panes += [(0.025, 0.90 - 0.07 * k, rng.uniform(0.05, 0.12), 0.022, 2, 2) for k in range(9)]
    y = 0.93
    while y > 0.08:
        x = 0.20 + 0.03 * rng.choice((0, 1, 1, 2, 3))
        while x < 0.36 + 0.22 * rng.random():
            word = rng.uniform(0.02, 0.08)
            panes.append((x, y, word, 0.020, 2, 2 + rng.choice((0, 0, 0, 1, 2, 3, 4))))
            x += word + 0.012
        y -= 0.042
    panes.append((0.66, 0.12, 0.31, 0.78, 1, 1))
    bars = [rng.uniform(0.12, 0.5) for _ in range(7)]
    panes += [(0.69 + 0.038 * k, 0.18, 0.026, bar, 2, 3 + k % 4) for k, bar in enumerate(bars)]

    verts: list[Vector] = []
    faces: list[list[int]] = []
    tones: list[int] = []
    for x, z, w, h, layer, tone in panes:
        first = len(verts)
        depth = -0.0001 * layer
        corners = ((x, z), (x + w, z), (x + w, z + h), (x, z + h))
        verts.extend(Vector(((cx - 0.5) * width, depth, cz * height)) for cx, cz in corners)
        faces.append([first, first + 1, first + 2, first + 3])
        tones.append(tone)
    screen = mesh.from_pydata(name, verts, faces, smooth=False)
    for k, colour in enumerate((PAPER, PANEL, *INKS)):
        screen.data.materials.append(products.glow(f"{name}_{k}", colour, 1.6))
    screen.data.polygons.foreach_set("material_index", tones)
    return screen
