"""An office: carpet tiles, painted walls, felt panels, a window with a half-open venetian blind.

Owns what is fixed to the building, and lets sunlight in only between the slats: the walls on the sun's side
go up far beyond what cameras see. Knows nothing of furniture. Back wall at +Y, window in the wall at -X,
floor at z = 0.
"""

from __future__ import annotations

import random
from math import radians

import bpy
from mathutils import Matrix

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.assets.materials.base import Nodes, principled
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.colour import Colour

WALL_HEIGHT_M = 2.7
SILL_M, LINTEL_M = 0.92, 2.25
_TALL_M = 6.0


@kind("room", (6.88, 5.45, 6.02), "backdrop")
def office_room(
    name: str,
    rng: random.Random,
    *,
    half_width_m: float = 3.3,
    back_m: float = 1.95,
    front_m: float = -3.4,
    window_y_m: tuple[float, float] = (-0.95, 1.05),
    wall: Colour = (0.56, 0.58, 0.57),
    accent: Colour = (0.1, 0.24, 0.26),
    carpet: Colour = (0.115, 0.125, 0.14),
    side: int = -1,
) -> list[bpy.types.Object]:
    """[floor, walls, panels, blind]; `side` +1 puts the window into the wall at +X instead."""
    paint = products.plaster(f"{name}_paint", wall, rng)
    white = products.lacquer(f"{name}_white", (0.72, 0.72, 0.70), rng)
    length, middle = back_m - front_m, 0.5 * (back_m + front_m)
    floor = mesh.move(mesh.box(f"{name}_floor", (2 * half_width_m, length, 0.02)), y=middle, z=-0.02)
    mesh.set_material(floor, carpet_tiles(f"{name}_carpet", carpet, rng))

    x, (near, far) = side * half_width_m, window_y_m
    walls = [
        _wall(f"{name}_back", (2 * half_width_m + 0.2, 0.1, _TALL_M), (0.0, back_m + 0.05, 0.0)),
        _wall(f"{name}_blank", (0.1, length, WALL_HEIGHT_M), (-x - 0.05 * side, middle, 0.0)),
        _wall(f"{name}_under", (0.1, far - near, SILL_M), (x + 0.05 * side, 0.5 * (near + far), 0.0)),
        _wall(
            f"{name}_over",
            (0.1, far - near, _TALL_M - LINTEL_M),
            (x + 0.05 * side, 0.5 * (near + far), LINTEL_M),
        ),
        _wall(f"{name}_left", (0.1, near - front_m, _TALL_M), (x + 0.05 * side, 0.5 * (near + front_m), 0.0)),
        _wall(f"{name}_right", (0.1, back_m - far, _TALL_M), (x + 0.05 * side, 0.5 * (back_m + far), 0.0)),
    ]
    shell = mesh.set_material(mesh.join(f"{name}_walls", walls), paint)
    trim = []
    for size, at in (
        ((2 * half_width_m, 0.016, 0.08), (0.0, back_m - 0.008, 0.0)),
        ((0.016, length, 0.08), (-half_width_m + 0.008, middle, 0.0)),
        ((0.016, length, 0.08), (half_width_m - 0.008, middle, 0.0)),
    ):
        trim.append(mesh.move(mesh.bevel_box(f"{name}_skirting", size, 0.003), *at))
    trim += _window_frame(name, x, near, far, side)
    woodwork = mesh.set_material(mesh.join(f"{name}_trim", trim), white)
    return [
        floor,
        shell,
        woodwork,
        _felt_panels(f"{name}_panels", rng, half_width_m, back_m, accent),
        _blind(f"{name}_blind", rng, x - 0.055 * side, near, far, side),
    ]


