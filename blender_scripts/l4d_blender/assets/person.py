"""A person: body, face, hands and clothes on one armature, described by a Look.

`person` returns a rig with skinned meshes in the rest pose; motion/people.py makes it act.
"""

from __future__ import annotations

import random
from dataclasses import dataclass, field, replace
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

from l4d_blender.scene.catalogue import Choice, kind, words

from ..scene.colour import Colour
from . import garments, head
from .anatomy import BUILDS, CHIN_M, FINGERS, SIDES, Anatomy, vec
from .implicit import clip, smoothstep
from .materials import skin as materials
from .rigs import armature
from .shell import Shell, make_mesh, merged, tube

SKIN_TONES: dict[str, Colour] = {
    "pale": (0.72, 0.46, 0.36),
    "fair": (0.62, 0.37, 0.26),
    "tan": (0.47, 0.26, 0.16),
    "brown": (0.27, 0.135, 0.08),
    "dark": (0.13, 0.062, 0.037),
}
HAIR_COLOURS: dict[str, Colour] = {
    "black": (0.012, 0.010, 0.009),
    "dark_brown": (0.045, 0.022, 0.012),
    "brown": (0.10, 0.048, 0.022),
    "blond": (0.42, 0.26, 0.10),
    "red": (0.27, 0.075, 0.022),
    "grey": (0.32, 0.31, 0.30),
}
CLOTH_COLOURS: dict[str, Colour] = {
    "white": (0.80, 0.78, 0.74),
    "black": (0.022, 0.022, 0.026),
    "grey": (0.22, 0.22, 0.23),
    "red": (0.55, 0.035, 0.035),
    "pink": (0.78, 0.22, 0.34),
    "orange": (0.75, 0.22, 0.03),
    "yellow": (0.80, 0.52, 0.06),
    "green": (0.07, 0.30, 0.09),
    "blue": (0.05, 0.14, 0.48),
    "light_blue": (0.25, 0.46, 0.70),
    "navy": (0.02, 0.035, 0.11),
    "purple": (0.22, 0.06, 0.32),
    "brown": (0.16, 0.08, 0.04),
    "beige": (0.52, 0.41, 0.28),
    "denim": (0.07, 0.13, 0.26),
}


@dataclass(frozen=True)
class Cloth:
    """A fabric: names of CLOTH_COLOURS (or RGB triples), plain, stripes, checks, dots or denim."""

    colour: str | Colour = "blue"
    pattern: str = "plain"
    second: str | Colour = "white"
    repeat_m: float = 0.05


@dataclass(frozen=True)
class Look:
    """Everything that makes one person look different from another.

    `bottom` is trousers, shorts, skirt or dress (a dress takes its upper part from the same fabric);
    `sleeve` is none, short, elbow or long; `shoes` is shoes or boots.
    """

    build: str = "woman"
    height_m: float = 1.68
    girth: float = 1.0
    skin: str = "fair"
    hair: str = "bob"
    hair_colour: str = "brown"
    top: Cloth = field(default_factory=Cloth)
    sleeve: str = "short"
    bottom: str = "trousers"
    lower: Cloth = field(default_factory=lambda: Cloth("denim", "denim"))
    hem_z: float | None = None
    apron: Cloth | None = None
    jacket: Cloth | None = None
    shoes: str = "shoes"
    shoe_colour: str = "brown"
    eye_colour: Colour = (0.10, 0.055, 0.025)
    jaw: float = 1.0
    nose: float = 1.0
    seed: int = 0

    def dressed(self, **changes: Any) -> Look:
        """The same person in something else: look.dressed(apron=Cloth("white"))."""
        return replace(self, **changes)


@dataclass
class PersonBody:
    """A built person: the armature, its skinned meshes, and the anatomy that motion needs."""

    rig: bpy.types.Object
    meshes: list[bpy.types.Object]
    anatomy: Anatomy
    skirt: garments.Skirt | None

    @property
    def parts(self) -> list[bpy.types.Object]:
        """All meshes; the rig moves them."""
        return self.meshes

    def place(self, matrix: Matrix) -> None:
        """Stands the person somewhere."""
        self.rig.matrix_basis = matrix


@kind(
    "person",
    (1.027, 0.337, 1.698),
    "walks",
    front="-y",
    build=words("look.build", *BUILDS),
    skin=words("look.skin", *SKIN_TONES),
    hair=words("look.hair", *head.HAIR_STYLES),
    hair_colour=words("look.hair_colour", *HAIR_COLOURS),
    top=Choice("look.top", {colour: Cloth(colour) for colour in CLOTH_COLOURS}),
    sleeve=words("look.sleeve", *garments.SLEEVES),
    bottom=words("look.bottom", "trousers", "shorts", "skirt", "dress"),
)
def person(name: str, rng: random.Random, *, look: Look = Look()) -> PersonBody:
    """A person in the rest pose at the origin, facing -Y."""
    anatomy = Anatomy(look.build, look.height_m, look.girth)
    phase = random.Random(f"{look.seed}/phase").uniform(0.0, 6.28)
    tailor = garments.Tailor(anatomy, phase)
    skirt = _skirt(look, anatomy, phase)
    skin = materials.skin(f"{name}.skin", SKIN_TONES[look.skin])
    clothes = _clothes(name, look, tailor, skirt)
    shells = [
        merged(f"{name}.body", [_bare_skin(look, tailor, skin), *_hands(anatomy, skin)]),
        _head(name, look, anatomy, skin, phase),
        *clothes,
    ]
    rig = armature(f"{name}.rig", [*anatomy.bones, *(skirt.bones if skirt else [])])
    meshes = [make_mesh(shell, rig) for shell in shells]
    return PersonBody(rig, meshes, anatomy, skirt)


