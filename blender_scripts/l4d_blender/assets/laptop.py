"""A notebook computer in two parts: a base with keys and a lid with a screen.

Owns the shape and where its keys, hinge and lid edge are. Knows nothing of hands. The user sits at -Y, the
base stands on z = 0; the lid turns about its own X axis, which is the hinge.
"""

from __future__ import annotations

import random
from dataclasses import dataclass

import bpy
from mathutils import Matrix, Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import Choice, kind
from l4d_blender.scene.colour import Colour

BASE_M = 0.0155
LID_M = 0.0065
HINGE_INSET_M = 0.010
KEY_PITCH_M = 0.0190
KEY_ROWS, KEY_COLUMNS = 5, 14


@dataclass(frozen=True)
class Model:
    """What one kind of laptop looks like: width and depth in metres, metal and keys."""

    size_m: tuple[float, float]
    metal: Colour
    caps: Colour
    badge: Colour


COMPACT_SILVER = Model((0.316, 0.226), (0.60, 0.61, 0.62), (0.035, 0.036, 0.040), (0.30, 0.31, 0.32))
LARGE_BLACK = Model((0.386, 0.268), (0.030, 0.031, 0.035), (0.10, 0.10, 0.11), (0.62, 0.10, 0.06))
COMPACT_COPPER = Model((0.316, 0.226), (0.62, 0.34, 0.22), (0.05, 0.045, 0.042), (0.72, 0.60, 0.48))
LARGE_WHITE = Model((0.386, 0.268), (0.74, 0.73, 0.70), (0.55, 0.55, 0.54), (0.12, 0.24, 0.46))


@dataclass(frozen=True)
class Laptop:
    """The two mesh objects of a laptop that stands at the origin, and its measures."""

    base: bpy.types.Object
    lid: bpy.types.Object
    model: Model

    @property
    def parts(self) -> list[bpy.types.Object]:
        """Base and lid."""
        return [self.base, self.lid]

    def place(self, matrix: Matrix) -> None:
        """Stands the laptop somewhere, shut."""
        self.base.matrix_basis = matrix
        self.lid.matrix_basis = self.base.matrix_basis @ self.lid_matrix(0.0)

    def lid_matrix(self, angle_rad: float) -> Matrix:
        """Where the lid is in the base's space when it is open by an angle (0: shut)."""
        return Matrix.Translation((0.0, self._hinge_y, BASE_M + 0.0006)) @ Matrix.Rotation(-angle_rad, 4, "X")

    def lid_edge(self, angle_rad: float, aside_m: float = 0.0) -> Vector:
        """The rim of the lid that fingers take hold of, in the base's space."""
        return self.lid_matrix(angle_rad) @ Vector((aside_m, -self._lid_depth, 0.5 * LID_M))

    def home_row(self, aside_m: float = 0.0, rows_up: float = 0.0) -> Vector:
        """A point on top of the middle row of keys, in the base's space."""
        y = self._keys_y + rows_up * KEY_PITCH_M
        return Vector((aside_m, y, BASE_M + 0.0016))

    @property
    def _hinge_y(self) -> float:
        return 0.5 * self.model.size_m[1] - HINGE_INSET_M

    @property
    def _lid_depth(self) -> float:
        return self.model.size_m[1] - HINGE_INSET_M - 0.001

    @property
    def _keys_y(self) -> float:
        return 0.17 * self.model.size_m[1]


@kind(
    "laptop",
    (0.316, 0.328, 0.017),
    "opens",
    "graspable",
    front="-y",
    colour=Choice(
        "model",
        {"silver": COMPACT_SILVER, "black": LARGE_BLACK, "copper": COMPACT_COPPER, "white": LARGE_WHITE},
    ),
)
def laptop(name: str, rng: random.Random, *, model: Model = COMPACT_SILVER, page: int = 0) -> Laptop:
    """A laptop whose lid hangs on nothing: key both parts. `page` chooses what its screen shows."""
    metal = products.metal(f"{name}_metal", model.metal, rng, roughness=0.40)
    base = _base(f"{name}_base", rng, model, metal)
    lid = _lid(f"{name}_lid", rng, model, metal, page)
    return Laptop(base, lid, model)


