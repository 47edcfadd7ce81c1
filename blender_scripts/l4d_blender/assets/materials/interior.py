"""Surfaces of a lived-in room: fur, wool, woven cloth, wood, plaster, paper, leaves, lampshades.

Owns colours, patterns, roughness and bump. Refuses to know shapes; patterns live in object coordinates
(metres) or, on bodies that deform, in the stored rest position.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import TYPE_CHECKING

import bpy

from l4d_blender.assets.materials.base import Nodes, emission, principled
from l4d_blender.scene.colour import Colour

if TYPE_CHECKING:
    from l4d_blender.assets.cat import Coat


def _material(name: str, colour: Colour) -> tuple[bpy.types.Material, Nodes]:
    material = bpy.data.materials.new(name)
    material.diffuse_color = (*tuple(colour)[:3], 1.0)
    return material, Nodes(material)


def _scaled(colour: Colour, factor: float) -> tuple[float, ...]:
    return tuple(min(c * factor, 1.0) for c in colour[:3])


def fur(name: str, coat: Coat, rng: random.Random) -> bpy.types.Material:
    """Short fur: the mesh attribute "coat" holds (stripe, pale, bare skin); hairs run along the body (Y)."""
    material, n = _material(name, coat.base)
    rest = n.vector_math("ADD", n.rest_coords(), tuple(rng.uniform(-9, 9) for _ in range(3)))
    stripe, pale, bare = n.separate(n.attribute("coat", "Color"))
    hairs = n.noise(260, 3, vector=n.mapping(rest, scale=(1.0, 0.22, 0.6)))
    tufts = n.noise(46, 3, vector=n.mapping(rest, scale=(1.0, 0.55, 1.0)))
    patches = n.noise(13, 2, vector=rest)

    ticking = n.math("ADD", n.math("MULTIPLY", hairs, 0.55), n.math("MULTIPLY", tufts, 0.45))
    ground = n.mix(n.map_range(patches, 0.35, 0.65), _scaled(coat.base, 0.86), _scaled(coat.base, 1.16))
    ground = n.mix(n.map_range(ticking, 0.36, 0.64), n.hue(ground, value=0.62), n.hue(ground, value=1.32))
    edge = n.math("ADD", stripe, n.math("MULTIPLY", n.math("SUBTRACT", tufts, 0.5), 0.9))
    dark = n.mix(n.map_range(hairs, 0.3, 0.7), coat.dark, n.mix(0.35, coat.dark, coat.base))
    colour = n.mix(n.map_range(edge, 0.34, 0.72), ground, dark)
    white = n.mix(n.map_range(ticking, 0.35, 0.6), _scaled(coat.pale, 0.78), coat.pale)
    soft = n.math("ADD", pale, n.math("MULTIPLY", n.math("SUBTRACT", tufts, 0.5), 0.5))
    colour = n.mix(n.map_range(soft, 0.35, 0.65), colour, white)
    colour = n.mix(bare, colour, coat.skin)
    n.set("Base Color", colour)
    n.set("Roughness", 0.82)
    n.set("Specular IOR Level", 0.22)
    n.set("Sheen Weight", 0.35)
    n.set("Sheen Roughness", 0.4)
    n.set("Sheen Tint", _scaled(coat.base, 1.5))
    n.bump(n.math("ADD", n.math("MULTIPLY", hairs, 0.5), tufts), 0.9, 0.0030)
    return material


def cat_eye(name: str, iris: Colour, centre: Sequence[float]) -> bpy.types.Material:
    """A wet eye with a slit pupil and a dark rim, both eyes alike; `centre` is the left eye's at rest."""
    material, n = _material(name, iris)
    x, _, z = n.separate(n.rest_coords())
    across = n.math("SUBTRACT", n.math("ABSOLUTE", x), centre[0] + 0.0026)
    up = n.math("SUBTRACT", z, centre[2] + 0.0010)
    across = n.math("SUBTRACT", across, n.math("MULTIPLY", up, 0.18))
    radius = n.math("SQRT", n.math("ADD", n.math("POWER", across, 2.0), n.math("POWER", up, 2.0)))
    slit = n.math(
        "ADD",
        n.math("POWER", n.math("MULTIPLY", across, 1 / 0.0030), 2.0),
        n.math("POWER", n.math("MULTIPLY", up, 1 / 0.0088), 2.0),
    )
    glow = n.mix(n.map_range(radius, 0.002, 0.009), _scaled(iris, 0.8), _scaled(iris, 1.6))
    glow = n.mix(n.map_range(radius, 0.0098, 0.0112), glow, (0.012, 0.009, 0.008))
    n.set("Base Color", n.mix(n.map_range(slit, 0.8, 1.2), (0.004, 0.004, 0.004), glow))
    n.set("Roughness", 0.08)
    n.set("Coat Weight", 0.6)
    return material