def _cloth(name: str, cloth: Cloth) -> bpy.types.Material:
    colour, second = (CLOTH_COLOURS[c] if isinstance(c, str) else c for c in (cloth.colour, cloth.second))
    return materials.cloth(name, colour, pattern=cloth.pattern, second=second, repeat_m=cloth.repeat_m)


def _skirt(look: Look, anatomy: Anatomy, phase: float) -> garments.Skirt | None:
    if look.bottom in ("dress", "skirt"):
        return garments.Skirt(anatomy, hem_z=look.hem_z or 0.44, flare=0.36, phase=phase)
    if look.apron:
        return garments.Skirt(anatomy, hem_z=0.46, flare=0.10, folds=5, phase=phase)
    return None


def _clothes(name: str, look: Look, tailor: garments.Tailor, skirt: garments.Skirt | None) -> list[Shell]:
    anatomy, wears_skirt = tailor.anatomy, look.bottom in ("dress", "skirt")
    lower = _cloth(f"{name}.lower", look.lower)
    upper = lower if look.bottom == "dress" else _cloth(f"{name}.upper", look.top)
    trim = materials.leather(f"{name}.trim", (0.05, 0.03, 0.02))
    feminine = look.build == "woman"
    neck = (0.088, 0.045) if feminine else (0.078, 0.008)
    shells = []
    if wears_skirt:
        assert skirt is not None
        shirt = garments.top(
            tailor, f"{name}.top", upper, sleeve=look.sleeve, hem_z=0.97, ease=0.008, loose=0.0, neck=neck
        )
        band = garments.belt(
            skirt, f"{name}.belt", lower if look.bottom == "dress" else trim, z=1.005, offset=0.006
        )
        if look.bottom == "dress":
            shells.append(merged(f"{name}.dress", [shirt, skirt.panel("panel", lower), band]))
        else:
            shells += [shirt, merged(f"{name}.skirt", [skirt.panel("panel", lower), band])]
    else:
        tucked = {"hem_z": 0.965, "loose": 0.0} if look.apron else {}
        shells.append(garments.top(tailor, f"{name}.top", upper, sleeve=look.sleeve, neck=neck, **tucked))
        hem_z = 0.52 if look.bottom == "shorts" else 0.062
        shells.append(garments.trousers(tailor, f"{name}.trousers", lower, hem_z=look.hem_z or hem_z))
    if look.jacket:
        cloth = _cloth(f"{name}.jacket", look.jacket)
        shells.append(garments.jacket(tailor, f"{name}.jacket", [cloth]))
    if look.apron:
        assert skirt is not None
        cloth = _cloth(f"{name}.apron", look.apron)
        lift = 0.014 if wears_skirt else 0.020
        front = skirt.panel(
            "front",
            cloth,
            first=-1.25,
            last=1.25,
            top_z=1.02,
            hem_z=skirt.hem_z + 0.07,
            offset=lift,
            columns=34,
            rows=14,
        )
        ties = garments.belt(skirt, "ties", cloth, z=0.99, offset=lift + 0.002)
        shells.append(merged(f"{name}.apron", [front, garments.bib(tailor, "bib", cloth), ties]))
    shoe = materials.leather(f"{name}.shoe", CLOTH_COLOURS[look.shoe_colour])
    sole = materials.leather(f"{name}.sole", (0.03, 0.028, 0.026))
    shaft = 0.27 if look.shoes == "boots" else 0.088
    shells.append(garments.shoes(anatomy, f"{name}.shoes", shoe, sole, shaft_z=shaft))
    return shells


def _bare_skin(look: Look, tailor: garments.Tailor, skin: bpy.types.Material) -> Shell:
    """Neck, arms and legs as far as clothes show them."""
    anatomy = tailor.anatomy
    k = anatomy.scale
    verts, faces = tailor.surface(0.0)
    arms, z = tailor.reach_along_arms(verts), verts[:, 2]
    sleeve = garments.SLEEVES["long" if look.jacket else look.sleeve] * k * anatomy.build.arms
    legs_from = {"trousers": 0.13, "shorts": 0.56}.get(look.bottom, 0.80) * k
    trunk = np.minimum(1.26 * k - z, z - legs_from)
    if look.sleeve == "none":
        trunk = np.minimum(trunk, 1.15 * k - z)
    verts, cut = clip(verts, faces, np.where(arms > 0.0, sleeve - 0.05 - arms, trunk))
    tint = np.ones((len(verts), 3))
    return Shell("skin", verts, cut, anatomy.body_weights(verts), [skin], tint=tint)