def _base(name: str, rng: random.Random, model: Model, metal: bpy.types.Material) -> bpy.types.Object:
    width, depth = model.size_m
    rubber = products.rubber(f"{name}_feet", (0.02, 0.02, 0.02), rng)
    parts = Parts(name)
    parts.box("body", metal, (width, depth, BASE_M - 0.0015), 0.004, z=0.0015)
    for x in (-0.42, 0.42):
        for y in (-0.40, 0.40):
            parts.cylinder("foot", rubber, 0.007, 0.0025, 16, x=x * width, y=y * depth)

    keys_y = 0.17 * depth
    well = mesh.box(
        f"{name}_well", (KEY_COLUMNS * KEY_PITCH_M + 0.006, KEY_ROWS * KEY_PITCH_M + 0.006, 0.0006)
    )
    dark = products.satin_plastic(f"{name}_well", (0.016, 0.016, 0.018), rng)
    parts.add(well, dark, y=keys_y, z=BASE_M - 0.0002)
    caps = products.satin_plastic(f"{name}_caps", model.caps, rng, roughness=0.5)
    parts.add(_keys(f"{name}_keys", keys_y), caps)

    pad = mesh.bevel_box(f"{name}_pad", (0.105, 0.27 * depth, 0.0008), 0.0003, segments=1)
    smooth = products.satin_plastic(f"{name}_pad", products.scaled(model.metal, 0.80), rng, roughness=0.3)
    parts.add(pad, smooth, y=-0.315 * depth, z=BASE_M - 0.0004)
    hinge = mesh.cylinder(f"{name}_hinge", 0.0052, 0.62 * width, 14)
    mesh.move(mesh.rotate(hinge, "Y", 90.0), x=-0.31 * width, y=0.5 * depth - HINGE_INSET_M + 0.004)
    parts.add(hinge, dark, z=BASE_M - 0.0050)
    return parts.join()


def _keys(name: str, middle_y: float) -> bpy.types.Object:
    """Flat caps in rows; the lowest row has a space bar."""
    verts: list[Vector] = []
    faces: list[tuple[int, ...]] = []
    for row in range(KEY_ROWS):
        y = middle_y + (row - 0.5 * (KEY_ROWS - 1)) * KEY_PITCH_M
        widths = [1.0, 1.0, 1.0, 1.25, 5.5, 1.25, 1.0, 1.0, 1.0] if row == 0 else [1.0] * KEY_COLUMNS
        x = -0.5 * sum(widths) * KEY_PITCH_M
        for units in widths:
            _cap(verts, faces, x + 0.0014, x + units * KEY_PITCH_M - 0.0014, y)
            x += units * KEY_PITCH_M
    return mesh.from_pydata(name, verts, faces, smooth=False)


def _cap(verts: list[Vector], faces: list[tuple[int, ...]], left: float, right: float, y: float) -> None:
    half = 0.5 * KEY_PITCH_M - 0.0014
    first = len(verts)
    for z, inset in ((BASE_M - 0.0004, 0.0), (BASE_M + 0.0014, 0.0007)):
        verts += [
            Vector((left + inset, y - half + inset, z)),
            Vector((right - inset, y - half + inset, z)),
            Vector((right - inset, y + half - inset, z)),
            Vector((left + inset, y + half - inset, z)),
        ]
    low, high = first, first + 4
    faces += [(low + k, low + (k + 1) % 4, high + (k + 1) % 4, high + k) for k in range(4)]
    faces.append((high, high + 1, high + 2, high + 3))


