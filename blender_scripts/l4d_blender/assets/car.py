"""Compact hatchbacks, lofted from a cage, with wheels that steer and roll.

Owns shapes, glass, lamps and wheels. A car faces -Y on z = 0, its origin under the middle of its wheelbase.
The four wheels are objects of their own, round their hubs, so that motion can turn them. Metres.
"""

from __future__ import annotations

import random
from dataclasses import dataclass, field
from math import cos, pi, sin

import bmesh
import bpy
from mathutils import Matrix, Vector

from l4d_blender.scene.catalogue import kind, words

from ..scene.colour import Colour
from . import mesh
from .lettering import lettering
from .materials import street
from .materials.base import emission, principled
from .parts import Parts, placed

WHEEL_RADIUS_M = 0.295
WHEELBASE_M = 2.36
TRACK_M = 1.42  # between the middles of the tyres
COLOURS: dict[str, Colour] = {
    "red": (0.46, 0.016, 0.018),
    "blue": (0.020, 0.085, 0.30),
    "white": (0.66, 0.66, 0.63),
    "silver": (0.34, 0.35, 0.36),
    "green": (0.035, 0.16, 0.085),
    "yellow": (0.68, 0.40, 0.020),
    "black": (0.018, 0.018, 0.020),
    "mint": (0.24, 0.46, 0.38),
    "orange": (0.66, 0.17, 0.015),
}


@dataclass(frozen=True)
class CarLook:
    """`roof` is plain, rack (bars and a long box) or another paint's name."""

    colour: str = "red"
    roof: str = "plain"
    plate: str = "K 204"


@dataclass
class Car:
    """The body (carries the axes) and its wheels: front left, front right, rear left, rear right."""

    body: bpy.types.Object
    wheels: list[bpy.types.Object]
    hubs: list[Vector] = field(default_factory=list)

    @property
    def parts(self) -> list[bpy.types.Object]:
        """What belongs to the instance, the body first."""
        return [self.body, *self.wheels]

    def place(self, matrix: Matrix) -> None:
        """Stands the car somewhere with its wheels straight."""
        self.body.matrix_basis = matrix
        for wheel, hub in zip(self.wheels, self.hubs):
            wheel.matrix_basis = matrix @ Matrix.Translation(hub)


@dataclass(frozen=True)
class _Station:
    """A cross-section: y, then half widths and heights of sill, flank, shoulder, belt, rail and crown."""

    y: float
    sill: tuple[float, float]
    flank: tuple[float, float]
    shoulder: tuple[float, float]
    belt: tuple[float, float]
    rail: tuple[float, float]
    crown: float

    def half(self) -> list[tuple[float, float]]:
        rx, rz = self.rail
        return [
            (0.0, self.sill[1]),
            self.sill,
            self.flank,
            self.shoulder,
            self.belt,
            self.rail,
            (0.52 * rx, rz + 0.75 * (self.crown - rz)),
            (0.0, self.crown),
        ]


_LOW = (0.74, 0.19)
_STATIONS = (
    _Station(-1.74, (0.50, 0.25), (0.56, 0.36), (0.55, 0.52), (0.50, 0.60), (0.34, 0.64), 0.65),
    _Station(-1.66, (0.62, 0.20), (0.70, 0.36), (0.69, 0.56), (0.62, 0.69), (0.42, 0.74), 0.755),
    _Station(-1.45, (0.72, 0.19), (0.80, 0.38), (0.79, 0.62), (0.71, 0.76), (0.50, 0.815), 0.835),
    _Station(-0.98, (0.74, 0.19), (0.815, 0.40), (0.81, 0.68), (0.745, 0.845), (0.58, 0.905), 0.93),
    _Station(-0.70, _LOW, (0.815, 0.40), (0.812, 0.70), (0.755, 0.885), (0.64, 0.955), 0.985),
    _Station(-0.06, _LOW, (0.815, 0.40), (0.815, 0.72), (0.765, 0.91), (0.585, 1.375), 1.435),
    _Station(0.02, _LOW, (0.815, 0.40), (0.815, 0.72), (0.765, 0.91), (0.580, 1.405), 1.462),
    _Station(0.50, _LOW, (0.815, 0.40), (0.815, 0.73), (0.765, 0.92), (0.572, 1.435), 1.492),
    _Station(0.60, _LOW, (0.815, 0.40), (0.815, 0.73), (0.765, 0.925), (0.570, 1.435), 1.492),
    _Station(1.08, (0.74, 0.20), (0.81, 0.41), (0.81, 0.75), (0.755, 0.955), (0.555, 1.410), 1.466),
    _Station(1.36, (0.73, 0.22), (0.805, 0.42), (0.80, 0.77), (0.735, 0.985), (0.535, 1.350), 1.405),
    _Station(1.62, (0.70, 0.26), (0.78, 0.42), (0.775, 0.76), (0.69, 0.955), (0.54, 1.00), 1.03),
    _Station(1.72, (0.62, 0.28), (0.70, 0.42), (0.70, 0.68), (0.62, 0.84), (0.46, 0.88), 0.90),
)
_PAINT, _GLASS, _TRIM, _ROOF = range(4)