def cloth(name: str, colour: Colour, rng: random.Random, *, slub_per_m: float = 90.0) -> bpy.types.Material:
    """Upholstery with a visible weave: crossed slubs, worn and lighter in places."""
    material, n = _material(name, colour)
    at = n.vector_math("ADD", n.object_coords(), tuple(rng.uniform(-9, 9) for _ in range(3)))
    warp = n.noise(slub_per_m, 2, vector=n.mapping(at, scale=(1.0, 1.0, 0.14)))
    weft = n.noise(slub_per_m, 2, vector=n.mapping(at, scale=(0.14, 0.5, 1.0)))
    weave = n.math("ADD", n.math("MULTIPLY", warp, 0.5), n.math("MULTIPLY", weft, 0.5))
    worn = n.mix(
        n.map_range(n.noise(3.5, 3, vector=at), 0.35, 0.7), _scaled(colour, 0.8), _scaled(colour, 1.15)
    )
    n.set(
        "Base Color", n.mix(n.map_range(weave, 0.38, 0.62), n.hue(worn, value=0.72), n.hue(worn, value=1.2))
    )
    n.set("Roughness", 0.9)
    n.set("Specular IOR Level", 0.2)
    n.set("Sheen Weight", 0.25)
    n.bump(weave, 0.7, 0.002)
    return material


def striped_cloth(
    name: str, colours: tuple[Colour, Colour], rng: random.Random, *, period_m: float = 0.09, axis: int = 0
) -> bpy.types.Material:
    """Two-coloured woven stripes of uneven width across one object axis."""
    material, n = _material(name, colours[0])
    along = n.separate(n.object_coords())[axis]
    fine = n.noise(120, 2)
    place = n.math("FRACT", n.math("ADD", n.math("DIVIDE", along, period_m), rng.random()))
    place = n.math("ADD", place, n.math("MULTIPLY", n.math("SUBTRACT", fine, 0.5), 0.06))
    a, b = colours
    stripes = n.ramp(
        place,
        [(0.0, a), (0.46, a), (0.48, b), (0.58, b), (0.60, a), (0.70, a), (0.72, b), (0.97, b)],
        interpolation="CONSTANT",
    )
    n.set(
        "Base Color",
        n.mix(n.map_range(fine, 0.3, 0.7), n.hue(stripes, value=0.8), n.hue(stripes, value=1.12)),
    )
    n.set("Roughness", 0.9)
    n.set("Sheen Weight", 0.2)
    n.bump(fine, 0.6, 0.002)
    return material


