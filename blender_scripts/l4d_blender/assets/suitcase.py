"""Trolley suitcases: hard shells (ribbed or smooth) and soft cases, with wheels and a telescopic handle.

Owns sizes, shells, straps and stickers, and where hands and wheels meet a case. The case stands upright on
its base and faces -Y; wheels and handle are at its back (+Y), so it tilts over its wheels towards +Y. The
axle is an object of its own, so that motion can roll it. Metres.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from math import cos, pi, sin
from typing import Any

import bpy
from mathutils import Matrix, Vector

from l4d_blender.scene.catalogue import kind, words

from ..scene.colour import Colour
from . import mesh
from .materials import products
from .materials.base import principled
from .parts import Parts

#: Width, depth and height of the shell.
SIZES: dict[str, tuple[float, float, float]] = {
    "cabin": (0.37, 0.22, 0.52),
    "medium": (0.43, 0.27, 0.62),
    "large": (0.50, 0.32, 0.72),
}
COLOURS: dict[str, Colour] = {
    "teal": (0.020, 0.235, 0.235),
    "red": (0.46, 0.028, 0.030),
    "navy": (0.018, 0.040, 0.135),
    "yellow": (0.66, 0.40, 0.030),
    "grey": (0.20, 0.21, 0.22),
    "brown": (0.20, 0.095, 0.042),
    "black": (0.020, 0.020, 0.022),
    "pink": (0.62, 0.20, 0.27),
    "cream": (0.66, 0.58, 0.43),
    "orange": (0.66, 0.20, 0.030),
}
WHEEL_RADIUS_M = 0.042
BASE_M = 0.062  # underside of the shell
HANDLE_OUT_M = 0.99  # height of the bar over the ground, drawn out


@dataclass(frozen=True)
class CaseLook:
    """`shell` is ribbed, smooth or soft; `strap` and `stickers` are colours, or nothing."""

    size: str = "medium"
    shell: str = "ribbed"
    colour: str = "teal"
    strap: str | None = None
    stickers: tuple[str, ...] = ()
    handle_out: bool = True


@dataclass
class Suitcase:
    """The case (carries the axes) and its rolling axle; points are in the case's own space."""

    body: bpy.types.Object
    axle: bpy.types.Object
    grip: Vector
    axle_at: Vector

    @property
    def parts(self) -> list[bpy.types.Object]:
        """What belongs to the instance, the case first."""
        return [self.body, self.axle]

    def place(self, matrix: Matrix) -> None:
        """Stands the case somewhere, wheels and all."""
        self.body.matrix_basis = matrix
        self.axle.matrix_basis = matrix @ Matrix.Translation(self.axle_at)


@kind(
    "suitcase",
    (0.465, 0.277, 1.0),
    "graspable",
    "rolls",
    front="-y",
    colour=words("look.colour", *COLOURS),
    shell=words("look.shell", "ribbed", "smooth", "soft"),
    size=words("look.size", *SIZES),
)
def suitcase(name: str, rng: random.Random, *, look: CaseLook = CaseLook()) -> Suitcase:
    """A suitcase upright on z = 0."""
    w, d, h = SIZES[look.size]
    dark = products.satin_plastic(f"{name}_trim", (0.022, 0.022, 0.024), rng)
    chrome = products.metal(f"{name}_tube", (0.60, 0.61, 0.62), rng, roughness=0.3)
    back = 0.5 * d - 0.035
    parts = [_shell(name, rng, look, w, d, h), *_fittings(name, dark, w, d, h)]
    grip_z = HANDLE_OUT_M if look.handle_out else BASE_M + h + 0.035
    parts += _handle(name, dark, chrome, grip_z, back, BASE_M + h)
    if look.shell == "soft":
        parts += _pockets(name, rng, look, w, d, h)
    else:
        parts.append(_zip(name, dark, w, h))
    if look.strap:
        parts += _strap(name, rng, look.strap, dark, w, d, h)
    parts += _stickers(name, rng, look, d, h)
    axle = _axle(f"{name}_axle", rng, w)
    case = Suitcase(
        mesh.join(name, parts), axle, Vector((0.0, back, grip_z)), Vector((0.0, back, WHEEL_RADIUS_M))
    )
    case.place(Matrix.Identity(4))
    return case


