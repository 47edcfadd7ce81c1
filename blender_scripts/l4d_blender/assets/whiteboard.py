"""A mobile whiteboard on a stand with castors, half written on, with a tray for markers.

Owns the board, what is on it already, and ink that appears while somebody writes. Knows nothing of hands.
The board looks to -Y; the castors stand on z = 0.
"""

from __future__ import annotations

import random
from math import sin

import bpy
from mathutils import Matrix, Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.lettering import lettering
from l4d_blender.assets.materials import products
from l4d_blender.assets.materials.base import principled
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import colours, kind
from l4d_blender.scene.colour import Colour

WIDTH_M, HEIGHT_M, BOTTOM_M = 1.50, 0.95, 0.90
SURFACE_Y_M = -0.016
TRAY_Z_M = BOTTOM_M - 0.012
TRAY_Y_M = -0.060
INK_M = 0.0062
BLUE: Colour = (0.02, 0.05, 0.30)


@kind("whiteboard", (1.53, 0.56, 1.86), front="-y")
def whiteboard(name: str, rng: random.Random) -> list[bpy.types.Object]:
    """[board, stand]: enamel in an aluminium frame on two legs."""
    steel = products.metal(f"{name}_frame", (0.55, 0.56, 0.57), rng, roughness=0.35)
    enamel = principled(
        f"{name}_enamel", (0.82, 0.83, 0.82), roughness=0.22, variation=0.05, variation_scale=3.0
    )
    parts = Parts(name)
    parts.box("sheet", enamel, (WIDTH_M, 0.03, HEIGHT_M), 0.002, z=BOTTOM_M)
    for size, x, z in (
        ((WIDTH_M + 0.03, 0.040, 0.025), 0.0, BOTTOM_M - 0.012),
        ((WIDTH_M + 0.03, 0.040, 0.025), 0.0, BOTTOM_M + HEIGHT_M - 0.012),
        ((0.025, 0.040, HEIGHT_M), -0.5 * WIDTH_M, BOTTOM_M),
        ((0.025, 0.040, HEIGHT_M), 0.5 * WIDTH_M, BOTTOM_M),
    ):
        parts.box("rail", steel, size, 0.004, x=x, z=z)
    parts.box("tray", steel, (0.90, 0.075, 0.010), 0.003, y=-0.050, z=TRAY_Z_M - 0.010)
    parts += _notes(name, rng)
    board = parts.join()

    legs = []
    for x in (-0.55, 0.55):
        post = mesh.move(mesh.bevel_box(f"{name}_post", (0.035, 0.035, 1.55), 0.005), x=x, y=0.035, z=0.09)
        foot = mesh.move(mesh.bevel_box(f"{name}_foot", (0.045, 0.56, 0.035), 0.008), x=x, z=0.062)
        legs += [post, foot]
        for y in (-0.24, 0.24):
            castor = mesh.cylinder(f"{name}_castor", 0.031, 0.026, 20, bevel_m=0.004)
            mesh.move(mesh.rotate(castor, "Y", 90.0), x=x - 0.013, y=y, z=0.031)
            legs.append(castor)
    beam = mesh.move(mesh.bevel_box(f"{name}_beam", (1.10, 0.03, 0.03), 0.005), y=0.035, z=0.30)
    stand = mesh.join(f"{name}_stand", [*legs, beam])
    mesh.set_material(stand, products.lacquer(f"{name}_lacquer", (0.10, 0.105, 0.11), rng))
    return [board, stand]


@kind("marker", (0.019, 0.019, 0.135), "graspable", "writes", colour=colours("barrel"))
def marker(name: str, rng: random.Random, *, barrel: Colour = BLUE) -> bpy.types.Object:
    """A felt pen 13.5 cm long that stands on its tip along +Z."""
    body = mesh.lathe(
        f"{name}_body",
        [
            (0.0, 0.0),
            (0.0018, 0.0006),
            (0.0030, 0.004),
            (0.0032, 0.010),
            (0.0075, 0.014),
            (0.0092, 0.022),
            (0.0094, 0.128),
            (0.0080, 0.1345),
            (0.0, 0.135),
        ],
        20,
    )
    white = products.satin_plastic(f"{name}_barrel", (0.70, 0.70, 0.68), rng)
    ink = products.satin_plastic(f"{name}_ends", barrel, rng)
    return mesh.paint(body, [white, ink], lambda centre, _: int(centre.z < 0.022 or centre.z > 0.10))