def carpet_tiles(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """Half-metre tiles of looped pile, laid with the nap turned from tile to tile."""
    material = bpy.data.materials.new(name)
    n = Nodes(material)
    at = n.vector_math("ADD", n.object_coords(), (rng.uniform(-9, 9), rng.uniform(-9, 9), 0.0))
    tiles = n.node("ShaderNodeTexChecker")
    n.feed(tiles.inputs["Vector"], n.object_coords())
    n.feed(tiles.inputs["Scale"], 2.0)
    loops = n.noise(190.0, 3.0, vector=at)
    clouds = n.noise(7.0, 4.0, vector=at)
    fleck = n.math("LESS_THAN", n.voronoi(60.0, vector=at), 0.16)
    tone = n.mix(tiles.outputs["Fac"], products.scaled(colour, 0.86), products.scaled(colour, 1.16))
    tone = n.mix(n.map_range(clouds, 0.35, 0.7), tone, products.scaled(colour, 0.72))
    tone = n.mix(n.math("MULTIPLY", fleck, 0.5), tone, products.scaled(colour, 2.3))
    n.set("Base Color", n.mix(n.map_range(loops, 0.35, 0.65, 0.0, 0.55), tone, products.scaled(colour, 0.45)))
    n.set("Roughness", 0.97)
    n.set("Specular IOR Level", 0.1)
    n.bump(loops, 0.9, 0.004)
    return material


def _wall(name: str, size: tuple[float, float, float], at: tuple[float, float, float]) -> bpy.types.Object:
    return mesh.move(mesh.box(name, size), *at)


def _window_frame(name: str, x: float, near: float, far: float, side: int) -> list[bpy.types.Object]:
    """Stiles, rails and a sill board round the opening."""
    middle, tall, wide = 0.5 * (near + far), LINTEL_M - SILL_M, far - near
    bars = Parts(name)
    bars.add(mesh.bevel_box(f"{name}_sill", (0.30, wide + 0.12, 0.03), 0.006), x=x, y=middle, z=SILL_M - 0.02)
    for y in (near + 0.02, middle, far - 0.02):
        bars.add(
            mesh.bevel_box(f"{name}_stile", (0.05, 0.045, tall), 0.004), x=x + 0.06 * side, y=y, z=SILL_M
        )
    for z in (SILL_M, LINTEL_M - 0.045):
        bars.add(mesh.bevel_box(f"{name}_rail", (0.05, wide, 0.045), 0.004), x=x + 0.06 * side, y=middle, z=z)
    return bars


def _blind(name: str, rng: random.Random, x: float, near: float, far: float, side: int) -> bpy.types.Object:
    """Aluminium slats, all tilted alike, on a head rail; the lowest stop a hand above the sill."""
    slat = principled(f"{name}_slats", (0.66, 0.66, 0.63), roughness=0.45, variation=0.06)
    parts = Parts(name)
    parts.add(
        mesh.bevel_box("head", (0.05, far - near - 0.02, 0.045), 0.004),
        x=x,
        y=0.5 * (near + far),
        z=LINTEL_M - 0.05,
    )
    z = LINTEL_M - 0.09
    while z > SILL_M + 0.10:
        leaf = mesh.box(f"{name}_slat", (0.062, far - near - 0.04, 0.003))
        tilt = radians(-14.0 * side + rng.uniform(-1.5, 1.5))
        mesh.transform(leaf, Matrix.Translation((x, 0.5 * (near + far), z)) @ Matrix.Rotation(tilt, 4, "Y"))
        parts.add(leaf)
        z -= 0.068
    for y in (near + 0.18, far - 0.18):
        parts.add(mesh.box("cord", (0.004, 0.004, LINTEL_M - SILL_M - 0.16)), x=x, y=y, z=SILL_M + 0.10)
    return mesh.set_material(parts.join(), slat)


def _felt_panels(
    name: str, rng: random.Random, half_width: float, back: float, accent: Colour
) -> bpy.types.Object:
    """Sound-absorbing felt on the back wall in upright strips of three tones."""
    felts = []
    for k, factor in enumerate((0.75, 1.0, 1.45)):
        felts.append(
            products.woven_cloth(f"{name}_felt{k}", products.scaled(accent, factor), rng, threads_per_m=180)
        )
    parts, x = Parts(name), -half_width + 0.10
    while x < half_width - 0.3:
        wide = rng.choice((0.28, 0.40, 0.52))
        strip = mesh.bevel_box(f"{name}_strip", (wide - 0.012, 0.035, 1.15), 0.008)
        parts.add(strip, rng.choice(felts), x=x + 0.5 * wide, y=back - 0.018, z=1.05)
        x += wide
    return parts.join()