def _lid(
    name: str, rng: random.Random, model: Model, metal: bpy.types.Material, page: int
) -> bpy.types.Object:
    """The lid as it lies when shut: screen downwards, hinge at the origin, free edge at -Y."""
    width, depth = model.size_m
    long = depth - HINGE_INSET_M - 0.001
    shell = mesh.move(mesh.bevel_box(f"{name}_shell", (width, long, LID_M - 0.001), 0.0025), z=0.001)
    parts = Parts(name)
    parts.add(shell, metal, y=-0.5 * long)
    dark = products.satin_plastic(f"{name}_bezel", (0.010, 0.010, 0.012), rng, roughness=0.25)
    parts.box("bezel", dark, (width - 0.008, long - 0.010, 0.0010), y=-0.5 * long, z=0.0003)
    badge = mesh.cylinder(f"{name}_badge", 0.017, 0.0006, 28)
    mesh.transform(badge, Matrix.Diagonal((1.0, 0.72, 1.0, 1.0)))
    sheen = products.metal(f"{name}_badge", model.badge, rng, roughness=0.2)
    parts.add(badge, sheen, y=-0.5 * long, z=LID_M - 0.0001)

    half_w, half_h = 0.5 * width - 0.011, 0.5 * long - 0.013
    for part in _screen(f"{name}_screen", rng, half_w, half_h, page):
        # The picture is drawn upright in XY facing +Z; on the shut lid it faces down with its top at -Y.
        mesh.rotate(part, "X", 180.0)
        parts.add(part, y=-0.5 * long + 0.002, z=0.0001)
    return parts.join()


def _screen(name: str, rng: random.Random, half_w: float, half_h: float, page: int) -> list[bpy.types.Object]:
    """What is on the screen: a document with text, or charts; sheets that shine by themselves."""
    colours = {
        "paper": (0.80, 0.84, 0.90),
        "bar": ((0.10, 0.24, 0.50), (0.50, 0.20, 0.08), (0.08, 0.34, 0.24))[page % 3],
        "ink": (0.10, 0.11, 0.14),
        "pale": (0.52, 0.60, 0.70),
        "accent": ((0.90, 0.42, 0.08), (0.14, 0.42, 0.78), (0.75, 0.16, 0.24))[page % 3],
    }
    sheets: dict[str, list[tuple[float, float, float, float]]] = {key: [] for key in colours}
    sheets["paper"].append((-half_w, -half_h, half_w, half_h))
    sheets["bar"].append((-half_w, half_h - 0.016, half_w, half_h))
    sheets["pale"].append((-half_w, -half_h, -half_w + 0.045, half_h - 0.016))
    left, top = -half_w + 0.058, half_h - 0.030
    sheets["ink"].append((left, top - 0.007, left + 0.5 * half_w, top))
    y = top - 0.018
    while y > -half_h + 0.012:
        if page % 2 == 0 or y > 0.0:
            sheets["ink"].append(
                (left, y - 0.0026, left + rng.uniform(0.55, 1.0) * (half_w - left - 0.02), y)
            )
        y -= 0.0085
    if page % 2 == 1:
        for k in range(9):
            x = left + k * (half_w - left - 0.02) / 9
            high = -half_h + 0.012 + rng.uniform(0.02, 0.9 * half_h)
            sheets["accent"].append((x, -half_h + 0.012, x + 0.009, high))
    else:
        sheets["accent"].append((half_w - 0.055, -half_h + 0.014, half_w - 0.012, -half_h + 0.050))
    made = Parts(name)
    for layer, (key, rectangles) in enumerate(sheets.items()):
        if not rectangles:
            continue
        verts: list[tuple[float, float, float]] = []
        faces: list[tuple[int, ...]] = []
        for x0, y0, x1, y1 in rectangles:
            first, z = len(verts), 0.00012 * layer
            verts += [(x0, y0, z), (x1, y0, z), (x1, y1, z), (x0, y1, z)]
            faces.append((first, first + 1, first + 2, first + 3))
        sheet = mesh.from_pydata(f"{name}_{key}", verts, faces, smooth=False)
        made.add(sheet, products.glow(f"{name}_{key}", colours[key], 0.85))
    return made