def ink(name: str, points: list[Vector], colour: Colour = BLUE) -> list[bpy.types.Object]:
    """A line on the board in board space, one short piece between every two points."""
    felt = principled(f"{name}_ink", colour, roughness=0.5)
    pieces = Parts(name)
    for k, (a, b) in enumerate(zip(points, points[1:])):
        pieces.add(_stroke(f"{name}_{k}", [a, b]), felt)
    return pieces


def _stroke(name: str, points: list[Vector], width_m: float = INK_M) -> bpy.types.Object:
    """A flat ribbon along points in the plane of the board, with blunt ends."""
    verts: list[Vector] = []
    faces: list[tuple[int, ...]] = []
    for a, b in zip(points, points[1:]):
        along = (b - a).normalized() if (b - a).length > 1e-6 else Vector((1.0, 0.0, 0.0))
        side = 0.5 * width_m * Vector((-along.z, 0.0, along.x))
        a, b = a - 0.25 * width_m * along, b + 0.25 * width_m * along
        first = len(verts)
        verts += [a - side, b - side, b + side, a + side]
        faces.append((first, first + 1, first + 2, first + 3))
    ribbon = mesh.from_pydata(name, verts, faces, smooth=False)
    if ribbon.data.polygons[0].normal.y > 0.0:
        ribbon.data.flip_normals()
    return ribbon


def _notes(name: str, rng: random.Random) -> list[bpy.types.Object]:
    """A plan that somebody drew: a heading, boxes with arrows, a falling and a rising curve, stickers."""
    y = SURFACE_Y_M
    inks = {
        "black": principled(f"{name}_black", (0.02, 0.02, 0.025), roughness=0.5),
        "red": principled(f"{name}_red", (0.50, 0.03, 0.03), roughness=0.5),
        "green": principled(f"{name}_green", (0.02, 0.24, 0.08), roughness=0.5),
    }
    parts = Parts(name)

    def draw(points: list[tuple[float, float]], ink_name: str, width_m: float = INK_M) -> None:
        parts.add(_stroke(f"{name}_drawn", [Vector((x, y, z)) for x, z in points], width_m), inks[ink_name])

    heading = lettering(f"{name}_heading", "Plan", 0.075, bold_m=0.001)
    mesh.move(mesh.rotate(heading, "X", 90.0), x=-0.50, y=y - 0.0004, z=1.74)
    parts.add(heading, inks["black"])
    draw([(-0.62, 1.685), (-0.36, 1.690)], "red")
    corners = [(-0.64, 1.36), (-0.38, 1.37), (-0.385, 1.52), (-0.635, 1.515), (-0.64, 1.36)]
    draw(corners, "black")
    draw([(x + 0.40, z - 0.01) for x, z in corners], "black")
    draw([(x + 0.20, z - 0.30) for x, z in corners], "green")
    draw([(-0.37, 1.44), (-0.26, 1.44), (-0.285, 1.455)], "red")
    draw([(-0.12, 1.35), (-0.22, 1.23), (-0.195, 1.24)], "red")
    for x, z in ((-0.60, 1.455), (-0.20, 1.445), (-0.40, 1.145)):
        for row in range(2):
            way = [
                (x + 0.012 * k, z - 0.045 * row + 0.009 * sin(2.4 * k + rng.uniform(0, 0.6)))
                for k in range(15)
            ]
            draw(way, "black", 0.004)
    draw([(-0.02, 1.00), (0.30, 1.00)], "black")
    draw([(0.0, 0.98), (0.0, 1.20)], "black")
    draw([(0.012 + 0.02 * k, 1.02 + 0.00065 * k * k + 0.006 * sin(2 * k)) for k in range(14)], "red")
    for k, (x, z) in enumerate(((0.60, 1.06), (0.51, 1.01), (0.62, 0.965))):
        note = mesh.box(f"{name}_note", (0.085, 0.001, 0.085))
        mesh.transform(note, Matrix.Rotation(rng.uniform(-0.15, 0.15), 4, "Y"))
        colour = ((0.80, 0.60, 0.10), (0.75, 0.30, 0.36), (0.35, 0.60, 0.28))[k]
        paper = products.paper(f"{name}_paper{k}", colour, rng)
        parts.add(note, paper, x=x, y=y - 0.001, z=z)
    return parts