@kind(
    "car",
    (2.0, 3.6, 1.49),
    "drives",
    front="-y",
    colour=words("look.colour", *COLOURS),
    roof=words("look.roof", "plain", "rack", "white", "black"),
)
def car(name: str, rng: random.Random, *, look: CarLook = CarLook()) -> Car:
    """About 3.5 m long, 1.63 m wide, 1.5 m high."""
    paint = street.car_paint(f"{name}_paint", COLOURS[look.colour], rng)
    roof = (
        paint if look.roof in ("plain", "rack") else street.car_paint(f"{name}_roof", COLOURS[look.roof], rng)
    )
    trim = street.street_metal(f"{name}_trim", (0.020, 0.020, 0.022))
    glass = street.car_glass(f"{name}_glass")
    hull = _hull(f"{name}_hull")
    for material in (paint, glass, trim, roof):
        hull.data.materials.append(material)
    hubs = [
        Vector((s * 0.5 * TRACK_M, y, WHEEL_RADIUS_M))
        for y in (-0.5 * WHEELBASE_M, 0.5 * WHEELBASE_M)
        for s in (1.0, -1.0)
    ]
    hull = _cut_wells(hull, hubs, trim)
    parts = [hull, *_lamps(name), *_bumpers(name, trim, look), *_sides(name, paint, trim)]
    if look.roof == "rack":
        parts += _rack(name, trim)
    body = mesh.join(name, parts)
    wheels = [_wheel(f"{name}_wheel_{k}", k % 2 == 0) for k in range(4)]
    made = Car(body, wheels, hubs)
    made.place(Matrix.Identity(4))
    return made


def _hull(name: str) -> bpy.types.Object:
    """The closed skin: a cage through the stations, windows inset, then subdivided."""
    bm = bmesh.new()
    rings = []
    for station in _STATIONS:
        half = station.half()
        points = half + [(-x, z) for x, z in reversed(half[1:-1])]
        rings.append([bm.verts.new((x, station.y, z)) for x, z in points])
    count = len(rings[0])
    quads: dict[tuple[int, int], bmesh.types.BMFace] = {}
    for i, (front, back) in enumerate(zip(rings, rings[1:])):
        for j in range(count):
            quads[i, j] = bm.faces.new((front[j], front[(j + 1) % count], back[(j + 1) % count], back[j]))
    for ring, flip in ((rings[0], False), (rings[-1], True)):
        _cap(bm, ring, flip)
    bm.normal_update()
    bmesh.ops.recalc_face_normals(bm, faces=bm.faces[:])
    for (i, j), face in quads.items():
        mirror = min(j, count - 1 - j)
        if mirror >= 5 and 5 <= i <= 9:
            face.material_index = _ROOF
        if mirror == 0:
            face.material_index = _TRIM
    panes = [[quads[4, j] for j in range(5, count - 5)]]
    panes.append([quads[len(_STATIONS) - 3, j] for j in range(5, count - 5)])
    for j in (4, count - 5):
        panes += [[quads[4, j], quads[5, j], quads[6, j]], [quads[8, j], quads[9, j]]]
    for pane in panes:
        _inset(bm, pane)
    layer = bm.edges.layers.float.new("crease_edge")
    for edge in bm.edges:
        kinds = {face.material_index for face in edge.link_faces}
        if _GLASS in kinds and _TRIM in kinds:
            edge[layer] = 0.9
    data = bpy.data.meshes.new(name)
    bm.to_mesh(data)
    bm.free()
    obj = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(obj)
    mesh.subdivide(obj, 2)
    return mesh.shade_smooth(obj, 50.0)