def _outline(w: float, d: float, corner: float, ribs: float, count: int = 132) -> list[Vector]:
    """A rounded rectangle in the plane, evenly sampled by arc length; ribs press grooves of `ribs` metres."""
    hw, hd = 0.5 * w - corner, 0.5 * d - corner
    lengths = [2 * hd, 0.5 * pi * corner, 2 * hw, 0.5 * pi * corner] * 2
    starts: list[Any] = [Vector((hw + corner, -hd)), None, Vector((hw, hd + corner)), None]
    starts += [Vector((-hw - corner, hd)), None, Vector((-hw, -hd - corner)), None]
    ways: list[Any] = [
        Vector((0, 1)),
        None,
        Vector((-1, 0)),
        None,
        Vector((0, -1)),
        None,
        Vector((1, 0)),
        None,
    ]
    centres: list[Any] = [None, (hw, hd, 0.0), None, (-hw, hd, 0.5 * pi), None, (-hw, -hd, pi), None]
    centres.append((hw, -hd, 1.5 * pi))
    total, points = sum(lengths), []
    for k in range(count):
        s, i = total * k / count, 0
        while s > lengths[i]:
            s -= lengths[i]
            i += 1
        if starts[i] is not None:
            point, normal = starts[i] + ways[i] * s, Vector((ways[i].y, -ways[i].x))
        else:
            x, y, turn = centres[i]
            normal = Vector((cos(turn + s / corner), sin(turn + s / corner)))
            point = Vector((x, y)) + corner * normal
        wave = 0.5 + 0.5 * sin(2 * pi * round(total / 0.040) * k / count)
        points.append(point - normal * (ribs * wave**3))
    return points


def _shell(name: str, rng: random.Random, look: CaseLook, w: float, d: float, h: float) -> bpy.types.Object:
    colour = COLOURS[look.colour]
    soft = look.shell == "soft"
    rounding = 0.045 if soft else 0.060
    steps = 5
    levels = [(rounding * (1 - sin(a)), rounding * (1 - cos(a))) for a in _quarter(steps)]
    levels += [(0.0, z) for z in (0.25 * h, 0.5 * h, 0.75 * h)]
    levels += [(rounding * (1 - cos(a)), h - rounding * (1 - sin(a))) for a in _quarter(steps)]
    sections = []
    for inset, z in levels:
        fade = max(0.0, 1.0 - inset / 0.02)
        bulge = 0.010 * sin(pi * z / h) if soft else 0.0
        ring = _outline(
            w - 2 * inset, d - 2 * inset + 2 * bulge, 0.055, 0.008 * fade if look.shell == "ribbed" else 0.0
        )
        sections.append([(p.x, p.y, BASE_M + z) for p in ring])
    body = mesh.loft(f"{name}_shell", sections)
    if soft:
        material = products.woven_cloth(f"{name}_cloth", colour, rng, threads_per_m=420.0, contrast=0.35)
    else:
        material = products.satin_plastic(f"{name}_plastic", colour, rng, roughness=0.34)
    return mesh.set_material(body, material)


def _quarter(steps: int) -> list[float]:
    return [0.5 * pi * k / steps for k in range(steps + 1)]


def _zip(name: str, dark: bpy.types.Material, w: float, h: float) -> bpy.types.Object:
    """The dark seam round the middle where the two halves meet."""
    ring = _outline(w + 0.002, h + 0.002, 0.06, 0.0, 72)
    seam = mesh.tube(
        f"{name}_zip",
        [(p.x, 0.0, BASE_M + 0.5 * h + p.y) for p in ring],
        [(0.006, 0.004)] * len(ring),
        segments=6,
        cap=False,
        closed=True,
        up=(1.0, 0.0, 0.0),
    )
    return mesh.set_material(seam, dark)


def _fittings(name: str, dark: bpy.types.Material, w: float, d: float, h: float) -> list[bpy.types.Object]:
    """Feet, wheel housings, corner guards of the base, and the two carrying handles."""
    parts = Parts(name)
    for side in (-1.0, 1.0):
        foot = mesh.cylinder(f"{name}_foot", 0.020, BASE_M + 0.03, 16, 0.006)
        parts.add(foot, dark, x=side * (0.5 * w - 0.07), y=-0.5 * d + 0.055)
        housing = mesh.bevel_box(f"{name}_housing", (0.060, 0.085, 0.075), 0.018)
        parts.add(housing, dark, x=side * (0.5 * w - 0.050), y=0.5 * d - 0.040, z=0.040)
    top, turns = BASE_M + h, [pi * k / 10 for k in range(11)]
    arc = [(0.085 * cos(a), -0.02, top - 0.006 + 0.034 * sin(a)) for a in turns]
    parts.tube("carry", dark, arc, [(0.014, 0.007)] * 11, segments=8, up=(0.0, 0.0, 1.0))
    z = BASE_M + 0.5 * h
    arc = [(0.5 * w - 0.006 + 0.030 * sin(a), -0.02, z + 0.085 * cos(a)) for a in turns]
    parts.tube("carry_side", dark, arc, [(0.014, 0.007)] * 11, segments=8, up=(1.0, 0.0, 0.0))
    return parts


def _handle(
    name: str, dark: bpy.types.Material, chrome: bpy.types.Material, grip_z: float, back: float, top: float
) -> list[bpy.types.Object]:
    parts = Parts(name)
    for x in (-0.075, 0.075):
        parts.tube("rod", chrome, [(x, back, top - 0.05), (x, back, grip_z)], 0.0085, segments=10)
        parts.cylinder("collar", dark, 0.017, 0.02, 12, 0.004, x=x, y=back, z=top - 0.006)
    parts.tube(
        "bar",
        dark,
        [(-0.095, back, grip_z), (-0.06, back, grip_z), (0.06, back, grip_z), (0.095, back, grip_z)],
        [(0.012, 0.012), (0.0145, 0.0145), (0.0145, 0.0145), (0.012, 0.012)],
        segments=12,
    )
    return parts