def _hands(anatomy: Anatomy, skin: bpy.types.Material) -> list[Shell]:
    """Palms and fingers as tubes that grow out of one another."""
    parts, k = [], 0.98 * anatomy.scale * (0.9 + 0.1 * anatomy.build.limbs)
    for side, _ in SIDES:
        j = anatomy.joints
        along, palm, thumb = anatomy.hand_frame(side)
        wrist = j[f"hand_{side}"]
        spine = [
            (-0.03, 0.0, 0.0),
            (-0.004, 0.0, 0.0),
            (0.022, 0.002, 0.001),
            (0.05, 0.002, 0.002),
            (0.074, 0.0, 0.002),
            (0.088, -0.002, 0.003),
            (0.094, -0.002, 0.004),
        ]
        size = [
            (0.025, 0.021),
            (0.027, 0.019),
            (0.034, 0.0175),
            (0.0405, 0.0155),
            (0.042, 0.0135),
            (0.040, 0.0115),
            (0.034, 0.006),
        ]
        line = np.array([wrist + k * (a * along + b * thumb + c * palm) for a, b, c in spine])
        verts, faces = tube(line, k * np.array(size), 14, palm)
        reach = (verts - wrist) @ along
        hold = smoothstep(-0.025 * k, 0.012 * k, reach)
        parts.append(Shell("palm", verts, faces, {f"hand_{side}": hold, f"wrist_{side}": 1.0 - hold}, [skin]))
        for finger in (*FINGERS, "thumb"):
            parts.append(_finger(anatomy, finger, side, palm, k, skin))
    return parts


def _finger(
    anatomy: Anatomy, finger: str, side: str, palm: np.ndarray, k: float, skin: bpy.types.Material
) -> Shell:
    base, knee, tip = (anatomy.joints[f"{finger}_{n}_{side}"] for n in ("1", "2", "tip"))
    thick = {"index": 0.0088, "middle": 0.0092, "ring": 0.0087, "pinky": 0.0075, "thumb": 0.0105}[finger] * k
    first, second = knee - base, tip - knee
    points = np.array(
        [
            base - 0.30 * first,
            base + 0.15 * first,
            base + 0.6 * first,
            knee - 0.12 * first,
            knee + 0.05 * second,
            knee + 0.4 * second,
            knee + 0.75 * second,
            tip,
            tip + 0.10 * second,
        ]
    )
    swell = np.array([1.12, 1.10, 1.0, 1.03, 1.02, 0.93, 0.88, 0.70, 0.30])
    if finger == "thumb":
        swell[:3] = (1.75, 1.5, 1.12)
    verts, faces = tube(points, np.stack([thick * swell, thick * swell * 0.92], axis=1), 8, palm)
    reach = np.repeat(np.arange(len(points)), 8)
    row = np.concatenate([reach, [0, len(points) - 1]])
    bend = np.array([0, 0, 0, 0.3, 0.75, 1, 1, 1, 1])[row]
    root = np.array([0.5, 0, 0, 0, 0, 0, 0, 0, 0])[row]
    weights = {
        f"hand_{side}": root,
        f"{finger}_1_{side}": (1 - root) * (1 - bend),
        f"{finger}_2_{side}": bend,
    }
    tint = np.where(row[:, None] >= 7, np.array([1.0, 0.90, 0.89]), np.array([1.0, 0.97, 0.96]))
    return Shell(finger, verts, faces, weights, [skin], tint=tint)


def _head(name: str, look: Look, anatomy: Anatomy, skin: bpy.types.Material, phase: float) -> Shell:
    face = head.Face(
        jaw=look.jaw * anatomy.build.jaw,
        nose=look.nose * (0.85 if look.build == "child" else 1.0),
        feminine=look.build != "man",
    )
    tresses = materials.hair(f"{name}.hair", HAIR_COLOURS[look.hair_colour])
    white = materials.gloss(f"{name}.eye_white", (0.72, 0.70, 0.67), 0.25)
    iris = materials.gloss(f"{name}.iris", look.eye_colour, 0.15)
    pupil = materials.gloss(f"{name}.pupil", (0.006, 0.006, 0.006), 0.1)
    lip = np.array([0.90, 0.50, 0.52]) if look.build == "woman" else np.array([0.93, 0.70, 0.68])
    parts = [
        *head.head_shell(face, skin, lip),
        *head.eye_shells(white, iris, pupil, skin, pupil),
        *head.brow_shells(face, tresses),
        head.hair_shell(look.hair, face, tresses, phase),
    ]
    chin = vec(0, 0, CHIN_M * anatomy.scale)
    return merged(f"{name}.head", head.place(parts, chin, anatomy.head_scale))