def wool(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """Spun yarn: fuzzy, twisted, lighter on some strands."""
    material, n = _material(name, colour)
    at = n.vector_math("ADD", n.object_coords(), tuple(rng.uniform(-9, 9) for _ in range(3)))
    fuzz, strands = n.noise(420, 2, vector=at), n.noise(34, 2, vector=at)
    shade = n.mix(n.map_range(strands, 0.36, 0.64), _scaled(colour, 0.55), _scaled(colour, 1.35))
    n.set(
        "Base Color", n.mix(n.map_range(fuzz, 0.3, 0.7), n.hue(shade, value=0.75), n.hue(shade, value=1.15))
    )
    n.set("Roughness", 0.9)
    n.set("Specular IOR Level", 0.15)
    n.set("Sheen Weight", 0.5)
    n.bump(fuzz, 0.8, 0.002)
    return material


def felt(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """Short plush of a toy."""
    material, n = _material(name, colour)
    at = n.vector_math("ADD", n.object_coords(), tuple(rng.uniform(-9, 9) for _ in range(3)))
    nap, blotch = n.noise(330, 3, vector=at), n.noise(28, 3, vector=at)
    shade = n.mix(n.map_range(blotch, 0.35, 0.65), _scaled(colour, 0.78), _scaled(colour, 1.18))
    n.set("Base Color", n.mix(n.map_range(nap, 0.3, 0.7), n.hue(shade, value=0.8), n.hue(shade, value=1.15)))
    n.set("Roughness", 0.95)
    n.set("Sheen Weight", 0.4)
    n.bump(nap, 0.8, 0.0025)
    return material


def wood(
    name: str, colour: Colour, rng: random.Random, *, grain_axis: str = "X", gloss: float = 0.45
) -> bpy.types.Material:
    """Oiled wood with grain along an object axis."""
    material, n = _material(name, colour)
    at = n.vector_math("ADD", n.object_coords(), tuple(rng.uniform(-9, 9) for _ in range(3)))
    stretch = {"X": (0.07, 1.0, 1.0), "Y": (1.0, 0.07, 1.0), "Z": (1.0, 1.0, 0.07)}[grain_axis]
    streaks = n.mapping(at, scale=stretch)
    rings = n.noise(26, 4, distortion=0.6, vector=streaks)
    pores = n.noise(160, 2, vector=streaks)
    tone = n.ramp(rings, [(0.3, _scaled(colour, 0.55)), (0.5, colour), (0.7, _scaled(colour, 1.3))])
    n.set("Base Color", n.mix(n.map_range(pores, 0.55, 0.7), tone, n.hue(tone, value=0.6)))
    n.set("Roughness", n.map_range(rings, 0.3, 0.7, gloss, gloss + 0.2))
    n.bump(pores, 0.3, 0.0006)
    return material


def floorboards(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """Long planks along X, each of its own tone, with dark seams and a satin finish."""
    material, n = _material(name, colour)
    at = n.vector_math("ADD", n.object_coords(), (rng.uniform(-9, 9), rng.uniform(-9, 9), 0.0))
    planks, seam = n.brick(
        1.0,
        ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)),
        (0.5, 0.5, 0.5),
        vector=at,
        width=1.35,
        height=0.115,
        mortar_size=0.0022,
        offset=0.37,
    )
    streaks = n.mapping(
        n.vector_math("ADD", at, n.vector_math("MULTIPLY", planks, (7.0, 3.0, 0.0))), scale=(0.06, 1.0, 1.0)
    )
    grain, pores = n.noise(22, 4, distortion=0.5, vector=streaks), n.noise(150, 2, vector=streaks)
    tone = n.ramp(grain, [(0.28, _scaled(colour, 0.62)), (0.5, colour), (0.74, _scaled(colour, 1.28))])
    tone = n.hue(tone, value=n.map_range(planks, 0.0, 1.0, 0.72, 1.22))
    tone = n.mix(n.map_range(pores, 0.56, 0.7), tone, n.hue(tone, value=0.7))
    n.set("Base Color", n.mix(seam, tone, _scaled(colour, 0.18)))
    n.set("Roughness", n.map_range(n.noise(9, 3, vector=at), 0.3, 0.7, 0.34, 0.55))
    n.bump(n.math("SUBTRACT", n.math("MULTIPLY", grain, 0.3), seam), 0.5, 0.0015)
    return material


def plaster(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """A painted wall: roller texture, faint clouds."""
    material, n = _material(name, colour)
    at = n.vector_math("ADD", n.object_coords(), tuple(rng.uniform(-9, 9) for _ in range(3)))
    clouds, roller = n.noise(1.6, 4, vector=at), n.noise(110, 3, vector=at)
    n.set("Base Color", n.mix(n.map_range(clouds, 0.3, 0.7), _scaled(colour, 0.88), _scaled(colour, 1.08)))
    n.set("Roughness", 0.85)
    n.bump(roller, 0.35, 0.002)
    return material


def wallpaper(name: str, colour: Colour, figure: Colour, rng: random.Random) -> bpy.types.Material:
    """Vertical ornament rows on a wall in the XZ plane: leaves on stems, printed a little unevenly."""
    material, n = _material(name, colour)
    x, _, z = n.separate(n.object_coords())
    column = n.math("DIVIDE", x, 0.19)
    across = n.math("SUBTRACT", n.math("FRACT", column), 0.5)
    shift = n.math("MULTIPLY", n.math("FRACT", n.math("MULTIPLY", n.math("FLOOR", column), 0.5)), 1.0)
    up = n.math("SUBTRACT", n.math("FRACT", n.math("ADD", n.math("DIVIDE", z, 0.23), shift)), 0.5)
    curve = n.math(
        "ABSOLUTE",
        n.math(
            "SUBTRACT",
            n.math("ABSOLUTE", across),
            n.math("MULTIPLY", n.math("COSINE", n.math("MULTIPLY", up, 3.14159)), 0.20),
        ),
    )
    leaf = n.math(
        "ADD",
        n.math("POWER", n.math("DIVIDE", across, 0.12), 2.0),
        n.math("POWER", n.math("DIVIDE", up, 0.26), 2.0),
    )
    ink = n.math("MAXIMUM", n.map_range(curve, 0.035, 0.020), n.map_range(leaf, 1.0, 0.85))
    ink = n.math("MULTIPLY", ink, n.map_range(n.noise(60, 2), 0.25, 0.55, 0.55, 1.0))
    clouds = n.noise(1.4, 3)
    base = n.mix(n.map_range(clouds, 0.3, 0.7), _scaled(colour, 0.9), _scaled(colour, 1.07))
    n.set("Base Color", n.mix(ink, base, figure))
    n.set("Roughness", 0.8)
    n.bump(n.noise(140, 2), 0.3, 0.001)
    return material


def carpet(
    name: str, size_m: tuple[float, float], colours: Sequence[Colour], rng: random.Random
) -> bpy.types.Material:
    """A woven rug: banded border, diamond lattice, medallion; colours are (field, figure, dark, light)."""
    material, n = _material(name, colours[0])
    ground, figure, dark, light = colours
    x, y, _ = n.separate(n.object_coords())
    knots = n.noise(95, 2)
    jitter = n.math("MULTIPLY", n.math("SUBTRACT", knots, 0.5), 0.020)
    ax, ay = n.math("ABSOLUTE", x), n.math("ABSOLUTE", y)
    edge = n.math("MINIMUM", n.math("SUBTRACT", size_m[0] / 2, ax), n.math("SUBTRACT", size_m[1] / 2, ay))
    edge = n.math("ADD", edge, jitter)
    u, v = n.math("DIVIDE", ax, 0.30), n.math("DIVIDE", ay, 0.22)
    lattice = n.math(
        "ABSOLUTE", n.math("SUBTRACT", n.math("FRACT", n.math("ADD", n.math("ADD", u, v), jitter)), 0.5)
    )
    cross = n.math(
        "ABSOLUTE", n.math("SUBTRACT", n.math("FRACT", n.math("ADD", n.math("SUBTRACT", u, v), 8.0)), 0.5)
    )
    diamonds = n.math("MINIMUM", lattice, cross)
    pattern = n.ramp(
        diamonds,
        [
            (0.0, _scaled(ground, 1.7)),
            (0.05, ground),
            (0.28, _scaled(figure, 0.6)),
            (0.35, ground),
            (0.46, light),
        ],
        interpolation="CONSTANT",
    )
    medal = n.math("ADD", n.math("DIVIDE", ax, 0.46), n.math("DIVIDE", ay, 0.34))
    medal = n.math("ADD", medal, n.math("MULTIPLY", jitter, 2.0))
    medallion = n.ramp(
        medal,
        [
            (0.0, light),
            (0.16, dark),
            (0.24, figure),
            (0.52, light),
            (0.60, dark),
            (0.66, ground),
            (0.9, dark),
            (0.95, light),
        ],
        interpolation="CONSTANT",
    )
    inside = n.mix(n.math("LESS_THAN", medal, 0.98), pattern, medallion)
    teeth = n.math(
        "ABSOLUTE", n.math("SUBTRACT", n.math("FRACT", n.math("DIVIDE", n.math("ADD", x, y), 0.11)), 0.5)
    )
    band = n.ramp(teeth, [(0.0, light), (0.14, figure), (0.34, dark)], interpolation="CONSTANT")
    border = n.ramp(
        n.math("MULTIPLY", edge, 4.0),
        [(0.0, dark), (0.10, light), (0.16, figure), (0.22, dark)],
        interpolation="CONSTANT",
    )
    in_band = n.math("MULTIPLY", n.math("GREATER_THAN", edge, 0.055), n.math("LESS_THAN", edge, 0.145))
    border = n.mix(in_band, border, band)
    colour = n.mix(n.math("GREATER_THAN", edge, 0.185), border, inside)
    faded = n.map_range(n.noise(2.2, 3), 0.3, 0.7, 0.82, 1.15)
    colour = n.hue(colour, value=faded)
    n.set(
        "Base Color",
        n.mix(n.map_range(knots, 0.3, 0.7), n.hue(colour, value=0.78), n.hue(colour, value=1.15)),
    )
    n.set("Roughness", 0.95)
    n.set("Specular IOR Level", 0.1)
    n.set("Sheen Weight", 0.3)
    n.bump(knots, 0.9, 0.004)
    return material


def sisal(name: str, rng: random.Random) -> bpy.types.Material:
    """Rope wound round an upright post."""
    colour = (0.42, 0.29, 0.15)
    material, n = _material(name, colour)
    turns = n.wave(22, axis="Z", distortion=1.2)
    fibres = n.noise(180, 2)
    shade = n.mix(turns, _scaled(colour, 0.5), _scaled(colour, 1.25))
    n.set("Base Color", n.mix(n.map_range(fibres, 0.3, 0.7), n.hue(shade, value=0.75), shade))
    n.set("Roughness", 0.95)
    n.bump(turns, 0.8, 0.004)
    return material


def leaf(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """A waxy leaf, unevenly green."""
    return principled(
        name, colour, roughness=0.38, variation=0.4, variation_scale=rng.uniform(7, 10), bump=(60, 0.001)
    )


def ceramic(name: str, colour: Colour, rng: random.Random) -> bpy.types.Material:
    """Glazed stoneware with specks and an uneven glaze."""
    material, n = _material(name, colour)
    specks, glaze = n.noise(120, 1), n.noise(9, 3)
    base = n.mix(n.map_range(glaze, 0.3, 0.7), _scaled(colour, 0.85), _scaled(colour, 1.1))
    n.set("Base Color", n.mix(n.map_range(specks, 0.68, 0.74), base, _scaled(colour, 0.4)))
    n.set("Roughness", n.map_range(glaze, 0.3, 0.7, 0.22, 0.4))
    n.bump(glaze, 0.2, 0.002)
    return material


def painting(name: str, palette: Sequence[Colour], rng: random.Random) -> bpy.types.Material:
    """An imagined landscape in the XZ plane: layered hills under a sky, loose brushwork."""
    material, n = _material(name, palette[0])
    x, _, z = n.separate(n.vector_math("ADD", n.object_coords(), (rng.uniform(-9, 9), 0.0, 0.0)))
    ridge = n.noise(5, 4, vector=n.combine(x, rng.uniform(0, 9), 0.0))
    height = n.math("ADD", z, n.math("MULTIPLY", n.math("SUBTRACT", ridge, 0.5), 0.35))
    brush = n.noise(45, 2, vector=n.mapping(n.object_coords(), scale=(0.4, 1.0, 1.6)))
    height = n.math("ADD", height, n.math("MULTIPLY", n.math("SUBTRACT", brush, 0.5), 0.05))
    stops = [(0.08 + 0.8 * i / max(len(palette) - 1, 1), colour) for i, colour in enumerate(palette)]
    layers = n.ramp(n.map_range(height, 0.0, 0.5), stops, interpolation="EASE")
    n.set(
        "Base Color", n.mix(n.map_range(brush, 0.3, 0.7), n.hue(layers, value=0.8), n.hue(layers, value=1.15))
    )
    n.set("Roughness", 0.6)
    n.bump(brush, 0.4, 0.002)
    return material


def daylight_view(name: str, strength: float, rng: random.Random) -> bpy.types.Material:
    """What is outside a window, out of focus: sky over trees, in the XZ plane; it shines."""
    material = emission(name, (1.0, 1.0, 1.0), strength)
    material.cycles.emission_sampling = "NONE"  # the recipe's area light does the lighting, without noise
    n = Nodes(material)
    x, _, z = n.separate(n.object_coords())
    crowns = n.noise(2.2, 3, vector=n.combine(x, rng.uniform(0, 9), z))
    height = n.math("ADD", z, n.math("MULTIPLY", n.math("SUBTRACT", crowns, 0.5), 0.9))
    n.set(
        "Emission Color",
        n.ramp(
            n.map_range(height, 0.3, 1.5),
            [
                (0.0, (0.16, 0.24, 0.07)),
                (0.25, (0.32, 0.46, 0.14)),
                (0.45, (0.60, 0.74, 0.42)),
                (0.6, (0.85, 0.93, 1.0)),
                (1.0, (0.62, 0.80, 1.0)),
            ],
        ),
    )
    return material


def lampshade(name: str, strength: float) -> bpy.types.Material:
    """A glowing linen shade, brighter in its middle."""
    material = emission(name, (1.0, 0.72, 0.42), strength)
    material.cycles.emission_sampling = "NONE"  # the recipe's lamp does the lighting, without noise
    n = Nodes(material)
    _, _, z = n.separate(n.generated_coords())
    threads = n.noise(140, 2)
    glow = n.ramp(z, [(0.0, 0.75), (0.5, 1.0), (1.0, 0.65)])
    n.set(
        "Emission Strength",
        n.math("MULTIPLY", n.math("MULTIPLY", glow, n.map_range(threads, 0.3, 0.7, 0.8, 1.1)), strength),
    )
    return material