def _pockets(
    name: str, rng: random.Random, look: CaseLook, w: float, d: float, h: float
) -> list[bpy.types.Object]:
    """Two zipped pockets on the front, and piping round front and back."""
    cloth = products.woven_cloth(
        f"{name}_pocket", products.scaled(COLOURS[look.colour], 0.86), rng, threads_per_m=420.0, contrast=0.35
    )
    piping = products.woven_cloth(
        f"{name}_piping", products.scaled(COLOURS[look.colour], 0.35), rng, threads_per_m=300.0
    )
    parts = Parts(name)
    for low, tall in ((0.07, 0.44), (0.58, 0.32)):
        parts.box(
            "pocket", cloth, (0.80 * w, 0.06, tall * h), 0.028, 4, y=-0.5 * d - 0.004, z=BASE_M + low * h
        )
        line = [
            (x * w, -0.5 * d - 0.035, BASE_M + (low + tall) * h - 0.03) for x in (-0.36, -0.12, 0.12, 0.36)
        ]
        parts.tube("zip", piping, line, 0.005, segments=6)
    for y in (-0.5 * d + 0.030, 0.5 * d - 0.030):
        ring = _outline(w + 0.004, h + 0.004, 0.052, 0.0, 72)
        parts.tube(
            "cord",
            piping,
            [(p.x, y, BASE_M + 0.5 * h + p.y) for p in ring],
            0.0065,
            segments=6,
            cap=False,
            closed=True,
        )
    return parts


def _strap(
    name: str, rng: random.Random, colour: str, dark: bpy.types.Material, w: float, d: float, h: float
) -> list[bpy.types.Object]:
    """A webbing strap pulled tight round the middle, with its buckle in front."""
    webbing = products.woven_cloth(f"{name}_strap", COLOURS[colour], rng, threads_per_m=260.0)
    z, half = BASE_M + 0.54 * h, 0.027
    rings = [
        [(p.x, p.y - 0.022, z + dz) for p in _outline(w + grow, d + 0.048 + grow, 0.055, 0.0, 72)]
        for dz, grow in ((-half, 0.000), (-half, 0.012), (half, 0.012), (half, 0.000))
    ]
    band = mesh.shade_smooth(mesh.loft(f"{name}_strap", rings, cap=False), 40.0)
    buckle = mesh.bevel_box(f"{name}_buckle", (0.075, 0.016, 0.068), 0.006)
    mesh.move(buckle, 0.05, -0.5 * d - 0.046, z - 0.034)
    return [mesh.set_material(band, webbing), mesh.set_material(buckle, dark)]


def _stickers(name: str, rng: random.Random, look: CaseLook, d: float, h: float) -> list[bpy.types.Object]:
    """Round and square travel stickers on the front."""
    spots = [(-0.09, 0.70), (0.08, 0.50), (-0.07, 0.30), (0.10, 0.80), (0.03, 0.22)]
    parts = Parts(name)
    for k, (colour, (x, z)) in enumerate(zip(look.stickers, spots)):
        if k % 2:
            label = mesh.bevel_box(f"{name}_sticker", (0.11, 0.0024, 0.075), 0.001, 1)
        else:
            label = mesh.rotate(mesh.cylinder(f"{name}_sticker", 0.050, 0.0024, 28), "X", 90.0)
        mesh.rotate(label, "Y", rng.uniform(-18.0, 18.0))
        mesh.move(label, x, -0.5 * d - 0.0014, BASE_M + z * h)
        print_ = principled(
            f"{name}_sticker", COLOURS[colour], roughness=0.5, variation=0.5, variation_scale=40
        )
        parts.add(label, print_)
    return parts


def _axle(name: str, rng: random.Random, w: float) -> bpy.types.Object:
    """Two wheels on one axle along X, round its own origin."""
    rubber = products.rubber(f"{name}_rubber", (0.030, 0.030, 0.032), rng)
    hub = products.satin_plastic(f"{name}_hub", (0.16, 0.16, 0.17), rng)
    parts = Parts(name)
    for side in (-1.0, 1.0):
        wheel = mesh.cylinder(f"{name}_wheel", WHEEL_RADIUS_M, 0.026, 28, 0.007)
        parts.add(wheel, rubber)
        boss = mesh.move(mesh.cylinder(f"{name}_boss", 0.020, 0.032, 6, 0.003), z=-0.003)
        parts.add(boss, hub)
        for part in (wheel, boss):
            mesh.rotate(mesh.move(part, z=-0.013), "Y", 90.0)
            mesh.move(part, side * (0.5 * w - 0.012))
    return parts.join()