def _cap(bm: bmesh.types.BMesh, ring: list[bmesh.types.BMVert], flip: bool) -> None:
    """Closes nose or tail with quads across the middle."""
    count = len(ring)
    for j in range(count // 2):
        a, b = ring[j], ring[j + 1]
        c, d = ring[(count - j - 1) % count], ring[(count - j) % count]
        corners = [v for k, v in enumerate((a, b, c, d)) if v not in (a, b, c, d)[:k]]
        if len(corners) >= 3:
            bm.faces.new(corners[::-1] if flip else corners)


def _inset(bm: bmesh.types.BMesh, pane: list[bmesh.types.BMFace]) -> None:
    """Sinks a window into the body, with a dark rubber round it."""
    rim = bmesh.ops.inset_region(bm, faces=pane, thickness=0.015, depth=-0.008, use_even_offset=True)["faces"]
    for face in rim:
        face.material_index = _TRIM
    for face in pane:
        face.material_index = _GLASS


def _cut_wells(hull: bpy.types.Object, hubs: list[Vector], dark: bpy.types.Material) -> bpy.types.Object:
    """Wheel wells, dark inside."""
    for k, hub in enumerate(hubs):
        cutter = mesh.cylinder(f"well_{k}", WHEEL_RADIUS_M + 0.055, 0.5, 40)
        mesh.rotate(mesh.move(cutter, z=-0.25), "Y", 90.0)
        mesh.move(cutter, hub.x + (0.11 if hub.x > 0 else -0.11), hub.y, hub.z + 0.01)
        mesh.set_material(cutter, dark)
        modifier = hull.modifiers.new("well", "BOOLEAN")
        modifier.operation, modifier.object, modifier.solver = "DIFFERENCE", cutter, "EXACT"
        modifier.material_mode = "TRANSFER"
        mesh.apply_modifiers(hull)
        bpy.data.objects.remove(cutter)
    return mesh.shade_smooth(hull, 40.0)


def _lamps(name: str) -> list[bpy.types.Object]:
    """Round-cornered headlamps, tail lamps, indicators."""
    clear = principled(f"{name}_lamp", (0.70, 0.71, 0.70), roughness=0.12, specular=0.8)
    shine = emission(f"{name}_beam", (1.0, 0.95, 0.85), 1.2)
    shine.cycles.emission_sampling = "NONE"
    red = principled(f"{name}_tail", (0.36, 0.008, 0.008), roughness=0.15, specular=0.7)
    amber = principled(f"{name}_blinker", (0.70, 0.22, 0.01), roughness=0.2)
    parts = Parts(name)
    nose, tail = _STATIONS[0].y, _STATIONS[-1].y
    for s in (-1.0, 1.0):
        parts.ellipsoid("lamp", clear, (0.135, 0.10, 0.105), 24, 14, (s * 0.545, nose + 0.135, 0.60))
        parts.ellipsoid("beam", shine, (0.062, 0.05, 0.062), 16, 10, (s * 0.530, nose + 0.072, 0.605))
        parts.ellipsoid("blinker", amber, (0.05, 0.06, 0.032), 14, 8, (s * 0.66, nose + 0.185, 0.50))
        parts.ellipsoid("tail", red, (0.105, 0.11, 0.175), 20, 12, (s * 0.640, tail - 0.125, 0.73))
    return parts


def _bumpers(name: str, trim: bpy.types.Material, look: CarLook) -> list[bpy.types.Object]:
    """Bumper strips, grille, number plates."""
    white = principled(f"{name}_plate", (0.72, 0.72, 0.68), roughness=0.5)
    ink = principled(f"{name}_ink", (0.02, 0.02, 0.025), roughness=0.6)
    chrome = street.steel(f"{name}_chrome")
    nose, tail = _STATIONS[0].y, _STATIONS[-1].y
    parts = Parts(name)
    for y, turn in ((nose, 0.0), (tail, 180.0)):
        s = 1.0 if turn else -1.0
        line = [(x, y - s * (0.02 + 0.30 * abs(x / 0.76) ** 3.2), 0.34) for x in _spread(-0.76, 0.76, 17)]
        parts.tube("bumper", trim, line, [(0.055, 0.085)] * 17, segments=12, up=(0.0, 0.0, 1.0))
        parts.box("plate", white, (0.44, 0.016, 0.105), 0.006, y=y + s * 0.062, z=0.29)
        text = mesh.rotate(lettering(f"{name}_number", look.plate, 0.070, bold_m=0.002), "X", 90.0)
        mesh.move(mesh.rotate(text, "Z", turn), 0.0, y + s * 0.0712, 0.343)
        parts.add(text, ink)
    for k in range(3):
        bar = mesh.bevel_box(f"{name}_grille", (0.62 - 0.06 * k, 0.05, 0.022), 0.008, 2)
        parts.add(bar, trim if k else chrome, y=nose - 0.005, z=0.555 - 0.045 * k)
    return parts


def _spread(first: float, last: float, count: int) -> list[float]:
    return [first + (last - first) * k / (count - 1) for k in range(count)]


def _sides(name: str, paint: bpy.types.Material, trim: bpy.types.Material) -> list[bpy.types.Object]:
    """Mirrors, door handles, door gaps, sills, wipers and an aerial."""
    chrome = street.steel(f"{name}_handle")
    parts = Parts(name)
    for s in (-1.0, 1.0):
        parts.ellipsoid("mirror", paint, (0.095, 0.06, 0.065), 18, 12, (s * 0.905, -0.52, 0.975))
        parts.tube("stalk", trim, [(s * 0.74, -0.50, 0.92), (s * 0.86, -0.51, 0.955)], 0.02, segments=8)
        parts.box("grip", chrome, (0.035, 0.17, 0.028), 0.010, 2, x=s * 0.806, y=0.42, z=0.765)
        for y in (-0.60, 0.58):
            parts.tube(
                "gap",
                trim,
                [(s * 0.758, y, 0.26), (s * 0.8, y, 0.42), (s * 0.8, y, 0.70), (s * 0.757, y, 0.88)],
                0.008,
                segments=6,
            )
        parts.box("sill", trim, (0.07, 1.55, 0.11), 0.03, 2, x=s * 0.755, z=0.17)
    for x in (-0.30, 0.22):
        parts.tube(
            "wiper",
            trim,
            [(x, -0.70, 1.005), (x + 0.22, -0.585, 1.075), (x + 0.42, -0.55, 1.095)],
            0.010,
            segments=6,
        )
    return parts


def _rack(name: str, trim: bpy.types.Material) -> list[bpy.types.Object]:
    """Two bars with a long roof box on them."""
    top = max(station.crown for station in _STATIONS)
    parts = Parts(name)
    for y in (0.10, 0.92):
        parts.tube(
            "bar",
            trim,
            [(-0.60, y, top - 0.075), (-0.57, y, top + 0.06), (0.57, y, top + 0.06), (0.60, y, top - 0.075)],
            0.018,
            segments=8,
        )
    box = mesh.subdivide(mesh.bevel_box(f"{name}_box", (0.66, 1.75, 0.32), 0.11, 3), 1)
    parts.add(box, street.street_metal(f"{name}_box", (0.055, 0.058, 0.062)), y=0.48, z=top + 0.075)
    return parts


def _wheel(name: str, left: bool) -> bpy.types.Object:
    """Tyre and a five-spoked rim that looks outwards (+X on the left side), round its hub."""
    rubber, alloy = street.tyre(f"{name}_tyre"), street.steel(f"{name}_alloy")
    dark = street.street_metal(f"{name}_dark", (0.012, 0.012, 0.013))
    r, half = WHEEL_RADIUS_M, 0.085
    profile = [
        (0.19, -half + 0.012), (0.225, -half), (r - 0.028, -half + 0.006), (r - 0.008, -half + 0.022),
        (r, -half + 0.045), (r, half - 0.045), (r - 0.008, half - 0.022), (r - 0.028, half - 0.006),
        (0.225, half), (0.19, half - 0.012),
    ]  # fmt: skip
    tyre = mesh.set_material(mesh.lathe(f"{name}_tyre", profile, 40, close_bottom=False), rubber)
    drum = placed(mesh.cylinder(f"{name}_drum", 0.192, 0.10, 32), dark, z=-0.06)
    lip = mesh.lathe(
        f"{name}_lip",
        [(0.178, 0.035), (0.182, half - 0.016), (0.196, half - 0.006), (0.200, half - 0.02)],
        40,
        close_bottom=False,
    )
    parts = Parts(name)
    parts += [tyre, drum]
    parts.add(lip, alloy)
    for k in range(5):
        a = 2 * pi * k / 5
        parts.tube(
            "spoke",
            alloy,
            [(0.03 * cos(a), 0.03 * sin(a), 0.062), (0.186 * cos(a), 0.186 * sin(a), 0.066)],
            [(0.030, 0.014), (0.022, 0.012)],
            segments=8,
        )
    parts.cylinder("cap", alloy, 0.048, 0.03, 20, 0.008, z=0.052)
    wheel = parts.join()
    return mesh.rotate(wheel, "Y", 90.0 if left else -90.0)
