"""A compact mechanical keyboard: aluminium case, single keys, printed legends.

Owns the keyboard; knows nothing of typing. The typist sits at -Y; it stands on z = 0, long side along X.
"""

from __future__ import annotations

import random

import bpy
from mathutils import Matrix, Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.lettering import lettering
from l4d_blender.assets.materials import products
from l4d_blender.scene.catalogue import kind
from l4d_blender.scene.colour import Colour

UNIT_M = 0.0178
GAP_M = 0.0022
ROW_WIDTHS = (
    (1.25, 1.25, 1.25, 6.25, 1.25, 1.25, 1.25, 1.25),
    (2.25, *[1.0] * 10, 2.75),
    (1.75, *[1.0] * 11, 2.25),
    (1.5, *[1.0] * 12, 1.5),
    (*[1.0] * 13, 2.0),
)
COLUMNS = 15
MARGIN_M = 0.007
CASE_HEIGHT_M = 0.016
KEY_RISE_M = 0.0085
TILT_RAD = 0.055

WIDTH_M = COLUMNS * UNIT_M + 2 * MARGIN_M
DEPTH_M = len(ROW_WIDTHS) * UNIT_M + 2 * MARGIN_M

LEGENDS = (
    ("ctrl", "opt", "cmd", "", "cmd", "fn", "<", ">"),
    ("shift", *"ZXCVBNM,.", "/", "shift"),
    ("caps", *"ASDFGHJKL;'", "enter"),
    ("tab", *"QWERTYUIOP[]", "del"),
    ("esc", *"1234567890-=", "back"),
)


@kind("keyboard", (0.281, 0.103, 0.028), "pushable", front="-y")
def keyboard(
    name: str,
    rng: random.Random,
    *,
    caps: Colour = (0.62, 0.59, 0.52),
    modifiers: Colour = (0.17, 0.24, 0.27),
    accent: Colour = (0.62, 0.16, 0.04),
    case: Colour = (0.34, 0.35, 0.37),
) -> bpy.types.Object:
    """A 65-key board, about 28 cm wide; Escape and Enter carry the accent colour."""
    body = mesh.bevel_box(f"{name}_case", (WIDTH_M, DEPTH_M, CASE_HEIGHT_M), 0.0035)
    mesh.set_material(body, products.metal(f"{name}_aluminium", case, rng, roughness=0.42))

    light_print = products.satin_plastic(f"{name}_light_print", (0.66, 0.64, 0.58), rng)
    dark_print = products.satin_plastic(f"{name}_dark_print", (0.05, 0.06, 0.07), rng)
    verts: list[Vector] = []
    faces: list[list[int]] = []
    kinds: list[int] = []
    legends: list[bpy.types.Object] = []
    for row, widths in enumerate(ROW_WIDTHS):
        x = -0.5 * COLUMNS * UNIT_M
        y = -0.5 * len(ROW_WIDTHS) * UNIT_M + (row + 0.5) * UNIT_M
        for column, width in enumerate(widths):
            centre = Vector((x + 0.5 * width * UNIT_M, y, CASE_HEIGHT_M - 0.001))
            is_accent = (row, column) in ((4, 0), (2, len(widths) - 1))
            kind = 1 if is_accent else 2 if width > 1.0 and width < 6.0 else 0
            top = _add_key(verts, faces, kinds, centre, width * UNIT_M - GAP_M, UNIT_M - GAP_M, kind)
            legend = LEGENDS[row][column]
            if legend:
                letters = lettering(
                    f"{name}_legend", legend, 0.0046 if len(legend) == 1 else 0.0027, bold_m=0.0001
                )
                mesh.move(letters, top.x, top.y, top.z + 0.0001)
                legends.append(mesh.set_material(letters, dark_print if kind == 0 else light_print))
            x += width * UNIT_M
    keys = mesh.from_pydata(f"{name}_keys", verts, faces, smooth=False)
    for material in (
        products.satin_plastic(f"{name}_caps", caps, rng, roughness=0.55),
        products.satin_plastic(f"{name}_accent", accent, rng, roughness=0.55),
        products.satin_plastic(f"{name}_modifiers", modifiers, rng, roughness=0.55),
    ):
        keys.data.materials.append(material)
    keys.data.polygons.foreach_set("material_index", kinds)

    board = mesh.join(name, [body, keys, *legends])
    mesh.transform(board, Matrix.Rotation(TILT_RAD, 4, "X"))
    mesh.drop_to_base(board)
    return board


def _add_key(
    verts: list[Vector],
    faces: list[list[int]],
    kinds: list[int],
    centre: Vector,
    width: float,
    depth: float,
    kind: int,
) -> Vector:
    """One cap with sloped sides and chamfered corners; returns the middle of its top."""
    rings = ((0.0, 0.0, 0.0010), (0.0009, 0.78 * KEY_RISE_M, 0.0012), (0.0021, KEY_RISE_M, 0.0016))
    first = len(verts)
    for inset, rise, chamfer in rings:
        hx, hy = 0.5 * width - inset, 0.5 * depth - inset
        corner = [
            (hx, hy - chamfer),
            (hx - chamfer, hy),
            (-hx + chamfer, hy),
            (-hx, hy - chamfer),
            (-hx, -hy + chamfer),
            (-hx + chamfer, -hy),
            (hx - chamfer, -hy),
            (hx, -hy + chamfer),
        ]
        verts.extend(centre + Vector((x, y, rise)) for x, y in corner)
    for ring in range(2):
        low, high = first + 8 * ring, first + 8 * (ring + 1)
        faces.extend([low + k, low + (k + 1) % 8, high + (k + 1) % 8, high + k] for k in range(8))
    faces.append([first + 16 + k for k in range(8)])
    kinds.extend([kind] * 17)
    return centre + Vector((0.0, 0.0, KEY_RISE_M))
