"""A wind-up tin robot: printed tin body, two feet that shuffle by turns, a key in its back.

Owns the robot's parts and where they join. Knows nothing of how it walks. All parts have their origin between
the soles on z = 0 except the key, whose origin is on its shaft; front = -Y.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from math import cos, pi, sin

import bpy
from mathutils import Matrix, Vector

from l4d_blender.assets import mesh
from l4d_blender.assets.materials import products
from l4d_blender.assets.materials.base import Nodes
from l4d_blender.assets.parts import Parts
from l4d_blender.scene.catalogue import Choice, colours, kind, words
from l4d_blender.scene.colour import Colour

STANCE_M = 0.021  # half the distance between the feet
HIP_M = 0.040
KEY_AT = Vector((0.0, 0.030, 0.078))
CHESTS = ("dial", "gears", "lamps")
STEEL: Colour = (0.60, 0.59, 0.56)


@dataclass(frozen=True)
class Look:
    """Paint of body and limbs, what is on the chest (one of CHESTS), an aerial or none, and its scale."""

    paint: Colour = (0.48, 0.045, 0.03)
    trim: Colour = (0.68, 0.46, 0.06)
    chest: str = "dial"
    aerial: bool = False
    scale: float = 1.0


@dataclass(frozen=True)
class Robot:
    """The separate parts of a robot."""

    body: bpy.types.Object
    left: bpy.types.Object
    right: bpy.types.Object
    key: bpy.types.Object
    scale: float

    @property
    def parts(self) -> list[bpy.types.Object]:
        """All parts, the body first."""
        return [self.body, self.left, self.right, self.key]

    def place(self, matrix: Matrix) -> None:
        """Stands the robot somewhere, feet together."""
        for part in (self.body, self.left, self.right):
            part.matrix_basis = matrix
        self.key.matrix_basis = matrix @ Matrix.Translation(KEY_AT * self.scale)


@kind(
    "robot",
    (0.112, 0.072, 0.149),
    "graspable",
    "walks",
    front="-y",
    colour=colours("look.paint"),
    chest=words("look.chest", *CHESTS),
    size=Choice("look.scale", {"small": 1.0, "large": 1.2}),
)
def toy_robot(name: str, rng: random.Random, *, look: Look = Look()) -> Robot:
    """A robot 14 cm tall (times the look's scale)."""
    tin = printed_tin(f"{name}_tin", look.paint, rng)
    trim = printed_tin(f"{name}_trim", look.trim, rng)
    steel = products.metal(f"{name}_steel", STEEL, rng, roughness=0.35)
    dark = products.satin_plastic(f"{name}_dark", (0.03, 0.03, 0.035), rng)
    glow = products.glow(f"{name}_eyes", (1.0, 0.72, 0.25), 1.6)
    body = mesh.join(
        name,
        [
            *_torso(name, tin, trim, steel),
            *_chest(name, look, trim, steel, dark, rng),
            *_head(name, look, tin, trim, steel, dark, glow),
            *(part for side in (-1.0, 1.0) for part in _arm(name, side, tin, trim, steel)),
        ],
    )
    legs = [_leg(f"{name}_leg", side, tin, steel, dark) for side in (1.0, -1.0)]
    parts = [body, *legs, _key(f"{name}_key", steel)]
    for part in parts:
        mesh.transform(part, Matrix.Scale(look.scale, 4))
    left, right = legs
    left.name, right.name = f"{name}_left", f"{name}_right"
    return Robot(body, left, right, parts[3], look.scale)


def printed_tin(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """Lithographed sheet: glossy ink, scratched through to the metal here and there, rust in places."""
    material = products.lacquer(name, colour, rng)
    n = Nodes(material)
    at = n.vector_math("ADD", n.object_coords(), tuple(rng.uniform(-5, 5) for _ in range(3)))
    cloud = n.noise(30.0, 3.0, vector=at)
    scratch = n.math("MULTIPLY", n.noise(150.0, 4.0, vector=n.mapping(at, scale=(1.0, 1.0, 0.25))), cloud)
    worn = n.map_range(scratch, 0.335, 0.36)
    ink = n.ramp(cloud, [(0.3, products.scaled(colour, 0.80)), (0.7, products.scaled(colour, 1.15))])
    bare = n.ramp(n.noise(80.0, 3.0, vector=at), [(0.4, (0.20, 0.09, 0.04)), (0.6, (0.40, 0.38, 0.35))])
    n.set("Base Color", n.mix(worn, ink, bare))
    n.set("Metallic", n.math("MULTIPLY", worn, 0.6))
    n.set("Roughness", n.map_range(worn, 0.0, 1.0, 0.26, 0.5))
    return material


def _torso(name: str, tin, trim, steel) -> list[bpy.types.Object]:
    parts = Parts(name)
    parts.box("chest", tin, (0.066, 0.046, 0.058), 0.005, z=HIP_M + 0.002)
    parts.box("belt", trim, (0.069, 0.049, 0.009), 0.002, z=HIP_M)
    parts.cylinder("collar", steel, 0.013, 0.010, 24, z=0.098)
    for x in (-0.028, 0.028):
        for z in (0.054, 0.093):
            parts.ellipsoid("rivet", steel, (0.0021, 0.0014, 0.0021), 10, 6, centre=(x, -0.0232, z))
    return parts


def _chest(name: str, look: Look, trim, steel, dark, rng: random.Random) -> list[bpy.types.Object]:
    """What is printed or mounted on the front of the torso."""
    front = Matrix.Translation((0.0, -0.0228, 0.075)) @ Matrix.Rotation(pi / 2, 4, "X")
    parts = Parts(name)

    def mount(part: bpy.types.Object, material: bpy.types.Material, x: float = 0.0, y: float = 0.0) -> None:
        mesh.transform(part, front @ Matrix.Translation((x, y, 0.0)))
        parts.add(part, material)

    paper = products.lacquer(f"{name}_face", (0.74, 0.70, 0.58), rng)
    if look.chest == "dial":
        mount(mesh.cylinder(f"{name}_bezel", 0.0185, 0.0022, 36, bevel_m=0.0008), steel)
        mount(mesh.cylinder(f"{name}_dial", 0.0160, 0.0028, 36), paper)
        needle = mesh.bevel_box(f"{name}_needle", (0.0020, 0.0145, 0.0034), 0.0004, segments=1)
        mesh.rotate(mesh.move(needle, y=0.006), "Z", -38)
        mount(needle, dark)
    elif look.chest == "gears":
        panel = mesh.bevel_box(f"{name}_panel", (0.048, 0.034, 0.0020), 0.0008, segments=2)
        mount(panel, dark)
        for x, y, radius, metal in ((-0.010, 0.002, 0.0125, trim), (0.0118, -0.003, 0.0095, steel)):
            mount(gear(f"{name}_gear", radius, 0.0042), metal, x, y)
    else:
        panel = mesh.bevel_box(f"{name}_panel", (0.046, 0.030, 0.0020), 0.0008, segments=2)
        mount(panel, paper)
        for k, colour in enumerate(((0.55, 0.04, 0.03), (0.70, 0.45, 0.04), (0.06, 0.32, 0.09))):
            lamp = mesh.ellipsoid(f"{name}_lamp", (0.0052, 0.0052, 0.0040), 18, 10, centre=(0, 0, 0.002))
            mount(
                lamp,
                products.satin_plastic(f"{name}_lamp{k}", colour, rng, roughness=0.2),
                -0.014 + 0.014 * k,
            )
    return parts


def gear(name: str, radius: float, height: float) -> bpy.types.Object:
    """A flat cog with ten teeth round +Z."""
    rim = []
    for k in range(40):
        tooth = 1.0 if (k // 2) % 2 == 0 else 0.80
        a = 2 * pi * k / 40
        rim.append((radius * tooth * cos(a), radius * tooth * sin(a)))
    cog = mesh.loft(name, [[Vector((x, y, z)) for x, y in rim] for z in (0.0, height)])
    return mesh.shade_smooth(cog, 30.0)


def _head(name: str, look: Look, tin, trim, steel, dark, glow) -> list[bpy.types.Object]:
    """A box with lamp eyes, a grille, ears, and perhaps an aerial."""
    parts = Parts(name)
    parts.box("head", tin, (0.044, 0.038, 0.033), 0.006, z=0.106)
    for side in (-1.0, 1.0):
        for radius, length, material in ((0.0072, 0.0030, steel), (0.0052, 0.0042, glow)):
            eye = mesh.cylinder(f"{name}_eye", radius, length, 24, bevel_m=0.0006)
            parts.add(eye, material, x=side * 0.0105, y=-0.0185, z=0.1265, turn=("X", 90.0))
        parts.cylinder(
            "ear", trim, 0.0085, 0.006, 24, bevel_m=0.001, x=side * 0.0215, z=0.122, turn=("Y", 90.0 * side)
        )
    parts.box("mouth", dark, (0.024, 0.003, 0.0072), 0.0008, segments=1, y=-0.0185, z=0.1105)
    for k in range(4):
        tooth = mesh.bevel_box(f"{name}_tooth", (0.0022, 0.0036, 0.0058), 0.0004, segments=1)
        parts.add(tooth, steel, x=-0.0084 + 0.0056 * k, y=-0.0187, z=0.1112)
    if look.aerial:
        parts.cylinder("aerial", steel, 0.0016, 0.026, 10, z=0.138)
        parts.ellipsoid("tip", trim, (0.0048, 0.0048, 0.0048), 16, 10, centre=(0.0, 0.0, 0.166))
    return parts


def _arm(name: str, side: float, tin, trim, steel) -> list[bpy.types.Object]:
    """A bent arm that ends in a C-shaped claw held forward."""
    shoulder = mesh.cylinder(f"{name}_shoulder", 0.010, 0.010, 24, bevel_m=0.0015)
    mesh.rotate(shoulder, "Y", 90.0 * side)
    mesh.move(shoulder, x=side * 0.032, z=0.088)
    upper = mesh.bevel_box(f"{name}_upper", (0.012, 0.016, 0.034), 0.003)
    mesh.move(upper, x=side * 0.0455, z=0.060)
    fore = mesh.bevel_box(f"{name}_fore", (0.011, 0.032, 0.012), 0.003)
    mesh.move(fore, x=side * 0.0455, y=-0.016, z=0.057)
    arc = [_front_arc(0.0078, pi * (0.22 + 1.56 * k / 10)) for k in range(11)]
    claw = mesh.tube(
        f"{name}_claw", [(side * 0.0455 + x, -0.040 + y, 0.063) for x, y in arc], (0.0026,) * 11, segments=8
    )
    return [
        mesh.set_material(shoulder, trim),
        mesh.set_material(upper, tin),
        mesh.set_material(fore, tin),
        mesh.set_material(claw, steel),
    ]


def _front_arc(radius: float, angle: float) -> tuple[float, float]:
    """A point of a circle whose angle 0 is at -Y, so that an arc from it opens forward."""
    return radius * sin(angle), -radius * cos(angle)


def _leg(name: str, side: float, tin, steel, dark) -> bpy.types.Object:
    """A leg that reaches into the torso, on a heavy foot."""
    x = side * STANCE_M
    parts = Parts(name)
    parts.box("shank", tin, (0.024, 0.030, 0.046), 0.003, x=x, z=0.012)
    parts.box("foot", tin, (0.034, 0.054, 0.017), 0.005, x=x, y=-0.006, z=0.002)
    parts.box("sole", dark, (0.035, 0.055, 0.005), 0.001, x=x, y=-0.006)
    parts.box("cuff", steel, (0.026, 0.032, 0.005), 0.0015, x=x, z=0.022)
    return parts.join()


def _key(name: str, steel) -> bpy.types.Object:
    """A butterfly key whose shaft lies along Y, its origin where the shaft enters the back."""
    shaft = mesh.cylinder(f"{name}_shaft", 0.0028, 0.022, 14)
    mesh.move(mesh.rotate(shaft, "X", -90.0), y=-0.008)
    wings = Parts(name)
    for side in (-1.0, 1.0):
        wing = mesh.torus(f"{name}_wing", 0.0092, 0.0028, 24, 8)
        mesh.transform(wing, Matrix.Diagonal((1.0, 0.82, 1.0, 1.0)))
        wings.add(wing, x=side * 0.0105, y=0.014, turn=("X", 90.0))
    return mesh.set_material(mesh.join(name, [shaft, *wings]), steel)
